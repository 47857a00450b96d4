// Derivatives by the cloud: against differences of refits, and what they and refits take beside fits.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "../points.hpp"
#include "../stats.hpp"
#include "../timing.hpp"

#include <cmath>
#include <functional>

namespace bench {

namespace {

struct FreeSensitivity {
    void operator()(ko_sensitivity *sensitivity) const { ko_sensitivity_free(sensitivity); }
};
using Sensitivity = std::unique_ptr<ko_sensitivity, FreeSensitivity>;

constexpr int ROUNDS = 5;
// Steps of differences, in D; the solves' residual.
constexpr double STEP = 2e-5, SOLVED = 1e-12;
constexpr double MOVE = 1e-3;

Field refit(const Field &start, const Cloud &cloud, const ko_fit_options &options) {
    ko_field *field = nullptr;
    check(ko_field_refit(start.get(), cloud.get(), &options, &field), "ko_field_refit");
    return Field(field);
}

Sensitivity sensitivity_of(const Field &field, const Cloud &cloud, const ko_fit_options &options) {
    ko_sensitivity *sensitivity = nullptr;
    check(ko_sensitivity_create(field.get(), cloud.get(), &options, &sensitivity), "ko_sensitivity_create");
    return Sensitivity(sensitivity);
}

struct Derivatives {
    std::vector<double> points, normals;
};

Derivatives solve(const Sensitivity &sensitivity, const std::vector<double> &points, std::size_t n_cloud) {
    Derivatives by{std::vector<double>(3 * n_cloud), std::vector<double>(3 * n_cloud)};
    check(ko_sensitivity_solve(sensitivity.get(), points.data(), nullptr, points.size() / 3, nullptr, n_cloud, by.points.data(),
                               by.normals.data()),
          "ko_sensitivity_solve");
    return by;
}

// How vertices move, a wave through the shape, [n], each coordinate within [-1, 1].
std::vector<double> wave(const Facets &mesh, double diagonal) {
    std::vector<double> moves(mesh.vertices.size());
    for (std::size_t k = 0; k < moves.size(); ++k) {
        const double *v = &mesh.vertices[k - k % 3];
        moves[k] = std::sin(20 * v[(k + 1) % 3] / diagonal + static_cast<double>(k % 3));
    }
    return moves;
}

// `cloud` on the mesh with its vertices `step` of their moves further.
Cloud followed(const Cloud &cloud, const Facets &mesh, const std::vector<double> &moves, double step) {
    std::vector<double> vertices = mesh.vertices;
    for (std::size_t k = 0; k < vertices.size(); ++k) vertices[k] += step * moves[k];
    const Mesh moved = mesh_from(vertices, mesh.facets);
    ko_cloud *there = nullptr;
    check(ko_cloud_follow(cloud.get(), moved.get(), &there), "ko_cloud_follow");
    return Cloud(there);
}

double dot(const std::vector<double> &x, const std::vector<double> &y) {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += x[i] * y[i];
    return sum;
}

double sum_of(const std::vector<double> &x) {
    double sum = 0;
    for (const double v : x) sum += v;
    return sum;
}

// The derivative of `j` at 0: central differences with steps h, 2 h and 4 h, extrapolated to sixth order.
double slope(const std::function<double(double)> &j, double h) {
    const auto central = [&](double h) { return (j(h) - j(-h)) / (2 * h); };
    const double narrow = central(h), middle = central(2 * h), wide = central(4 * h);
    return (16 * (4 * narrow - middle) / 3 - (4 * middle - wide) / 3) / 15;
}

void differences(const Mesh &mesh) {
    const std::size_t n = 3000;
    const Cloud cloud = sample(mesh, n);
    ko_fit_options options = options_of({14, 14, 12});
    options.tolerance = SOLVED;
    options.max_iterations = 100000;
    const Field field = fit(cloud, options);
    const double diagonal = report_of(field).diagonal;
    // Some of the points lie outside the box.
    std::vector<double> at = draw_in_box(report_of(field), 50, 7);
    for (std::size_t i = 0; i < 15; ++i) at[i] *= 2;
    const Derivatives by = solve(sensitivity_of(field, cloud, options), at, n);
    options.reweighting = KO_REWEIGHT_KEEP;
    const auto j = [&](const Cloud &moved) { return sum_of(values_of(refit(field, moved, options), at)); };

    std::vector<double> points(3 * n), normals(3 * n);
    check(ko_cloud_copy(cloud.get(), n, points.data(), normals.data()), "ko_cloud_copy");
    Uniform uniform(11);
    std::vector<double> moves(3 * n);
    for (double &m : moves) m = 2 * uniform() - 1;
    const auto moved = [&](std::vector<double> x, double step) {
        for (std::size_t k = 0; k < x.size(); ++k) x[k] += step * moves[k];
        return x;
    };
    // Beside the size that a derivative along a random move has.
    const auto error = [&](double found, double right, double size) { return std::abs(found - right) / size; };
    const double spread = std::sqrt(dot(moves, moves) / static_cast<double>(3 * n));
    const double by_points = slope([&](double h) { return j(cloud_from(3, moved(points, h * diagonal), normals)); }, STEP);
    print("adjoint_difference_by_points",
          error(by_points, diagonal * dot(by.points, moves), diagonal * spread * std::sqrt(dot(by.points, by.points))), "of |dJ|");
    const double by_normals = slope([&](double h) { return j(cloud_from(3, points, moved(normals, h))); }, 100 * STEP);
    print("adjoint_difference_by_normals",
          error(by_normals, dot(by.normals, moves), spread * std::sqrt(dot(by.normals, by.normals))), "of |dJ|");

    // By a parameter of the shape: how far a wave moves its vertices.
    const Facets facets = facets_of(mesh);
    const std::vector<double> way = wave(facets, diagonal);
    std::vector<double> d_vertices(facets.vertices.size());
    check(ko_cloud_pull_back(cloud.get(), mesh.get(), by.points.data(), by.normals.data(), n, facets.vertices.size() / 3,
                             d_vertices.data()),
          "ko_cloud_pull_back");
    // Steps so short that no edge of the mesh turns sharp or smooth on the way: normals of the cloud jump there.
    const double by_parameter = slope([&](double h) { return j(followed(cloud, facets, way, h * diagonal)); }, STEP / 4);
    const double right = diagonal * dot(d_vertices, way);
    print("adjoint_difference_by_shape_parameter", error(by_parameter, right, std::abs(right)), "of dJ");
    print("adjoint_difference_limit", 1e-6, "");
}

struct Work {
    std::string name;
    std::function<void()> run;
    std::vector<double> times = {};
};

void times(const Mesh &mesh) {
    const std::size_t n = 25000;
    const Cloud cloud = sample(mesh, n);
    const ko_fit_options options = options_of({32, 31, 25});
    const Field field = fit(cloud, options);
    const ko_fit_report report = report_of(field);
    const Facets facets = facets_of(mesh);
    const Cloud moved = followed(cloud, facets, wave(facets, report.diagonal), MOVE * report.diagonal / std::sqrt(3.0));
    ko_fit_options keep = options;
    keep.reweighting = KO_REWEIGHT_KEEP;
    Field made;
    const Sensitivity ready = sensitivity_of(field, cloud, options);
    // One J whatever the number of its points: another would take more iterations, or less.
    const std::vector<double> drawn = draw_in_box(report, 100, 3);
    const auto solve_at = [&](std::size_t n_points) {
        std::vector<double> points(3 * n_points);
        for (std::size_t k = 0; k < points.size(); ++k) points[k] = drawn[k % drawn.size()];
        return [&, points] { solve(ready, points, n); };
    };
    std::vector<Work> works = {
        {"fit", [&] { made = fit(moved, options); }},
        {"refit", [&] { made = refit(field, moved, options); }},
        {"refit_that_keeps", [&] { made = refit(field, moved, keep); }},
        {"create", [&] { sensitivity_of(field, cloud, options); }},
        {"solve_at_100_points", solve_at(100)},
        {"solve_at_10000_points", solve_at(10000)},
        {"solve_at_1000000_points", solve_at(1000000)},
    };
    print_count("adjoint_points", n);
    print_count("adjoint_control_points", report.n_unknowns);
    for (std::size_t i = 0; i < 3; ++i) {
        works[i].run();
        const ko_fit_report of = report_of(made);
        print_count("adjoint_" + works[i].name + "_iterations", of.iterations);
        print("adjoint_" + works[i].name + "_error_rms", of.rms, "D");
        print("adjoint_" + works[i].name + "_error_max", of.max, "D");
        print("adjoint_" + works[i].name + "_assembly", of.seconds_assembly, "s");
        print("adjoint_" + works[i].name + "_solves", of.seconds_solve, "s");
    }
    {
        const Pinned pinned;
        for (int round = 0; round < ROUNDS; ++round)
            for (Work &work : works) work.times.push_back(processor_seconds(work.run));
    }
    for (const Work &work : works) print("adjoint_" + work.name, median(work.times), "s");
    const double whole = median(works[0].times);
    for (std::size_t i = 1; i < works.size(); ++i) print("adjoint_" + works[i].name + "_over_fit", median(works[i].times) / whole, "times");
    print("adjoint_refit_over_fit_limit", 0.5, "times");
}

}  // namespace

void adjoint(const Data &data) {
    const Mesh mesh = read_mesh(data("stanford/bunny_lsdo_genie.stl"));
    differences(mesh);
    times(mesh);
}

}  // namespace bench
