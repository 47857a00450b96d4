/* SPDX-License-Identifier: Apache-2.0 OR MIT */
#include "slice.h"

#include "failure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static double extent(const ko_fit_report *report, int axis)
{
    return report->box_max[axis] - report->box_min[axis];
}

/* Looks against the shortest axis, so that the others lie as in a right-handed frame. */
static void choose_plane(const ko_fit_report *report, int longest, struct slice *slice)
{
    int shortest = 2; /* stays so in the plane */
    for (int k = 1; k >= 0 && report->dim == 3; --k)
        if (extent(report, k) < extent(report, shortest))
            shortest = k;
    slice->right = (shortest + 1) % 3;
    slice->up = (shortest + 2) % 3;
    const double width = extent(report, slice->right), height = extent(report, slice->up);
    slice->pixel = fmax(width, height) / longest;
    slice->width = (int)ceil(width / slice->pixel);
    slice->height = (int)ceil(height / slice->pixel);
}

/* `points` [dim * width * height] */
static void place_points(const ko_fit_report *report, const struct slice *slice, double *points)
{
    const uint32_t dim = report->dim;
    double middle[3];
    for (int k = 0; k < 3; ++k)
        middle[k] = 0.5 * (report->box_min[k] + report->box_max[k]);
    for (int y = 0; y < slice->height; ++y) {
        for (int x = 0; x < slice->width; ++x, points += dim) {
            for (uint32_t k = 0; k < dim; ++k)
                points[k] = middle[k];
            points[slice->right] += (x + 0.5 - 0.5 * slice->width) * slice->pixel;
            points[slice->up] -= (y + 0.5 - 0.5 * slice->height) * slice->pixel;
        }
    }
}

/* Keeps of the gradients [dim * n] what the picture needs. */
static void summarise(const double *gradients, uint32_t dim, size_t n, struct slice *slice)
{
    slice->min = slice->max = slice->values[0];
    for (size_t i = 0; i < n; ++i) {
        slice->slopes[i] = hypot(gradients[dim * i + (size_t)slice->right], gradients[dim * i + (size_t)slice->up]);
        slice->min = fmin(slice->min, slice->values[i]);
        slice->max = fmax(slice->max, slice->values[i]);
    }
    if (slice->max == slice->min)
        slice->max += slice->pixel; /* a flat field has no range, and a legend needs one */
}

bool slice_take(const ko_field *field, const ko_fit_report *report, int longest, uint32_t n_threads, struct slice *slice)
{
    choose_plane(report, longest, slice);
    const size_t n = (size_t)slice->width * (size_t)slice->height;
    double *points = malloc(report->dim * n * sizeof *points);
    double *gradients = malloc(report->dim * n * sizeof *gradients);
    slice->values = malloc(n * sizeof *slice->values);
    slice->slopes = malloc(n * sizeof *slice->slopes);
    bool ok = points != NULL && gradients != NULL && slice->values != NULL && slice->slopes != NULL;
    if (ok) {
        place_points(report, slice, points);
        ok = succeeded(ko_field_eval_parallel(field, points, n, slice->values, gradients, NULL, n_threads), "evaluating a slice");
    } else {
        fprintf(stderr, "keepout_field: no memory for a slice of %zu points\n", n);
    }
    if (ok)
        summarise(gradients, report->dim, n, slice);
    free(points);
    free(gradients);
    return ok;
}

void slice_free(struct slice *slice)
{
    free(slice->values);
    free(slice->slopes);
    *slice = (struct slice){0};
}
