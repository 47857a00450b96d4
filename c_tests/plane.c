/* The main job in the plane, call by call: polylines, cloud, field, values, level set, and polylines again. */

#include "check.h"

static void polylines_come_back(void) {
    ko_mesh *mesh = check_frame();
    uint32_t dim = 0;
    OK(ko_mesh_get_dim(mesh, &dim));
    CHECK(dim == 2);
    size_t n_points = 0, n_loops = 0;
    OK(ko_mesh_get_size(mesh, &n_points, &n_loops));
    CHECK(n_points == 8 && n_loops == 8);
    double vertices[16];
    uint32_t segments[16];
    OK(ko_mesh_copy(mesh, 8, 8, vertices, segments));
    CHECK(memcmp(vertices, check_frame_points, sizeof vertices) == 0);
    CHECK(segments[0] == 0 && segments[1] == 1 && segments[6] == 3 && segments[7] == 0 && segments[15] == 4);

    OK(ko_mesh_get_polylines_size(mesh, &n_points, &n_loops));
    CHECK(n_points == 8 && n_loops == 2);
    OK(ko_mesh_get_polylines_size(mesh, NULL, NULL));
    double points[16];
    size_t starts[2];
    uint8_t closed[2] = {9, 9};
    OK(ko_mesh_copy_polylines(mesh, 8, 2, points, starts, closed));
    CHECK(memcmp(points, check_frame_points, sizeof points) == 0);
    CHECK(memcmp(starts, check_frame_starts, sizeof starts) == 0);
    CHECK(closed[0] == 1 && closed[1] == 1);
    OK(ko_mesh_copy_polylines(mesh, 8, 2, NULL, NULL, NULL));
    ko_mesh_free(mesh);

    OK(ko_mesh_from_polylines(check_frame_points, 8, check_frame_starts, 2, 0, &mesh));
    OK(ko_mesh_copy_polylines(mesh, 8, 2, points, starts, closed));
    CHECK(memcmp(points, check_frame_points, sizeof points) == 0);
    CHECK(starts[1] == 4 && closed[0] == 0 && closed[1] == 0);
    ko_mesh_free(mesh);

    /* Points given twice, and the first one again at the end, are dropped. */
    const double repeated[12] = {0, 0, 1, 0, 1, 0, 1, 1, 0, 1, 0, 0};
    OK(ko_mesh_from_polylines(repeated, 6, check_frame_starts, 1, 1, &mesh));
    OK(ko_mesh_get_polylines_size(mesh, &n_points, &n_loops));
    CHECK(n_points == 4 && n_loops == 1);
    ko_mesh_free(mesh);
}

static void mesh_tells_what_it_is(void) {
    ko_mesh *mesh = check_frame();
    ko_mesh_report report;
    OK(ko_mesh_get_report(mesh, sizeof report, &report));
    CHECK(report.n_vertices == 8 && report.n_triangles == 8 && report.n_components == 2 && report.n_boundary_edges == 0);
    CHECK(report.closed == 1 && report.oriented == 1 && report.manifold == 1 && report.inside_out == 0);
    CHECK_NEAR(report.area, 12.0, 1e-14);
    CHECK_NEAR(report.volume, 3.0, 1e-14);
    CHECK(report.bounds_min[1] == -1.0 && report.bounds_max[0] == 1.0);
    CHECK(report.bounds_min[2] == 0.0 && report.bounds_max[2] == 0.0);
    const double points[] = {0, 0, 0.75, 0, 2, 0, 2, 2, 0.5, 0.1};
    const double right[] = {0.5, -0.25, 1, sqrt(2), 0};
    double distances[5];
    OK(ko_mesh_signed_distance(mesh, points, 5, distances));
    for (int i = 0; i < 5; i++) {
        CHECK_NEAR(distances[i], right[i], 1e-15);
    }
    OK(ko_mesh_flip(mesh));
    OK(ko_mesh_get_report(mesh, sizeof report, &report));
    CHECK(report.inside_out == 1);
    ko_mesh_free(mesh);
}

