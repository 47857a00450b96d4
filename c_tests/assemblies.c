/* Assemblies: trains of wheels, three that meet each other, and what is refused. */

#include "cogen.h"

/* Wheels of `side`^2 cells around centres, every other one turning the other way. */
enum { MOST = 4, SIDE = 10, CELLS = SIDE * SIDE };

struct wheels {
    ko_part *parts[MOST];
    ko_motion *motions[MOST];
    size_t n;
};

static struct wheels wheels_at(const double *centers, size_t n) {
    struct wheels w = {{NULL}, {NULL}, n};
    for (size_t k = 0; k < n; k++) {
        const double x = centers[2 * k], y = centers[2 * k + 1];
        w.parts[k] = grid(x - 0.5, y - 0.5, 1.0 / SIDE, SIDE, SIDE);
        w.motions[k] = turn(x, y, k % 2 == 0 ? TAU : -TAU);
    }
    return w;
}

static void free_wheels(struct wheels *w) {
    for (size_t k = 0; k < w->n; k++) {
        ko_part_free(w->parts[k]);
        ko_motion_free(w->motions[k]);
    }
}

static int32_t assemble(const struct wheels *w, const ko_pair_options *options, ko_assembly **assembly) {
    const ko_part *parts[MOST];
    const ko_motion *motions[MOST];
    for (size_t k = 0; k < w->n; k++) {
        parts[k] = w->parts[k];
        motions[k] = w->motions[k];
    }
    return ko_assembly_create(parts, motions, w->n, options, assembly);
}

/* No two parts collide, by pairs made one by one, and no cell of any could be added. */
static void check_closed(const struct wheels *w, const uint8_t *cells) {
    ko_pair_options options = options_of(KO_CONFLICTS_OF_OVERLAP, 0);
    uint8_t room[MOST * CELLS];
    memset(room, 1, sizeof room);
    for (size_t i = 0; i < w->n; i++) {
        for (size_t j = i + 1; j < w->n; j++) {
            ko_pair *pair = NULL;
            CHECK(ko_pair_create(w->parts[i], w->motions[i], w->parts[j], w->motions[j], &options, &pair) >= 0);
            size_t lost = 1;
            OK(ko_pair_volumes(pair, cells + i * CELLS, CELLS, cells + j * CELLS, CELLS, NULL, NULL, &lost));
            CHECK(lost == 0);
            /* What the other leaves: part 2 beside this set of part 1, and the other way round. */
            uint8_t one[CELLS], two[CELLS];
            OK(ko_pair_close(pair, cells + i * CELLS, NULL, 1, CELLS, CELLS, one, two, NULL));
            for (size_t c = 0; c < CELLS; c++) {
                room[j * CELLS + c] &= two[c];
            }
            OK(ko_pair_close(pair, NULL, cells + j * CELLS, 2, CELLS, CELLS, one, two, NULL));
            for (size_t c = 0; c < CELLS; c++) {
                room[i * CELLS + c] &= one[c];
            }
            ko_pair_free(pair);
        }
    }
    CHECK(memcmp(room, cells, w->n * CELLS) == 0);
}

