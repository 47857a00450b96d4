/* Clouds smoothed, and the sides of clouds of closed and of open shapes. */

#include "check.h"

/* Points of the sphere and of the circle. Those of the circle are farther apart than the noise is high. */
enum { N = 1500, N_CIRCLE = 300 };

static size_t n_of(uint32_t dim) {
    return dim == 2 ? N_CIRCLE : N;
}

/* The unit sphere or circle with noise in points and normals. */
static ko_cloud *noisy(uint32_t dim) {
    const size_t n = n_of(dim);
    double *points = dim == 2 ? check_circle_points(n) : check_sphere_points(n);
    double *normals = malloc(dim * n * sizeof *normals);
    uint64_t seed = 3;
    for (size_t i = 0; i < dim * n; i++) {
        normals[i] = points[i] + 0.3 * (2.0 * check_random(&seed) - 1.0);
        points[i] += (dim == 2 ? 0.01 : 0.02) * (2.0 * check_random(&seed) - 1.0);
    }
    ko_cloud *cloud = NULL;
    OK(ko_cloud_from_points(dim, points, normals, n, &cloud));
    free(points);
    free(normals);
    return cloud;
}

/* Root mean square distance of the cloud's points from the unit sphere or circle, and of its normals from the right ones. */
static void measure(const ko_cloud *cloud, uint32_t dim, double *off, double *turned) {
    const size_t n = n_of(dim);
    double points[3 * N], normals[3 * N];
    OK(ko_cloud_copy(cloud, n, points, normals));
    *off = *turned = 0.0;
    for (size_t i = 0; i < n; i++) {
        double length = 0.0;
        for (uint32_t a = 0; a < dim; a++) {
            length += points[dim * i + a] * points[dim * i + a];
        }
        length = sqrt(length);
        *off += (length - 1.0) * (length - 1.0);
        for (uint32_t a = 0; a < dim; a++) {
            double difference = normals[dim * i + a] - points[dim * i + a] / length;
            *turned += difference * difference;
        }
    }
    *off = sqrt(*off / (double)n);
    *turned = sqrt(*turned / (double)n);
}

static int32_t listen(double fraction, const char *stage, void *data) {
    double *last = data;
    CHECK(fraction >= *last && fraction <= 1.0 && stage != NULL && stage[0] != '\0');
    *last = fraction;
    return 0;
}

static void smoothing_lowers_noise(uint32_t dim) {
    ko_cloud *cloud = noisy(dim), *once = NULL, *twice = NULL;
    double off, turned, off_once, turned_once, off_twice, turned_twice, last = -1.0;
    measure(cloud, dim, &off, &turned);
    OK(ko_cloud_smooth(cloud, NULL, &once));
    measure(once, dim, &off_once, &turned_once);
    CHECK(off_once < 0.75 * off && turned_once < 0.75 * turned);

    ko_smooth_options options;
    OK(ko_smooth_options_init(&options, sizeof options));
    CHECK(options.struct_size == sizeof options && options.neighbours == 0 && options.rounds == 1 && options.progress == NULL);
    options.rounds = 2;
    options.progress = listen;
    options.progress_data = &last;
    OK(ko_cloud_smooth(cloud, &options, &twice));
    measure(twice, dim, &off_twice, &turned_twice);
    CHECK(last == 1.0 && off_twice < off_once && turned_twice < turned_once);
    /* The cloud itself stays. */
    double off_after, turned_after;
    measure(cloud, dim, &off_after, &turned_after);
    CHECK(off_after == off && turned_after == turned);

    uint32_t its_dim = 0;
    size_t n = 0;
    OK(ko_cloud_get_dim(once, &its_dim));
    OK(ko_cloud_get_size(once, &n));
    CHECK(its_dim == dim && n == n_of(dim));
    ko_cloud_free(twice);

    /* Threads do not change the result. */
    double points[3 * N], others[3 * N];
    options.n_threads = 3;
    last = -1.0;
    OK(ko_cloud_smooth(cloud, &options, &twice));
    OK(ko_cloud_copy(twice, n, points, NULL));
    ko_cloud_free(twice);
    options.n_threads = 1;
    last = -1.0;
    OK(ko_cloud_smooth(cloud, &options, &twice));
    OK(ko_cloud_copy(twice, n, others, NULL));
    CHECK(memcmp(points, others, dim * n * sizeof *points) == 0);
    ko_cloud_free(twice);
    /* More neighbours smooth more. */
    options.rounds = 1;
    options.neighbours = dim == 2 ? 24 : 80;
    last = -1.0;
    OK(ko_cloud_smooth(cloud, &options, &twice));
    measure(twice, dim, &off_twice, &turned_twice);
    CHECK(off_twice < off_once && turned_twice < turned_once);
    ko_cloud_free(twice);
    ko_cloud_free(once);
    ko_cloud_free(cloud);
}

