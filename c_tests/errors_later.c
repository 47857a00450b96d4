/* The errors of what came after version 0.1, as errors.c has those of the first: curves, files of meshes, weights, estimated normals,
 * smoothing, sides, level sets, lattices, refits, control points. */

#include "check.h"
#include <unistd.h>

static const double nan_value = NAN;

/* ---- curves ---- */

/* These polylines are refused with these words. */
#define POLYLINES_FAIL(points, n_points, starts, n_loops, closed, words)                                       \
    do {                                                                                                       \
        ko_mesh *made = STALE(ko_mesh);                                                                        \
        FAILS(ko_mesh_from_polylines((points), (n_points), (starts), (n_loops), (closed), &made),              \
              KO_ERR_INVALID_ARGUMENT, (words));                                                               \
        CHECK(made == NULL);                                                                                   \
    } while (0)

static void polylines_that_bound_nothing_are_refused(void) {
    const double *frame = check_frame_points;
    const size_t *starts = check_frame_starts;
    const size_t late[2] = {1, 4}, down[2] = {0, 0}, far[2] = {0, 9}, short_one[2] = {0, 6};
    POLYLINES_FAIL(NULL, 8, starts, 2, 1, "points is NULL");
    POLYLINES_FAIL(frame, 8, NULL, 2, 1, "loop_starts is NULL");
    POLYLINES_FAIL(MISALIGNED(frame), 7, starts, 2, 1, "points is at address");
    POLYLINES_FAIL(frame, 8, MISALIGNED(starts), 1, 1, "loop_starts is at address");
    FAILS(ko_mesh_from_polylines(frame, 8, starts, 2, 1, NULL), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    POLYLINES_FAIL(frame, 8, starts, 2, 2, "closed is 2");
    POLYLINES_FAIL(frame, 8, starts, 2, -1, "closed is -1");
    POLYLINES_FAIL(NULL, 0, NULL, 0, 1, "no polylines");
    POLYLINES_FAIL(frame, 8, late, 2, 1, "loop_starts[0] is 1");
    POLYLINES_FAIL(frame, 8, down, 2, 1, "polyline 0");
    POLYLINES_FAIL(frame, 8, far, 2, 1, "loop_starts[1] is 9");
    POLYLINES_FAIL(frame, 8, short_one, 2, 1, "polyline 1");
    POLYLINES_FAIL(frame, SIZE_MAX / 8, starts, 2, 1, "points is said to have");

    double points[16];
    memcpy(points, frame, sizeof points);
    points[11] = nan_value;
    POLYLINES_FAIL(points, 8, starts, 2, 1, "point 5 is ");
    const double twice[8] = {0, 0, 1, 1, 1, 1, 0, 0};
    POLYLINES_FAIL(twice, 4, starts, 1, 1, "do not repeat");
    const double bow_tie[8] = {0, 0, 1, 1, 1, 0, 0, 1};
    POLYLINES_FAIL(bow_tie, 4, starts, 1, 1, "cross");
    POLYLINES_FAIL(bow_tie, 4, starts, 1, 0, "cross");
    /* A corner of the second on a side of the first; then the same way round as the first. */
    memcpy(points, frame, sizeof points);
    points[8] = -1.0;
    POLYLINES_FAIL(points, 8, starts, 2, 1, "touch");
    const double nested[16] = {-1, -1, 1, -1, 1, 1, -1, 1, -0.5, -0.5, 0.5, -0.5, 0.5, 0.5, -0.5, 0.5};
    POLYLINES_FAIL(nested, 8, starts, 2, 1, "polyline 1");
    /* Side by side, different ways round. */
    const double beside[16] = {-1, -1, 1, -1, 1, 1, -1, 1, 2, -1, 2, 1, 4, 1, 4, -1};
    POLYLINES_FAIL(beside, 8, starts, 2, 1, "polyline");
}

static void polylines_are_asked_for_as_they_are(void) {
    ko_mesh *plane = check_frame(), *space = check_cube();
    size_t n = 77, starts[2] = {77, 77};
    double points[16];
    uint8_t closed[2] = {77, 77};
    uint32_t dim = 77;
    FAILS(ko_mesh_get_dim(NULL, &dim), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    FAILS(ko_mesh_get_dim(plane, NULL), KO_ERR_INVALID_ARGUMENT, "dim is NULL");
    FAILS(ko_mesh_get_polylines_size(NULL, &n, &n), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    FAILS(ko_mesh_get_polylines_size(space, &n, &n), KO_ERR_INVALID_ARGUMENT, "of space");
    FAILS(ko_mesh_get_polylines_size(plane, MISALIGNED(&n), NULL), KO_ERR_INVALID_ARGUMENT, "n_points is at");
    FAILS(ko_mesh_get_polylines_size(plane, NULL, MISALIGNED(&n)), KO_ERR_INVALID_ARGUMENT, "n_loops is at");
    FAILS(ko_mesh_copy_polylines(NULL, 8, 2, points, starts, closed), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    FAILS(ko_mesh_copy_polylines(space, 8, 2, points, starts, closed), KO_ERR_INVALID_ARGUMENT, "of space");
    FAILS(ko_mesh_copy_polylines(plane, 7, 2, points, starts, closed), KO_ERR_INVALID_ARGUMENT,
          "n_points is 7; the object has 8");
    FAILS(ko_mesh_copy_polylines(plane, 8, 3, points, starts, closed), KO_ERR_INVALID_ARGUMENT,
          "n_loops is 3; the object has 2");
    FAILS(ko_mesh_copy_polylines(plane, 8, 2, MISALIGNED(points), starts, closed), KO_ERR_INVALID_ARGUMENT, "points is at");
    FAILS(ko_mesh_copy_polylines(plane, 8, 2, NULL, MISALIGNED(starts), closed), KO_ERR_INVALID_ARGUMENT,
          "loop_starts is at");
    CHECK(n == 77 && starts[0] == 77 && closed[0] == 77 && dim == 77);
    ko_mesh_free(plane);
    ko_mesh_free(space);
}

/* ---- files of meshes ---- */

static void meshes_go_to_files_that_can_be(void) {
    ko_mesh *plane = check_frame(), *space = check_cube();
    FAILS(ko_mesh_write(NULL, "x.obj"), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    FAILS(ko_mesh_write(space, NULL), KO_ERR_INVALID_ARGUMENT, "path is NULL");
    FAILS(ko_mesh_write(space, ""), KO_ERR_INVALID_ARGUMENT, "path is empty");
    FAILS(ko_mesh_write(space, "x"), KO_ERR_UNSUPPORTED, "x: meshes are written to files that end in");
    FAILS(ko_mesh_write(space, "x.step"), KO_ERR_UNSUPPORTED, "x.step");
    FAILS(ko_mesh_write(plane, "x.stl"), KO_ERR_UNSUPPORTED, ".obj");
    FAILS(ko_mesh_write(plane, "x.txt"), KO_ERR_UNSUPPORTED, "x.txt");
    FAILS(ko_mesh_write(space, "no-such-folder/x.obj"), KO_ERR_IO, "no-such-folder/x.obj");
    const char *const full[] = {"full.obj", "full.off", "full.ply", "full.stl"};
    for (int i = 0; i < 4; i++) {
        CHECK(symlink("/dev/full", full[i]) == 0);
        FAILS(ko_mesh_write(space, full[i]), KO_ERR_IO, full[i]);
        CHECK(remove(full[i]) == 0);
    }
    ko_mesh_free(plane);
    ko_mesh_free(space);

    /* More than a float holds: refused before the file that is there is touched. */
    double vertices[24];
    memcpy(vertices, check_cube_vertices, sizeof vertices);
    vertices[4] = 1e300;
    OK(ko_mesh_from_triangles(vertices, 8, check_cube_triangles, 12, &space));
    FILE *file = fopen("kept.stl", "w");
    CHECK(file != NULL && fputs("kept", file) >= 0 && fclose(file) == 0);
    FAILS(ko_mesh_write(space, "kept.stl"), KO_ERR_INVALID_ARGUMENT, "1");
    char kept[8] = "";
    file = fopen("kept.stl", "r");
    CHECK(file != NULL && fgets(kept, sizeof kept, file) != NULL && fclose(file) == 0 && strcmp(kept, "kept") == 0);
    CHECK(remove("kept.stl") == 0);
    ko_mesh_free(space);
}

/* ---- weights ---- */

static void weights_that_weigh_nothing_are_refused(void) {
    enum { N = 50 };
    ko_cloud *cloud = check_circle(N);
    double weights[N];
    uint32_t dim = 77;
    FAILS(ko_cloud_get_dim(NULL, &dim), KO_ERR_INVALID_ARGUMENT, "cloud is NULL");
    FAILS(ko_cloud_get_dim(cloud, NULL), KO_ERR_INVALID_ARGUMENT, "dim is NULL");
    for (int i = 0; i < N; i++) {
        weights[i] = i % 2;
    }
    OK(ko_cloud_set_weights(cloud, weights, N));
    FAILS(ko_cloud_set_weights(NULL, weights, N), KO_ERR_INVALID_ARGUMENT, "cloud is NULL");
    FAILS(ko_cloud_set_weights(cloud, NULL, N), KO_ERR_INVALID_ARGUMENT, "weights is NULL");
    FAILS(ko_cloud_set_weights(cloud, weights, N - 1), KO_ERR_INVALID_ARGUMENT, "49 weights");
    FAILS(ko_cloud_set_weights(cloud, NULL, 0), KO_ERR_INVALID_ARGUMENT, "0 weights");
    const double bad[] = {-1.0, nan_value, INFINITY, 1e101};
    for (int i = 0; i < 4; i++) {
        weights[20] = bad[i];
        FAILS(ko_cloud_set_weights(cloud, weights, N), KO_ERR_INVALID_ARGUMENT, "weight 20 is ");
    }
    memset(weights, 0, sizeof weights);
    FAILS(ko_cloud_set_weights(cloud, weights, N), KO_ERR_INVALID_ARGUMENT, "all weights are 0");
    /* The weights are those that were taken. */
    ko_fit_options options = check_options(6);
    ko_field *field = NULL;
    ko_fit_report report;
    OK(ko_field_fit(cloud, &options, &field));
    OK(ko_field_get_report(field, sizeof report, &report));
    CHECK(report.n_points == N / 2);
    ko_field_free(field);

    options.reweighting = KO_REWEIGHT_KEEP;
    FAILS(ko_field_fit(cloud, &options, &field), KO_ERR_INVALID_ARGUMENT, "a first fit has none");
    options.reweighting = 3;
    FAILS(ko_field_fit(cloud, &options, &field), KO_ERR_INVALID_ARGUMENT, "reweighting is 3");
    options.reweighting = -1;
    FAILS(ko_field_fit(cloud, &options, &field), KO_ERR_INVALID_ARGUMENT, "reweighting is -1");
    options = check_options(6);
    options.reserved_2 = 5;
    FAILS(ko_field_fit(cloud, &options, &field), KO_ERR_INVALID_ARGUMENT, "reserved_2 is 5");
    options = check_options(6);
    options.reweighting = KO_REWEIGHT_ROBUST;
    options.max_iterations = 1;
    FAILS(ko_field_fit(cloud, &options, &field), KO_ERR_NOT_CONVERGED, "after 1 iteration");
    CHECK(field == NULL);
    ko_cloud_free(cloud);
}

/* ---- estimated normals ---- */

/* An estimate that fails writes nothing but its handle. */
#define ESTIMATE_FAILS(dim, points, n, options, status, words)                                                        \
    do {                                                                                                              \
        ko_cloud *made = STALE(ko_cloud);                                                                             \
        ko_normal_report report;                                                                                      \
        uint8_t flags[64];                                                                                            \
        memset(&report, 0x55, sizeof report);                                                                         \
        memset(flags, 0x55, sizeof flags);                                                                            \
        FAILS(ko_cloud_estimate_normals((dim), (points), (n), (options), &made, flags, sizeof report, &report),       \
              (status), (words));                                                                                     \
        CHECK(made == NULL && flags[0] == 0x55 && flags[63] == 0x55 && report.n_copies == 0x5555555555555555u);       \
    } while (0)

/* Estimates with the option at `member` set to `value` must fail so. */
#define NORMAL_OPTION_FAILS(member, value, status, words)                      \
    do {                                                                       \
        ko_normal_options options;                                             \
        OK(ko_normal_options_init(&options, sizeof options));                  \
        options.member = (value);                                              \
        ESTIMATE_FAILS(3, points, 50, &options, (status), (words));            \
    } while (0)

static void points_without_normals_are_refused(void) {
    double *points = check_sphere_points(50);
    ko_cloud *made = STALE(ko_cloud);
    ESTIMATE_FAILS(3, NULL, 50, NULL, KO_ERR_INVALID_ARGUMENT, "points is NULL");
    ESTIMATE_FAILS(3, MISALIGNED(points), 49, NULL, KO_ERR_INVALID_ARGUMENT, "points is at");
    ESTIMATE_FAILS(1, points, 50, NULL, KO_ERR_INVALID_ARGUMENT, "dim is 1");
    ESTIMATE_FAILS(4, points, 50, NULL, KO_ERR_INVALID_ARGUMENT, "dim is 4");
    ESTIMATE_FAILS(3, NULL, 0, NULL, KO_ERR_INVALID_ARGUMENT, "0 points are given");
    ESTIMATE_FAILS(3, points, 3, NULL, KO_ERR_INVALID_ARGUMENT, "3 points are given");
    ESTIMATE_FAILS(2, points, 2, NULL, KO_ERR_INVALID_ARGUMENT, "2 points are given");
    FAILS(ko_cloud_estimate_normals(3, points, 50, NULL, NULL, NULL, 0, NULL), KO_ERR_INVALID_ARGUMENT, "cloud is NULL");
    ko_normal_report report;
    FAILS(ko_cloud_estimate_normals(3, points, 50, NULL, &made, NULL, 8, &report), KO_ERR_INVALID_ARGUMENT,
          "report has struct_size 8");
    CHECK(made == NULL);
    FAILS(ko_cloud_estimate_normals(3, points, 50, NULL, &made, NULL, sizeof report, MISALIGNED(&report)),
          KO_ERR_INVALID_ARGUMENT, "report is at");
    FAILS(ko_cloud_from_points(2, points, NULL, 2, &made), KO_ERR_INVALID_ARGUMENT, "2 points are given");
    points[3 * 17] = nan_value;
    ESTIMATE_FAILS(3, points, 50, NULL, KO_ERR_INVALID_ARGUMENT, "point 17 is ");
    FAILS(ko_cloud_from_points(3, points, NULL, 50, &made), KO_ERR_INVALID_ARGUMENT, "point 17 is ");
    CHECK(made == NULL);

    for (int i = 0; i < 150; i++) {
        points[i] = i % 3 == 0 ? i : 1.0;
    }
    ESTIMATE_FAILS(3, points, 50, NULL, KO_ERR_DEGENERATE, "on a line");
    FAILS(ko_cloud_from_points(3, points, NULL, 50, &made), KO_ERR_DEGENERATE, "on a line");
    for (int i = 0; i < 150; i++) {
        points[i] = i % 3;
    }
    ESTIMATE_FAILS(3, points, 50, NULL, KO_ERR_DEGENERATE, "1 different places");
    free(points);
}

static int32_t cancel(double fraction, const char *stage, void *data) {
    (void)fraction, (void)stage;
    return --*(int *)data < 0 ? 42 : 0;
}

static void options_of_normals_are_checked(void) {
    double *points = check_sphere_points(50);
    NORMAL_OPTION_FAILS(neighbours, 2, KO_ERR_INVALID_ARGUMENT, "neighbours is 2");
    NORMAL_OPTION_FAILS(neighbours, 65, KO_ERR_INVALID_ARGUMENT, "neighbours is 65");
    NORMAL_OPTION_FAILS(outlier_factor, 1.0, KO_ERR_INVALID_ARGUMENT, "outlier_factor is 1");
    NORMAL_OPTION_FAILS(outlier_factor, nan_value, KO_ERR_INVALID_ARGUMENT, "outlier_factor is NaN");
    NORMAL_OPTION_FAILS(n_threads, 1025, KO_ERR_INVALID_ARGUMENT, "n_threads is 1025");
    NORMAL_OPTION_FAILS(memory_limit, 1000, KO_ERR_OUT_OF_MEMORY, "the limit is 1000 bytes");
    NORMAL_OPTION_FAILS(struct_size, 8, KO_ERR_INVALID_ARGUMENT, "struct_size 8");
    NORMAL_OPTION_FAILS(struct_size, 1 << 20, KO_ERR_INVALID_ARGUMENT, "struct_size 1048576");
    struct {
        ko_normal_options options;
        unsigned char newer[16];
    } grown;
    OK(ko_normal_options_init(&grown.options, sizeof grown));
    grown.newer[9] = 1;
    ESTIMATE_FAILS(3, points, 50, &grown.options, KO_ERR_UNSUPPORTED, "newer");
    FAILS(ko_normal_options_init(NULL, sizeof grown.options), KO_ERR_INVALID_ARGUMENT, "options is NULL");
    FAILS(ko_normal_options_init(&grown.options, 8), KO_ERR_INVALID_ARGUMENT, "struct_size 8");

    /* Cancelled at every place where it can be, until it no longer is. */
    ko_normal_options options;
    OK(ko_normal_options_init(&options, sizeof options));
    int left = 0, calls = 0;
    options.progress = cancel;
    options.progress_data = &left;
    ko_cloud *made = NULL;
    while (made == NULL && calls < 10000) {
        left = calls++;
        int32_t status = ko_cloud_estimate_normals(3, points, 50, &options, &made, NULL, 0, NULL);
        CHECK(status == (made == NULL ? KO_ERR_CANCELLED : KO_OK));
    }
    CHECK(calls > 3 && made != NULL);
    ko_cloud_free(made);
    free(points);
}

/* ---- smoothing and sides ---- */

/* Smoothing with the option at `member` set to `value` must fail so. */
#define SMOOTH_OPTION_FAILS(member, value, words)                                             \
    do {                                                                                      \
        ko_smooth_options options;                                                            \
        ko_cloud *made = STALE(ko_cloud);                                                     \
        OK(ko_smooth_options_init(&options, sizeof options));                                 \
        options.member = (value);                                                             \
        FAILS(ko_cloud_smooth(cloud, &options, &made), KO_ERR_INVALID_ARGUMENT, (words));     \
        CHECK(made == NULL);                                                                  \
    } while (0)

static void smoothing_is_checked(ko_cloud *cloud) {
    ko_cloud *made = STALE(ko_cloud);
    FAILS(ko_cloud_smooth(NULL, NULL, &made), KO_ERR_INVALID_ARGUMENT, "cloud is NULL");
    CHECK(made == NULL);
    FAILS(ko_cloud_smooth(cloud, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "smoothed is NULL");
    FAILS(ko_cloud_smooth(cloud, NULL, MISALIGNED(&made)), KO_ERR_INVALID_ARGUMENT, "smoothed is at");
    SMOOTH_OPTION_FAILS(neighbours, 3, "neighbours is 3; it must lie in [4, 128]");
    SMOOTH_OPTION_FAILS(neighbours, 129, "neighbours is 129; it must lie in [4, 128]");
    SMOOTH_OPTION_FAILS(rounds, 0, "rounds is 0; it must lie in [1, 100]");
    SMOOTH_OPTION_FAILS(rounds, 101, "rounds is 101; it must lie in [1, 100]");
    SMOOTH_OPTION_FAILS(n_threads, 1025, "n_threads is 1025");
    SMOOTH_OPTION_FAILS(reserved, 3, "reserved is 3");
    SMOOTH_OPTION_FAILS(struct_size, 0, "struct_size 0");
    SMOOTH_OPTION_FAILS(struct_size, 8, "struct_size 8");
    SMOOTH_OPTION_FAILS(struct_size, 1 << 20, "struct_size 1048576");
    struct {
        ko_smooth_options options;
        unsigned char newer[16];
    } grown;
    OK(ko_smooth_options_init(&grown.options, sizeof grown));
    grown.newer[9] = 1;
    FAILS(ko_cloud_smooth(cloud, &grown.options, &made), KO_ERR_UNSUPPORTED, "newer");
    FAILS(ko_cloud_smooth(cloud, MISALIGNED(&grown.options), &made), KO_ERR_INVALID_ARGUMENT, "options is at");
    FAILS(ko_smooth_options_init(NULL, sizeof grown.options), KO_ERR_INVALID_ARGUMENT, "options is NULL");
    FAILS(ko_smooth_options_init(&grown.options, 8), KO_ERR_INVALID_ARGUMENT, "struct_size 8");

    ko_smooth_options options;
    OK(ko_smooth_options_init(&options, sizeof options));
    int left = 0, calls = 0;
    options.rounds = 4;
    options.progress = cancel;
    options.progress_data = &left;
    while (made == NULL && calls < 10000) {
        left = calls++;
        made = STALE(ko_cloud);
        int32_t status = ko_cloud_smooth(cloud, &options, &made);
        CHECK(status == (made == NULL ? KO_ERR_CANCELLED : KO_OK));
    }
    CHECK(calls > 3 && made != NULL);
    ko_cloud_free(made);
}

static void sides_are_asked_for_points(ko_cloud *cloud, size_t dim) {
    double points[30], sides[10];
    memset(points, 0, sizeof points);
    FAILS(ko_cloud_sides(NULL, points, 10, sides), KO_ERR_INVALID_ARGUMENT, "cloud is NULL");
    FAILS(ko_cloud_sides(NULL, NULL, 0, NULL), KO_ERR_INVALID_ARGUMENT, "cloud is NULL");
    FAILS(ko_cloud_sides(cloud, NULL, 10, sides), KO_ERR_INVALID_ARGUMENT, "points is NULL");
    FAILS(ko_cloud_sides(cloud, points, 10, NULL), KO_ERR_INVALID_ARGUMENT, "sides is NULL");
    FAILS(ko_cloud_sides(cloud, MISALIGNED(points), 9, sides), KO_ERR_INVALID_ARGUMENT, "points is at");
    FAILS(ko_cloud_sides(cloud, points, 9, MISALIGNED(sides)), KO_ERR_INVALID_ARGUMENT, "sides is at");
    FAILS(ko_cloud_sides(cloud, points, SIZE_MAX / 8, sides), KO_ERR_INVALID_ARGUMENT, "is said to have");
    points[dim * 7 + 1] = nan_value;
    FAILS(ko_cloud_sides(cloud, points, 10, sides), KO_ERR_INVALID_ARGUMENT, "point 7 is ");
    points[dim * 4] = -INFINITY;
    FAILS(ko_cloud_sides(cloud, points, 10, sides), KO_ERR_INVALID_ARGUMENT, "point 4 is ");
    OK(ko_cloud_sides(cloud, points, 4, sides));
}

/* ---- level sets ---- */

/* Level sets that fail so. */
#define LEVEL_SET_FAILS(level, options, status, words)                            \
    do {                                                                          \
        ko_mesh *made = STALE(ko_mesh);                                           \
        FAILS(ko_field_level_set(field, (level), (options), &made), (status), (words)); \
        CHECK(made == NULL);                                                      \
    } while (0)

/* Level sets with the option at `member` set to `value` must fail so. */
#define LEVEL_SET_OPTION_FAILS(member, value, status, words)          \
    do {                                                              \
        ko_level_set_options options;                                 \
        OK(ko_level_set_options_init(&options, sizeof options));      \
        options.member = (value);                                     \
        LEVEL_SET_FAILS(0.0, &options, (status), (words));            \
    } while (0)

static void level_sets_that_are_not_are_refused(ko_field *field) {
    ko_mesh *made = STALE(ko_mesh);
    FAILS(ko_field_level_set(NULL, 0.0, NULL, &made), KO_ERR_INVALID_ARGUMENT, "field is NULL");
    CHECK(made == NULL);
    FAILS(ko_field_level_set(field, 0.0, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    LEVEL_SET_FAILS(nan_value, NULL, KO_ERR_INVALID_ARGUMENT, "level is NaN");
    LEVEL_SET_FAILS(INFINITY, NULL, KO_ERR_INVALID_ARGUMENT, "level is inf");
    LEVEL_SET_FAILS(100.0, NULL, KO_ERR_DEGENERATE, "level 100 is not reached");
    LEVEL_SET_FAILS(-100.0, NULL, KO_ERR_DEGENERATE, "phi runs from ");
    LEVEL_SET_OPTION_FAILS(subdivisions, 0, KO_ERR_INVALID_ARGUMENT, "subdivisions is 0");
    LEVEL_SET_OPTION_FAILS(subdivisions, 1025, KO_ERR_INVALID_ARGUMENT, "subdivisions is 1025");
    LEVEL_SET_OPTION_FAILS(shortest_edge, -0.1, KO_ERR_INVALID_ARGUMENT, "shortest_edge is -0.1");
    LEVEL_SET_OPTION_FAILS(shortest_edge, 1.1, KO_ERR_INVALID_ARGUMENT, "shortest_edge is 1.1");
    LEVEL_SET_OPTION_FAILS(shortest_edge, nan_value, KO_ERR_INVALID_ARGUMENT, "shortest_edge is NaN");
    LEVEL_SET_OPTION_FAILS(relaxations, 1001, KO_ERR_INVALID_ARGUMENT, "relaxations is 1001");
    LEVEL_SET_OPTION_FAILS(n_threads, 1025, KO_ERR_INVALID_ARGUMENT, "n_threads is 1025");
    LEVEL_SET_OPTION_FAILS(reserved, 3, KO_ERR_INVALID_ARGUMENT, "reserved is 3");
    LEVEL_SET_OPTION_FAILS(memory_limit, 1000, KO_ERR_OUT_OF_MEMORY, "the limit is 1000 bytes");
    LEVEL_SET_OPTION_FAILS(struct_size, 8, KO_ERR_INVALID_ARGUMENT, "struct_size 8");
    LEVEL_SET_OPTION_FAILS(struct_size, 1 << 20, KO_ERR_INVALID_ARGUMENT, "struct_size 1048576");
    struct {
        ko_level_set_options options;
        unsigned char newer[16];
    } grown;
    OK(ko_level_set_options_init(&grown.options, sizeof grown));
    grown.newer[9] = 1;
    LEVEL_SET_FAILS(0.0, &grown.options, KO_ERR_UNSUPPORTED, "newer");
    FAILS(ko_level_set_options_init(NULL, sizeof grown.options), KO_ERR_INVALID_ARGUMENT, "options is NULL");
    FAILS(ko_level_set_options_init(&grown.options, 8), KO_ERR_INVALID_ARGUMENT, "struct_size 8");

    ko_level_set_options options;
    OK(ko_level_set_options_init(&options, sizeof options));
    int left = 0, calls = 0;
    options.progress = cancel;
    options.progress_data = &left;
    while (made == NULL && calls < 10000) {
        left = calls++;
        int32_t status = ko_field_level_set(field, 0.0, &options, &made);
        CHECK(status == (made == NULL ? KO_ERR_CANCELLED : KO_OK));
    }
    CHECK(calls > 3 && made != NULL);
    ko_mesh_free(made);
}

/* A lattice too fine for any memory is refused with its bytes. */
static void absurd_level_sets_are_refused(void) {
    ko_field *field = check_sphere_field(40);
    LEVEL_SET_OPTION_FAILS(subdivisions, 1024, KO_ERR_OUT_OF_MEMORY, "bytes; the limit is 8589934592 bytes");
    ko_field_free(field);
}

/* ---- lattices ---- */

static void lattices_that_are_none_are_refused(void) {
    ko_field *space = check_sphere_field(5), *plane = check_circle_field(5);
    double origin[3] = {0, 0, 0}, steps[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, values[8], gradients[24];
    size_t counts[3] = {2, 2, 2};
    memset(values, 0, sizeof values);
#define LATTICE_FAILS(field, origin, steps, counts, n_steps, words)                                                 \
    FAILS(ko_field_eval_lattice((field), (origin), (steps), (counts), (n_steps), values, gradients, 1),              \
          KO_ERR_INVALID_ARGUMENT, (words))
    LATTICE_FAILS(NULL, origin, steps, counts, 3, "field is NULL");
    LATTICE_FAILS(space, NULL, steps, counts, 3, "origin is NULL");
    LATTICE_FAILS(space, origin, NULL, counts, 3, "steps is NULL");
    LATTICE_FAILS(space, origin, steps, NULL, 3, "counts is NULL");
    LATTICE_FAILS(space, MISALIGNED(origin), steps, counts, 3, "origin is at");
    LATTICE_FAILS(space, origin, MISALIGNED(steps), counts, 2, "steps is at");
    LATTICE_FAILS(space, origin, steps, MISALIGNED(counts), 2, "counts is at");
    LATTICE_FAILS(space, origin, steps, counts, 0, "n_steps is 0; it must lie in [1, 3]");
    LATTICE_FAILS(space, origin, steps, counts, 4, "n_steps is 4; it must lie in [1, 3]");
    LATTICE_FAILS(plane, origin, steps, counts, 3, "n_steps is 3; it must lie in [1, 2]");
    counts[1] = 0;
    LATTICE_FAILS(space, origin, steps, counts, 3, "count 1 is 0");
    counts[1] = SIZE_MAX / 2;
    LATTICE_FAILS(space, origin, steps, counts, 3, "than memory can count");
    counts[1] = 2;
    origin[2] = nan_value;
    LATTICE_FAILS(space, origin, steps, counts, 3, "NaN");
    origin[2] = 0.0;
    steps[4] = INFINITY;
    LATTICE_FAILS(space, origin, steps, counts, 3, "inf");
    /* Too far from the second row on. */
    steps[4] = 1e151;
    LATTICE_FAILS(space, origin, steps, counts, 3, "point 2 is ");
    steps[4] = 1.0;
    FAILS(ko_field_eval_lattice(space, origin, steps, counts, 3, values, gradients, 1025), KO_ERR_INVALID_ARGUMENT,
          "n_threads is 1025");
    FAILS(ko_field_eval_lattice(space, origin, steps, counts, 2, MISALIGNED(values), NULL, 1), KO_ERR_INVALID_ARGUMENT,
          "values is at");
    FAILS(ko_field_eval_lattice(space, origin, steps, counts, 2, NULL, MISALIGNED(gradients), 1), KO_ERR_INVALID_ARGUMENT,
          "gradients is at");
#undef LATTICE_FAILS
    for (int i = 0; i < 8; i++) {
        CHECK(values[i] == 0.0);
    }
    ko_field_free(space);
    ko_field_free(plane);
}

/* ---- refits ---- */

static void refits_that_cannot_be(void) {
    ko_field *start = check_sphere_field(5), *plane = check_circle_field(5), *made = STALE(ko_field);
    ko_cloud *cloud = check_sphere(100), *curve = check_circle(100);
    FAILS(ko_field_refit(NULL, cloud, NULL, &made), KO_ERR_INVALID_ARGUMENT, "start is NULL");
    CHECK(made == NULL);
    FAILS(ko_field_refit(start, NULL, NULL, &made), KO_ERR_INVALID_ARGUMENT, "cloud is NULL");
    FAILS(ko_field_refit(start, cloud, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "field is NULL");
    FAILS(ko_field_refit(start, curve, NULL, &made), KO_ERR_INVALID_ARGUMENT, "start dim 3, the cloud dim 2");
    FAILS(ko_field_refit(plane, cloud, NULL, &made), KO_ERR_INVALID_ARGUMENT, "start dim 2, the cloud dim 3");
    ko_fit_options options = check_options(5);
    options.lambda_smooth = nan_value;
    FAILS(ko_field_refit(start, cloud, &options, &made), KO_ERR_INVALID_ARGUMENT, "lambda_smooth is NaN");
    options = check_options(5);
    options.feasible = 9;
    FAILS(ko_field_refit(start, cloud, &options, &made), KO_ERR_INVALID_ARGUMENT, "feasible is 9");
    options = check_options(5);
    options.memory_limit = 1000;
    FAILS(ko_field_refit(start, cloud, &options, &made), KO_ERR_OUT_OF_MEMORY, "the limit is 1000 bytes");
    options = check_options(5);
    options.max_iterations = 1;
    options.tolerance = 1e-12;
    FAILS(ko_field_refit(start, cloud, &options, &made), KO_ERR_NOT_CONVERGED, "after 1 iteration");
    options = check_options(5);
    int left = 2;
    options.progress = cancel;
    options.progress_data = &left;
    FAILS(ko_field_refit(start, cloud, &options, &made), KO_ERR_CANCELLED, "cancelled");
    options = check_options(5);
    options.struct_size = 8;
    FAILS(ko_field_refit(start, cloud, &options, &made), KO_ERR_INVALID_ARGUMENT, "struct_size 8");

    double points[60], normals[60];
    for (int i = 0; i < 60; i++) {
        points[i] = i == 37 ? 1.5 : 0.01 * i;
        normals[i] = 1.0;
    }
    ko_cloud *far = NULL, *place = NULL;
    OK(ko_cloud_from_points(3, points, normals, 20, &far));
    FAILS(ko_field_refit(start, far, NULL, &made), KO_ERR_INVALID_ARGUMENT, "point 12 is ");
    memset(points, 0, sizeof points);
    OK(ko_cloud_from_points(3, points, normals, 20, &place));
    FAILS(ko_field_refit(start, place, NULL, &made), KO_ERR_DEGENERATE, "(0, 0, 0)");
    CHECK(made == NULL);
    ko_cloud_free(far);
    ko_cloud_free(place);
    ko_cloud_free(cloud);
    ko_cloud_free(curve);
    ko_field_free(start);
    ko_field_free(plane);
}

/* ---- control points ---- */

struct given {
    uint32_t dim, counts[3];
    double box_min[3], box_max[3];
    int32_t feasible;
    double diagonal, numbers[125];
    size_t n;
};

static struct given sound(void) {
    struct given given = {3, {5, 5, 5}, {-1, -1, -1}, {1, 1, 1}, KO_FEASIBLE_INSIDE, 2.0, {0}, 125};
    return given;
}

/* A field of sound arguments but for `change` fails so. */
#define GIVEN_FAILS(change, words)                                                                                     \
    do {                                                                                                               \
        struct given given = sound();                                                                                  \
        ko_field *made = STALE(ko_field);                                                                              \
        given.change;                                                                                                  \
        FAILS(ko_field_from_control_points(given.dim, given.counts, given.box_min, given.box_max, given.feasible,      \
                                           given.diagonal, given.numbers, given.n, &made),                             \
              KO_ERR_INVALID_ARGUMENT, (words));                                                                       \
        CHECK(made == NULL);                                                                                           \
    } while (0)

static void control_points_that_make_no_field(void) {
    GIVEN_FAILS(dim = 1, "dim is 1");
    GIVEN_FAILS(dim = 4, "dim is 4");
    GIVEN_FAILS(dim = 2, "25 control points, but 125 are given");
    GIVEN_FAILS(counts[1] = 3, "axis 1 has 3 control points");
    GIVEN_FAILS(counts[2] = 0, "axis 2 has 0 control points");
    GIVEN_FAILS(counts[0] = 6, "150 control points, but 125 are given");
    GIVEN_FAILS(counts[0] = UINT32_MAX, "are given");
    GIVEN_FAILS(n = 124, "125 control points, but 124 are given");
    GIVEN_FAILS(n = 0, "125 control points, but 0 are given");
    GIVEN_FAILS(n = SIZE_MAX / 4, "control_points is said to have");
    GIVEN_FAILS(box_min[0] = 1.0, "along axis 0");
    GIVEN_FAILS(box_max[1] = -2.0, "along axis 1");
    GIVEN_FAILS(box_max[2] = nan_value, "along axis 2");
    GIVEN_FAILS(box_min[2] = -INFINITY, "along axis 2");
    GIVEN_FAILS(box_max[0] = 1e100, "axis 0");
    GIVEN_FAILS(feasible = 2, "feasible is 2");
    GIVEN_FAILS(diagonal = 0.0, "diagonal is 0");
    GIVEN_FAILS(diagonal = -1.0, "diagonal is -1");
    GIVEN_FAILS(diagonal = nan_value, "diagonal is NaN");
    GIVEN_FAILS(numbers[77] = INFINITY, "control point 77 is inf");

    /* Counts whose product, 2^93, would wrap round to the 0 that are given. */
    struct given wide = sound();
    ko_field *made = STALE(ko_field);
    wide.counts[0] = wide.counts[1] = wide.counts[2] = 1u << 31;
    FAILS(ko_field_from_control_points(3, wide.counts, wide.box_min, wide.box_max, 0, 2.0, NULL, 0, &made),
          KO_ERR_INVALID_ARGUMENT, "but 0 are given");
    /* Where sums would leave the range of doubles. */
    for (int k = 0; k < 2; ++k) {
        struct given huge = sound();
        huge.numbers[7] = k == 0 ? 1.7e308 : -1.1e100;
        FAILS(ko_field_from_control_points(3, huge.counts, huge.box_min, huge.box_max, 0, 2.0, huge.numbers, 125, &made),
              KO_ERR_INVALID_ARGUMENT, k == 0 ? "control point 7 is 1.7e308" : "at most 1e100");
    }
    struct given given = sound();
    FAILS(ko_field_from_control_points(3, NULL, given.box_min, given.box_max, 0, 2.0, given.numbers, 125, &made),
          KO_ERR_INVALID_ARGUMENT, "counts is NULL");
    FAILS(ko_field_from_control_points(3, given.counts, NULL, given.box_max, 0, 2.0, given.numbers, 125, &made),
          KO_ERR_INVALID_ARGUMENT, "box_min is NULL");
    FAILS(ko_field_from_control_points(3, given.counts, given.box_min, NULL, 0, 2.0, given.numbers, 125, &made),
          KO_ERR_INVALID_ARGUMENT, "box_max is NULL");
    FAILS(ko_field_from_control_points(3, given.counts, given.box_min, given.box_max, 0, 2.0, NULL, 125, &made),
          KO_ERR_INVALID_ARGUMENT, "control_points is NULL");
    FAILS(ko_field_from_control_points(3, given.counts, given.box_min, given.box_max, 0, 2.0, given.numbers, 125, NULL),
          KO_ERR_INVALID_ARGUMENT, "field is NULL");
    CHECK(made == NULL);

    OK(ko_field_from_control_points(3, given.counts, given.box_min, given.box_max, 0, 2.0, given.numbers, 125, &made));
    FAILS(ko_field_copy_control_points(NULL, 125, given.numbers), KO_ERR_INVALID_ARGUMENT, "field is NULL");
    FAILS(ko_field_copy_control_points(made, 124, given.numbers), KO_ERR_INVALID_ARGUMENT,
          "n_control_points is 124; the object has 125");
    FAILS(ko_field_copy_control_points(made, 125, NULL), KO_ERR_INVALID_ARGUMENT, "control_points is NULL");
    FAILS(ko_field_copy_control_points(made, 125, MISALIGNED(given.numbers)), KO_ERR_INVALID_ARGUMENT,
          "control_points is at");
    ko_field_free(made);
}

int main(void) {
    polylines_that_bound_nothing_are_refused();
    polylines_are_asked_for_as_they_are();
    meshes_go_to_files_that_can_be();
    weights_that_weigh_nothing_are_refused();
    points_without_normals_are_refused();
    options_of_normals_are_checked();
    ko_cloud *sphere = check_sphere(100), *circle = check_circle(100);
    smoothing_is_checked(sphere);
    smoothing_is_checked(circle);
    sides_are_asked_for_points(sphere, 3);
    sides_are_asked_for_points(circle, 2);
    ko_cloud_free(sphere);
    ko_cloud_free(circle);
    ko_field *space = check_sphere_field(5), *plane = check_circle_field(6);
    level_sets_that_are_not_are_refused(space);
    level_sets_that_are_not_are_refused(plane);
    ko_field_free(space);
    ko_field_free(plane);
    absurd_level_sets_are_refused();
    lattices_that_are_none_are_refused();
    refits_that_cannot_be();
    control_points_that_make_no_field();
    return check_result();
}
