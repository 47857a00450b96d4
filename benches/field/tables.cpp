// Tables 4 and 5 of paper 000: parts of an aircraft with a human and a piece of luggage, and a heart.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "common.hpp"
#include "shapes.hpp"

#include <functional>

namespace bench {

namespace {

const std::size_t N_SIGNS = 20000;

struct Row {
    const char *key;
    std::function<Mesh()> mesh;
    Counts counts;
    Limits paper;
    double seconds_paper;
};

// The paper does not say how its shapes lay; here the longest axis of a shape gets the largest count, and so on.
Counts ordered(const Mesh &mesh, Counts counts) {
    const ko_mesh_report report = report_of(mesh);
    std::array<int, 3> axes = {0, 1, 2};
    const auto extent = [&](int k) { return report.bounds_max[k] - report.bounds_min[k]; };
    std::sort(axes.begin(), axes.end(), [&](int a, int b) { return extent(a) < extent(b); });
    std::sort(counts.begin(), counts.end());
    Counts given;
    for (int k = 0; k < 3; ++k) given[axes[k]] = counts[k];
    return given;
}

// The paper has weights of its own for these tables, and so have we: for shapes smoother than the default weights are made for.
ko_fit_options table_options(Counts counts) {
    ko_fit_options options = options_of(counts);
    options.lambda_normal = 1e-5;
    options.lambda_smooth = 3e-11;
    return options;
}

void table_4_row(const Row &row) {
    const std::string key = std::string("table_4_") + row.key;
    const Shape shape(row.mesh());
    const Counts counts = ordered(shape.mesh, row.counts);
    const Cloud cloud = sample(shape.mesh, N_SAMPLES);
    const Field field = fit(cloud, table_options(counts));
    print_fit(key, field);
    print(key + "_fit_seconds_paper", row.seconds_paper, "s");
    const OnSurface found = on_surface(field, shape.held_out.points);
    print_errors(key + "_on_surface", found.phi, row.paper, "_paper");
    print_errors(key + "_on_surface_over_gradient", found.distance);
    print(key + "_mean_gradient", found.mean_gradient);
    print_signs(key, signs_in_box(field, shape.mesh, N_SIGNS), N_SIGNS);
    const Field by_default = fit(cloud, options_of(counts));
    print_errors(key + "_default_weights_on_surface", on_surface(by_default, shape.held_out.points).phi);
    const Signs signs = signs_in_box(by_default, shape.mesh, N_SIGNS);
    print_count(key + "_default_weights_wrong_beyond_a_cell", signs.wrong_far, ("of " + std::to_string(signs.far)).c_str());
}

void table_4(const Data &data) {
    const auto file = [&](const char *name) { return [&data, name] { return read_mesh(data(name)); }; };
    const Limits fuselage_paper = {7.6e-5, 5.7e-4}, wing_paper = {2.5e-4, 1.0e-3}, pack_paper = {4.4e-4, 1.8e-3};
    const Row rows[] = {
        {"fuselage", fuselage, {47, 29, 29}, fuselage_paper, 6.7},
        {"luggage", luggage, {33, 44, 28}, {1.8e-4, 1.8e-3}, 13.5},
        {"wing", wing, {29, 47, 29}, wing_paper, 39.4},
        {"battery_pack", battery_pack, {29, 47, 29}, pack_paper, 15.6},
        {"human", [&] { return group_of_obj(data("anatomy/human_body_mpfb2.obj"), "body"); }, {37, 32, 34}, {7.8e-4, 3.8e-3}, 21.3},
        {"fuselage_file", file("aircraft/fuselage_skinny_b.stl"), {47, 29, 29}, fuselage_paper, 6.7},
        {"wing_file", file("aircraft/wingsurf.stl"), {29, 47, 29}, wing_paper, 39.4},
        {"battery_pack_file", file("aircraft/battery_pack_skinny_b.stl"), {29, 47, 29}, pack_paper, 15.6}};
    print("table_4_shapes", std::string("made by the bench but for the human and those that end in _file, whose edges are sharp where the paper's shapes are smooth"));
    for (const Row &row : rows) table_4_row(row);
}

// Whether the exact gradient turns by more than 30 degrees within one cell of `p`: the field, which is smooth, cannot follow it there.
bool near_medial_axis(const ClosestPoints &surface, const double *p, double cell) {
    const auto gradient = [&](const std::array<double, 3> &at) {
        const std::array<double, 3> q = surface.closest(at.data());
        const double length = std::hypot(at[0] - q[0], at[1] - q[1], at[2] - q[2]);
        return std::array<double, 3>{(at[0] - q[0]) / length, (at[1] - q[1]) / length, (at[2] - q[2]) / length};
    };
    const auto here = gradient({p[0], p[1], p[2]});
    for (int k = 0; k < 6; ++k) {
        std::array<double, 3> moved = {p[0], p[1], p[2]};
        moved[k / 2] += k % 2 ? cell : -cell;
        const auto there = gradient(moved);
        if (here[0] * there[0] + here[1] * there[1] + here[2] * there[2] < 0.8660254037844386) return true;
    }
    return false;
}

// Off the surface by the paper's 5 mm of its D of 244.75: at all held-out points, and at those not near the medial axis.
void heart_off_surface(const std::string &key, const Shape &heart, const Field &field) {
    const ko_fit_report report = report_of(field);
    const ClosestPoints closest(facets_of(heart.mesh));
    const SurfacePoints few = draw_by_area(facets_of(heart.mesh), 10000, HELD_OUT);
    for (const double side : {1.0, -1.0}) {
        const std::vector<double> points = displaced(few, side * 5 / 244.75 * report.diagonal), values = values_of(field, points);
        const std::vector<double> exact = exact_distances(heart.mesh, points);
        Errors all, away;
        std::size_t near = 0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double error = (values[i] - exact[i]) / report.diagonal;
            all.add(error);
            if (near_medial_axis(closest, &points[3 * i], cell_of(report))) ++near;
            else away.add(error);
        }
        const std::string at = key + (side > 0 ? "_5mm_outside" : "_5mm_inside");
        print_errors(at, all, {3.1e-3, 4.3e-3}, "_paper");
        print_count(at + "_points_near_medial_axis", near, "of 10000");
        print_errors(at + "_not_near_medial_axis", away);
    }
}

void table_5(const Data &data) {
    const Shape heart(data("anatomy/heart_sphinxsys.stl"));
    const Counts counts = ordered(heart.mesh, {28, 23, 37});
    const Cloud cloud = sample(heart.mesh, 100000);
    for (const bool by_default : {false, true}) {
        const std::string key = std::string("table_5_heart") + (by_default ? "_default_weights" : "");
        const Field field = fit(cloud, by_default ? options_of(counts) : table_options(counts));
        print_fit(key, field);
        print(key + "_fit_seconds_paper", 8.7, "s, to 1,842 samples");
        const OnSurface found = on_surface(field, heart.held_out.points);
        print_errors(key + "_on_surface", found.phi, {2.1e-4, 1.8e-3}, "_paper");
        print_errors(key + "_on_surface_over_gradient", found.distance);
        print(key + "_mean_gradient", found.mean_gradient);
        heart_off_surface(key, heart, field);
        print_signs(key, signs_in_box(field, heart.mesh, N_SIGNS), N_SIGNS);
    }
}

}  // namespace

void tables(const Data &data) {
    const ko_fit_options options = table_options({});
    print("tables_4_and_5_lambda_normal", options.lambda_normal);
    print("tables_4_and_5_lambda_smooth", options.lambda_smooth);
    print("tables_4_and_5_order_of_counts", std::string("the longest axis of a shape has the largest count, the shortest the smallest"));
    table_4(data);
    table_5(data);
}

}  // namespace bench
