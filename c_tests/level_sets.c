/* What is made of a field in space: level sets, files of them, and values on lattices. */

#include "check.h"

static ko_mesh_report report_of(const ko_mesh *mesh) {
    ko_mesh_report report = {0};
    OK(ko_mesh_get_report(mesh, sizeof report, &report));
    return report;
}

static void check_watertight(const ko_mesh *mesh) {
    ko_mesh_report report = report_of(mesh);
    CHECK(report.closed == 1 && report.oriented == 1 && report.manifold == 1 && report.inside_out == 0);
    CHECK(report.n_components == 1 && report.n_boundary_edges == 0 && report.n_unreferenced == 0);
}

static double ball(double r) {
    return 4.0 / 3.0 * 3.141592653589793 * r * r * r;
}

/* Level 0 is the shape, level l what is l away from it on the feasible side; normals point out of the solid on either side. */
static void level_sets_are_spheres(void) {
    ko_cloud *cloud = check_sphere(1000);
    for (int32_t feasible = KO_FEASIBLE_OUTSIDE; feasible <= KO_FEASIBLE_INSIDE; feasible++) {
        ko_fit_options options = check_options(14);
        options.feasible = feasible;
        ko_field *field = NULL;
        OK(ko_field_fit(cloud, &options, &field));
        for (int i = -1; i <= 1; i++) {
            double level = 0.1 * i, r = feasible == KO_FEASIBLE_OUTSIDE ? 1.0 + level : 1.0 - level;
            ko_mesh *mesh = NULL;
            OK(ko_field_level_set(field, level, NULL, &mesh));
            check_watertight(mesh);
            ko_mesh_report report = report_of(mesh);
            CHECK_NEAR(report.volume / ball(r), 1.0, 0.02);
            CHECK(2 * report.n_vertices == report.n_triangles + 4);
            double *vertices = malloc(3 * report.n_vertices * sizeof *vertices);
            double *values = malloc(report.n_vertices * sizeof *values);
            OK(ko_mesh_copy(mesh, report.n_vertices, report.n_triangles, vertices, NULL));
            OK(ko_field_eval(field, vertices, report.n_vertices, values, NULL, NULL));
            for (size_t v = 0; v < report.n_vertices; v++) {
                CHECK_NEAR(values[v], level, 1e-8);
            }
            free(vertices);
            free(values);
            ko_mesh_free(mesh);
        }
        ko_field_free(field);
    }
    ko_cloud_free(cloud);
}

static void a_level_set_that_meets_the_box_is_open(void) {
    ko_field *field = check_sphere_field(10);
    ko_mesh *mesh = NULL;
    CHECK(ko_field_level_set(field, 0.3, NULL, &mesh) == KO_OPEN_AT_BOX);
    CHECK(strcmp(ko_status_string(KO_OPEN_AT_BOX), "KO_OPEN_AT_BOX") == 0);
    ko_mesh_report report = report_of(mesh);
    CHECK(report.closed == 0 && report.n_boundary_edges > 0 && report.oriented == 1 && report.manifold == 1);
    ko_mesh_free(mesh);
    ko_field_free(field);
}

static int32_t listen(double fraction, const char *stage, void *data) {
    double *last = data;
    CHECK(fraction >= *last && fraction <= 1.0 && stage != NULL && stage[0] != '\0');
    *last = fraction;
    return 0;
}

static void options_do_what_they_say(void) {
    ko_field *field = check_sphere_field(8);
    ko_level_set_options options;
    OK(ko_level_set_options_init(&options, sizeof options));
    CHECK(options.struct_size == sizeof options && options.subdivisions > 0 && options.progress == NULL);
    double last = 0.0;
    options.progress = listen;
    options.progress_data = &last;
    options.n_threads = 1;
    ko_mesh *mesh = NULL, *full = NULL, *coarse = NULL;
    OK(ko_field_level_set(field, 0.0, &options, &mesh));
    CHECK(last == 1.0);
    last = 0.0;
    options.shortest_edge = 0.0;
    OK(ko_field_level_set(field, 0.0, &options, &full));
    last = 0.0;
    options.subdivisions = 1;
    OK(ko_field_level_set(field, 0.0, &options, &coarse));
    uint64_t usual = report_of(mesh).n_triangles;
    CHECK(report_of(full).n_triangles > usual && report_of(coarse).n_triangles < usual);
    check_watertight(full);
    check_watertight(coarse);
    ko_mesh_free(mesh);
    ko_mesh_free(full);
    ko_mesh_free(coarse);
    ko_field_free(field);
}

