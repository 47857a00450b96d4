/* The other formulations: explicit ones of a sphere and a circle, the separation of boxes, and what they refuse. */

#include "check.h"

enum { N_CLOUD = 1500, N = 100, KINDS = 5 };

static ko_explicit *make(const ko_cloud *cloud, int32_t formulation, uint32_t n_nearest) {
    ko_explicit_options options;
    OK(ko_explicit_options_init(&options, sizeof options));
    options.formulation = formulation;
    options.n_nearest = n_nearest;
    ko_explicit *made = NULL;
    OK(ko_explicit_create(cloud, &options, &made));
    return made;
}

/* Values near |x| - 1, and gradients against differences of values, within what each formula promises. */
static void check_round(uint32_t dim) {
    const double errors[KINDS] = {0.005, 0.0005, 0.15, 0.02, 0.1};
    const size_t n_cloud = dim == 2 ? 200 : N_CLOUD;
    ko_cloud *cloud = dim == 2 ? check_circle(n_cloud) : check_sphere(n_cloud);
    double *points = check_points(N, 1.0, 11), values[N], gradients[3 * N], up[N], down[N];
    for (size_t i = 0; i < N; i++) {
        double length = 0.0, radius = 0.95 + 0.1 * (double)i / N;
        for (uint32_t a = 0; a < dim; a++) length += points[dim * i + a] * points[dim * i + a];
        for (uint32_t a = 0; a < dim; a++) points[dim * i + a] *= radius / sqrt(length);
    }
    for (int32_t kind = 0; kind < KINDS; kind++) {
        for (uint32_t n_nearest = 0; n_nearest < 2; n_nearest++) {
            ko_explicit *made = make(cloud, kind, n_nearest);
            OK(ko_explicit_eval(made, points, N, values, gradients));
            for (size_t i = 0; i < N; i++) {
                const double exact = 0.95 + 0.1 * (double)i / N - 1.0;
                if (n_nearest == 0 || kind != KO_EXPLICIT_LIN) CHECK_NEAR(values[i], exact, n_nearest == 0 ? errors[kind] : 0.1);
            }
            /* A point may lie where the nearest changes: one or two in a hundred are forgiven. */
            const double h = 1e-6;
            int wrong = 0;
            for (uint32_t a = 0; a < dim; a++) {
                for (int side = -1; side <= 1; side += 2) {
                    for (size_t i = 0; i < N; i++) points[dim * i + a] += side * h;
                    OK(ko_explicit_eval(made, points, N, side < 0 ? down : up, NULL));
                    for (size_t i = 0; i < N; i++) points[dim * i + a] -= side * h;
                }
                for (size_t i = 0; i < N; i++) {
                    wrong += !(fabs((up[i] - down[i]) / (2 * h) - gradients[dim * i + a]) < 1e-5);
                }
            }
            CHECK(wrong <= 4);
            ko_explicit_free(made);
        }
    }
    free(points);
    ko_cloud_free(cloud);
}

static void check_options_of_explicit(void) {
    ko_cloud *cloud = check_sphere(100);
    ko_explicit_options options;
    OK(ko_explicit_options_init(&options, sizeof options));
    CHECK(options.formulation == KO_EXPLICIT_HICKEN_KAUR_LINEAR && options.n_nearest == 0 && options.smoothing == 0);
    CHECK(options.feasible == KO_FEASIBLE_OUTSIDE);
    ko_explicit *made = NULL, *inside = NULL;
    OK(ko_explicit_create(cloud, NULL, &made));
    double smoothing = 0.0, value = 0.0, negative = 0.0;
    OK(ko_explicit_get_smoothing(made, &smoothing));
    CHECK(smoothing > 20.0 && smoothing < 200.0);
    options.feasible = KO_FEASIBLE_INSIDE;
    options.smoothing = smoothing;
    OK(ko_explicit_create(cloud, &options, &inside));
    const double point[3] = {0.1, -0.8, 0.7};
    OK(ko_explicit_eval(made, point, 1, &value, NULL));
    OK(ko_explicit_eval(inside, point, 1, &negative, NULL));
    CHECK(value == -negative && value > 0);
    OK(ko_explicit_eval(made, NULL, 0, NULL, NULL));
    ko_explicit_free(inside);

    const double far_[6] = {0, 0, 0, 0, NAN, 0};
    double values[2];
    FAILS(ko_explicit_eval(made, far_, 2, values, NULL), KO_ERR_INVALID_ARGUMENT, "point 1");
    FAILS(ko_explicit_eval(NULL, point, 1, &value, NULL), KO_ERR_INVALID_ARGUMENT, "formula is NULL");
    FAILS(ko_explicit_eval(made, NULL, 1, &value, NULL), KO_ERR_INVALID_ARGUMENT, "points");
    FAILS(ko_explicit_get_smoothing(made, NULL), KO_ERR_INVALID_ARGUMENT, "smoothing");
    ko_explicit_free(made);
    FAILS(ko_explicit_options_init(NULL, sizeof options), KO_ERR_INVALID_ARGUMENT, "options");
    made = STALE(ko_explicit);
    FAILS(ko_explicit_create(NULL, NULL, &made), KO_ERR_INVALID_ARGUMENT, "cloud is NULL");
    CHECK(made == NULL);
    options.formulation = 5;
    FAILS(ko_explicit_create(cloud, &options, &made), KO_ERR_INVALID_ARGUMENT, "formulation is 5");
    options.formulation = KO_EXPLICIT_NEAREST_PLANE;
    options.n_nearest = 2;
    FAILS(ko_explicit_create(cloud, &options, &made), KO_ERR_INVALID_ARGUMENT, "n_nearest is 2");
    options.formulation = KO_EXPLICIT_LIN;
    options.exponent = 33;
    FAILS(ko_explicit_create(cloud, &options, &made), KO_ERR_INVALID_ARGUMENT, "exponent is 33");
    ko_explicit_free(NULL);
    ko_cloud_free(cloud);
}

