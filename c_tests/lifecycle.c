/* The main job, call by call: mesh, cloud, field, values, file. And what each of them promises of its numbers. */

#include "check.h"
#include <pthread.h>

static const char *saved = "lifecycle.kof";

static void mesh_tells_what_it_is(void) {
    ko_mesh *mesh = check_cube();
    size_t n_vertices = 0, n_triangles = 0;
    OK(ko_mesh_get_size(mesh, &n_vertices, &n_triangles));
    CHECK(n_vertices == 8 && n_triangles == 12);
    OK(ko_mesh_get_size(mesh, NULL, NULL));

    double vertices[24];
    uint32_t triangles[36];
    OK(ko_mesh_copy(mesh, 8, 12, vertices, triangles));
    CHECK(memcmp(vertices, check_cube_vertices, sizeof vertices) == 0);
    CHECK(memcmp(triangles, check_cube_triangles, sizeof triangles) == 0);

    ko_mesh_report report;
    OK(ko_mesh_get_report(mesh, sizeof report, &report));
    CHECK(report.struct_size == sizeof report);
    CHECK(report.n_vertices == 8 && report.n_triangles == 12 && report.n_components == 1);
    CHECK(report.closed == 1 && report.oriented == 1 && report.manifold == 1 && report.inside_out == 0);
    CHECK(report.n_boundary_edges == 0 && report.n_degenerate == 0 && report.n_unreferenced == 0);
    CHECK_NEAR(report.volume, 8.0, 1e-14);
    CHECK_NEAR(report.area, 24.0, 1e-14);
    CHECK(report.bounds_min[0] == -1.0 && report.bounds_max[2] == 1.0);

    OK(ko_mesh_flip(mesh));
    OK(ko_mesh_get_report(mesh, sizeof report, &report));
    CHECK(report.inside_out == 1);
    CHECK_NEAR(report.volume, -8.0, 1e-14);
    ko_mesh_free(mesh);
}

static void distances_are_exact(void) {
    ko_mesh *mesh = check_cube();
    const double points[] = {0, 0, 0, 2, 0, 0, 2, 2, 2, 0.5, 0, 0, 1, 0.25, 0.5, 1.5, 3, 0};
    const double right[] = {-1, 1, sqrt(3), -0.5, 0, sqrt(0.25 + 4)};
    double distances[6];
    OK(ko_mesh_signed_distance(mesh, points, 6, distances));
    for (int i = 0; i < 6; i++) {
        CHECK_NEAR(distances[i], right[i], 1e-15);
    }
    OK(ko_mesh_signed_distance(mesh, NULL, 0, NULL));
    ko_mesh_free(mesh);
}

static void samples_lie_where_they_say(void) {
    enum { N = 500 };
    ko_mesh *mesh = check_cube();
    ko_cloud *cloud = NULL, *again = NULL, *other = NULL;
    OK(ko_mesh_sample(mesh, N, 7, &cloud));
    OK(ko_mesh_sample(mesh, N, 7, &again));
    OK(ko_mesh_sample(mesh, N, 8, &other));
    size_t n = 0;
    OK(ko_cloud_get_size(cloud, &n));
    CHECK(n == N);

    static double points[3 * N], normals[3 * N], barycentric[3 * N], compared[3 * N];
    static uint32_t triangles[N];
    OK(ko_cloud_copy(cloud, N, points, normals));
    OK(ko_cloud_copy_origins(cloud, N, triangles, barycentric));
    for (int i = 0; i < N; i++) {
        CHECK(triangles[i] < 12);
        const uint32_t *corners = check_cube_triangles + 3 * (triangles[i] % 12);
        for (int a = 0; a < 3; a++) {
            double x = 0.0;
            for (int c = 0; c < 3; c++) {
                x += barycentric[3 * i + c] * check_cube_vertices[3 * corners[c] + a];
            }
            CHECK_NEAR(points[3 * i + a], x, 1e-15);
        }
        /* A cube's edges are sharp: its normals are those of its faces, and point to where the point is. */
        double length = 0.0, along = 0.0;
        for (int a = 0; a < 3; a++) {
            length += normals[3 * i + a] * normals[3 * i + a];
            along += normals[3 * i + a] * points[3 * i + a];
        }
        CHECK_NEAR(length, 1.0, 1e-15);
        CHECK_NEAR(along, 1.0, 1e-15);
    }
    OK(ko_cloud_copy(again, N, compared, NULL));
    CHECK(memcmp(points, compared, sizeof points) == 0);
    OK(ko_cloud_copy(other, N, compared, NULL));
    CHECK(memcmp(points, compared, sizeof points) != 0);
    OK(ko_cloud_copy(cloud, N, NULL, NULL));
    OK(ko_cloud_copy_origins(cloud, N, NULL, NULL));
    ko_cloud_free(cloud);
    ko_cloud_free(again);
    ko_cloud_free(other);
    ko_mesh_free(mesh);
}