static void samples_lie_where_they_say(void) {
    enum { N = 120 };
    ko_mesh *mesh = check_frame();
    ko_cloud *cloud = NULL;
    OK(ko_mesh_sample(mesh, N, 7, &cloud));
    uint32_t dim = 0, segments[N];
    OK(ko_cloud_get_dim(cloud, &dim));
    CHECK(dim == 2);
    double points[2 * N], normals[2 * N], barycentric[2 * N], distances[N];
    OK(ko_cloud_copy(cloud, N, points, normals));
    OK(ko_cloud_copy_origins(cloud, N, segments, barycentric));
    OK(ko_mesh_signed_distance(mesh, points, N, distances));
    for (int i = 0; i < N; i++) {
        CHECK_NEAR(distances[i], 0.0, 1e-15);
        CHECK_NEAR(normals[2 * i] * normals[2 * i] + normals[2 * i + 1] * normals[2 * i + 1], 1.0, 1e-15);
        uint32_t a = segments[i], b = a % 4 == 3 ? a - 3 : a + 1;
        for (int k = 0; k < 2; k++) {
            double x = barycentric[2 * i] * check_frame_points[2 * a + k] + barycentric[2 * i + 1] * check_frame_points[2 * b + k];
            CHECK_NEAR(points[2 * i + k], x, 1e-15);
        }
    }
    ko_cloud_free(cloud);
    ko_mesh_free(mesh);
}

/* The frame's field, of samples of its polylines. */
static ko_field *frame_field(int32_t feasible) {
    ko_mesh *mesh = check_frame();
    ko_cloud *cloud = NULL;
    OK(ko_mesh_sample(mesh, 600, 1, &cloud));
    ko_fit_options options = check_options(40);
    options.control_points[2] = 1; /* In the plane it is ignored. */
    options.feasible = feasible;
    ko_field *field = NULL;
    OK(ko_field_fit(cloud, &options, &field));
    ko_cloud_free(cloud);
    ko_mesh_free(mesh);
    return field;
}

static void fields_are_close_to_the_distance(void) {
    ko_field *field = frame_field(KO_FEASIBLE_OUTSIDE);
    ko_fit_report report;
    OK(ko_field_get_report(field, sizeof report, &report));
    CHECK(report.dim == 2 && report.n_unknowns == 1600 && report.n_points == 600);
    CHECK(report.control_points[0] == 40 && report.control_points[1] == 40 && report.control_points[2] == 0);
    CHECK(report.box_min[2] == 0.0 && report.box_max[2] == 0.0 && report.rms < 0.01);
    CHECK_NEAR(report.diagonal, 2.0 * sqrt(2.0), 1e-2);

    const double points[] = {0.75, 0.1, 0.45, 0.1, 1.1, -0.2, 5, 5, 0, 0};
    const double right[] = {-0.25, 0.05, 0.1, 4.0 * sqrt(2.0), 0.5};
    double values[5], gradients[10];
    uint8_t outside[5];
    OK(ko_field_eval(field, points, 5, values, gradients, NULL));
    for (int i = 0; i < 3; i++) {
        CHECK_NEAR(values[i], right[i], 0.03);
    }
    CHECK(values[4] > 0.0);
    CHECK_NEAR(values[3] / right[3], 1.0, 0.1);
    CHECK_NEAR(hypot(gradients[6], gradients[7]), 1.0, 0.01);
    OK(ko_field_outside_box(field, points, 5, outside));
    CHECK(outside[0] == 0 && outside[2] == 0 && outside[3] == 1);
    ko_field_free(field);
}

/* Central differences of values and gradients against gradients and Hessians xx xy yy, in the box and outside it. */
static void derivatives_are_those_of_the_values(void) {
    static const int packed[2][2] = {{0, 1}, {1, 2}};
    const double step = 1e-5;
    ko_field *field = frame_field(KO_FEASIBLE_OUTSIDE);
    uint64_t seed = 11;
    for (int i = 0; i < 300; i++) {
        double p[2] = {4.0 * check_random(&seed) - 2.0, 4.0 * check_random(&seed) - 2.0};
        double gradient[2], hessian[3];
        OK(ko_field_eval(field, p, 1, NULL, gradient, hessian));
        double size = 1.0;
        for (int k = 0; k < 3; k++) {
            size = fmax(size, fabs(hessian[k]));
        }
        for (int a = 0; a < 2; a++) {
            double ends[4] = {p[0], p[1], p[0], p[1]}, values[2], gradients[4];
            ends[a] -= step;
            ends[2 + a] += step;
            OK(ko_field_eval(field, ends, 2, values, gradients, NULL));
            CHECK_NEAR((values[1] - values[0]) / (2.0 * step), gradient[a], 1e-8 * size);
            for (int b = 0; b < 2; b++) {
                CHECK_NEAR((gradients[2 + b] - gradients[b]) / (2.0 * step), hessian[packed[a][b]], 1e-3 * size);
            }
        }
    }
    ko_field_free(field);
}