static void check_separation(void) {
    ko_mesh *a = check_cube(), *b = check_cube(), *plane = check_frame();
    ko_separation found;
    double by_distance[24], by_length[24];
    const double apart[3] = {5, 0.5, 6}, through[3] = {1.5, 1.25, 0.5};
    OK(ko_meshes_separation(a, b, apart, 0, 8, sizeof found, &found, by_distance, by_length));
    CHECK(found.struct_size == sizeof found);
    CHECK_NEAR(found.minimum_distance, 5.0, 1e-14);
    CHECK(found.intersection_length == 0 && !found.b_in_a && !found.a_in_b);
    double sum[3] = {0, 0, 0};
    for (int i = 0; i < 24; i++) {
        sum[i % 3] += by_distance[i];
        CHECK(by_length[i] == 0);
    }
    for (int k = 0; k < 3; k++) {
        CHECK_NEAR(sum[k], found.distance_by_translation[k], 1e-15);
    }
    CHECK_NEAR(sum[0], 0.6, 1e-15);
    CHECK_NEAR(sum[2], 0.8, 1e-15);
    ko_separation soft;
    OK(ko_meshes_separation(a, b, apart, 1000, 0, sizeof soft, &soft, NULL, NULL));
    CHECK(soft.minimum_distance <= found.minimum_distance && soft.minimum_distance > found.minimum_distance - 0.02);

    /* The cubes share the box [0.5, 1] x [0.25, 1] x [-0.5, 1]: on its boundary the surfaces cross along edges of both faces. */
    OK(ko_meshes_separation(a, b, through, 0, 8, sizeof found, &found, NULL, by_length));
    CHECK(found.minimum_distance == 0);
    CHECK_NEAR(found.intersection_length, 2 * (0.5 + 0.75 + 1.5), 1e-12);
    for (int k = 0; k < 3; k++) {
        CHECK_NEAR(found.length_by_translation[k], -2.0, 1e-12);
    }

    OK(ko_meshes_separation(a, b, NULL, 0, 0, 0, NULL, NULL, NULL));
    const double nan_[3] = {0, NAN, 0};
    FAILS(ko_meshes_separation(NULL, b, NULL, 0, 0, sizeof found, &found, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "mesh_a");
    FAILS(ko_meshes_separation(a, plane, NULL, 0, 0, sizeof found, &found, NULL, NULL), KO_ERR_UNSUPPORTED, "mesh_b");
    FAILS(ko_meshes_separation(a, b, nan_, 0, 0, sizeof found, &found, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "translation");
    FAILS(ko_meshes_separation(a, b, NULL, 0.5, 0, sizeof found, &found, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "sharpness");
    FAILS(ko_meshes_separation(a, b, NULL, 0, 7, sizeof found, &found, by_distance, NULL), KO_ERR_INVALID_ARGUMENT, "n_vertices");
    FAILS(ko_meshes_separation(a, b, NULL, 0, 0, 4, &found, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "struct_size 4");
    ko_mesh_free(a);
    ko_mesh_free(b);
    ko_mesh_free(plane);

    /* A small cube inside a large one. */
    double small[24];
    for (int i = 0; i < 24; i++) small[i] = 0.25 * check_cube_vertices[i];
    ko_mesh *large = check_cube(), *inner = NULL;
    OK(ko_mesh_from_triangles(small, 8, check_cube_triangles, 12, &inner));
    OK(ko_meshes_separation(large, inner, NULL, 0, 0, sizeof found, &found, NULL, NULL));
    CHECK(found.b_in_a == 1 && found.a_in_b == 0 && found.intersection_length == 0);
    CHECK_NEAR(found.minimum_distance, 0.75, 1e-15);
    OK(ko_meshes_separation(inner, large, NULL, 0, 0, sizeof found, &found, NULL, NULL));
    CHECK(found.b_in_a == 0 && found.a_in_b == 1);
    ko_mesh_free(large);
    ko_mesh_free(inner);
}

int main(void) {
    check_round(2);
    check_round(3);
    check_options_of_explicit();
    check_separation();
    return check_result();
}
