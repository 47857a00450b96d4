// The subjects of `benches/run field`, in the order in which they are printed; a file each.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include "../program.hpp"

namespace bench {

// Accuracy beside the paper's: the bunny, Tables 2 and 3.
void accuracy(const Data &data);

// Tables 4 and 5: parts of aircraft, a human, a heart.
void tables(const Data &data);

// Curves of the plane.
void plane(const Data &data);

// Several shapes in one domain (figure 4), and open ones (figure 2).
void several(const Data &data);

// Level sets as meshes: topology, offsets.
void level_sets(const Data &data);

// Estimated normals.
void normals(const Data &data);

// The paper's start of the solve, from (1).
void guess(const Data &data);

// The same cloud in other units.
void scale(const Data &data);

// Seconds of a fit, nanoseconds of an evaluation beside CGAL's.
void speed(const Data &data);

// Signs far from the surface.
void signs(const Data &data);

// Sizes a factor 8 apart.
void growth(const Data &data);

// A fit and nothing else, to be run under a program that measures memory.
void fit_only(const Data &data);

}  // namespace bench
