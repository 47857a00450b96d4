/* Choices among pairs: symmetric ones, those that keep in touch; and what a cell more or less does. */

#include "cogen.h"

/* Two wheels of 24^2 cells that turn against each other once, in steps that quarters of a turn carry onto each other. */
enum { SIDE = 24, CELLS = SIDE * SIDE };

struct wheels {
    ko_part *parts[2];
    ko_motion *motions[2];
    ko_pair *pair;
};

static struct wheels wheels_of(uint64_t measure_steps) {
    struct wheels w = {{grid(-0.5, -0.5, 1.0 / SIDE, SIDE, SIDE), grid(0.5, -0.5, 1.0 / SIDE, SIDE, SIDE)}, {NULL, NULL}, NULL};
    const double centers[4] = {0.0, 0.0, 1.0, 0.0};
    OK(ko_motion_gears(centers, 1.0, 1.0, &w.motions[0], &w.motions[1]));
    ko_pair_options options = options_of(KO_CONFLICTS_OF_OVERLAP, measure_steps);
    options.n_steps = 400;
    OK(ko_pair_create(w.parts[0], w.motions[0], w.parts[1], w.motions[1], &options, &w.pair));
    return w;
}

static void free_wheels(struct wheels *w) {
    for (int k = 0; k < 2; k++) {
        ko_part_free(w->parts[k]);
        ko_motion_free(w->motions[k]);
    }
    ko_pair_free(w->pair);
}

/* x goes to A x + b: about (0, 0) in part 1, about (1, 0) in part 2. */
static void about_centers(const double *one, const double *two, double *map) {
    memcpy(map, one, 4 * sizeof *map);
    map[4] = map[5] = 0.0;
    memcpy(map + 6, two, 4 * sizeof *map);
    map[10] = 1.0 - two[0];
    map[11] = -two[2];
}

static const double QUARTER[4] = {0.0, -1.0, 1.0, 0.0}, BACK[4] = {0.0, 1.0, -1.0, 0.0}, MIRROR[4] = {1.0, 0.0, 0.0, -1.0};

static int is_carried(const uint8_t *set, const double *linear) {
    for (int i = 0; i < CELLS; i++) {
        const double x = i / SIDE - 0.5 * (SIDE - 1), y = i % SIDE - 0.5 * (SIDE - 1);
        const int p = (int)lround(linear[0] * x + linear[1] * y + 0.5 * (SIDE - 1)),
                  q = (int)lround(linear[2] * x + linear[3] * y + 0.5 * (SIDE - 1));
        if (set[i] != set[SIDE * p + q]) {
            return 0;
        }
    }
    return 1;
}

static void check_pair(const struct wheels *w, const uint8_t *one, const uint8_t *two) {
    uint8_t closed_1[CELLS], closed_2[CELLS];
    size_t lost = 1;
    OK(ko_pair_volumes(w->pair, one, CELLS, two, CELLS, NULL, NULL, &lost));
    CHECK(lost == 0);
    OK(ko_pair_close(w->pair, one, two, 1, CELLS, CELLS, closed_1, closed_2, NULL));
    CHECK(memcmp(one, closed_1, CELLS) == 0 && memcmp(two, closed_2, CELLS) == 0);
}

