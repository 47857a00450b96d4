/* Many threads at once: values do not depend on company, errors stay with the thread that made them. */

#include "check.h"
#include <pthread.h>

enum { N_THREADS = 8, N_POINTS = 3000, N_ROUNDS = 10 };

static ko_mesh *mesh;
static ko_field *field;
static double *points, values[N_POINTS], distances[N_POINTS];

struct worker {
    pthread_t thread;
    int index;
    int failures;
};

static void *work(void *data) {
    struct worker *worker = data;
    double *mine = malloc(3 * N_POINTS * sizeof *mine), results[N_POINTS];
    memcpy(mine, points, 3 * N_POINTS * sizeof *mine);
    char words[32];
    for (int round = 0; round < N_ROUNDS; round++) {
        worker->failures += ko_field_eval(field, points, N_POINTS, results, NULL, NULL) != KO_OK;
        worker->failures += memcmp(results, values, sizeof values) != 0;
        worker->failures += ko_mesh_signed_distance(mesh, points, N_POINTS, results) != KO_OK;
        worker->failures += memcmp(results, distances, sizeof distances) != 0;

        int bad = 100 * worker->index + round;
        mine[3 * bad] = NAN;
        snprintf(words, sizeof words, "point %d ", bad);
        worker->failures += ko_field_eval(field, mine, N_POINTS, results, NULL, NULL) != KO_ERR_INVALID_ARGUMENT;
        worker->failures += strstr(ko_last_error(), words) == NULL;
        mine[3 * bad] = 0.0;
    }
    free(mine);
    return NULL;
}

