// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "path.hpp"

#include <cmath>

namespace {

constexpr int n_control = PathProblem::n_control, degree = 3;
constexpr double unit = 10;          // a variable is a control point's coordinate over this [mm]
constexpr double bending = 0.01;     // what the squares of second derivatives weigh beside those of first ones

// Cubic B-splines on [0, 1], clamped, by the recurrence of Cox and de Boor; `order` is that of the derivative.
double basis(int i, int p, int order, double t) {
    const auto knot = [](int k) { return std::min(std::max(0, k - degree), n_control - degree) / static_cast<double>(n_control - degree); };
    const double left = knot(i + p) - knot(i), right = knot(i + p + 1) - knot(i + 1);
    if (p == 0) {
        const bool last = t >= 1 && knot(i) < 1 && knot(i + 1) >= 1;
        return (t >= knot(i) && t < knot(i + 1)) || last ? 1 : 0;
    }
    double sum = 0;
    if (order > 0) {
        if (left > 0)
            sum += p / left * basis(i, p - 1, order - 1, t);
        if (right > 0)
            sum -= p / right * basis(i + 1, p - 1, order - 1, t);
        return sum;
    }
    if (left > 0)
        sum += (t - knot(i)) / left * basis(i, p - 1, 0, t);
    if (right > 0)
        sum += (knot(i + p + 1) - t) / right * basis(i + 1, p - 1, 0, t);
    return sum;
}

} // namespace

PathProblem::PathProblem(const Vec3 &from, const Vec3 &to, Clearance &clearance, const LeastOf &least_of, double least)
    : from_(from), to_(to), clearance_(clearance), least_of_(least_of), energy_(n_control * n_control) {
    for (int j = 0; j < n_samples; ++j)
        for (int i = 0; i < n_control; ++i)
            basis_.push_back(basis(i, degree, 0, j / (n_samples - 1.0)));

    // Three points of Gauss a span are exact to degree 5; squares of first derivatives have degree 4.
    const double distance2 = std::pow(to[0] - from[0], 2) + std::pow(to[1] - from[1], 2) + std::pow(to[2] - from[2], 2);
    const double nodes[3] = {0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)}, node_weights[3] = {5. / 18, 8. / 18, 5. / 18};
    const int n_spans = n_control - degree;
    for (int span = 0; span < n_spans; ++span)
        for (int q = 0; q < 3; ++q) {
            const double t = (span + nodes[q]) / n_spans, weight = node_weights[q] / n_spans / distance2;
            for (int a = 0; a < n_control; ++a)
                for (int b = 0; b < n_control; ++b)
                    energy_[a * n_control + b] += weight * (basis(a, degree, 1, t) * basis(b, degree, 1, t) +
                                                            bending * basis(a, degree, 2, t) * basis(b, degree, 2, t));
        }

    variables.assign(3 * (n_control - 2), {-unbounded, unbounded});
    constraints = {{least, unbounded}};
    gradient.resize(variables.size());
    values.resize(1);
    for (std::size_t k = 0; k < variables.size(); ++k)
        add_entry(0, k);
}

std::vector<double> PathProblem::start() const {
    std::vector<double> x;
    for (int i = 1; i + 1 < n_control; ++i) {
        // The Greville abscissae, at which a straight line has its speed constant.
        double share = 0;
        for (int k = 1; k <= degree; ++k)
            share += std::min(std::max(0, i + k - degree), n_control - degree) / static_cast<double>(n_control - degree) / degree;
        for (int k = 0; k < 3; ++k)
            x.push_back((from_[k] + share * (to_[k] - from_[k])) / unit);
    }
    return x;
}

std::vector<double> PathProblem::control(const double *x) const {
    std::vector<double> control(from_.begin(), from_.end());
    for (std::size_t k = 0; k < variables.size(); ++k)
        control.push_back(unit * x[k]);
    control.insert(control.end(), to_.begin(), to_.end());
    return control;
}

std::vector<double> PathProblem::points(const std::vector<double> &x, int n) const {
    const std::vector<double> c = control(x.data());
    std::vector<double> points(3 * n);
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n_control; ++i)
            for (int k = 0; k < 3; ++k)
                points[3 * j + k] += basis(i, degree, 0, j / (n - 1.0)) * c[3 * i + k];
    return points;
}

void PathProblem::compute(const double *x) {
    const std::vector<double> c = control(x);
    samples_.assign(3 * n_samples, 0);
    for (int j = 0; j < n_samples; ++j)
        for (int i = 0; i < n_control; ++i)
            for (int k = 0; k < 3; ++k)
                samples_[3 * j + k] += basis_[j * n_control + i] * c[3 * i + k];
    clearance_.eval(samples_, values_, gradients_);
    weights_.resize(n_samples);
    values[0] = least_of_(values_, weights_);

    objective = 0;
    for (int i = 0; i < n_control; ++i)
        for (int k = 0; k < 3; ++k) {
            double by_energy = 0, by_clearance = 0;
            for (int b = 0; b < n_control; ++b)
                by_energy += energy_[i * n_control + b] * c[3 * b + k];
            for (int j = 0; j < n_samples; ++j)
                by_clearance += weights_[j] * basis_[j * n_control + i] * gradients_[3 * j + k];
            objective += by_energy * c[3 * i + k];
            if (i == 0 || i + 1 == n_control)
                continue;
            gradient[3 * (i - 1) + k] = 2 * unit * by_energy;
            entries[3 * (i - 1) + k] = unit * by_clearance;
        }
}

std::vector<double> points_along(const std::vector<double> &polyline, const std::vector<double> &shares, double &length) {
    const std::size_t n_points = polyline.size() / 3;
    std::vector<double> until(n_points);
    for (std::size_t j = 1; j < n_points; ++j) {
        const double *a = &polyline[3 * (j - 1)], *b = &polyline[3 * j];
        until[j] = until[j - 1] + std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    }
    length = until.back();
    std::vector<double> points;
    std::size_t j = 1;
    for (const double share_of_length : shares) {
        const double at = share_of_length * length;
        while (j + 1 < n_points && until[j] < at)
            ++j;
        const double share = std::min(1.0, (at - until[j - 1]) / (until[j] - until[j - 1]));
        for (int i = 0; i < 3; ++i)
            points.push_back((1 - share) * polyline[3 * (j - 1) + i] + share * polyline[3 * j + i]);
    }
    return points;
}
