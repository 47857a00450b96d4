// Where sides go wrong: signs of points all around closed shapes, and parts of the zero level set that the shape has not; and how far
// |grad phi| is from 1 away from them.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "../measure.hpp"
#include "../points.hpp"

namespace bench {

namespace {

constexpr std::size_t SAMPLES = 50000, POINTS = 20000;  // points all over the box; as many within REACH of the surface
constexpr double REACH = 0.08, SLACK = 2e-3;            // in D; a sign within the slack of the surface does not count
constexpr double AWAY = 0.02;                           // in D; |grad phi| is looked at from here on
constexpr double MOST_OFF = 0.2;                        // of |grad phi| from 1

const char *const SHAPES[] = {"stanford/bunny_lsdo_genie.stl", "stanford/armadillo_cgal.off", "anatomy/femur_cgal.off",
                              "mechanical/rotor.off", "aircraft/bwb.stl", "mechanical/fandisk.obj", "mechanical/joint.off",
                              "mechanical/spool.off", "mechanical/knot1.off", "mechanical/double-torus.off"};

std::vector<double> points_around(const Facets &facets, const ko_fit_report &report, double diagonal) {
    Uniform uniform(11);
    std::vector<double> points = draw_by_area(facets, POINTS, /*seed*/ 5).points;
    for (double &x : points) x += REACH * diagonal * (2 * uniform() - 1);
    for (std::size_t i = 0; i < 3 * POINTS; ++i)
        points.push_back(report.box_min[i % 3] + uniform() * (report.box_max[i % 3] - report.box_min[i % 3]));
    return points;
}

Field fitted(const Cloud &cloud, double max_error) {
    ko_fit_options options = options_of();
    options.max_error = max_error;
    options.tolerance = 1e-3;
    return fit(cloud, options);
}

void sides_of(const std::string &key, const Mesh &mesh, const Field &field) {
    const ko_fit_report report = report_of(field);
    const std::vector<double> points = points_around(facets_of(mesh), report, report.diagonal);
    const std::vector<double> exact = signed_distances(mesh, points);
    std::vector<double> phi(exact.size());
    eval(field, points, phi.data());
    std::size_t wrong = 0;
    double farthest = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const double distance = std::abs(exact[i]) / report.diagonal;
        if (distance <= SLACK || (phi[i] > 0) == (exact[i] > 0)) continue;
        ++wrong;
        farthest = std::max(farthest, distance);
    }
    ko_mesh *surface = nullptr;
    check(ko_field_level_set(field.get(), 0, nullptr, &surface), "ko_field_level_set");
    const Mesh owned(surface);
    print(key + "_longest_cell", cell_of(report) / report.diagonal, "D");
    print(key + "_control_points", static_cast<double>(report.n_unknowns));
    print_count(key + "_wrong_signs", wrong);
    print(key + "_farthest_wrong_sign", farthest, "D");
    print_count(key + "_components", report_of(owned).n_components);
}

// A point, and those a step of it away along the axes and the diagonals between them.
constexpr std::size_t PROBES = 1 + 6 + 8;

void add_probes(const double *x, double step, std::vector<double> &probes) {
    probes.insert(probes.end(), x, x + 3);
    for (int i = 0; i < 27; ++i) {
        const double to[3] = {i / 9 - 1.0, i / 3 % 3 - 1.0, i % 3 - 1.0};
        const double length = std::hypot(to[0], to[1], to[2]);
        if (length == 0 || (length > 1 && length < 1.5)) continue;
        for (int a = 0; a < 3; ++a) probes.push_back(x[a] + step * to[a] / length);
    }
}

// Points of the box as far as `AWAY` from the surface and more.
std::vector<double> points_away(const Mesh &mesh, const ko_fit_report &report) {
    const std::vector<double> drawn = draw_in_box(report, POINTS, /*seed*/ 17), distances = exact_distances(mesh, drawn);
    std::vector<double> kept;
    for (std::size_t i = 0; i < distances.size(); ++i)
        if (std::abs(distances[i]) >= AWAY * report.diagonal) kept.insert(kept.end(), &drawn[3 * i], &drawn[3 * i] + 3);
    return kept;
}

// Those of `points` around which the exact gradient turns by less than 30 degrees within `step`: not near the medial axis.
std::vector<double> off_medial_axis(const Mesh &mesh, const std::vector<double> &points, double step) {
    std::vector<double> probes;
    for (std::size_t i = 0; i < points.size(); i += 3) add_probes(&points[i], step, probes);
    const std::vector<double> exact = exact_distances(mesh, probes);
    const ClosestPoints closest(facets_of(mesh));
    std::vector<double> gradients;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const std::array<double, 3> at = closest.closest(&probes[3 * i]);
        for (int a = 0; a < 3; ++a) gradients.push_back((probes[3 * i + a] - at[a]) / exact[i]);
    }
    std::vector<double> kept;
    for (std::size_t i = 0; i < gradients.size(); i += 3 * PROBES) {
        const double *g = &gradients[i];
        bool turns = false;
        for (std::size_t j = 1; j < PROBES; ++j) {
            const double *h = g + 3 * j;
            turns |= !(g[0] * h[0] + g[1] * h[1] + g[2] * h[2] > std::cos(M_PI / 6));  // so is a NaN, on the surface
        }
        if (!turns) kept.insert(kept.end(), &probes[i], &probes[i] + 3);
    }
    return kept;
}