static void threads_do_not_meet(void) {
    /* Distances first on another mesh: here the threads race to build the tree. */
    ko_mesh *other = check_cube();
    OK(ko_mesh_signed_distance(other, points, N_POINTS, distances));
    ko_mesh_free(other);
    OK(ko_field_eval(field, points, N_POINTS, values, NULL, NULL));
    FAILS(ko_mesh_flip(NULL), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    struct worker workers[N_THREADS];
    for (int i = 0; i < N_THREADS; i++) {
        workers[i].index = i;
        workers[i].failures = 0;
        CHECK(pthread_create(&workers[i].thread, NULL, work, &workers[i]) == 0);
    }
    for (int i = 0; i < N_THREADS; i++) {
        CHECK(pthread_join(workers[i].thread, NULL) == 0);
        CHECK(workers[i].failures == 0);
    }
    /* None of their errors came here. */
    CHECK(strstr(ko_last_error(), "mesh is NULL") != NULL);
}

static void threads_do_not_change_the_bits(void) {
    enum { N = 20000 };
    double *many = check_points(N, 2.0, 2);
    double *one = malloc(10 * N * sizeof *one), *spread = malloc(10 * N * sizeof *spread);
    OK(ko_field_eval(field, many, N, one, one + N, one + 4 * N));
    const uint32_t n_threads[] = {0, 1, 2, 3, 8};
    for (size_t t = 0; t < sizeof n_threads / sizeof *n_threads; t++) {
        memset(spread, 0xff, 10 * N * sizeof *spread);
        OK(ko_field_eval_parallel(field, many, N, spread, spread + N, spread + 4 * N, n_threads[t]));
        CHECK(memcmp(one, spread, 10 * N * sizeof *one) == 0);
        OK(ko_field_eval_parallel(field, NULL, 0, NULL, NULL, NULL, n_threads[t]));
    }
    /* The first bad point is named, whoever finds which first. */
    many[3 * 19000] = many[3 * 9001 + 1] = NAN;
    for (size_t t = 0; t < sizeof n_threads / sizeof *n_threads; t++) {
        FAILS(ko_field_eval_parallel(field, many, N, spread, NULL, NULL, n_threads[t]), KO_ERR_INVALID_ARGUMENT,
              "point 9001 ");
    }
    FAILS(ko_field_eval_parallel(field, many, 1, spread, NULL, NULL, UINT32_MAX), KO_ERR_INVALID_ARGUMENT, "n_threads is");
    FAILS(ko_field_eval_parallel(field, many, N, spread, NULL, NULL, UINT32_MAX), KO_ERR_INVALID_ARGUMENT,
          "n_threads is 4294967295");
    free(many);
    free(one);
    free(spread);
}

static void fits_do_not_depend_on_threads(void) {
    ko_cloud *cloud = check_sphere(2000);
    ko_fit_options options = check_options(12);
    double one[N_POINTS], other[N_POINTS];
    for (options.n_threads = 1; options.n_threads <= 3; options.n_threads++) {
        ko_field *fitted = NULL;
        OK(ko_field_fit(cloud, &options, &fitted));
        OK(ko_field_eval(fitted, points, N_POINTS, options.n_threads == 1 ? one : other, NULL, NULL));
        CHECK(options.n_threads == 1 || memcmp(one, other, sizeof one) == 0);
        ko_field_free(fitted);
    }
    ko_cloud_free(cloud);
}

static void level_sets_do_not_depend_on_threads(void) {
    ko_level_set_options options;
    OK(ko_level_set_options_init(&options, sizeof options));
    ko_mesh *sets[3] = {NULL, NULL, NULL};
    double *vertices[3] = {NULL, NULL, NULL};
    uint32_t *triangles[3] = {NULL, NULL, NULL};
    size_t n[3] = {0}, n_triangles[3] = {0};
    for (uint32_t i = 0; i < 3; i++) {
        options.n_threads = i + 1;
        OK(ko_field_level_set(field, 0.0, &options, &sets[i]));
        OK(ko_mesh_get_size(sets[i], &n[i], &n_triangles[i]));
        vertices[i] = malloc(3 * n[i] * sizeof **vertices);
        triangles[i] = malloc(3 * n_triangles[i] * sizeof **triangles);
        OK(ko_mesh_copy(sets[i], n[i], n_triangles[i], vertices[i], triangles[i]));
        CHECK(n[i] == n[0] && n_triangles[i] == n_triangles[0]);
        CHECK(memcmp(vertices[i], vertices[0], 3 * n[0] * sizeof **vertices) == 0);
        CHECK(memcmp(triangles[i], triangles[0], 3 * n_triangles[0] * sizeof **triangles) == 0);
    }
    for (int i = 0; i < 3; i++) {
        ko_mesh_free(sets[i]);
        free(vertices[i]);
        free(triangles[i]);
    }
}

/* ---- constraints ---- */

enum { N_BODY = 600, N_X = 8, N_VALUES = N_BODY + 2, N_ENTRIES = N_X * N_VALUES };

struct evaluation {
    double values[N_VALUES], entries[N_ENTRIES], product[N_X], hessian[N_X * (N_X + 1) / 2];
};

static ko_constraints *constraints;
static struct evaluation evaluated;

static int evaluate(struct evaluation *to) {
    const double x[N_X] = {0.1, -0.1, 0.2, 1, 0.2, -0.3, 0.1, 1.1};
    double w[N_VALUES];
    for (int i = 0; i < N_VALUES; i++) {
        w[i] = 1.0 / (1 + i);
    }
    int failures = ko_constraints_values(constraints, x, N_X, N_VALUES, to->values) != KO_OK;
    failures += ko_constraints_jacobian(constraints, x, N_X, N_ENTRIES, to->entries) != KO_OK;
    failures += ko_constraints_transposed_jacobian_times(constraints, x, N_X, w, N_VALUES, to->product) != KO_OK;
    return failures + (ko_constraints_hessian(constraints, x, N_X, w, N_VALUES, N_X * (N_X + 1) / 2, to->hessian) != KO_OK);
}

static void *constrain(void *data) {
    struct worker *worker = data;
    struct evaluation *mine = malloc(sizeof *mine);
    const double bad[N_X] = {0};
    for (int round = 0; round < N_ROUNDS; round++) {
        worker->failures += evaluate(mine);
        worker->failures += memcmp(mine, &evaluated, sizeof evaluated) != 0;
        worker->failures += ko_constraints_values(constraints, bad, N_X, N_VALUES, mine->values) != KO_ERR_INVALID_ARGUMENT;
        worker->failures += strstr(ko_last_error(), "quaternion of length 0") == NULL;
    }
    free(mine);
    return NULL;
}

static void threads_share_constraints(void) {
    ko_field *made = check_made_field(3);
    ko_body *body = check_body(3, N_BODY, 4);
    ko_aggregation each = check_aggregation(KO_AGGREGATE_NONE), induced = check_aggregation(KO_AGGREGATE_INDUCED_EXPONENTIAL);
    uint32_t frame = 0;
    OK(ko_constraints_create(3, &constraints));
    OK(ko_constraints_add_frame(constraints, KO_ROTATION_QUATERNION, KO_SCALE_FREE, &frame));
    OK(ko_constraints_keep_body(constraints, body, frame, made, KO_WORLD, &each, NULL));
    OK(ko_constraints_keep_body(constraints, body, frame, made, KO_WORLD, NULL, NULL));
    OK(ko_constraints_keep_body(constraints, body, KO_WORLD, made, frame, &induced, NULL));
    ko_body_free(body);
    ko_field_free(made);
    CHECK(evaluate(&evaluated) == 0);
    FAILS(ko_mesh_flip(NULL), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    struct worker workers[N_THREADS];
    for (int i = 0; i < N_THREADS; i++) {
        workers[i].index = i;
        workers[i].failures = 0;
        CHECK(pthread_create(&workers[i].thread, NULL, constrain, &workers[i]) == 0);
    }
    for (int i = 0; i < N_THREADS; i++) {
        CHECK(pthread_join(workers[i].thread, NULL) == 0);
        CHECK(workers[i].failures == 0);
    }
    CHECK(strstr(ko_last_error(), "mesh is NULL") != NULL);
    ko_constraints_free(constraints);
}

int main(void) {
    mesh = check_cube();
    field = check_sphere_field(8);
    points = check_points(N_POINTS, 2.0, 1);
    threads_do_not_meet();
    threads_do_not_change_the_bits();
    fits_do_not_depend_on_threads();
    level_sets_do_not_depend_on_threads();
    threads_share_constraints();
    free(points);
    ko_field_free(field);
    ko_mesh_free(mesh);
    return check_result();
}
