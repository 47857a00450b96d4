/* Constraints: aggregates, bodies, frames of each kind, points; values against the field's own, derivatives against differences. */

#include "check.h"

static const int32_t smooth_kinds[3] = {KO_AGGREGATE_KS, KO_AGGREGATE_INDUCED_EXPONENTIAL, KO_AGGREGATE_P_NORM};

/* ---- aggregates of numbers ---- */

/* Derivatives of an aggregate against central differences, and its value against the least, or largest, of the numbers. */
static void check_aggregate(const ko_aggregation *aggregation, int32_t extreme, double *numbers, size_t n) {
    enum { MOST = 10 };
    const double unit = 1.5, step = 1e-5;
    double value, gradient[MOST], hessian[MOST * (MOST + 1) / 2], alone, below, above;
    OK(ko_aggregate(aggregation, extreme, unit, numbers, n, &value, gradient, hessian));
    OK(ko_aggregate(aggregation, extreme, unit, numbers, n, &alone, NULL, NULL));
    CHECK(alone == value);
    double end = numbers[0], sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        end = extreme == KO_LEAST ? fmin(end, numbers[i]) : fmax(end, numbers[i]);
        sum += gradient[i];
    }
    if (aggregation == NULL || aggregation->kind != KO_AGGREGATE_P_NORM) {
        CHECK_NEAR(sum, 1.0, 1e-13);
    }
    if (extreme == KO_LEAST) {
        OK(ko_aggregation_bounds(aggregation, n, end / unit, &below, &above));
        CHECK(value >= end - unit * below - 1e-13 && value <= end + unit * above + 1e-13);
        CHECK((below == 0.0 || above == 0.0) && (below > 0.0 || above > 0.0 || n == 1));
    }
    int32_t side = aggregation == NULL ? KO_BELOW : aggregation->side;
    CHECK(side == KO_BELOW ? value <= end + 1e-13 : value >= end - 1e-13);
    for (size_t i = 0; i < n; i++) {
        double at = numbers[i], values[2], gradients[2][MOST];
        for (int k = 0; k < 2; k++) {
            numbers[i] = at + (k == 0 ? -step : step);
            OK(ko_aggregate(aggregation, extreme, unit, numbers, n, &values[k], gradients[k], NULL));
        }
        numbers[i] = at;
        CHECK_NEAR((values[1] - values[0]) / (2.0 * step), gradient[i], 1e-7);
        for (size_t j = 0; j < n; j++) {
            size_t row = i > j ? i : j, column = i > j ? j : i;
            double right = hessian[row * (row + 1) / 2 + column];
            CHECK_NEAR((gradients[1][j] - gradients[0][j]) / (2.0 * step), right, 1e-6 * fmax(1.0, fabs(right)));
        }
    }
}

static void numbers_are_aggregated(void) {
    double numbers[10] = {0.3, 0.1, 0.7, 0.12, -0.2, 0.4, -0.17, 0.9, 0.0, 0.11};
    for (int32_t extreme = KO_LEAST; extreme <= KO_LARGEST; extreme++) {
        for (int k = 0; k < 3; k++) {
            ko_aggregation aggregation = check_aggregation(smooth_kinds[k]);
            for (aggregation.side = KO_BELOW; aggregation.side <= KO_ABOVE; aggregation.side++) {
                check_aggregate(&aggregation, extreme, numbers, 10);
                check_aggregate(&aggregation, extreme, numbers, 1);
            }
        }
        double value = 0.0, gradient[10];
        ko_aggregation minimum = check_aggregation(KO_AGGREGATE_MINIMUM);
        OK(ko_aggregate(&minimum, extreme, 1.0, numbers, 10, &value, gradient, NULL));
        int at = extreme == KO_LEAST ? 4 : 7;
        CHECK(value == numbers[at]);
        for (int i = 0; i < 10; i++) {
            CHECK(gradient[i] == (i == at ? 1.0 : 0.0));
        }
    }
    /* NULL is KS from below with rho = 500. */
    ko_aggregation defaults;
    OK(ko_aggregation_init(&defaults, sizeof defaults));
    CHECK(defaults.struct_size == sizeof defaults && defaults.sharpness == 500.0);
    CHECK(defaults.kind == KO_AGGREGATE_KS && defaults.side == KO_BELOW);
    double one = 0.0, other = 1.0, sum = 0.0, below = -1.0;
    OK(ko_aggregate(NULL, KO_LEAST, 2.0, numbers, 10, &one, NULL, NULL));
    OK(ko_aggregate(&defaults, KO_LEAST, 2.0, numbers, 10, &other, NULL, NULL));
    for (int i = 0; i < 10; i++) {
        sum += exp(-500.0 * (numbers[i] - numbers[4]) / 2.0);
    }
    CHECK(one == other);
    CHECK_NEAR(one, numbers[4] - 2.0 * log(sum) / 500.0, 1e-15);
    OK(ko_aggregation_bounds(NULL, 10000, 0.0, &below, NULL));
    CHECK_NEAR(below, log(10000.0) / 500.0, 1e-15);
    OK(ko_aggregation_bounds(NULL, 10000, 0.0, NULL, NULL));
}

