// The field's figures, all of them or the subjects that are named.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

int main(int argc, char **argv) {
    using namespace bench;
    return run_subjects("field", argc, argv,
                        {{"accuracy", accuracy},
                         {"tables", tables},
                         {"plane", plane},
                         {"several", several},
                         {"level_sets", level_sets},
                         {"normals", normals},
                         {"guess", guess},
                         {"scale", scale},
                         {"speed", speed},
                         {"signs", signs},
                         {"growth", growth}},
                        {{"fit-only", fit_only}});
}
