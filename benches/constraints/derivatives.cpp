// Jacobians, their products and Hessians against central differences, over random configurations of bodies, points and fields that move; of
// aggregates of plain values, and gradients of the formulations to compare with.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "../points.hpp"
#include "../stats.hpp"
#include "set.hpp"

#include <cmath>

namespace bench {

namespace {

constexpr int CONFIGURATIONS = 10000;
// Third derivatives jump at knots and faces: a difference of gradients across one is off by that jump times the step.
constexpr double STEP = 2e-6, STEP_OF_GRADIENTS = 1e-7;
constexpr double LIMIT_OF_GRADIENTS = 1e-7, LIMIT_OF_HESSIANS = 1e-5;
const std::int32_t KINDS[] = {KO_AGGREGATE_NONE, KO_AGGREGATE_KS, KO_AGGREGATE_INDUCED_EXPONENTIAL, KO_AGGREGATE_P_NORM};
const char *const NAMES[] = {"none", "ks", "induced_exponential", "p_norm"};

// A field of waves, so that every configuration has third derivatives of its own.
Field made_up_field(std::uint32_t dim, Uniform &uniform) {
    const double lower[3] = {-1, -1.1, -1.2}, upper[3] = {1, 1.1, 1.2};
    const std::uint32_t counts[3] = {7, 8, 9};
    std::size_t n = 1;
    for (std::uint32_t a = 0; a < dim; ++a) n *= counts[a];
    std::vector<double> control_points(n);
    for (double &c : control_points) c = 2 * uniform() - 1;
    ko_field *made = nullptr;
    check(ko_field_from_control_points(dim, counts, lower, upper, KO_FEASIBLE_OUTSIDE, 2, control_points.data(), n, &made),
          "ko_field_from_control_points");
    return Field(made);
}

struct Pose {
    std::int32_t rotation, scale;
};

std::vector<Pose> poses_of(std::uint32_t dim) {
    std::vector<Pose> poses;
    for (const std::int32_t scale : {KO_SCALE_ONE, KO_SCALE_FREE}) {
        poses.push_back({KO_ROTATION_NONE, scale});
        if (dim == 2) poses.push_back({KO_ROTATION_ANGLE, scale});
        if (dim == 3) poses.push_back({KO_ROTATION_QUATERNION, scale});
        if (dim == 3) poses.push_back({KO_ROTATION_VECTOR, scale});
    }
    return poses;
}

void add_parameters(std::uint32_t dim, const Pose &pose, Uniform &uniform, std::vector<double> &x) {
    const auto between = [&](double a, double b) { return a + (b - a) * uniform(); };
    for (std::uint32_t a = 0; a < dim; ++a) x.push_back(between(-0.8, 0.8));
    const int n = pose.rotation == KO_ROTATION_QUATERNION ? 4 : pose.rotation == KO_ROTATION_VECTOR ? 3 : pose.rotation == KO_ROTATION_ANGLE;
    for (int k = 0; k < n; ++k) x.push_back(between(-0.7, 0.7) + (n == 4 && k == 0 ? 1 : 0));
    if (pose.scale == KO_SCALE_FREE) x.push_back(between(0.7, 1.4));
}

// Points of a body: inside the field's box, outside, and some on its faces for a frame that stands at the origin.
std::vector<double> body_points(std::uint32_t dim, std::size_t n, Uniform &uniform) {
    std::vector<double> points(dim * n);
    for (std::size_t i = 0; i < points.size(); ++i) {
        points[i] = 2.6 * uniform() - 1.3;
        if (uniform() < 0.1) points[i] = uniform() < 0.5 ? -1 - 0.1 * static_cast<double>(i % dim) : 1 + 0.1 * static_cast<double>(i % dim);
    }
    return points;
}

double largest(const std::vector<double> &v) {
    double most = 0;
    for (const double x : v) most = std::max(most, std::abs(x));
    return most;
}

struct Worst {
    double gradient = 0, hessian = 0;
    double products = 0;  // J v and J^T w, off sums over the dense Jacobian
};

double products_off(const Constraints &set, const std::vector<double> &x, const std::vector<double> &jacobian, std::vector<double> w,
                    Uniform &uniform) {
    const std::size_t n = x.size(), m = w.size();
    std::vector<double> v(n), along(m), back(n);
    for (double &k : v) k = 2 * uniform() - 1;
    check(ko_constraints_jacobian_times(set.get(), x.data(), v.data(), n, m, along.data()), "ko_constraints_jacobian_times");
    check(ko_constraints_transposed_jacobian_times(set.get(), x.data(), n, w.data(), m, back.data()),
          "ko_constraints_transposed_jacobian_times");
    for (std::size_t row = 0; row < m; ++row)
        for (std::size_t k = 0; k < n; ++k) {
            along[row] -= jacobian[row * n + k] * v[k];
            back[k] -= jacobian[row * n + k] * w[row];
        }
    return std::max(largest(along), largest(back));
}

// The largest difference of each, over the largest entry, or over 1 where that is less.
Worst compare(const Constraints &set, const std::vector<double> &x, Uniform &uniform) {
    const std::size_t n = x.size(), m = sizes_of(set).values;
    std::vector<double> lambda(m);
    for (double &l : lambda) l = 2 * uniform() - 1;
    const std::vector<double> jacobian = dense_jacobian(set, x), hessian = dense_hessian(set, x, lambda);
    const auto gradient_at = [&](const std::vector<double> &x) {
        const std::vector<double> jacobian = dense_jacobian(set, x);
        std::vector<double> sum(n);
        for (std::size_t row = 0; row < m; ++row)
            for (std::size_t k = 0; k < n; ++k) sum[k] += lambda[row] * jacobian[row * n + k];
        return sum;
    };
    const auto moved = [&](std::size_t k, double by) {
        std::vector<double> to = x;
        to[k] += by;
        return to;
    };
    Worst worst;
    for (std::size_t k = 0; k < n; ++k) {
        const std::vector<double> up = values_of(set, moved(k, STEP)), down = values_of(set, moved(k, -STEP));
        for (std::size_t row = 0; row < m; ++row)
            worst.gradient = std::max(worst.gradient, std::abs((up[row] - down[row]) / (2 * STEP) - jacobian[row * n + k]));
        const double h = STEP_OF_GRADIENTS;
        const std::vector<double> g_up = gradient_at(moved(k, h)), g_down = gradient_at(moved(k, -h));
        for (std::size_t l = 0; l < n; ++l)
            worst.hessian = std::max(worst.hessian, std::abs((g_up[l] - g_down[l]) / (2 * h) - hessian[k * n + l]));
    }
    worst.products = products_off(set, x, jacobian, lambda, uniform) / std::max(1.0, largest(jacobian));
    worst.gradient /= std::max(1.0, largest(jacobian));
    worst.hessian /= std::max(1.0, largest(hessian));
    return worst;
}

void take_in(Worst &worst, const Worst &found) {
    worst.gradient = std::max(worst.gradient, found.gradient);
    worst.hessian = std::max(worst.hessian, found.hessian);
    worst.products = std::max(worst.products, found.products);
}

// ko_aggregate of up to six values.
Worst compare_aggregate(const ko_aggregation &of, std::int32_t extreme, Uniform &uniform) {
    const std::size_t n = 1 + static_cast<std::size_t>(6 * uniform());
    std::vector<double> values(n), gradient(n), hessian(n * (n + 1) / 2), off(n * (n + 1) / 2);
    for (double &v : values) v = 2 * uniform() - 1;
    const auto at = [&](std::size_t k, double by, std::vector<double> &gradient) {
        std::vector<double> moved = values;
        moved[k] += by;
        double value = 0;
        check(ko_aggregate(&of, extreme, 0.7, moved.data(), n, &value, gradient.data(), nullptr), "ko_aggregate");
        return value;
    };
    double value = 0;
    check(ko_aggregate(&of, extreme, 0.7, values.data(), n, &value, gradient.data(), hessian.data()), "ko_aggregate");
    Worst worst;
    std::vector<double> up(n), down(n);
    for (std::size_t k = 0; k < n; ++k) {
        const double slope = (at(k, STEP, up) - at(k, -STEP, down)) / (2 * STEP);
        worst.gradient = std::max(worst.gradient, std::abs(slope - gradient[k]));
        at(k, STEP_OF_GRADIENTS, up);
        at(k, -STEP_OF_GRADIENTS, down);
        for (std::size_t l = 0; l <= k; ++l) {
            const double second = (up[l] - down[l]) / (2 * STEP_OF_GRADIENTS);
            worst.hessian = std::max(worst.hessian, std::abs(second - hessian[k * (k + 1) / 2 + l]));
        }
    }
    worst.gradient /= std::max(1.0, largest(gradient));
    worst.hessian /= std::max(1.0, largest(hessian));
    return worst;
}

// The formulations to compare with that are smooth over all points, of random clouds, at random points.
void compare_formulations(std::uint32_t dim, Uniform &uniform) {
    const struct {
        const char *name;
        std::int32_t kind;
    } formulations[] = {{"hicken_kaur_linear", KO_EXPLICIT_HICKEN_KAUR_LINEAR},
                        {"hicken_kaur_quadratic", KO_EXPLICIT_HICKEN_KAUR_QUADRATIC},
                        {"lin", KO_EXPLICIT_LIN}};
    const std::size_t n = 60, n_places = 20;
    for (const auto &formulation : formulations) {
        double worst = 0;
        for (int i = 0; i < CONFIGURATIONS / 2 / static_cast<int>(n_places); ++i) {
            std::vector<double> points(dim * n), normals(dim * n), x(dim * n_places);
            // Around a ball, uneven by a tenth, so that the quadratic formula finds curvatures that are a shape's.
            for (std::size_t p = 0; p < n; ++p) {
                double squared = 0;
                for (std::uint32_t a = 0; a < dim; ++a) squared += std::pow(normals[dim * p + a] = 2 * uniform() - 1, 2);
                const double radius = (0.95 + 0.1 * uniform()) / std::sqrt(squared);
                for (std::uint32_t a = 0; a < dim; ++a) points[dim * p + a] = radius * normals[dim * p + a];
            }
            for (double &at : x) at = 3 * uniform() - 1.5;
            const Cloud cloud = cloud_from(dim, points, normals);
            ko_explicit_options options;
            check(ko_explicit_options_init(&options, sizeof options), "ko_explicit_options_init");
            options.formulation = formulation.kind;
            options.smoothing = 5 + 20 * uniform();
            ko_explicit *made = nullptr;
            check(ko_explicit_create(cloud.get(), &options, &made), "ko_explicit_create");
            const Explicit formula(made);
            std::vector<double> values(n_places), gradients(dim * n_places), up(n_places), down(n_places);
            const auto eval = [&](const std::vector<double> &x, std::vector<double> &values, double *gradients) {
                check(ko_explicit_eval(formula.get(), x.data(), n_places, values.data(), gradients), "ko_explicit_eval");
            };
            eval(x, values, gradients.data());
            for (std::uint32_t a = 0; a < dim; ++a) {
                const auto moved = [&](double by) {
                    std::vector<double> to = x;
                    for (std::size_t p = 0; p < n_places; ++p) to[dim * p + a] += by;
                    return to;
                };
                eval(moved(STEP), up, nullptr);
                eval(moved(-STEP), down, nullptr);
                for (std::size_t p = 0; p < n_places; ++p) {
                    const double slope = (up[p] - down[p]) / (2 * STEP);
                    worst = std::max(worst, std::abs(slope - gradients[dim * p + a]) / std::max(1.0, largest(gradients)));
                }
            }
        }
        print("derivatives_" + std::to_string(dim) + "d_" + formulation.name + "_gradient_error", worst);
    }
}

}  // namespace

void derivatives(const Data &) {
    // Combinations draw from numbers of their own.
    Uniform uniform(5), others(6);
    print_count("derivatives_configurations", CONFIGURATIONS);
    for (const std::uint32_t dim : {2u, 3u}) {
        std::vector<Field> fields;
        for (int i = 0; i < 20; ++i) fields.push_back(made_up_field(dim, uniform));
        const std::vector<Pose> poses = poses_of(dim);
        Worst of_kind[4], of_combination[4], of_aggregate;
        for (int i = 0; i < CONFIGURATIONS / 2; ++i) {
            const Pose &a = poses[i % poses.size()], &b = poses[i / poses.size() % poses.size()];
            const Constraints set = constraints_of(dim);
            const std::uint32_t frames[] = {add_frame(set, a.rotation, a.scale), add_frame(set, b.rotation, b.scale)};
            const Body body = body_from(dim, body_points(dim, 1 + i % 5, uniform));
            const int kind = i / 7 % 4;
            const ko_aggregation of = aggregation_of(KINDS[kind], 1 + 11 * uniform(), uniform() < 0.5 ? KO_BELOW : KO_ABOVE);
            keep(set, body, frames[0], fields[i % 20], frames[1], of);
            keep(set, body, frames[1], fields[(i + 7) % 20], frames[0], of);
            keep(set, body, frames[0], fields[(i + 3) % 20], KO_WORLD, of);
            // Points that are variables, in a field that moves.
            const std::size_t n_points = 1 + i % 3;
            std::uint32_t points = 0;
            check(ko_constraints_add_points(set.get(), n_points, &points), "ko_constraints_add_points");
            check(ko_constraints_keep_points(set.get(), points, fields[(i + 11) % 20].get(), frames[i % 2], &of, nullptr),
                  "ko_constraints_keep_points");
            std::vector<double> x;
            add_parameters(dim, a, uniform, x);
            add_parameters(dim, b, uniform, x);
            const std::vector<double> places_of_points = body_points(dim, n_points, others);
            x.insert(x.end(), places_of_points.begin(), places_of_points.end());
            // One in ten where a frame stands still in the world, so that points lie on the faces of the box.
            if (i % 10 == 0) std::fill(x.begin(), x.begin() + dim, 0.0);
            const Worst found = compare(set, x, uniform);
            take_in(of_kind[kind], found);
            if (kind > 0) take_in(of_aggregate, compare_aggregate(of, i % 2 ? KO_LARGEST : KO_LEAST, others));
            // The union or the intersection of two or three fields, by another kind.
            if (i % 5 != 0) continue;
            const int by = 1 + i / 5 % 3;
            std::vector<const ko_field *> several;
            for (int f = 0; f < 2 + i / 15 % 2; ++f) several.push_back(fields[(i + 5 * f) % 20].get());
            const ko_aggregation combination = aggregation_of(KINDS[by], 1 + 11 * others(), others() < 0.5 ? KO_BELOW : KO_ABOVE);
            const Constraints combined = constraints_of(dim);
            const std::uint32_t places[] = {add_frame(combined, a.rotation, a.scale), add_frame(combined, b.rotation, b.scale)};
            keep_in_fields(combined, body, places[0], several, i % 2 ? KO_LARGEST : KO_LEAST, combination, places[1], of);
            x.resize(x.size() - dim * n_points);
            take_in(of_combination[by], compare(combined, x, others));
        }
        for (int kind = 0; kind < 4; ++kind) {
            const std::string key = "derivatives_" + std::to_string(dim) + "d_" + NAMES[kind];
            print(key + "_gradient_error", of_kind[kind].gradient);
            print(key + "_hessian_error", of_kind[kind].hessian);
            print(key + "_products_error", of_kind[kind].products);
            if (kind == 0) continue;
            print(key + "_of_fields_gradient_error", of_combination[kind].gradient);
            print(key + "_of_fields_hessian_error", of_combination[kind].hessian);
        }
        print("derivatives_" + std::to_string(dim) + "d_of_values_gradient_error", of_aggregate.gradient);
        print("derivatives_" + std::to_string(dim) + "d_of_values_hessian_error", of_aggregate.hessian);
        compare_formulations(dim, others);
    }
    print("derivatives_gradient_error_limit", LIMIT_OF_GRADIENTS);
    print("derivatives_hessian_error_limit", LIMIT_OF_HESSIANS);
}

}  // namespace bench
