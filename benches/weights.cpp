// Sweep of the fit's weights over several shapes, as Markdown: the table that the defaults are taken from.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "library.hpp"
#include "measure.hpp"
#include "oracle.hpp"
#include "program.hpp"

#include <cinttypes>

namespace {

using namespace bench;

struct Weights {
    double normal, smooth, distance;
    std::uint32_t reweightings;
};

// What is swept: both weights of (10) at the default departures, the departures one by one at the default weights, and last the paper's
// own values.
std::vector<Weights> sweep() {
    ko_fit_options defaults;
    check(ko_fit_options_init(&defaults, sizeof defaults), "ko_fit_options_init");
    const Weights chosen = {defaults.lambda_normal, defaults.lambda_smooth, defaults.distance_weight, defaults.reweightings};
    std::vector<Weights> all;
    for (const double normal : {3e-5, 1e-4, 3e-4, 1e-3})
        for (const double smooth : {1e-11, 1e-10, 3e-10, 1e-9, 1e-8})
            all.push_back({normal, smooth, chosen.distance, chosen.reweightings});
    for (const double distance : {0.0, 5.0, 500.0}) all.push_back({chosen.normal, chosen.smooth, distance, chosen.reweightings});
    for (const std::uint32_t rounds : {0u, 1u, 6u}) all.push_back({chosen.normal, chosen.smooth, chosen.distance, rounds});
    all.push_back({chosen.normal, chosen.smooth, 0.0, 0});
    all.push_back({1e-2, 5e-4, 0.0, 0});
    return all;
}

// Points with their exact signed distances. A shape's box does not depend on the weights, so they are made once.
struct Known {
    std::vector<double> points, exact;
};

struct Shape {
    const char *name;
    Cloud cloud;
    Counts grid;
    std::vector<double> on_surface;
    Known off_surface, in_box;
};

Shape shape_of(const char *name, const std::string &path, Counts grid) {
    const Mesh mesh = read_mesh(path);
    const SurfacePoints held_out = draw_by_area(facets_of(mesh), 20000, /*seed*/ 20230601);
    Shape shape{name, sample(mesh, 25000), grid, held_out.points, {}, {}};
    const ko_fit_report box = report_of(fit(shape.cloud, options_of(grid)));
    std::copy(box.control_points, box.control_points + 3, shape.grid.begin());
    for (const double side : {-0.01, 0.01}) {
        const std::vector<double> moved = displaced(held_out, side * box.diagonal);
        shape.off_surface.points.insert(shape.off_surface.points.end(), moved.begin(), moved.end());
    }
    shape.in_box.points = draw_in_box(box, 20000, /*seed*/ 7);
    for (Known *known : {&shape.off_surface, &shape.in_box}) known->exact = exact_distances(mesh, known->points);
    return shape;
}

// A row of the table: one fit, or the mean of several.
struct Row {
    bool converged = true;
    double rms = 0, max = 0, off_rms = 0, iterations = 0;
    std::size_t wrong = 0;
};

Row measure(const Shape &shape, const Weights &weights) {
    ko_fit_options options = options_of(shape.grid);
    options.lambda_normal = weights.normal;
    options.lambda_smooth = weights.smooth;
    options.distance_weight = weights.distance;
    options.reweightings = weights.reweightings;
    Row row;
    try {
        const Field field = fit(shape.cloud, options);
        const OnSurface found = on_surface(field, shape.on_surface);
        row.rms = found.distance.rms();
        row.max = found.distance.max();
        row.off_rms = off_surface(field, shape.off_surface.points, shape.off_surface.exact).rms();
        row.wrong = signs_of(field, shape.in_box.points, shape.in_box.exact).wrong_far;
        row.iterations = report_of(field).iterations;
    } catch (const LibraryError &error) {
        // Weights that cannot be solved for are a result of the sweep.
        if (error.status != KO_ERR_NOT_CONVERGED) throw;
        row.converged = false;
    }
    return row;
}

// Geometric means over the shapes, which differ by factors; wrong signs are summed.
Row mean_of(const std::vector<Row> &rows) {
    Row mean;
    const auto root = [&](double Row::*member) {
        double logs = 0;
        for (const Row &row : rows) logs += std::log(row.*member);
        return std::exp(logs / static_cast<double>(rows.size()));
    };
    for (double Row::*member : {&Row::rms, &Row::max, &Row::off_rms, &Row::iterations}) mean.*member = root(member);
    for (const Row &row : rows) mean.wrong += row.wrong, mean.converged &= row.converged;
    return mean;
}

void print_table(const std::string &title, const std::vector<Weights> &weights, const std::vector<Row> &rows) {
    std::printf("\n## %s\n\n", title.c_str());
    std::printf("| lambda_normal | lambda_smooth | distance_weight | reweightings | rms | max | rms at +-0.01 D | wrong signs | "
                "iterations |\n");
    std::printf("|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Row &row = rows[i];
        std::printf("| %g | %g | %g | %" PRIu32 " | ", weights[i].normal, weights[i].smooth, weights[i].distance,
                    weights[i].reweightings);
        if (row.converged)
            std::printf("%.2e | %.2e | %.2e | %zu | %.0f |\n", row.rms, row.max, row.off_rms, row.wrong, row.iterations);
        else
            std::printf("not converged | | | | |\n");
    }
    std::fflush(stdout);
}

void all(const Data &data) {
    const Counts chosen = {0, 0, 0};
    const struct {
        const char *name, *path;
        Counts grid;
    } shapes[] = {{"bunny_35947", "stanford/bunny_35947.obj", {32, 31, 25}},
                  {"armadillo_cgal", "stanford/armadillo_cgal.off", {32, 32, 32}},
                  {"fandisk", "mechanical/fandisk.obj", chosen},
                  {"femur_cgal", "anatomy/femur_cgal.off", chosen},
                  {"bwb", "aircraft/bwb.stl", chosen},
                  {"rotor", "mechanical/rotor.off", chosen},
                  {"heart_sphinxsys", "anatomy/heart_sphinxsys.stl", chosen}};
    const std::vector<Weights> weights = sweep();
    std::vector<std::vector<Row>> of_weights(weights.size());

    std::printf("# Weights\n\n"
                "Fits to 25,000 samples, otherwise with the default options of keepout %s. Errors are those of |phi| / |grad phi| on the "
                "surface at 20,000\n"
                "held-out points, and of phi at 40,000 points +-0.01 D off it, in units of D; wrong signs are of 20,000 points in the box, "
                "those farther\n"
                "than one cell from the surface. The last row has the paper's weights, taken as dimensionless.\n\n"
                "The defaults are of those whose signs are all right on every shape; some of these are a little more accurate.\n",
                ko_version());
    for (const auto &from : shapes) {
        const Shape shape = shape_of(from.name, data(from.path), from.grid);
        std::vector<Row> rows;
        for (std::size_t i = 0; i < weights.size(); ++i) {
            rows.push_back(measure(shape, weights[i]));
            of_weights[i].push_back(rows.back());
            std::fprintf(stderr, "%s: %zu of %zu\n", shape.name, i + 1, weights.size());
        }
        const Counts n = shape.grid;
        print_table(std::string(shape.name) + ", " + std::to_string(n[0]) + " x " + std::to_string(n[1]) + " x " +
                        std::to_string(n[2]) + " control points", weights, rows);
    }
    std::vector<Row> means;
    for (const std::vector<Row> &rows : of_weights) means.push_back(mean_of(rows));
    print_table("Geometric mean over the shapes (wrong signs: sum)", weights, means);
}

}  // namespace

int main(int argc, char **argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: %s DATA_FOLDER\n", argv[0]);
        return EXIT_FAILURE;
    }
    return run("weights", [&] { all(Data(argv[1])); });
}
