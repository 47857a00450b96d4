/* Every error code but KO_ERR_INTERNAL, which no caller can provoke (its test is in src/ffi/guard.rs), and every argument refused that
 * version 0.1 knew. Those of later calls: errors_later.c. */

#include "check.h"

static const double nan_value = NAN;

static void messages_are_of_this_thread_and_stay(void) {
    CHECK(strcmp(ko_last_error(), "") == 0);
    CHECK(strcmp(ko_status_string(KO_OK), "KO_OK") == 0);
    CHECK(strcmp(ko_status_string(KO_ERR_CANCELLED), "KO_ERR_CANCELLED") == 0);
    for (int32_t status = KO_ERR_INTERNAL; status < 0; status++) {
        CHECK(strncmp(ko_status_string(status), "KO_ERR_", 7) == 0);
    }
    CHECK(strcmp(ko_status_string(12345), "unknown status") == 0);
    FAILS(ko_mesh_flip(NULL), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    ko_mesh *mesh = check_cube();
    CHECK(strstr(ko_last_error(), "mesh is NULL") != NULL);
    ko_mesh_free(mesh);
}

static void null_is_freed(void) {
    ko_mesh_free(NULL);
    ko_cloud_free(NULL);
    ko_field_free(NULL);
}

static void mesh_refuses_null(void) {
    ko_mesh *mesh = check_cube(), *made = STALE(ko_mesh);
    ko_cloud *cloud = STALE(ko_cloud);
    double xyz[3] = {0}, distance;
    ko_mesh_report report;
    size_t n;
    FAILS(ko_mesh_read(NULL, &made), KO_ERR_INVALID_ARGUMENT, "path is NULL");
    CHECK(made == NULL);
    FAILS(ko_mesh_read("x.obj", NULL), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    FAILS(ko_mesh_from_triangles(NULL, 8, check_cube_triangles, 12, &made), KO_ERR_INVALID_ARGUMENT, "vertices is NULL");
    FAILS(ko_mesh_from_triangles(check_cube_vertices, 8, NULL, 12, &made), KO_ERR_INVALID_ARGUMENT,
          "triangles is NULL");
    FAILS(ko_mesh_from_triangles(check_cube_vertices, 8, check_cube_triangles, 12, NULL), KO_ERR_INVALID_ARGUMENT,
          "mesh is NULL");
    FAILS(ko_mesh_get_size(NULL, &n, &n), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    FAILS(ko_mesh_copy(NULL, 8, 12, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    FAILS(ko_mesh_get_report(NULL, sizeof report, &report), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    FAILS(ko_mesh_get_report(mesh, sizeof report, NULL), KO_ERR_INVALID_ARGUMENT, "report is NULL");
    FAILS(ko_mesh_flip(NULL), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    FAILS(ko_mesh_sample(NULL, 10, 0, &cloud), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    CHECK(cloud == NULL);
    FAILS(ko_mesh_sample(mesh, 10, 0, NULL), KO_ERR_INVALID_ARGUMENT, "cloud is NULL");
    FAILS(ko_mesh_signed_distance(NULL, xyz, 1, &distance), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    FAILS(ko_mesh_signed_distance(mesh, NULL, 1, &distance), KO_ERR_INVALID_ARGUMENT, "points is NULL");
    FAILS(ko_mesh_signed_distance(mesh, xyz, 1, NULL), KO_ERR_INVALID_ARGUMENT, "distances is NULL");
    ko_mesh_free(mesh);
}

static void cloud_refuses_null(void) {
    ko_mesh *mesh = check_cube();
    ko_cloud *cloud = NULL, *made = STALE(ko_cloud);
    const double xyz[6] = {0, 0, 0, 1, 1, 1};
    size_t n;
    OK(ko_mesh_sample(mesh, 10, 0, &cloud));
    FAILS(ko_cloud_from_points(3, NULL, xyz, 2, &made), KO_ERR_INVALID_ARGUMENT, "points is NULL");
    CHECK(made == NULL);
    FAILS(ko_cloud_from_points(3, xyz, NULL, 2, &made), KO_ERR_INVALID_ARGUMENT, "2 points are given");
    FAILS(ko_cloud_from_points(3, xyz, xyz, 2, NULL), KO_ERR_INVALID_ARGUMENT, "cloud is NULL");
    FAILS(ko_cloud_get_size(NULL, &n), KO_ERR_INVALID_ARGUMENT, "cloud is NULL");
    FAILS(ko_cloud_get_size(cloud, NULL), KO_ERR_INVALID_ARGUMENT, "n_points is NULL");
    FAILS(ko_cloud_copy(NULL, 10, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "cloud is NULL");
    FAILS(ko_cloud_copy_origins(NULL, 10, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "cloud is NULL");
    ko_cloud_free(cloud);
    ko_mesh_free(mesh);
}

static void field_refuses_null(void) {
    ko_field *field = check_sphere_field(5), *made = STALE(ko_field);
    ko_cloud *cloud = check_sphere(100);
    ko_fit_report report;
    double xyz[3] = {0}, value;
    uint8_t outside;
    FAILS(ko_fit_options_init(NULL, sizeof(ko_fit_options)), KO_ERR_INVALID_ARGUMENT, "options is NULL");
    FAILS(ko_field_fit(NULL, NULL, &made), KO_ERR_INVALID_ARGUMENT, "cloud is NULL");
    CHECK(made == NULL);
    FAILS(ko_field_fit(cloud, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "field is NULL");
    FAILS(ko_field_eval(NULL, xyz, 1, &value, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "field is NULL");
    FAILS(ko_field_eval(field, NULL, 1, &value, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "points is NULL");
    FAILS(ko_field_eval_parallel(NULL, xyz, 1, &value, NULL, NULL, 2), KO_ERR_INVALID_ARGUMENT, "field is NULL");
    FAILS(ko_field_eval_parallel(field, NULL, 1, &value, NULL, NULL, 2), KO_ERR_INVALID_ARGUMENT, "points is NULL");
    FAILS(ko_field_outside_box(NULL, xyz, 1, &outside), KO_ERR_INVALID_ARGUMENT, "field is NULL");
    FAILS(ko_field_outside_box(field, NULL, 1, &outside), KO_ERR_INVALID_ARGUMENT, "points is NULL");
    FAILS(ko_field_outside_box(field, xyz, 1, NULL), KO_ERR_INVALID_ARGUMENT, "outside is NULL");
    FAILS(ko_field_get_report(NULL, sizeof report, &report), KO_ERR_INVALID_ARGUMENT, "field is NULL");
    FAILS(ko_field_get_report(field, sizeof report, NULL), KO_ERR_INVALID_ARGUMENT, "report is NULL");
    FAILS(ko_field_save(NULL, "x.kof"), KO_ERR_INVALID_ARGUMENT, "field is NULL");
    FAILS(ko_field_save(field, NULL), KO_ERR_INVALID_ARGUMENT, "path is NULL");
    FAILS(ko_field_load(NULL, &made), KO_ERR_INVALID_ARGUMENT, "path is NULL");
    FAILS(ko_field_load("x.kof", NULL), KO_ERR_INVALID_ARGUMENT, "field is NULL");
    ko_cloud_free(cloud);
    ko_field_free(field);
}

static void misaligned_pointers_are_refused(void) {
    static double room[64];
    static uint32_t indices[64];
    ko_mesh *mesh = check_cube();
    ko_field *field = check_sphere_field(5);
    ko_cloud *cloud = NULL;
    ko_mesh *made = NULL;
    FAILS(ko_cloud_from_points(3, MISALIGNED(room), room, 1, &cloud), KO_ERR_INVALID_ARGUMENT, "points is at address");
    FAILS(ko_cloud_from_points(3, room, MISALIGNED(room), 1, &cloud), KO_ERR_INVALID_ARGUMENT, "normals is at address");
    FAILS(ko_cloud_from_points(3, room, room, 1, MISALIGNED(room)), KO_ERR_INVALID_ARGUMENT, "cloud is at address");
    FAILS(ko_mesh_from_triangles(check_cube_vertices, 8, MISALIGNED(indices), 12, &made), KO_ERR_INVALID_ARGUMENT,
          "triangles is at address");
    FAILS(ko_mesh_flip(MISALIGNED(mesh)), KO_ERR_INVALID_ARGUMENT, "mesh is at address");
    FAILS(ko_mesh_signed_distance(mesh, room, 1, MISALIGNED(room)), KO_ERR_INVALID_ARGUMENT, "distances is at address");
    FAILS(ko_mesh_get_report(mesh, sizeof(ko_mesh_report), MISALIGNED(room)), KO_ERR_INVALID_ARGUMENT, "multiple of 8");
    FAILS(ko_field_eval(field, room, 1, MISALIGNED(room), NULL, NULL), KO_ERR_INVALID_ARGUMENT, "values is at");
    FAILS(ko_field_eval(field, room, 1, NULL, MISALIGNED(room), NULL), KO_ERR_INVALID_ARGUMENT, "gradients is at");
    FAILS(ko_field_eval(field, room, 1, NULL, NULL, MISALIGNED(room)), KO_ERR_INVALID_ARGUMENT, "hessians is at");
    ko_field_free(field);
    ko_mesh_free(mesh);
}

/* Not even the first of two outputs is written where the second is misaligned. */
static void outputs_are_written_on_success_only(void) {
    static double room[64];
    static uint32_t indices[64];
    ko_mesh *mesh = check_cube();
    ko_cloud *cloud = NULL;
    size_t n = 77;
    OK(ko_mesh_sample(mesh, 10, 1, &cloud));
    room[0] = 77.0;
    indices[0] = 77;
    FAILS(ko_mesh_get_size(mesh, &n, MISALIGNED(room)), KO_ERR_INVALID_ARGUMENT, "n_triangles is at");
    FAILS(ko_mesh_copy(mesh, 8, 12, room, MISALIGNED(indices)), KO_ERR_INVALID_ARGUMENT, "triangles is at");
    FAILS(ko_cloud_copy(cloud, 10, room, MISALIGNED(room)), KO_ERR_INVALID_ARGUMENT, "normals is at");
    FAILS(ko_cloud_copy_origins(cloud, 10, indices, MISALIGNED(room)), KO_ERR_INVALID_ARGUMENT, "barycentric is at");
    CHECK(n == 77 && room[0] == 77.0 && indices[0] == 77);
    ko_cloud_free(cloud);
    ko_mesh_free(mesh);
}

/* The arrays are not as long as is said: they must not be read. */
static void too_many_are_refused_unread(void) {
    static double room[3];
    static uint32_t indices[3];
    ko_mesh *mesh = NULL;
    ko_cloud *cloud = NULL;
    const size_t many = ((size_t)1 << 31) + 1;
    FAILS(ko_cloud_from_points(3, room, room, many, &cloud), KO_ERR_INVALID_ARGUMENT, "at most 1073741824");
    FAILS(ko_cloud_from_points(2, room, NULL, many, &cloud), KO_ERR_INVALID_ARGUMENT, "at most 1073741824");
    FAILS(ko_mesh_from_triangles(room, 1, indices, many, &mesh), KO_ERR_INVALID_ARGUMENT, "at most 2147483647");
    CHECK(cloud == NULL && mesh == NULL);
}

static void bad_triangles_are_named(void) {
    ko_mesh *mesh = NULL;
    double vertices[24];
    uint32_t triangles[36];
    memcpy(vertices, check_cube_vertices, sizeof vertices);
    memcpy(triangles, check_cube_triangles, sizeof triangles);
    FAILS(ko_mesh_from_triangles(vertices, 8, triangles, 0, &mesh), KO_ERR_INVALID_ARGUMENT, "triangle");
    FAILS(ko_mesh_from_triangles(NULL, 0, NULL, 0, &mesh), KO_ERR_INVALID_ARGUMENT, "triangle");
    triangles[3 * 5 + 1] = 8;
    FAILS(ko_mesh_from_triangles(vertices, 8, triangles, 12, &mesh), KO_ERR_INVALID_ARGUMENT, "triangle 5");
    triangles[3 * 5 + 1] = 5;
    vertices[3 * 6 + 1] = INFINITY;
    FAILS(ko_mesh_from_triangles(vertices, 8, triangles, 12, &mesh), KO_ERR_INVALID_ARGUMENT, "vertex 6");
    FAILS(ko_mesh_from_triangles(vertices, SIZE_MAX / 8, triangles, 12, &mesh), KO_ERR_INVALID_ARGUMENT,
          "vertices is said to have");
    CHECK(mesh == NULL);
}

static void bad_samplings_are_refused(void) {
    ko_mesh *mesh = check_cube();
    ko_cloud *cloud = NULL;
    FAILS(ko_mesh_sample(mesh, 0, 0, &cloud), KO_ERR_INVALID_ARGUMENT, "0 sample points");
    FAILS(ko_mesh_sample(mesh, SIZE_MAX, 0, &cloud), KO_ERR_INVALID_ARGUMENT, "18446744073709551615 sample points");
    CHECK(cloud == NULL);
    ko_mesh_free(mesh);
    const double line[9] = {0, 0, 0, 1, 0, 0, 2, 0, 0};
    const uint32_t one[3] = {0, 1, 2};
    OK(ko_mesh_from_triangles(line, 3, one, 1, &mesh));
    FAILS(ko_mesh_sample(mesh, 10, 0, &cloud), KO_ERR_DEGENERATE, "area");
    ko_mesh_free(mesh);
}

static void wrong_counts_are_refused(void) {
    ko_mesh *mesh = check_cube();
    ko_cloud *sampled = NULL, *given = check_sphere(10);
    double room[64];
    OK(ko_mesh_sample(mesh, 10, 0, &sampled));
    FAILS(ko_mesh_copy(mesh, 7, 12, room, NULL), KO_ERR_INVALID_ARGUMENT, "n_vertices is 7; the object has 8");
    FAILS(ko_mesh_copy(mesh, 8, 13, room, NULL), KO_ERR_INVALID_ARGUMENT, "n_triangles is 13; the object has 12");
    FAILS(ko_cloud_copy(sampled, 9, room, NULL), KO_ERR_INVALID_ARGUMENT, "n_points is 9; the object has 10");
    FAILS(ko_cloud_copy_origins(sampled, 11, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "n_points is 11");
    FAILS(ko_cloud_copy_origins(given, 10, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "made from points");
    ko_cloud_free(sampled);
    ko_cloud_free(given);
    ko_mesh_free(mesh);
}

static void bad_points_are_named(void) {
    double points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, normals[12];
    ko_cloud *cloud = NULL;
    memcpy(normals, points, sizeof normals);
    FAILS(ko_cloud_from_points(3, points, normals, 4, &cloud), KO_ERR_INVALID_ARGUMENT, "normal 0 is (0, 0, 0)");
    normals[0] = 1.0;
    OK(ko_cloud_from_points(3, points, normals, 4, &cloud));
    ko_cloud_free(cloud);
    normals[7] = nan_value;
    FAILS(ko_cloud_from_points(3, points, normals, 4, &cloud), KO_ERR_INVALID_ARGUMENT, "normal 2 ");
    normals[7] = 1.0;
    points[9] = -INFINITY;
    FAILS(ko_cloud_from_points(3, points, normals, 4, &cloud), KO_ERR_INVALID_ARGUMENT, "point 3 ");
    FAILS(ko_cloud_from_points(3, NULL, NULL, 0, &cloud), KO_ERR_INVALID_ARGUMENT, "point");
    FAILS(ko_cloud_from_points(0, points, normals, 4, &cloud), KO_ERR_INVALID_ARGUMENT, "dim is 0");
    FAILS(ko_cloud_from_points(4, points, normals, 4, &cloud), KO_ERR_INVALID_ARGUMENT, "dim is 4");
    CHECK(cloud == NULL);

    ko_mesh *mesh = check_cube();
    ko_field *field = check_sphere_field(5);
    double *many = check_points(1000, 1.0, 1), *values = malloc(6 * 1000 * sizeof *values);
    uint8_t *outside = malloc(1000);
    many[3 * 700 + 2] = nan_value;
    many[3 * 900] = INFINITY;
    FAILS(ko_mesh_signed_distance(mesh, many, 1000, values), KO_ERR_INVALID_ARGUMENT, "point 700 ");
    FAILS(ko_field_eval(field, many, 1000, values, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "point 700 ");
    FAILS(ko_field_eval(field, many, 1000, NULL, NULL, values), KO_ERR_INVALID_ARGUMENT, "point 700 ");
    FAILS(ko_field_eval(field, many, 1000, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "point 700 ");
    FAILS(ko_field_outside_box(field, many, 1000, outside), KO_ERR_INVALID_ARGUMENT, "point 700 ");
    FAILS(ko_field_eval(field, many, SIZE_MAX / 2, values, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "is said to have");
    free(outside);
    free(values);
    free(many);
    ko_field_free(field);
    ko_mesh_free(mesh);
}

/* Points that give no scale, and few or flat ones that do. */
static void degenerate_clouds(void) {
    double points[30], normals[30];
    ko_cloud *cloud = NULL;
    ko_field *field = STALE(ko_field);
    ko_fit_options options = check_options(5);
    for (int i = 0; i < 10; i++) {
        for (int a = 0; a < 3; a++) {
            points[3 * i + a] = 4.0 - a;
            normals[3 * i + a] = a == 2;
        }
    }
    for (size_t n = 1; n <= 10; n += 9) {
        OK(ko_cloud_from_points(3, points, normals, n, &cloud));
        FAILS(ko_field_fit(cloud, &options, &field), KO_ERR_DEGENERATE, "(4, 3, 2)");
        CHECK(field == NULL);
        ko_cloud_free(cloud);
    }
    /* The plane z = 2. */
    uint64_t seed = 1;
    for (int i = 0; i < 10; i++) {
        points[3 * i] = check_random(&seed);
        points[3 * i + 1] = check_random(&seed);
    }
    OK(ko_cloud_from_points(3, points, normals, 10, &cloud));
    OK(ko_field_fit(cloud, &options, &field));
    const double above_and_below[6] = {0.5, 0.5, 2.01, 0.5, 0.5, 1.99};
    double values[2];
    OK(ko_field_eval(field, above_and_below, 2, values, NULL, NULL));
    CHECK_NEAR(values[0], 0.01, 0.002);
    CHECK_NEAR(values[1], -0.01, 0.002);
    ko_field_free(field);
    ko_cloud_free(cloud);
    /* Too large or too small for squares and cubes of lengths. */
    for (int large = 0; large <= 1; large++) {
        for (int i = 0; i < 10; i++) {
            points[3 * i] = i * (large ? 1e140 : 1e-140);
            points[3 * i + 1] = points[3 * i + 2] = 0.0;
        }
        OK(ko_cloud_from_points(3, points, normals, 10, &cloud));
        FAILS(ko_field_fit(cloud, &options, &field), KO_ERR_INVALID_ARGUMENT, "must lie in [1e-90, 1e90]");
        ko_cloud_free(cloud);
    }
}

/* Fits with the option at `member` set to `value` must fail so. */
#define OPTION_FAILS(member, value, status, words)             \
    do {                                                       \
        ko_fit_options options = check_options(5);             \
        ko_field *field = STALE(ko_field);                     \
        options.member = (value);                              \
        FAILS(ko_field_fit(cloud, &options, &field), (status), (words)); \
        CHECK(field == NULL);                                  \
    } while (0)

static void options_out_of_range_are_refused(void) {
    ko_cloud *cloud = check_sphere(100);
    OPTION_FAILS(control_points[1], 3, KO_ERR_INVALID_ARGUMENT, "along y is 3");
    OPTION_FAILS(control_points[2], 1, KO_ERR_INVALID_ARGUMENT, "along z is 1");
    OPTION_FAILS(margin, -0.1, KO_ERR_INVALID_ARGUMENT, "margin is -0.1");
    OPTION_FAILS(margin, nan_value, KO_ERR_INVALID_ARGUMENT, "margin is NaN");
    OPTION_FAILS(margin, INFINITY, KO_ERR_INVALID_ARGUMENT, "margin is inf");
    OPTION_FAILS(lambda_normal, 0.0, KO_ERR_INVALID_ARGUMENT, "lambda_normal is 0");
    OPTION_FAILS(lambda_normal, nan_value, KO_ERR_INVALID_ARGUMENT, "lambda_normal is NaN");
    OPTION_FAILS(lambda_smooth, -1e-9, KO_ERR_INVALID_ARGUMENT, "lambda_smooth is -0.000000001");
    OPTION_FAILS(distance_weight, -1.0, KO_ERR_INVALID_ARGUMENT, "distance_weight is -1");
    OPTION_FAILS(distance_weight, nan_value, KO_ERR_INVALID_ARGUMENT, "distance_weight is NaN");
    OPTION_FAILS(reweightings, 101, KO_ERR_INVALID_ARGUMENT, "reweightings is 101");
    OPTION_FAILS(reweightings, UINT32_MAX, KO_ERR_INVALID_ARGUMENT, "reweightings is 4294967295");
    OPTION_FAILS(tolerance, 0.0, KO_ERR_INVALID_ARGUMENT, "tolerance is 0");
    OPTION_FAILS(tolerance, 2.0, KO_ERR_INVALID_ARGUMENT, "tolerance is 2");
    OPTION_FAILS(max_iterations, 0, KO_ERR_INVALID_ARGUMENT, "max_iterations is 0");
    OPTION_FAILS(feasible, 2, KO_ERR_INVALID_ARGUMENT, "feasible is 2");
    OPTION_FAILS(feasible, -7, KO_ERR_INVALID_ARGUMENT, "feasible is -7");
    OPTION_FAILS(reserved, 1, KO_ERR_INVALID_ARGUMENT, "reserved is 1");
    OPTION_FAILS(n_threads, 1000000000, KO_ERR_INVALID_ARGUMENT, "n_threads");
    OPTION_FAILS(struct_size, 0, KO_ERR_INVALID_ARGUMENT, "struct_size 0");
    OPTION_FAILS(struct_size, 7, KO_ERR_INVALID_ARGUMENT, "struct_size 7");
    OPTION_FAILS(struct_size, offsetof(ko_fit_options, reweighting) - 1, KO_ERR_INVALID_ARGUMENT, "struct_size ");
    OPTION_FAILS(struct_size, 1 << 20, KO_ERR_INVALID_ARGUMENT, "struct_size 1048576");
    OPTION_FAILS(max_iterations, 1, KO_ERR_NOT_CONVERGED, "after 1 iteration");
    ko_cloud_free(cloud);
}

static void absurd_sizes_are_refused_with_their_bytes(void) {
    ko_cloud *cloud = check_sphere(100);
    ko_field *field = STALE(ko_field);
    ko_fit_options options = check_options(100000);
    FAILS(ko_field_fit(cloud, &options, &field), KO_ERR_OUT_OF_MEMORY, "100000 x 100000 x 100000 control points");
    CHECK(field == NULL && strstr(ko_last_error(), "bytes; the limit is 8589934592 bytes") != NULL);
    options = check_options(UINT32_MAX);
    FAILS(ko_field_fit(cloud, &options, &field), KO_ERR_OUT_OF_MEMORY, "bytes; the limit is");
    options.memory_limit = UINT64_MAX;
    FAILS(ko_field_fit(cloud, &options, &field), KO_ERR_OUT_OF_MEMORY, "bytes; the limit is");
    /* Within the limit, but not within any memory. */
    options = check_options(200000);
    options.memory_limit = UINT64_MAX;
    FAILS(ko_field_fit(cloud, &options, &field), KO_ERR_OUT_OF_MEMORY, "did not give");
    options = check_options(8);
    options.memory_limit = 1000;
    FAILS(ko_field_fit(cloud, &options, &field), KO_ERR_OUT_OF_MEMORY, "the limit is 1000 bytes");
    ko_cloud_free(cloud);
}

/* A struct made for a newer library may ask for what this one does not know. */
static void unknown_options_are_unsupported(void) {
    struct {
        ko_fit_options options;
        unsigned char newer[16];
    } grown;
    ko_cloud *cloud = check_sphere(100);
    ko_field *field = NULL;
    OK(ko_fit_options_init(&grown.options, sizeof grown));
    grown.newer[9] = 1;
    FAILS(ko_field_fit(cloud, &grown.options, &field), KO_ERR_UNSUPPORTED, "newer");
    ko_cloud_free(cloud);

    ko_fit_options options;
    FAILS(ko_fit_options_init(&options, 3), KO_ERR_INVALID_ARGUMENT, "struct_size 3");
    FAILS(ko_fit_options_init(&options, sizeof(ko_fit_options *)), KO_ERR_INVALID_ARGUMENT, "struct_size 8");
    ko_mesh *mesh = check_cube();
    ko_mesh_report report;
    FAILS(ko_mesh_get_report(mesh, 0, &report), KO_ERR_INVALID_ARGUMENT, "struct_size 0");
    ko_mesh_free(mesh);
    ko_field *fitted = check_sphere_field(5);
    ko_fit_report fit_report;
    FAILS(ko_field_get_report(fitted, 1 << 20, &fit_report), KO_ERR_INVALID_ARGUMENT, "struct_size 1048576");
    ko_field_free(fitted);
}

/* Cancels when `*data` calls are over. */
static int32_t cancel(double fraction, const char *stage, void *data) {
    (void)fraction, (void)stage;
    return --*(int *)data < 0 ? 42 : 0;
}

static void a_cancelled_fit_leaves_the_cloud(void) {
    ko_cloud *cloud = check_sphere(200);
    ko_fit_options options = check_options(6);
    options.tolerance = 0.5;
    options.reweightings = 1;
    options.progress = cancel;
    int left = 0;
    options.progress_data = &left;
    /* At every place where it can be, until it no longer is. */
    int32_t status = KO_ERR_CANCELLED;
    int calls = 0;
    while (status == KO_ERR_CANCELLED && calls < 10000) {
        ko_field *field = STALE(ko_field);
        left = calls++;
        status = ko_field_fit(cloud, &options, &field);
        CHECK((status == KO_OK) == (field != NULL));
        CHECK(status == KO_OK || strstr(ko_last_error(), "cancelled") != NULL);
        ko_field_free(field);
    }
    CHECK(status == KO_OK && calls > 3);
    ko_cloud_free(cloud);
}

static void files_that_cannot_be(void) {
    ko_field *field = check_sphere_field(5), *loaded = STALE(ko_field);
    ko_mesh *mesh = STALE(ko_mesh);
    FAILS(ko_field_save(field, "no-such-folder/x.kof"), KO_ERR_IO, "no-such-folder/x.kof");
    FAILS(ko_field_save(field, "/"), KO_ERR_IO, "/");
    FAILS(ko_field_save(field, "/dev/full"), KO_ERR_IO, "/dev/full");
    FAILS(ko_field_save(field, ""), KO_ERR_INVALID_ARGUMENT, "path is empty");
    FAILS(ko_field_load("no-such-file.kof", &loaded), KO_ERR_IO, "no-such-file.kof");
    CHECK(loaded == NULL);
    FAILS(ko_field_load("/", &loaded), KO_ERR_IO, "/");
    FAILS(ko_field_load("/dev/null", &loaded), KO_ERR_FORMAT, "0 bytes");
    FAILS(ko_field_load("", &loaded), KO_ERR_INVALID_ARGUMENT, "path is empty");
    FAILS(ko_mesh_read("no-such-file.obj", &mesh), KO_ERR_IO, "no-such-file.obj");
    CHECK(mesh == NULL);
    FAILS(ko_mesh_read("/", &mesh), KO_ERR_IO, "/");
    FAILS(ko_mesh_read("/dev/null", &mesh), KO_ERR_UNSUPPORTED, "/dev/null");
    FAILS(ko_mesh_read("", &mesh), KO_ERR_INVALID_ARGUMENT, "path is empty");
    ko_field_free(field);
}

int main(void) {
    messages_are_of_this_thread_and_stay();
    null_is_freed();
    mesh_refuses_null();
    cloud_refuses_null();
    field_refuses_null();
    misaligned_pointers_are_refused();
    outputs_are_written_on_success_only();
    too_many_are_refused_unread();
    bad_triangles_are_named();
    bad_samplings_are_refused();
    wrong_counts_are_refused();
    bad_points_are_named();
    degenerate_clouds();
    options_out_of_range_are_refused();
    absurd_sizes_are_refused_with_their_bytes();
    unknown_options_are_unsupported();
    a_cancelled_fit_leaves_the_cloud();
    files_that_cannot_be();
    return check_result();
}