static void trains_get_the_best(void) {
    const double centers[8] = {0.0, 0.0, 0.9, 0.0, 1.8, 0.1, 2.7, 0.0};
    struct wheels w = wheels_at(centers, 4);
    ko_pair_options options = options_of(KO_CONFLICTS_OF_OVERLAP, 0);
    ko_assembly *assembly = NULL;
    OK(assemble(&w, &options, &assembly));
    ko_assembly_report report;
    OK(ko_assembly_get_report(assembly, sizeof report, &report));
    CHECK(report.n_parts == 4 && report.dim == 2 && report.n_cells == 4 * CELLS && report.n_meetings == 3);
    CHECK(report.n_edges > 100 && report.graph_bytes > 0);
    size_t meetings[6];
    OK(ko_assembly_copy_meetings(assembly, 3, meetings));
    const size_t right[6] = {0, 1, 1, 2, 2, 3};
    CHECK(memcmp(meetings, right, sizeof right) == 0);

    uint8_t cells[4 * CELLS], again[4 * CELLS];
    double weight = 0.0, bound = 0.0;
    size_t n_cuts = 0;
    OK(ko_assembly_arrange(assembly, NULL, NULL, 4 * CELLS, cells, &weight, &bound, &n_cuts));
    CHECK(weight == bound && n_cuts >= 1);
    CHECK_NEAR(weight, (double)count(cells, 4 * CELLS) / CELLS, 1e-12);
    CHECK(weight > 2.0 && weight < 4.0);
    check_closed(&w, cells);
    OK(ko_assembly_arrange(assembly, NULL, NULL, 4 * CELLS, again, NULL, NULL, NULL));
    CHECK(memcmp(cells, again, sizeof cells) == 0);
    /* What is closed stays what it is, in any order. */
    const size_t order[4] = {3, 1, 0, 2};
    OK(ko_assembly_close(assembly, cells, order, 4 * CELLS, again));
    CHECK(memcmp(cells, again, sizeof cells) == 0);

    /* The first in the order keeps all that it is given. */
    uint8_t all[4 * CELLS];
    memset(all, 1, sizeof all);
    OK(ko_assembly_close(assembly, all, order, 4 * CELLS, again));
    CHECK(count(again + 3 * CELLS, CELLS) == CELLS && count(again + CELLS, CELLS) == CELLS);
    check_closed(&w, again);
    OK(ko_assembly_close(assembly, all, NULL, 4 * CELLS, again));
    CHECK(count(again, CELLS) == CELLS && count(again + CELLS, CELLS) < CELLS);
    check_closed(&w, again);

    /* Weights that leave all to one part. */
    double weights[4 * CELLS];
    for (int i = 0; i < 4 * CELLS; i++) {
        weights[i] = i / CELLS == 1 ? 1.0 : 1e-3;
    }
    OK(ko_assembly_arrange(assembly, weights, NULL, 4 * CELLS, again, &weight, &bound, NULL));
    CHECK(count(again + CELLS, CELLS) == CELLS && weight >= CELLS && weight <= bound);
    check_closed(&w, again);

    /* It refers to neither parts nor motions. */
    free_wheels(&w);
    OK(ko_assembly_arrange(assembly, NULL, NULL, 4 * CELLS, again, NULL, NULL, NULL));
    CHECK(memcmp(cells, again, sizeof cells) == 0);
    ko_assembly_free(assembly);
    ko_assembly_free(NULL);
}

static void three_that_meet_each_other_get_a_bound(void) {
    const double centers[6] = {0.0, 0.0, 0.9, 0.0, 0.45, 0.8};
    struct wheels w = wheels_at(centers, 3);
    ko_assembly *assembly = NULL;
    OK(assemble(&w, NULL, &assembly));
    ko_assembly_report report;
    OK(ko_assembly_get_report(assembly, sizeof report, &report));
    CHECK(report.n_meetings == 3);
    uint8_t cells[3 * CELLS];
    double weight = 0.0, bound = 0.0;
    ko_arrange_options options;
    OK(ko_arrange_options_init(&options, sizeof options));
    OK(ko_assembly_arrange(assembly, NULL, &options, 3 * CELLS, cells, &weight, &bound, NULL));
    CHECK(weight <= bound && weight > 0.8 * bound);
    check_closed(&w, cells);
    options.max_starts = 1;
    options.max_rounds = 1;
    double less = 0.0;
    OK(ko_assembly_arrange(assembly, NULL, &options, 3 * CELLS, cells, &less, NULL, NULL));
    CHECK(less > 0.8 * weight && less <= bound);
    check_closed(&w, cells);
    free_wheels(&w);
    ko_assembly_free(assembly);
}

static void those_far_apart_keep_all(void) {
    const double centers[4] = {0.0, 0.0, 5.0, 0.0};
    struct wheels w = wheels_at(centers, 2);
    ko_assembly *assembly = NULL;
    CHECK(assemble(&w, NULL, &assembly) == KO_NEVER_MEET);
    uint8_t cells[2 * CELLS];
    OK(ko_assembly_arrange(assembly, NULL, NULL, 2 * CELLS, cells, NULL, NULL, NULL));
    CHECK(count(cells, 2 * CELLS) == 2 * CELLS);
    ko_assembly_free(assembly);
    /* Alone, and without a motion. */
    const ko_part *one = w.parts[0];
    const ko_motion *none = NULL;
    CHECK(ko_assembly_create(&one, &none, 1, NULL, &assembly) == KO_NEVER_MEET);
    ko_assembly_free(assembly);
    free_wheels(&w);
}

