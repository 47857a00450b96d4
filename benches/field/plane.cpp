// Curves of the plane at 64 x 64 control points.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "common.hpp"
#include "corners.hpp"
#include "shapes.hpp"

namespace bench {

namespace {

const Counts GRID = {64, 64, 0};
const std::size_t N_CURVE_SAMPLES = 2000;
const double LIMIT = 2e-4;

void curve(const std::string &key, Mesh mesh) {
    const Shape shape(std::move(mesh));
    const Field field = fit(sample(shape.mesh, N_CURVE_SAMPLES), options_of(GRID));
    print_fit(key, field);
    const OnSurface all = on_surface(field, shape.held_out.points);
    print_errors(key + "_on_curve", all.phi);
    print(key + "_mean_gradient", all.mean_gradient);
    const double cell = cell_of(report_of(field));
    const std::vector<double> corners = corners_of(facets_of(shape.mesh), 40);
    print_count(key + "_corners", corners.size() / 2, "of more than 40 degrees");
    const std::vector<double> smooth = farther_than(2 * cell, shape.held_out.points, corners);
    const OnSurface away = on_surface(field, smooth);
    print_errors(key + "_two_cells_from_corners", away.phi, {LIMIT, 0});
    print_errors(key + "_two_cells_from_corners_over_gradient", away.distance, {LIMIT, 0});
    print_signs(key, signs_in_box(field, shape.mesh, N_POINTS), N_POINTS);
}

}  // namespace

void plane(const Data &data) {
    curve("plane_rectangle", rectangle(2, 1));
    curve("plane_circle", circles({{0, 0, 1}}));
    curve("plane_three_circles", circles({{-1, 0, 0.5}, {0.8, 0.3, 0.7}, {0, -1.2, 0.4}}));
    for (const char *name : {"clarky", "naca0012", "rae2822", "s1223"})
        curve(std::string("plane_") + name, curves_from(data((std::string("curves2d/") + name + ".dat").c_str())));
    curve("plane_borssele", curves_from(data("curves2d/iea37-boundary-cs3.yaml")));
}

}  // namespace bench