void gradients_of(const std::string &key, const Field &field, const std::vector<double> &points) {
    std::vector<double> phi(points.size() / 3), gradients(points.size()), off;
    eval(field, points, phi.data(), gradients.data());
    for (std::size_t i = 0; i < points.size(); i += 3)
        off.push_back(std::abs(std::hypot(gradients[i], gradients[i + 1], gradients[i + 2]) - 1));
    const auto far_off = std::count_if(off.begin(), off.end(), [](double x) { return x > MOST_OFF; });
    print(key + "_gradient_off_1_beyond_0.2", 100.0 * static_cast<double>(far_off) / static_cast<double>(off.size()), "%");
    print(key + "_gradient_off_1_median", median(off));
    print(key + "_gradient_off_1_max", *std::max_element(off.begin(), off.end()));
}

}  // namespace

void sides(const Data &data) {
    print_count("sides_points", 2 * POINTS);
    for (const char *shape : SHAPES) {
        const Mesh mesh = read_mesh(data(shape));
        const Cloud cloud = sample(mesh, SAMPLES);
        std::string name = shape;
        name = name.substr(name.find('/') + 1);
        const std::string key = "sides_" + name.substr(0, name.find('.'));
        print_count(key + "_components", report_of(mesh).n_components);
        const Field one_grid = fitted(cloud, 0), refined = fitted(cloud, 1e-3);
        const ko_fit_report report = report_of(one_grid);
        const std::vector<double> away = points_away(mesh, report);
        const std::vector<double> by_a_cell = off_medial_axis(mesh, away, cell_of(report));
        const std::vector<double> by_two = off_medial_axis(mesh, by_a_cell, 2 * cell_of(report));
        print_count(key + "_away_points", away.size() / 3);
        print_count(key + "_away_points_a_cell_off_medial_axis", by_a_cell.size() / 3);
        print_count(key + "_away_points_two_cells_off_medial_axis", by_two.size() / 3);
        for (const auto &[name_of, field] : {std::pair{"_one_grid", &one_grid}, std::pair{"_refined", &refined}}) {
            sides_of(key + name_of, mesh, *field);
            gradients_of(key + name_of + "_a_cell_off_medial_axis", *field, by_a_cell);
            gradients_of(key + name_of + "_two_cells_off_medial_axis", *field, by_two);
        }
    }
}

}  // namespace bench
