// SPDX-License-Identifier: Apache-2.0 OR MIT
// Design of the robot: one set of tubes, and how far to push and turn them at each of some points of the path, so that the tip is there and
// the whole robot outside the anatomy.
//
// Variables: curvatures and curved lengths of the tubes, tilt of the guide; at each point of the path the tubes' tip angles and ends.
// Constraints, at each point of the path: the tip's three coordinates, near the point's; KS of the clearance along the robot; tubes end in order.
// Objective: squares of what tip angles and ends change by from one point to the next, of strains, and of curved lengths.
#pragma once

#include "clearance.hpp"
#include "problem.hpp"
#include "tubes.hpp"

class DesignProblem : public Problem {
public:
    // `targets` [3 x n]: points of the path. KS of the clearance along the centre line is to be `least` [mm].
    DesignProblem(const Tubes &tubes, const std::vector<double> &targets, Clearance &clearance, const LeastOf &least_of, double least);

    // Tubes of middling curvature, nothing turned, their ends at fixed shares of how long the path is up to each target.
    std::vector<double> start(const std::vector<double> &shares, double path_length) const;

    std::size_t n_poses() const { return targets_.size() / 3; }

    // What the shape at point k of the path depends on.
    Parameters parameters(const double *x, std::size_t pose) const;

    // Which variable a parameter at point k of the path is.
    std::size_t variable(int parameter, std::size_t pose) const;

    double model_seconds = 0;

private:
    void compute(const double *x) override;
    void add_objective(const double *x);

    Tubes tubes_;
    std::vector<double> targets_;
    Clearance &clearance_;
    LeastOf least_of_;
    std::vector<Shape> shapes_;
    std::vector<double> points_, values_, gradients_, weights_;
};
