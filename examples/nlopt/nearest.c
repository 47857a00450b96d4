/* SPDX-License-Identifier: Apache-2.0 OR MIT */
/* The place outside a torus that is nearest to a point within it, by NLopt's MMA from C. The answer is known: straight out of the tube. */
#include <keepout.h>

#include <math.h>
#include <nlopt.h>
#include <stdio.h>
#include <stdlib.h>

enum { ALONG = 180, AROUND = 64 };

static const double TURN = 6.283185307179586;
static const double RING = 1.0, TUBE = 0.35;
static const double TARGET[3] = {0.72, 0.54, 0.12}; /* 0.9 from the axis: 0.1 within the ring, 0.12 above it */
static const double TOLERANCE = 2e-3;               /* several times what the field misses the torus by */

/* The constraints, and the first status of Keepout below 0. */
struct problem {
    ko_constraints *constraints;
    nlopt_opt optimiser;
    int evaluations;
    int32_t status;
};

/* Ends the program with the library's message where a call failed. */
static void check(int32_t status)
{
    if (status >= 0)
        return;
    fprintf(stderr, "keepout_nearest: %s\n", ko_last_error());
    exit(EXIT_FAILURE);
}

static ko_mesh *make_torus(void)
{
    static double vertices[3 * ALONG * AROUND];
    static uint32_t triangles[6 * ALONG * AROUND];
    for (uint32_t i = 0; i < ALONG; ++i) {
        for (uint32_t j = 0; j < AROUND; ++j) {
            const double angle = TURN * i / ALONG, tilt = TURN * j / AROUND, from_axis = RING + TUBE * cos(tilt);
            const uint32_t k = i * AROUND + j, next_i = (i + 1) % ALONG * AROUND, next_j = (j + 1) % AROUND;
            double *v = vertices + 3 * k;
            uint32_t *t = triangles + 6 * k;
            v[0] = from_axis * cos(angle);
            v[1] = from_axis * sin(angle);
            v[2] = TUBE * sin(tilt);
            /* Counter-clockwise seen from outside. */
            t[0] = t[3] = k;
            t[1] = next_i + j;
            t[2] = t[4] = next_i + next_j;
            t[5] = i * AROUND + next_j;
        }
    }
    ko_mesh *mesh;
    check(ko_mesh_from_triangles(vertices, ALONG * AROUND, triangles, 2 * ALONG * AROUND, &mesh));
    return mesh;
}

/* One point, kept where the field of the torus is positive. */
static ko_constraints *make_constraints(const ko_mesh *torus)
{
    ko_cloud *cloud;
    ko_field *field;
    ko_constraints *constraints;
    ko_aggregation none;
    uint32_t point;
    check(ko_mesh_sample(torus, 20000, 1, &cloud));
    check(ko_field_fit(cloud, NULL, &field));
    check(ko_aggregation_init(&none, sizeof none));
    none.kind = KO_AGGREGATE_NONE;
    check(ko_constraints_create(3, &constraints));
    check(ko_constraints_add_points(constraints, 1, &point));
    check(ko_constraints_keep_points(constraints, point, field, KO_WORLD, &none, NULL));
    ko_field_free(field); /* the constraints keep what they need of it */
    ko_cloud_free(cloud);
    return constraints;
}

static double squared_distance(unsigned n, const double *x, double *gradient, void *data)
{
    struct problem *problem = data;
    double sum = 0;
    ++problem->evaluations;
    for (unsigned k = 0; k < n; ++k) {
        sum += (x[k] - TARGET[k]) * (x[k] - TARGET[k]);
        if (gradient != NULL)
            gradient[k] = 2 * (x[k] - TARGET[k]);
    }
    return sum;
}

/* NLopt wants c(x) <= 0. A point that Keepout refuses stops the optimiser, which then says NLOPT_FORCED_STOP. */
static void outside(unsigned m, double *c, unsigned n, const double *x, double *gradient, void *data)
{
    struct problem *problem = data;
    int32_t status = ko_constraints_values(problem->constraints, x, n, m, c);
    if (status >= 0 && gradient != NULL)
        status = ko_constraints_dense_jacobian(problem->constraints, x, n, m, gradient);
    if (status < 0) {
        fprintf(stderr, "keepout_nearest: %s\n", ko_last_error());
        problem->status = status;
        nlopt_force_stop(problem->optimiser);
        return;
    }
    for (unsigned i = 0; i < m; ++i)
        c[i] = -c[i];
    for (unsigned i = 0; gradient != NULL && i < m * n; ++i)
        gradient[i] = -gradient[i];
}

/* Straight out of the tube: from the nearest point of the ring through the target. */
static void known_answer(double answer[3])
{
    const double from_axis = hypot(TARGET[0], TARGET[1]), out = from_axis - RING, length = hypot(out, TARGET[2]);
    const double scale = (RING + TUBE * out / length) / from_axis;
    answer[0] = scale * TARGET[0];
    answer[1] = scale * TARGET[1];
    answer[2] = TUBE * TARGET[2] / length;
}

int main(int argc, char **argv)
{
    ko_mesh *torus = make_torus();
    struct problem problem = {make_constraints(torus), nlopt_create(NLOPT_LD_MMA, 3), 0, KO_OK};
    double x[3] = {0.7, 0.5, 0.3}, answer[3], least, gradient[3], normal[3], distance, feasible = 1e-9;
    if (argc > 1) /* a start beyond all bounds, to see what becomes of it */
        x[0] = strtod(argv[1], NULL);

    nlopt_set_min_objective(problem.optimiser, squared_distance, &problem);
    nlopt_add_inequality_mconstraint(problem.optimiser, 1, outside, &problem, &feasible);
    nlopt_set_xtol_rel(problem.optimiser, 1e-10);
    nlopt_set_maxeval(problem.optimiser, 1000);
    const nlopt_result result = nlopt_optimize(problem.optimiser, x, &least);
    if (result < 0 || problem.status < 0) {
        printf("NLopt ends with %s\n", nlopt_result_to_string(result));
        return EXIT_FAILURE;
    }

    /* KKT: with one active constraint, the way to the target is along the gradient of phi, and its remainder the residual. */
    check(ko_constraints_dense_jacobian(problem.constraints, x, 3, 1, normal));
    squared_distance(3, x, gradient, &problem);
    double along = 0, square = 0, residual = 0, error = 0;
    for (int k = 0; k < 3; ++k) {
        along += gradient[k] * normal[k];
        square += normal[k] * normal[k];
    }
    known_answer(answer);
    for (int k = 0; k < 3; ++k) {
        residual = fmax(residual, fabs(gradient[k] - along / square * normal[k]));
        error = fmax(error, fabs(x[k] - answer[k]));
    }
    check(ko_mesh_signed_distance(torus, x, 1, &distance));
    printf("MMA: %s after %d evaluations\n", nlopt_result_to_string(result), problem.evaluations);
    printf("x      %9.6f %9.6f %9.6f\nknown  %9.6f %9.6f %9.6f\n", x[0], x[1], x[2], answer[0], answer[1], answer[2]);
    printf("error %.1e, KKT residual %.1e, multiplier %.4f, exact distance to the torus %.1e\n", error, residual, along / square, distance);

    const int ok = error < TOLERANCE && residual < 1e-5 && along > 0 && fabs(distance) < TOLERANCE;
    printf(ok ? "The known answer.\n" : "NOT the known answer.\n");
    nlopt_destroy(problem.optimiser);
    ko_constraints_free(problem.constraints);
    ko_mesh_free(torus);
    return ok ? EXIT_SUCCESS : EXIT_FAILURE;
}
