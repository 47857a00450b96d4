/* What the tests in C and C++ share: checks that count, and a few shapes. A test returns check_result() from main. */

#ifndef KEEPOUT_CHECK_H
#define KEEPOUT_CHECK_H

#include <keepout.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A test that lacks what it needs ends with this; CTest knows it as "skipped". */
enum { CHECK_SKIPPED = 77 };

static int check_failures = 0;

/* The condition holds. */
#define CHECK(condition) check_that((condition), #condition, __FILE__, __LINE__)

/* |a - b| <= tolerance; false for NaN. */
#define CHECK_NEAR(a, b, tolerance) check_near((a), (b), (tolerance), #a " = " #b, __FILE__, __LINE__)

/* The call succeeds. */
#define OK(call) check_status((call), KO_OK, "", #call, __FILE__, __LINE__)

/* The call fails with this status, and with a message that contains these words. */
#define FAILS(call, status, words) check_status((call), (status), (words), #call, __FILE__, __LINE__)

/* A handle that a failed call must set to NULL. */
#define STALE(type) ((type *)(uintptr_t)8)

/* A pointer that is not NULL and not aligned for anything but bytes. */
#define MISALIGNED(pointer) ((void *)((char *)(pointer) + 1))

static inline void check_that(int holds, const char *what, const char *file, int line) {
    if (!holds) {
        check_failures++;
        fprintf(stderr, "%s:%d: not so: %s\n", file, line, what);
    }
}

static inline void check_near(double a, double b, double tolerance, const char *what, const char *file, int line) {
    if (!(fabs(a - b) <= tolerance)) {
        check_failures++;
        fprintf(stderr, "%s:%d: not so: %s: %.17g and %.17g differ by %.3g, more than %.3g\n", file, line, what, a, b,
                fabs(a - b), tolerance);
    }
}

static inline void check_status(int32_t status, int32_t right, const char *words, const char *call, const char *file,
                                int line) {
    int fails = status < 0;
    if (status != right || (fails && strstr(ko_last_error(), words) == NULL)) {
        check_failures++;
        fprintf(stderr, "%s:%d: %s: %s \"%s\"; right is %s with \"%s\"\n", file, line, call, ko_status_string(status),
                fails ? ko_last_error() : "", ko_status_string(right), words);
    }
}

static inline int check_result(void) {
    if (check_failures > 0) {
        fprintf(stderr, "%d checks failed\n", check_failures);
    }
    return check_failures > 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}

