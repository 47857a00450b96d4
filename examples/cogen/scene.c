/* SPDX-License-Identifier: Apache-2.0 OR MIT */
#include "scene.h"

#include "../c/failure.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 3, LOOKS = 200, MARGIN = 8 };

struct colour {
    double red, green, blue; /* 0 to 1 */
};

static const struct colour PAPER = {1, 1, 1}, ROOM = {0.90, 0.93, 0.88}, PARTS[2] = {{0.25, 0.46, 0.72}, {0.93, 0.55, 0.20}};

/* A part's pose at a time: x_w = R x + t. */
struct pose {
    double rotation[9], translation[3];
};

static bool pose_at(const struct study *study, int part, double time, struct pose *pose)
{
    double rotation[9], translation[3] = {0, 0, 0};
    const uint32_t dim = study->dim;
    if (!succeeded(ko_motion_eval(study->motions[part], &time, 1, rotation, translation), "evaluating a motion"))
        return false;
    for (uint32_t i = 0; i < 3; ++i)
        for (uint32_t j = 0; j < 3; ++j)
            pose->rotation[3 * i + j] = i < dim && j < dim ? rotation[dim * i + j] : i == j;
    for (uint32_t i = 0; i < 3; ++i)
        pose->translation[i] = i < dim ? translation[i] : 0;
    return true;
}

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void to_world(const struct pose *pose, const double *p, double *world)
{
    for (int i = 0; i < 3; ++i)
        world[i] = dot(pose->rotation + 3 * i, p) + pose->translation[i];
}

/* Places for `translation` pose->translation, directions for NULL. */
static void to_part(const struct pose *pose, const double *translation, const double *world, double *p)
{
    double from[3];
    for (int i = 0; i < 3; ++i)
        from[i] = world[i] - (translation != NULL ? translation[i] : 0);
    for (int i = 0; i < 3; ++i)
        p[i] = pose->rotation[i] * from[0] + pose->rotation[3 + i] * from[1] + pose->rotation[6 + i] * from[2];
}

/* The eye: from above in the plane, else from where both parts are seen. */
static void look(struct scene *scene)
{
    const bool plane = scene->study->dim == 2;
    const double azimuth = plane ? -1.5707963267948966 : -0.9, height = plane ? 1.5707963267948966 : 0.5;
    const double eye[3] = {cos(height) * cos(azimuth), cos(height) * sin(azimuth), sin(height)};
    const double right[3] = {-sin(azimuth), cos(azimuth), 0};
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        scene->axes[0][i] = right[i];
        scene->axes[1][i] = eye[j] * right[k] - eye[k] * right[j];
        scene->axes[2][i] = eye[i];
    }
}

/* Turns the box of the grid through the whole motion, and fits the picture to what it passes over. */
static bool fit_view(struct scene *scene, int width)
{
    const struct study *study = scene->study;
    double least[2] = {DBL_MAX, DBL_MAX}, most[2] = {-DBL_MAX, -DBL_MAX};
    for (int part = 0; part < 2; ++part)
        for (int look = 0; look <= LOOKS; ++look) {
            struct pose pose;
            if (!pose_at(study, part, (double)look / LOOKS, &pose))
                return false;
            for (int corner = 0; corner < 8; ++corner) {
                double p[3] = {0, 0, 0}, world[3];
                for (uint32_t a = 0; a < study->dim; ++a)
                    p[a] = study->corner[part][a] + (corner >> a & 1) * study->edge[part] * (double)study->counts[part][a];
                to_world(&pose, p, world);
                for (int a = 0; a < 2; ++a) {
                    const double at = dot(scene->axes[a], world);
                    least[a] = fmin(least[a], at);
                    most[a] = fmax(most[a], at);
                }
            }
        }
    scene->pixel = (most[0] - least[0]) / (width - 2 * MARGIN);
    scene->width = width;
    scene->height = (int)ceil((most[1] - least[1]) / scene->pixel) + 2 * MARGIN;
    for (int a = 0; a < 2; ++a)
        scene->middle[a] = 0.5 * (least[a] + most[a]);
    return true;
}

static size_t number(const size_t *counts, const size_t *place)
{
    return (place[0] * counts[1] + place[1]) * counts[2] + place[2];
}

/* Means of each cell and those around it, 27 in all: three passes along the axes. */
static float *smoothed(const uint8_t *set, const size_t *counts, size_t n_cells)
{
    float *values = malloc(n_cells * sizeof *values), *next = malloc(n_cells * sizeof *next);
    if (values == NULL || next == NULL) {
        fprintf(stderr, "no memory for a picture of %zu cells\n", n_cells);
        free(values);
        free(next);
        return NULL;
    }
    for (size_t i = 0; i < n_cells; ++i)
        values[i] = set[i];
    for (int axis = 0; axis < 3; ++axis) {
        const size_t step = axis == 2 ? 1 : axis == 1 ? counts[2] : counts[1] * counts[2];
        for (size_t i = 0; i < n_cells; ++i) {
            const size_t at = i / step % counts[axis];
            const float before = at > 0 ? values[i - step] : 0, behind = at + 1 < counts[axis] ? values[i + step] : 0;
            next[i] = (before + values[i] + behind) / 3;
        }
        float *swap = values;
        values = next;
        next = swap;
    }
    free(next);
    return values;
}

