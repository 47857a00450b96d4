/* Co-generation: motions, parts, measures against sums over cells and times, pairs against all there are. */

#include "cogen.h"
#include <pthread.h>

static ko_motion *product(const ko_motion *outer, const ko_motion *inner) {
    ko_motion *motion = NULL;
    OK(ko_motion_product(outer, inner, &motion));
    return motion;
}

/* A pose of the plane or of space, as x y z of what it makes of a point. */
static void moved(const ko_motion *motion, double t, const double *p, double *to) {
    uint32_t dim = 0;
    double r[9], s[3];
    OK(ko_motion_get_dim(motion, &dim));
    OK(ko_motion_eval(motion, &t, 1, r, s));
    for (uint32_t a = 0; a < dim; a++) {
        to[a] = s[a];
        for (uint32_t b = 0; b < dim; b++) {
            to[a] += r[dim * a + b] * p[b];
        }
    }
}

/* The same backwards: by R^T. */
static void moved_back(const ko_motion *motion, double t, const double *p, double *to) {
    ko_motion *inverse = NULL;
    OK(ko_motion_inverse(motion, &inverse));
    moved(inverse, t, p, to);
    ko_motion_free(inverse);
}

static void near_point(const double *p, const double *q, int dim, double tolerance) {
    for (int a = 0; a < dim; a++) {
        CHECK_NEAR(p[a], q[a], tolerance);
    }
}

static void motions_move_as_they_say(void) {
    const double p[3] = {0.7, -0.3, 0.2};
    double q[3], r[3];
    const double t = 0.3;
    /* f(t) = 0.1 + 0.5 t + 0.2 cos(2 pi 3 t + 0.4) - 0.1 cos(2 pi t) */
    const double waves[6] = {0.2, 3.0, 0.4, -0.1, 1.0, 0.0};
    ko_law law = even(0.5);
    law.offset = 0.1;
    law.waves = waves;
    law.n_waves = 2;
    const double f = 0.1 + 0.5 * t + 0.2 * cos(TAU * 3.0 * t + 0.4) - 0.1 * cos(TAU * t);

    ko_motion *slide = NULL, *screw = NULL, *fixed = NULL, *still = NULL;
    const double along[3] = {1.0, 2.0, -1.0};
    OK(ko_motion_slide(3, along, &law, &slide));
    moved(slide, t, p, q);
    for (int a = 0; a < 3; a++) {
        CHECK_NEAR(q[a], p[a] + f * along[a], 1e-14);
    }
    /* About the line x = 1, y = 0, along z, in the other direction. */
    const double point[3] = {1.0, 0.0, 5.0}, axis[3] = {0.0, 0.0, -2.0};
    OK(ko_motion_screw(point, axis, 0.25, &law, &screw));
    moved(screw, t, p, q);
    const double right[3] = {1.0 + cos(f) * (p[0] - 1.0) + sin(f) * p[1], cos(f) * p[1] - sin(f) * (p[0] - 1.0), p[2] - 0.25 * f};
    near_point(q, right, 3, 1e-14);
    const double quarter[4] = {0.0, -1.0, 1.0, 0.0}, shift[2] = {3.0, 4.0};
    OK(ko_motion_fixed(2, quarter, shift, &fixed));
    moved(fixed, 0.9, p, q);
    CHECK(q[0] == 3.0 - p[1] && q[1] == 4.0 + p[0]);
    OK(ko_motion_fixed(2, NULL, NULL, &still));
    moved(still, 0.1, p, q);
    CHECK(q[0] == p[0] && q[1] == p[1]);

    /* Products and inverses. */
    ko_motion *both = product(screw, slide);
    moved(slide, t, p, q);
    moved(screw, t, q, r);
    moved(both, t, p, q);
    near_point(q, r, 3, 1e-14);
    moved_back(both, t, q, r);
    near_point(r, p, 3, 1e-14);
    ko_motion_free(slide);
    ko_motion_free(screw);
    ko_motion_free(fixed);
    ko_motion_free(still);
    ko_motion_free(both);
}

static int32_t on_screw(double time, double *rotation, double *translation, void *data) {
    return ko_motion_eval(data, &time, 1, rotation, translation);
}

