/* SPDX-License-Identifier: Apache-2.0 OR MIT */
#define _POSIX_C_SOURCE 200112L /* isatty */

#include "progress.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { WIDTH = 40 };

struct progress progress_start(void)
{
    return (struct progress){.terminal = isatty(STDERR_FILENO) != 0, .percent = -1};
}

static void draw_bar(int percent, const char *stage)
{
    const int filled = percent * WIDTH / 100;
    fprintf(stderr, "\r[%.*s%*s] %3d%% %-12.12s", filled, "########################################", WIDTH - filled, "",
            percent, stage);
}

int32_t progress_show(double fraction, const char *stage, void *data)
{
    struct progress *shown = data;
    const int percent = (int)(100 * fraction);
    const bool new_stage = strncmp(shown->stage, stage, sizeof shown->stage - 1) != 0;
    if (shown->terminal && (percent != shown->percent || new_stage))
        draw_bar(percent, stage);
    if (!shown->terminal && new_stage)
        fprintf(stderr, "%s\n", stage);
    shown->percent = percent;
    strncpy(shown->stage, stage, sizeof shown->stage - 1);
    return 0; /* go on */
}

void progress_end(const struct progress *progress)
{
    if (progress->terminal && progress->percent >= 0)
        fputc('\n', stderr);
}
