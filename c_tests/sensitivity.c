/* Derivatives of a field's values by its cloud, and by the vertices of the cloud's mesh. */

#include "check.h"

enum { N = 400, J = 4 };

/* Points of J, on both sides of the unit sphere or circle, one of them outside the box. */
static const double places[3 * J] = {0.9, 0.1, 0.2, 1.1, -0.2, 0.1, -0.3, 0.2, 0.1, 1.9, 0.4, -0.3};
static const double weights[J] = {1.0, -0.5, 2.0, 0.25};

static double j_of(const ko_field *field) {
    double values[J], sum = 0.0;
    OK(ko_field_eval(field, places, J, values, NULL, NULL));
    for (int j = 0; j < J; j++) {
        sum += weights[j] * values[j];
    }
    return sum;
}

/* The defaults, solved to the end. */
static ko_fit_options solved_options(void) {
    ko_fit_options options = check_options(10);
    options.tolerance = 1e-12;
    return options;
}

static double *room(size_t n) {
    double *numbers = malloc(n * sizeof *numbers);
    for (size_t i = 0; i < n; i++) {
        numbers[i] = NAN;
    }
    return numbers;
}

/* How the points are moved, and their normals by twice that. */
static double step_of(size_t k) { return sin(0.7 * (double)k); }

/* J of the sphere or circle moved by h of its way, refitted with all held that a sensitivity holds. */
static double j_moved(const ko_field *start, uint32_t dim, double h) {
    double *there = dim == 2 ? check_circle_points(N) : check_sphere_points(N);
    double *points = room(dim * N), *normals = room(dim * N);
    for (size_t k = 0; k < dim * N; k++) {
        points[k] = there[k] + h * step_of(k);
        normals[k] = there[k] + 2.0 * h * step_of(k);
    }
    ko_cloud *cloud = NULL;
    ko_field *field = NULL;
    ko_fit_options options = solved_options();
    options.reweighting = KO_REWEIGHT_KEEP;
    OK(ko_cloud_from_points(dim, points, normals, N, &cloud));
    OK(ko_field_refit(start, cloud, &options, &field));
    double j = j_of(field);
    ko_field_free(field);
    ko_cloud_free(cloud);
    free(there);
    free(points);
    free(normals);
    return j;
}

static double central_difference(const ko_field *start, uint32_t dim, double h) {
    return (j_moved(start, dim, h) - j_moved(start, dim, -h)) / (2.0 * h);
}

/* Under valgrind, which runs one thread at a time, solves on two take minutes. */
static uint32_t n_threads = 2;

static void derivatives_agree_with_differences_of_refits(uint32_t dim) {
    ko_cloud *cloud = dim == 2 ? check_circle(N) : check_sphere(N);
    ko_fit_options options = solved_options();
    ko_field *field = NULL;
    ko_sensitivity *ready = NULL;
    OK(ko_field_fit(cloud, &options, &field));
    OK(ko_sensitivity_create(field, cloud, &options, &ready));
    double *d_points = room(dim * N), *d_normals = room(dim * N), *again = room(dim * N);
    OK(ko_sensitivity_solve(ready, places, weights, J, NULL, N, d_points, d_normals));
    double h = 5e-5, by_adjoint = 0.0;
    for (size_t k = 0; k < dim * N; k++) {
        by_adjoint += (d_points[k] + 2.0 * d_normals[k]) * step_of(k);
    }
    /* Differences of sixth order: the shape is in no step so near that central ones suffice above what solves leave. */
    double narrow = central_difference(field, dim, h), middle = central_difference(field, dim, 2.0 * h);
    double wide = central_difference(field, dim, 4.0 * h);
    double by_difference = (16.0 * (4.0 * narrow - middle) - (4.0 * middle - wide)) / 45.0;
    CHECK_NEAR(by_adjoint, by_difference, 1e-6 * fabs(by_adjoint));

    /* Neither field nor cloud is needed any more; options of a solve are its own; outputs may be NULL; no weights are ones. */
    ko_field_free(field);
    ko_cloud_free(cloud);
    options.n_threads = n_threads;
    OK(ko_sensitivity_solve(ready, places, weights, J, &options, N, again, NULL));
    CHECK(memcmp(again, d_points, dim * N * sizeof *again) == 0);
    OK(ko_sensitivity_solve(ready, places, weights, J, NULL, N, NULL, again));
    CHECK(memcmp(again, d_normals, dim * N * sizeof *again) == 0);
    const double ones[J] = {1.0, 1.0, 1.0, 1.0};
    OK(ko_sensitivity_solve(ready, places, ones, J, NULL, N, d_points, NULL));
    OK(ko_sensitivity_solve(ready, places, NULL, J, NULL, N, again, NULL));
    CHECK(memcmp(again, d_points, dim * N * sizeof *again) == 0);
    OK(ko_sensitivity_solve(ready, NULL, NULL, 0, NULL, N, again, NULL));
    CHECK(again[0] == 0.0 && again[dim * N - 1] == 0.0);
    free(d_points);
    free(d_normals);
    free(again);
    ko_sensitivity_free(ready);
}

