/* Pictures of two parts at a time of their motion. SPDX-License-Identifier: Apache-2.0 OR MIT */
#ifndef SCENE_H
#define SCENE_H

#include "cases.h"

#include <stdint.h>

struct scene {
    const struct study *study;
    const uint8_t *sets[2]; /* the cells that are drawn */
    int width, height;      /* of a picture, in pixels */
    bool cut_open;          /* in space: part 1 without the quarter of its frame with x > 0 and y < 0 */
    double middle[2], pixel;
    double axes[3][3];      /* right, up, and towards the eye, in the world */
    float *smooth[2];       /* in space: densities between cells, for surfaces without steps */
};

/* A scene whose pictures show all of the motion, `width` pixels wide. Says on stderr where that fails. */
bool scene_make(const struct study *study, const uint8_t *set_1, const uint8_t *set_2, int width, struct scene *scene);

void scene_free(struct scene *scene);

/* Draws both parts at `time`: `pixels` [3 * width * height]. */
bool scene_draw(const struct scene *scene, double time, uint8_t *pixels);

#endif
