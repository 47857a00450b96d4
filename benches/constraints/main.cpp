// Figures of constraints, all of them or the subjects that are named.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

int main(int argc, char **argv) {
    using namespace bench;
    return run_subjects("constraints", argc, argv,
                        {{"derivatives", derivatives}, {"speed", speed}, {"figure_8", figure_8}, {"certify", certify}, {"adjoint", adjoint}});
}
