// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "pairs.hpp"

namespace bench {

// Multiplied out here, from the poses in the world.
RelativePose relative_pose(const study &of, double time) {
    double turns[2][9], shifts[2][3] = {{0, 0, 0}, {0, 0, 0}};
    for (int part = 0; part < 2; ++part) {
        double rotation[9];
        check(ko_motion_eval(of.motions[part], &time, 1, rotation, shifts[part]), "ko_motion_eval");
        for (std::uint32_t i = 0; i < 3; ++i)
            for (std::uint32_t j = 0; j < 3; ++j)
                turns[part][3 * i + j] = i < of.dim && j < of.dim ? rotation[of.dim * i + j] : (i == j ? 1.0 : 0.0);
    }
    RelativePose pose{};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k) pose.turn[3 * i + j] += turns[0][3 * k + i] * turns[1][3 * k + j];
        for (int k = 0; k < 3; ++k) pose.shift[i] += turns[0][3 * k + i] * (shifts[1][k] - shifts[0][k]);
    }
    return pose;
}

}  // namespace bench
