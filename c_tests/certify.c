/* Certificates: a threshold above phi wherever a sample must not be, and the components that a body could swallow. */

#include "check.h"

/* Coarse, so that it takes a second: most boxes are of the slope beyond the box, which is told roughly anyway. */
#define TOLERANCE 0.3
#define MAX_BOXES 20000

/* Distance of a point to the cube [-1, 1]^dim, negative inside. */
static double cube_distance(const double *p, uint32_t dim) {
    double outside = 0.0, deepest = -INFINITY;
    for (uint32_t a = 0; a < dim; a++) {
        double d = fabs(p[a]) - 1.0;
        outside += d > 0.0 ? d * d : 0.0;
        deepest = d > deepest ? d : deepest;
    }
    return outside > 0.0 ? sqrt(outside) : deepest;
}

/* The cube in space, the square in the plane. */
static ko_mesh *block(uint32_t dim) {
    static const double corners[8] = {-1, -1, 1, -1, 1, 1, -1, 1};
    static const size_t start = 0;
    ko_mesh *mesh = NULL;
    if (dim == 3) {
        return check_cube();
    }
    OK(ko_mesh_from_polylines(corners, 4, &start, 1, 1, &mesh));
    return mesh;
}

static ko_field *field_of(const ko_mesh *mesh, int32_t feasible, double max_error) {
    ko_cloud *cloud = NULL;
    OK(ko_mesh_sample(mesh, 1500, 1, &cloud));
    ko_fit_options options = check_options(12);
    options.feasible = feasible;
    options.margin = 0.6; /* With less this coarse a field is steep beside the cube's corners, and its threshold high. */
    options.max_error = max_error;
    options.max_unknowns = 4000;
    ko_field *field = NULL;
    CHECK(ko_field_fit(cloud, &options, &field) >= 0);
    ko_cloud_free(cloud);
    return field;
}

/* No point that is infeasible or within `reach` has phi at the threshold, and eps and G hold. */
static void check_sound(const ko_field *field, uint32_t dim, double sign, double reach, const ko_certificate *found) {
    enum { N = 20000 };
    double *points = check_points(N, 1.6, 7), *values = malloc(N * sizeof *values), *slopes = malloc(3 * N * sizeof *slopes);
    OK(ko_field_eval(field, points, N, values, slopes, NULL));
    size_t n_counted = 0;
    for (size_t i = 0; i < N; i++) {
        double distance = cube_distance(points + dim * i, dim), slope = 0.0;
        if (fabs(distance) <= reach || distance * sign <= 0.0) {
            n_counted++;
            CHECK(values[i] < found->threshold);
        }
        for (uint32_t a = 0; a < dim; a++) {
            slope += slopes[dim * i + a] * slopes[dim * i + a];
        }
        CHECK(sqrt(slope) <= fmax(found->steepest, found->steepest_beyond));
    }
    CHECK(n_counted > N / 10);
    double place[3], value;
    memcpy(place, found->place, sizeof place);
    OK(ko_field_eval(field, place, 1, &value, NULL, NULL));
    CHECK(value == found->largest_found && value < found->threshold && found->threshold < (1.0 + 1.1 * TOLERANCE) * value + 0.01);
    CHECK(found->surface_error > 0.0 && found->surface_error < 0.2);
    free(points);
    free(values);
    free(slopes);
}

static void thresholds_are_sound(void) {
    for (uint32_t dim = 2; dim <= 3; dim++) {
        ko_mesh *mesh = block(dim);
        for (int i = 0; i < 4; i++) {
            int32_t feasible = i % 2 == 0 ? KO_FEASIBLE_OUTSIDE : KO_FEASIBLE_INSIDE;
            ko_field *field = field_of(mesh, feasible, i < 2 ? 0.0 : 5e-3);
            ko_certify_options options;
            OK(ko_certify_options_init(&options, sizeof options));
            options.n_threads = 1;
            options.tolerance = TOLERANCE;
            options.max_boxes = MAX_BOXES;
            ko_certificate found = {0}, again = {0};
            OK(ko_field_certify(field, mesh, 0.15, 0.05, &options, sizeof found, &found));
            CHECK(found.struct_size == sizeof found && found.side_certified == 1 && found.budget_reached == 0);
            CHECK(found.n_components == 1 && found.n_boxes > 0);
            check_sound(field, dim, feasible == KO_FEASIBLE_OUTSIDE ? 1.0 : -1.0, 0.2, &found);
            options.n_threads = 3;
            OK(ko_field_certify(field, mesh, 0.15, 0.05, &options, sizeof again, &again));
            CHECK(memcmp(&found, &again, sizeof found) == 0);
            options.max_boxes = 1;
            options.tolerance = 1e-4;
            CHECK(ko_field_certify(field, mesh, 0.15, 0.05, &options, sizeof again, &again) == KO_BUDGET_REACHED);
            CHECK(again.budget_reached == 1 && again.threshold >= found.largest_found);
            ko_field_free(field);
        }
        ko_mesh_free(mesh);
    }
}

