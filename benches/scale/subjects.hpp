// The subjects of `benches/run scale`, in the order in which they are printed; a file each.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include "../program.hpp"

namespace bench {

// Nanoseconds of an evaluation beside a kernel by hand, in and out of cache, and on two threads.
void speed(const Data &data);

}  // namespace bench
