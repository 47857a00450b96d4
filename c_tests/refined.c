/* Fits that refine their cells until an error is reached. */

#include "check.h"

static ko_fit_report report_of(const ko_field *field) {
    ko_fit_report report = {0};
    OK(ko_field_get_report(field, sizeof report, &report));
    return report;
}

/* Few control points and rough solves: valgrind runs this too. */
static ko_fit_options small_options(void) {
    ko_fit_options options = check_options(8);
    options.tolerance = 1e-2;
    return options;
}

static void a_fit_refines_until_the_error_is_reached(uint32_t dim) {
    enum { N = 60 };
    ko_cloud *cloud = check_lens(dim, dim == 2 ? 200 : 600);
    ko_fit_options options = small_options();
    CHECK(options.max_error == 0.0 && options.max_unknowns == 2000000);
    ko_field *one_grid = NULL, *field = NULL;
    OK(ko_field_fit(cloud, &options, &one_grid));
    ko_fit_report coarse = report_of(one_grid);
    CHECK(coarse.n_levels == 1);
    options.max_error = 0.5 * coarse.max;
    OK(ko_field_fit(cloud, &options, &field));
    ko_fit_report fine = report_of(field);
    CHECK(fine.n_levels > 1 && fine.max <= options.max_error && fine.n_unknowns > coarse.n_unknowns);
    CHECK(fine.control_points[0] == 8 && fine.clear_sides == 1.0 && fine.residual <= options.tolerance);

    /* Its control points are no tensor. */
    double *control_points = malloc(fine.n_unknowns * sizeof *control_points);
    FAILS(ko_field_copy_control_points(field, fine.n_unknowns, control_points), KO_ERR_UNSUPPORTED, "max_error 0");
    free(control_points);

    /* A file keeps it, in the box and around it. */
    double *points = check_points(N, 1.0, 1), values[N], again[N];
    ko_field *loaded = NULL, *refitted = NULL;
    OK(ko_field_save(field, "refined.kof"));
    OK(ko_field_load("refined.kof", &loaded));
    CHECK(remove("refined.kof") == 0);
    OK(ko_field_eval(field, points, N, values, NULL, NULL));
    OK(ko_field_eval(loaded, points, N, again, NULL, NULL));
    CHECK(memcmp(values, again, sizeof values) == 0);
    ko_fit_report kept = report_of(loaded);
    CHECK(kept.n_levels == fine.n_levels && kept.n_unknowns == fine.n_unknowns && kept.max == fine.max);

    /* A refit keeps the cells, and refines them where it is asked to. */
    options.max_error = 0.0;
    OK(ko_field_refit(loaded, cloud, &options, &refitted));
    CHECK(report_of(refitted).n_unknowns == fine.n_unknowns);
    ko_field_free(refitted);
    options.max_error = 1e-8;
    options.max_unknowns = fine.n_unknowns + 1;
    CHECK(ko_field_refit(loaded, cloud, &options, &refitted) == KO_BUDGET_REACHED);
    CHECK(report_of(refitted).n_unknowns <= options.max_unknowns);
    ko_field_free(refitted);
    free(points);
    ko_field_free(loaded);
    ko_field_free(field);
    ko_field_free(one_grid);
    ko_cloud_free(cloud);
}

static void a_budget_ends_it_with_a_remark(void) {
    ko_cloud *cloud = check_lens(3, 400);
    ko_fit_options options = small_options();
    options.max_error = 1e-7;
    options.max_unknowns = 2000;
    ko_field *field = NULL;
    CHECK(ko_field_fit(cloud, &options, &field) == KO_BUDGET_REACHED);
    CHECK(strcmp(ko_status_string(KO_BUDGET_REACHED), "KO_BUDGET_REACHED") == 0);
    CHECK(report_of(field).n_unknowns <= 2000 && report_of(field).max > 1e-7);
    ko_field_free(field);

    options.max_unknowns = 0;
    FAILS(ko_field_fit(cloud, &options, &field), KO_ERR_INVALID_ARGUMENT, "max_unknowns is 0");
    options.max_unknowns = 2000;
    options.max_error = -1.0;
    FAILS(ko_field_fit(cloud, &options, &field), KO_ERR_INVALID_ARGUMENT, "max_error is -1");
    options.max_error = 1e-3;
    options.reweighting = KO_REWEIGHT_ROBUST;
    FAILS(ko_field_fit(cloud, &options, &field), KO_ERR_UNSUPPORTED, "KO_REWEIGHT_LARGEST");
    ko_cloud_free(cloud);
}

int main(void) {
    a_fit_refines_until_the_error_is_reached(2);
    a_fit_refines_until_the_error_is_reached(3);
    a_budget_ends_it_with_a_remark();
    return check_result();
}
