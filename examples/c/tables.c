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

void print_mesh_report(const ko_mesh_report *report)
{
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
    printf("  control points        %" PRIu64 " (%" PRIu32 " x %" PRIu32 " x %" PRIu32 ")\n", report->n_unknowns, n[0], n[1],
           n[2]);
    printf("  memory held           %.2f MB\n", 1e-6 * (double)report->bytes);
    printf("  iterations, residual  %" PRIu32 ", %.1e\n", report->iterations, report->residual);
    printf("  seconds               %.2f assembly, %.2f solve, %.2f check\n", report->seconds_assembly, report->seconds_solve,
           report->seconds_check);
    printf("  |phi| at the points   %.1e D rms, %.1e D at most; D = %g\n", report->rms, report->max, report->diagonal);
    printf("  mean |grad phi| there %.4f\n", report->mean_gradient);
}

/* Along the box's longest axis through its middle, a tenth of its length beyond either face. */
static void place_probes(const ko_fit_report *report, double *points)
{
    int longest = 0;
    for (int k = 1; k < 3; ++k)
        if (report->box_max[k] - report->box_min[k] > report->box_max[longest] - report->box_min[longest])
            longest = k;
    for (int i = 0; i < N_PROBES; ++i) {
        for (int k = 0; k < 3; ++k) {
            const double along = k == longest ? -0.1 + 1.2 * i / (N_PROBES - 1) : 0.5;
            points[3 * i + k] = report->box_min[k] + along * (report->box_max[k] - report->box_min[k]);
        }
    }
}

bool print_probe(const ko_mesh *mesh, const ko_field *field, const ko_fit_report *report)
{
    double points[3 * N_PROBES], values[N_PROBES], gradients[3 * N_PROBES], exact[N_PROBES];
    uint8_t outside[N_PROBES];
    place_probes(report, points);
    if (!succeeded(ko_field_eval(field, points, N_PROBES, values, gradients, NULL), "evaluating") ||
        !succeeded(ko_mesh_signed_distance(mesh, points, N_PROBES, exact), "measuring distances") ||
        !succeeded(ko_field_outside_box(field, points, N_PROBES, outside), "asking where points are"))
        return false;

    /* Distances to the mesh are positive outside, whatever phi is. */
    const double sign = report->feasible == KO_FEASIBLE_INSIDE ? -1.0 : 1.0;
    printf("\n%32s %11s %26s %8s %11s %8s\n", "point", "phi", "grad phi", "length", "distance", "box");
    for (int i = 0; i < N_PROBES; ++i) {
        const double *p = points + 3 * i, *g = gradients + 3 * i;
        printf("%10.4g %10.4g %10.4g %11.4g %8.3f %8.3f %8.3f %8.3f %11.4g %8s\n", p[0], p[1], p[2], values[i], g[0], g[1],
               g[2], sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]), sign * exact[i], outside[i] ? "outside" : "in");
    }
    return true;
}
