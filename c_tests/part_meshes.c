/* Meshes of parts: what they bound, that they stay in their cells, and the field of one. */

#include "cogen.h"

static ko_mesh_report report_of(const ko_mesh *mesh) {
    ko_mesh_report report;
    OK(ko_mesh_get_report(mesh, sizeof report, &report));
    return report;
}

static void check_bounds_a_solid(const ko_mesh *mesh) {
    const ko_mesh_report report = report_of(mesh);
    CHECK(report.closed == 1 && report.oriented == 1 && report.inside_out == 0 && report.n_boundary_edges == 0);
    CHECK(report.manifold == 1 && report.n_degenerate == 0 && report.n_unreferenced == 0);
}

/* The area in the plane, or the volume. */
static double inside(const ko_mesh *mesh) { return report_of(mesh).volume; }

static void faces_of_cells_bound_them(void) {
    ko_part *plane = grid(-1.0, 2.0, 0.25, 8, 6), *space = NULL;
    uint8_t cells[48] = {0}, block[60] = {0};
    /* A ring of 5 x 4 cells around 3 x 2, and a cell alone. */
    for (int i = 0; i < 5; i++) {
        for (int j = 0; j < 4; j++) {
            cells[6 * i + j] = i == 0 || i == 4 || j == 0 || j == 3;
        }
    }
    cells[47] = 1;
    ko_mesh *mesh = NULL;
    OK(ko_part_mesh_of_cells(plane, cells, 48, KO_WITHIN_CELLS, 0, NULL, NULL, &mesh));
    check_bounds_a_solid(mesh);
    CHECK(report_of(mesh).n_components == 3 && report_of(mesh).n_triangles == 18 + 10 + 4);
    CHECK_NEAR(inside(mesh), 15 * 0.0625, 1e-12);
    ko_mesh_free(mesh);

    const double corner[3] = {1.0, 0.0, -1.0};
    const size_t counts[3] = {3, 4, 5};
    OK(ko_part_create(3, corner, 0.5, counts, NULL, 0, &space));
    for (int i = 0; i < 24; i++) {
        block[i] = 1;
    }
    OK(ko_part_mesh_of_cells(space, block, 60, KO_WITHIN_CELLS, 0, NULL, NULL, &mesh));
    check_bounds_a_solid(mesh);
    CHECK_NEAR(inside(mesh), 24 * 0.125, 1e-12);
    ko_mesh_free(mesh);
    ko_part_free(plane);
    ko_part_free(space);
}

/* Which cell of a grid a point is in, with room for what touches a border. */
static int is_kept(const uint8_t *cells, const size_t *counts, uint32_t dim, const double *corner, double edge, const double *p) {
    const int n = 1 << dim;
    for (int k = 0; k < n; k++) {
        size_t number = 0;
        int is_in = 1;
        for (uint32_t a = 0; a < dim; a++) {
            const double at = (p[a] - corner[a]) / edge + ((k >> a & 1) ? 1e-7 : -1e-7);
            is_in = is_in && at >= 0.0 && at < (double)counts[a];
            number = number * counts[a] + (size_t)(is_in ? at : 0.0);
        }
        if (is_in && cells[number]) {
            return 1;
        }
    }
    return 0;
}

static void moved_meshes_stay_in_their_cells(void) {
    enum { N = 16, ALL = N * N * N };
    static uint8_t cells[ALL];
    static double rho[ALL];
    const double corner[3] = {-1.2, -1.2, -1.2}, center[3] = {0.03, -0.02, 0.01};
    const size_t counts[3] = {N, N, N};
    const double edge = 2.4 / N;
    ko_part *part = NULL;
    OK(ko_part_create(3, corner, edge, counts, NULL, 0, &part));
    OK(ko_part_fractions_of_ball(part, center, 1.0, 4, 1, ALL, rho));
    for (int i = 0; i < ALL; i++) {
        cells[i] = rho[i] > 0.5;
    }
    const double ball = 2.0 / 3.0 * TAU, of_cells = edge * edge * edge * (double)count(cells, ALL);
    ko_mesh *mesh = NULL, *again = NULL;
    OK(ko_part_mesh_of_cells(part, cells, ALL, KO_WITHIN_CELLS, 20, NULL, NULL, &mesh));
    check_bounds_a_solid(mesh);
    CHECK(inside(mesh) < of_cells && inside(mesh) > 0.7 * of_cells);
    /* Points of its surface. */
    ko_cloud *cloud = NULL;
    enum { POINTS = 2000 };
    static double points[3 * POINTS], normals[3 * POINTS];
    OK(ko_mesh_sample(mesh, POINTS, 1, &cloud));
    OK(ko_cloud_copy(cloud, POINTS, points, normals));
    size_t out = 0;
    for (size_t i = 0; i < POINTS; i++) {
        out += !is_kept(cells, counts, 3, corner, edge, points + 3 * i);
    }
    CHECK(out == 0);

    /* The field of the part: negative inside, positive outside, about the distance. */
    ko_fit_options options = check_options(16);
    ko_field *field = NULL;
    OK(ko_field_fit(cloud, &options, &field));
    const double at[9] = {0.03, -0.02, 0.01, 1.6, 0.0, 0.0, 0.03, -0.02, 0.81};
    double phi[3];
    OK(ko_field_eval(field, at, 3, phi, NULL, NULL));
    CHECK(phi[0] < -0.5 && phi[1] > 0.4 && phi[2] < 0.0 && phi[2] > -0.3);
    ko_field_free(field);
    ko_cloud_free(cloud);

    /* Where it may be anywhere it keeps the volume; drawn to the densities it comes near to the ball. */
    OK(ko_part_mesh_of_cells(part, cells, ALL, KO_WITHIN_ANYWHERE, 20, NULL, NULL, &again));
    check_bounds_a_solid(again);
    CHECK_NEAR(inside(again), of_cells, 0.03 * of_cells);
    ko_mesh_free(again);
    OK(ko_part_mesh_of_densities(part, rho, ALL, 0.5, KO_WITHIN_ANYWHERE, 20, NULL, NULL, &again));
    check_bounds_a_solid(again);
    CHECK_NEAR(inside(again), ball, 0.05 * ball);
    ko_mesh_free(again);
    ko_mesh_free(mesh);
    ko_part_free(part);
}

