/* SPDX-License-Identifier: Apache-2.0 OR MIT */
#include "options.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct options DEFAULTS = {.points = 25000, .seed = 1, .picture = "keepout_field.png"};

void options_print_help(const struct options *options)
{
    printf("usage: keepout_field [MESH] [options]\n"
           "Fits a smooth field to MESH (OBJ, STL, PLY or OFF, also gzipped; without one a trefoil knot that is made here),\n"
           "probes it and draws a slice of it. Or, in the plane, to closed curves: an airfoil's .dat, boundaries in .yaml, x, y in .csv.\n"
           "  --points N                 points sampled on the surface (%zu)\n"
           "  --control-points NX NY NZ  size of the spline, at least 4 each (chosen by the library); in the plane NZ is ignored\n"
           "  --max-error E              refine cells until |phi| at the points is E D or less, D the shape's diagonal; 1e-3, say (one grid)\n"
           "  --inside                   the design stays inside the shape: phi > 0 there\n"
           "  --seed S                   seed of the sampling (%" PRIu64 ")\n"
           "  --threads N                threads, 0 for all cores (%" PRIu32 ")\n"
           "  --save FILE                write the field to FILE\n"
           "  --picture FILE             write the slice to FILE, a PNG (%s)\n"
           "  --help                     this text\n",
           DEFAULTS.points, DEFAULTS.seed, DEFAULTS.threads, options->picture);
}

static bool read_number(const char *text, uint64_t largest, uint64_t *number)
{
    char *end;
    errno = 0;
    const unsigned long long read = strtoull(text, &end, 10);
    /* strtoull takes "-1" and " 1" */
    if (text[0] < '0' || text[0] > '9' || *end != '\0' || errno != 0 || read > largest) {
        fprintf(stderr, "keepout_field: '%s' is not a whole number from 0 to %" PRIu64 "\n", text, largest);
        return false;
    }
    *number = read;
    return true;
}

/* The library tells what is out of range. */
static bool read_real(const char *text, double *number)
{
    char *end;
    const double read = strtod(text, &end);
    /* strtod takes "", " 1", "-1" and "nan" */
    if (strchr("0123456789.", text[0]) == NULL || end == text || *end != '\0') {
        fprintf(stderr, "keepout_field: '%s' is not a number from 0 on\n", text);
        return false;
    }
    *number = read;
    return true;
}

/* How many arguments follow option `name`; -1 for no option. */
static int arguments_of(const char *name)
{
    static const struct {
        const char *name;
        int arguments;
    } known[] = {{"--points", 1}, {"--control-points", 3}, {"--max-error", 1}, {"--inside", 0},
                 {"--seed", 1}, {"--threads", 1}, {"--save", 1}, {"--picture", 1}, {"--help", 0}};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; ++i)
        if (strcmp(name, known[i].name) == 0)
            return known[i].arguments;
    return -1;
}

/* Takes the option `at[0]`, which has its arguments behind it. */
static bool take(char **at, struct options *options)
{
    const char *name = at[0];
    uint64_t number = 0;
    if (strcmp(name, "--help") == 0) {
        options->help = true;
    } else if (strcmp(name, "--inside") == 0) {
        options->inside = true;
    } else if (strcmp(name, "--save") == 0) {
        options->save = at[1];
    } else if (strcmp(name, "--picture") == 0) {
        options->picture = at[1];
    } else if (strcmp(name, "--max-error") == 0) {
        return read_real(at[1], &options->max_error);
    } else if (strcmp(name, "--seed") == 0) {
        return read_number(at[1], UINT64_MAX, &options->seed);
    } else if (strcmp(name, "--points") == 0) {
        if (!read_number(at[1], SIZE_MAX, &number))
            return false;
        options->points = (size_t)number;
    } else if (strcmp(name, "--threads") == 0) {
        if (!read_number(at[1], UINT32_MAX, &number))
            return false;
        options->threads = (uint32_t)number;
    } else { /* --control-points */
        for (int k = 0; k < 3; ++k) {
            if (!read_number(at[1 + k], UINT32_MAX, &number))
                return false;
            options->control_points[k] = (uint32_t)number;
        }
    }
    return true;
}

bool options_read(int argc, char **argv, struct options *options)
{
    *options = DEFAULTS;
    for (int i = 1; i < argc; ++i) {
        const int arguments = arguments_of(argv[i]);
        if (arguments < 0 && (argv[i][0] == '-' || options->mesh != NULL)) {
            fprintf(stderr, "keepout_field: '%s' is not expected; --help tells what is\n", argv[i]);
            return false;
        }
        if (arguments < 0) {
            options->mesh = argv[i];
        } else if (i + arguments >= argc) {
            fprintf(stderr, "keepout_field: %s takes %d argument(s)\n", argv[i], arguments);
            return false;
        } else {
            if (!take(argv + i, options))
                return false;
            i += arguments;
        }
    }
    return true;
}
