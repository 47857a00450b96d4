// Figures of size and speed, all of them or the subjects that are named.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

int main(int argc, char **argv) {
    using namespace bench;
    return run_subjects("scale", argc, argv, {{"speed", speed}, {"peers", peers}, {"fits", fits}, {"accuracy", accuracy}, {"sides", sides}},
                        {{"million-only", million_only}});
}
