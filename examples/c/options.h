/* The command line. SPDX-License-Identifier: Apache-2.0 OR MIT */
#ifndef OPTIONS_H
#define OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct options {
    const char *mesh; /* NULL: the shape that the program makes */
    size_t points;
    uint32_t control_points[3]; /* 0: the library chooses */
    double max_error; /* fraction of D; 0: one grid */
    bool inside;
    uint64_t seed;
    uint32_t threads; /* 0: all cores */
    const char *save; /* NULL: not saved */
    const char *picture;
    bool help;
};

/* Reads the command line; says on stderr what is wrong with it. */
bool options_read(int argc, char **argv, struct options *options);

/* Tells the options, with the picture that `options` would write. */
void options_print_help(const struct options *options);

#endif
