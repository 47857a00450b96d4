/* What the tests of co-generation share. */

#ifndef KEEPOUT_TEST_COGEN_H
#define KEEPOUT_TEST_COGEN_H

#include "check.h"

static const double TAU = 6.283185307179586;

static inline ko_law even(double slope) {
    ko_law law;
    OK(ko_law_init(&law, sizeof law));
    law.slope = slope;
    return law;
}

static inline ko_motion *turn(double x, double y, double slope) {
    const double center[2] = {x, y};
    ko_law law = even(slope);
    ko_motion *motion = NULL;
    OK(ko_motion_turn(center, &law, &motion));
    return motion;
}

static inline ko_part *grid(double x, double y, double edge, size_t nx, size_t ny) {
    const double corner[2] = {x, y};
    const size_t counts[2] = {nx, ny};
    ko_part *part = NULL;
    OK(ko_part_create(2, corner, edge, counts, NULL, 0, &part));
    return part;
}

static inline size_t count(const uint8_t *set, size_t n) {
    size_t total = 0;
    for (size_t i = 0; i < n; i++) {
        CHECK(set[i] <= 1);
        total += set[i];
    }
    return total;
}

static inline ko_pair_options options_of(int32_t conflicts, uint64_t measure_steps) {
    ko_pair_options options;
    OK(ko_pair_options_init(&options, sizeof options));
    options.conflicts = conflicts;
    options.measure_steps = measure_steps;
    options.n_threads = 1;
    return options;
}

#endif