static void samples_are_screws_between_poses(void) {
    enum { N = 5 };
    const double point[3] = {0.2, -0.1, 0.4}, axis[3] = {1.0, 2.0, 0.5}, p[3] = {0.7, -0.3, 0.2};
    ko_law law = even(3.0);
    ko_motion *screw = NULL, *sampled = NULL, *called = NULL;
    OK(ko_motion_screw(point, axis, 0.3, &law, &screw));
    double times[N], rotations[9 * N], translations[3 * N];
    for (int k = 0; k < N; k++) {
        times[k] = k / (N - 1.0);
    }
    OK(ko_motion_eval(screw, times, N, rotations, translations));
    OK(ko_motion_sampled(3, rotations, translations, N, &sampled));
    OK(ko_motion_from_function(3, on_screw, screw, N, NULL, 0.0, &called));
    for (int k = 0; k <= 100; k++) {
        double q[3], r[3], s[3];
        moved(screw, k / 100.0, p, q);
        moved(sampled, k / 100.0, p, r);
        moved(called, k / 100.0, p, s);
        near_point(q, r, 3, 1e-13);
        CHECK(memcmp(r, s, sizeof r) == 0);
    }
    ko_motion_free(screw);
    ko_motion_free(sampled);
    ko_motion_free(called);
}

static void mechanisms_hold_together(void) {
    ko_motion *first = NULL, *second = NULL, *crank = NULL, *coupler = NULL, *rocker = NULL;
    const double centers[4] = {0.0, 0.0, 3.0, 0.0}, origin[2] = {0.0, 0.0};
    OK(ko_motion_gears(centers, 1.0, 2.0, &first, &second));
    /* The pitch point: r_1 = 2 r_2. Both wheels pass it together. */
    const double before[2] = {2.0, 0.0}, h = 1e-6;
    double q[2], r[2], back[2];
    moved_back(second, 0.5 - h, before, back);
    moved(second, 0.5 + h, back, r);
    moved_back(first, 0.5 - h, before, back);
    moved(first, 0.5 + h, back, q);
    CHECK(q[1] > 2e-5);
    near_point(q, r, 2, 1e-9);

    const double pivots[4] = {0.0, 0.0, 1.0, 0.0}, lengths[3] = {0.3, 0.9, 0.7};
    OK(ko_motion_four_bar(pivots, lengths, 0.2, TAU, 1, 64, &crank, &coupler, &rocker));
    for (int k = 0; k <= 64; k++) {
        const double t = k / 64.0, end_of_crank[2] = {0.3, 0.0}, end_of_coupler[2] = {0.9, 0.0}, end_of_rocker[2] = {0.7, 0.0};
        moved(crank, t, end_of_crank, q);
        moved(coupler, t, origin, r);
        near_point(q, r, 2, 1e-12);
        moved(coupler, t, end_of_coupler, q);
        moved(rocker, t, end_of_rocker, r);
        near_point(q, r, 2, 1e-12);
        CHECK(r[1] > 0.0);
    }
    ko_motion_free(first);
    ko_motion_free(second);
    ko_motion_free(crank);
    ko_motion_free(coupler);
    ko_motion_free(rocker);
}

static double sum(const double *x, size_t n) {
    double total = 0.0;
    for (size_t i = 0; i < n; i++) {
        total += x[i];
    }
    return total;
}

static void parts_are_what_was_given(void) {
    const double corner[3] = {-1.0, 0.5, 2.0};
    const size_t counts[3] = {2, 3, 4};
    uint8_t cells[24], copied[24];
    for (int i = 0; i < 24; i++) {
        cells[i] = (uint8_t)(i % 3);
    }
    ko_part *part = NULL;
    OK(ko_part_create(3, corner, 0.25, counts, cells, 24, &part));
    uint32_t dim = 0;
    size_t n = 0, m[3];
    double c[3], edge = 0.0;
    OK(ko_part_get_size(part, &dim, &n));
    CHECK(dim == 3 && n == 24);
    OK(ko_part_get_size(part, NULL, NULL));
    OK(ko_part_get_grid(part, c, &edge, m));
    CHECK(memcmp(c, corner, sizeof c) == 0 && edge == 0.25 && memcmp(m, counts, sizeof m) == 0);
    OK(ko_part_get_grid(part, NULL, NULL, NULL));
    OK(ko_part_copy_cells(part, 24, copied));
    CHECK(memcmp(cells, copied, sizeof cells) == 0);
    ko_part_free(part);
}