struct listener {
    pthread_t thread;
    double last;
    int calls;
};

static int32_t listen(double fraction, const char *stage, void *data) {
    struct listener *listener = data;
    CHECK(pthread_equal(pthread_self(), listener->thread));
    CHECK(fraction >= listener->last && fraction <= 1.0);
    CHECK(stage != NULL && stage[0] != '\0');
    listener->last = fraction;
    listener->calls++;
    return 0;
}

static void fit_is_told_and_reported(void) {
    ko_cloud *cloud = check_sphere(500);
    struct listener listener = {pthread_self(), 0.0, 0};
    ko_fit_options options = check_options(10);
    options.control_points[2] = 12;
    options.n_threads = 2;
    options.progress = listen;
    options.progress_data = &listener;
    ko_field *field = NULL;
    OK(ko_field_fit(cloud, &options, &field));
    CHECK(listener.calls > 3 && listener.last == 1.0);

    ko_fit_report report;
    OK(ko_field_get_report(field, sizeof report, &report));
    CHECK(report.struct_size == sizeof report && report.dim == 3 && report.feasible == KO_FEASIBLE_OUTSIDE);
    CHECK(report.control_points[0] == 10 && report.control_points[1] == 10 && report.control_points[2] == 12);
    CHECK(report.n_unknowns == 1200 && report.n_points == 500 && report.iterations > 0);
    CHECK(report.bytes >= 1200 * sizeof(double));
    CHECK(report.residual > 0.0 && report.residual <= options.tolerance);
    CHECK(report.rms > 0.0 && report.rms < 0.01 && report.rms < report.max && report.max < 0.05);
    CHECK_NEAR(report.mean_gradient, 1.0, 0.1);
    CHECK_NEAR(report.diagonal, 2.0 * sqrt(3), 0.05);
    CHECK_NEAR(report.box_max[0] - report.box_min[0], 2.0 * 1.15, 0.02);
    CHECK(report.seconds_assembly >= 0.0 && report.seconds_solve > 0.0 && report.seconds_check >= 0.0);
    ko_field_free(field);
    ko_cloud_free(cloud);
}

/* The defaults fit without any option; the field is close to the distance, and positive outside. */
static void defaults_fit(void) {
    ko_cloud *cloud = check_sphere(500);
    ko_field *field = NULL;
    OK(ko_field_fit(cloud, NULL, &field));
    const double points[] = {0, 0, 0.9, 0.6, -0.6, 0.6, 1.02, 0.2, 0.1};
    double values[3];
    OK(ko_field_eval(field, points, 3, values, NULL, NULL));
    for (int i = 0; i < 3; i++) {
        const double *p = points + 3 * i;
        CHECK_NEAR(values[i], sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 1.0, 0.02);
    }
    ko_field_free(field);
    ko_cloud_free(cloud);
}

static void sides_differ_in_sign_alone(void) {
    ko_cloud *cloud = check_sphere(500);
    ko_fit_options options = check_options(8);
    ko_field *outside = NULL, *inside = NULL;
    OK(ko_field_fit(cloud, &options, &outside));
    options.feasible = KO_FEASIBLE_INSIDE;
    OK(ko_field_fit(cloud, &options, &inside));
    double *points = check_points(100, 2.0, 3), a[100], b[100];
    OK(ko_field_eval(outside, points, 100, a, NULL, NULL));
    OK(ko_field_eval(inside, points, 100, b, NULL, NULL));
    for (int i = 0; i < 100; i++) {
        CHECK_NEAR(a[i], -b[i], 1e-9);
    }
    free(points);
    ko_field_free(outside);
    ko_field_free(inside);
    ko_cloud_free(cloud);
}

