// SPDX-License-Identifier: Apache-2.0 OR MIT
// What the model of the robot and its derivatives are checked against, each time before they are used.
#pragma once

#include "problem.hpp"
#include "tubes.hpp"

// Prints what it finds; false where something is off: derivatives against differences; the torsionally rigid limit against arcs in closed
// form; two equal tubes at opposite angles, which are straight; the compliant shape against shooting from the base by Runge and Kutta.
bool check_model(const Tubes &tubes);

// The largest difference of the problem's derivatives at x from central differences, over the largest derivative of the same row.
double derivative_error(Problem &problem, const std::vector<double> &x);
