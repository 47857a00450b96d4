// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "design.hpp"

#include <cmath>
#include <ctime>

namespace {

constexpr int n_common = 2 * n_tubes + 2, n_own = 2 * n_tubes; // variables of the tubes and the tilt, and of one point of the path
constexpr int clearance_row = 3, order_row = 4;                // the tip's coordinates are rows 0 to 2
constexpr int n_rows = order_row + n_tubes - 1;                // constraints at one point of the path

constexpr double largest_strain = 0.04; // of nitinol, straightened, kappa times the radius: half of what it recovers from
constexpr double tip_tolerance = 0.5;    // from the path, along each axis [mm]
constexpr double smallest_curvature = 0.004; // [1/mm]; of a straight tube angles would mean nothing
constexpr double between_ends = 1;      // tubes end at least this far from each other [mm]
constexpr double strain_weight = 0.1, turning_weight = 1, pushing_weight = 1, length_weight = 0.01;

// Which variable parameter p at a point of the path is, and what it is measured in.
std::size_t variable_of(int p, std::size_t pose) {
    if (p < psi_0)
        return p;
    if (p >= tilt_0)
        return psi_0 + (p - tilt_0);
    return n_common + n_own * pose + (p - psi_0);
}

double unit_of(int p) {
    if (p < curved_0)
        return 0.02; // 1/mm
    if (p < psi_0 || (p >= end_0 && p < tilt_0))
        return 10; // mm
    return 1;
}

double seconds_since(std::clock_t begin) { return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC; }

} // namespace

DesignProblem::DesignProblem(const Tubes &tubes, const std::vector<double> &targets, Clearance &clearance, const LeastOf &least_of,
                             double least)
    : tubes_(tubes), targets_(targets), clearance_(clearance), least_of_(least_of), shapes_(targets.size() / 3) {
    variables.resize(n_common + n_own * n_poses());
    for (std::size_t pose = 0; pose < n_poses(); ++pose) {
        for (int p = 0; p < n_parameters; ++p) {
            Bounds bounds{-4 * M_PI, 4 * M_PI}; // angles
            if (p < curved_0)
                bounds = {smallest_curvature, largest_strain / tubes.radius[p]};
            else if (p < psi_0)
                bounds = {5, 80};
            else if (p >= tilt_0)
                bounds = {-0.9, 0.9};
            else if (p >= end_0)
                bounds = {1, 120};
            variables[variable_of(p, pose)] = {bounds.low / unit_of(p), bounds.high / unit_of(p)};
        }
        for (int row = 0; row < 3; ++row)
            constraints.push_back({-tip_tolerance, tip_tolerance});
        constraints.push_back({least, unbounded});
        for (int i = 1; i < n_tubes; ++i)
            constraints.push_back({between_ends, unbounded});
        for (int row = 0; row <= clearance_row; ++row)
            for (int p = 0; p < n_parameters; ++p)
                add_entry(n_rows * pose + row, variable_of(p, pose));
        for (int i = 1; i < n_tubes; ++i) {
            entries[add_entry(n_rows * pose + order_row + i - 1, variable_of(end_0 + i - 1, pose))] = unit_of(end_0);
            entries[add_entry(n_rows * pose + order_row + i - 1, variable_of(end_0 + i, pose))] = -unit_of(end_0);
        }
    }
    gradient.resize(variables.size());
    values.resize(constraints.size());
}

std::vector<double> DesignProblem::start(const std::vector<double> &shares, double path_length) const {
    const double curvature[n_tubes] = {0.02, 0.015, 0.01}, end[n_tubes] = {1, 0.7, 0.4};
    std::vector<double> x(variables.size());
    for (std::size_t pose = 0; pose < n_poses(); ++pose)
        for (int i = 0; i < n_tubes; ++i) {
            x[variable_of(kappa_0 + i, pose)] = curvature[i] / unit_of(kappa_0);
            x[variable_of(curved_0 + i, pose)] = 30 / unit_of(curved_0);
            x[variable_of(end_0 + i, pose)] = end[i] * shares[pose] * path_length / unit_of(end_0);
        }
    return x;
}

std::size_t DesignProblem::variable(int parameter, std::size_t pose) const { return variable_of(parameter, pose); }

Parameters DesignProblem::parameters(const double *x, std::size_t pose) const {
    Parameters parameters;
    for (int p = 0; p < n_parameters; ++p)
        parameters[p] = unit_of(p) * x[variable_of(p, pose)];
    return parameters;
}

void DesignProblem::compute(const double *x) {
    const std::clock_t begin = std::clock();
    const std::size_t n_points = tubes_.n_elements + 1;
    points_.clear();
    for (std::size_t pose = 0; pose < n_poses(); ++pose) {
        solve(tubes_, parameters(x, pose), shapes_[pose]);
        points_.insert(points_.end(), shapes_[pose].points.begin(), shapes_[pose].points.end());
    }
    model_seconds += seconds_since(begin);

    clearance_.eval(points_, values_, gradients_);

    const std::clock_t again = std::clock();
    weights_.resize(values_.size());
    const std::size_t n_entries = entries.size() / n_poses();
    std::vector<double> forces(3 * n_points);
    Parameters by;
    for (std::size_t pose = 0; pose < n_poses(); ++pose) {
        double *row = &values[n_rows * pose], *entry = &entries[n_entries * pose];
        const auto put = [&] {
            for (int p = 0; p < n_parameters; ++p)
                *entry++ = unit_of(p) * by[p];
        };
        const Vec3 tip = shapes_[pose].tip();
        std::fill(forces.begin(), forces.end(), 0);
        for (int k = 0; k < 3; ++k) {
            row[k] = tip[k] - targets_[3 * pose + k];
            forces[3 * (n_points - 1) + k] = 1;
            pull(shapes_[pose], forces.data(), by);
            put();
            forces[3 * (n_points - 1) + k] = 0;
        }
        const std::size_t first = pose * n_points;
        row[clearance_row] = least_of_({&values_[first], n_points}, {&weights_[first], n_points});
        for (std::size_t j = 0; j < n_points; ++j)
            for (int k = 0; k < 3; ++k)
                forces[3 * j + k] = weights_[first + j] * gradients_[3 * (first + j) + k];
        pull(shapes_[pose], forces.data(), by);
        put();
        for (int i = 1; i < n_tubes; ++i)
            row[order_row + i - 1] = unit_of(end_0) * (x[variable_of(end_0 + i - 1, pose)] - x[variable_of(end_0 + i, pose)]);
    }
    add_objective(x);
    model_seconds += seconds_since(again);
}

void DesignProblem::add_objective(const double *x) {
    objective = 0;
    std::fill(gradient.begin(), gradient.end(), 0);
    for (int i = 0; i < n_tubes; ++i) {
        const double strain = unit_of(kappa_0) * tubes_.radius[i] / largest_strain; // of a variable of 1
        objective += strain_weight * strain * strain * x[i] * x[i];
        gradient[i] += 2 * strain_weight * strain * strain * x[i];
        objective += length_weight * x[curved_0 + i] * x[curved_0 + i];
        gradient[curved_0 + i] += 2 * length_weight * x[curved_0 + i];
    }
    for (std::size_t pose = 1; pose < n_poses(); ++pose)
        for (int p = psi_0; p < tilt_0; ++p) {
            const double weight = (p < end_0 ? turning_weight : pushing_weight) / (n_poses() - 1);
            const std::size_t now = variable_of(p, pose), before = variable_of(p, pose - 1);
            const double change = x[now] - x[before];
            objective += weight * change * change;
            gradient[now] += 2 * weight * change;
            gradient[before] -= 2 * weight * change;
        }
}