/* Each format reads back with the same counts, closed; all but STL with the same bits. */
static void files_read_back(void) {
    ko_field *field = check_sphere_field(9);
    ko_mesh *mesh = NULL;
    OK(ko_field_level_set(field, 0.0, NULL, &mesh));
    ko_mesh_report report = report_of(mesh);
    size_t n = report.n_vertices, n_triangles = report.n_triangles;
    double *vertices = malloc(3 * n * sizeof *vertices), *read = malloc(3 * n * sizeof *read);
    uint32_t *triangles = malloc(3 * n_triangles * sizeof *triangles);
    uint32_t *triangles_read = malloc(3 * n_triangles * sizeof *triangles_read);
    OK(ko_mesh_copy(mesh, n, n_triangles, vertices, triangles));
    const char *const paths[] = {"set.obj", "set.off", "set.PLY", "set.stl"};
    for (int i = 0; i < 4; i++) {
        ko_mesh *again = NULL;
        for (int time = 0; time < 2; time++) { /* The second replaces the first. */
            OK(ko_mesh_write(mesh, paths[i]));
        }
        OK(ko_mesh_read(paths[i], &again));
        ko_mesh_report read_report = report_of(again);
        CHECK(read_report.n_vertices == n && read_report.n_triangles == n_triangles);
        CHECK_NEAR(read_report.volume, report.volume, 1e-6);
        check_watertight(again);
        if (i < 3 && read_report.n_vertices == n && read_report.n_triangles == n_triangles) {
            OK(ko_mesh_copy(again, n, n_triangles, read, triangles_read));
            CHECK(memcmp(vertices, read, 3 * n * sizeof *read) == 0);
            CHECK(memcmp(triangles, triangles_read, 3 * n_triangles * sizeof *triangles) == 0);
        }
        ko_mesh_free(again);
        CHECK(remove(paths[i]) == 0);
    }
    free(vertices);
    free(read);
    free(triangles);
    free(triangles_read);
    ko_mesh_free(mesh);
    ko_field_free(field);
}

/* A lattice's values are those of its points, one by one, on any number of threads and whatever else is wanted. */
static void check_lattice(const ko_field *field, size_t dim, const double *origin, const double *steps,
                          const size_t *counts, uint32_t n_steps) {
    size_t n = 1;
    for (uint32_t j = 0; j < n_steps; j++) {
        n *= counts[j];
    }
    double *points = malloc(dim * n * sizeof *points);
    for (size_t i = 0; i < n; i++) {
        size_t rest = i;
        memcpy(points + dim * i, origin, dim * sizeof *origin);
        for (uint32_t j = n_steps; j-- > 0;) {
            for (size_t a = 0; a < dim; a++) {
                points[dim * i + a] += (double)(rest % counts[j]) * steps[dim * j + a];
            }
            rest /= counts[j];
        }
    }
    size_t numbers = (1 + dim) * n;
    double *right = malloc(numbers * sizeof *right), *found = malloc(numbers * sizeof *found);
    OK(ko_field_eval(field, points, n, right, right + n, NULL));
    for (uint32_t n_threads = 1; n_threads <= 3; n_threads++) {
        memset(found, 0xff, numbers * sizeof *found);
        OK(ko_field_eval_lattice(field, origin, steps, counts, n_steps, found, found + n, n_threads));
        for (size_t i = 0; i < numbers; i++) {
            CHECK_NEAR(found[i], right[i], 1e-12);
        }
        memcpy(right, found, numbers * sizeof *found);
        OK(ko_field_eval_lattice(field, origin, steps, counts, n_steps, NULL, found + n, n_threads));
        CHECK(memcmp(right, found, numbers * sizeof *found) == 0);
    }
    OK(ko_field_eval_lattice(field, origin, steps, counts, n_steps, found, NULL, 0));
    for (size_t i = 0; i < n; i++) {
        CHECK_NEAR(found[i], right[i], 1e-13);
    }
    OK(ko_field_eval_lattice(field, origin, steps, counts, n_steps, NULL, NULL, 1));
    free(points);
    free(right);
    free(found);
}

static void lattices_are_evaluated_in_rows(void) {
    const double origin[3] = {-1.4, -1.3, -1.2};
    const double steps[9] = {0.1, 0.02, 0.0, 0.0, 0.12, -0.01, 0.03, 0.0, 0.11};
    const size_t counts[3] = {23, 20, 21}; /* More points than one thread's item. */
    ko_field *space = check_sphere_field(8), *plane = check_circle_field(8);
    for (uint32_t n_steps = 1; n_steps <= 3; n_steps++) {
        check_lattice(space, 3, origin, steps, counts, n_steps);
    }
    for (uint32_t n_steps = 1; n_steps <= 2; n_steps++) {
        check_lattice(plane, 2, origin, steps, counts, n_steps);
    }
    ko_field_free(space);
    ko_field_free(plane);
}

int main(void) {
    level_sets_are_spheres();
    a_level_set_that_meets_the_box_is_open();
    options_do_what_they_say();
    files_read_back();
    lattices_are_evaluated_in_rows();
    return check_result();
}
