/* SPDX-License-Identifier: Apache-2.0 OR MIT */
#include "cases.h"

#include "../c/failure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

const char *const STUDIES[] = {"gears", "cam", "cam_diamond", "cam_3d", "bolt", NULL};

/* f(t) = slope t, or with waves too. */
static ko_law law_of(double offset, double slope, const double *waves, size_t n_waves)
{
    ko_law law;
    ko_law_init(&law, sizeof law);
    law.offset = offset;
    law.slope = slope;
    law.waves = waves;
    law.n_waves = n_waves;
    return law;
}

/* A part of all its cells, `counts` of them along each axis, from `corner` on. */
static bool make_part(struct study *study, int which, const double *corner, const size_t *counts)
{
    study->n_cells[which] = 1;
    for (uint32_t a = 0; a < 3; ++a) {
        study->corner[which][a] = a < study->dim ? corner[a] : 0;
        study->counts[which][a] = a < study->dim ? counts[a] : 1;
        study->n_cells[which] *= study->counts[which][a];
    }
    return succeeded(ko_part_create(study->dim, corner, study->edge[which], counts, NULL, 0, &study->parts[which]), "making a part");
}

/* 5.1: two squares that turn against each other about their middles, L apart. */
static bool make_gears(struct study *study)
{
    const size_t n = study->cells, counts[2] = {n, n};
    const double first[2] = {-0.5, -0.5}, second[2] = {0.5, -0.5}, centers[4] = {0, 0, 1, 0};
    return make_part(study, 0, first, counts) && make_part(study, 1, second, counts) &&
           succeeded(ko_motion_gears(centers, 1, 1, &study->motions[0], &study->motions[1]), "making the gears' motions");
}

/* 5.2: a square turns, from `start` on, and a rectangle above it goes up and down twice, (44). */
static bool make_cam_from(double start, struct study *study)
{
    const size_t n = study->cells, cam[2] = {n, n}, follower[2] = {n, n / 2};
    const double corners[2][2] = {{-0.5, -0.5}, {-0.5, -0.25}}, center[2] = {0, 0}, up[2] = {0, 1};
    const double wave[3] = {0.125, 2, 0};
    const ko_law turn = law_of(start, 2 * PI, NULL, 0), lift = law_of(0.75, 0, wave, 1);
    return make_part(study, 0, corners[0], cam) && make_part(study, 1, corners[1], follower) &&
           succeeded(ko_motion_turn(center, &turn, &study->motions[0]), "making the cam's motion") &&
           succeeded(ko_motion_slide(2, up, &lift, &study->motions[1]), "making the follower's motion");
}

static bool make_cam(struct study *study)
{
    return make_cam_from(0, study);
}

/* From the cam's corner on: as the follower is highest, so is the cam. */
static bool make_cam_diamond(struct study *study)
{
    return make_cam_from(PI / 4, study);
}

/* (46), the follower's turn about x by |sin(2 pi t)| / 2; (45) and (46) turn the other way round than the right hand. */
static int32_t follower_pose(double time, double *rotation, double *translation, void *data)
{
    const double angle = 0.5 * fabs(sin(2 * PI * time)), c = cos(angle), s = sin(angle);
    const double rows[9] = {1, 0, 0, 0, c, s, 0, -s, c};
    (void)data;
    memcpy(rotation, rows, sizeof rows);
    memset(translation, 0, 3 * sizeof *translation);
    return 0;
}

/* 5.3: a cube turns about z, and a box beside it is tilted about x. Of where it stands figure 14 shows less than one needs: from L / 4 on. */
static bool make_cam_3d(struct study *study)
{
    enum { POSES = 201 };
    const size_t n = study->cells, cam[3] = {n, n, n}, follower[3] = {n, n * 4 / 3, n};
    const double corners[2][3] = {{-0.5, -0.5, -0.5}, {-0.5, 0.25, -0.5}}, point[3] = {0, 0, 0}, axis[3] = {0, 0, 1};
    const ko_law turn = law_of(0, -2 * PI, NULL, 0);
    return make_part(study, 0, corners[0], cam) && make_part(study, 1, corners[1], follower) &&
           succeeded(ko_motion_screw(point, axis, 0, &turn, &study->motions[0]), "making the cam's motion") &&
           succeeded(ko_motion_from_function(3, follower_pose, NULL, POSES, NULL, 0, &study->motions[1]), "making the follower's motion");
}

/* 5.4: a nut that stays, and a bolt that is screwed through it by four turns, (47), the other way round than the right hand. */
static bool make_bolt(struct study *study)
{
    const size_t n = study->cells, nut[3] = {2 * n, 2 * n, n}, bolt[3] = {n, n, 3 * n};
    const double corners[2][3] = {{-1, -1, 0}, {-0.5, -0.5, -1}}, point[3] = {0, 0, 0}, axis[3] = {0, 0, 1};
    const ko_law turns = law_of(0, -8 * PI, NULL, 0);
    return make_part(study, 0, corners[0], nut) && make_part(study, 1, corners[1], bolt) &&
           succeeded(ko_motion_fixed(3, NULL, NULL, &study->motions[0]), "making the nut's motion") &&
           succeeded(ko_motion_screw(point, axis, 0.1 / PI, &turns, &study->motions[1]), "making the bolt's motion");
}

bool study_make(const char *name, size_t cells, struct study *study)
{
    static const struct {
        const char *title;
        uint32_t dim;
        size_t cells;
        uint64_t steps;
        double gamma;
        bool (*make)(struct study *study);
    } kinds[] = {
        {"gears: two squares that turn against each other", 2, 400, 500, 0.5, make_gears},
        {"cam and follower", 2, 400, 1000, 0.8, make_cam},
        {"cam and follower, from the cam's corner on", 2, 400, 1000, 0.8, make_cam_diamond},
        {"cam and follower in space", 3, 105, 5000, 0.5, make_cam_3d},
        {"nut and bolt", 3, 50, 5000, 0.2, make_bolt},
    };
    memset(study, 0, sizeof *study);
    for (size_t i = 0; STUDIES[i] != NULL; ++i) {
        if (strcmp(name, STUDIES[i]) != 0)
            continue;
        study->name = STUDIES[i];
        study->title = kinds[i].title;
        study->dim = kinds[i].dim;
        study->cells = cells > 0 ? cells : kinds[i].cells;
        study->steps = kinds[i].steps;
        study->gamma = kinds[i].gamma;
        study->edge[0] = study->edge[1] = 1.0 / (double)study->cells;
        if (kinds[i].make(study))
            return true;
        study_free(study);
        return false;
    }
    fprintf(stderr, "there is no study '%s'; there are", name);
    for (size_t i = 0; STUDIES[i] != NULL; ++i)
        fprintf(stderr, " %s", STUDIES[i]);
    fputc('\n', stderr);
    return false;
}

void study_free(struct study *study)
{
    for (int k = 0; k < 2; ++k) {
        ko_part_free(study->parts[k]);
        ko_motion_free(study->motions[k]);
    }
    memset(study, 0, sizeof *study);
}