/* ---- bodies ---- */

static void bodies_are_points(void) {
    double *points = check_points(50, 1.0, 3);
    for (uint32_t dim = 2; dim <= 3; dim++) {
        ko_body *body = NULL;
        OK(ko_body_from_points(dim, points, 50, 0.25, &body));
        uint32_t found_dim = 0;
        size_t n = 0;
        double radius = -1.0, copy[150];
        OK(ko_body_get_dim(body, &found_dim));
        OK(ko_body_get_size(body, &n));
        OK(ko_body_get_covering_radius(body, &radius));
        OK(ko_body_copy_points(body, 50, copy));
        CHECK(found_dim == dim && n == 50 && radius == 0.25);
        CHECK(memcmp(copy, points, dim * 50 * sizeof *points) == 0);
        ko_body_free(body);
    }
    free(points);
    ko_body_free(NULL);
}

/* Points on the cube and on the frame, the mesh gone: its vertices among them, all on its surface, none of that far from all of them. */
static void bodies_cover_meshes(void) {
    const double radius = 0.2;
    for (uint32_t dim = 2; dim <= 3; dim++) {
        ko_mesh *mesh = dim == 2 ? check_frame() : check_cube();
        ko_cloud *cloud = NULL;
        ko_body *body = NULL, *coarse = NULL;
        OK(ko_body_from_mesh(mesh, radius, &body));
        OK(ko_body_from_mesh(mesh, 100.0, &coarse));
        OK(ko_mesh_sample(mesh, 300, 1, &cloud));
        size_t n = 0, n_coarse = 0;
        double found_radius = 0.0;
        OK(ko_body_get_size(coarse, &n_coarse));
        CHECK(n_coarse == 8);
        OK(ko_body_get_size(body, &n));
        OK(ko_body_get_covering_radius(body, &found_radius));
        CHECK(n > 24 && n < 2000 && found_radius == radius);
        double *points = malloc(dim * n * sizeof *points), *distances = malloc(n * sizeof *distances), samples[900];
        OK(ko_body_copy_points(body, n, points));
        OK(ko_mesh_signed_distance(mesh, points, n, distances));
        OK(ko_cloud_copy(cloud, 300, samples, NULL));
        ko_mesh_free(mesh);
        for (size_t i = 0; i < n; i++) {
            CHECK_NEAR(distances[i], 0.0, 1e-14);
        }
        double farthest = 0.0;
        for (int s = 0; s < 300; s++) {
            double nearest = INFINITY;
            for (size_t i = 0; i < n; i++) {
                double square = 0.0;
                for (uint32_t a = 0; a < dim; a++) {
                    square += pow(points[dim * i + a] - samples[dim * (size_t)s + a], 2.0);
                }
                nearest = fmin(nearest, sqrt(square));
            }
            farthest = fmax(farthest, nearest);
        }
        CHECK(farthest <= radius);
        free(points);
        free(distances);
        ko_cloud_free(cloud);
        ko_body_free(body);
        ko_body_free(coarse);
    }
}

/* ---- what every set of constraints promises ---- */

static double *numbers(size_t n) { return calloc(n + 1, sizeof(double)); }

static void places_are_distinct(const int32_t *rows, const int32_t *columns, size_t n, size_t n_rows, size_t n_columns) {
    uint8_t *seen = calloc(n_rows * n_columns + 1, 1);
    for (size_t k = 0; k < n; k++) {
        CHECK(rows[k] >= 0 && (size_t)rows[k] < n_rows && columns[k] >= 0 && (size_t)columns[k] < n_columns);
        size_t at = (size_t)rows[k] * n_columns + (size_t)columns[k];
        CHECK(at < n_rows * n_columns && seen[at]++ == 0);
    }
    free(seen);
}

