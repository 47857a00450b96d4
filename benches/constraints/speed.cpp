// A body of 10,000 points in a field, beside the field alone at the same points, and in several fields as one, beside each by itself: in
// turns, the least time of each over the rounds.
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

// Fields that a body is kept in, each by itself and as one.
constexpr std::size_t SEVERAL[] = {2, 8};

struct Work {
    std::string name;
    std::function<void()> run;
    double least = std::numeric_limits<double>::infinity();
};

void measure(std::vector<Work> &works) {
    const Pinned pinned;
    for (int round = 0; round < ROUNDS; ++round)
        for (Work &work : works) work.least = std::min(work.least, seconds(work.run));
    for (const Work &work : works) print("speed_" + work.name, work.least * 1e9 / POINTS, "ns a point");
}

Field fit_to(const Mesh &mesh, std::size_t n_samples) { return fit(sample(mesh, n_samples), options_of({32, 31, 25})); }

// A ball of points beside the bunny, as large as it: some near, some far, none all at one distance.
std::vector<double> ball_of(double diagonal) {
    Uniform uniform(3);
    std::vector<double> points(3 * POINTS);
    for (std::size_t i = 0; i < POINTS; ++i) {
        double length = 0;
        double *p = &points[3 * i];
        do {
            for (int a = 0; a < 3; ++a) p[a] = 2 * uniform() - 1;
            length = std::hypot(p[0], p[1], p[2]);
        } while (length > 1 || length == 0);
        for (int a = 0; a < 3; ++a) p[a] *= 0.2 * diagonal / length;
    }
    return points;
}

// Not turned, in the middle of the box.
std::vector<double> pose_in(const ko_fit_report &report) {
    std::vector<double> x(7);
    for (int a = 0; a < 3; ++a) x[a] = 0.5 * (report.box_min[a] + report.box_max[a]);
    x[3] = 1;
    return x;
}

// A set of one body's constraints, and room for what is evaluated of it.
class Evaluated {
public:
    Evaluated() : set(constraints_of(3)), frame(add_frame(set, KO_ROTATION_QUATERNION, KO_SCALE_ONE)) {}

    // Once all is kept.
    void make_room() {
        const Sizes sizes = sizes_of(set);
        values_.resize(sizes.values), entries_.resize(sizes.jacobian), hessian_.resize(sizes.hessian);
        lambda_.assign(sizes.values, 1.0);
    }

    void evaluate(const std::vector<double> &x) {
        check(ko_constraints_values(set.get(), x.data(), x.size(), values_.size(), values_.data()), "ko_constraints_values");
    }

    void differentiate(const std::vector<double> &x) {
        check(ko_constraints_values_and_jacobian(set.get(), x.data(), x.size(), values_.size(), values_.data(), entries_.size(),
                                                 entries_.data()),
              "ko_constraints_values_and_jacobian");
    }

    void differentiate_twice(const std::vector<double> &x) {
        check(ko_constraints_hessian(set.get(), x.data(), x.size(), lambda_.data(), lambda_.size(), hessian_.size(), hessian_.data()),
              "ko_constraints_hessian");
    }

    double value() const { return values_.at(0); }

    const Constraints set;
    const std::uint32_t frame;

private:
    std::vector<double> values_, entries_, hessian_, lambda_;
};

// The union of fields beside the fields one by one, each of a cloud of its own.
void in_several_fields(const Mesh &mesh, std::size_t n_fields, const std::vector<double> &points, const std::vector<double> &x) {
    std::vector<Field> fields;
    std::vector<const ko_field *> handles;
    const ko_aggregation ks = aggregation_of(KO_AGGREGATE_KS, SHARPNESS);
    const Body body = body_from(3, points);
    Evaluated each, as_one;
    for (std::size_t f = 0; f < n_fields; ++f) {
        fields.push_back(fit_to(mesh, 25000 - 100 * f));
        handles.push_back(fields[f].get());
        keep(each.set, body, each.frame, fields[f], KO_WORLD, ks);
    }
    keep_in_fields(as_one.set, body, as_one.frame, handles, KO_LARGEST, ks, KO_WORLD, ks);
    each.make_room(), as_one.make_room();
    const std::string of = std::to_string(n_fields) + "_fields_";
    std::vector<Work> works = {
        {of + "values", [&] { each.evaluate(x); }},
        {of + "values_and_jacobian", [&] { each.differentiate(x); }},
        {of + "hessian", [&] { each.differentiate_twice(x); }},
        {of + "as_one_value", [&] { as_one.evaluate(x); }},
        {of + "as_one_value_and_jacobian", [&] { as_one.differentiate(x); }},
        {of + "as_one_hessian", [&] { as_one.differentiate_twice(x); }},
    };
    measure(works);
    const char *names[] = {"value", "value_and_jacobian", "hessian"};
    for (int i = 0; i < 3; ++i) print("speed_" + of + "as_one_" + names[i] + "_over_each", works[i + 3].least / works[i].least, "times");
}

}  // namespace

void speed(const Data &data) {
    const Mesh mesh = read_mesh(data("stanford/bunny_lsdo_genie.stl"));
    const Field field = fit_to(mesh, 25000);
    const ko_fit_report report = report_of(field);
    const std::vector<double> points = ball_of(report.diagonal), x = pose_in(report);
    const Body body = body_from(3, points);
    Evaluated set;
    keep(set.set, body, set.frame, field, KO_WORLD, aggregation_of(KO_AGGREGATE_KS, SHARPNESS));
    set.make_room();
    // The same points in the world, for the field alone.
    std::vector<double> placed = points, values(POINTS), gradients(3 * POINTS), hessians(6 * POINTS);
    for (std::size_t i = 0; i < placed.size(); ++i) placed[i] += x[i % 3];
    std::vector<Work> works = {
        {"field_values", [&] { eval(field, placed, values.data()); }},
        {"field_gradients", [&] { eval(field, placed, values.data(), gradients.data()); }},
        {"field_hessians", [&] { eval(field, placed, values.data(), gradients.data(), hessians.data()); }},
        {"body_value", [&] { set.evaluate(x); }},
        {"body_value_and_jacobian", [&] { set.differentiate(x); }},
        {"body_hessian", [&] { set.differentiate_twice(x); }},
    };
    print_count("speed_points", POINTS);
    measure(works);
    print("speed_value_over_field", works[3].least / works[0].least, "times");
    print("speed_value_and_jacobian_over_field", works[4].least / works[1].least, "times");
    print("speed_value_and_jacobian_over_field_limit", 1.4, "times");
    print("speed_hessian_over_field", works[5].least / works[2].least, "times");
    // What the aggregate costs in accuracy.
    const double least = *std::min_element(values.begin(), values.end());
    print("speed_least_phi", least / report.diagonal, "D");
    print("speed_ks_below_it_by", (least - set.value()) / report.diagonal, "D");
    for (const std::size_t n_fields : SEVERAL) in_several_fields(mesh, n_fields, points, x);
}

}  // namespace bench
