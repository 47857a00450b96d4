// A body of 10,000 points in a field, beside the field alone at the same points: in turns, the least time of each over the rounds.
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

constexpr std::size_t POINTS = 10000;
constexpr int ROUNDS = 300;
constexpr double SHARPNESS = 500;

struct Work {
    std::string name;
    std::function<void()> run;
    double least = std::numeric_limits<double>::infinity();
};

}  // namespace

void speed(const Data &data) {
    const Mesh mesh = read_mesh(data("stanford/bunny_lsdo_genie.stl"));
    const Field field = fit(sample(mesh, 25000), options_of({32, 31, 25}));
    // A ball of points beside the bunny, as large as it: some near, some far, none all at one distance.
    const ko_fit_report report = report_of(field);
    Uniform uniform(3);
    std::vector<double> points(3 * POINTS);
    for (std::size_t i = 0; i < POINTS; ++i) {
        double length = 0;
        double *p = &points[3 * i];
        do {
            for (int a = 0; a < 3; ++a) p[a] = 2 * uniform() - 1;
            length = std::hypot(p[0], p[1], p[2]);
        } while (length > 1 || length == 0);
        for (int a = 0; a < 3; ++a) p[a] *= 0.2 * report.diagonal / length;
    }
    const Body body = body_from(3, points);
    const Constraints set = constraints_of(3);
    const std::uint32_t frame = add_frame(set, KO_ROTATION_QUATERNION, KO_SCALE_ONE);
    keep(set, body, frame, field, KO_WORLD, aggregation_of(KO_AGGREGATE_KS, SHARPNESS));
    std::vector<double> x(7);
    for (int a = 0; a < 3; ++a) x[a] = 0.5 * (report.box_min[a] + report.box_max[a]);
    x[3] = 1;
    // The same points in the world, for the field alone.
    std::vector<double> placed = points, values(POINTS), gradients(3 * POINTS), hessians(6 * POINTS);
    for (std::size_t i = 0; i < placed.size(); ++i) placed[i] += x[i % 3];
    const Sizes sizes = sizes_of(set);
    std::vector<double> value(1), entries(sizes.jacobian), hessian(sizes.hessian);
    const double lambda = 1;
    const auto c = set.get();
    std::vector<Work> works = {
        {"field_values", [&] { eval(field, placed, values.data()); }},
        {"field_gradients", [&] { eval(field, placed, values.data(), gradients.data()); }},
        {"field_hessians", [&] { eval(field, placed, values.data(), gradients.data(), hessians.data()); }},
        {"body_value", [&] { check(ko_constraints_values(c, x.data(), 7, 1, value.data()), "ko_constraints_values"); }},
        {"body_value_and_jacobian",
         [&] {
             check(ko_constraints_values_and_jacobian(c, x.data(), 7, 1, value.data(), entries.size(), entries.data()),
                   "ko_constraints_values_and_jacobian");
         }},
        {"body_hessian",
         [&] {
             check(ko_constraints_hessian(c, x.data(), 7, &lambda, 1, hessian.size(), hessian.data()), "ko_constraints_hessian");
         }},
    };
    const Pinned pinned;
    for (int round = 0; round < ROUNDS; ++round)
        for (Work &work : works) work.least = std::min(work.least, seconds(work.run));
    print_count("speed_points", POINTS);
    for (const Work &work : works) print("speed_" + work.name, work.least * 1e9 / POINTS, "ns a point");
    print("speed_value_over_field", works[3].least / works[0].least, "times");
    print("speed_value_and_jacobian_over_field", works[4].least / works[1].least, "times");
    print("speed_value_and_jacobian_over_field_limit", 1.4, "times");
    print("speed_hessian_over_field", works[5].least / works[2].least, "times");
    // What the aggregate costs in accuracy.
    const double least = *std::min_element(values.begin(), values.end());
    print("speed_least_phi", least / report.diagonal, "D");
    print("speed_ks_below_it_by", (least - value[0]) / report.diagonal, "D");
}

}  // namespace bench