/* The Jacobian in all its forms: dense = sparse, products, and central differences of the values. */
static void check_jacobian(const ko_constraints *set, double *x, double tolerance) {
    size_t n = 0, m = 0, n_jacobian = 0;
    OK(ko_constraints_get_size(set, &n, &m, &n_jacobian, NULL));
    double *values = numbers(m), *both = numbers(m), *entries = numbers(n_jacobian), *with_values = numbers(n_jacobian);
    double *dense = numbers(m * n), *scattered = numbers(m * n), *v = check_points(n, 1.0, 1), *w = check_points(m, 1.0, 2);
    double *jv = numbers(m), *jtw = numbers(n), *before = numbers(m), *behind = numbers(m);
    int32_t *rows = calloc(n_jacobian + 1, sizeof *rows), *columns = calloc(n_jacobian + 1, sizeof *columns);
    OK(ko_constraints_values(set, x, n, m, values));
    OK(ko_constraints_jacobian_pattern(set, n_jacobian, rows, columns));
    places_are_distinct(rows, columns, n_jacobian, m, n);
    OK(ko_constraints_jacobian(set, x, n, n_jacobian, entries));
    OK(ko_constraints_values_and_jacobian(set, x, n, m, both, n_jacobian, with_values));
    CHECK(memcmp(entries, with_values, n_jacobian * sizeof *entries) == 0);
    memset(dense, 0xff, m * n * sizeof *dense);
    OK(ko_constraints_dense_jacobian(set, x, n, m, dense));
    OK(ko_constraints_jacobian_times(set, x, v, n, m, jv));
    OK(ko_constraints_transposed_jacobian_times(set, x, n, w, m, jtw));
    for (size_t k = 0; k < n_jacobian; k++) {
        scattered[(size_t)rows[k] * n + (size_t)columns[k]] = entries[k];
    }
    for (size_t k = 0; k < m * n; k++) {
        CHECK(dense[k] == scattered[k]);
    }
    for (size_t i = 0; i < m; i++) {
        CHECK_NEAR(both[i], values[i], 1e-13);
        double right = 0.0;
        for (size_t j = 0; j < n; j++) {
            right += dense[i * n + j] * v[j];
        }
        CHECK_NEAR(jv[i], right, 1e-13);
    }
    for (size_t j = 0; j < n; j++) {
        double right = 0.0, at = x[j];
        const double step = 1e-5;
        for (size_t i = 0; i < m; i++) {
            right += dense[i * n + j] * w[i];
        }
        CHECK_NEAR(jtw[j], right, 1e-13);
        x[j] = at - step;
        OK(ko_constraints_values(set, x, n, m, before));
        x[j] = at + step;
        OK(ko_constraints_values(set, x, n, m, behind));
        x[j] = at;
        for (size_t i = 0; i < m; i++) {
            CHECK_NEAR((behind[i] - before[i]) / (2.0 * step), dense[i * n + j], tolerance);
        }
    }
    free(values), free(both), free(entries), free(with_values), free(dense), free(scattered), free(v), free(w);
    free(jv), free(jtw), free(before), free(behind), free(rows), free(columns);
}

/* The Hessian against central differences of J^T lambda; what its pattern leaves out must be 0. Third derivatives jump at the faces of cells,
 * by which a difference across one may be off. */
static void check_hessian(const ko_constraints *set, double *x, double tolerance) {
    size_t n = 0, m = 0, n_hessian = 0;
    OK(ko_constraints_get_size(set, &n, &m, NULL, &n_hessian));
    double *lambda = check_points(m, 1.0, 5), *entries = numbers(n_hessian), *whole = numbers(n * n);
    double *before = numbers(n), *behind = numbers(n);
    int32_t *rows = calloc(n_hessian + 1, sizeof *rows), *columns = calloc(n_hessian + 1, sizeof *columns);
    OK(ko_constraints_hessian_pattern(set, n_hessian, rows, columns));
    places_are_distinct(rows, columns, n_hessian, n, n);
    memset(entries, 0xff, n_hessian * sizeof *entries);
    OK(ko_constraints_hessian(set, x, n, lambda, m, n_hessian, entries));
    for (size_t k = 0; k < n_hessian; k++) {
        CHECK(columns[k] <= rows[k]);
        whole[(size_t)rows[k] * n + (size_t)columns[k]] = whole[(size_t)columns[k] * n + (size_t)rows[k]] = entries[k];
    }
    for (size_t j = 0; j < n; j++) {
        const double at = x[j], step = 1e-5;
        x[j] = at - step;
        OK(ko_constraints_transposed_jacobian_times(set, x, n, lambda, m, before));
        x[j] = at + step;
        OK(ko_constraints_transposed_jacobian_times(set, x, n, lambda, m, behind));
        x[j] = at;
        for (size_t i = 0; i < n; i++) {
            double right = whole[i * n + j];
            CHECK_NEAR((behind[i] - before[i]) / (2.0 * step), right, tolerance * fmax(1.0, fabs(right)));
        }
    }
    free(lambda), free(entries), free(whole), free(before), free(behind), free(rows), free(columns);
}

/* ---- frames ---- */

/* What a rotation's parameters and a scale make of a frame: a point of it is at s R p + t. */
struct pose {
    int32_t rotation, scale;
    size_t n;
    double parameters[8], r[3][3], t[3], s;
};