static double dot(const double *x, const double *y, size_t n) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += x[i] * y[i];
    }
    return sum;
}

/* A cloud that follows the frame with all its vertices moved by `h` of `way`, and sums of its points and normals. */
static double sums_of_followed(const ko_cloud *cloud, const double *way, double h, const double *by_points,
                               const double *by_normals) {
    double moved[16], points[2 * N], normals[2 * N];
    for (int i = 0; i < 16; i++) {
        moved[i] = check_frame_points[i] + h * way[i];
    }
    ko_mesh *mesh = NULL;
    ko_cloud *followed = NULL;
    OK(ko_mesh_from_polylines(moved, 8, check_frame_starts, 2, 1, &mesh));
    OK(ko_cloud_follow(cloud, mesh, &followed));
    OK(ko_cloud_copy(followed, N, points, normals));
    ko_cloud_free(followed);
    ko_mesh_free(mesh);
    return dot(points, by_points, 2 * N) + dot(normals, by_normals, 2 * N);
}

static void derivatives_go_back_to_vertices(void) {
    ko_mesh *mesh = check_frame();
    ko_cloud *cloud = NULL;
    OK(ko_mesh_sample(mesh, N, 1, &cloud));
    double by_points[2 * N], by_normals[2 * N], way[16], d_vertices[16];
    uint64_t state = 3;
    for (int i = 0; i < 2 * N; i++) {
        by_points[i] = check_random(&state) - 0.5;
        by_normals[i] = check_random(&state) - 0.5;
    }
    for (int i = 0; i < 16; i++) {
        way[i] = check_random(&state) - 0.5;
    }
    OK(ko_cloud_pull_back(cloud, mesh, by_points, by_normals, N, 8, d_vertices));
    double h = 1e-6, above = sums_of_followed(cloud, way, h, by_points, by_normals);
    double slope = (above - sums_of_followed(cloud, way, -h, by_points, by_normals)) / (2.0 * h);
    CHECK_NEAR(dot(d_vertices, way, 16), slope, 1e-6);
    OK(ko_cloud_pull_back(cloud, mesh, NULL, NULL, N, 8, d_vertices));
    CHECK(dot(d_vertices, d_vertices, 16) == 0.0);

    /* What does not belong together. */
    ko_mesh *cube = check_cube();
    ko_cloud *of_points = check_circle(N), *none = STALE(ko_cloud);
    FAILS(ko_cloud_follow(cloud, cube, &none), KO_ERR_INVALID_ARGUMENT, "the cloud dim 2, the mesh dim 3");
    CHECK(none == NULL);
    FAILS(ko_cloud_follow(of_points, mesh, &none), KO_ERR_INVALID_ARGUMENT, "has origins");
    FAILS(ko_cloud_pull_back(cloud, cube, by_points, NULL, N, 8, d_vertices), KO_ERR_INVALID_ARGUMENT, "the mesh dim 3");
    FAILS(ko_cloud_pull_back(of_points, mesh, by_points, NULL, N, 8, d_vertices), KO_ERR_INVALID_ARGUMENT, "has origins");
    FAILS(ko_cloud_pull_back(cloud, mesh, by_points, NULL, N - 1, 8, d_vertices), KO_ERR_INVALID_ARGUMENT, "n_points is 399");
    FAILS(ko_cloud_pull_back(cloud, mesh, by_points, NULL, N, 9, d_vertices), KO_ERR_INVALID_ARGUMENT, "n_vertices is 9");
    FAILS(ko_cloud_pull_back(cloud, mesh, by_points, NULL, N, 8, NULL), KO_ERR_INVALID_ARGUMENT, "d_vertices is NULL");
    ko_mesh_free(cube);
    ko_cloud_free(of_points);
    ko_cloud_free(cloud);
    ko_mesh_free(mesh);
}

