/* What co-generation's calls refuse, and what they say; cancelled work. */

#include "cogen.h"

static const double ZERO[3] = {0.0, 0.0, 0.0}, Z[3] = {0.0, 0.0, 1.0};

static ko_motion *screw(void) {
    ko_law law = even(1.0);
    ko_motion *motion = NULL;
    OK(ko_motion_screw(ZERO, Z, 0.1, &law, &motion));
    return motion;
}

static void laws_and_screws(void) {
    ko_law law, wrong = even(NAN);
    const double infinite[3] = {0.0, INFINITY, 0.0};
    FAILS(ko_law_init(NULL, sizeof law), KO_ERR_INVALID_ARGUMENT, "law");
    FAILS(ko_law_init(&law, 8), KO_ERR_INVALID_ARGUMENT, "struct_size");
    law = even(1.0);
    ko_motion *motion = STALE(ko_motion);
    FAILS(ko_motion_turn(ZERO, NULL, &motion), KO_ERR_INVALID_ARGUMENT, "law is NULL");
    CHECK(motion == NULL);
    FAILS(ko_motion_turn(NULL, &law, &motion), KO_ERR_INVALID_ARGUMENT, "center");
    FAILS(ko_motion_turn(ZERO, &law, NULL), KO_ERR_INVALID_ARGUMENT, "motion");
    FAILS(ko_motion_turn(ZERO, &wrong, &motion), KO_ERR_INVALID_ARGUMENT, "law is not finite");
    FAILS(ko_motion_turn(infinite, &law, &motion), KO_ERR_INVALID_ARGUMENT, "finite");
    law.n_waves = 2;
    FAILS(ko_motion_turn(ZERO, &law, &motion), KO_ERR_INVALID_ARGUMENT, "waves is NULL");
    law = even(1.0);
    law.struct_size = 3;
    FAILS(ko_motion_turn(ZERO, &law, &motion), KO_ERR_INVALID_ARGUMENT, "struct_size 3");
    law = even(1.0);
    FAILS(ko_motion_slide(4, ZERO, &law, &motion), KO_ERR_INVALID_ARGUMENT, "dim is 4");
    FAILS(ko_motion_slide(3, NULL, &law, &motion), KO_ERR_INVALID_ARGUMENT, "along");
    FAILS(ko_motion_slide(3, infinite, &law, &motion), KO_ERR_INVALID_ARGUMENT, "finite");
    FAILS(ko_motion_slide(3, ZERO, NULL, &motion), KO_ERR_INVALID_ARGUMENT, "law");
    FAILS(ko_motion_slide(2, ZERO, &law, NULL), KO_ERR_INVALID_ARGUMENT, "motion");
    FAILS(ko_motion_screw(NULL, Z, 0.0, &law, &motion), KO_ERR_INVALID_ARGUMENT, "point");
    FAILS(ko_motion_screw(ZERO, NULL, 0.0, &law, &motion), KO_ERR_INVALID_ARGUMENT, "axis");
    FAILS(ko_motion_screw(ZERO, ZERO, 0.0, &law, &motion), KO_ERR_INVALID_ARGUMENT, "no direction");
    FAILS(ko_motion_screw(ZERO, Z, NAN, &law, &motion), KO_ERR_INVALID_ARGUMENT, "finite");
    FAILS(ko_motion_screw(ZERO, Z, 0.0, NULL, &motion), KO_ERR_INVALID_ARGUMENT, "law");
    FAILS(ko_motion_screw(ZERO, Z, 0.0, &law, NULL), KO_ERR_INVALID_ARGUMENT, "motion");
    CHECK(motion == NULL);
}

struct poses {
    int bad;
    int kind;
    int asked;
};

/* Turns by 0.1 a pose; pose `bad` is wrong in the way that is asked for. */
static int32_t pose(double time, double *rotation, double *translation, void *data) {
    struct poses *poses = data;
    const int k = poses->asked++;
    const double w = (k == poses->bad && poses->kind == 2 ? 3.1 : 0.0) + 0.1 * k;
    const double right[4] = {cos(w), -sin(w), sin(w), cos(w)};
    if (k == poses->bad && poses->kind == 0) {
        return 7;
    }
    memcpy(rotation, right, sizeof right);
    translation[0] = time;
    if (k == poses->bad && poses->kind == 3) {
        rotation[0] += 0.01;
    }
    if (k != poses->bad || poses->kind != 1) {
        translation[1] = 0.0;
    }
    return 0;
}