/* A pose of this kind with numbers of `seed`, and its matrix, written down another way than the library's. */
static struct pose make_pose(uint32_t dim, int32_t rotation, int32_t scale, uint64_t seed) {
    struct pose pose = {rotation, scale, 0, {0}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0}, 1.0};
    for (uint32_t a = 0; a < dim; a++) {
        pose.parameters[pose.n++] = pose.t[a] = 0.4 * (2.0 * check_random(&seed) - 1.0);
    }
    double axis[3] = {0, 0, 1}, angle = 0.0;
    const size_t of_rotation[4] = {0, 4, 3, 1};
    for (size_t k = 0; k < of_rotation[rotation]; k++) {
        pose.parameters[pose.n++] = 0.2 + check_random(&seed);
    }
    const double *q = pose.parameters + dim;
    if (rotation == KO_ROTATION_QUATERNION) {
        double length = sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        angle = 2.0 * atan2(length, q[0]);
        for (int a = 0; a < 3; a++) {
            axis[a] = q[1 + a] / length;
        }
    } else if (rotation == KO_ROTATION_VECTOR) {
        angle = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
        for (int a = 0; a < 3; a++) {
            axis[a] = q[a] / angle;
        }
    } else if (rotation == KO_ROTATION_ANGLE) {
        angle = q[0];
    }
    /* Column k is where the unit vector e turns to: its part along the axis stays, the rest goes around. */
    for (int k = 0; k < 3; k++) {
        double e[3] = {k == 0, k == 1, k == 2};
        double cross[3] = {axis[1] * e[2] - axis[2] * e[1], axis[2] * e[0] - axis[0] * e[2], axis[0] * e[1] - axis[1] * e[0]};
        for (int a = 0; a < 3; a++) {
            double along = axis[k] * axis[a];
            pose.r[a][k] = along + cos(angle) * (e[a] - along) + sin(angle) * cross[a];
        }
    }
    if (scale == KO_SCALE_FREE) {
        pose.parameters[pose.n++] = pose.s = 0.7 + 0.6 * check_random(&seed);
    }
    return pose;
}

static void to_world(const struct pose *pose, uint32_t dim, const double *p, double *world) {
    for (uint32_t a = 0; a < dim; a++) {
        world[a] = pose->t[a];
        for (uint32_t b = 0; b < dim; b++) {
            world[a] += pose->s * pose->r[a][b] * p[b];
        }
    }
}

static void from_world(const struct pose *pose, uint32_t dim, const double *world, double *p) {
    for (uint32_t a = 0; a < dim; a++) {
        p[a] = 0.0;
        for (uint32_t b = 0; b < dim; b++) {
            p[a] += pose->r[b][a] * (world[b] - pose->t[b]) / pose->s;
        }
    }
}

/* Rotations that a dimension has: none, quaternion, vector; none, angle. */
static int32_t rotation_of(uint32_t dim, int k) { return dim == 3 ? k : 3 * k; }

/* Each kind of frame for the body against each for the field, moving or fixed: values are s phi of the points put there by hand. */
static void frames_move_as_they_say(uint32_t dim) {
    enum { N = 7 };
    ko_field *field = check_made_field(dim);
    ko_body *body = check_body(dim, N, 9);
    double points[3 * N];
    OK(ko_body_copy_points(body, N, points));
    ko_aggregation each = check_aggregation(KO_AGGREGATE_NONE), ks = check_aggregation(KO_AGGREGATE_KS);
    int kinds = dim == 3 ? 6 : 4;
    for (int k = 0; k < kinds * kinds; k++) {
        struct pose pose = make_pose(dim, rotation_of(dim, k % kinds / 2), k % kinds % 2, 10 + (uint64_t)k);
        struct pose other = make_pose(dim, rotation_of(dim, k / kinds / 2), k / kinds % 2, 90 + (uint64_t)k);
        ko_constraints *set = NULL;
        uint32_t frame = 77, field_frame = 77, still = 77;
        size_t first = 77, n = 0, m = 0, at = 77, of_frame = 77;
        OK(ko_constraints_create(dim, &set));
        OK(ko_constraints_add_frame(set, pose.rotation, pose.scale, &frame));
        OK(ko_constraints_add_frame(set, other.rotation, other.scale, &field_frame));
        OK(ko_constraints_add_fixed_frame(set, other.rotation, other.scale, other.parameters, other.n, &still));
        CHECK(frame == 1 && field_frame == 2 && still == 3);
        OK(ko_constraints_get_frame_variables(set, frame, &at, &of_frame));
        CHECK(at == 0 && of_frame == pose.n);
        OK(ko_constraints_get_frame_variables(set, field_frame, &at, &of_frame));
        CHECK(at == pose.n && of_frame == other.n);
        OK(ko_constraints_get_frame_variables(set, still, &at, &of_frame));
        CHECK(of_frame == 0);
        OK(ko_constraints_get_frame_variables(set, KO_WORLD, &at, &of_frame));
        CHECK(of_frame == 0);

        OK(ko_constraints_keep_body(set, body, frame, field, field_frame, &each, &first));
        CHECK(first == 0);
        OK(ko_constraints_keep_body(set, body, frame, field, still, &each, &first));
        CHECK(first == N);
        OK(ko_constraints_keep_body(set, body, still, field, field_frame, &ks, NULL));
        OK(ko_constraints_keep_body(set, body, frame, field, KO_WORLD, &ks, &first));
        CHECK(first == 2 * N + 1);
        OK(ko_constraints_get_size(set, &n, &m, NULL, NULL));
        CHECK(n == pose.n + other.n && m == 2 * N + 2);

        double x[16], values[2 * N + 2], right[N], z[3 * N];
        memcpy(x, pose.parameters, pose.n * sizeof *x);
        memcpy(x + pose.n, other.parameters, other.n * sizeof *x);
        OK(ko_constraints_values(set, x, n, m, values));
        for (int i = 0; i < N; i++) {
            double world[3];
            to_world(&pose, dim, points + dim * (uint32_t)i, world);
            from_world(&other, dim, world, z + dim * (uint32_t)i);
        }
        OK(ko_field_eval(field, z, N, right, NULL, NULL));
        for (int i = 0; i < N; i++) {
            CHECK_NEAR(values[i], other.s * right[i], 1e-13);
            CHECK_NEAR(values[N + i], other.s * right[i], 1e-13);
        }
        check_jacobian(set, x, 1e-7);
        check_hessian(set, x, 1e-4);
        ko_constraints_free(set);
    }
    ko_body_free(body);
    ko_field_free(field);
}

