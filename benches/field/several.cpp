// Several shapes in one domain, figure 4 of paper 000, and open shapes, its figure 2.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "common.hpp"
#include "corners.hpp"
#include "shapes.hpp"

namespace bench {

namespace {

// Circles in a row: phi along the x axis through their middles against the exact distance.
void circles_in_a_row() {
    const std::string key = "several_circles";
    const std::vector<Circle> row = {{-2.2, 0, 0.3}, {-0.9, 0, 0.6}, {1.1, 0, 1.0}, {2.7, 0, 0.2}};
    const Shape shape(circles(row));
    const Field field = fit(sample(shape.mesh, 2000), options_of({64, 64, 0}));
    print_fit(key, field);
    print_on_surface(key, on_surface(field, shape.held_out.points));
    print_signs(key, signs_in_box(field, shape.mesh, N_POINTS), N_POINTS);

    const ko_fit_report report = report_of(field);
    const double cell = cell_of(report), D = report.diagonal;
    const std::size_t n = 10001;
    const auto exact = [&](double x) {
        double least = 1e300;
        for (const Circle &circle : row) least = std::min(least, std::abs(x - circle.x) - circle.radius);
        return least;
    };
    // The distance has a kink where it is extremal along the axis: in the middles of circles, and between them.
    const auto kinked = [&](double x) {
        return std::abs(exact(x + 2 * cell) - exact(x - 2 * cell)) < 4 * cell * (1 - 1e-9);
    };
    Errors near, smooth, all;
    std::vector<double> points;
    for (std::size_t i = 0; i < n; ++i) {
        points.push_back(report.box_min[0] + (report.box_max[0] - report.box_min[0]) * static_cast<double>(i) / (n - 1));
        points.push_back(0);
    }
    const std::vector<double> values = values_of(field, points);
    for (std::size_t i = 0; i < n; ++i) {
        const double x = points[2 * i], error = (values[i] - exact(x)) / D;
        all.add(error);
        if (!kinked(x)) smooth.add(error);
        if (!kinked(x) && std::abs(exact(x)) < 2 * cell) near.add(error);
    }
    print_errors(key + "_along_x_within_2_cells_of_a_circle_2_cells_from_kinks", near);
    print_errors(key + "_along_x_2_cells_from_kinks", smooth);
    print_errors(key + "_along_x", all);
}

// A shape with a rim, beyond which its sides mean nothing.
void open_shape(const std::string &key, const Shape &shape, std::size_t n_samples, Counts counts) {
    const Field field = fit(sample(shape.mesh, n_samples), options_of(counts));
    print_fit(key, field);
    const Facets facets = facets_of(shape.mesh);
    const std::size_t dim = facets.dim;
    const double cell = cell_of(report_of(field));
    const std::vector<double> rim = rim_of(facets, cell / 4);
    print_on_surface(key, on_surface(field, shape.held_out.points));
    print_on_surface(key + "_two_cells_from_rim", on_surface(field, farther_than(2 * cell, shape.held_out.points, rim, dim)));

    // Points off the surface along its normals to which no other part of it is nearer: their sign is that of the offset.
    const ClosestPoints closest(facets);
    for (const double cells : {1.0, 2.0, 4.0}) {
        std::size_t judged = 0, wrong = 0, wrong_near = 0;
        double farthest = 0;
        for (const double side : {cells, -cells}) {
            const std::vector<double> points = displaced(shape.held_out, side * cell), values = values_of(field, points);
            for (std::size_t i = 0; i < values.size(); ++i) {
                if (closest.distance(&points[dim * i]) < 0.999 * cells * cell) continue;
                ++judged;
                if (values[i] * side > 0) continue;
                const double away = nearest(&shape.held_out.points[dim * i], rim, dim) / cell;
                ++wrong;
                wrong_near += away < 2;
                farthest = std::max(farthest, away);
            }
        }
        const std::string at = key + "_" + std::to_string(static_cast<int>(cells)) + "_cells_off";
        print_count(at + "_wrong_signs", wrong, ("of " + std::to_string(judged)).c_str());
        print_count(at + "_wrong_signs_within_2_cells_of_rim", wrong_near, "points");
        print(at + "_wrong_sign_farthest_from_rim", farthest, "cells");
    }
}

}  // namespace

void several(const Data &data) {
    circles_in_a_row();
    open_shape("open_funnel", Shape(funnel()), 2000, {64, 64, 0});
    open_shape("open_ventricle", Shape(data("anatomy/ventricle_lv.stl")), N_SAMPLES, {0, 0, 0});
    open_shape("open_wing", Shape(data("aircraft/wingsurf.stl")), N_SAMPLES, {0, 0, 0});
}

}  // namespace bench