/* Points of weight 0 take no part in a fit to the smoothed cloud either; where on a mesh its points were taken is no longer known. */
static void weights_stay_and_origins_go(void) {
    ko_mesh *mesh = check_cube();
    ko_cloud *cloud = NULL, *smoothed = NULL;
    OK(ko_mesh_sample(mesh, 400, 1, &cloud));
    double weights[400];
    for (int i = 0; i < 400; i++) {
        weights[i] = i < 5 ? 0.0 : 1.0;
    }
    OK(ko_cloud_set_weights(cloud, weights, 400));
    OK(ko_cloud_smooth(cloud, NULL, &smoothed));
    ko_fit_options options = check_options(6);
    ko_field *field = NULL;
    ko_fit_report report;
    OK(ko_field_fit(smoothed, &options, &field));
    OK(ko_field_get_report(field, sizeof report, &report));
    CHECK(report.n_points == 395);
    uint32_t triangles[400];
    FAILS(ko_cloud_copy_origins(smoothed, 400, triangles, NULL), KO_ERR_INVALID_ARGUMENT, "sampled from a mesh");
    OK(ko_cloud_copy_origins(cloud, 400, triangles, NULL));
    ko_field_free(field);
    ko_cloud_free(smoothed);
    ko_cloud_free(cloud);
    ko_mesh_free(mesh);
}

/* Flat: the segment from (-1, 0) to (1, 0), normals up; in space, the square of it along y, with normals along z. */
static ko_cloud *flat(uint32_t dim) {
    enum { SIDE = 40 };
    static double points[3 * SIDE * SIDE], normals[3 * SIDE * SIDE];
    size_t n = dim == 2 ? SIDE : SIDE * SIDE;
    memset(points, 0, sizeof points);
    memset(normals, 0, sizeof normals);
    for (size_t i = 0; i < n; i++) {
        points[dim * i] = -1.0 + 2.0 * (double)(i % SIDE) / (SIDE - 1);
        if (dim == 3) {
            points[3 * i + 1] = -1.0 + 2.0 * (double)(i / SIDE) / (SIDE - 1);
        }
        normals[dim * i + dim - 1] = 1.0;
    }
    ko_cloud *cloud = NULL;
    OK(ko_cloud_from_points(dim, points, normals, n, &cloud));
    return cloud;
}

static void closed_shapes_have_sides_everywhere(void) {
    ko_cloud *circle = check_circle(N_CIRCLE), *sphere = check_sphere(N);
    const double plane[8] = {0, 0, 0.9, 0, 0, 1.1, 50, 3}, space[12] = {0, 0, 0, 0.5, 0.5, 0.5, 0, 0, 1.2, -40, 7, 9};
    const double right[4] = {-1, -1, 1, 1};
    double sides[4], one = 7.0;
    OK(ko_cloud_sides(circle, plane, 4, sides));
    for (int i = 0; i < 4; i++) {
        CHECK_NEAR(sides[i], right[i], 0.15);
    }
    OK(ko_cloud_sides(sphere, space, 4, sides));
    for (int i = 0; i < 4; i++) {
        CHECK_NEAR(sides[i], right[i], 0.15);
    }
    /* Alone as among others; none are fine. */
    OK(ko_cloud_sides(sphere, space + 6, 1, &one));
    CHECK(one == sides[2]);
    OK(ko_cloud_sides(sphere, NULL, 0, NULL));
    ko_cloud_free(circle);
    ko_cloud_free(sphere);
}