/* A ball of samples that is at the threshold is clear of the cube; one that swallows the cube is told by the component's point. */
static void a_body_is_proven_clear_or_found_to_swallow(void) {
    enum { N = 2000 };
    const double clearance = 0.1, covering = 0.08;
    ko_mesh *mesh = check_cube();
    ko_field *field = field_of(mesh, KO_FEASIBLE_OUTSIDE, 0.0);
    ko_certify_options options;
    OK(ko_certify_options_init(&options, sizeof options));
    options.tolerance = 0.1;
    options.max_boxes = MAX_BOXES;
    options.n_threads = 1;
    ko_certificate found;
    OK(ko_field_certify(field, mesh, clearance, covering, &options, sizeof found, &found));
    double *sphere = check_sphere_points(N), values[N], points[3 * N];
    const double balls[2][4] = {{2.6, 0.3, 0.0, 0.7}, {0.0, 0.0, 0.0, 4.0}};
    for (int b = 0; b < 2; b++) {
        double least = INFINITY, radius = balls[b][3];
        for (size_t i = 0; i < 3 * N; i++) {
            points[i] = balls[b][i % 3] + radius * sphere[i];
        }
        OK(ko_field_eval(field, points, N, values, NULL, NULL));
        for (size_t i = 0; i < N; i++) {
            least = fmin(least, values[i]);
        }
        CHECK(least >= found.threshold);
        size_t n = 0;
        OK(ko_mesh_get_component_count(mesh, &n));
        CHECK(n == 1 && found.n_components == n);
        double corner[3], away = 0.0;
        OK(ko_mesh_copy_component_points(mesh, n, corner));
        for (int a = 0; a < 3; a++) {
            away += (corner[a] - balls[b][a]) * (corner[a] - balls[b][a]);
        }
        CHECK((sqrt(away) > radius) == (b == 0));
    }
    free(sphere);
    ko_field_free(field);
    ko_mesh_free(mesh);
}

static void components_are_counted_and_copied(void) {
    ko_mesh *mesh = check_frame();
    size_t n = 0;
    double points[4];
    OK(ko_mesh_get_component_count(mesh, &n));
    CHECK(n == 2);
    OK(ko_mesh_copy_component_points(mesh, 2, points));
    CHECK(points[0] == -1 && points[1] == -1 && points[2] == -0.5 && points[3] == -0.5);
    FAILS(ko_mesh_copy_component_points(mesh, 1, points), KO_ERR_INVALID_ARGUMENT, "n_components");
    FAILS(ko_mesh_copy_component_points(mesh, 2, NULL), KO_ERR_INVALID_ARGUMENT, "points");
    FAILS(ko_mesh_copy_component_points(NULL, 2, points), KO_ERR_INVALID_ARGUMENT, "mesh");
    FAILS(ko_mesh_get_component_count(NULL, &n), KO_ERR_INVALID_ARGUMENT, "mesh");
    FAILS(ko_mesh_get_component_count(mesh, NULL), KO_ERR_INVALID_ARGUMENT, "n_components");
    ko_mesh_free(mesh);
}

static int32_t stop(double fraction, const char *stage, void *data) {
    (void)stage;
    (void)data;
    return fraction > 0.3;
}