static void fractions_are_areas_and_volumes(void) {
    enum { N = 16 * 16 * 16 };
    static double out[N], again[N];
    const double pi = 0.5 * TAU;
    ko_part *plane = grid(-0.8, -0.8, 0.1, 16, 16), *space = NULL;
    const double low[3] = {-0.75, -0.4, -0.4}, high[3] = {0.2, 0.5, 0.3}, center[3] = {0.01, 0.02, 0.0};
    OK(ko_part_fractions_of_box(plane, low, high, 4, 1, 256, out));
    CHECK_NEAR(sum(out, 256) * 0.01, 0.95 * 0.9, 1e-12);
    OK(ko_part_fractions_of_ball(plane, center, 0.5, 8, 1, 256, out));
    CHECK_NEAR(sum(out, 256) * 0.01, pi * 0.25, 2e-3);
    const double ends[4] = {-0.5, -0.4, 0.5, 0.45};
    OK(ko_part_fractions_of_cylinder(plane, ends, 0.1, 32, 3, 256, out));
    CHECK_NEAR(sum(out, 256) * 0.01, 0.2 * hypot(1.0, 0.85), 1e-3);

    const double corner[3] = {-1.2, -1.2, -1.2};
    const size_t counts[3] = {16, 16, 16};
    OK(ko_part_create(3, corner, 0.15, counts, NULL, 0, &space));
    ko_mesh *cube = check_cube();
    OK(ko_part_fractions_of_mesh(space, cube, 3, 1, N, out));
    CHECK_NEAR(sum(out, N) * 0.15 * 0.15 * 0.15, 8.0, 1e-9);
    OK(ko_part_fractions_of_mesh(space, cube, 3, 2, N, again));
    CHECK(memcmp(out, again, sizeof out) == 0);
    /* A field by its values: cells are sampled at 2^3 points. */
    ko_field *field = check_made_field(3);
    OK(ko_part_fractions_of_field(space, field, 3.0, 2, 1, N, out));
    size_t some = 0;
    for (size_t i = 0; i < N; i++) {
        double inside = 0.0;
        for (int k = 0; k < 8; k++) {
            const size_t place[3] = {i / 256, i / 16 % 16, i % 16};
            double p[3], value;
            for (int a = 0; a < 3; a++) {
                p[a] = corner[a] + 0.15 * ((double)place[a] + ((k >> a & 1) ? 0.75 : 0.25));
            }
            OK(ko_field_eval(field, p, 1, &value, NULL, NULL));
            inside += value < 0.0 ? 0.125 : 0.0;
        }
        CHECK(out[i] == inside);
        some += inside > 0.0 && inside < 1.0;
    }
    CHECK(some > 50);
    ko_field_free(field);
    ko_mesh_free(cube);
    ko_part_free(plane);
    ko_part_free(space);
}

/* Two grids that turn against each other, the second the finer: no centre comes to a border of cells. */
enum { N1 = 120, N2 = 160, K = 53 };
static const double EDGE_1 = 0.1, EDGE_2 = 0.075, CORNER_1[2] = {-0.5123, -0.6011}, CORNER_2[2] = {0.3017, -0.3702};

struct gears {
    ko_part *parts[2];
    ko_motion *motions[2];
    ko_pair *pair;
};

static struct gears gears_of(int32_t conflicts, uint64_t measure_steps) {
    struct gears g = {{grid(CORNER_1[0], CORNER_1[1], EDGE_1, 10, 12), grid(CORNER_2[0], CORNER_2[1], EDGE_2, 16, 10)},
                      {turn(0.0, 0.0, TAU), turn(0.9, 0.0, -TAU)},
                      NULL};
    ko_pair_options options = options_of(conflicts, measure_steps);
    OK(ko_pair_create(g.parts[0], g.motions[0], g.parts[1], g.motions[1], &options, &g.pair));
    return g;
}

static void free_gears(struct gears *g) {
    for (int k = 0; k < 2; k++) {
        ko_part_free(g->parts[k]);
        ko_motion_free(g->motions[k]);
    }
    ko_pair_free(g->pair);
}

/* w[i][j] of (A.15) without the measure: the times at which the centre of cell i of a grid is in cell j of the other, over K. */
static void weigh(const struct gears *g, int of, double *w) {
    const double *corners[2] = {CORNER_1, CORNER_2}, edges[2] = {EDGE_1, EDGE_2};
    const int columns[2] = {12, 10}, rows[2] = {10, 16}, n[2] = {N1, N2}, in = 1 - of;
    for (int i = 0; i < n[of]; i++) {
        for (int k = 0; k < K; k++) {
            const double t = (k + 0.5) / K;
            const double p[2] = {corners[of][0] + edges[of] * (i / columns[of] + 0.5), corners[of][1] + edges[of] * (i % columns[of] + 0.5)};
            double world[2], q[2];
            moved(g->motions[of], t, p, world);
            moved_back(g->motions[in], t, world, q);
            const double a = floor((q[0] - corners[in][0]) / edges[in]), b = floor((q[1] - corners[in][1]) / edges[in]);
            if (a >= 0 && a < rows[in] && b >= 0 && b < columns[in]) {
                w[i * n[in] + (int)a * columns[in] + (int)b] += 1.0 / K;
            }
        }
    }
}

