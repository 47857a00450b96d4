// A kernel by hand, for one machine and one dimension: the floor that the library's evaluation is held to.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include <cstddef>

namespace bench {

// Control points of space, row-major, the last axis contiguous, and the box of their cells.
struct FloorField {
    const double *control_points;
    std::size_t counts[3];
    double lower[3], cell[3];
};

// Whether this program has the kernel and this machine the instructions that it is made of.
bool has_floor();

// Values [n], gradients [3 * n] and Hessians [6 * n] at `points` [3 * n]; the last two or the last may be NULL. Returns n, or less where
// a point is not finite or beyond 1e150. Outside the box it gives what the box's nearest point has.
std::size_t floor_eval(const FloorField &field, const double *points, std::size_t n, double *values, double *gradients,
                       double *hessians);

}  // namespace bench
