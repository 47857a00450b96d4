/* A progress bar. SPDX-License-Identifier: Apache-2.0 OR MIT */
#ifndef PROGRESS_H
#define PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

struct progress {
    bool terminal; /* a bar that moves, else a line a stage */
    int percent;   /* shown last */
    char stage[32];
};

struct progress progress_start(void);

/* A ko_progress; `data` is a struct progress. */
int32_t progress_show(double fraction, const char *stage, void *data);

/* Leaves the bar's line, also where the work stopped short of its end. */
void progress_end(const struct progress *progress);

#endif
