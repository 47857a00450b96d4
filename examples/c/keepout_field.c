/*
 * Keepout's main job: a mesh or curves in, a smooth field out, with a probe of it and a picture.
 * SPDX-License-Identifier: Apache-2.0 OR MIT
 */
#include "curves.h"
#include "failure.h"
#include "options.h"
#include "picture.h"
#include "progress.h"
#include "shape.h"
#include "tables.h"

#include <keepout.h>
#include <stdio.h>
#include <stdlib.h>

struct job {
    ko_mesh *mesh;
    ko_cloud *cloud;
    ko_field *field;
    ko_fit_report report;
};

static bool open_mesh(const struct options *options, ko_mesh **mesh)
{
    if (options->mesh == NULL)
        return shape_trefoil(mesh);
    if (curves_are_in(options->mesh))
        return curves_read(options->mesh, mesh);
    return succeeded(ko_mesh_read(options->mesh, mesh), "reading");
}

/* Tells what the mesh is like, and turns it over where its normals point into the solid. */
static bool check_mesh(ko_mesh *mesh)
{
    ko_mesh_report report;
    uint32_t dim;
    if (!succeeded(ko_mesh_get_report(mesh, sizeof report, &report), "judging the mesh") ||
        !succeeded(ko_mesh_get_dim(mesh, &dim), "judging the mesh"))
        return false;
    print_mesh_report(&report, dim);
    if (!report.closed)
        printf("Warning: the mesh is open. The field goes on across its holes; where it has no inside, signs mean little.\n");
    if (!report.oriented)
        printf("Warning: neighbouring triangles disagree about which side is out. Expect a poor field.\n");
    if (!report.inside_out)
        return true;
    printf("The mesh is inside out: turning it over.\n");
    return succeeded(ko_mesh_flip(mesh), "turning the mesh over");
}

static bool fit(const struct options *options, struct job *job)
{
    struct progress progress = progress_start();
    ko_fit_options fit;
    if (!succeeded(ko_mesh_sample(job->mesh, options->points, options->seed, &job->cloud), "sampling") ||
        !succeeded(ko_fit_options_init(&fit, sizeof fit), "setting options"))
        return false;
    for (int k = 0; k < 3; ++k)
        fit.control_points[k] = options->control_points[k];
    fit.max_error = options->max_error;
    fit.feasible = options->inside ? KO_FEASIBLE_INSIDE : KO_FEASIBLE_OUTSIDE;
    fit.n_threads = options->threads;
    fit.progress = progress_show;
    fit.progress_data = &progress;
    const int32_t status = ko_field_fit(job->cloud, &fit, &job->field);
    progress_end(&progress);
    if (status == KO_BUDGET_REACHED)
        printf("Warning: the error asked for needs more control points than a fit may take, or finer cells than the points tell.\n");
    return succeeded(status, "fitting") &&
           succeeded(ko_field_get_report(job->field, sizeof job->report, &job->report), "reporting");
}

static bool save(const struct options *options, const ko_field *field)
{
    if (options->save == NULL)
        return true;
    if (!succeeded(ko_field_save(field, options->save), "saving"))
        return false;
    printf("\nField: %s\n", options->save);
    return true;
}

static bool work(const struct options *options, struct job *job)
{
    if (!open_mesh(options, &job->mesh) || !check_mesh(job->mesh) || !fit(options, job))
        return false;
    print_fit_report(&job->report);
    if (!print_probe(job->mesh, job->field, &job->report) || !save(options, job->field) ||
        !picture_write(job->field, &job->report, options->threads, options->picture))
        return false;
    printf("\nPicture: %s\n", options->picture);
    return true;
}

int main(int argc, char **argv)
{
    struct options options;
    struct job job = {0};
    if (!options_read(argc, argv, &options))
        return EXIT_FAILURE;
    if (options.help) {
        options_print_help(&options);
        return EXIT_SUCCESS;
    }
    const bool ok = work(&options, &job);
    ko_field_free(job.field);
    ko_cloud_free(job.cloud);
    ko_mesh_free(job.mesh);
    return ok ? EXIT_SUCCESS : EXIT_FAILURE;
}