bool scene_make(const struct study *study, const uint8_t *set_1, const uint8_t *set_2, int width, struct scene *scene)
{
    memset(scene, 0, sizeof *scene);
    scene->study = study;
    scene->sets[0] = set_1;
    scene->sets[1] = set_2;
    scene->cut_open = strcmp(study->name, "bolt") == 0;
    look(scene);
    if (!fit_view(scene, width))
        return false;
    for (int part = 0; part < 2 && study->dim == 3; ++part) {
        scene->smooth[part] = smoothed(scene->sets[part], study->counts[part], study->n_cells[part]);
        if (scene->smooth[part] == NULL) {
            scene_free(scene);
            return false;
        }
    }
    return true;
}

void scene_free(struct scene *scene)
{
    free(scene->smooth[0]);
    free(scene->smooth[1]);
    scene->smooth[0] = scene->smooth[1] = NULL;
}

/* Where pixel x, y, or a point in it, lies on the plane through the origin that the eye looks at. */
static void place_of(const struct scene *scene, double x, double y, double *world)
{
    const double right = scene->middle[0] + (x - 0.5 * scene->width) * scene->pixel;
    const double up = scene->middle[1] + (0.5 * scene->height - y) * scene->pixel;
    for (int i = 0; i < 3; ++i)
        world[i] = right * scene->axes[0][i] + up * scene->axes[1][i];
}

static struct colour mix(struct colour a, struct colour b, double of_b)
{
    return (struct colour){a.red + of_b * (b.red - a.red), a.green + of_b * (b.green - a.green),
                           a.blue + of_b * (b.blue - a.blue)};
}

/* What is seen in the plane: kept cells in the parts' colours, those that had to go as a tint. */
static struct colour look_down(const struct scene *scene, const struct pose *poses, const double *world)
{
    const double *room = scene->study->enclosure;
    const bool enclosed = world[0] > room[0] && world[1] > room[1] && world[0] < room[2] && world[1] < room[3];
    struct colour seen = enclosed ? ROOM : PAPER;
    for (int part = 0; part < 2; ++part) {
        const struct study *study = scene->study;
        double p[3];
        size_t place[3] = {0, 0, 0};
        to_part(&poses[part], poses[part].translation, world, p);
        bool within = true;
        for (int a = 0; a < 2; ++a) {
            const double at = floor((p[a] - study->corner[part][a]) / study->edge[part]);
            within = within && at >= 0 && at < (double)study->counts[part][a];
            place[a] = within ? (size_t)at : 0;
        }
        if (within && scene->sets[part][number(study->counts[part], place)])
            return PARTS[part];
        if (within)
            seen = mix(seen, PARTS[part], 0.12);
    }
    return seen;
}

/* The smooth density of a part at `p` in cells, between centres; 0 outside. */
static double density(const struct scene *scene, int part, const double *p)
{
    const size_t *counts = scene->study->counts[part];
    size_t place[3];
    double off[3];
    for (int a = 0; a < 3; ++a) {
        const double at = p[a] - 0.5, low = floor(at);
        if (low < -1 || low >= (double)counts[a])
            return 0;
        place[a] = (size_t)(low + 1); /* one too many, so that it is not below 0 */
        off[a] = at - low;
    }
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        size_t at[3];
        double weight = 1;
        bool within = true;
        for (int a = 0; a < 3; ++a) {
            const int high = corner >> a & 1;
            weight *= high ? off[a] : 1 - off[a];
            within = within && place[a] + (size_t)high >= 1 && place[a] + (size_t)high <= counts[a];
            at[a] = within ? place[a] + (size_t)high - 1 : 0;
        }
        if (within && weight > 0)
            sum += weight * scene->smooth[part][number(counts, at)];
    }
    return sum;
}

/* A ray in a part's cells, from the eye on. */
struct ray {
    double from[3], along[3];
    double begin, end; /* where it is in the grid */
};