static void measures_are_sums_over_cells_and_times(void) {
    struct gears g = gears_of(KO_CONFLICTS_OF_MEASURE, K);
    static double of_1[N1 * N2], of_2[N2 * N1];
    weigh(&g, 0, of_1);
    weigh(&g, 1, of_2);
    double rho_1[N1], rho_2[N2], l21[N1], l12[N2], d21_d1[N1], d21_d2[N2], d12_d1[N1], d12_d2[N2], g21 = 0.0, g12 = 0.0;
    uint64_t seed = 3;
    for (int i = 0; i < N1; i++) {
        rho_1[i] = check_random(&seed);
    }
    for (int j = 0; j < N2; j++) {
        rho_2[j] = check_random(&seed);
    }
    OK(ko_pair_measures(g.pair, rho_1, N1, rho_2, N2, 1, &g21, &g12));
    OK(ko_pair_measures(g.pair, rho_1, N1, rho_2, N2, 1, NULL, NULL));
    OK(ko_pair_local_measures(g.pair, rho_1, N1, rho_2, N2, 1, l21, l12));
    OK(ko_pair_sensitivities(g.pair, rho_1, N1, rho_2, N2, 1, d21_d1, d21_d2, d12_d1, d12_d2));
    const double area_1 = EDGE_1 * EDGE_1, area_2 = EDGE_2 * EDGE_2;
    double right_21 = 0.0, right_12 = 0.0;
    size_t n_edges = 0, visits = 0;
    for (int i = 0; i < N1; i++) {
        double local = 0.0, by_1 = 0.0;
        for (int j = 0; j < N2; j++) {
            const double w21 = of_1[i * N2 + j], w12 = of_2[j * N1 + i];
            local += w21 * rho_2[j];
            by_1 += area_2 * w12 * rho_2[j];
            right_12 += area_1 * rho_1[i] * w21 * rho_2[j];
            right_21 += area_2 * rho_1[i] * w12 * rho_2[j];
            n_edges += w21 > 0.0 || w12 > 0.0;
            visits += w21 > 0.0;
        }
        CHECK_NEAR(l21[i], local, 1e-14);
        CHECK_NEAR(d12_d1[i], area_1 * local, 1e-14);
        CHECK_NEAR(d21_d1[i], by_1, 1e-14);
    }
    for (int j = 0; j < N2; j++) {
        double local = 0.0, by_2 = 0.0;
        for (int i = 0; i < N1; i++) {
            local += of_2[j * N1 + i] * rho_1[i];
            by_2 += area_1 * of_1[i * N2 + j] * rho_1[i];
        }
        CHECK_NEAR(l12[j], local, 1e-14);
        CHECK_NEAR(d21_d2[j], area_2 * local, 1e-14);
        CHECK_NEAR(d12_d2[j], by_2, 1e-14);
    }
    CHECK(right_21 > 0.01 && right_12 > 0.01 && visits > 100);
    CHECK_NEAR(g21, right_21, 1e-14);
    CHECK_NEAR(g12, right_12, 1e-14);
    ko_pair_report report;
    OK(ko_pair_get_report(g.pair, sizeof report, &report));
    CHECK(report.dim == 2 && report.n_cells[0] == N1 && report.n_cells[1] == N2 && report.measure_steps == K);
    CHECK(report.has_graph == 1 && report.n_edges == n_edges && report.graph_bytes > 0 && report.measure_bytes > 0);
    /* Both ways, (33) to (36): cells with a weight. */
    uint8_t hit_1[N1] = {0}, hit_2[N2] = {0}, found_1[N1], found_2[N2];
    for (int i = 0; i < N1; i++) {
        for (int j = 0; j < N2; j++) {
            const int meets = of_1[i * N2 + j] > 0.0 || of_2[j * N1 + i] > 0.0;
            hit_1[i] |= (uint8_t)meets;
            hit_2[j] |= (uint8_t)meets;
        }
    }
    OK(ko_pair_colliding(g.pair, N1, N2, found_1, found_2));
    CHECK(memcmp(hit_1, found_1, N1) == 0 && memcmp(hit_2, found_2, N2) == 0);
    CHECK(report.n_colliding[0] == count(found_1, N1) && report.n_colliding[1] == count(found_2, N2));
    /* A pair that does not conflict has measures of 0. */
    uint8_t cells_1[N1], cells_2[N2];
    OK(ko_pair_cut(g.pair, NULL, NULL, NULL, N1, N2, cells_1, cells_2, NULL, NULL, NULL));
    for (int i = 0; i < N1; i++) {
        rho_1[i] = cells_1[i];
    }
    for (int j = 0; j < N2; j++) {
        rho_2[j] = cells_2[j];
    }
    OK(ko_pair_measures(g.pair, rho_1, N1, rho_2, N2, 2, &g21, &g12));
    CHECK(g21 == 0.0 && g12 == 0.0);
    free_gears(&g);
}

