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

/* The same of fields with refined cells. Points of the plane are the first two thirds of those in space. */
static void check_refined(const double *inside, const double *outside) {
    for (uint32_t dim = 2; dim <= 3; dim++) {
        ko_cloud *cloud = check_lens(dim, 400);
        ko_fit_options options = check_options(8);
        options.max_error = 1e-3;
        options.tolerance = 1e-2;
        ko_field *field = NULL;
        CHECK(ko_field_fit(cloud, &options, &field) >= 0);
        ko_fit_report report;
        OK(ko_field_get_report(field, sizeof report, &report));
        CHECK(report.n_levels > 1);
        check_evaluation(field, inside, outside);
        ko_field_free(field);
        ko_cloud_free(cloud);
    }
}

/* A body in a frame by each aggregate, alone and in a field that moves; points that are variables; both in several fields as one. */
static void check_constraints(uint32_t dim) {
    enum { N_VALUES = 3 * 300 + 4 + 20 + 1, MOST = 12000 };
    static double jacobian[MOST], dense[N_VALUES * 60], entries[MOST];
    ko_field *field = check_made_field(dim);
    ko_body *body = check_body(dim, 300, 2);
    ko_constraints *set = NULL;
    uint32_t frame = 0, other = 0, path = 0;
    OK(ko_constraints_create(dim, &set));
    OK(ko_constraints_add_frame(set, dim == 3 ? KO_ROTATION_VECTOR : KO_ROTATION_ANGLE, KO_SCALE_FREE, &frame));
    OK(ko_constraints_add_frame(set, KO_ROTATION_NONE, KO_SCALE_FREE, &other));
    OK(ko_constraints_add_points(set, 10, &path));
    for (int32_t kind = KO_AGGREGATE_NONE; kind <= KO_AGGREGATE_P_NORM; kind++) {
        ko_aggregation aggregation = check_aggregation(kind);
        OK(ko_constraints_keep_body(set, body, frame, field, other, &aggregation, NULL));
        OK(ko_constraints_keep_points(set, path, field, kind % 2 == 0 ? KO_WORLD : frame, &aggregation, NULL));
    }
    /* The union of three. */
    const ko_field *fields[3] = {field, field, field};
    OK(ko_constraints_keep_body_in_fields(set, body, frame, fields, 3, KO_LARGEST, NULL, other, NULL, NULL));
    OK(ko_constraints_keep_points_in_fields(set, path, fields, 3, KO_LARGEST, NULL, KO_WORLD, NULL, NULL));
    size_t n = 0, m = 0, n_jacobian = 0, n_hessian = 0;
    OK(ko_constraints_get_size(set, &n, &m, &n_jacobian, &n_hessian));
    CHECK(n <= 60 && m <= N_VALUES && n_jacobian <= MOST && n_hessian <= MOST);
    double *x = check_points(n, 0.3, 6), *w = check_points(m, 1.0, 7);
    size_t first = 0, n_first = 0;
    OK(ko_constraints_get_frame_variables(set, frame, &first, &n_first));
    x[first + n_first - 1] = 1.1;
    OK(ko_constraints_get_frame_variables(set, other, &first, &n_first));
    x[first + n_first - 1] = 0.9;
    CHECK(COUNTED(ko_constraints_values(set, x, n, m, values)) == 0);
    CHECK(COUNTED(ko_constraints_jacobian(set, x, n, n_jacobian, jacobian)) == 0);
    CHECK(COUNTED(ko_constraints_values_and_jacobian(set, x, n, m, values, n_jacobian, jacobian)) == 0);
    CHECK(COUNTED(ko_constraints_dense_jacobian(set, x, n, m, dense)) == 0);
    CHECK(COUNTED(ko_constraints_jacobian_times(set, x, x, n, m, values)) == 0);
    CHECK(COUNTED(ko_constraints_transposed_jacobian_times(set, x, n, w, m, values)) == 0);
    CHECK(COUNTED(ko_constraints_hessian(set, x, n, w, m, n_hessian, entries)) == 0);
    ko_aggregation aggregation = check_aggregation(KO_AGGREGATE_KS);
    CHECK(COUNTED(ko_aggregate(&aggregation, KO_LEAST, 1.0, w, 100, values, gradients, dense)) == 0);
    free(x);
    free(w);
    ko_constraints_free(set);
    ko_body_free(body);
    ko_field_free(field);
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

/* So are motions, products of them too. */
static void check_motions(void) {
    const double center[2] = {1.0, 2.0}, times[3] = {0.0, 0.4, 1.0};
    ko_law law;
    OK(ko_law_init(&law, sizeof law));
    law.slope = 3.0;
    ko_motion *turn = NULL, *product = NULL;
    OK(ko_motion_turn(center, &law, &turn));
    CHECK(COUNTED(ko_motion_product(turn, turn, &product)) > 0);
    double rotations[12], translations[6];
    CHECK(COUNTED(ko_motion_eval(product, times, 3, rotations, translations)) == 0);
    ko_motion_free(turn);
    ko_motion_free(product);
}

int main(void) {
    ko_field *field = check_sphere_field(8), *plane = check_circle_field(8);
    double *inside = check_points(N, 0.9, 1), *outside = check_points(N, 5.0, 2);
    check_evaluation(field, inside, outside);
    check_evaluation(plane, inside, outside);
    check_refined(inside, outside);
    check_constraints(2);
    check_constraints(3);
    check_explicit(outside);
    check_motions();

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
