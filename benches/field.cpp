// The field's figures: accuracy beside the paper's, scale, fit, evaluation beside CGAL's closest point, signs, growth.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "library.hpp"
#include "machine.hpp"
#include "measure.hpp"
#include "oracle.hpp"
#include "program.hpp"
#include "timing.hpp"

#include <cstring>

namespace {

using namespace bench;

const char *const BUNNY = "stanford/bunny_35947.obj";
const Counts BUNNY_GRID = {32, 31, 25};  // the paper's 24,800
const std::size_t N_SAMPLES = 25000;
const std::size_t N_POINTS = 100000;
const std::uint64_t HELD_OUT = 20230601;  // a seed that no fit uses
const std::uint64_t IN_BOX = 7;

// A mesh and the points that its fields are judged on.
struct Shape {
    Mesh mesh;
    SurfacePoints held_out;

    explicit Shape(const std::string &path)
        : mesh(read_mesh(path)), held_out(draw_by_area(triangles_of(mesh), N_POINTS, HELD_OUT)) {}
};

// The finest near-cubic grid of at most `most` control points over a box in the proportions of the mesh.
Counts grid_of_at_most(const Mesh &mesh, double most) {
    const ko_mesh_report report = report_of(mesh);
    Counts best = {4, 4, 4};
    for (double cells = 1; cells < 1000; cells += 0.25) {  // along the longest extent
        double extents[3], n = 1;
        for (int k = 0; k < 3; ++k) extents[k] = report.bounds_max[k] - report.bounds_min[k];
        const double edge = *std::max_element(extents, extents + 3) / cells;
        Counts counts;
        for (int k = 0; k < 3; ++k) n *= counts[k] = 3 + static_cast<std::uint32_t>(std::ceil(extents[k] / edge));
        if (n > most) break;
        best = counts;
    }
    return best;
}

std::string text(Counts counts) {
    return std::to_string(counts[0]) + "x" + std::to_string(counts[1]) + "x" + std::to_string(counts[2]);
}

double seconds_of(const ko_fit_report &report) {
    return report.seconds_assembly + report.seconds_solve + report.seconds_check;
}

struct Limits {
    double rms, max;
};

void print_with(const std::string &key, double value, const char *suffix, double other) {
    print(key, value, "D");
    if (other > 0) print(key + suffix, other, "D");
}

void print_fit(const std::string &key, const Field &field) {
    const ko_fit_report report = report_of(field);
    print(key + "_control_points", text({report.control_points[0], report.control_points[1], report.control_points[2]}));
    print_count(key + "_samples", report.n_points);
    print_count(key + "_fit_iterations", report.iterations);
    print(key + "_fit_seconds", seconds_of(report), "s");
}

void print_on_surface(const std::string &key, const OnSurface &found, Limits limit) {
    print_with(key + "_on_surface_rms", found.phi.rms(), "_limit", limit.rms);
    print_with(key + "_on_surface_max", found.phi.max(), "_limit", limit.max);
    print_with(key + "_on_surface_over_gradient_rms", found.distance.rms(), "_limit", limit.rms);
    print_with(key + "_on_surface_over_gradient_max", found.distance.max(), "_limit", limit.max);
    print(key + "_mean_gradient", found.mean_gradient);
}

void print_paper(const std::string &key, Limits paper) {
    print(key + "_on_surface_rms_paper", paper.rms, "D");
    print(key + "_on_surface_max_paper", paper.max, "D");
}

// Figure 1, the bunny: on its surface, and beside it against the exact distance.
void bunny_accuracy(const Shape &bunny, const Cloud &cloud) {
    const Field field = fit(cloud, options_of(BUNNY_GRID));
    print_fit("bunny_25k", field);
    const OnSurface found = on_surface(field, bunny.held_out.points);
    print_on_surface("bunny_25k", found, {5.5e-4, 4.0e-3});
    print_paper("bunny_25k", {8.2e-4, 3.7e-3});
    print("bunny_25k_mean_gradient_off_1", std::abs(found.mean_gradient - 1));
    print("bunny_25k_mean_gradient_off_1_limit", 0.02);
    const double D = report_of(field).diagonal;
    print("bunny_25k_off_surface_side_by", std::string("the library's winding number: this bunny has holes, and so no side by CGAL"));
    const struct {
        const char *key;
        double offset;
    } levels[] = {{"plus_0.005", 0.005}, {"minus_0.005", -0.005}, {"plus_0.01", 0.01}, {"minus_0.01", -0.01}};
    for (const auto &level : levels) {
        const std::vector<double> points = displaced(bunny.held_out, level.offset * D);
        const Errors errors = off_surface(field, points, exact_distances(bunny.mesh, points));
        print(std::string("bunny_25k_off_surface_") + level.key + "_rms", errors.rms(), "D");
        print(std::string("bunny_25k_off_surface_") + level.key + "_max", errors.max(), "D");
    }
}

// Figure 1, Table 2: three clouds by three grids.
void table_2(const Shape &bunny) {
    const struct {
        const char *key;
        std::size_t n;
    } clouds[] = {{"5k", 5000}, {"25k", 25000}, {"64k", 64000}};
    const Counts grids[] = {BUNNY_GRID, {40, 39, 32}, {48, 45, 33}};
    // The text of the paper that we have lacks the third column, but for its seconds.
    const Limits paper[3][2] = {
        {{1.0e-3, 4.7e-3}, {7.5e-4, 3.7e-3}}, {{8.2e-4, 3.7e-3}, {5.4e-4, 3.3e-3}}, {{7.8e-4, 6.1e-3}, {5.1e-4, 5.1e-3}}};
    const double paper_seconds[] = {4.79, 8.90, 15.87};
    print("table_2_paper_third_column", std::string("not known to us"));
    for (std::size_t i = 0; i < 3; ++i) {
        const Cloud cloud = sample(bunny.mesh, clouds[i].n);
        for (std::size_t j = 0; j < 3; ++j) {
            const Field field = fit(cloud, options_of(grids[j]));
            const OnSurface found = on_surface(field, bunny.held_out.points);
            const std::string key = std::string("table_2_bunny_") + clouds[i].key + "_" + text(grids[j]);
            print(key + "_on_surface_rms", found.phi.rms(), "D");
            print(key + "_on_surface_max", found.phi.max(), "D");
            if (j < 2) print_paper(key, paper[i][j]);
            print(key + "_fit_seconds", seconds_of(report_of(field)), "s");
            print(key + "_fit_seconds_paper", paper_seconds[j], "s");
        }
    }
}

// Figure 1, Table 3: armadillo and dragon at the paper's size, and the armadillo at the issue's.
void table_3(const Data &data) {
    const auto at_paper_size = [](const std::string &key, const Shape &shape, Limits paper) {
        const Field field = fit(sample(shape.mesh, N_SAMPLES), options_of(grid_of_at_most(shape.mesh, 25000)));
        print_fit(key, field);
        print_on_surface(key, on_surface(field, shape.held_out.points), {0, 0});
        print_paper(key, paper);
    };
    const Shape armadillo(data("stanford/armadillo_cgal.off"));
    at_paper_size("table_3_armadillo", armadillo, {1.3e-3, 7.6e-3});
    at_paper_size("table_3_dragon", Shape(data("stanford/dragon_vrip.ply.gz")), {1.4e-3, 1.0e-2});
    const Field field = fit(sample(armadillo.mesh, 40000), options_of({32, 32, 32}));
    print_fit("armadillo_40k", field);
    print_on_surface("armadillo_40k", on_surface(field, armadillo.held_out.points), {9.0e-4, 5.5e-3});
}

// Figure 2: phi / D of a cloud and of the same cloud in another unit, at corresponding points.
void scale(const Cloud &cloud) {
    std::vector<double> points(3 * N_SAMPLES), normals(3 * N_SAMPLES);
    check(ko_cloud_copy(cloud.get(), N_SAMPLES, points.data(), normals.data()), "ko_cloud_copy");
    const auto scaled = [](std::vector<double> numbers, double factor) {
        for (double &number : numbers) number *= factor;
        return numbers;
    };
    const auto fit_scaled = [&](double factor, double tolerance) {
        ko_cloud *handle = nullptr;
        const std::vector<double> moved = scaled(points, factor);
        check(ko_cloud_from_points(3, moved.data(), normals.data(), N_SAMPLES, &handle), "ko_cloud_from_points");
        ko_fit_options options = options_of(BUNNY_GRID);
        if (tolerance > 0) options.tolerance = tolerance;
        return fit(Cloud(handle), options);
    };
    const auto relative = [&](const Field &field, const std::vector<double> &at, double factor) {
        return scaled(values_of(field, scaled(at, factor)), 1 / report_of(field).diagonal);
    };

    const Field as_it_is = fit_scaled(1, 0);
    const std::vector<double> at = draw_in_box(report_of(as_it_is), 10000, IN_BOX);
    const std::vector<double> expected = relative(as_it_is, at, 1);
    for (const auto &[key, factor] : {std::pair{"2^10", 0x1p10}, {"2^-10", 0x1p-10}}) {
        const std::vector<double> found = relative(fit_scaled(factor, 0), at, factor);
        std::uint64_t differing = 0;
        for (std::size_t i = 0; i < at.size() / 3; ++i) differing += std::memcmp(&found[i], &expected[i], sizeof(double)) != 0;
        print_count(std::string("scale_") + key + "_values_that_differ", differing, "of 10000");
        print_count(std::string("scale_") + key + "_values_that_differ_limit", 0, "of 10000");
    }
    const std::vector<double> tight = relative(fit_scaled(1, 1e-12), at, 1);
    for (const auto &[key, factor] : {std::pair{"1e3", 1e3}, {"1e-3", 1e-3}}) {
        const std::vector<double> found = relative(fit_scaled(factor, 1e-12), at, factor);
        Errors errors;
        for (std::size_t i = 0; i < found.size(); ++i) errors.add(found[i] - tight[i]);
        print(std::string("scale_") + key + "_largest_difference", errors.max(), "D");
        print(std::string("scale_") + key + "_largest_difference_limit", 1e-9, "D");
    }
}

// Figure 3: the fit's time, by the clock around the call.
void fit_time(const Cloud &cloud) {
    const Pinned pinned;
    std::vector<double> runs, processor;
    for (int i = 0; i < 3; ++i) {
        runs.push_back(seconds([&] {
            processor.push_back(processor_seconds([&] { fit(cloud, options_of(BUNNY_GRID)); }));
        }));
    }
    print("bunny_fit_seconds_fastest_of_3", minimum(runs), "s");
    print("bunny_fit_seconds_median_of_3", median(runs), "s");
    print("bunny_fit_seconds_limit", 3, "s");
    print("bunny_fit_processor_seconds_fastest_of_3", minimum(processor), "s");
}

// Figure 4: an evaluation beside a closest point of CGAL's, round by round, since other programs share the machine.
void eval_time(const Shape &bunny, const Cloud &cloud) {
    const Field field = fit(cloud, options_of(BUNNY_GRID));
    const std::vector<double> points = draw_in_box(report_of(field), N_POINTS, IN_BOX);
    const ClosestPoints closest(triangles_of(bunny.mesh));
    std::vector<double> values(N_POINTS), gradients(3 * N_POINTS), hessians(6 * N_POINTS), distances(N_POINTS);
    const auto per_point = [](double time) { return time / static_cast<double>(N_POINTS) * 1e9; };

    std::vector<double> ours, peer, ratios, value, hessian, parallel;
    for (int round = 0; round < 5; ++round) {
        {
            const Pinned pinned;
            ours.push_back(per_point(seconds([&] { eval(field, points, values.data(), gradients.data()); })));
            peer.push_back(per_point(seconds([&] {
                for (std::size_t i = 0; i < N_POINTS; ++i) distances[i] = closest.distance(&points[3 * i]);
            })));
            ratios.push_back(peer.back() / ours.back());
            value.push_back(per_point(seconds([&] { eval(field, points, values.data()); })));
            hessian.push_back(
                per_point(seconds([&] { eval(field, points, values.data(), gradients.data(), hessians.data()); })));
        }
        parallel.push_back(per_point(seconds([&] {
            check(ko_field_eval_parallel(field.get(), points.data(), N_POINTS, values.data(), gradients.data(), nullptr, 2),
                  "ko_field_eval_parallel");
        })));
    }
    print_count("eval_points", N_POINTS, "uniform in the box");
    print("eval_value_and_gradient", median(ours), "ns/point");
    print("eval_cgal_closest_point_and_primitive", median(peer), "ns/point");
    print("eval_times_faster_than_cgal_median_of_5", median(ratios));
    print("eval_times_faster_than_cgal_limit", 100);
    print("eval_value_only", median(value), "ns/point");
    print("eval_value_gradient_and_hessian", median(hessian), "ns/point");
    print("eval_value_and_gradient_2_threads", median(parallel), "ns/point");
    signed_distances(bunny.mesh, {points[0], points[1], points[2]});  // builds the mesh's tree
    print("mesh_signed_distance", per_point(seconds([&] { signed_distances(bunny.mesh, points); })), "ns/point");
    // Both sought the same surface: how far they are apart near it, so that speed is not told without accuracy.
    Errors near;
    const double D = report_of(field).diagonal;
    for (std::size_t i = 0; i < N_POINTS; ++i)
        if (distances[i] < 0.01 * D) near.add((std::abs(values[i]) - distances[i]) / D);
    print("eval_against_cgal_within_0.01_rms", near.rms(), "D");
}

// Figure 5: signs against CGAL's side.
void signs(const Data &data) {
    const std::pair<const char *, const char *> shapes[] = {{"bunny_lsdo_genie", "stanford/bunny_lsdo_genie.stl"},
                                                            {"armadillo", "stanford/armadillo_cgal.off"},
                                                            {"femur", "anatomy/femur_cgal.off"},
                                                            {"bwb", "aircraft/bwb.stl"},
                                                            {"rotor", "mechanical/rotor.off"}};
    for (const auto &[name, path] : shapes) {
        const Mesh mesh = read_mesh(data(path));
        const Field field = fit(sample(mesh, N_SAMPLES), options_of());
        const std::string key = std::string("signs_") + name;
        print_fit(key, field);
        const std::vector<double> points = draw_in_box(report_of(field), N_POINTS, IN_BOX);
        const Signs found = signs_of(field, points, exact_distances(mesh, points));
        print_count(key + "_points_beyond_a_cell", found.far, "of 100000");
        print_count(key + "_wrong_beyond_a_cell", found.wrong_far, "points");
        print_count(key + "_wrong_beyond_a_cell_limit", 0, "points");
        print_count(key + "_wrong_anywhere", found.wrong, "points");
        print(key + "_farthest_wrong", found.farthest_wrong, "cells");
    }
}

// Sizes a factor 8 apart in control points; samples grow as the surface in cells does, by 4.
void growth(const Shape &bunny) {
    const struct {
        Counts grid;
        std::size_t samples;
    } sizes[] = {{{16, 16, 12}, 6250}, {BUNNY_GRID, 25000}, {{64, 62, 50}, 100000}};
    const char *const keys[] = {"growth_3k", "growth_25k", "growth_200k"};
    double n[3], time[3], iterations[3];
    const Pinned pinned;
    for (int i = 0; i < 3; ++i) {
        const Field field = fit(sample(bunny.mesh, sizes[i].samples), options_of(sizes[i].grid));
        const ko_fit_report report = report_of(field);
        n[i] = static_cast<double>(report.n_unknowns), time[i] = seconds_of(report), iterations[i] = report.iterations;
        print_fit(keys[i], field);
        print_count(std::string(keys[i]) + "_field_bytes", report.bytes, "bytes");
        const std::vector<double> points = draw_in_box(report, N_POINTS, IN_BOX);
        std::vector<double> values(N_POINTS), gradients(3 * N_POINTS), times;
        for (int round = 0; round < 5; ++round)
            times.push_back(seconds([&] { eval(field, points, values.data(), gradients.data()); }));
        print(std::string(keys[i]) + "_eval_value_and_gradient", median(times) / N_POINTS * 1e9, "ns/point");
    }
    const auto exponent = [&](const double *y, int from, int to) { return std::log(y[to] / y[from]) / std::log(n[to] / n[from]); };
    print("growth_fit_seconds_exponent_3k_25k", exponent(time, 0, 1));
    print("growth_fit_seconds_exponent_25k_200k", exponent(time, 1, 2));
    print("growth_fit_seconds_exponent", exponent(time, 0, 2));
    print("growth_fit_iterations_exponent", exponent(iterations, 0, 2));
}

void all(const Data &data) {
    print_machine();
    const Shape bunny(data(BUNNY));
    const Cloud cloud = sample(bunny.mesh, N_SAMPLES);
    bunny_accuracy(bunny, cloud);
    table_2(bunny);
    table_3(data);
    scale(cloud);
    fit_time(cloud);
    eval_time(bunny, cloud);
    signs(data);
    growth(bunny);
}

// The job of figure 3 and nothing else, to be run under a program that measures memory.
void fit_only(const Data &data) { fit(sample(read_mesh(data(BUNNY)), N_SAMPLES), options_of(BUNNY_GRID)); }

}  // namespace

int main(int argc, char **argv) {
    const bool only = argc == 3 && !std::strcmp(argv[2], "fit-only");
    if (argc != 2 && !only) {
        std::fprintf(stderr, "usage: %s DATA_FOLDER [fit-only]\n", argv[0]);
        return EXIT_FAILURE;
    }
    return run("field", [&] {
        const Data data(argv[1]);
        only ? fit_only(data) : all(data);
    });
}
