/* SPDX-License-Identifier: Apache-2.0 OR MIT */
#include "tables.h"

#include "failure.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

enum { N_PROBES = 11 };

static const char *yes_or_no(int32_t answer)
{
    return answer ? "yes" : "no";
}

static void print_curves_report(const ko_mesh_report *report)
{
    const double *lower = report->bounds_min, *upper = report->bounds_max;
    printf("Curves\n");
    printf("  points, segments      %" PRIu64 ", %" PRIu64 "\n", report->n_vertices, report->n_triangles);
    printf("  curves                %" PRIu64 "\n", report->n_components);
    printf("  bounds                %g %g to %g %g\n", lower[0], lower[1], upper[0], upper[1]);
    printf("  length, area          %g, %g\n", report->area, report->volume);
}

void print_mesh_report(const ko_mesh_report *report, uint32_t dim)
{
    if (dim == 2) {
        print_curves_report(report);
        return;
    }
    const double *lower = report->bounds_min, *upper = report->bounds_max;
    printf("Mesh\n");
    printf("  vertices, triangles   %" PRIu64 ", %" PRIu64 "\n", report->n_vertices, report->n_triangles);
    printf("  components            %" PRIu64 "\n", report->n_components);
    printf("  closed                %s (%" PRIu64 " boundary edges)\n", yes_or_no(report->closed), report->n_boundary_edges);
    printf("  oriented, manifold    %s, %s\n", yes_or_no(report->oriented), yes_or_no(report->manifold));
    printf("  degenerate, duplicate %" PRIu64 ", %" PRIu64 "\n", report->n_degenerate, report->n_duplicate);
    printf("  bounds                %g %g %g to %g %g %g\n", lower[0], lower[1], lower[2], upper[0], upper[1], upper[2]);
    printf("  area, volume          %g, %g\n", report->area, report->volume);
}

void print_fit_report(const ko_fit_report *report)
{
    const uint32_t *n = report->control_points;
    printf("\nField, phi > 0 %s the shape\n", report->feasible == KO_FEASIBLE_INSIDE ? "inside" : "outside");
    printf("  points                %" PRIu64 "\n", report->n_points);
    printf("  control points        %" PRIu64 " (%s%" PRIu32 " x %" PRIu32, report->n_unknowns,
           report->n_levels > 1 ? "coarsest level " : "", n[0], n[1]);
    if (report->dim == 3)
        printf(" x %" PRIu32, n[2]);
    printf(")\n");
    printf("  levels of cells       %" PRIu64 "\n", report->n_levels);
    printf("  memory held           %.2f MB\n", 1e-6 * (double)report->bytes);
    printf("  iterations, residual  %" PRIu32 ", %.1e\n", report->iterations, report->residual);
    printf("  seconds               %.2f assembly, %.2f solve, %.2f check\n", report->seconds_assembly, report->seconds_solve,
           report->seconds_check);
    printf("  |phi| at the points   %.1e D rms, %.1e D at most; D = %g\n", report->rms, report->max, report->diagonal);
    printf("  mean |grad phi| there %.4f\n", report->mean_gradient);
}

/* `points` [dim * N_PROBES] along the box's longest axis through its middle, a tenth of its length beyond either face. */
static void place_probes(const ko_fit_report *report, double *points)
{
    const int dim = (int)report->dim;
    int longest = 0;
    for (int k = 1; k < dim; ++k)
        if (report->box_max[k] - report->box_min[k] > report->box_max[longest] - report->box_min[longest])
            longest = k;
    for (int i = 0; i < N_PROBES; ++i) {
        for (int k = 0; k < dim; ++k) {
            const double along = k == longest ? -0.1 + 1.2 * i / (N_PROBES - 1) : 0.5;
            points[dim * i + k] = report->box_min[k] + along * (report->box_max[k] - report->box_min[k]);
        }
    }
}

static void print_title(int columns, int width, const char *title)
{
    printf("%*s", columns * width - 1, title);
}

bool print_probe(const ko_mesh *mesh, const ko_field *field, const ko_fit_report *report)
{
    const int dim = (int)report->dim;
    double points[3 * N_PROBES], values[N_PROBES], gradients[3 * N_PROBES], exact[N_PROBES];
    uint8_t outside[N_PROBES];
    place_probes(report, points);
    if (!succeeded(ko_field_eval(field, points, N_PROBES, values, gradients, NULL), "evaluating") ||
        !succeeded(ko_mesh_signed_distance(mesh, points, N_PROBES, exact), "measuring distances") ||
        !succeeded(ko_field_outside_box(field, points, N_PROBES, outside), "asking where points are"))
        return false;

    /* Distances to the mesh are positive outside, whatever phi is. */
    const double sign = report->feasible == KO_FEASIBLE_INSIDE ? -1.0 : 1.0;
    printf("\n");
    print_title(dim, 11, "point");
    printf(" %11s ", "phi");
    print_title(dim, 9, "grad phi");
    printf(" %8s %11s %8s\n", "length", "distance", "box");
    for (int i = 0; i < N_PROBES; ++i) {
        double square = 0;
        for (int k = 0; k < dim; ++k)
            printf("%10.4g ", points[dim * i + k]);
        printf("%11.4g ", values[i]);
        for (int k = 0; k < dim; ++k) {
            const double g = gradients[dim * i + k];
            printf("%8.3f ", g);
            square += g * g;
        }
        printf("%8.3f %11.4g %8s\n", sqrt(square), sign * exact[i], outside[i] ? "outside" : "in");
    }
    return true;
}
