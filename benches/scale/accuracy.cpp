// Accuracy against control points, beside the reconstruction programs: distance of 60,000 held-out points to the surface.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "../measure.hpp"
#include "../timing.hpp"

namespace bench {

namespace {

// As fractions of D, with processor seconds; one thread each.
struct Figures {
    double rms, max, seconds;
};

struct Reference {
    const char *key, *file;
    std::size_t samples;  // 0: the mesh's vertices
    // Screened Poisson (Kazhdan and Hoppe 2013) and SSD (Calakli and Taubin 2011) at depth 8 on samples of the mesh with normals.
    Figures poisson, ssd, goal;
};

const Reference SHAPES[] = {
    {"armadillo", "stanford/armadillo_cgal.off", 100000, {2.40e-4, 1.67e-3, 11.6}, {2.41e-4, 1.54e-3, 18.7}, {1.5e-4, 1.0e-3, 8}},
    {"fandisk", "mechanical/fandisk.obj", 100000, {1.85e-4, 2.65e-3, 12.9}, {1.51e-4, 2.11e-3, 20.7}, {1.0e-4, 1.5e-3, 8}},
    {"bunny", "stanford/bunny_lsdo_genie.stl", 50000, {2.00e-4, 2.48e-3, 13.2}, {1.70e-4, 2.02e-3, 20.4}, {1.2e-4, 1.4e-3, 8}},
    {"dragon", "stanford/dragon_vrip.ply.gz", 0, {2.9e-4, 7.8e-3, 11.5}, {4.3e-4, 9.2e-3, 23}, {2.0e-4, 5e-3, 15}},
};

// Weights for fine grids and clouds that are to be trusted.
constexpr double LAMBDA_NORMAL = 2e-6, LAMBDA_SMOOTH = 3e-12;

// Refined fits are hardly less accurate with this than with the default 1e-4, which takes twice as long.
constexpr double REFINED_TOLERANCE = 1e-3;

void print_figures(const std::string &key, const Figures &figures) {
    print(key + "_rms", figures.rms, "D");
    print(key + "_max", figures.max, "D");
    print(key + "_processor_seconds", figures.seconds, "s");
}

// Vertices with the mean normals of their triangles by area.
Cloud vertices_of(const Facets &mesh) {
    std::vector<double> normals(mesh.vertices.size());
    for (std::size_t t = 0; t < mesh.size(); ++t) {
        const std::array<double, 3> area = area_of(mesh, t);
        for (std::size_t corner = 0; corner < 3; ++corner)
            for (std::size_t a = 0; a < 3; ++a) normals[3 * mesh.facets[3 * t + corner] + a] += area[a];
    }
    std::vector<double> points, kept;
    for (std::size_t v = 0; v < normals.size() / 3; ++v) {
        const double *n = &normals[3 * v], length = std::hypot(n[0], n[1], n[2]);
        if (!(length > 0)) continue;
        points.insert(points.end(), &mesh.vertices[3 * v], &mesh.vertices[3 * v] + 3);
        for (int a = 0; a < 3; ++a) kept.push_back(n[a] / length);
    }
    return cloud_from(3, points, kept);
}

// Counts of near-cubes, `n` in all at most.
Counts counts_of(const std::vector<double> &vertices, double n) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        low[i % 3] = std::min(low[i % 3], vertices[i]);
        high[i % 3] = std::max(high[i % 3], vertices[i]);
    }
    Counts counts{};
    for (double cell = 1e-3 * (high[0] - low[0] + high[1] - low[1] + high[2] - low[2]);; cell *= 1.002) {
        double product = 1;
        for (int a = 0; a < 3; ++a) {
            counts[a] = static_cast<std::uint32_t>(std::lround(1.15 * (high[a] - low[a]) / cell)) + 3;
            product *= counts[a];
        }
        if (product <= n) return counts;
    }
}

// Prints how far the field fitted with `options` is from the held-out points, under the key that `key_of` has for its report.
template <class KeyOf>
ko_fit_report measured(const Cloud &cloud, const ko_fit_options &options, const SurfacePoints &held_out, const KeyOf &key_of) {
    Field field;
    Figures found{};
    found.seconds = processor_seconds([&] { field = fit(cloud, options); });
    const OnSurface errors = on_surface(field, held_out.points);
    found.rms = errors.distance.rms(), found.max = errors.distance.max();
    const ko_fit_report report = report_of(field);
    const std::string key = key_of(report);
    print_figures(key, found);
    print(key + "_mean_gradient", errors.mean_gradient);
    return report;
}

// A fit that refines: all options but these are the defaults.
void refined(const std::string &shape, const Cloud &cloud, const SurfacePoints &held_out, double max_error) {
    ko_fit_options options = options_of({0, 0, 0});
    options.max_error = max_error;
    options.tolerance = REFINED_TOLERANCE;
    char name[16];
    std::snprintf(name, sizeof name, "%.0e", max_error);
    const std::string key = "accuracy_" + shape + "_refined_" + name;
    const ko_fit_report report = measured(cloud, options, held_out, [&](const ko_fit_report &) { return key; });
    print(key + "_max_at_the_points", report.max, "D");
    print(key + "_control_points", static_cast<double>(report.n_unknowns));
    print(key + "_levels", static_cast<double>(report.n_levels));
    print_count(key + "_iterations", report.iterations);
    print(key + "_megabytes", report.bytes / 1e6, "MB");
}

}  // namespace

void accuracy(const Data &data) {
    print("accuracy_lambda_normal", LAMBDA_NORMAL);
    print("accuracy_lambda_smooth", LAMBDA_SMOOTH);
    print("accuracy_refined_tolerance", REFINED_TOLERANCE);
    for (const Reference &shape : SHAPES) {
        const Mesh mesh = read_mesh(data(shape.file));
        const Facets facets = facets_of(mesh);
        const Cloud cloud = shape.samples ? sample(mesh, shape.samples) : vertices_of(facets);
        const SurfacePoints held_out = draw_by_area(facets, 60000, /*seed*/ 20230601);
        for (const double n : {1.25e5, 2.5e5, 5e5, 1e6, 1.25e6}) {
            ko_fit_options options = options_of(counts_of(facets.vertices, n));
            options.lambda_normal = LAMBDA_NORMAL;
            options.lambda_smooth = LAMBDA_SMOOTH;
            measured(cloud, options, held_out, [&](const ko_fit_report &report) {
                return std::string("accuracy_") + shape.key + "_" + std::to_string(report.n_unknowns);
            });
        }
        for (const double max_error : {2e-3, 1e-3, 6e-4}) refined(shape.key, cloud, held_out, max_error);
        print_figures(std::string("accuracy_") + shape.key + "_poisson", shape.poisson);
        print_figures(std::string("accuracy_") + shape.key + "_ssd", shape.ssd);
        print_figures(std::string("accuracy_") + shape.key + "_goal", shape.goal);
    }
}

}  // namespace bench