static void poses_that_are_none(void) {
    ko_motion *motion = STALE(ko_motion);
    double r[12] = {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, t[6] = {0};
    OK(ko_motion_sampled(2, r, t, 3, &motion));
    ko_motion_free(motion);
    FAILS(ko_motion_sampled(2, r, t, 1, &motion), KO_ERR_INVALID_ARGUMENT, "1 poses");
    FAILS(ko_motion_sampled(2, r, t, 0, &motion), KO_ERR_INVALID_ARGUMENT, "0 poses");
    FAILS(ko_motion_sampled(5, r, t, 3, &motion), KO_ERR_INVALID_ARGUMENT, "dim is 5");
    FAILS(ko_motion_sampled(2, NULL, t, 3, &motion), KO_ERR_INVALID_ARGUMENT, "rotations");
    FAILS(ko_motion_sampled(2, r, NULL, 3, &motion), KO_ERR_INVALID_ARGUMENT, "translations");
    FAILS(ko_motion_sampled(2, r, t, 3, NULL), KO_ERR_INVALID_ARGUMENT, "motion");
    r[8] = 1.01;
    FAILS(ko_motion_sampled(2, r, t, 3, &motion), KO_ERR_INVALID_ARGUMENT, "pose 2: the pose is not rigid: R^T R is off the identity by 2.010e-2");
    r[8] = 1.0;
    r[4] = -1.0;
    FAILS(ko_motion_sampled(2, r, t, 3, &motion), KO_ERR_INVALID_ARGUMENT, "pose 1: the pose mirrors");
    r[7] = -1.0;
    FAILS(ko_motion_sampled(2, r, t, 3, &motion), KO_ERR_INVALID_ARGUMENT, "from pose 0 to pose 1 the part turns by");
    r[4] = r[7] = 1.0;
    t[5] = NAN;
    FAILS(ko_motion_sampled(2, r, t, 3, &motion), KO_ERR_INVALID_ARGUMENT, "pose 2: an entry of the pose is not finite");
    FAILS(ko_motion_fixed(2, r, t + 4, &motion), KO_ERR_INVALID_ARGUMENT, "not finite");
    r[0] = 2.0;
    FAILS(ko_motion_fixed(2, r, NULL, &motion), KO_ERR_INVALID_ARGUMENT, "off the identity by 3");
    FAILS(ko_motion_fixed(1, NULL, NULL, &motion), KO_ERR_INVALID_ARGUMENT, "dim is 1");
    FAILS(ko_motion_fixed(2, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "motion");
    CHECK(motion == NULL);

    const char *const words[4] = {"pose 3, at time 0.3: the function returned 7", "pose 3, at time 0.3: an entry of the pose is not finite",
                                  "from pose 2 to pose 3", "pose 3, at time 0.3: the pose is not rigid"};
    for (int kind = 0; kind < 4; kind++) {
        struct poses poses = {3, kind, 0};
        FAILS(ko_motion_from_function(2, pose, &poses, 11, NULL, 0.0, &motion), KO_ERR_INVALID_ARGUMENT, words[kind]);
        CHECK(motion == NULL && poses.asked == (kind == 2 ? 11 : 4));
    }
    struct poses poses = {-1, 0, 0};
    FAILS(ko_motion_from_function(2, NULL, &poses, 11, NULL, 0.0, &motion), KO_ERR_INVALID_ARGUMENT, "pose is NULL");
    FAILS(ko_motion_from_function(2, pose, &poses, 0, NULL, 0.0, &motion), KO_ERR_INVALID_ARGUMENT, "0 poses");
    FAILS(ko_motion_from_function(0, pose, &poses, 11, NULL, 0.0, &motion), KO_ERR_INVALID_ARGUMENT, "dim is 0");
    FAILS(ko_motion_from_function(2, pose, &poses, 11, NULL, 0.0, NULL), KO_ERR_INVALID_ARGUMENT, "motion");
    FAILS(ko_motion_from_function(2, pose, &poses, SIZE_MAX / 2, NULL, 0.0, &motion), KO_ERR_OUT_OF_MEMORY, "poses");

    /* Half a turn in ten steps moves a corner by 0.3 of the diagonal, or not so much. */
    const size_t one[3] = {1, 1, 1};
    const double corner[3] = {0.0, 0.0, 0.0};
    ko_part *part = NULL, *cube = NULL;
    OK(ko_part_create(2, corner, 1.0, one, NULL, 0, &part));
    OK(ko_part_create(3, corner, 1.0, one, NULL, 0, &cube));
    struct poses turning = {-1, 0, 0};
    OK(ko_motion_from_function(2, pose, &turning, 11, part, 100.0, &motion));
    ko_motion_free(motion);
    FAILS(ko_motion_from_function(2, pose, &turning, 11, part, 1e-3, &motion), KO_ERR_INVALID_ARGUMENT, "the motion jumps: from time 0 to time 0.1");
    FAILS(ko_motion_from_function(2, pose, &turning, 11, part, -1.0, &motion), KO_ERR_INVALID_ARGUMENT, "a limit of speed of -1");
    FAILS(ko_motion_from_function(2, pose, &turning, 11, NULL, 1.0, &motion), KO_ERR_INVALID_ARGUMENT, "max_speed is 1 and part is NULL");
    FAILS(ko_motion_from_function(2, pose, &turning, 11, cube, 1.0, &motion), KO_ERR_INVALID_ARGUMENT, "the motion dim 2, part dim 3");
    ko_part_free(part);
    ko_part_free(cube);

    /* Products of products: each one of twice as many. */
    ko_motion *whole = turn(0.0, 0.0, 1e-3), *twice = NULL;
    for (int k = 0; k < 9; k++) {
        OK(ko_motion_product(whole, whole, &twice));
        ko_motion_free(whole);
        whole = twice;
    }
    FAILS(ko_motion_product(whole, whole, &motion), KO_ERR_INVALID_ARGUMENT, "a product of 1024 motions; at most 1000");
    ko_motion_free(whole);
}

static void mechanisms_that_are_none(void) {
    ko_motion *a = STALE(ko_motion), *b = STALE(ko_motion), *c = STALE(ko_motion);
    const double centers[4] = {0.0, 0.0, 3.0, 0.0}, pivots[4] = {0.0, 0.0, 1.0, 0.0}, lengths[3] = {0.3, 0.9, 0.7};
    FAILS(ko_motion_gears(centers, 1.0, 0.0, &a, &b), KO_ERR_INVALID_ARGUMENT, "ratio of 0");
    CHECK(a == NULL && b == NULL);
    FAILS(ko_motion_gears(centers, NAN, 1.0, &a, &b), KO_ERR_INVALID_ARGUMENT, "finite");
    FAILS(ko_motion_gears(NULL, 1.0, 1.0, &a, &b), KO_ERR_INVALID_ARGUMENT, "centers");
    FAILS(ko_motion_gears(centers, 1.0, 1.0, NULL, &b), KO_ERR_INVALID_ARGUMENT, "first");
    FAILS(ko_motion_gears(centers, 1.0, 1.0, &a, NULL), KO_ERR_INVALID_ARGUMENT, "second");
    FAILS(ko_motion_four_bar(pivots, lengths, 0.0, 6.0, 0, 50, &a, &b, &c), KO_ERR_INVALID_ARGUMENT, "bend is 0");
    CHECK(c == NULL);
    const double no_length[3] = {0.3, 0.0, 0.7}, too_short[3] = {0.9, 0.3, 0.4};
    FAILS(ko_motion_four_bar(pivots, no_length, 0.0, 6.0, 1, 50, &a, &b, &c), KO_ERR_INVALID_ARGUMENT, "coupler is 0 long");
    FAILS(ko_motion_four_bar(pivots, too_short, 0.0, 6.0, 1, 50, &a, &b, &c), KO_ERR_INVALID_ARGUMENT, "does not close");
    FAILS(ko_motion_four_bar(pivots, lengths, 0.0, 6.0, 1, 0, &a, &b, &c), KO_ERR_INVALID_ARGUMENT, "0 steps");
    FAILS(ko_motion_four_bar(pivots, lengths, 0.0, 6.0, 1, 1, &a, &b, &c), KO_ERR_INVALID_ARGUMENT, "by 6 rad in 1 steps");
    FAILS(ko_motion_four_bar(NULL, lengths, 0.0, 6.0, 1, 50, &a, &b, &c), KO_ERR_INVALID_ARGUMENT, "pivots");
    FAILS(ko_motion_four_bar(pivots, NULL, 0.0, 6.0, 1, 50, &a, &b, &c), KO_ERR_INVALID_ARGUMENT, "lengths");
    FAILS(ko_motion_four_bar(pivots, lengths, 0.0, 6.0, 1, 50, NULL, &b, &c), KO_ERR_INVALID_ARGUMENT, "crank");
    FAILS(ko_motion_four_bar(pivots, lengths, 0.0, 6.0, 1, 50, &a, NULL, &c), KO_ERR_INVALID_ARGUMENT, "coupler");
    FAILS(ko_motion_four_bar(pivots, lengths, 0.0, 6.0, 1, 50, &a, &b, NULL), KO_ERR_INVALID_ARGUMENT, "rocker");
    FAILS(ko_motion_four_bar(pivots, lengths, NAN, 6.0, 1, 50, &a, &b, &c), KO_ERR_INVALID_ARGUMENT, "from NaN");
    FAILS(ko_motion_four_bar(pivots, lengths, 0.0, 6.0, 1, SIZE_MAX / 2, &a, &b, &c), KO_ERR_OUT_OF_MEMORY, "linkage");

    ko_motion *plane = turn(0.0, 0.0, 1.0), *space = screw();
    FAILS(ko_motion_product(plane, space, &a), KO_ERR_INVALID_ARGUMENT, "outer dim 2, inner dim 3");
    FAILS(ko_motion_product(NULL, space, &a), KO_ERR_INVALID_ARGUMENT, "outer");
    FAILS(ko_motion_product(plane, NULL, &a), KO_ERR_INVALID_ARGUMENT, "inner");
    FAILS(ko_motion_product(plane, plane, NULL), KO_ERR_INVALID_ARGUMENT, "motion");
    FAILS(ko_motion_inverse(NULL, &a), KO_ERR_INVALID_ARGUMENT, "of is NULL");
    FAILS(ko_motion_inverse(plane, NULL), KO_ERR_INVALID_ARGUMENT, "motion");
    uint32_t dim;
    FAILS(ko_motion_get_dim(NULL, &dim), KO_ERR_INVALID_ARGUMENT, "motion");
    FAILS(ko_motion_get_dim(plane, NULL), KO_ERR_INVALID_ARGUMENT, "dim");
    double times[2] = {0.5, 1.5}, r[8], t[4];
    FAILS(ko_motion_eval(plane, times, 2, r, t), KO_ERR_INVALID_ARGUMENT, "time 1 is 1.5; it must be in [0, 1]");
    times[0] = NAN;
    FAILS(ko_motion_eval(plane, times, 2, r, t), KO_ERR_INVALID_ARGUMENT, "time 0 is NaN");
    FAILS(ko_motion_eval(NULL, times, 2, r, t), KO_ERR_INVALID_ARGUMENT, "motion");
    FAILS(ko_motion_eval(plane, NULL, 2, r, t), KO_ERR_INVALID_ARGUMENT, "times");
    FAILS(ko_motion_eval(plane, times, 2, NULL, t), KO_ERR_INVALID_ARGUMENT, "rotations");
    FAILS(ko_motion_eval(plane, times, 2, r, NULL), KO_ERR_INVALID_ARGUMENT, "translations");
    OK(ko_motion_eval(plane, NULL, 0, NULL, NULL));
    ko_motion_free(plane);
    ko_motion_free(space);
    ko_motion_free(NULL);
}

/* n^2 cells. */
static ko_part *square(double x, size_t n) { return grid(x, -0.5, 1.0 / (double)n, n, n); }

static void parts_that_are_none(void) {
    const size_t counts[3] = {2, 2, 2}, none[2] = {2, 0}, many[2] = {1u << 20, 1u << 20};
    const double wrong[2] = {0.0, NAN};
    uint8_t cells[8] = {0, 1, 2, 0, 1, 3, 0, 0};
    ko_part *part = STALE(ko_part);
    FAILS(ko_part_create(2, ZERO, 0.0, counts, NULL, 0, &part), KO_ERR_INVALID_ARGUMENT, "edge 0");
    CHECK(part == NULL);
    FAILS(ko_part_create(2, ZERO, 1.0, none, NULL, 0, &part), KO_ERR_INVALID_ARGUMENT, "axis 1");
    FAILS(ko_part_create(2, ZERO, 1.0, many, NULL, 0, &part), KO_ERR_INVALID_ARGUMENT, "may have");
    FAILS(ko_part_create(2, wrong, 1.0, counts, NULL, 0, &part), KO_ERR_INVALID_ARGUMENT, "corner");
    FAILS(ko_part_create(2, NULL, 1.0, counts, NULL, 0, &part), KO_ERR_INVALID_ARGUMENT, "corner");
    FAILS(ko_part_create(2, ZERO, 1.0, NULL, NULL, 0, &part), KO_ERR_INVALID_ARGUMENT, "counts");
    FAILS(ko_part_create(2, ZERO, 1.0, counts, NULL, 4, &part), KO_ERR_INVALID_ARGUMENT, "cells");
    FAILS(ko_part_create(2, ZERO, 1.0, counts, cells, 3, &part), KO_ERR_INVALID_ARGUMENT, "3 cells for a grid of 4");
    FAILS(ko_part_create(3, ZERO, 1.0, counts, cells, 8, &part), KO_ERR_INVALID_ARGUMENT, "cell 5 is 3");
    FAILS(ko_part_create(7, ZERO, 1.0, counts, NULL, 0, &part), KO_ERR_INVALID_ARGUMENT, "dim is 7");
    FAILS(ko_part_create(2, ZERO, 1.0, counts, NULL, 0, NULL), KO_ERR_INVALID_ARGUMENT, "part");
    part = square(0.0, 3);
    double out[9], before[9] = {4, 4, 4, 4, 4, 4, 4, 4, 4};
    memcpy(out, before, sizeof out);
    const double low[2] = {0.0, 0.0}, high[2] = {1.0, -1.0}, ends[4] = {1, 1, 1, 1};
    ko_mesh *cube = check_cube();
    ko_field *space = check_made_field(3), *plane = check_made_field(2);
    size_t n = 0, sizes[2];
    double edge;
    uint32_t dim;
    FAILS(ko_part_get_size(NULL, &dim, &n), KO_ERR_INVALID_ARGUMENT, "part");
    FAILS(ko_part_get_size(part, &dim, MISALIGNED(&n)), KO_ERR_INVALID_ARGUMENT, "n_cells");
    FAILS(ko_part_get_grid(NULL, out, &edge, sizes), KO_ERR_INVALID_ARGUMENT, "part");
    FAILS(ko_part_get_grid(part, out, MISALIGNED(&edge), sizes), KO_ERR_INVALID_ARGUMENT, "cell_edge");
    FAILS(ko_part_copy_cells(part, 8, cells), KO_ERR_INVALID_ARGUMENT, "n_cells is 8; the object has 9");
    FAILS(ko_part_copy_cells(NULL, 8, cells), KO_ERR_INVALID_ARGUMENT, "part");
    FAILS(ko_part_copy_cells(part, 9, NULL), KO_ERR_INVALID_ARGUMENT, "cells");
    FAILS(ko_part_fractions_of_mesh(part, cube, 2, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "the part dim 2, the mesh dim 3");
    FAILS(ko_part_fractions_of_mesh(part, NULL, 2, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "mesh");
    FAILS(ko_part_fractions_of_mesh(NULL, cube, 2, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "part");
    FAILS(ko_part_fractions_of_field(part, space, 2.0, 2, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "the field dim 3");
    FAILS(ko_part_fractions_of_field(part, plane, 0.0, 2, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "steepness of 0");
    FAILS(ko_part_fractions_of_field(part, NULL, 2.0, 2, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "field");
    FAILS(ko_part_fractions_of_field(NULL, plane, 2.0, 2, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "part");
    FAILS(ko_part_fractions_of_box(part, low, high, 2, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "along axis 1 the box goes from 0 to -1");
    FAILS(ko_part_fractions_of_box(part, NULL, high, 2, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "box_min");
    FAILS(ko_part_fractions_of_box(part, low, NULL, 2, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "box_max");
    FAILS(ko_part_fractions_of_box(NULL, low, high, 2, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "part");
    FAILS(ko_part_fractions_of_ball(part, low, 0.0, 2, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "radius is 0");
    FAILS(ko_part_fractions_of_ball(part, wrong, 1.0, 2, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "NaN");
    FAILS(ko_part_fractions_of_ball(part, NULL, 1.0, 2, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "center");
    FAILS(ko_part_fractions_of_ball(NULL, low, 1.0, 2, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "part");
    FAILS(ko_part_fractions_of_ball(part, low, 1.0, 0, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "0 samples");
    FAILS(ko_part_fractions_of_ball(part, low, 1.0, 65, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "65 samples");
    FAILS(ko_part_fractions_of_ball(part, low, 1.0, 2, 2000, 9, out), KO_ERR_INVALID_ARGUMENT, "n_threads");
    FAILS(ko_part_fractions_of_ball(part, low, 1.0, 2, 1, 8, out), KO_ERR_INVALID_ARGUMENT, "8 fractions for a grid of 9");
    FAILS(ko_part_fractions_of_ball(part, low, 1.0, 2, 1, 9, NULL), KO_ERR_INVALID_ARGUMENT, "fractions");
    FAILS(ko_part_fractions_of_cylinder(part, ends, 1.0, 2, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "one point");
    FAILS(ko_part_fractions_of_cylinder(part, NULL, 1.0, 2, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "ends");
    FAILS(ko_part_fractions_of_cylinder(NULL, ends, 1.0, 2, 1, 9, out), KO_ERR_INVALID_ARGUMENT, "part");
    CHECK(memcmp(out, before, sizeof out) == 0);
    ko_field_free(space);
    ko_field_free(plane);
    ko_mesh_free(cube);
    ko_part_free(part);
    ko_part_free(NULL);
}

static int32_t stop(double fraction, const char *stage, void *data) {
    (void)fraction;
    (void)stage;
    (void)data;
    return 1;
}

/* Cancelled in the `data`-th call. */
static int32_t stop_later(double fraction, const char *stage, void *data) {
    (void)fraction;
    (void)stage;
    return --*(int *)data <= 0;
}

enum { N = 4, CELLS = 16 };

static void sweeps_that_are_none(void) {
    ko_part *a = square(-0.5, N), *b = square(0.4, N), *space = NULL;
    ko_motion *motion = turn(0.0, 0.0, 1.0), *in_space = screw();
    const size_t counts[3] = {2, 2, 2};
    OK(ko_part_create(3, ZERO, 1.0, counts, NULL, 0, &space));
    uint8_t out[CELLS], before[CELLS], set[CELLS] = {0};
    memset(out, 1, CELLS);
    memcpy(before, out, CELLS);
    ko_pair_options o;
    OK(ko_pair_options_init(&o, sizeof o));
    o.n_threads = 1;
    FAILS(ko_part_sweep(NULL, NULL, 0, motion, b, NULL, &o, CELLS, out), KO_ERR_INVALID_ARGUMENT, "part");
    FAILS(ko_part_sweep(a, NULL, 0, motion, NULL, NULL, &o, CELLS, out), KO_ERR_INVALID_ARGUMENT, "still");
    FAILS(ko_part_sweep(a, NULL, 0, motion, space, NULL, &o, 8, out), KO_ERR_INVALID_ARGUMENT, "still dim 3");
    FAILS(ko_part_sweep(a, NULL, 0, in_space, b, NULL, &o, CELLS, out), KO_ERR_INVALID_ARGUMENT, "its motion dim 3");
    FAILS(ko_part_sweep(a, set, 5, motion, b, NULL, &o, CELLS, out), KO_ERR_INVALID_ARGUMENT, "n_cells is 5");
    FAILS(ko_part_sweep(a, NULL, 0, motion, b, NULL, &o, 5, out), KO_ERR_INVALID_ARGUMENT, "n_still is 5");
    FAILS(ko_part_sweep(a, NULL, 0, motion, b, NULL, &o, CELLS, NULL), KO_ERR_INVALID_ARGUMENT, "swept");
    o.clearance = 0.1;
    FAILS(ko_part_sweep(a, NULL, 0, motion, b, NULL, &o, CELLS, out), KO_ERR_INVALID_ARGUMENT, "clearance is 0.1");
    o.clearance = -1.0;
    FAILS(ko_part_unsweep(a, motion, b, NULL, 0, NULL, KO_AVOID, &o, CELLS, out), KO_ERR_INVALID_ARGUMENT, "clearance of -1");
    o.clearance = 0.0;
    FAILS(ko_part_unsweep(a, motion, b, NULL, 0, NULL, 2, &o, CELLS, out), KO_ERR_INVALID_ARGUMENT, "rule is 2");
    FAILS(ko_part_unsweep(a, motion, b, set, 3, NULL, KO_AVOID, &o, CELLS, out), KO_ERR_INVALID_ARGUMENT, "n_body is 3");
    FAILS(ko_part_unsweep(a, motion, b, NULL, 0, NULL, KO_AVOID, &o, 3, out), KO_ERR_INVALID_ARGUMENT, "n_cells is 3");
    FAILS(ko_part_unsweep(a, motion, b, NULL, 0, in_space, KO_AVOID, &o, CELLS, out), KO_ERR_INVALID_ARGUMENT, "its motion");
    FAILS(ko_part_unsweep(a, motion, space, NULL, 0, NULL, KO_AVOID, &o, CELLS, out), KO_ERR_INVALID_ARGUMENT, "body dim 3");
    FAILS(ko_part_unsweep(NULL, motion, b, NULL, 0, NULL, KO_AVOID, &o, CELLS, out), KO_ERR_INVALID_ARGUMENT, "part");
    FAILS(ko_part_unsweep(a, motion, NULL, NULL, 0, NULL, KO_AVOID, &o, CELLS, out), KO_ERR_INVALID_ARGUMENT, "body");
    FAILS(ko_part_unsweep(a, motion, b, NULL, 0, NULL, KO_AVOID, &o, CELLS, NULL), KO_ERR_INVALID_ARGUMENT, "kept");
    o.slack = 0.0;
    FAILS(ko_part_unsweep(a, motion, b, NULL, 0, NULL, KO_AVOID, &o, CELLS, out), KO_ERR_INVALID_ARGUMENT, "slack of 0");
    o.slack = 0.05;
    o.progress = stop;
    FAILS(ko_part_unsweep(a, motion, b, NULL, 0, NULL, KO_AVOID, &o, CELLS, out), KO_ERR_CANCELLED, "cancelled");
    FAILS(ko_part_sweep(a, NULL, 0, motion, b, NULL, &o, CELLS, out), KO_ERR_CANCELLED, "cancelled");
    CHECK(memcmp(out, before, CELLS) == 0);
    set[4] = 2;
    FAILS(ko_part_sweep(a, set, CELLS, motion, b, NULL, NULL, CELLS, out), KO_ERR_INVALID_ARGUMENT, "entry 4 of cells is 2");
    FAILS(ko_part_unsweep(a, motion, b, set, CELLS, NULL, KO_AVOID, NULL, CELLS, out), KO_ERR_INVALID_ARGUMENT, "entry 4 of body_cells is 2");
    FAILS(ko_part_unsweep(a, motion, b, NULL, 0, NULL, KO_AVOID, NULL, CELLS, set), KO_ERR_INVALID_ARGUMENT, "entry 4 of kept is 2");
    ko_part_free(a);
    ko_part_free(b);
    ko_part_free(space);
    ko_motion_free(motion);
    ko_motion_free(in_space);
}

static void pairs_that_are_none(void) {
    ko_part *a = square(-0.5, N), *b = square(0.4, N), *space = NULL, *far_off = square(100.0, N);
    ko_motion *motion = turn(0.0, 0.0, 6.0), *other = turn(0.9, 0.0, -6.0), *in_space = screw();
    const size_t counts[3] = {2, 2, 2};
    OK(ko_part_create(3, ZERO, 1.0, counts, NULL, 0, &space));
    ko_pair *pair = STALE(ko_pair);
    ko_pair_options o = options_of(KO_CONFLICTS_OF_OVERLAP, 10);
    FAILS(ko_pair_create(NULL, motion, b, other, &o, &pair), KO_ERR_INVALID_ARGUMENT, "part_1");
    CHECK(pair == NULL);
    FAILS(ko_pair_create(a, motion, NULL, other, &o, &pair), KO_ERR_INVALID_ARGUMENT, "part_2");
    FAILS(ko_pair_create(a, motion, b, other, &o, NULL), KO_ERR_INVALID_ARGUMENT, "pair");
    FAILS(ko_pair_create(a, motion, space, other, &o, &pair), KO_ERR_INVALID_ARGUMENT, "part_2 dim 3");
    FAILS(ko_pair_create(a, in_space, b, other, &o, &pair), KO_ERR_INVALID_ARGUMENT, "its motion dim 3");
    o.max_bytes = 100;
    FAILS(ko_pair_create(a, motion, b, other, &o, &pair), KO_ERR_OUT_OF_MEMORY, "the limit is 100 bytes");
    o = options_of(KO_CONFLICTS_OF_OVERLAP, 0);
    o.max_bytes = 10;
    FAILS(ko_pair_create(a, motion, b, other, &o, &pair), KO_ERR_OUT_OF_MEMORY, "the conflict graph, which would fit with cells about");
    o = options_of(KO_CONFLICTS_OF_OVERLAP, 0);
    o.slack = NAN;
    FAILS(ko_pair_create(a, motion, b, other, &o, &pair), KO_ERR_INVALID_ARGUMENT, "slack");
    o.n_steps = 20000000;
    FAILS(ko_pair_create(a, motion, b, other, &o, &pair), KO_ERR_INVALID_ARGUMENT, "more than 10000000 steps");
    o = options_of(KO_CONFLICTS_OF_OVERLAP, 20000000);
    FAILS(ko_pair_create(a, motion, b, other, &o, &pair), KO_ERR_INVALID_ARGUMENT, "20000000 steps of time");
    o = options_of(3, 10);
    FAILS(ko_pair_create(a, motion, b, other, &o, &pair), KO_ERR_INVALID_ARGUMENT, "conflicts is 3");
    o = options_of(KO_CONFLICTS_NONE, 0);
    FAILS(ko_pair_create(a, motion, b, other, &o, &pair), KO_ERR_INVALID_ARGUMENT, "measure_steps is 0");
    o = options_of(KO_CONFLICTS_OF_MEASURE, 0);
    FAILS(ko_pair_create(a, motion, b, other, &o, &pair), KO_ERR_INVALID_ARGUMENT, "measure_steps is 0");
    o = options_of(KO_CONFLICTS_OF_MEASURE, 10);
    o.clearance = 0.1;
    FAILS(ko_pair_create(a, motion, b, other, &o, &pair), KO_ERR_INVALID_ARGUMENT, "clearance is 0.1");
    o = options_of(KO_CONFLICTS_OF_OVERLAP, 0);
    o.clearance = -0.1;
    FAILS(ko_pair_create(a, motion, b, other, &o, &pair), KO_ERR_INVALID_ARGUMENT, "clearance of -0.1");
    o = options_of(KO_CONFLICTS_OF_OVERLAP, 0);
    o.n_threads = 5000;
    FAILS(ko_pair_create(a, motion, b, other, &o, &pair), KO_ERR_INVALID_ARGUMENT, "n_threads");
    o.struct_size = 4;
    FAILS(ko_pair_create(a, motion, b, other, &o, &pair), KO_ERR_INVALID_ARGUMENT, "struct_size 4");
    FAILS(ko_pair_options_init(NULL, sizeof o), KO_ERR_INVALID_ARGUMENT, "options");
    FAILS(ko_pair_options_init(&o, 8), KO_ERR_INVALID_ARGUMENT, "struct_size");
    o = options_of(KO_CONFLICTS_OF_OVERLAP, 10);
    for (int calls = 1; calls <= 3; calls++) {
        int left = calls;
        o.progress = stop_later;
        o.progress_data = &left;
        FAILS(ko_pair_create(a, motion, b, other, &o, &pair), KO_ERR_CANCELLED, "cancelled");
        CHECK(pair == NULL && left == 0);
    }
    /* Parts that never meet: a pair with nothing in it, and a remark. */
    o = options_of(KO_CONFLICTS_OF_OVERLAP, 10);
    CHECK(ko_pair_create(a, motion, far_off, NULL, &o, &pair) == KO_NEVER_MEET);
    CHECK(strcmp(ko_status_string(KO_NEVER_MEET), "KO_NEVER_MEET") == 0);
    ko_pair_report report;
    OK(ko_pair_get_report(pair, sizeof report, &report));
    CHECK(report.n_edges == 0 && report.n_visits == 0 && report.n_colliding[0] == 0);
    FAILS(ko_pair_get_report(NULL, sizeof report, &report), KO_ERR_INVALID_ARGUMENT, "pair");
    FAILS(ko_pair_get_report(pair, sizeof report, NULL), KO_ERR_INVALID_ARGUMENT, "report");
    FAILS(ko_pair_get_report(pair, 9, &report), KO_ERR_INVALID_ARGUMENT, "struct_size 9");
    ko_pair_free(pair);
    /* Frozen cells that collide: which, when and where. Part 2's cell 5 has its centre at (0.4, 0) + (0.375, -0.125). */
    uint8_t cells[CELLS];
    memset(cells, KO_CELL_FREE, CELLS);
    ko_part *frozen[2] = {NULL, NULL};
    const double corner_a[2] = {-0.5, -0.5}, corner_b[2] = {0.4, -0.5};
    const size_t n[2] = {N, N};
    cells[13] = KO_CELL_FROZEN;
    OK(ko_part_create(2, corner_a, 0.25, n, cells, CELLS, &frozen[0]));
    cells[13] = KO_CELL_FREE;
    cells[1] = KO_CELL_FROZEN;
    OK(ko_part_create(2, corner_b, 0.25, n, cells, CELLS, &frozen[1]));
    o = options_of(KO_CONFLICTS_OF_OVERLAP, 0);
    FAILS(ko_pair_create(frozen[0], NULL, frozen[1], NULL, &o, &pair), KO_ERR_INVALID_ARGUMENT,
          "1 pair of frozen cells collides: cell 13 of part 1, at (0.375, -0.125), and cell 1 of part 2");
    CHECK(strstr(ko_last_error(), "overlap from time 0 on, at (0.45, -0.125) in part 1's frame") != NULL);
    ko_part_free(frozen[0]);
    ko_part_free(frozen[1]);
    ko_part_free(a);
    ko_part_free(b);
    ko_part_free(space);
    ko_part_free(far_off);
    ko_motion_free(motion);
    ko_motion_free(other);
    ko_motion_free(in_space);
    ko_pair_free(NULL);
}

static void calls_on_pairs(void) {
    ko_part *a = square(-0.5, N), *b = square(0.4, N);
    ko_motion *motion = turn(0.0, 0.0, 6.0), *other = turn(0.9, 0.0, -6.0);
    ko_pair *both = NULL, *graph = NULL, *measures = NULL;
    ko_pair_options o = options_of(KO_CONFLICTS_OF_OVERLAP, 10);
    OK(ko_pair_create(a, motion, b, other, &o, &both));
    o = options_of(KO_CONFLICTS_OF_OVERLAP, 0);
    OK(ko_pair_create(a, motion, b, other, &o, &graph));
    o = options_of(KO_CONFLICTS_NONE, 10);
    OK(ko_pair_create(a, motion, b, other, &o, &measures));
    double r1[CELLS], r2[CELLS], x[CELLS], y[CELLS], z[CELLS], w[CELLS], g = 5.0, h = 5.0;
    for (int i = 0; i < CELLS; i++) {
        r1[i] = r2[i] = 0.5;
    }
    const size_t n = CELLS;
    FAILS(ko_pair_measures(NULL, r1, n, r2, n, 1, &g, &h), KO_ERR_INVALID_ARGUMENT, "pair");
    FAILS(ko_pair_measures(graph, r1, n, r2, n, 1, &g, &h), KO_ERR_INVALID_ARGUMENT, "no measures");
    FAILS(ko_pair_measures(both, NULL, n, r2, n, 1, &g, &h), KO_ERR_INVALID_ARGUMENT, "densities_1");
    FAILS(ko_pair_measures(both, r1, n, NULL, n, 1, &g, &h), KO_ERR_INVALID_ARGUMENT, "densities_2");
    FAILS(ko_pair_measures(both, r1, 3, r2, n, 1, &g, &h), KO_ERR_INVALID_ARGUMENT, "3 densities for part 1's 16 cells");
    FAILS(ko_pair_measures(both, r1, n, r2, 4, 1, &g, &h), KO_ERR_INVALID_ARGUMENT, "4 densities for part 2's 16 cells");
    FAILS(ko_pair_measures(both, r1, n, r2, n, 2000, &g, &h), KO_ERR_INVALID_ARGUMENT, "n_threads");
    FAILS(ko_pair_measures(both, r1, n, r2, n, 1, MISALIGNED(&g), &h), KO_ERR_INVALID_ARGUMENT, "g21");
    FAILS(ko_pair_measures(both, r1, n, r2, n, 1, &g, MISALIGNED(&h)), KO_ERR_INVALID_ARGUMENT, "g12");
    r2[7] = NAN;
    FAILS(ko_pair_measures(both, r1, n, r2, n, 1, &g, &h), KO_ERR_INVALID_ARGUMENT, "density 7 of part 2 is NaN");
    FAILS(ko_pair_local_measures(both, r1, n, r2, n, 1, x, y), KO_ERR_INVALID_ARGUMENT, "density 7 of part 2 is NaN");
    FAILS(ko_pair_sensitivities(both, r1, n, r2, n, 1, x, y, z, w), KO_ERR_INVALID_ARGUMENT, "density 7 of part 2 is NaN");
    r2[7] = 0.5;
    CHECK(g == 5.0 && h == 5.0);
    FAILS(ko_pair_local_measures(NULL, r1, n, r2, n, 1, x, y), KO_ERR_INVALID_ARGUMENT, "pair");
    FAILS(ko_pair_local_measures(graph, r1, n, r2, n, 1, x, y), KO_ERR_INVALID_ARGUMENT, "no measures");
    OK(ko_pair_local_measures(both, r1, n, r2, n, 1, NULL, NULL));
    FAILS(ko_pair_sensitivities(NULL, r1, n, r2, n, 1, x, y, z, w), KO_ERR_INVALID_ARGUMENT, "pair");
    FAILS(ko_pair_sensitivities(graph, r1, n, r2, n, 1, x, y, z, w), KO_ERR_INVALID_ARGUMENT, "no measures");
    FAILS(ko_pair_sensitivities(both, r1, n, r2, n, 1, NULL, y, z, w), KO_ERR_INVALID_ARGUMENT, "d21_d1");
    FAILS(ko_pair_sensitivities(both, r1, n, r2, n, 1, x, NULL, z, w), KO_ERR_INVALID_ARGUMENT, "d21_d2");
    FAILS(ko_pair_sensitivities(both, r1, n, r2, n, 1, x, y, NULL, w), KO_ERR_INVALID_ARGUMENT, "d12_d1");
    FAILS(ko_pair_sensitivities(both, r1, n, r2, n, 1, x, y, z, NULL), KO_ERR_INVALID_ARGUMENT, "d12_d2");

    uint8_t s1[CELLS], s2[CELLS], c1[2 * CELLS], c2[2 * CELLS], before[2 * CELLS];
    memset(s1, 1, CELLS);
    memset(s2, 1, CELLS);
    memset(before, 9, sizeof before);
    memcpy(c1, before, sizeof c1);
    memcpy(c2, before, sizeof c2);
    FAILS(ko_pair_colliding(NULL, n, n, c1, c2), KO_ERR_INVALID_ARGUMENT, "pair");
    FAILS(ko_pair_colliding(measures, n, n, c1, c2), KO_ERR_INVALID_ARGUMENT, "no conflict graph");
    FAILS(ko_pair_colliding(graph, 3, n, c1, c2), KO_ERR_INVALID_ARGUMENT, "n_1 is 3; the object has 16");
    OK(ko_pair_colliding(graph, n, n, NULL, NULL));
    FAILS(ko_pair_volumes(NULL, s1, n, s2, n, x, &g, NULL), KO_ERR_INVALID_ARGUMENT, "pair");
    FAILS(ko_pair_volumes(measures, s1, n, s2, n, x, &g, NULL), KO_ERR_INVALID_ARGUMENT, "no conflict graph");
    FAILS(ko_pair_volumes(graph, NULL, n, s2, n, x, &g, NULL), KO_ERR_INVALID_ARGUMENT, "set_1");
    FAILS(ko_pair_volumes(graph, s1, n, NULL, n, x, &g, NULL), KO_ERR_INVALID_ARGUMENT, "set_2");
    FAILS(ko_pair_volumes(graph, s1, n, s2, 5, x, &g, NULL), KO_ERR_INVALID_ARGUMENT, "n_2 is 5");
    size_t lost = 0;
    OK(ko_pair_volumes(graph, s1, n, s2, n, NULL, NULL, &lost));
    CHECK(lost > 0);
    FAILS(ko_pair_close(NULL, s1, s2, 0, n, n, c1, c2, &g), KO_ERR_INVALID_ARGUMENT, "pair");
    FAILS(ko_pair_close(measures, s1, s2, 0, n, n, c1, c2, &g), KO_ERR_INVALID_ARGUMENT, "no conflict graph");
    FAILS(ko_pair_close(graph, s1, s2, 3, n, n, c1, c2, &g), KO_ERR_INVALID_ARGUMENT, "from is 3");
    FAILS(ko_pair_close(graph, NULL, s2, 0, n, n, c1, c2, &g), KO_ERR_INVALID_ARGUMENT, "set_1");
    FAILS(ko_pair_close(graph, s1, NULL, 2, n, n, c1, c2, &g), KO_ERR_INVALID_ARGUMENT, "set_2");
    FAILS(ko_pair_close(graph, s1, s2, 1, n, 2, c1, c2, &g), KO_ERR_INVALID_ARGUMENT, "n_2 is 2");
    FAILS(ko_pair_close(graph, s1, s2, 1, n, n, NULL, c2, &g), KO_ERR_INVALID_ARGUMENT, "cells_1");
    FAILS(ko_pair_close(graph, s1, s2, 1, n, n, c1, NULL, &g), KO_ERR_INVALID_ARGUMENT, "cells_2");
    s1[15] = 2;
    FAILS(ko_pair_close(graph, s1, s2, 1, n, n, c1, c2, &g), KO_ERR_INVALID_ARGUMENT, "entry 15 of set_1 is 2");
    s1[15] = 1;

    ko_family_options f;
    FAILS(ko_family_options_init(NULL, sizeof f), KO_ERR_INVALID_ARGUMENT, "options");
    OK(ko_family_options_init(&f, sizeof f));
    FAILS(ko_pair_cut(NULL, NULL, NULL, &f, n, n, c1, c2, &g, &h, NULL), KO_ERR_INVALID_ARGUMENT, "pair");
    FAILS(ko_pair_cut(measures, NULL, NULL, &f, n, n, c1, c2, &g, &h, NULL), KO_ERR_INVALID_ARGUMENT, "no conflict graph");
    FAILS(ko_pair_cut(graph, NULL, NULL, &f, 1, n, c1, c2, &g, &h, NULL), KO_ERR_INVALID_ARGUMENT, "n_1 is 1");
    FAILS(ko_pair_cut(graph, NULL, NULL, &f, n, n, NULL, c2, &g, &h, NULL), KO_ERR_INVALID_ARGUMENT, "cells_1");
    FAILS(ko_pair_cut(graph, NULL, NULL, &f, n, n, c1, NULL, &g, &h, NULL), KO_ERR_INVALID_ARGUMENT, "cells_2");
    r1[3] = -1.0;
    FAILS(ko_pair_cut(graph, r1, NULL, &f, n, n, c1, c2, &g, &h, NULL), KO_ERR_INVALID_ARGUMENT, "weight 3 of part 1 is -1");
    r1[3] = INFINITY;
    FAILS(ko_pair_cut(graph, NULL, r1, &f, n, n, c1, c2, &g, &h, NULL), KO_ERR_INVALID_ARGUMENT, "weight 3 of part 2 is inf");
    double gammas[2] = {0.5, 1.1};
    FAILS(ko_pair_family(graph, NULL, NULL, gammas, 2, &f, n, n, c1, c2, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "gamma 1 is 1.1");
    gammas[1] = 0.7;
    FAILS(ko_pair_family(NULL, NULL, NULL, gammas, 2, &f, n, n, c1, c2, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "pair");
    FAILS(ko_pair_family(measures, NULL, NULL, gammas, 2, &f, n, n, c1, c2, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "no conflict graph");
    FAILS(ko_pair_family(graph, NULL, NULL, NULL, 2, &f, n, n, c1, c2, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "gammas");
    FAILS(ko_pair_family(graph, NULL, NULL, gammas, 2, &f, n, n, NULL, c2, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "cells_1");
    FAILS(ko_pair_family(graph, r1, NULL, gammas, 2, &f, n, n, c1, c2, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "weight 3");
    FAILS(ko_pair_family(graph, NULL, NULL, gammas, 2, &f, n, 3, c1, c2, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "n_2 is 3");
    f.gap = 1.0;
    FAILS(ko_pair_family(graph, NULL, NULL, gammas, 2, &f, n, n, c1, c2, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "gap is 1");
    f.gap = 0.0;
    f.progress = stop;
    FAILS(ko_pair_family(graph, NULL, NULL, gammas, 2, &f, n, n, c1, c2, NULL, NULL, NULL), KO_ERR_CANCELLED, "cancelled");
    FAILS(ko_pair_cut(graph, NULL, NULL, &f, n, n, c1, c2, &g, &h, NULL), KO_ERR_CANCELLED, "cancelled");
    CHECK(memcmp(c1, before, sizeof c1) == 0 && memcmp(c2, before, sizeof c2) == 0 && g == 5.0 && h == 5.0);
    OK(ko_pair_family(graph, NULL, NULL, gammas, 0, NULL, n, n, NULL, NULL, NULL, NULL, NULL));

    ko_optimise_options p;
    ko_optimise_report report;
    FAILS(ko_optimise_options_init(&p, 1), KO_ERR_INVALID_ARGUMENT, "struct_size 1");
    OK(ko_optimise_options_init(&p, sizeof p));
    FAILS(ko_pair_optimise(NULL, &p, n, n, x, y, c1, c2, NULL, sizeof report, &report), KO_ERR_INVALID_ARGUMENT, "pair");
    FAILS(ko_pair_optimise(graph, &p, n, n, x, y, c1, c2, NULL, sizeof report, &report), KO_ERR_INVALID_ARGUMENT, "no measures");
    FAILS(ko_pair_optimise(measures, &p, n, n, x, y, c1, c2, NULL, sizeof report, &report), KO_ERR_INVALID_ARGUMENT, "no conflict graph");
    FAILS(ko_pair_optimise(both, &p, n, 2, x, y, c1, c2, NULL, sizeof report, &report), KO_ERR_INVALID_ARGUMENT, "n_2 is 2");
    FAILS(ko_pair_optimise(both, &p, n, n, x, y, NULL, c2, NULL, sizeof report, &report), KO_ERR_INVALID_ARGUMENT, "cells_1");
    FAILS(ko_pair_optimise(both, &p, n, n, x, y, c1, NULL, NULL, sizeof report, &report), KO_ERR_INVALID_ARGUMENT, "cells_2");
    FAILS(ko_pair_optimise(both, &p, n, n, x, y, c1, c2, NULL, 2, &report), KO_ERR_INVALID_ARGUMENT, "struct_size 2");
    FAILS(ko_pair_optimise(both, &p, n, n, x, y, c1, c2, NULL, sizeof report, NULL), KO_ERR_INVALID_ARGUMENT, "report");
    const char *const words[6] = {"gamma is 1.5", "tolerance is 0", "feasibility is 1", "close_from is 3", "reserved is 1", "n_threads is 2000"};
    for (int i = 0; i < 6; i++) {
        OK(ko_optimise_options_init(&p, sizeof p));
        p.gamma = i == 0 ? 1.5 : p.gamma;
        p.tolerance = i == 1 ? 0.0 : p.tolerance;
        p.feasibility = i == 2 ? 1.0 : p.feasibility;
        p.close_from = i == 3 ? 3 : 0;
        p.reserved = i == 4;
        p.n_threads = i == 5 ? 2000 : 1;
        FAILS(ko_pair_optimise(both, &p, n, n, x, y, c1, c2, NULL, sizeof report, &report), KO_ERR_INVALID_ARGUMENT, words[i]);
    }
    OK(ko_optimise_options_init(&p, sizeof p));
    int left = 3;
    p.progress = stop_later;
    p.progress_data = &left;
    FAILS(ko_pair_optimise(both, &p, n, n, x, y, c1, c2, NULL, sizeof report, &report), KO_ERR_CANCELLED, "cancelled");
    CHECK(memcmp(c1, before, sizeof c1) == 0 && left == 0);

    double largest = 5.0;
    uint8_t none[CELLS] = {0};
    FAILS(ko_pair_contact(NULL, s1, n, s2, n, 4, 1, NULL, NULL, x, NULL, NULL, &largest, NULL), KO_ERR_INVALID_ARGUMENT, "pair");
    FAILS(ko_pair_contact(both, NULL, n, s2, n, 4, 1, NULL, NULL, x, NULL, NULL, &largest, NULL), KO_ERR_INVALID_ARGUMENT, "set_1");
    FAILS(ko_pair_contact(both, s1, n, s2, 3, 4, 1, NULL, NULL, x, NULL, NULL, &largest, NULL), KO_ERR_INVALID_ARGUMENT, "n_2 is 3");
    FAILS(ko_pair_contact(both, s1, n, s2, n, 0, 1, NULL, NULL, x, NULL, NULL, &largest, NULL), KO_ERR_INVALID_ARGUMENT, "0 steps");
    FAILS(ko_pair_contact(both, s1, n, none, n, 4, 1, NULL, NULL, x, NULL, NULL, &largest, NULL), KO_ERR_DEGENERATE, "part 2 has no cells");
    FAILS(ko_pair_contact(both, s1, n, s2, n, 4, 1, stop, NULL, x, NULL, NULL, &largest, NULL), KO_ERR_CANCELLED, "cancelled");
    CHECK(largest == 5.0);
    ko_part_free(a);
    ko_part_free(b);
    ko_motion_free(motion);
    ko_motion_free(other);
    ko_pair_free(both);
    ko_pair_free(graph);
    ko_pair_free(measures);
}

int main(void) {
    laws_and_screws();
    poses_that_are_none();
    mechanisms_that_are_none();
    parts_that_are_none();
    sweeps_that_are_none();
    pairs_that_are_none();
    calls_on_pairs();
    return check_result();
}