/* With all of one part, the other is what it leaves: the unsweep, seen from the part with fewer cells as the graph sees it. */
static void ends_of_the_family_are_unsweeps(void) {
    struct gears g = gears_of(KO_CONFLICTS_OF_OVERLAP, 0);
    uint8_t all_1[N1], all_2[N2], cells_1[N1], cells_2[N2], kept[N2];
    memset(all_1, 1, N1);
    memset(all_2, 1, N2);
    double gamma = -1.0, reached[2], volumes[4], bounds[2], part[2];
    OK(ko_pair_close(g.pair, NULL, all_2, 2, N1, N2, cells_1, cells_2, &gamma));
    memset(kept, 1, N1);
    ko_pair_options one = options_of(KO_CONFLICTS_OF_OVERLAP, 0);
    OK(ko_part_unsweep(g.parts[0], g.motions[0], g.parts[1], NULL, 0, g.motions[1], KO_AVOID, &one, N1, kept));
    CHECK(gamma == 1.0 && count(cells_2, N2) == N2 && count(kept, N1) > 2 && count(kept, N1) < N1);
    CHECK(memcmp(kept, cells_1, N1) == 0);
    /* The family's ends are these. */
    const double gammas[2] = {0.0, 1.0};
    uint8_t family_1[2 * N1], family_2[2 * N2];
    OK(ko_pair_family(g.pair, NULL, NULL, gammas, 2, NULL, N1, N2, family_1, family_2, reached, volumes, bounds));
    CHECK(memcmp(family_1 + N1, cells_1, N1) == 0 && memcmp(family_2 + N2, cells_2, N2) == 0);
    CHECK(reached[0] == 0.0 && reached[1] == 1.0 && count(family_1, N1) == N1);
    OK(ko_pair_volumes(g.pair, family_1 + N1, N1, family_2 + N2, N2, part, &gamma, NULL));
    CHECK(gamma == 1.0 && part[0] == 0.0);
    CHECK_NEAR(part[1], volumes[3], 1e-12);
    CHECK(volumes[3] <= bounds[1] * (1.0 + 1e-12) && volumes[0] <= bounds[0] * (1.0 + 1e-12));
    free_gears(&g);

    /* The other way round: the parts swap places, so that the graph's rows are part 2's. */
    g = gears_of(KO_CONFLICTS_OF_OVERLAP, 0);
    ko_pair *swapped = NULL;
    OK(ko_pair_create(g.parts[1], g.motions[1], g.parts[0], g.motions[0], &one, &swapped));
    OK(ko_pair_close(swapped, all_2, NULL, 1, N2, N1, cells_2, cells_1, &gamma));
    CHECK(gamma == 0.0 && memcmp(kept, cells_1, N1) == 0);
    ko_pair_free(swapped);
    free_gears(&g);
}

/* All pairs of a small case: for each set of part 2, what part 1 may have beside it. */
static void cuts_are_the_best_of_all_pairs(void) {
    enum { M1 = 16, M2 = 9 };
    const double corner[2] = {0.9, -0.31};
    ko_part *one = grid(-0.5, -0.5, 0.25, 4, 4), *two = grid(corner[0] - 0.6, corner[1], 0.2, 3, 3);
    ko_motion *motions[2] = {turn(0.0, 0.0, TAU), turn(1.0, 0.0, -TAU)};
    ko_pair *pair = NULL;
    OK(ko_pair_create(one, motions[0], two, motions[1], NULL, &pair));
    uint8_t beside[M2][M1], set[M2] = {0}, cells_1[M1], cells_2[M2];
    for (int j = 0; j < M2; j++) {
        set[j] = 1;
        OK(ko_pair_close(pair, NULL, set, 2, M1, M2, beside[j], cells_2, NULL));
        CHECK(cells_2[j] == 1);
        set[j] = 0;
    }
    uint64_t seed = 11;
    for (int round = 0; round < 30; round++) {
        double w1[M1], w2[M2], best = 0.0, weight, bound, gamma;
        for (int i = 0; i < M1; i++) {
            w1[i] = round == 0 ? 0.0625 : round % 2 == 0 ? check_random(&seed) : floor(4.0 * check_random(&seed));
        }
        for (int j = 0; j < M2; j++) {
            w2[j] = round == 0 ? 0.04 : round % 2 == 0 ? 2.0 * check_random(&seed) : floor(6.0 * check_random(&seed));
        }
        for (int s = 0; s < 1 << M2; s++) {
            double total = 0.0;
            for (int j = 0; j < M2; j++) {
                total += (s >> j & 1) ? w2[j] : 0.0;
            }
            for (int i = 0; i < M1; i++) {
                int may = 1;
                for (int j = 0; j < M2; j++) {
                    may = may && (!(s >> j & 1) || beside[j][i]);
                }
                total += may ? w1[i] : 0.0;
            }
            best = fmax(best, total);
        }
        OK(ko_pair_cut(pair, round ? w1 : NULL, round ? w2 : NULL, NULL, M1, M2, cells_1, cells_2, &weight, &bound, &gamma));
        double own = 0.0;
        for (int i = 0; i < M1; i++) {
            own += cells_1[i] * w1[i];
        }
        for (int j = 0; j < M2; j++) {
            own += cells_2[j] * w2[j];
        }
        CHECK_NEAR(own, best, 1e-9);
        CHECK_NEAR(weight, best, 1e-9);
        CHECK(weight == bound);
        size_t lost = 1;
        double reached;
        OK(ko_pair_volumes(pair, cells_1, M1, cells_2, M2, NULL, &reached, &lost));
        CHECK(lost == 0 && reached == gamma);
        /* And maximal: closing it from either part leaves it as it is. */
        for (uint32_t from = 0; from <= 2; from++) {
            uint8_t again_1[M1], again_2[M2];
            OK(ko_pair_close(pair, cells_1, cells_2, from, M1, M2, again_1, again_2, NULL));
            CHECK(memcmp(cells_1, again_1, M1) == 0 && memcmp(cells_2, again_2, M2) == 0);
        }
    }
    ko_part_free(one);
    ko_part_free(two);
    ko_motion_free(motions[0]);
    ko_motion_free(motions[1]);
    ko_pair_free(pair);
}

