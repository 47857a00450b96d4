/* Pairs over the whole range of gamma. SPDX-License-Identifier: Apache-2.0 OR MIT */
#ifndef FAMILY_H
#define FAMILY_H

#include "cases.h"

#include <stdio.h>

struct family {
    size_t n;
    double *gammas, *reached, *volumes, *bounds; /* [n], [n], [2 * n], [n] */
    double *largest_gaps, *mean_gaps;            /* [n] over the motion */
    double *mma_gammas, *mma_sums;               /* [n_mma] by moving asymptotes */
    size_t n_mma;
    uint8_t *cells[2];                           /* [n * n_cells] */
};

/* Finds pairs for `n` gammas from 0 to 1, with their gaps at `n_times` times. Says on stderr where that fails. */
bool family_find(const ko_pair *pair, const struct study *study, size_t n, size_t n_times, struct family *family);

/* Adds what moving asymptotes find for each gamma but 0 and 1. */
bool family_optimise(const ko_pair *pair, const struct study *study, struct family *family);

void family_print(const struct family *family);

/* The sums over gamma below their bound, as SVG. */
void family_chart(FILE *file, const struct family *family, size_t shown);

void family_free(struct family *family);

#endif