static void the_level_set_is_the_frame_again(int32_t feasible) {
    ko_field *field = frame_field(feasible);
    ko_mesh *mesh = NULL;
    OK(ko_field_level_set(field, 0.0, NULL, &mesh));
    ko_mesh_report report;
    OK(ko_mesh_get_report(mesh, sizeof report, &report));
    CHECK(report.n_components == 2 && report.closed == 1 && report.oriented == 1 && report.manifold == 1);
    CHECK(report.inside_out == 0);
    CHECK_NEAR(report.volume, 3.0, 0.03);

    size_t n_points = 0, n_loops = 0, starts[2];
    uint8_t closed[2];
    OK(ko_mesh_get_polylines_size(mesh, &n_points, &n_loops));
    CHECK(n_points == report.n_vertices && n_loops == 2);
    double *points = malloc(2 * n_points * sizeof *points), *values = malloc(n_points * sizeof *values);
    OK(ko_mesh_copy_polylines(mesh, n_points, 2, points, starts, closed));
    CHECK(starts[0] == 0 && starts[1] > 0 && starts[1] < n_points && closed[0] == 1 && closed[1] == 1);
    OK(ko_field_eval(field, points, n_points, values, NULL, NULL));
    for (size_t i = 0; i < n_points; i++) {
        CHECK_NEAR(values[i], 0.0, 1e-8);
    }
    /* What comes out goes in. */
    ko_mesh *again = NULL;
    OK(ko_mesh_from_polylines(points, n_points, starts, 2, 1, &again));
    ko_mesh_free(again);
    free(points);
    free(values);
    ko_mesh_free(mesh);
    ko_field_free(field);
}

/* A circle that is larger than the box leaves an arc in each of its corners. */
static void a_level_set_that_meets_the_box_is_open(void) {
    ko_field *field = check_circle_field(12);
    ko_mesh *mesh = NULL;
    CHECK(ko_field_level_set(field, 0.3, NULL, &mesh) == KO_OPEN_AT_BOX);
    size_t n_points = 0, n_loops = 0;
    OK(ko_mesh_get_polylines_size(mesh, &n_points, &n_loops));
    CHECK(n_loops == 4);
    uint8_t closed[4] = {9, 9, 9, 9};
    if (n_loops == 4) {
        OK(ko_mesh_copy_polylines(mesh, n_points, 4, NULL, NULL, closed));
    }
    CHECK(closed[0] == 0 && closed[1] == 0 && closed[2] == 0 && closed[3] == 0);
    ko_mesh_free(mesh);
    ko_field_free(field);
}

static size_t lines_of(const char *path, char kind) {
    FILE *file = fopen(path, "r");
    CHECK(file != NULL);
    char line[256];
    size_t n = 0;
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        n += line[0] == kind;
    }
    if (file != NULL) {
        fclose(file);
    }
    return n;
}

static void files_hold_the_plane(void) {
    enum { N = 100 };
    ko_mesh *mesh = check_frame();
    OK(ko_mesh_write(mesh, "plane.obj"));
    CHECK(lines_of("plane.obj", 'v') == 8 && lines_of("plane.obj", 'l') == 8);
    CHECK(remove("plane.obj") == 0);
    ko_mesh_free(mesh);

    ko_field *field = check_circle_field(8), *loaded = NULL;
    OK(ko_field_save(field, "plane.kof"));
    OK(ko_field_load("plane.kof", &loaded));
    double *points = check_points(N, 2.0, 5); /* Three numbers each make more of two. */
    double a[6 * N], b[6 * N];
    OK(ko_field_eval(field, points, N, a, a + N, a + 3 * N));
    OK(ko_field_eval(loaded, points, N, b, b + N, b + 3 * N));
    CHECK(memcmp(a, b, sizeof a) == 0);
    OK(ko_field_eval_parallel(loaded, points, N, b, b + N, b + 3 * N, 2));
    CHECK(memcmp(a, b, sizeof a) == 0);
    ko_fit_report report, loaded_report;
    OK(ko_field_get_report(field, sizeof report, &report));
    OK(ko_field_get_report(loaded, sizeof report, &loaded_report));
    /* Files do not keep clear_sides. */
    CHECK(memcmp(&report, &loaded_report, offsetof(ko_fit_report, clear_sides)) == 0);
    CHECK(remove("plane.kof") == 0);
    free(points);
    ko_field_free(field);
    ko_field_free(loaded);
}

int main(void) {
    CHECK(ko_capabilities() & KO_CAPABILITY_2D);
    polylines_come_back();
    mesh_tells_what_it_is();
    samples_lie_where_they_say();
    fields_are_close_to_the_distance();
    derivatives_are_those_of_the_values();
    the_level_set_is_the_frame_again(KO_FEASIBLE_OUTSIDE);
    the_level_set_is_the_frame_again(KO_FEASIBLE_INSIDE);
    a_level_set_that_meets_the_box_is_open();
    files_hold_the_plane();
    return check_result();
}
