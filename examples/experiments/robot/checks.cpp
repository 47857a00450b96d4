// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "checks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace {

// A robot with all that the model has: tubes turned against each other, each part of each kind.
constexpr Parameters example = {0.03, 0.02, 0.012, 30, 25, 20, 0.3, 2.2, -0.9, 70, 50, 30, 0.1, -0.2};

double distance(const Vec3 &a, const Vec3 &b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

bool report(const char *what, double found, double limit, const char *unit) {
    const bool good = found <= limit;
    std::printf("  %-86s %8.1e %s%s\n", what, found, unit, good ? "" : "  NOT as it should be");
    return good;
}

double pull_error(const Tubes &tubes) {
    Shape shape;
    solve(tubes, example, shape);
    std::vector<double> forces(shape.points.size());
    for (std::size_t i = 0; i < forces.size(); ++i)
        forces[i] = std::sin(1.7 * static_cast<double>(i)); // any
    const auto work = [&](Parameters at, int k, double step) {
        at[k] += step;
        Shape moved;
        solve(tubes, at, moved);
        double sum = 0;
        for (std::size_t i = 0; i < forces.size(); ++i)
            sum += forces[i] * moved.points[i];
        return sum;
    };
    Parameters exact;
    pull(shape, forces.data(), exact);
    double error = 0;
    for (int k = 0; k < n_parameters; ++k) {
        const double step = 1e-4 * std::max(0.01, std::fabs(example[k]));
        const double difference = (work(example, k, step) - work(example, k, -step)) / (2 * step);
        error = std::max(error, std::fabs(difference - exact[k]) / std::max(1.0, std::fabs(exact[k])));
    }
    return error;
}

double rigid_error(Tubes tubes) {
    for (double &torsion : tubes.torsion)
        torsion *= 1e9;
    tubes.n_elements = 8000;
    tubes.blur = 0.02;
    Shape shape;
    solve(tubes, example, shape);
    return distance(shape.tip(), rigid_tip(tubes, example));
}

double straightness_error(Tubes tubes) {
    tubes.bending = {1000, 1000, 0};
    tubes.torsion = {750, 750, 1};
    // Tube 1 goes on beyond the tip, as far as its end's blur reaches: along all of the robot both are equal.
    const Parameters opposite = {0.03, 0.03, 0, 40, 90, 1, 0.4, 0.4 + M_PI, 0, 60, 110, 1, 0, 0};
    Shape shape;
    solve(tubes, opposite, shape);
    const Vec3 straight = times(tubes.frame, Vec3{0, 0, 60});
    return distance(shape.tip(), {tubes.entry[0] + straight[0], tubes.entry[1] + straight[1], tubes.entry[2] + straight[2]});
}

// Angles, torques, frame and place, by s.
struct State {
    std::array<double, 2 * n_tubes + 12> y;
};

// The equations themselves, written for this check alone.
State slope(const Tubes &tubes, const Parameters &x, double s, const State &state) {
    const auto step = [&](double at) { return 1 / (1 + std::exp(-at / tubes.blur)); };
    double moment[n_tubes], share[n_tubes], stiffness[n_tubes];
    for (int i = 0; i < n_tubes; ++i) {
        moment[i] = tubes.bending[i] * x[kappa_0 + i] * step(s - x[end_0 + i] + x[curved_0 + i]);
        stiffness[i] = tubes.bending[i] + (i > 0 ? stiffness[i - 1] : 0);
        share[i] = i + 1 < n_tubes ? 1 - step(x[end_0 + i + 1] - s) : 1;
        for (int k = 1; k <= i; ++k)
            share[i] *= step(x[end_0 + k] - s);
    }
    State rate{};
    double u[2] = {0, 0};
    for (int part = 0; part < n_tubes; ++part)
        for (int i = 0; i <= part; ++i) {
            u[0] += share[part] * moment[i] * std::cos(state.y[i]) / stiffness[part];
            u[1] += share[part] * moment[i] * std::sin(state.y[i]) / stiffness[part];
            for (int j = 0; j <= part; ++j)
                rate.y[n_tubes + i] += share[part] * moment[i] * moment[j] * std::sin(state.y[i] - state.y[j]) / stiffness[part];
        }
    for (int i = 0; i < n_tubes; ++i)
        rate.y[i] = state.y[n_tubes + i] / tubes.torsion[i];
    const double *frame = &state.y[2 * n_tubes];
    for (int k = 0; k < 3; ++k) {
        double *to = &rate.y[2 * n_tubes + 3 * k];
        const double *from = frame + 3 * k;
        to[0] = -from[2] * u[1];
        to[1] = from[2] * u[0];
        to[2] = from[0] * u[1] - from[1] * u[0];
        rate.y[2 * n_tubes + 9 + k] = from[2];
    }
    return rate;
}

// From the base to the tip by the classical method of order 4.
State integrate(const Tubes &tubes, const Parameters &x, State state, int n_steps) {
    const double h = x[end_0] / n_steps;
    const auto moved = [](State from, const State &rate, double by) {
        for (std::size_t k = 0; k < from.y.size(); ++k)
            from.y[k] += by * rate.y[k];
        return from;
    };
    for (int j = 0; j < n_steps; ++j) {
        const double s = j * h;
        const State a = slope(tubes, x, s, state), b = slope(tubes, x, s + h / 2, moved(state, a, h / 2));
        const State c = slope(tubes, x, s + h / 2, moved(state, b, h / 2)), d = slope(tubes, x, s + h, moved(state, c, h));
        for (std::size_t k = 0; k < state.y.size(); ++k)
            state.y[k] += h / 6 * (a.y[k] + 2 * b.y[k] + 2 * c.y[k] + d.y[k]);
    }
    return state;
}

// Solves the 3 x 3 system by Cramer's rule.
Vec3 solved(const Mat3 &a, const Vec3 &b) {
    const auto determinant = [](const Mat3 &m) {
        return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
    };
    Vec3 x;
    for (int k = 0; k < 3; ++k) {
        Mat3 replaced = a;
        for (int i = 0; i < 3; ++i)
            replaced[3 * i + k] = b[i];
        x[k] = determinant(replaced) / determinant(a);
    }
    return x;
}

// How far the tip is from where shooting from the same base angles puts it: Newton's method on the torques at the base, which are to leave
// none at the tip.
double shooting_error(Tubes tubes, int n_elements) {
    tubes.n_elements = n_elements;
    Shape shape;
    solve(tubes, example, shape);
    State base{};
    const Mat3 frame = times(tubes.frame, rotation(example[tilt_0], example[tilt_0 + 1]));
    std::copy(frame.begin(), frame.end(), base.y.begin() + 2 * n_tubes);
    std::copy(tubes.entry.begin(), tubes.entry.end(), base.y.begin() + 2 * n_tubes + 9);
    for (int i = 0; i < n_tubes; ++i)
        base.y[i] = shape.base_angle[i].value;
    constexpr int n_steps = 1500;
    State tip;
    for (int round = 0; round < 8; ++round) {
        tip = integrate(tubes, example, base, n_steps);
        Mat3 by{};
        for (int k = 0; k < n_tubes; ++k) {
            State other = base;
            other.y[n_tubes + k] += 1e-3;
            other = integrate(tubes, example, other, n_steps);
            for (int i = 0; i < n_tubes; ++i)
                by[3 * i + k] = (other.y[n_tubes + i] - tip.y[n_tubes + i]) / 1e-3;
        }
        const Vec3 change = solved(by, {tip.y[n_tubes], tip.y[n_tubes + 1], tip.y[n_tubes + 2]});
        for (int k = 0; k < n_tubes; ++k)
            base.y[n_tubes + k] -= change[k];
    }
    tip = integrate(tubes, example, base, n_steps);
    const double *place = &tip.y[2 * n_tubes + 9];
    return distance(shape.tip(), {place[0], place[1], place[2]});
}

} // namespace