/* Points of kept cells at many times are in no kept cell of the other part, and nearer to none than the clearance. */
static void pairs_never_overlap(void) {
    struct gears g = gears_of(KO_CONFLICTS_OF_OVERLAP, 0);
    ko_pair_free(g.pair);
    ko_pair_options options = options_of(KO_CONFLICTS_OF_OVERLAP, 0);
    options.clearance = 0.03;
    OK(ko_pair_create(g.parts[0], g.motions[0], g.parts[1], g.motions[1], &options, &g.pair));
    uint8_t cells_1[N1], cells_2[N2];
    double weight, bound, gaps[40], places[80], largest, mean, total = 0.0;
    size_t pairs[80];
    OK(ko_pair_cut(g.pair, NULL, NULL, NULL, N1, N2, cells_1, cells_2, &weight, &bound, NULL));
    CHECK(count(cells_1, N1) > 5 && count(cells_2, N2) > 5);
    uint64_t seed = 5;
    for (int k = 0; k < 3000; k++) {
        const double t = check_random(&seed);
        const size_t j = (size_t)(N2 * check_random(&seed));
        const double p[2] = {CORNER_2[0] + EDGE_2 * ((double)(j / 10) + check_random(&seed)),
                             CORNER_2[1] + EDGE_2 * ((double)(j % 10) + check_random(&seed))};
        double world[2], q[2];
        moved(g.motions[1], t, p, world);
        moved_back(g.motions[0], t, world, q);
        for (int i = 0; i < N1 && cells_2[j]; i++) {
            if (cells_1[i]) {
                const double dx = fabs(q[0] - CORNER_1[0] - EDGE_1 * (i / 12 + 0.5)) - 0.5 * EDGE_1;
                const double dy = fabs(q[1] - CORNER_1[1] - EDGE_1 * (i % 12 + 0.5)) - 0.5 * EDGE_1;
                CHECK(hypot(fmax(dx, 0.0), fmax(dy, 0.0)) >= 0.03 - 1e-12);
            }
        }
    }
    OK(ko_pair_contact(g.pair, cells_1, N1, cells_2, N2, 40, 1, NULL, NULL, gaps, pairs, places, &largest, &mean));
    for (int k = 0; k < 40; k++) {
        CHECK(gaps[k] >= 0.03 - 1e-12 && gaps[k] <= largest && cells_1[pairs[2 * k]] == 1 && cells_2[pairs[2 * k + 1]] == 1);
        total += gaps[k] / 40.0;
    }
    CHECK_NEAR(mean, total, 1e-14);
    OK(ko_pair_contact(g.pair, cells_1, N1, cells_2, N2, 40, 1, NULL, NULL, NULL, NULL, NULL, NULL, NULL));
    free_gears(&g);
}