/* In space: a bar that slides through two blocks, which do not move. */
static void space_is_served(void) {
    const double corners[3][3] = {{0.0, 0.0, 0.0}, {1.0, -1.0, -1.0}, {2.5, -1.0, -1.0}};
    const size_t counts[3][3] = {{2, 2, 2}, {2, 6, 6}, {2, 6, 6}};
    const double along[3] = {3.0, 0.0, 0.0};
    const ko_part *parts[3];
    ko_part *made[3];
    for (int k = 0; k < 3; k++) {
        OK(ko_part_create(3, corners[k], 0.5, counts[k], NULL, 0, &made[k]));
        parts[k] = made[k];
    }
    ko_law law = even(1.0);
    ko_motion *slide = NULL;
    OK(ko_motion_slide(3, along, &law, &slide));
    const ko_motion *motions[3] = {slide, NULL, NULL};
    ko_assembly *assembly = NULL;
    OK(ko_assembly_create(parts, motions, 3, NULL, &assembly));
    uint8_t cells[8 + 72 + 72], all[8 + 72 + 72];
    memset(all, 1, sizeof all);
    /* The bar bores its way: 2 x 2 cells of each layer. */
    OK(ko_assembly_close(assembly, all, NULL, sizeof all, cells));
    CHECK(count(cells, 8) == 8 && count(cells + 8, 72) == 72 - 8 && count(cells + 80, 72) == 72 - 8);
    ko_assembly_free(assembly);
    for (int k = 0; k < 3; k++) {
        ko_part_free(made[k]);
    }
    ko_motion_free(slide);
}

static int32_t cancel(double fraction, const char *stage, void *data) {
    *(int *)data += fraction >= 0.0 && fraction <= 1.0 && stage != NULL;
    return 1;
}

