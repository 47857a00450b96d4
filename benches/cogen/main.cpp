// Figures of co-generation, all of them or the subjects that are named. They need no data.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

int main(int argc, char **argv) {
    using namespace bench;
    return run_subjects("cogen", argc, argv,
                        {{"exact", exact},
                         {"sensitivities", sensitivities},
                         {"safety", safety},
                         {"family", family},
                         {"assembly", assembly},
                         {"table", table},
                         {"growth", growth}});
}