/* A file gives the field back to the bit, also where one stood before. */
static void files_give_the_same_bits(void) {
    enum { N = 100 };
    ko_field *field = check_sphere_field(8), *other = check_sphere_field(7), *loaded = NULL;
    OK(ko_field_save(other, saved));
    OK(ko_field_save(field, saved));
    OK(ko_field_load(saved, &loaded));
    double *points = check_points(N, 2.0, 5);
    double a[10 * N], b[10 * N];
    OK(ko_field_eval(field, points, N, a, a + N, a + 4 * N));
    OK(ko_field_eval(loaded, points, N, b, b + N, b + 4 * N));
    CHECK(memcmp(a, b, sizeof a) == 0);
    ko_fit_report report, loaded_report;
    OK(ko_field_get_report(field, sizeof report, &report));
    OK(ko_field_get_report(loaded, sizeof report, &loaded_report));
    /* Files do not keep clear_sides and convergence_rate. */
    CHECK(memcmp(&report, &loaded_report, offsetof(ko_fit_report, clear_sides)) == 0);
    free(points);
    ko_field_free(field);
    ko_field_free(other);
    ko_field_free(loaded);
    CHECK(remove(saved) == 0);
}

/* What is wanted does not change what is given. */
static void outputs_do_not_depend_on_each_other(void) {
    enum { N = 50 };
    ko_field *field = check_sphere_field(8);
    double *points = check_points(N, 2.0, 9);
    double values[N], gradients[3 * N], hessians[6 * N];
    double v[N], g[3 * N], h[6 * N];
    OK(ko_field_eval(field, points, N, values, gradients, hessians));
    OK(ko_field_eval(field, points, N, v, NULL, NULL));
    OK(ko_field_eval(field, points, N, NULL, g, NULL));
    OK(ko_field_eval(field, points, N, NULL, NULL, h));
    OK(ko_field_eval(field, points, N, NULL, NULL, NULL));
    OK(ko_field_eval(field, NULL, 0, NULL, NULL, NULL));
    for (int i = 0; i < N; i++) {
        CHECK_NEAR(v[i], values[i], 1e-14);
        for (int a = 0; a < 3; a++) {
            CHECK_NEAR(g[3 * i + a], gradients[3 * i + a], 1e-13);
        }
        for (int p = 0; p < 6; p++) {
            CHECK_NEAR(h[6 * i + p], hessians[6 * i + p], 1e-12);
        }
    }
    free(points);
    ko_field_free(field);
}

/* Central differences of values and gradients at `p` against gradient and Hessian there, in units of the largest of those. */
static void check_derivatives(const ko_field *field, const double *p, double tolerance) {
    static const int packed[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    const double step = 1e-5;
    double gradient[3], hessian[6];
    OK(ko_field_eval(field, p, 1, NULL, gradient, hessian));
    double size = 1.0;
    for (int i = 0; i < 6; i++) {
        size = fmax(size, fmax(fabs(gradient[i % 3]), fabs(hessian[i])));
    }
    for (int a = 0; a < 3; a++) {
        double ends[6] = {p[0], p[1], p[2], p[0], p[1], p[2]};
        ends[a] -= step;
        ends[3 + a] += step;
        double values[2], gradients[6];
        OK(ko_field_eval(field, ends, 2, values, gradients, NULL));
        CHECK_NEAR((values[1] - values[0]) / (2.0 * step), gradient[a], 1e-8 * size);
        for (int b = 0; b < 3; b++) {
            CHECK_NEAR((gradients[3 + b] - gradients[b]) / (2.0 * step), hessian[packed[a][b]], tolerance * size);
        }
    }
}

static void derivatives_are_those_of_the_values(void) {
    ko_field *field = check_sphere_field(8);
    ko_fit_report report;
    OK(ko_field_get_report(field, sizeof report, &report));
    const double *low = report.box_min, *high = report.box_max;
    uint64_t seed = 11;
    for (int i = 0; i < 200; i++) {
        double inside[3], outside[3];
        for (int a = 0; a < 3; a++) {
            inside[a] = low[a] + (high[a] - low[a]) * (0.001 + 0.998 * check_random(&seed));
            outside[a] = low[a] + (high[a] - low[a]) * (3.0 * check_random(&seed) - 1.0);
        }
        /* The third derivative jumps at the faces of cells, by which a difference across one may be off. */
        check_derivatives(field, inside, 1e-3);
        check_derivatives(field, outside, 1e-3);
        /* On a face, an edge and a corner of the box: inside and outside meet with equal second derivatives. */
        for (int fixed = 1; fixed <= 3; fixed++) {
            for (int a = 0; a < fixed; a++) {
                inside[(a + i) % 3] = (i >> a) % 2 ? low[(a + i) % 3] : high[(a + i) % 3];
            }
            check_derivatives(field, inside, 1e-3);
        }
    }
    ko_field_free(field);
}

static void far_away_the_field_is_a_distance(void) {
    ko_field *field = check_sphere_field(16);
    const double points[] = {100, 0, 0, 0, -300, 0, 40, 50, -60};
    double values[3], gradients[9];
    OK(ko_field_eval(field, points, 3, values, gradients, NULL));
    for (int i = 0; i < 3; i++) {
        const double *p = points + 3 * i, *g = gradients + 3 * i;
        double distance = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 1.0;
        CHECK_NEAR(values[i] / distance, 1.0, 0.05);
        CHECK_NEAR(sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]), 1.0, 1e-3);
    }
    ko_field_free(field);
}

