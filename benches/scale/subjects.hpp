// The subjects of `benches/run scale`, in the order in which they are printed; a file each.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include "../program.hpp"

namespace bench {

// Nanoseconds of an evaluation beside a kernel by hand, in and out of cache, and on two threads.
void speed(const Data &data);

// Nanoseconds of an evaluation of a fitted field, and its accuracy, beside CGAL, parry3d-f64, interpn and the kernel by hand.
void peers(const Data &data);

// Seconds and iterations of fits at the paper's sizes, how they grow, and where data are stiff.
void fits(const Data &data);

// A fit of a million control points and nothing else, for the memory of the process to be seen from outside.
void million_only(const Data &data);

// Distances of held-out points to surfaces, against control points, beside the reconstruction programs'.
void accuracy(const Data &data);

// Wrong signs around closed shapes, parts of the zero level set that they have not, and how far |grad phi| is from 1 away from them, of one
// grid and of refined cells.
void sides(const Data &data);

}  // namespace bench