static void open_meshes_have_no_side_and_mistakes_are_told(void) {
    ko_mesh *cube = check_cube(), *open = NULL, *flat = block(2);
    OK(ko_mesh_from_triangles(check_cube_vertices, 8, check_cube_triangles, 11, &open));
    ko_field *field = field_of(cube, KO_FEASIBLE_OUTSIDE, 0.0), *inside = field_of(cube, KO_FEASIBLE_INSIDE, 0.0);
    ko_certify_options options;
    OK(ko_certify_options_init(&options, sizeof options));
    options.max_boxes = 200;
    options.n_threads = 1;
    ko_certificate found, before;
    CHECK(ko_field_certify(field, open, 0.1, 0.0, &options, sizeof found, &found) == KO_SIDE_NOT_CERTIFIED);
    CHECK(strcmp(ko_status_string(KO_SIDE_NOT_CERTIFIED), "KO_SIDE_NOT_CERTIFIED") == 0);
    CHECK(found.side_certified == 0 && found.threshold > 0.05);
    before = found;
    size_t size = sizeof found;
    FAILS(ko_field_certify(NULL, cube, 0, 0, NULL, size, &found), KO_ERR_INVALID_ARGUMENT, "field");
    FAILS(ko_field_certify(field, NULL, 0, 0, NULL, size, &found), KO_ERR_INVALID_ARGUMENT, "mesh");
    FAILS(ko_field_certify(field, flat, 0, 0, NULL, size, &found), KO_ERR_INVALID_ARGUMENT, "dim");
    FAILS(ko_field_certify(field, cube, -1, 0, NULL, size, &found), KO_ERR_INVALID_ARGUMENT, "clearance");
    FAILS(ko_field_certify(field, cube, 0, NAN, NULL, size, &found), KO_ERR_INVALID_ARGUMENT, "covering_radius");
    FAILS(ko_field_certify(field, cube, 0, 0, NULL, 8, &found), KO_ERR_INVALID_ARGUMENT, "struct_size");
    FAILS(ko_field_certify(field, cube, 0, 0, NULL, size, NULL), KO_ERR_INVALID_ARGUMENT, "certificate");
    FAILS(ko_field_certify(inside, cube, 0, 0, NULL, size, MISALIGNED(&found)), KO_ERR_INVALID_ARGUMENT, "certificate");
    FAILS(ko_certify_options_init(NULL, sizeof options), KO_ERR_INVALID_ARGUMENT, "options");
    OK(ko_certify_options_init(&options, sizeof options));
    options.tolerance = 0.0;
    FAILS(ko_field_certify(field, cube, 0, 0, &options, size, &found), KO_ERR_INVALID_ARGUMENT, "tolerance");
    OK(ko_certify_options_init(&options, sizeof options));
    options.max_boxes = 0;
    FAILS(ko_field_certify(field, cube, 0, 0, &options, size, &found), KO_ERR_INVALID_ARGUMENT, "max_boxes");
    OK(ko_certify_options_init(&options, sizeof options));
    options.reserved = 1;
    FAILS(ko_field_certify(field, cube, 0, 0, &options, size, &found), KO_ERR_INVALID_ARGUMENT, "reserved");
    OK(ko_certify_options_init(&options, sizeof options));
    options.n_threads = 2000;
    FAILS(ko_field_certify(field, cube, 0, 0, &options, size, &found), KO_ERR_INVALID_ARGUMENT, "n_threads");
    OK(ko_certify_options_init(&options, sizeof options));
    options.progress = stop;
    options.n_threads = 1;
    FAILS(ko_field_certify(field, cube, 0.1, 0, &options, size, &found), KO_ERR_CANCELLED, "cancelled");
    CHECK(memcmp(&found, &before, size) == 0);
    ko_field_free(field);
    ko_field_free(inside);
    ko_mesh_free(cube);
    ko_mesh_free(open);
    ko_mesh_free(flat);
}

/* A field that grows for ever where the design may not be has no threshold. */
static void no_threshold_where_phi_has_no_end(void) {
    static const uint32_t counts[3] = {4, 4, 4};
    static const double low[3] = {-2, -2, -2}, high[3] = {2, 2, 2};
    double control_points[64];
    for (int i = 0; i < 64; i++) {
        control_points[i] = 1.0;
    }
    ko_mesh *cube = check_cube();
    ko_field *field = NULL;
    OK(ko_field_from_control_points(3, counts, low, high, KO_FEASIBLE_INSIDE, 4.0, control_points, 64, &field));
    ko_certificate found;
    FAILS(ko_field_certify(field, cube, 0.1, 0, NULL, sizeof found, &found), KO_ERR_DEGENERATE, "for ever");
    ko_field_free(field);
    ko_mesh_free(cube);
}

/* With an argument only what needs no search to its end: for valgrind, under which one takes minutes. */
int main(int argc, char **argv) {
    (void)argv;
    if (argc == 1) {
        thresholds_are_sound();
        a_body_is_proven_clear_or_found_to_swallow();
    }
    components_are_counted_and_copied();
    open_meshes_have_no_side_and_mistakes_are_told();
    no_threshold_where_phi_has_no_end();
    return check_result();
}