static struct ray ray_of(const struct scene *scene, const struct pose *pose, int part, const double *world)
{
    const struct study *study = scene->study;
    struct ray ray = {.begin = -DBL_MAX, .end = DBL_MAX};
    double away[3];
    for (int i = 0; i < 3; ++i)
        away[i] = -scene->axes[2][i];
    to_part(pose, pose->translation, world, ray.from);
    to_part(pose, NULL, away, ray.along);
    for (int a = 0; a < 3; ++a) {
        ray.from[a] = (ray.from[a] - study->corner[part][a]) / study->edge[part];
        const double low = (0 - ray.from[a]) / ray.along[a], high = ((double)study->counts[part][a] - ray.from[a]) / ray.along[a];
        if (ray.along[a] == 0) {
            if (ray.from[a] < 0 || ray.from[a] > (double)study->counts[part][a])
                ray.end = -DBL_MAX;
            continue;
        }
        ray.begin = fmax(ray.begin, fmin(low, high));
        ray.end = fmin(ray.end, fmax(low, high));
    }
    return ray;
}

static void along(const struct ray *ray, double s, double *p)
{
    for (int a = 0; a < 3; ++a)
        p[a] = ray->from[a] + s * ray->along[a];
}

static bool is_there(const struct scene *scene, int part, const double *p)
{
    if (scene->cut_open && part == 0) {
        const double x = scene->study->corner[0][0] + scene->study->edge[0] * p[0];
        const double y = scene->study->corner[0][1] + scene->study->edge[0] * p[1];
        if (x > 0 && y < 0)
            return false;
    }
    return density(scene, part, p) > 0.5;
}

/* Where the ray first meets the part, in cells from its plane; DBL_MAX where it does not. */
static double meet(const struct scene *scene, int part, const struct ray *ray)
{
    double p[3];
    for (double s = ray->begin - 0.5; s <= ray->end + 0.5; s += 1) {
        along(ray, s, p);
        if (!is_there(scene, part, p))
            continue;
        double outside = s - 1, inside = s;
        for (int i = 0; i < 6; ++i) {
            const double half = 0.5 * (outside + inside);
            along(ray, half, p);
            *(is_there(scene, part, p) ? &inside : &outside) = half;
        }
        return inside;
    }
    return DBL_MAX;
}

/* Light from the eye's upper left; a face of the cut is flat. */
static struct colour shade(const struct scene *scene, const struct pose *pose, int part, const double *p)
{
    double normal[3], light[3], to_light[3];
    for (int a = 0; a < 3; ++a) {
        double before[3] = {p[0], p[1], p[2]}, behind[3] = {p[0], p[1], p[2]};
        before[a] -= 1;
        behind[a] += 1;
        normal[a] = density(scene, part, before) - density(scene, part, behind);
    }
    double length = sqrt(dot(normal, normal));
    const bool flat = density(scene, part, p) > 0.7; /* well inside: the cut */
    for (int i = 0; i < 3; ++i)
        light[i] = scene->axes[2][i] + 0.6 * scene->axes[1][i] - 0.5 * scene->axes[0][i];
    to_part(pose, NULL, light, to_light);
    const double lit = flat || length < 1e-9 ? 0.75 : fmax(dot(normal, to_light) / length / sqrt(dot(light, light)), 0);
    const struct colour dark = mix(PARTS[part], (struct colour){0, 0, 0}, 0.65);
    return mix(dark, mix(PARTS[part], PAPER, flat ? 0.45 : 0.15), lit);
}

static struct colour look_into(const struct scene *scene, const struct pose *poses, const double *world)
{
    struct colour seen = PAPER;
    double nearest = DBL_MAX;
    for (int part = 0; part < 2; ++part) {
        const struct ray ray = ray_of(scene, &poses[part], part, world);
        const double s = ray.begin < ray.end ? meet(scene, part, &ray) : DBL_MAX;
        if (s >= nearest)
            continue;
        double p[3];
        along(&ray, s, p);
        seen = shade(scene, &poses[part], part, p);
        nearest = s;
    }
    return seen;
}

bool scene_draw(const struct scene *scene, double time, uint8_t *pixels)
{
    struct pose poses[2];
    const int samples = scene->study->dim == 2 ? SAMPLES : 1;
    if (!pose_at(scene->study, 0, time, &poses[0]) || !pose_at(scene->study, 1, time, &poses[1]))
        return false;
    for (int y = 0; y < scene->height; ++y)
        for (int x = 0; x < scene->width; ++x) {
            struct colour sum = {0, 0, 0};
            for (int k = 0; k < samples * samples; ++k) {
                double world[3];
                place_of(scene, x + (k % samples + 0.5) / samples, y + (k / samples + 0.5) / samples, world);
                const struct colour seen = scene->study->dim == 2 ? look_down(scene, poses, world) : look_into(scene, poses, world);
                sum = (struct colour){sum.red + seen.red, sum.green + seen.green, sum.blue + seen.blue};
            }
            const double scale = 255.0 / (samples * samples);
            *pixels++ = (uint8_t)(scale * sum.red + 0.5);
            *pixels++ = (uint8_t)(scale * sum.green + 0.5);
            *pixels++ = (uint8_t)(scale * sum.blue + 0.5);
        }
    return true;
}
