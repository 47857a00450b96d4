/* The case studies of Morris and Behandish 2022, section 5, and the latch of its figure 2. SPDX-License-Identifier: Apache-2.0 OR MIT */
#ifndef CASES_H
#define CASES_H

#include <keepout.h>
#include <stdbool.h>

struct study {
    const char *name, *title;
    uint32_t dim;
    size_t cells;        /* along a part's edge L = 1, in the paper */
    uint64_t steps;      /* K of the paper */
    double gamma;        /* of the pair that the paper shows */
    ko_part *parts[2];
    ko_motion *motions[2];
    size_t n_cells[2];
    double corner[2][3], edge[2];
    size_t counts[2][3]; /* 1 along the third axis in the plane */
    double enclosure[4]; /* in the plane, what is drawn behind the parts: x and y from and to; 0 for none */
};

/* The names, behind the last NULL. */
extern const char *const STUDIES[];

/* Makes the study `name` with `cells` along L, 0 for as many as in the paper. Says on stderr where that fails. */
bool study_make(const char *name, size_t cells, struct study *study);

void study_free(struct study *study);

#endif
