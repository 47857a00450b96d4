// Corners of curves, ends of open shapes, and points that keep away from them.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include "../library.hpp"

namespace bench {

// Vertices of curves in the plane where these turn by more than `degrees`, [n x 2].
std::vector<double> corners_of(const Facets &curves, double degrees);

// Points on the rim of an open mesh, [n x dim]: ends of curves, in space points along the boundary edges, at most `spacing` apart.
std::vector<double> rim_of(const Facets &mesh, double spacing);

// Distance of the point `p` to the nearest of `points` [n x dim]; infinite where there are none.
double nearest(const double *p, const std::vector<double> &points, std::size_t dim);

// Those of `points` [n x dim] that are farther than `distance` from all of `others` [m x dim].
std::vector<double> farther_than(double distance, const std::vector<double> &points, const std::vector<double> &others,
                                 std::size_t dim = 2);

}  // namespace bench