/* ---- aggregates of samples ---- */

/* Of bodies of more than one block: the aggregate is that of the single values, with the field's D for unit. */
static void samples_are_aggregated(uint32_t dim) {
    enum { N = 700 };
    ko_field *field = check_made_field(dim);
    ko_body *body = check_body(dim, N, 4);
    ko_fit_report report;
    OK(ko_field_get_report(field, sizeof report, &report));
    ko_aggregation each = check_aggregation(KO_AGGREGATE_NONE);
    ko_constraints *set = NULL;
    uint32_t frame = 0;
    OK(ko_constraints_create(dim, &set));
    OK(ko_constraints_add_frame(set, dim == 3 ? KO_ROTATION_QUATERNION : KO_ROTATION_ANGLE, KO_SCALE_FREE, &frame));
    struct pose pose = make_pose(dim, dim == 3 ? KO_ROTATION_QUATERNION : KO_ROTATION_ANGLE, KO_SCALE_FREE, 3);
    OK(ko_constraints_keep_body(set, body, frame, field, KO_WORLD, &each, NULL));
    for (int k = 0; k < 8; k++) {
        ko_aggregation aggregation = check_aggregation(k < 6 ? smooth_kinds[k / 2] : KO_AGGREGATE_MINIMUM);
        aggregation.side = k % 2;
        OK(ko_constraints_keep_body(set, body, frame, field, KO_WORLD, &aggregation, NULL));
    }
    double values[N + 8], value = 0.0;
    OK(ko_constraints_values(set, pose.parameters, pose.n, N + 8, values));
    for (int k = 0; k < 8; k++) {
        ko_aggregation aggregation = check_aggregation(k < 6 ? smooth_kinds[k / 2] : KO_AGGREGATE_MINIMUM);
        aggregation.side = k % 2;
        OK(ko_aggregate(&aggregation, KO_LEAST, report.diagonal, values, N, &value, NULL, NULL));
        CHECK_NEAR(values[N + k], value, 1e-12);
    }
    check_jacobian(set, pose.parameters, 1e-6);
    ko_constraints_free(set);

    /* The minimum has no Hessian; the others have theirs. */
    OK(ko_constraints_create(dim, &set));
    OK(ko_constraints_add_frame(set, pose.rotation, pose.scale, &frame));
    for (int k = 0; k < 6; k++) {
        ko_aggregation aggregation = check_aggregation(smooth_kinds[k / 2]);
        aggregation.side = k % 2;
        OK(ko_constraints_keep_body(set, body, frame, field, KO_WORLD, &aggregation, NULL));
    }
    check_hessian(set, pose.parameters, 1e-4);
    ko_aggregation minimum = check_aggregation(KO_AGGREGATE_MINIMUM);
    OK(ko_constraints_keep_body(set, body, frame, field, KO_WORLD, &minimum, NULL));
    size_t n_hessian = 0;
    OK(ko_constraints_get_size(set, NULL, NULL, NULL, &n_hessian));
    double lambda[7] = {1, 1, 1, 1, 1, 1, 1}, entries[36];
    CHECK(n_hessian == pose.n * (pose.n + 1) / 2);
    FAILS(ko_constraints_hessian(set, pose.parameters, pose.n, lambda, 7, n_hessian, entries), KO_ERR_UNSUPPORTED,
          "6 is a minimum, which is not smooth and has no Hessian");
    lambda[6] = 0.0;
    OK(ko_constraints_hessian(set, pose.parameters, pose.n, lambda, 7, n_hessian, entries));
    ko_constraints_free(set);
    ko_body_free(body);
    ko_field_free(field);
}

/* ---- points that are variables ---- */

