/* Evaluation takes no memory: every allocator of the C library is counted here, in the place of its own (glibc's). */

#include "check.h"
#include <errno.h>

extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);
extern void *__libc_memalign(size_t, size_t);

static unsigned long n_allocations;

void *malloc(size_t size) {
    __atomic_add_fetch(&n_allocations, 1, __ATOMIC_RELAXED);
    return __libc_malloc(size);
}

void *calloc(size_t n, size_t size) {
    __atomic_add_fetch(&n_allocations, 1, __ATOMIC_RELAXED);
    return __libc_calloc(n, size);
}

void *realloc(void *old, size_t size) {
    __atomic_add_fetch(&n_allocations, 1, __ATOMIC_RELAXED);
    return __libc_realloc(old, size);
}

void *memalign(size_t alignment, size_t size) {
    __atomic_add_fetch(&n_allocations, 1, __ATOMIC_RELAXED);
    return __libc_memalign(alignment, size);
}

void *aligned_alloc(size_t alignment, size_t size) {
    return memalign(alignment, size);
}

int posix_memalign(void **out, size_t alignment, size_t size) {
    *out = memalign(alignment, size);
    return *out == NULL ? ENOMEM : 0;
}

/* Allocations that the call made. */
#define COUNTED(call) (n_allocations = 0, OK(call), n_allocations)

enum { N = 2000 };
static double values[N], gradients[3 * N], hessians[6 * N];
static uint8_t flags[N];

/* Points [dim * N] inside the box and outside it are evaluated without memory, whatever is wanted. */
static void check_evaluation(const ko_field *field, const double *inside, const double *outside) {
    const double *const batches[] = {inside, outside};
    for (int b = 0; b < 2; b++) {
        const double *points = batches[b];
        CHECK(COUNTED(ko_field_eval(field, points, N, values, NULL, NULL)) == 0);
        CHECK(COUNTED(ko_field_eval(field, points, N, values, gradients, NULL)) == 0);
        CHECK(COUNTED(ko_field_eval(field, points, N, NULL, gradients, NULL)) == 0);
        CHECK(COUNTED(ko_field_eval(field, points, N, NULL, NULL, hessians)) == 0);
        CHECK(COUNTED(ko_field_eval(field, points, N, values, gradients, hessians)) == 0);
        CHECK(COUNTED(ko_field_outside_box(field, points, N, flags)) == 0);
    }
    ko_fit_report report;
    CHECK(COUNTED(ko_field_get_report(field, sizeof report, &report)) == 0);
}

/* So are explicit formulations, over all points and over the nearest. */
static void check_explicit(const double *points) {
    ko_cloud *cloud = check_sphere(200);
    for (int32_t kind = KO_EXPLICIT_HICKEN_KAUR_LINEAR; kind <= KO_EXPLICIT_NEAREST_POINT; kind++) {
        for (uint32_t n_nearest = 0; n_nearest < 2; n_nearest++) {
            ko_explicit_options options;
            OK(ko_explicit_options_init(&options, sizeof options));
            options.formulation = kind;
            options.n_nearest = n_nearest;
            ko_explicit *made = NULL;
            CHECK(COUNTED(ko_explicit_create(cloud, &options, &made)) > 0);
            CHECK(COUNTED(ko_explicit_eval(made, points, N, values, gradients)) == 0);
            ko_explicit_free(made);
        }
    }
    ko_cloud_free(cloud);
}

int main(void) {
    ko_field *field = check_sphere_field(8), *plane = check_circle_field(8);
    double *inside = check_points(N, 0.9, 1), *outside = check_points(N, 5.0, 2);
    check_evaluation(field, inside, outside);
    check_evaluation(plane, inside, outside);
    check_explicit(outside);

    /* The counter counts: these calls do allocate. */
    ko_mesh *mesh = NULL;
    CHECK(COUNTED(ko_mesh_from_triangles(check_cube_vertices, 8, check_cube_triangles, 12, &mesh)) > 0);
    CHECK(COUNTED(ko_field_eval_parallel(field, inside, N, values, NULL, NULL, 2)) > 0);
    CHECK(COUNTED(ko_field_save(field, "allocations.kof")) > 0);
    CHECK(remove("allocations.kof") == 0);

    ko_mesh_free(mesh);
    ko_field_free(field);
    ko_field_free(plane);
    free(inside);
    free(outside);
    return check_result();
}