static void what_is_wrong_is_refused(void) {
    const double centers[6] = {0.0, 0.0, 0.9, 0.0, 1.8, 0.0};
    struct wheels w = wheels_at(centers, 3);
    const ko_part *parts[3] = {w.parts[0], w.parts[1], w.parts[2]}, *lacking[2] = {w.parts[0], NULL};
    const ko_motion *motions[3] = {w.motions[0], w.motions[1], w.motions[2]};
    ko_assembly *assembly = STALE(ko_assembly);
    FAILS(ko_assembly_create(NULL, motions, 3, NULL, &assembly), KO_ERR_INVALID_ARGUMENT, "parts is NULL");
    CHECK(assembly == NULL);
    FAILS(ko_assembly_create(parts, NULL, 3, NULL, &assembly), KO_ERR_INVALID_ARGUMENT, "motions is NULL");
    FAILS(ko_assembly_create(parts, motions, 0, NULL, &assembly), KO_ERR_INVALID_ARGUMENT, "n_parts is 0");
    FAILS(ko_assembly_create(parts, motions, 3, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "assembly is NULL");
    FAILS(ko_assembly_create(lacking, motions, 2, NULL, &assembly), KO_ERR_INVALID_ARGUMENT, "parts[1] is NULL");
    ko_pair_options options = options_of(KO_CONFLICTS_OF_OVERLAP, 5);
    FAILS(assemble(&w, &options, &assembly), KO_ERR_INVALID_ARGUMENT, "measure_steps must be 0");
    options = options_of(KO_CONFLICTS_OF_MEASURE, 5);
    FAILS(assemble(&w, &options, &assembly), KO_ERR_INVALID_ARGUMENT, "conflicts of overlap");
    options = options_of(KO_CONFLICTS_OF_OVERLAP, 0);
    options.max_bytes = 100;
    FAILS(assemble(&w, &options, &assembly), KO_ERR_OUT_OF_MEMORY, "bytes");
    int told = 0;
    options = options_of(KO_CONFLICTS_OF_OVERLAP, 0);
    options.progress = cancel;
    options.progress_data = &told;
    FAILS(assemble(&w, &options, &assembly), KO_ERR_CANCELLED, "cancelled");
    CHECK(told == 1 && assembly == NULL);

    /* One of another dimension, and frozen cells that collide. */
    const double corner[3] = {0.0, 0.0, 0.0};
    const size_t counts[3] = {1, 1, 1};
    ko_part *cube = NULL, *frozen[2] = {NULL, NULL};
    OK(ko_part_create(3, corner, 1.0, counts, NULL, 0, &cube));
    const ko_part *mixed[2] = {w.parts[0], cube};
    FAILS(ko_assembly_create(mixed, motions, 2, NULL, &assembly), KO_ERR_INVALID_ARGUMENT, "parts[0] dim 2, parts[1] dim 3");
    const ko_part *solid = cube;
    FAILS(ko_assembly_create(&solid, motions, 1, NULL, &assembly), KO_ERR_INVALID_ARGUMENT, "part 0: a part dim 3, its motion dim 2");
    uint8_t kept[CELLS];
    memset(kept, KO_CELL_FROZEN, sizeof kept);
    const double low[2][2] = {{-0.5, -0.5}, {0.4, -0.5}};
    const size_t side[2] = {SIDE, SIDE};
    for (int k = 0; k < 2; k++) {
        OK(ko_part_create(2, low[k], 1.0 / SIDE, side, kept, CELLS, &frozen[k]));
    }
    const ko_part *cold[3] = {w.parts[2], frozen[0], frozen[1]};
    const ko_motion *of_cold[3] = {w.motions[2], w.motions[0], w.motions[1]};
    FAILS(ko_assembly_create(cold, of_cold, 3, NULL, &assembly), KO_ERR_INVALID_ARGUMENT, "pairs of frozen cells collide: cell 0 of part 1");
    CHECK(strstr(ko_last_error(), "of part 2, at") != NULL && strstr(ko_last_error(), "overlap from time") != NULL);
    ko_part_free(cube);
    ko_part_free(frozen[0]);
    ko_part_free(frozen[1]);

    OK(assemble(&w, NULL, &assembly));
    enum { N = 3 * CELLS };
    uint8_t cells[N], set[N];
    double weights[N], weight = -1.0;
    size_t order[3] = {0, 1, 1}, meetings[4];
    for (int i = 0; i < N; i++) {
        weights[i] = 1.0;
        set[i] = 0;
    }
    memset(cells, 7, sizeof cells);
    FAILS(ko_assembly_copy_meetings(assembly, 1, meetings), KO_ERR_INVALID_ARGUMENT, "n_meetings is 1; the object has 2");
    FAILS(ko_assembly_copy_meetings(assembly, 2, NULL), KO_ERR_INVALID_ARGUMENT, "meetings is NULL");
    FAILS(ko_assembly_close(assembly, set, order, N, cells), KO_ERR_INVALID_ARGUMENT, "[0, 1, 1]");
    FAILS(ko_assembly_close(assembly, set, NULL, N - 1, cells), KO_ERR_INVALID_ARGUMENT, "n_cells");
    FAILS(ko_assembly_close(assembly, NULL, NULL, N, cells), KO_ERR_INVALID_ARGUMENT, "sets is NULL");
    set[CELLS + 3] = 2;
    FAILS(ko_assembly_close(assembly, set, NULL, N, cells), KO_ERR_INVALID_ARGUMENT, "entry 103 of sets is 2");
    weights[2 * CELLS] = -1.0;
    FAILS(ko_assembly_arrange(assembly, weights, NULL, N, cells, &weight, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "weight 200 is -1");
    FAILS(ko_assembly_arrange(assembly, NULL, NULL, N + 1, cells, &weight, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "n_cells");
    FAILS(ko_assembly_arrange(assembly, NULL, NULL, N, NULL, &weight, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "cells is NULL");
    FAILS(ko_assembly_arrange(assembly, NULL, NULL, N, cells, MISALIGNED(&weight), NULL, NULL), KO_ERR_INVALID_ARGUMENT, "weight is at address");
    ko_arrange_options arrange;
    FAILS(ko_arrange_options_init(NULL, sizeof arrange), KO_ERR_INVALID_ARGUMENT, "options");
    OK(ko_arrange_options_init(&arrange, sizeof arrange));
    arrange.max_rounds = 0;
    FAILS(ko_assembly_arrange(assembly, NULL, &arrange, N, cells, &weight, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "0 rounds");
    arrange.max_rounds = 1;
    arrange.progress = cancel;
    arrange.progress_data = &told;
    FAILS(ko_assembly_arrange(assembly, NULL, &arrange, N, cells, &weight, NULL, NULL), KO_ERR_CANCELLED, "cancelled");
    CHECK(weight == -1.0);
    for (int i = 0; i < N; i++) {
        CHECK(cells[i] == 7);
    }
    FAILS(ko_assembly_get_report(assembly, 3, NULL), KO_ERR_INVALID_ARGUMENT, "report");
    FAILS(ko_assembly_get_report(NULL, sizeof(ko_assembly_report), NULL), KO_ERR_INVALID_ARGUMENT, "assembly is NULL");
    ko_assembly_free(assembly);
    free_wheels(&w);
}

int main(void) {
    trains_get_the_best();
    three_that_meet_each_other_get_a_bound();
    those_far_apart_keep_all();
    space_is_served();
    what_is_wrong_is_refused();
    return check_result();
}
