// SPDX-License-Identifier: Apache-2.0 OR MIT
// Path planning: a cubic B-spline between two points, short and smooth, that keeps away from the anatomy.
#pragma once

#include "clearance.hpp"
#include "problem.hpp"
#include "tubes.hpp"

class PathProblem : public Problem {
public:
    static constexpr int n_control = 12, n_samples = 101;

    // KS of the clearance at the samples is to be `least` [mm].
    PathProblem(const Vec3 &from, const Vec3 &to, Clearance &clearance, const LeastOf &least_of, double least);

    // The straight line between the two points.
    std::vector<double> start() const;

    // `n` points of the curve of variables x, at equal steps of the parameter.
    std::vector<double> points(const std::vector<double> &x, int n) const;

private:
    void compute(const double *x) override;
    std::vector<double> control(const double *x) const;

    Vec3 from_, to_;
    Clearance &clearance_;
    LeastOf least_of_;
    std::vector<double> basis_;  // [n_samples x n_control]
    std::vector<double> energy_; // [n_control x n_control]: of the squares of first and second derivatives, per squared distance of the ends
    std::vector<double> samples_, values_, gradients_, weights_;
};

// Points of a polyline [3 x ...] at these shares of its length, which increase; with its length.
std::vector<double> points_along(const std::vector<double> &polyline, const std::vector<double> &shares, double &length);