static void pairs_are_symmetric_on_demand(void) {
    struct wheels w = wheels_of(0);
    double maps[24], wrong[12];
    about_centers(QUARTER, BACK, maps);
    about_centers(MIRROR, MIRROR, maps + 12);
    ko_family_options options;
    OK(ko_family_options_init(&options, sizeof options));
    CHECK(options.symmetries == NULL && options.n_symmetries == 0 && options.symmetry_excess == 0.0);
    options.symmetries = maps;
    options.n_symmetries = 2;
    uint8_t one[CELLS], two[CELLS], plain_1[CELLS], plain_2[CELLS];
    double weight, bound, plain;
    OK(ko_pair_cut(w.pair, NULL, NULL, &options, CELLS, CELLS, one, two, &weight, &bound, NULL));
    CHECK(weight == bound && is_carried(one, QUARTER) && is_carried(two, BACK) && is_carried(one, MIRROR) && is_carried(two, MIRROR));
    check_pair(&w, one, two);
    /* The best pair of all is symmetric by itself where weights are. */
    OK(ko_pair_cut(w.pair, NULL, NULL, NULL, CELLS, CELLS, plain_1, plain_2, &plain, NULL, NULL));
    CHECK_NEAR(weight, plain, 1e-12);

    /* Weights that are not: the best symmetric pair is lighter. */
    static double weights[CELLS];
    uint64_t seed = 5;
    for (int i = 0; i < CELLS; i++) {
        weights[i] = check_random(&seed) < 0.5 ? 1.0 : 2.0;
    }
    OK(ko_pair_cut(w.pair, weights, weights, &options, CELLS, CELLS, one, two, &weight, NULL, NULL));
    OK(ko_pair_cut(w.pair, weights, weights, NULL, CELLS, CELLS, plain_1, plain_2, &plain, NULL, NULL));
    CHECK(weight < plain && weight > 0.5 * plain && is_carried(one, QUARTER) && !is_carried(plain_1, QUARTER));
    check_pair(&w, one, two);

    const double gammas[3] = {0.0, 0.2, 1.0};
    static uint8_t all_1[3 * CELLS], all_2[3 * CELLS];
    double reached[3], volumes[6], bounds[3];
    OK(ko_pair_family(w.pair, NULL, NULL, gammas, 3, &options, CELLS, CELLS, all_1, all_2, reached, volumes, bounds));
    CHECK(reached[0] == 0.0 && reached[2] == 1.0 && fabs(reached[1] - 0.2) < 0.05);
    for (int k = 0; k < 3; k++) {
        CHECK(is_carried(all_1 + k * CELLS, QUARTER) && is_carried(all_2 + k * CELLS, MIRROR));
        CHECK(volumes[2 * k] + volumes[2 * k + 1] <= bounds[k] * (1 + 1e-9));
        check_pair(&w, all_1 + k * CELLS, all_2 + k * CELLS);
    }

    /* Wheels that turn against each other are not carried along by quarters the same way round. */
    about_centers(QUARTER, QUARTER, wrong);
    options.symmetries = wrong;
    options.n_symmetries = 1;
    FAILS(ko_pair_cut(w.pair, NULL, NULL, &options, CELLS, CELLS, one, two, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT,
          "map 0 does not carry conflicts onto conflicts");
    about_centers(QUARTER, BACK, wrong);
    wrong[10] = 0.0;
    FAILS(ko_pair_cut(w.pair, NULL, NULL, &options, CELLS, CELLS, one, two, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT,
          "symmetry 0: the map takes cell 0 of part 2");
    wrong[0] = NAN;
    FAILS(ko_pair_family(w.pair, NULL, NULL, gammas, 3, &options, CELLS, CELLS, all_1, all_2, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT,
          "symmetry 0: the map takes cell 0 of part 1");
    options.symmetries = NULL;
    FAILS(ko_pair_cut(w.pair, NULL, NULL, &options, CELLS, CELLS, one, two, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "symmetries is NULL");
    options.symmetries = maps;
    options.symmetry_excess = 1.0;
    FAILS(ko_pair_cut(w.pair, NULL, NULL, &options, CELLS, CELLS, one, two, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "excess of edges is 1");
    options.symmetry_excess = 0.0;
    options.reserved = 1;
    FAILS(ko_pair_cut(w.pair, NULL, NULL, &options, CELLS, CELLS, one, two, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "reserved is 1");
    free_wheels(&w);
}

/* The mean of 1 / (1 + g / h). */
static double persistence(const struct wheels *w, const uint8_t *one, const uint8_t *two, size_t n_times, double h) {
    double gaps[64], sum = 0.0;
    OK(ko_pair_contact(w->pair, one, CELLS, two, CELLS, n_times, 1, NULL, NULL, gaps, NULL, NULL, NULL, NULL));
    for (size_t k = 0; k < n_times; k++) {
        sum += 1.0 / (1.0 + gaps[k] / h);
    }
    return sum / (double)n_times;
}

static int32_t cancel(double fraction, const char *stage, void *data) {
    *(int *)data += fraction >= 0.0 && fraction <= 1.0 && stage != NULL;
    return 1;
}

static void pairs_of_one_weight_come_to_touch_better(void) {
    struct wheels w = wheels_of(0);
    uint8_t one[CELLS], two[CELLS], next_1[CELLS], next_2[CELLS];
    double weight, before, after;
    size_t tries = 0;
    ko_persistence_options options;
    OK(ko_persistence_options_init(&options, sizeof options));
    options.n_times = 60;
    options.max_tries = 40;
    options.n_threads = 1;
    OK(ko_pair_cut(w.pair, NULL, NULL, NULL, CELLS, CELLS, one, two, &weight, NULL, NULL));
    OK(ko_pair_more_persistent(w.pair, one, two, NULL, NULL, &options, CELLS, CELLS, next_1, next_2, &before, &after, &tries));
    CHECK(after > before && tries > 0 && tries <= 40);
    CHECK_NEAR(before, persistence(&w, one, two, 60, 1.0 / SIDE), 1e-12);
    CHECK_NEAR(after, persistence(&w, next_1, next_2, 60, 1.0 / SIDE), 1e-12);
    CHECK(count(one, CELLS) + count(two, CELLS) == count(next_1, CELLS) + count(next_2, CELLS));
    check_pair(&w, next_1, next_2);
    /* From there on, with another scale, and by the defaults. */
    uint8_t last_1[CELLS], last_2[CELLS];
    options.scale = 0.1;
    OK(ko_pair_more_persistent(w.pair, next_1, next_2, NULL, NULL, &options, CELLS, CELLS, last_1, last_2, &before, NULL, NULL));
    CHECK_NEAR(before, persistence(&w, next_1, next_2, 60, 0.1), 1e-12);
    OK(ko_pair_more_persistent(w.pair, next_1, next_2, NULL, NULL, NULL, CELLS, CELLS, last_1, last_2, NULL, NULL, NULL));
    check_pair(&w, last_1, last_2);

    memset(next_1, 7, CELLS);
    int told = 0;
    options.progress = cancel;
    options.progress_data = &told;
    FAILS(ko_pair_more_persistent(w.pair, one, two, NULL, NULL, &options, CELLS, CELLS, next_1, next_2, NULL, NULL, NULL), KO_ERR_CANCELLED,
          "cancelled");
    CHECK(told == 1);
    options.progress = NULL;
    options.gammas[0] = 0.7;
    options.gammas[1] = 0.3;
    FAILS(ko_pair_more_persistent(w.pair, one, two, NULL, NULL, &options, CELLS, CELLS, next_1, next_2, NULL, NULL, NULL),
          KO_ERR_INVALID_ARGUMENT, "from 0.7 to 0.3");
    OK(ko_persistence_options_init(&options, sizeof options));
    options.scale = -1.0;
    FAILS(ko_pair_more_persistent(w.pair, one, two, NULL, NULL, &options, CELLS, CELLS, next_1, next_2, NULL, NULL, NULL),
          KO_ERR_INVALID_ARGUMENT, "a scale of -1");
    options.scale = 0.0;
    options.n_times = 0;
    FAILS(ko_pair_more_persistent(w.pair, one, two, NULL, NULL, &options, CELLS, CELLS, next_1, next_2, NULL, NULL, NULL),
          KO_ERR_INVALID_ARGUMENT, "0 steps");
    FAILS(ko_persistence_options_init(&options, 8), KO_ERR_INVALID_ARGUMENT, "struct_size");
    FAILS(ko_pair_more_persistent(w.pair, one, two, NULL, NULL, NULL, CELLS, CELLS - 1, next_1, next_2, NULL, NULL, NULL),
          KO_ERR_INVALID_ARGUMENT, "n_2");
    /* By other weights it is not of the greatest. */
    static double weights[CELLS];
    for (int i = 0; i < CELLS; i++) {
        weights[i] = one[i] ? 1.0 : 3.0;
    }
    FAILS(ko_pair_more_persistent(w.pair, one, two, weights, NULL, NULL, CELLS, CELLS, next_1, next_2, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT,
          "the greatest weight is");
    /* A cell less could grow; all cells collide. */
    for (int i = 0; i < CELLS; i++) {
        if (one[i]) {
            one[i] = 0;
            break;
        }
    }
    FAILS(ko_pair_more_persistent(w.pair, one, two, NULL, NULL, NULL, CELLS, CELLS, next_1, next_2, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT,
          "the pair collides, could grow");
    CHECK(next_1[0] == 7 && next_1[CELLS - 1] == 7);
    free_wheels(&w);
}

static void a_cell_more_or_less_changes_the_measures(void) {
    struct wheels w = wheels_of(60);
    static double rho[2][CELLS], d[4][CELLS], put[4][CELLS], take[4][CELLS];
    uint64_t seed = 9;
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < CELLS; i++) {
            const double x = check_random(&seed);
            rho[k][i] = x < 0.3 ? 0.0 : x > 0.7 ? 1.0 : x;
        }
    }
    OK(ko_pair_sensitivities(w.pair, rho[0], CELLS, rho[1], CELLS, 1, d[0], d[1], d[2], d[3]));
    OK(ko_pair_topological_sensitivities(w.pair, rho[0], CELLS, rho[1], CELLS, KO_CHANGE_PUT, 1, put[0], put[1], put[2], put[3]));
    OK(ko_pair_topological_sensitivities(w.pair, rho[0], CELLS, rho[1], CELLS, KO_CHANGE_TAKE, 2, take[0], take[1], take[2], take[3]));
    const double area = 1.0 / CELLS;
    int n = 0;
    for (int k = 0; k < 4; k++) {
        for (int i = 0; i < CELLS; i++) {
            CHECK_NEAR(put[k][i], (1.0 - rho[k % 2][i]) * d[k][i] / area, 1e-12);
            CHECK_NEAR(take[k][i], rho[k % 2][i] * d[k][i] / area, 1e-12);
            n += put[k][i] > 0.0 && take[k][i] > 0.0;
        }
    }
    CHECK(n > 100);
    /* As the measure itself tells: an empty cell of part 2 is filled. */
    double g[2][2];
    OK(ko_pair_measures(w.pair, rho[0], CELLS, rho[1], CELLS, 1, &g[0][0], &g[0][1]));
    for (int i = 0; i < CELLS; i++) {
        if (rho[1][i] == 0.0 && put[1][i] > 0.0) {
            rho[1][i] = 1.0;
            OK(ko_pair_measures(w.pair, rho[0], CELLS, rho[1], CELLS, 1, &g[1][0], &g[1][1]));
            CHECK_NEAR((g[1][0] - g[0][0]) / area, put[1][i], 1e-10);
            CHECK_NEAR((g[1][1] - g[0][1]) / area, put[3][i], 1e-10);
            break;
        }
    }
    FAILS(ko_pair_topological_sensitivities(w.pair, rho[0], CELLS, rho[1], CELLS, 2, 1, put[0], put[1], put[2], put[3]),
          KO_ERR_INVALID_ARGUMENT, "change is 2");
    FAILS(ko_pair_topological_sensitivities(w.pair, rho[0], CELLS, rho[1], CELLS, KO_CHANGE_PUT, 1, put[0], NULL, put[2], put[3]),
          KO_ERR_INVALID_ARGUMENT, "d21_d2 is NULL");
    free_wheels(&w);
    w = wheels_of(0);
    FAILS(ko_pair_topological_sensitivities(w.pair, rho[0], CELLS, rho[1], CELLS, KO_CHANGE_PUT, 1, put[0], put[1], put[2], put[3]),
          KO_ERR_INVALID_ARGUMENT, "the pair has no measures");
    free_wheels(&w);
}

int main(void) {
    pairs_are_symmetric_on_demand();
    pairs_of_one_weight_come_to_touch_better();
    a_cell_more_or_less_changes_the_measures();
    return check_result();
}