/* A number in [0, 1), the next of a sequence (splitmix64). */
static inline double check_random(uint64_t *state) {
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/* `n` points [3 * n], uniform in the cube [-half, half]^3. The caller frees them. */
static inline double *check_points(size_t n, double half, uint64_t seed) {
    double *points = (double *)malloc(3 * n * sizeof *points);
    for (size_t i = 0; i < 3 * n; i++) {
        points[i] = half * (2.0 * check_random(&seed) - 1.0);
    }
    return points;
}

/* The cube [-1, 1]^3. */
static const double check_cube_vertices[24] = {
    -1, -1, -1, 1, -1, -1, -1, 1, -1, 1, 1, -1, -1, -1, 1, 1, -1, 1, -1, 1, 1, 1, 1, 1,
};
static const uint32_t check_cube_triangles[36] = {
    0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6,
};

static inline ko_mesh *check_cube(void) {
    ko_mesh *mesh = NULL;
    OK(ko_mesh_from_triangles(check_cube_vertices, 8, check_cube_triangles, 12, &mesh));
    return mesh;
}

/* `n` points [3 * n] of the unit sphere, which are their normals too, along a spiral. The caller frees them. */
static inline double *check_sphere_points(size_t n) {
    double *points = (double *)malloc(3 * n * sizeof *points);
    for (size_t i = 0; i < n; i++) {
        double z = 1.0 - (2.0 * (double)i + 1.0) / (double)n;
        double r = sqrt(1.0 - z * z);
        double angle = 2.399963229728653 * (double)i;
        points[3 * i] = r * cos(angle);
        points[3 * i + 1] = r * sin(angle);
        points[3 * i + 2] = z;
    }
    return points;
}

static inline ko_cloud *check_sphere(size_t n) {
    double *points = check_sphere_points(n);
    ko_cloud *cloud = NULL;
    OK(ko_cloud_from_points(3, points, points, n, &cloud));
    free(points);
    return cloud;
}

/* `n` points [2 * n] of the unit circle, counter-clockwise, which are their normals too. The caller frees them. */
static inline double *check_circle_points(size_t n) {
    double *points = (double *)malloc(2 * n * sizeof *points);
    for (size_t i = 0; i < n; i++) {
        double angle = 6.283185307179586 * (double)i / (double)n;
        points[2 * i] = cos(angle);
        points[2 * i + 1] = sin(angle);
    }
    return points;
}

static inline ko_cloud *check_circle(size_t n) {
    double *points = check_circle_points(n);
    ko_cloud *cloud = NULL;
    OK(ko_cloud_from_points(2, points, points, n, &cloud));
    free(points);
    return cloud;
}

/* The square [-1, 1]^2 around the hole [-0.5, 0.5]^2. */
static const double check_frame_points[16] = {
    -1, -1, 1, -1, 1, 1, -1, 1, -0.5, -0.5, -0.5, 0.5, 0.5, 0.5, 0.5, -0.5,
};
static const size_t check_frame_starts[2] = {0, 4};

static inline ko_mesh *check_frame(void) {
    ko_mesh *mesh = NULL;
    OK(ko_mesh_from_polylines(check_frame_points, 8, check_frame_starts, 2, 1, &mesh));
    return mesh;
}

/* The sphere in space or circle in the plane, of radius 1, squeezed to an edge of about 50 degrees at x = 0: cells are hard put there. */
static inline ko_cloud *check_lens(uint32_t dim, size_t n) {
    double *points = dim == 2 ? check_circle_points(n) : check_sphere_points(n);
    double *normals = (double *)malloc(dim * n * sizeof *normals);
    for (size_t i = 0; i < n; i++) {
        double *p = &points[dim * i], *normal = &normals[dim * i], side = p[0] < 0 ? -1.0 : 1.0;
        memcpy(normal, p, dim * sizeof *p);
        /* Caps beyond |x| = 0.9, moved together: their rim is the edge. */
        normal[0] = side * (0.9 + 0.1 * fabs(p[0]));
        double rest = sqrt(1.0 - normal[0] * normal[0]), length = sqrt(1.0 - p[0] * p[0]);
        for (uint32_t a = 1; a < dim; a++) {
            normal[a] = length > 0 ? p[a] / length * rest : 0.0;
        }
        memcpy(p, normal, dim * sizeof *p);
        p[0] -= 0.9 * side;
    }
    ko_cloud *cloud = NULL;
    OK(ko_cloud_from_points(dim, points, normals, n, &cloud));
    free(points);
    free(normals);
    return cloud;
}

/* Options of a small fit on this thread alone: `n` control points along each axis. */
static inline ko_fit_options check_options(uint32_t n) {
    ko_fit_options options;
    OK(ko_fit_options_init(&options, sizeof options));
    for (int a = 0; a < 3; a++) {
        options.control_points[a] = n;
    }
    options.n_threads = 1;
    return options;
}

/* A field of the unit sphere with `n` control points along each axis. */
static inline ko_field *check_sphere_field(uint32_t n) {
    ko_cloud *cloud = check_sphere(500);
    ko_fit_options options = check_options(n);
    ko_field *field = NULL;
    OK(ko_field_fit(cloud, &options, &field));
    ko_cloud_free(cloud);
    return field;
}

/* A field of the unit circle with `n` control points along each axis. */
static inline ko_field *check_circle_field(uint32_t n) {
    ko_cloud *cloud = check_circle(200);
    ko_fit_options options = check_options(n);
    ko_field *field = NULL;
    OK(ko_field_fit(cloud, &options, &field));
    ko_cloud_free(cloud);
    return field;
}

/* A smooth field made of 8 control points along each axis on the box [-1, 1]^dim: about a ball of radius 0.6, not quite round. It takes no
 * fit. */
static inline ko_field *check_made_field(uint32_t dim) {
    const uint32_t counts[3] = {8, 8, 8};
    const double low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
    const size_t n = dim == 2 ? 64 : 512;
    double control_points[512];
    for (size_t i = 0; i < n; i++) {
        double square = 0.0, bumps = 0.0;
        for (size_t a = 0, rest = i; a < dim; a++, rest /= 8) {
            double x = -1.0 + ((double)(rest % 8) - 1.0) * 0.4;
            square += x * x;
            bumps += 0.05 * sin(3.0 * x + (double)a);
        }
        control_points[i] = sqrt(square + 0.05) - 0.6 + bumps;
    }
    ko_field *field = NULL;
    OK(ko_field_from_control_points(dim, counts, low, high, KO_FEASIBLE_OUTSIDE, 2.5, control_points, n, &field));
    return field;
}

/* A body of `n` points drawn from [-0.4, 0.4]^dim. */
static inline ko_body *check_body(uint32_t dim, size_t n, uint64_t seed) {
    double *points = check_points(n, 0.4, seed);
    ko_body *body = NULL;
    OK(ko_body_from_points(dim, points, n, 0.0, &body));
    free(points);
    return body;
}

/* The aggregation of this kind, of a sharpness that leaves many samples their say. */
static inline ko_aggregation check_aggregation(int32_t kind) {
    ko_aggregation aggregation;
    OK(ko_aggregation_init(&aggregation, sizeof aggregation));
    aggregation.kind = kind;
    aggregation.sharpness = 20.0;
    return aggregation;
}

#endif