static void points_outside_the_box_are_told(void) {
    ko_field *field = check_sphere_field(8);
    ko_fit_report report;
    OK(ko_field_get_report(field, sizeof report, &report));
    double past = nextafter(report.box_min[1], -10.0) - 1e-12;
    const double points[] = {0, 0, 0, 0, report.box_min[1], 0, 0, past, 0, 5, 5, 5};
    uint8_t outside[4] = {9, 9, 9, 9};
    OK(ko_field_outside_box(field, points, 4, outside));
    CHECK(outside[0] == 0 && outside[1] == 0 && outside[2] == 1 && outside[3] == 1);
    OK(ko_field_outside_box(field, NULL, 0, NULL));
    ko_field_free(field);
}

/* A caller with a newer, longer struct is served while the rest is 0. (Shorter ones than the first version's: see errors.c.) Later
 * libraries run this program too and may know the first of these bytes, but not the last for long. */
static void structs_of_other_versions_are_served(void) {
    ko_field *field = check_sphere_field(6);
    struct {
        ko_fit_report report;
        unsigned char newer[1024];
    } grown;
    memset(&grown, 0xff, sizeof grown);
    OK(ko_field_get_report(field, sizeof grown, &grown.report));
    CHECK(grown.report.struct_size == sizeof grown && grown.newer[1023] == 0);
    ko_field_free(field);

    struct {
        ko_fit_options options;
        unsigned char newer[16];
    } options;
    OK(ko_fit_options_init(&options.options, sizeof options));
    options.options.control_points[0] = options.options.control_points[1] = options.options.control_points[2] = 6;
    ko_cloud *cloud = check_sphere(300);
    ko_field *fitted = NULL;
    OK(ko_field_fit(cloud, &options.options, &fitted));
    ko_field_free(fitted);
    ko_cloud_free(cloud);
}

static void versions_agree(void) {
    CHECK(ko_abi_version() == KO_ABI_VERSION);
    int major = -1, minor = -1, patch = -1;
    CHECK(sscanf(ko_version(), "%d.%d.%d", &major, &minor, &patch) == 3);
    CHECK(ko_capabilities() & KO_CAPABILITY_3D);
    CHECK(ko_capabilities() & KO_CAPABILITY_GZIP);
}

int main(void) {
    versions_agree();
    mesh_tells_what_it_is();
    distances_are_exact();
    samples_lie_where_they_say();
    fit_is_told_and_reported();
    defaults_fit();
    sides_differ_in_sign_alone();
    files_give_the_same_bits();
    outputs_do_not_depend_on_each_other();
    derivatives_are_those_of_the_values();
    far_away_the_field_is_a_distance();
    points_outside_the_box_are_told();
    structs_of_other_versions_are_served();
    return check_result();
}