static int32_t cancel(double fraction, const char *stage, void *data) {
    *(int *)data += fraction >= 0.0 && fraction <= 1.0 && stage != NULL;
    return 1;
}

static void what_is_wrong_is_refused(void) {
    ko_part *part = grid(0.0, 0.0, 1.0, 3, 3);
    uint8_t cells[9] = {1, 1, 0, 1, 1, 0, 0, 0, 0}, none[9] = {0}, wrong[9] = {0, 0, 0, 0, 3, 0, 0, 0, 0};
    double rho[9] = {1.0, 0.7, 0.2, 0.9, 0.6, 0.1, 0.0, 0.0, 0.0};
    ko_mesh *mesh = STALE(ko_mesh);
    FAILS(ko_part_mesh_of_cells(NULL, cells, 9, 0, 5, NULL, NULL, &mesh), KO_ERR_INVALID_ARGUMENT, "part is NULL");
    CHECK(mesh == NULL);
    FAILS(ko_part_mesh_of_cells(part, NULL, 9, 0, 5, NULL, NULL, &mesh), KO_ERR_INVALID_ARGUMENT, "cells is NULL");
    FAILS(ko_part_mesh_of_cells(part, cells, 9, 0, 5, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    FAILS(ko_part_mesh_of_cells(part, cells, 8, 0, 5, NULL, NULL, &mesh), KO_ERR_INVALID_ARGUMENT, "a set of 8 cells for a grid of 9");
    FAILS(ko_part_mesh_of_cells(part, wrong, 9, 0, 5, NULL, NULL, &mesh), KO_ERR_INVALID_ARGUMENT, "entry 4 of cells is 3");
    FAILS(ko_part_mesh_of_cells(part, cells, 9, 2, 5, NULL, NULL, &mesh), KO_ERR_INVALID_ARGUMENT, "within is 2");
    FAILS(ko_part_mesh_of_cells(part, none, 9, 0, 5, NULL, NULL, &mesh), KO_ERR_DEGENERATE, "no cells");
    FAILS(ko_part_mesh_of_densities(part, rho, 8, 0.5, 0, 5, NULL, NULL, &mesh), KO_ERR_INVALID_ARGUMENT, "8 densities for a grid of 9");
    FAILS(ko_part_mesh_of_densities(part, NULL, 9, 0.5, 0, 5, NULL, NULL, &mesh), KO_ERR_INVALID_ARGUMENT, "densities is NULL");
    FAILS(ko_part_mesh_of_densities(part, rho, 9, 1.0, 0, 5, NULL, NULL, &mesh), KO_ERR_INVALID_ARGUMENT, "the level is 1");
    FAILS(ko_part_mesh_of_densities(part, rho, 9, NAN, 0, 5, NULL, NULL, &mesh), KO_ERR_INVALID_ARGUMENT, "the level is NaN");
    FAILS(ko_part_mesh_of_densities(part, rho, 9, 0.5, -1, 5, NULL, NULL, &mesh), KO_ERR_INVALID_ARGUMENT, "within is -1");
    rho[2] = 1.5;
    FAILS(ko_part_mesh_of_densities(part, rho, 9, 0.5, 0, 5, NULL, NULL, &mesh), KO_ERR_INVALID_ARGUMENT, "density 2 is 1.5");
    int told = 0;
    FAILS(ko_part_mesh_of_cells(part, cells, 9, 0, 5, cancel, &told, &mesh), KO_ERR_CANCELLED, "cancelled");
    CHECK(told == 1 && mesh == NULL);
    ko_part_free(part);
}

int main(void) {
    faces_of_cells_bound_them();
    moved_meshes_stay_in_their_cells();
    what_is_wrong_is_refused();
    return check_result();
}
