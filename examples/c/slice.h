/* A field on a plane through the middle of its box, or, in the plane, on all of it. SPDX-License-Identifier: Apache-2.0 OR MIT */
#ifndef SLICE_H
#define SLICE_H

#include <keepout.h>
#include <stdbool.h>

/* The plane of the box's two longest extents, or x to the right and y up of a field of the plane; one sample a pixel, rows from the top. */
struct slice {
    int right, up;     /* axes of the picture */
    int width, height; /* pixels */
    double pixel;      /* edge of a pixel, in the field's unit */
    double *values;    /* [width * height] */
    double *slopes;    /* [width * height], length of the gradient within the plane */
    double min, max;   /* of values */
};

/* Evaluates the field, `longest` pixels along the longer axis. Says on stderr where that fails; free it in any case. */
bool slice_take(const ko_field *field, const ko_fit_report *report, int longest, uint32_t n_threads, struct slice *slice);

void slice_free(struct slice *slice);

#endif
