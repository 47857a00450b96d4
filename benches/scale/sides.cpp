// Where sides go wrong: signs of points all around closed shapes, and parts of the zero level set that the shape has not.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "../measure.hpp"
#include "../points.hpp"

namespace bench {

namespace {

constexpr std::size_t SAMPLES = 50000, POINTS = 20000;  // points all over the box; as many within REACH of the surface
constexpr double REACH = 0.08, SLACK = 2e-3;            // in D; a sign within the slack of the surface does not count

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

void sides_of(const std::string &key, const Mesh &mesh, const Cloud &cloud, double max_error) {
    ko_fit_options options = options_of();
    options.max_error = max_error;
    options.tolerance = 1e-3;
    const Field field = fit(cloud, options);
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
    print(key + "_control_points", static_cast<double>(report.n_unknowns));
    print_count(key + "_wrong_signs", wrong);
    print(key + "_farthest_wrong_sign", farthest, "D");
    print_count(key + "_components", report_of(owned).n_components);
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
        sides_of(key + "_one_grid", mesh, cloud, 0);
        sides_of(key + "_refined", mesh, cloud, 1e-3);
    }
}

}  // namespace bench
