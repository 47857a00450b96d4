/* Normals of points that come without: to the right side, with flags and a report of what was found. */

#include "check.h"

enum { N = 800, N_LINE = 120 };

/* The sphere or circle, the first point of it again, and one far from all. */
static double *points_of(uint32_t dim) {
    double *shape = dim == 2 ? check_circle_points(N) : check_sphere_points(N);
    double *points = malloc(dim * (N + 2) * sizeof *points);
    memcpy(points, shape, dim * N * sizeof *points);
    for (uint32_t a = 0; a < dim; a++) {
        points[dim * N + a] = points[a];
        points[dim * (N + 1) + a] = 3.0;
    }
    free(shape);
    return points;
}

static size_t flagged(const uint8_t *flags, size_t n, uint8_t bit) {
    size_t count = 0;
    for (size_t i = 0; i < n; i++) {
        count += (flags[i] & bit) != 0;
    }
    return count;
}

static void check_flags(const ko_normal_report *report, const uint8_t *flags, size_t n) {
    CHECK(flagged(flags, n, KO_POINT_COPY) == report->n_copies);
    CHECK(flagged(flags, n, KO_POINT_OUTLIER) == report->n_outliers);
    CHECK(flagged(flags, n, KO_POINT_DEGENERATE) == report->n_degenerate);
    CHECK(flagged(flags, n, KO_POINT_DOUBTFUL) == report->n_doubtful);
    CHECK(flagged(flags, n, (uint8_t)~(KO_POINT_COPY | KO_POINT_OUTLIER | KO_POINT_DEGENERATE | KO_POINT_DOUBTFUL)) == 0);
}

static void normals_point_out(uint32_t dim) {
    double *points = points_of(dim);
    static uint8_t flags[N + 2];
    static double copied[3 * (N + 2)], normals[3 * (N + 2)], other[3 * (N + 2)];
    memset(flags, 0xff, sizeof flags);
    ko_normal_report report;
    ko_cloud *cloud = NULL, *plain = NULL;
    OK(ko_cloud_estimate_normals(dim, points, N + 2, NULL, &cloud, flags, sizeof report, &report));
    CHECK(report.struct_size == sizeof report && report.n_copies == 1 && report.n_outliers == 1);
    CHECK(report.n_components >= 1 && report.agreement > 0.9 && report.agreement <= 1.0 && report.seconds >= 0.0);
    CHECK(flags[0] == 0 && (flags[N] & KO_POINT_COPY) && (flags[N + 1] & KO_POINT_OUTLIER));
    check_flags(&report, flags, N + 2);

    OK(ko_cloud_copy(cloud, N + 2, copied, normals));
    CHECK(memcmp(points, copied, dim * (N + 2) * sizeof *points) == 0);
    for (size_t i = 0; i <= N; i++) {
        double along = 0.0;
        for (uint32_t a = 0; a < dim; a++) {
            along += points[dim * i + a] * normals[dim * i + a];
        }
        CHECK_NEAR(along, 1.0, 0.01);
    }
    /* NULL normals of a cloud are these. */
    OK(ko_cloud_from_points(dim, points, NULL, N + 2, &plain));
    OK(ko_cloud_copy(plain, N + 2, NULL, other));
    CHECK(memcmp(normals, other, dim * (N + 2) * sizeof *normals) == 0);
    ko_cloud_free(plain);
    /* Neither flags nor report are needed, and threads do not change the result. */
    ko_normal_options options;
    OK(ko_normal_options_init(&options, sizeof options));
    options.n_threads = 3;
    OK(ko_cloud_estimate_normals(dim, points, N + 2, &options, &plain, NULL, 0, NULL));
    OK(ko_cloud_copy(plain, N + 2, NULL, other));
    CHECK(memcmp(normals, other, dim * (N + 2) * sizeof *normals) == 0);
    ko_cloud_free(plain);
    ko_cloud_free(cloud);
    free(points);
}

static int32_t listen(double fraction, const char *stage, void *data) {
    double *last = data;
    CHECK(fraction >= *last && fraction <= 1.0 && stage != NULL && stage[0] != '\0');
    *last = fraction;
    return 0;
}

static void options_do_what_they_say(void) {
    double *points = points_of(3), last = 0.0;
    ko_normal_options options;
    OK(ko_normal_options_init(&options, sizeof options));
    CHECK(options.struct_size == sizeof options && options.neighbours == 0 && options.progress == NULL);
    options.neighbours = 16;
    options.outlier_factor = 1e6;
    options.n_threads = 1;
    options.progress = listen;
    options.progress_data = &last;
    ko_cloud *cloud = NULL;
    ko_normal_report report;
    OK(ko_cloud_estimate_normals(3, points, N + 2, &options, &cloud, NULL, sizeof report, &report));
    CHECK(last == 1.0 && report.n_outliers == 0);
    ko_cloud_free(cloud);
    free(points);
}

/* Points of a long line far from the sphere have no plane. */
static void points_of_a_line_are_told(void) {
    double *sphere = check_sphere_points(N);
    static double points[3 * (N + N_LINE)];
    static uint8_t flags[N + N_LINE];
    memcpy(points, sphere, 3 * N * sizeof *points);
    for (int i = 0; i < N_LINE; i++) {
        points[3 * (N + i)] = 10.0 + 0.0625 * i;
    }
    ko_cloud *cloud = NULL;
    ko_normal_report report;
    OK(ko_cloud_estimate_normals(3, points, N + N_LINE, NULL, &cloud, flags, sizeof report, &report));
    CHECK(report.n_degenerate == N_LINE && report.n_components == 2);
    CHECK((flags[N + 3] & KO_POINT_DEGENERATE) && !(flags[3] & KO_POINT_DEGENERATE));
    check_flags(&report, flags, N + N_LINE);
    ko_cloud_free(cloud);
    free(sphere);
}

/* A field of estimated normals is close to that of the true ones, outliers left out by their flags. */
static void a_fit_takes_them(void) {
    double *points = points_of(3);
    static uint8_t flags[N + 2];
    static double weights[N + 2];
    ko_cloud *cloud = NULL;
    OK(ko_cloud_estimate_normals(3, points, N + 2, NULL, &cloud, flags, 0, NULL));
    for (int i = 0; i < N + 2; i++) {
        weights[i] = flags[i] & (KO_POINT_OUTLIER | KO_POINT_COPY) ? 0.0 : 1.0;
    }
    OK(ko_cloud_set_weights(cloud, weights, N + 2));
    ko_fit_options options = check_options(10);
    ko_field *field = NULL;
    OK(ko_field_fit(cloud, &options, &field));
    const double probes[9] = {0.9, 0, 0, 0, -1.05, 0, 0.6, 0.6, 0.6};
    double values[3];
    OK(ko_field_eval(field, probes, 3, values, NULL, NULL));
    for (int i = 0; i < 3; i++) {
        const double *p = probes + 3 * i;
        CHECK_NEAR(values[i], sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 1.0, 0.02);
    }
    ko_field_free(field);
    ko_cloud_free(cloud);
    free(points);
}

int main(void) {
    normals_point_out(2);
    normals_point_out(3);
    options_do_what_they_say();
    points_of_a_line_are_told();
    a_fit_takes_them();
    return check_result();
}
