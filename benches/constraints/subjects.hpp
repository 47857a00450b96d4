// What the bench of constraints prints, subject by subject.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include "../program.hpp"

namespace bench {

void derivatives(const Data &data);  // against differences
void speed(const Data &data);        // beside the field alone
void figure_8(const Data &data);     // beside explicit formulations, against the number of samples
void certify(const Data &data);      // beside an attack, and how its cost grows
void adjoint(const Data &data);      // derivatives by the cloud against differences, refits and solves beside fits

}  // namespace bench