static void open_shapes_have_sides_beside_them_alone(void) {
    ko_cloud *segment = flat(2), *sheet = flat(3);
    const double plane[8] = {0, 0.05, 0, -0.05, 0, 20, 2.5, 0.05}, space[12] = {0, 0, 0.05, 0, 0, -0.05, 0, 0, 20, 2.5, 0, 0.05};
    const double right[4] = {1, -1, 0, 0};
    double sides[4];
    OK(ko_cloud_sides(segment, plane, 4, sides));
    for (int i = 0; i < 4; i++) {
        CHECK_NEAR(sides[i], right[i], 0.15);
    }
    OK(ko_cloud_sides(sheet, space, 4, sides));
    for (int i = 0; i < 4; i++) {
        CHECK_NEAR(sides[i], right[i], 0.15);
    }
    ko_cloud_free(segment);
    ko_cloud_free(sheet);
}

/* Half of the circle or sphere. */
static ko_cloud *half(uint32_t dim) {
    double *points = dim == 2 ? check_circle_points(N_CIRCLE) : check_sphere_points(N);
    ko_cloud *cloud = NULL;
    OK(ko_cloud_from_points(dim, points, points, n_of(dim) / 2, &cloud));
    free(points);
    return cloud;
}

static ko_fit_report report_of_fit(const ko_cloud *cloud, const ko_fit_options *options, ko_field **field) {
    ko_fit_report report;
    OK(ko_field_fit(cloud, options, field));
    OK(ko_field_get_report(*field, sizeof report, &report));
    return report;
}

static void reports_tell_how_clear_sides_were(uint32_t dim) {
    ko_cloud *closed = dim == 2 ? check_circle(N_CIRCLE) : check_sphere(N), *open = half(dim);
    ko_fit_options options = check_options(16);
    ko_field *field = NULL, *loaded = NULL;
    ko_fit_report report = report_of_fit(open, &options, &field);
    CHECK(report.clear_sides > 0.1 && report.clear_sides < 0.9);
    ko_field_free(field);
    report = report_of_fit(closed, &options, &field);
    CHECK(report.clear_sides > 0.99 && report.clear_sides <= 1.0);
    CHECK(report.convergence_rate > 0.0 && report.convergence_rate < 1.0);

    /* Files do not keep these, and no distances were held here. */
    OK(ko_field_save(field, "clouds.kof"));
    OK(ko_field_load("clouds.kof", &loaded));
    CHECK(remove("clouds.kof") == 0);
    OK(ko_field_get_report(loaded, sizeof report, &report));
    CHECK(isnan(report.clear_sides) && isnan(report.convergence_rate) && report.n_points > 0);
    ko_field_free(field);
    ko_field_free(loaded);
    options.distance_weight = 0.0;
    report = report_of_fit(closed, &options, &field);
    CHECK(isnan(report.clear_sides));

    /* A caller that does not know the field yet is given none. */
    report.clear_sides = 7.0;
    OK(ko_field_get_report(field, offsetof(ko_fit_report, clear_sides), &report));
    CHECK(report.clear_sides == 7.0);
    ko_field_free(field);
    ko_cloud_free(closed);
    ko_cloud_free(open);
}

int main(void) {
    smoothing_lowers_noise(2);
    smoothing_lowers_noise(3);
    weights_stay_and_origins_go();
    closed_shapes_have_sides_everywhere();
    open_shapes_have_sides_beside_them_alone();
    reports_tell_how_clear_sides_were(2);
    reports_tell_how_clear_sides_were(3);
    return check_result();
}
