// What the paper's start of the solve saves: control points set to the explicit distance (1) of Hicken and Kaur (2022) at their places.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "../timing.hpp"
#include "common.hpp"

namespace bench {

namespace {

// Points with normals, both [n x 3].
struct Oriented {
    std::vector<double> points, normals;
};

Oriented oriented(const Cloud &cloud) {
    std::size_t n = 0;
    check(ko_cloud_get_size(cloud.get(), &n), "ko_cloud_get_size");
    Oriented copy{std::vector<double>(3 * n), std::vector<double>(3 * n)};
    check(ko_cloud_copy(cloud.get(), n, copy.points.data(), copy.normals.data()), "ko_cloud_copy");
    return copy;
}

// (1) at x, over all points; those whose weight is below 1e-13 of the nearest point's are not summed.
double explicit_distance(const double *x, const Oriented &cloud, double rho, std::vector<double> &distances) {
    const std::size_t n = cloud.points.size() / 3;
    double least = 1e300;
    for (std::size_t i = 0; i < n; ++i) {
        const double *p = &cloud.points[3 * i];
        const double d[3] = {x[0] - p[0], x[1] - p[1], x[2] - p[2]};
        distances[i] = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        least = std::min(least, distances[i]);
    }
    const double nearest = std::sqrt(least), farthest = nearest + 30 / rho;
    double sum = 0, weights = 0;
    for (std::size_t i = 0; i < n; ++i) {
        if (distances[i] > farthest * farthest) continue;
        const double weight = std::exp(-rho * (std::sqrt(distances[i]) - nearest));
        for (int k = 0; k < 3; ++k) sum += weight * (x[k] - cloud.points[3 * i + k]) * cloud.normals[3 * i + k];
        weights += weight;
    }
    return sum / weights;
}

// A field on the box of `like` whose control points are (1) at their places: control point i of an axis lies i - 1 cells from its face.
Field explicit_field(const Oriented &cloud, const ko_fit_report &like, double rho) {
    std::vector<double> control_points, scratch(cloud.points.size() / 3);
    const std::uint32_t *n = like.control_points;
    const auto place = [&](int axis, std::uint32_t i) {
        return like.box_min[axis] + (like.box_max[axis] - like.box_min[axis]) * (static_cast<double>(i) - 1) / (n[axis] - 3.0);
    };
    for (std::uint32_t i = 0; i < n[0]; ++i)
        for (std::uint32_t j = 0; j < n[1]; ++j)
            for (std::uint32_t k = 0; k < n[2]; ++k) {
                const double x[3] = {place(0, i), place(1, j), place(2, k)};
                control_points.push_back(explicit_distance(x, cloud, rho, scratch));
            }
    ko_field *field = nullptr;
    check(ko_field_from_control_points(3, n, like.box_min, like.box_max, KO_FEASIBLE_OUTSIDE, like.diagonal, control_points.data(),
                                       control_points.size(), &field),
          "ko_field_from_control_points");
    return Field(field);
}

Field refit(const Field &start, const Cloud &cloud, const ko_fit_options &options) {
    ko_field *field = nullptr;
    check(ko_field_refit(start.get(), cloud.get(), &options, &field), "ko_field_refit");
    return Field(field);
}

}  // namespace

void guess(const Data &data) {
    const Shape bunny(data("stanford/bunny_lsdo_genie.stl"));
    const Cloud cloud = sample(bunny.mesh, N_SAMPLES);
    const Oriented points = oriented(cloud);
    const ko_fit_report like = report_of(fit(cloud, options_of(BUNNY_GRID)));
    const double spacing = std::sqrt(report_of(bunny.mesh).area / N_SAMPLES), rho = 2 / spacing;
    const Pinned pinned;
    Field start;
    const double time = seconds([&] { start = explicit_field(points, like, rho); });
    print("guess_rho", rho * like.diagonal, "/ D, 2 / mean spacing of the samples");
    print("guess_explicit_seconds", time, "s, summing over all samples");
    print_on_surface("guess_explicit", on_surface(start, bunny.held_out.points));
    for (const std::uint32_t rounds : {0u, 3u}) {
        for (const double tolerance : {1e-4, 1e-8}) {
            ko_fit_options options = options_of(BUNNY_GRID);
            options.reweightings = rounds;
            options.tolerance = tolerance;
            const std::string solve = rounds ? "default_rounds" : "one_solve", to = tolerance > 1e-6 ? "_1e-4" : "_1e-8";
            const std::string key = "guess_" + solve + to;
            const std::pair<const char *, const Field *> starts[] = {{"_from_zero", nullptr}, {"_from_explicit", &start}};
            for (const auto &[name, from] : starts) {
                const Field field = from ? refit(*from, cloud, options) : fit(cloud, options);
                const ko_fit_report report = report_of(field);
                print_count(key + name + "_iterations", report.iterations);
                print(key + name + "_seconds", seconds_of(report), "s");
                print(key + name + "_on_surface_rms", on_surface(field, bunny.held_out.points).phi.rms(), "D");
            }
        }
    }
}

}  // namespace bench