static void points_are_variables(uint32_t dim) {
    enum { N = 9 };
    ko_field *field = check_made_field(dim);
    ko_constraints *set = NULL;
    uint32_t frame = 77, path = 77, other = 77, still = 77;
    struct pose pose = make_pose(dim, dim == 3 ? KO_ROTATION_VECTOR : KO_ROTATION_ANGLE, KO_SCALE_FREE, 5);
    ko_aggregation each = check_aggregation(KO_AGGREGATE_NONE);
    OK(ko_constraints_create(dim, &set));
    OK(ko_constraints_add_points(set, N, &path));
    OK(ko_constraints_add_frame(set, pose.rotation, pose.scale, &frame));
    OK(ko_constraints_add_points(set, 2, &other));
    OK(ko_constraints_add_fixed_frame(set, pose.rotation, pose.scale, pose.parameters, pose.n, &still));
    CHECK(path == 0 && other == 1 && frame == 1 && still == 2);
    size_t first = 77, at = 77, n_points = 77, n = 0, m = 0;
    OK(ko_constraints_get_points_variables(set, path, &at, &n_points));
    CHECK(at == 0 && n_points == dim * N);
    OK(ko_constraints_get_points_variables(set, other, &at, &n_points));
    CHECK(at == dim * N + pose.n && n_points == 2 * dim);

    OK(ko_constraints_keep_points(set, path, field, KO_WORLD, &each, &first));
    CHECK(first == 0);
    OK(ko_constraints_keep_points(set, path, field, frame, &each, &first));
    CHECK(first == N);
    for (int k = 0; k < 3; k++) {
        ko_aggregation aggregation = check_aggregation(smooth_kinds[k]);
        OK(ko_constraints_keep_points(set, path, field, frame, &aggregation, &first));
        CHECK(first == 2 * N + (size_t)k);
    }
    OK(ko_constraints_keep_points(set, other, field, still, NULL, NULL));
    OK(ko_constraints_get_size(set, &n, &m, NULL, NULL));
    CHECK(n == dim * (N + 2) + pose.n && m == 2 * N + 4);

    double *x = check_points(n, 0.5, 8), values[2 * N + 4], right[N], z[3 * N];
    memcpy(x + dim * N, pose.parameters, pose.n * sizeof *x);
    OK(ko_constraints_values(set, x, n, m, values));
    OK(ko_field_eval(field, x, N, right, NULL, NULL));
    for (int i = 0; i < N; i++) {
        CHECK_NEAR(values[i], right[i], 1e-14);
        from_world(&pose, dim, x + dim * (uint32_t)i, z + dim * (uint32_t)i);
    }
    OK(ko_field_eval(field, z, N, right, NULL, NULL));
    for (int i = 0; i < N; i++) {
        CHECK_NEAR(values[N + i], pose.s * right[i], 1e-13);
    }
    check_jacobian(set, x, 1e-6);
    check_hessian(set, x, 1e-4);
    free(x);
    ko_constraints_free(set);
    ko_field_free(field);
}

/* ---- set operations of fields ---- */

