/* SPDX-License-Identifier: Apache-2.0 OR MIT */
#include "shape.h"

#include "failure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { ALONG = 360, AROUND = 48 };

static const double TURN = 6.283185307179586;
static const double RADIUS = 0.42;
static const double RISE = 0.65; /* how far the knot leaves the plane z = 0 where it crosses itself: a tube that does not meet itself */

static void cross(const double a[3], const double b[3], double c[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static void normalise(double a[3])
{
    const double length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    for (int k = 0; k < 3; ++k)
        a[k] /= length;
}

/* The knot c(t) = (2 cos 2t - cos t, sin t + 2 sin 2t, RISE sin 3t), with its normal and binormal; its curvature never vanishes. */
static void frame(double t, double centre[3], double normal[3], double binormal[3])
{
    const double at[3] = {2 * cos(2 * t) - cos(t), sin(t) + 2 * sin(2 * t), RISE * sin(3 * t)};
    const double first[3] = {sin(t) - 4 * sin(2 * t), cos(t) + 4 * cos(2 * t), 3 * RISE * cos(3 * t)};
    const double second[3] = {cos(t) - 8 * cos(2 * t), -sin(t) - 8 * sin(2 * t), -9 * RISE * sin(3 * t)};
    for (int k = 0; k < 3; ++k)
        centre[k] = at[k];
    cross(first, second, binormal);
    normalise(binormal);
    cross(binormal, first, normal);
    normalise(normal);
}

/* Rings of AROUND vertices, ALONG the knot. */
static void fill_vertices(double *vertices)
{
    for (int i = 0; i < ALONG; ++i) {
        double centre[3], normal[3], binormal[3];
        frame(TURN * i / ALONG, centre, normal, binormal);
        for (int j = 0; j < AROUND; ++j) {
            const double angle = TURN * j / AROUND;
            for (int k = 0; k < 3; ++k)
                *vertices++ = centre[k] + RADIUS * (cos(angle) * normal[k] + sin(angle) * binormal[k]);
        }
    }
}

/* Two triangles between neighbours of a ring and those of the next, counter-clockwise seen from outside. */
static void fill_triangles(uint32_t *triangles)
{
    for (uint32_t i = 0; i < ALONG; ++i) {
        for (uint32_t j = 0; j < AROUND; ++j) {
            const uint32_t next_i = (i + 1) % ALONG, next_j = (j + 1) % AROUND;
            const uint32_t a = i * AROUND + j, b = i * AROUND + next_j;
            const uint32_t c = next_i * AROUND + next_j, d = next_i * AROUND + j;
            const uint32_t corners[6] = {a, b, c, a, c, d};
            for (int k = 0; k < 6; ++k)
                *triangles++ = corners[k];
        }
    }
}

bool shape_trefoil(ko_mesh **mesh)
{
    const size_t n_vertices = (size_t)ALONG * AROUND, n_triangles = 2 * n_vertices;
    double *vertices = malloc(3 * n_vertices * sizeof *vertices);
    uint32_t *triangles = malloc(3 * n_triangles * sizeof *triangles);
    bool ok = vertices != NULL && triangles != NULL;
    if (ok) {
        fill_vertices(vertices);
        fill_triangles(triangles);
        ok = succeeded(ko_mesh_from_triangles(vertices, n_vertices, triangles, n_triangles, mesh), "making a shape");
    } else {
        fprintf(stderr, "keepout_field: no memory for a shape\n");
    }
    free(vertices);
    free(triangles);
    return ok;
}