static void sweeps_hold_what_is_passed(void) {
    ko_part *rod = grid(0.2, -0.05, 0.1, 5, 1), *table = grid(-1.0, -1.0, 0.1, 20, 20);
    ko_motion *motion = turn(0.0, 0.0, 0.25 * TAU);
    uint8_t swept[400], kept[5], pin[400] = {0};
    ko_pair_options options = options_of(KO_CONFLICTS_OF_OVERLAP, 0);
    OK(ko_part_sweep(rod, NULL, 0, motion, table, NULL, &options, 400, swept));
    for (int i = 0; i < 400; i++) {
        const double x = -0.95 + 0.1 * (i / 20), y = -0.95 + 0.1 * (i % 20), r = hypot(x, y);
        const int inside = x > 0.05 && y > 0.05 && r > 0.3 && r < 0.6, off = x < -0.15 || y < -0.15 || r > 0.85;
        CHECK(!(inside && !swept[i]) && !(off && swept[i]));
    }
    /* A cell of the rod that is asked for alone. */
    const uint8_t first[5] = {1, 0, 0, 0, 0};
    OK(ko_part_sweep(rod, first, 5, motion, table, NULL, &options, 400, swept));
    CHECK(count(swept, 400) > 8 && count(swept, 400) < 40);
    /* A pin at a radius of 0.5 takes the rod's cells there, an enclosure of radius 0.6 those beyond. */
    pin[20 * 13 + 13] = 1;
    memset(kept, 1, sizeof kept);
    OK(ko_part_unsweep(rod, motion, table, pin, 400, NULL, KO_AVOID, &options, 5, kept));
    CHECK(kept[0] == 1 && kept[4] == 1 && kept[2] == 0);
    uint8_t round_[400];
    for (int i = 0; i < 400; i++) {
        round_[i] = hypot(-0.95 + 0.1 * (i / 20), -0.95 + 0.1 * (i % 20)) < 0.62;
    }
    OK(ko_part_unsweep(rod, motion, table, round_, 400, NULL, KO_STAY_IN, &options, 5, kept));
    CHECK(kept[0] == 1 && kept[2] == 0 && kept[4] == 0);
    ko_part_free(rod);
    ko_part_free(table);
    ko_motion_free(motion);
}

static void densities_are_optimised(void) {
    struct gears g = gears_of(KO_CONFLICTS_OF_MEASURE, K);
    ko_optimise_options options;
    OK(ko_optimise_options_init(&options, sizeof options));
    options.n_threads = 1;
    static double history[5 * 201];
    double rho_1[N1], rho_2[N2], g21, g12, weight;
    uint8_t cells_1[N1], cells_2[N2], best_1[N1], best_2[N2];
    ko_optimise_report report;
    OK(ko_pair_optimise(g.pair, &options, N1, N2, rho_1, rho_2, cells_1, cells_2, history, sizeof report, &report));
    CHECK(report.converged == 1 && report.n_iterations > 3 && report.n_iterations < 200 && report.change < options.tolerance);
    OK(ko_pair_measures(g.pair, rho_1, N1, rho_2, N2, 1, &g21, &g12));
    const double *last = history + 5 * report.n_iterations;
    CHECK_NEAR(last[2], g21, 1e-12);
    CHECK_NEAR(last[3], g12, 1e-12);
    CHECK(g21 == report.measures[0] || fabs(g21 - report.measures[0]) < 1e-12);
    CHECK(g21 < 0.01 * history[2] && last[4] == report.change);
    size_t lost = 1;
    OK(ko_pair_volumes(g.pair, cells_1, N1, cells_2, N2, NULL, NULL, &lost));
    CHECK(lost == 0);
    OK(ko_pair_cut(g.pair, NULL, NULL, NULL, N1, N2, best_1, best_2, &weight, NULL, NULL));
    const double area = EDGE_1 * EDGE_1 * (double)count(cells_1, N1) + EDGE_2 * EDGE_2 * (double)count(cells_2, N2);
    CHECK(area <= weight + 1e-12 && area > 0.5 * weight);
    options.max_iterations = 2;
    CHECK(ko_pair_optimise(g.pair, &options, N1, N2, NULL, NULL, cells_1, cells_2, NULL, sizeof report, &report) == KO_BUDGET_REACHED);
    CHECK(report.n_iterations == 2 && report.converged == 0);
    free_gears(&g);
}