bool check_model(const Tubes &tubes) {
    std::printf("The model of the robot:\n");
    bool good = report("derivatives, to central differences, relative", pull_error(tubes), 1e-6, "");
    good = report("tip, torsion 1e9 times as stiff, to that of arcs in closed form", rigid_error(tubes), 1e-4, "mm") && good;
    good = report("tip of two equal tubes at opposite angles, to that of a straight line", straightness_error(tubes), 1e-12, "mm") && good;
    good = report("tip, to that by shooting from the base", shooting_error(tubes, tubes.n_elements), 0.05, "mm") && good;
    return report("the same with eight times the elements", shooting_error(tubes, 8 * tubes.n_elements), 1e-3, "mm") && good;
}

double derivative_error(Problem &problem, const std::vector<double> &x) {
    const std::size_t m = problem.constraints.size();
    problem.update(x.data());
    // Rows of the constraints, then the objective's.
    std::vector<double> exact((m + 1) * x.size()), largest(m + 1, 1e-12), error(m + 1);
    for (std::size_t e = 0; e < problem.entries.size(); ++e)
        exact[problem.rows[e] * x.size() + problem.columns[e]] += problem.entries[e];
    std::copy(problem.gradient.begin(), problem.gradient.end(), exact.begin() + m * x.size());
    const double step = 1e-5;
    for (std::size_t k = 0; k < x.size(); ++k) {
        std::vector<double> at = x, above;
        at[k] = x[k] + step;
        problem.update(at.data());
        above = problem.values;
        above.push_back(problem.objective);
        at[k] = x[k] - step;
        problem.update(at.data());
        std::vector<double> below = problem.values;
        below.push_back(problem.objective);
        for (std::size_t i = 0; i <= m; ++i) {
            const double derivative = exact[i * x.size() + k];
            largest[i] = std::max(largest[i], std::fabs(derivative));
            error[i] = std::max(error[i], std::fabs((above[i] - below[i]) / (2 * step) - derivative));
        }
    }
    double worst = 0;
    for (std::size_t i = 0; i <= m; ++i)
        worst = std::max(worst, error[i] / largest[i]);
    return worst;
}