static int32_t refuse(double fraction, const char *stage, void *data) {
    (void)fraction;
    (void)stage;
    ++*(int *)data;
    return 1;
}

static void wrong_calls_are_refused_and_long_ones_cancelled(void) {
    ko_cloud *cloud = check_sphere(N), *flat = check_circle(N), *fewer = check_sphere(N - 1);
    ko_fit_options options = check_options(10);
    ko_field *field = NULL;
    OK(ko_field_fit(cloud, &options, &field));
    ko_sensitivity *ready = STALE(ko_sensitivity);
    FAILS(ko_sensitivity_create(NULL, cloud, &options, &ready), KO_ERR_INVALID_ARGUMENT, "field is NULL");
    CHECK(ready == NULL);
    FAILS(ko_sensitivity_create(field, NULL, &options, &ready), KO_ERR_INVALID_ARGUMENT, "cloud is NULL");
    FAILS(ko_sensitivity_create(field, cloud, &options, NULL), KO_ERR_INVALID_ARGUMENT, "sensitivity is NULL");
    FAILS(ko_sensitivity_create(field, flat, &options, &ready), KO_ERR_INVALID_ARGUMENT, "the cloud dim 2");
    FAILS(ko_sensitivity_create(field, fewer, &options, &ready), KO_ERR_INVALID_ARGUMENT, "was fitted to 400 points");
    ko_fit_options other = options;
    other.lambda_smooth *= 100.0;
    FAILS(ko_sensitivity_create(field, cloud, &other, &ready), KO_ERR_INVALID_ARGUMENT, "it is not their fit");
    other = options;
    other.memory_limit = 1000;
    FAILS(ko_sensitivity_create(field, cloud, &other, &ready), KO_ERR_OUT_OF_MEMORY, "limit is 1000 bytes");
    int told = 0;
    other = options;
    other.progress = refuse;
    other.progress_data = &told;
    FAILS(ko_sensitivity_create(field, cloud, &other, &ready), KO_ERR_CANCELLED, "cancelled");
    CHECK(ready == NULL && told == 1);

    OK(ko_sensitivity_create(field, cloud, &options, &ready));
    double d_points[3 * N], wrong[3 * J];
    memcpy(wrong, places, sizeof wrong);
    wrong[4] = NAN;
    FAILS(ko_sensitivity_solve(NULL, places, NULL, J, NULL, N, d_points, NULL), KO_ERR_INVALID_ARGUMENT, "is NULL");
    FAILS(ko_sensitivity_solve(ready, NULL, NULL, J, NULL, N, d_points, NULL), KO_ERR_INVALID_ARGUMENT, "points is NULL");
    FAILS(ko_sensitivity_solve(ready, wrong, NULL, J, NULL, N, d_points, NULL), KO_ERR_INVALID_ARGUMENT, "point 1");
    FAILS(ko_sensitivity_solve(ready, places, wrong + 4, 1, NULL, N, d_points, NULL), KO_ERR_INVALID_ARGUMENT, "weight 0");
    FAILS(ko_sensitivity_solve(ready, places, NULL, J, NULL, N - 1, d_points, NULL), KO_ERR_INVALID_ARGUMENT, "n_cloud_points is 399");
    FAILS(ko_sensitivity_solve(ready, places, NULL, J, &other, N, d_points, NULL), KO_ERR_CANCELLED, "cancelled");
    other = options;
    other.max_iterations = 1;
    FAILS(ko_sensitivity_solve(ready, places, NULL, J, &other, N, d_points, NULL), KO_ERR_NOT_CONVERGED, "after 1 iter");
    /* It serves on. */
    OK(ko_sensitivity_solve(ready, places, NULL, J, NULL, N, d_points, NULL));
    ko_sensitivity_free(ready);
    ko_sensitivity_free(NULL);
    ko_field_free(field);
    ko_cloud_free(cloud);
    ko_cloud_free(flat);
    ko_cloud_free(fewer);
}