/* In space, a turn of a box in another one's corner: a pair, and that it holds. */
static void space_is_served(void) {
    const double corners[2][3] = {{-0.5, -0.5, -0.5}, {0.2, -0.3, -0.4}}, axis[3] = {0, 0, 1}, point[3] = {0, 0, 0};
    const size_t counts[2][3] = {{4, 4, 4}, {3, 3, 3}};
    ko_part *parts[2] = {NULL, NULL};
    for (int k = 0; k < 2; k++) {
        OK(ko_part_create(3, corners[k], 0.25, counts[k], NULL, 0, &parts[k]));
    }
    ko_law law = even(2.0);
    ko_motion *screw = NULL;
    OK(ko_motion_screw(point, axis, 0.1, &law, &screw));
    ko_pair_options options = options_of(KO_CONFLICTS_OF_OVERLAP, 20);
    ko_pair *pair = NULL;
    OK(ko_pair_create(parts[0], screw, parts[1], NULL, &options, &pair));
    uint8_t cells_1[64], cells_2[27];
    double weight, bound, rho_1[64], rho_2[27], g21, g12;
    OK(ko_pair_cut(pair, NULL, NULL, NULL, 64, 27, cells_1, cells_2, &weight, &bound, NULL));
    CHECK_NEAR(weight, (double)(count(cells_1, 64) + count(cells_2, 27)) / 64.0, 1e-12);
    CHECK(weight == bound && count(cells_1, 64) > 20 && count(cells_1, 64) < 64);
    for (int i = 0; i < 64; i++) {
        rho_1[i] = cells_1[i];
    }
    for (int j = 0; j < 27; j++) {
        rho_2[j] = cells_2[j];
    }
    OK(ko_pair_measures(pair, rho_1, 64, rho_2, 27, 1, &g21, &g12));
    CHECK(g21 == 0.0 && g12 == 0.0);
    for (int k = 0; k < 2; k++) {
        ko_part_free(parts[k]);
    }
    ko_motion_free(screw);
    ko_pair_free(pair);
}

struct worker {
    pthread_t thread;
    const struct gears *gears;
    const double *rho_1, *rho_2, *right;
    const uint8_t *right_1, *right_2;
    int index, failures;
};

static void *work(void *data) {
    struct worker *w = data;
    const ko_pair *pair = w->gears->pair;
    double bad[N1], g21, g12;
    uint8_t cells_1[N1], cells_2[N2];
    char words[32];
    memcpy(bad, w->rho_1, sizeof bad);
    bad[w->index] = 2.0;
    snprintf(words, sizeof words, "density %d of part 1 is 2", w->index);
    for (int round = 0; round < 3; round++) {
        w->failures += ko_pair_measures(pair, w->rho_1, N1, w->rho_2, N2, 1 + round, &g21, &g12) != KO_OK;
        w->failures += g21 != w->right[0] || g12 != w->right[1];
        w->failures += ko_pair_cut(pair, NULL, NULL, NULL, N1, N2, cells_1, cells_2, NULL, NULL, NULL) != KO_OK;
        w->failures += memcmp(cells_1, w->right_1, N1) != 0 || memcmp(cells_2, w->right_2, N2) != 0;
        w->failures += ko_pair_measures(pair, bad, N1, w->rho_2, N2, 1, &g21, &g12) != KO_ERR_INVALID_ARGUMENT;
        w->failures += strstr(ko_last_error(), words) == NULL;
    }
    return NULL;
}

static void threads_do_not_meet(void) {
    enum { N_THREADS = 6 };
    struct gears g = gears_of(KO_CONFLICTS_OF_OVERLAP, K);
    double rho_1[N1], rho_2[N2], right[2];
    uint8_t cells_1[N1], cells_2[N2];
    for (int i = 0; i < N1; i++) {
        rho_1[i] = 1.0 / (1 + i);
    }
    for (int j = 0; j < N2; j++) {
        rho_2[j] = 1.0 / (2 + j);
    }
    OK(ko_pair_measures(g.pair, rho_1, N1, rho_2, N2, 1, &right[0], &right[1]));
    OK(ko_pair_cut(g.pair, NULL, NULL, NULL, N1, N2, cells_1, cells_2, NULL, NULL, NULL));
    struct worker workers[N_THREADS];
    for (int k = 0; k < N_THREADS; k++) {
        workers[k] = (struct worker){.gears = &g, .rho_1 = rho_1, .rho_2 = rho_2, .right = right, .right_1 = cells_1, .right_2 = cells_2, .index = k};
        CHECK(pthread_create(&workers[k].thread, NULL, work, &workers[k]) == 0);
    }
    for (int k = 0; k < N_THREADS; k++) {
        CHECK(pthread_join(workers[k].thread, NULL) == 0);
        CHECK(workers[k].failures == 0);
    }
    free_gears(&g);
}

int main(void) {
    motions_move_as_they_say();
    samples_are_screws_between_poses();
    mechanisms_hold_together();
    parts_are_what_was_given();
    fractions_are_areas_and_volumes();
    measures_are_sums_over_cells_and_times();
    ends_of_the_family_are_unsweeps();
    cuts_are_the_best_of_all_pairs();
    pairs_never_overlap();
    sweeps_hold_what_is_passed();
    densities_are_optimised();
    space_is_served();
    threads_do_not_meet();
    return check_result();
}