/* Sample by sample phi is the aggregate of the fields' phi, in units of the largest D; all derivatives follow. */
static void fields_are_combined(uint32_t dim) {
    enum { N = 300, EACH = 8 };
    const ko_field *fields[3] = {check_made_field(dim), dim == 2 ? check_circle_field(9) : check_sphere_field(9), NULL};
    const uint32_t counts[3] = {8, 8, 8};
    const double low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
    double *control_points = check_points(512, 0.5, 11);
    ko_field *third = NULL;
    OK(ko_field_from_control_points(dim, counts, low, high, KO_FEASIBLE_OUTSIDE, 7.0, control_points, dim == 2 ? 64 : 512, &third));
    fields[2] = third;
    ko_body *body = check_body(dim, N, 4);
    ko_aggregation each = check_aggregation(KO_AGGREGATE_NONE), ks = check_aggregation(KO_AGGREGATE_KS);
    double points[3 * N], phi[3][N], *values = numbers(EACH * N);
    OK(ko_body_copy_points(body, N, points));
    for (int f = 0; f < 3; f++) {
        OK(ko_field_eval(fields[f], points, N, phi[f], NULL, NULL));
    }
    for (int32_t extreme = KO_LEAST; extreme <= KO_LARGEST; extreme++) {
        ko_constraints *set = NULL;
        size_t first = 77;
        OK(ko_constraints_create(dim, &set));
        for (size_t k = 0; k < EACH; k++) {
            ko_aggregation combination = check_aggregation(k < 6 ? smooth_kinds[k / 2] : KO_AGGREGATE_MINIMUM);
            combination.side = k % 2;
            OK(ko_constraints_keep_body_in_fields(set, body, KO_WORLD, fields, 3, extreme, &combination, KO_WORLD, &each, &first));
            CHECK(first == k * N);
        }
        OK(ko_constraints_values(set, NULL, 0, EACH * N, values));
        for (size_t k = 0; k < EACH; k++) {
            ko_aggregation combination = check_aggregation(k < 6 ? smooth_kinds[k / 2] : KO_AGGREGATE_MINIMUM);
            combination.side = k % 2;
            for (size_t i = 0; i < N; i++) {
                double at[3] = {phi[0][i], phi[1][i], phi[2][i]}, right = 0.0, value = values[k * N + i];
                OK(ko_aggregate(&combination, extreme, 7.0, at, 3, &right, NULL, NULL));
                CHECK_NEAR(value, right, 1e-13);
                double end = extreme == KO_LEAST ? fmin(at[0], fmin(at[1], at[2])) : fmax(at[0], fmax(at[1], at[2]));
                CHECK(k % 2 == 0 ? value <= end + 1e-13 : value >= end - 1e-13);
                CHECK(k < 6 || value == end);
            }
        }
        ko_constraints_free(set);

        /* Of bodies and points that move, aggregated and not, in a frame that moves; NULL is KS, one field is itself. */
        uint32_t frame = 0, other = 0, path = 0;
        struct pose pose = make_pose(dim, dim == 3 ? KO_ROTATION_QUATERNION : KO_ROTATION_ANGLE, KO_SCALE_FREE, 3);
        OK(ko_constraints_create(dim, &set));
        OK(ko_constraints_add_frame(set, pose.rotation, pose.scale, &frame));
        OK(ko_constraints_add_frame(set, KO_ROTATION_NONE, KO_SCALE_FREE, &other));
        OK(ko_constraints_add_points(set, 4, &path));
        for (int k = 0; k < 3; k++) {
            ko_aggregation combination = check_aggregation(smooth_kinds[k]);
            OK(ko_constraints_keep_body_in_fields(set, body, frame, fields, 3, extreme, &combination, other, &ks, NULL));
            OK(ko_constraints_keep_points_in_fields(set, path, fields, 3, extreme, &combination, other, &each, NULL));
            OK(ko_constraints_keep_points_in_fields(set, path, fields, 2, extreme, &combination, KO_WORLD, &ks, NULL));
        }
        OK(ko_constraints_keep_body_in_fields(set, body, frame, fields, 2, extreme, NULL, KO_WORLD, NULL, NULL));
        OK(ko_constraints_keep_points_in_fields(set, path, fields, 1, extreme, NULL, KO_WORLD, &each, &first));
        OK(ko_constraints_keep_points(set, path, fields[0], KO_WORLD, &each, NULL));
        size_t n = 0, m = 0;
        OK(ko_constraints_get_size(set, &n, &m, NULL, NULL));
        CHECK(n == pose.n + dim + 1 + 4 * dim && m == first + 8 && m == 3 * 6 + 1 + 8);
        double *x = check_points(n, 0.5, 8);
        memcpy(x, pose.parameters, pose.n * sizeof *x);
        x[pose.n + dim] = 0.9;
        OK(ko_constraints_values(set, x, n, m, values));
        CHECK(memcmp(values + first, values + first + 4, 4 * sizeof *values) == 0);
        check_jacobian(set, x, 1e-6);
        check_hessian(set, x, 1e-4);
        free(x);
        ko_constraints_free(set);
    }
    for (int f = 0; f < 3; f++) {
        ko_field_free((ko_field *)fields[f]);
    }
    ko_body_free(body);
    free(control_points);
    free(values);
}

/* The least and the largest themselves have a Jacobian, and no Hessian. */
static void hard_combinations_are_not_smooth(void) {
    ko_field *field = check_made_field(3), *ball = check_sphere_field(8);
    const ko_field *fields[2] = {field, ball};
    ko_aggregation minimum = check_aggregation(KO_AGGREGATE_MINIMUM);
    ko_constraints *set = NULL;
    uint32_t path = 0;
    OK(ko_constraints_create(3, &set));
    OK(ko_constraints_add_points(set, 2, &path));
    OK(ko_constraints_keep_points_in_fields(set, path, fields, 2, KO_LARGEST, &minimum, KO_WORLD, NULL, NULL));
    double x[6] = {0.1, 0.2, 0.3, 0.9, 0.8, 0.7}, lambda = 1.0, hessian[21];
    check_jacobian(set, x, 1e-6);
    FAILS(ko_constraints_hessian(set, x, 6, &lambda, 1, 21, hessian), KO_ERR_UNSUPPORTED,
          "the fields of value 0 are combined by a minimum");
    lambda = 0.0;
    OK(ko_constraints_hessian(set, x, 6, &lambda, 1, 21, hessian));
    ko_constraints_free(set);
    ko_field_free(field);
    ko_field_free(ball);
}

/* A path of single points has a small block a point, and no more. */
static void single_points_are_sparse(void) {
    enum { N = 1000 };
    ko_field *field = check_made_field(3);
    ko_constraints *set = NULL;
    uint32_t path = 0;
    ko_aggregation each = check_aggregation(KO_AGGREGATE_NONE);
    OK(ko_constraints_create(3, &set));
    OK(ko_constraints_add_points(set, N, &path));
    OK(ko_constraints_keep_points(set, path, field, KO_WORLD, &each, NULL));
    size_t n = 0, m = 0, n_jacobian = 0, n_hessian = 0;
    OK(ko_constraints_get_size(set, &n, &m, &n_jacobian, &n_hessian));
    CHECK(n == 3 * N && m == N && n_jacobian == 3 * N && n_hessian == 6 * N);
    ko_constraints_free(set);
    ko_field_free(field);
}

