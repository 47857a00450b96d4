/* Fits that go on from an earlier one, that do not trust every point, and fields of given control points. */

#include "check.h"

/* The sphere in space or circle in the plane, moved by `shift` along each axis. */
static ko_cloud *moved(uint32_t dim, size_t n, double shift) {
    double *normals = dim == 2 ? check_circle_points(n) : check_sphere_points(n);
    double *points = malloc(dim * n * sizeof *points);
    for (size_t i = 0; i < dim * n; i++) {
        points[i] = normals[i] + shift;
    }
    ko_cloud *cloud = NULL;
    OK(ko_cloud_from_points(dim, points, normals, n, &cloud));
    free(points);
    free(normals);
    return cloud;
}

static ko_fit_report report_of(const ko_field *field) {
    ko_fit_report report = {0};
    OK(ko_field_get_report(field, sizeof report, &report));
    return report;
}

static void a_refit_takes_few_iterations_on_the_same_box(uint32_t dim) {
    enum { N = 100 };
    ko_cloud *first = moved(dim, 500, 0.0), *second = moved(dim, 500, 0.002);
    ko_fit_options options = check_options(12);
    ko_field *start = NULL, *fresh = NULL, *again = NULL;
    OK(ko_field_fit(first, &options, &start));
    OK(ko_field_fit(second, &options, &fresh));
    double *points = check_points(N, 1.5, 1), before[N], after[N], values[N], fresh_values[N];
    OK(ko_field_eval(start, points, N, before, NULL, NULL));
    options.control_points[0] = 1; /* Not used, but checked. */
    FAILS(ko_field_refit(start, second, &options, &again), KO_ERR_INVALID_ARGUMENT, "along x is 1");
    options = check_options(5);
    options.margin = 3.0;
    OK(ko_field_refit(start, second, &options, &again));

    ko_fit_report old = report_of(start), report = report_of(again);
    CHECK(report.dim == dim && report.n_unknowns == old.n_unknowns && report.n_points == 500);
    CHECK(memcmp(report.box_min, old.box_min, sizeof old.box_min) == 0);
    CHECK(memcmp(report.box_max, old.box_max, sizeof old.box_max) == 0);
    CHECK(2 * report.iterations < report_of(fresh).iterations);
    CHECK(report.residual <= options.tolerance && report.rms < 2.0 * old.rms + 1e-4);

    OK(ko_field_eval(start, points, N, after, NULL, NULL));
    CHECK(memcmp(before, after, sizeof before) == 0);
    OK(ko_field_eval(again, points, N, values, NULL, NULL));
    OK(ko_field_eval(fresh, points, N, fresh_values, NULL, NULL));
    for (int i = 0; i < N; i++) {
        CHECK_NEAR(values[i], fresh_values[i], 0.05);
    }
    /* The defaults serve too. */
    ko_field *by_defaults = NULL;
    OK(ko_field_refit(start, second, NULL, &by_defaults));
    ko_field_free(by_defaults);
    free(points);
    ko_field_free(start);
    ko_field_free(fresh);
    ko_field_free(again);
    ko_cloud_free(first);
    ko_cloud_free(second);
}

static void a_refit_of_the_same_points_may_keep_their_weights(uint32_t dim) {
    ko_cloud *first = moved(dim, 500, 0.0), *second = moved(dim, 500, 0.002), *fewer = moved(dim, 400, 0.0);
    ko_fit_options options = check_options(12);
    ko_field *start = NULL, *again = NULL, *kept = NULL;
    OK(ko_field_fit(first, &options, &start));
    OK(ko_field_refit(start, second, &options, &again));
    options.reweighting = KO_REWEIGHT_KEEP;
    OK(ko_field_refit(start, second, &options, &kept));
    CHECK(report_of(kept).residual <= options.tolerance && report_of(kept).iterations < report_of(start).iterations);
    CHECK(report_of(kept).rms < 2.0 * report_of(again).rms + 1e-4);
    ko_field_free(kept);
    /* Nothing moved: nothing is to be done. */
    OK(ko_field_refit(start, first, &options, &kept));
    CHECK(report_of(kept).iterations <= 1);
    ko_field_free(kept);
    FAILS(ko_field_refit(start, fewer, &options, &kept), KO_ERR_INVALID_ARGUMENT, "fitted to 500 points, but 400 points");
    options.max_error = 1e-2;
    FAILS(ko_field_refit(start, second, &options, &kept), KO_ERR_UNSUPPORTED, "cells that stay as they are");
    options.max_error = 0.0;
    OK(ko_field_save(start, "start.kofield"));
    ko_field_free(start);
    OK(ko_field_load("start.kofield", &start));
    FAILS(ko_field_refit(start, second, &options, &kept), KO_ERR_INVALID_ARGUMENT, "does not know what points counted for");
    remove("start.kofield");
    ko_field_free(start);
    ko_field_free(again);
    ko_cloud_free(first);
    ko_cloud_free(second);
    ko_cloud_free(fewer);
}

