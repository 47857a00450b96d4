// Paper 000, Figure 8: time of an evaluation and errors against the number of samples of the bunny, of a field and of explicit formulations.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "../points.hpp"
#include "../stats.hpp"
#include "../timing.hpp"
#include "set.hpp"

#include <functional>
#include <limits>

namespace bench {

namespace {

// This bunny is closed, so that its sides are those of its triangles; the paper's of 35,947 points has five holes.
constexpr const char *BUNNY = "stanford/bunny_lsdo_genie.stl";
const std::size_t SAMPLES[] = {100, 316, 1000, 3162, 10000, 31623, 100000};
struct Grid {
    const char *name;
    Counts control_points;
};

// As in Figure 8, and three times as fine: errors of the first stop falling where its cells are what limits them.
const Grid GRIDS[] = {{"field", {31, 31, 26}}, {"fine_field", {87, 87, 72}}};
// Terms that a formula over all points may take for a measurement of time.
constexpr double TERMS = 4e7;
constexpr std::size_t HELD_OUT = 1000, MOST_TIMED = 10000;
constexpr int ROUNDS = 3;
// On the surface, and beside it in units of D.
const double OFFSETS[] = {0, 0.005, -0.005, 0.01, -0.01};
const char *const OFFSET_NAMES[] = {"on_surface", "plus_0.005", "minus_0.005", "plus_0.01", "minus_0.01"};

struct Formula {
    const char *name;
    std::int32_t kind;
    std::uint32_t nearest;
    bool errors;
};

// Lin's is no distance: the paper leaves its errors out as well.
const Formula FORMULAE[] = {
    {"hicken_kaur_linear", KO_EXPLICIT_HICKEN_KAUR_LINEAR, 0, true},
    {"hicken_kaur_linear_10_nearest", KO_EXPLICIT_HICKEN_KAUR_LINEAR, 10, true},
    {"hicken_kaur_quadratic", KO_EXPLICIT_HICKEN_KAUR_QUADRATIC, 0, true},
    {"hicken_kaur_quadratic_10_nearest", KO_EXPLICIT_HICKEN_KAUR_QUADRATIC, 10, true},
    {"lin", KO_EXPLICIT_LIN, 0, false},
};

Explicit explicit_of(const Cloud &cloud, const Formula &formula) {
    ko_explicit_options options;
    check(ko_explicit_options_init(&options, sizeof options), "ko_explicit_options_init");
    options.formulation = formula.kind;
    options.n_nearest = formula.nearest;
    ko_explicit *made = nullptr;
    check(ko_explicit_create(cloud.get(), &options, &made), "ko_explicit_create");
    return Explicit(made);
}

// Values, and gradients where wanted, at points [n x 3].
using Evaluate = std::function<void(const double *points, std::size_t n, double *values, double *gradients)>;

// What is timed: value and gradient, of points near the surface, the least over some rounds.
double time_of(const Evaluate &evaluate, const std::vector<double> &points, std::size_t n) {
    std::vector<double> values(n), gradients(3 * n);
    double least = std::numeric_limits<double>::infinity();
    for (int round = 0; round < ROUNDS; ++round)
        least = std::min(least, seconds([&] { evaluate(points.data(), n, values.data(), gradients.data()); }));
    return least / static_cast<double>(n) * 1e9;
}

struct Line {
    std::string name;
    std::vector<double> time;
};

}  // namespace

void figure_8(const Data &data) {
    const Mesh mesh = read_mesh(data(BUNNY));
    const SurfacePoints held_out = draw_by_area(facets_of(mesh), HELD_OUT, /*seed*/ 23);
    const ko_mesh_report report = report_of(mesh);
    double squared = 0;
    for (int a = 0; a < 3; ++a) squared += std::pow(report.bounds_max[a] - report.bounds_min[a], 2);
    const double D = std::sqrt(squared);
    std::vector<std::vector<double>> points, exact;
    for (const double offset : OFFSETS) {
        points.push_back(displaced(held_out, offset * D));
        exact.push_back(signed_distances(mesh, points.back()));
    }
    // On the surface the distance is 0 by what was drawn, whatever its rounding.
    std::fill(exact[0].begin(), exact[0].end(), 0.0);
    // Near the surface, within 0.01 D, as the points of a constraint that is active are.
    const SurfacePoints drawn = draw_by_area(facets_of(mesh), MOST_TIMED, /*seed*/ 29);
    std::vector<double> timed = drawn.points;
    Uniform uniform(31);
    for (std::size_t i = 0; i < MOST_TIMED; ++i) {
        const double by = (2 * uniform() - 1) * 0.01 * D;
        for (int a = 0; a < 3; ++a) timed[3 * i + a] += by * drawn.normals[3 * i + a];
    }
    print("figure_8_mesh", std::string(BUNNY));
    print_count("figure_8_held_out_points", HELD_OUT);
    print("figure_8_timed", std::string("value and gradient, one thread, points within 0.01 D of the surface"));

    std::vector<Line> lines;
    for (const Grid &grid : GRIDS) lines.push_back({grid.name, {}});
    for (const Formula &formula : FORMULAE) lines.push_back({formula.name, {}});
    const Pinned pinned;
    for (const std::size_t n : SAMPLES) {
        const Cloud cloud = sample(mesh, n);
        const std::string of_n = "_n_" + std::to_string(n);
        const auto measure = [&](Line &line, const Evaluate &evaluate, std::size_t n_timed, bool errors) {
            const std::string key = "figure_8_" + line.name + of_n;
            line.time.push_back(time_of(evaluate, timed, n_timed));
            print(key + "_time", line.time.back(), "ns a point");
            for (std::size_t k = 0; errors && k < points.size(); ++k) {
                std::vector<double> values(HELD_OUT);
                evaluate(points[k].data(), HELD_OUT, values.data(), nullptr);
                Errors of;
                for (std::size_t i = 0; i < HELD_OUT; ++i) of.add((values[i] - exact[k][i]) / D);
                print(key + "_" + OFFSET_NAMES[k] + "_rms", of.rms(), "D");
            }
        };
        for (std::size_t g = 0; g < std::size(GRIDS); ++g) {
            const Field field = fit(cloud, options_of(GRIDS[g].control_points));
            measure(lines[g], [&](const double *p, std::size_t count, double *values, double *gradients) {
                check(ko_field_eval(field.get(), p, count, values, gradients, nullptr), "ko_field_eval");
            }, MOST_TIMED, true);
        }
        for (std::size_t f = 0; f < std::size(FORMULAE); ++f) {
            const Explicit formula = explicit_of(cloud, FORMULAE[f]);
            if (f == 0) {
                double smoothing = 0;
                check(ko_explicit_get_smoothing(formula.get(), &smoothing), "ko_explicit_get_smoothing");
                print("figure_8_hicken_kaur" + of_n + "_smoothing", smoothing, "/ D");
            }
            const double affordable = TERMS / static_cast<double>(FORMULAE[f].nearest > 0 ? 1000 : n);
            const auto n_timed = static_cast<std::size_t>(std::clamp(affordable, 100.0, static_cast<double>(MOST_TIMED)));
            measure(lines[std::size(GRIDS) + f], [&](const double *p, std::size_t count, double *values, double *gradients) {
                check(ko_explicit_eval(formula.get(), p, count, values, gradients), "ko_explicit_eval");
            }, n_timed, FORMULAE[f].errors);
        }
    }
    // Of the last two decades: below, the work that does not grow counts.
    const std::size_t last = std::size(SAMPLES) - 1, first = last - 4;
    for (const Line &line : lines) {
        const double decades = std::log(static_cast<double>(SAMPLES[last]) / static_cast<double>(SAMPLES[first]));
        print("figure_8_" + line.name + "_time_exponent", std::log(line.time[last] / line.time[first]) / decades);
    }
    print("figure_8_hicken_kaur_linear_over_field_time", lines[std::size(GRIDS)].time[last] / lines[0].time[last], "times at the most samples");
}

}  // namespace bench
