// What the bench of co-generation prints, subject by subject.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include "../program.hpp"

namespace bench {

void exact(const Data &data);          // closures, cuts and unsweeps against brute force and Boost's maximum flow
void sensitivities(const Data &data);  // against differences, and against sums over all pairs of cells
void safety(const Data &data);         // no penetration between samples in space and time
void family(const Data &data);         // totals over gamma, their bound, and moving asymptotes beside them
void assembly(const Data &data);       // ten parts, beside their bound
void table(const Data &data);          // seconds and memory of the paper's cases
void growth(const Data &data);         // seconds and memory against resolution

}  // namespace bench