/* The value at `at` of the lens moved along x by h. */
static double value_moved(const ko_field *start, const ko_cloud *lens, const ko_fit_options *options, const double *at, double h) {
    double points[3 * 1500], normals[3 * 1500], value = 0.0;
    OK(ko_cloud_copy(lens, 1500, points, normals));
    for (int i = 0; i < 1500; i++) {
        points[3 * i] += h;
    }
    ko_cloud *moved = NULL;
    ko_field *field = NULL;
    OK(ko_cloud_from_points(3, points, normals, 1500, &moved));
    OK(ko_field_refit(start, moved, options, &field));
    OK(ko_field_eval(field, at, 1, &value, NULL, NULL));
    ko_field_free(field);
    ko_cloud_free(moved);
    return value;
}

/* Of a shape that moves as a whole, with no more digits than defaults or thereabouts have. Refined fields solved far enough for differences
 * take minutes under valgrind; tests/sensitivity.rs has them. */
static void derivatives_of_defaults_follow_the_shape(double max_error) {
    ko_cloud *cloud = check_lens(3, 1500);
    ko_fit_options options = check_options(10);
    options.tolerance = max_error > 0.0 ? options.tolerance : 1e-6;
    options.max_error = max_error;
    ko_field *field = NULL;
    ko_sensitivity *ready = NULL;
    CHECK(ko_field_fit(cloud, &options, &field) >= KO_OK);
    OK(ko_sensitivity_create(field, cloud, &options, &ready));
    double at[3] = {0.15, 0.1, -0.05}, d_points[3 * 1500], move = 0.0, h = 1e-3;
    OK(ko_sensitivity_solve(ready, at, NULL, 1, NULL, 1500, d_points, NULL));
    for (int i = 0; i < 1500; i++) {
        move += d_points[3 * i];
    }
    CHECK(move > -1.5 && move < -0.2);
    if (max_error > 0.0) {
        ko_sensitivity_free(ready);
        ko_field_free(field);
        ko_cloud_free(cloud);
        return;
    }
    options.reweighting = KO_REWEIGHT_KEEP;
    double forth = value_moved(field, cloud, &options, at, h), back = value_moved(field, cloud, &options, at, -h);
    CHECK_NEAR(move, (forth - back) / (2.0 * h), 0.02);
    ko_sensitivity_free(ready);
    ko_field_free(field);
    ko_cloud_free(cloud);
}

/* `quick`, for valgrind: without what solves for long. */
int main(int argc, char **argv) {
    int quick = argc > 1 && strcmp(argv[1], "quick") == 0;
    n_threads = quick ? 1 : 2;
    derivatives_agree_with_differences_of_refits(2);
    derivatives_go_back_to_vertices();
    wrong_calls_are_refused_and_long_ones_cancelled();
    if (!quick) {
        derivatives_agree_with_differences_of_refits(3);
        derivatives_of_defaults_follow_the_shape(0.0);
        derivatives_of_defaults_follow_the_shape(1e-2);
    }
    return check_result();
}