/* A field's control points on its box are that field: to rounding, since a cell's edge is taken from the box. */
static void control_points_make_the_field_again(uint32_t dim) {
    enum { N = 200 };
    ko_field *field = dim == 2 ? check_circle_field(9) : check_sphere_field(9), *made = NULL;
    ko_fit_report report = report_of(field);
    size_t n = report.n_unknowns;
    double *numbers = malloc(n * sizeof *numbers), *again = malloc(n * sizeof *again);
    OK(ko_field_copy_control_points(field, n, numbers));
    OK(ko_field_from_control_points(dim, report.control_points, report.box_min, report.box_max, report.feasible,
                                    report.diagonal, numbers, n, &made));
    OK(ko_field_copy_control_points(made, n, again));
    CHECK(memcmp(numbers, again, n * sizeof *numbers) == 0);
    ko_fit_report made_report = report_of(made);
    CHECK(made_report.dim == dim && made_report.n_unknowns == n && made_report.diagonal == report.diagonal);
    CHECK(made_report.feasible == report.feasible && made_report.iterations == 0 && made_report.n_points == 0);
    CHECK(memcmp(made_report.control_points, report.control_points, sizeof report.control_points) == 0);
    double *points = check_points(N, 2.0, 2), values[N], made_values[N];
    OK(ko_field_eval(field, points, N, values, NULL, NULL));
    OK(ko_field_eval(made, points, N, made_values, NULL, NULL));
    for (int i = 0; i < N; i++) {
        CHECK_NEAR(values[i], made_values[i], 1e-12);
    }
    free(points);
    free(numbers);
    free(again);
    ko_field_free(field);
    ko_field_free(made);
}

/* The sphere with every tenth point moved out, and its normal turned over. */
static ko_cloud *spoilt(size_t n) {
    double *normals = check_sphere_points(n), *points = check_sphere_points(n);
    for (size_t i = 0; i < n; i += 10) {
        for (int a = 0; a < 3; a++) {
            points[3 * i + a] *= 1.3;
            normals[3 * i + a] *= -1.0;
        }
    }
    ko_cloud *cloud = NULL;
    OK(ko_cloud_from_points(3, points, normals, n, &cloud));
    free(points);
    free(normals);
    return cloud;
}

static double worst_on_the_sphere(const ko_field *field) {
    enum { N = 200 };
    double *points = check_sphere_points(N), values[N], worst = 0.0;
    OK(ko_field_eval(field, points, N, values, NULL, NULL));
    for (int i = 0; i < N; i++) {
        worst = fmax(worst, fabs(values[i]));
    }
    free(points);
    return worst;
}

static void points_of_no_weight_are_not_there(void) {
    enum { N = 1000 };
    ko_cloud *cloud = spoilt(N);
    static double weights[N];
    for (int i = 0; i < N; i++) {
        weights[i] = i % 10 == 0 ? 0.0 : 2.0;
    }
    OK(ko_cloud_set_weights(cloud, weights, N));
    ko_fit_options options = check_options(12);
    ko_field *field = NULL;
    OK(ko_field_fit(cloud, &options, &field));
    CHECK(report_of(field).n_points == 900 && report_of(field).n_outliers == 0);
    CHECK(worst_on_the_sphere(field) < 0.01);
    ko_field_free(field);
    ko_cloud_free(cloud);
}

static void a_robust_fit_finds_them_itself(void) {
    ko_cloud *cloud = spoilt(1000);
    ko_fit_options options = check_options(12);
    ko_field *plain = NULL, *robust = NULL;
    OK(ko_field_fit(cloud, &options, &plain));
    options.reweighting = KO_REWEIGHT_ROBUST;
    OK(ko_field_fit(cloud, &options, &robust));
    CHECK(report_of(plain).n_outliers == 0 && report_of(robust).n_outliers >= 100);
    CHECK(worst_on_the_sphere(robust) < 0.02);
    CHECK(worst_on_the_sphere(robust) < 0.5 * worst_on_the_sphere(plain));
    ko_field_free(plain);
    ko_field_free(robust);
    ko_cloud_free(cloud);
}

int main(void) {
    for (uint32_t dim = 2; dim <= 3; dim++) {
        a_refit_takes_few_iterations_on_the_same_box(dim);
        a_refit_of_the_same_points_may_keep_their_weights(dim);
        control_points_make_the_field_again(dim);
    }
    points_of_no_weight_are_not_there();
    a_robust_fit_finds_them_itself();
    return check_result();
}