/* Far away, where a last bit of phi is many units of 1 / rho, gradients stay finite, and those of each sample at most that of phi. */
static void far_points_are_served(void) {
    ko_field *field = check_made_field(3);
    const double places[] = {1e6, 1e10, 1e14, 1e16, 1e20, 1e100};
    for (int k = 0; k < 3; k++) {
        ko_aggregation aggregation = check_aggregation(smooth_kinds[k]);
        aggregation.sharpness = 1e9;
        ko_constraints *set = NULL;
        uint32_t points = 0;
        OK(ko_constraints_create(3, &set));
        OK(ko_constraints_add_points(set, 4, &points));
        OK(ko_constraints_keep_points(set, points, field, KO_WORLD, &aggregation, NULL));
        for (size_t p = 0; p < sizeof places / sizeof *places; p++) {
            double *x = check_points(12, 1e-9 * places[p], p), lambda = 1.0, entries[12], hessian[78];
            for (int i = 0; i < 4; i++) {
                x[3 * i] = places[p];
            }
            OK(ko_constraints_jacobian(set, x, 12, 12, entries));
            OK(ko_constraints_hessian(set, x, 12, &lambda, 1, 78, hessian));
            for (int i = 0; i < 12; i++) {
                CHECK(fabs(entries[i]) < 2.0);
            }
            for (int i = 0; i < 78; i++) {
                CHECK(isfinite(hessian[i]));
            }
            free(x);
        }
        ko_constraints_free(set);
    }
    ko_field_free(field);
}

/* ---- handles ---- */

/* Bodies and fields may go first, and what was made with them stays to the bit. */
static void handles_may_go_first(uint32_t dim) {
    ko_field *field = check_made_field(dim);
    ko_body *body = check_body(dim, 300, 2);
    ko_constraints *set = NULL;
    uint32_t frame = 0;
    OK(ko_constraints_create(dim, &set));
    OK(ko_constraints_add_frame(set, KO_ROTATION_NONE, KO_SCALE_ONE, &frame));
    OK(ko_constraints_keep_body(set, body, frame, field, KO_WORLD, NULL, NULL));
    double x[3] = {0.1, 0.2, -0.1}, before[4], behind[4];
    OK(ko_constraints_values_and_jacobian(set, x, dim, 1, before, dim, before + 1));
    ko_body_free(body);
    ko_field_free(field);
    OK(ko_constraints_values_and_jacobian(set, x, dim, 1, behind, dim, behind + 1));
    CHECK(memcmp(before, behind, (1 + dim) * sizeof *before) == 0);
    ko_constraints_free(set);
    ko_constraints_free(NULL);
}

/* Without requirements there is nothing to give, which is no error. */
static void empty_sets_are_served(uint32_t dim) {
    ko_constraints *set = NULL;
    size_t n = 77, m = 77, n_jacobian = 77, n_hessian = 77;
    OK(ko_constraints_create(dim, &set));
    OK(ko_constraints_get_size(set, &n, &m, &n_jacobian, &n_hessian));
    CHECK(n == 0 && m == 0 && n_jacobian == 0 && n_hessian == 0);
    OK(ko_constraints_get_size(set, NULL, NULL, NULL, NULL));
    OK(ko_constraints_values(set, NULL, 0, 0, NULL));
    OK(ko_constraints_jacobian(set, NULL, 0, 0, NULL));
    OK(ko_constraints_values_and_jacobian(set, NULL, 0, 0, NULL, 0, NULL));
    OK(ko_constraints_dense_jacobian(set, NULL, 0, 0, NULL));
    OK(ko_constraints_jacobian_times(set, NULL, NULL, 0, 0, NULL));
    OK(ko_constraints_transposed_jacobian_times(set, NULL, 0, NULL, 0, NULL));
    OK(ko_constraints_jacobian_pattern(set, 0, NULL, NULL));
    OK(ko_constraints_hessian_pattern(set, 0, NULL, NULL));
    OK(ko_constraints_hessian(set, NULL, 0, NULL, 0, 0, NULL));
    uint32_t frame = 0;
    OK(ko_constraints_add_frame(set, KO_ROTATION_NONE, KO_SCALE_ONE, &frame));
    double x[3] = {1, 2, 3}, product[3] = {7, 7, 7};
    OK(ko_constraints_values(set, x, dim, 0, NULL));
    OK(ko_constraints_transposed_jacobian_times(set, x, dim, NULL, 0, product));
    CHECK(product[0] == 0.0 && product[dim - 1] == 0.0);
    ko_constraints_free(set);
}

int main(void) {
    numbers_are_aggregated();
    bodies_are_points();
    bodies_cover_meshes();
    for (uint32_t dim = 2; dim <= 3; dim++) {
        frames_move_as_they_say(dim);
        samples_are_aggregated(dim);
        points_are_variables(dim);
        fields_are_combined(dim);
        handles_may_go_first(dim);
        empty_sets_are_served(dim);
    }
    hard_combinations_are_not_smooth();
    single_points_are_sparse();
    far_points_are_served();
    return check_result();
}
