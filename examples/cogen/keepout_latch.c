/* The latch of Morris and Behandish 2022, figure 2: a part that turns, stays in its enclosure and gives way to a pin that comes down, as large as
 * that lets it be: unsweeps against an enclosure and a body. Writes a page on which it runs. SPDX-License-Identifier: Apache-2.0 OR MIT */
#include "page.h"

#include "../c/failure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

enum { CELLS = 300, PIN_CELLS = 60, ROOM_CELLS = 120 };

/* A square of `n` x `n` cells around the origin, 2 * half wide, as part `which`. */
static bool make_square(struct study *study, int which, size_t n, double half)
{
    const double corner[2] = {-half, -half};
    const size_t counts[2] = {n, n};
    study->edge[which] = 2 * half / (double)n;
    study->n_cells[which] = n * n;
    for (int a = 0; a < 3; ++a) {
        study->corner[which][a] = a < 2 ? -half : 0;
        study->counts[which][a] = a < 2 ? n : 1;
    }
    return succeeded(ko_part_create(2, corner, study->edge[which], counts, NULL, 0, &study->parts[which]), "making a part");
}

/* The latch turns by 60 degrees about the origin; the pin comes down beside it. */
static bool make_motions(struct study *study)
{
    const double pivot[2] = {0, 0}, down[2] = {0, -0.9}, above[2] = {0.55, 0.75};
    ko_law turn, slide;
    ko_motion *place = NULL, *way = NULL;
    ko_law_init(&turn, sizeof turn);
    ko_law_init(&slide, sizeof slide);
    turn.slope = -PI / 3;
    slide.slope = 1;
    const bool ok = succeeded(ko_motion_turn(pivot, &turn, &study->motions[0]), "making the latch's motion") &&
                    succeeded(ko_motion_fixed(2, NULL, above, &place), "placing the pin") &&
                    succeeded(ko_motion_slide(2, down, &slide, &way), "making the pin's way") &&
                    succeeded(ko_motion_product(place, way, &study->motions[1]), "making the pin's motion");
    ko_motion_free(place);
    ko_motion_free(way);
    return ok;
}

static bool make_latch(struct study *study)
{
    memset(study, 0, sizeof *study);
    study->name = "latch";
    study->title = "latch: it stays in its enclosure and gives way to a pin";
    study->dim = 2;
    return make_square(study, 0, CELLS, 1) && make_square(study, 1, PIN_CELLS, 0.14) && make_motions(study);
}

/* Cells whose larger part is in the disc. */
static bool make_pin(const struct study *study, uint8_t *pin)
{
    const double center[2] = {0, 0};
    const size_t n = study->n_cells[1];
    double *fractions = malloc(n * sizeof *fractions);
    if (fractions == NULL) {
        fprintf(stderr, "no memory for a pin\n");
        return false;
    }
    const bool ok = succeeded(ko_part_fractions_of_ball(study->parts[1], center, 0.14, 4, 0, n, fractions), "filling the pin");
    for (size_t i = 0; ok && i < n; ++i)
        pin[i] = fractions[i] > 0.5;
    free(fractions);
    return ok;
}

/* The enclosure's cells are a room, wider than high; the grid around it is what lies outside. */
static bool stay_in_room(struct study *study, uint8_t *latch)
{
    static uint8_t room[ROOM_CELLS * ROOM_CELLS];
    const double corner[2] = {-1.2, -1.2}, edge = 2.4 / ROOM_CELLS;
    const size_t counts[2] = {ROOM_CELLS, ROOM_CELLS}, from[2] = {15, 25}, to[2] = {105, 100};
    ko_part *enclosure = NULL;
    for (size_t x = from[0]; x < to[0]; ++x)
        memset(room + x * ROOM_CELLS + from[1], 1, to[1] - from[1]);
    for (int a = 0; a < 2; ++a) {
        study->enclosure[a] = corner[a] + edge * (double)from[a];
        study->enclosure[2 + a] = corner[a] + edge * (double)to[a];
    }
    const bool ok = succeeded(ko_part_create(2, corner, edge, counts, NULL, 0, &enclosure), "making the enclosure") &&
                    succeeded(ko_part_unsweep(study->parts[0], study->motions[0], enclosure, room, sizeof room, NULL, KO_STAY_IN, NULL,
                                              study->n_cells[0], latch),
                              "keeping the latch in its enclosure");
    ko_part_free(enclosure);
    return ok;
}

static size_t count(const uint8_t *set, size_t n)
{
    size_t sum = 0;
    for (size_t i = 0; i < n; ++i)
        sum += set[i];
    return sum;
}

/* Makes the latch, and asks a conflict graph, which is made in another way, whether it meets the pin. */
static bool shape(struct study *study, uint8_t *latch, uint8_t *pin)
{
    size_t n_lost = 0;
    ko_pair *pair = NULL;
    memset(latch, 1, study->n_cells[0]);
    printf("latch: %zu cells", count(latch, study->n_cells[0]));
    if (!make_pin(study, pin) || !stay_in_room(study, latch))
        return false;
    printf(", %zu of them stay in the enclosure", count(latch, study->n_cells[0]));
    if (!succeeded(ko_part_unsweep(study->parts[0], study->motions[0], study->parts[1], pin, study->n_cells[1], study->motions[1], KO_AVOID, NULL,
                                   study->n_cells[0], latch),
                   "letting the pin pass"))
        return false;
    printf(", and %zu do not meet the pin\n", count(latch, study->n_cells[0]));
    const bool ok = succeeded(ko_pair_create(study->parts[0], study->motions[0], study->parts[1], study->motions[1], NULL, &pair), "finding conflicts") &&
                    succeeded(ko_pair_volumes(pair, latch, study->n_cells[0], pin, study->n_cells[1], NULL, NULL, &n_lost), "looking for collisions");
    ko_pair_free(pair);
    printf("cells of the pin that the latch collides with: %zu\n", n_lost);
    return ok && n_lost == 0;
}

int main(int argc, char **argv)
{
    static uint8_t latch[CELLS * CELLS], pin[PIN_CELLS * PIN_CELLS];
    const char *folder = argc > 1 ? argv[1] : ".";
    struct study study;
    const bool ok = make_latch(&study) && shape(&study, latch, pin) && page_write(&study, latch, pin, NULL, 0, folder);
    if (ok)
        printf("page: %s/latch.html\n", folder);
    study_free(&study);
    return ok ? EXIT_SUCCESS : EXIT_FAILURE;
}
