/* SPDX-License-Identifier: Apache-2.0 OR MIT */
#include "picture.h"

#include "slice.h"
#include "text.h"

#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST = 1000, MARGIN = 24, LEGEND = 150, BAR = 28, LEAST_HEIGHT = 360 };

struct colour {
    double red, green, blue; /* 0 to 255 */
};

static const struct colour INK = {25, 28, 36};

struct picture {
    int width, height;
    uint8_t *pixels; /* [3 * width * height] */
};

static struct colour mix(struct colour a, struct colour b, double of_b)
{
    return (struct colour){a.red + of_b * (b.red - a.red), a.green + of_b * (b.green - a.green),
                           a.blue + of_b * (b.blue - a.blue)};
}

/* Diverging: blues below 0, white at 0, reds above; each side has its whole range, as the inside is shallow beside the outside. */
static struct colour colour_of(double value, const struct slice *slice)
{
    static const struct colour below[] = {{247, 247, 247}, {146, 197, 222}, {67, 147, 195}, {33, 102, 172}, {5, 48, 97}};
    static const struct colour above[] = {{247, 247, 247}, {253, 219, 199}, {244, 165, 130}, {214, 96, 77}, {150, 20, 40}};
    enum { STEPS = 4 };
    const double end = value < 0 ? slice->min : slice->max;
    const double at = end == 0 ? 0 : fmin(value / end, 1) * STEPS;
    const int step = at >= STEPS ? STEPS - 1 : (int)at;
    const struct colour *map = value < 0 ? below : above;
    return mix(map[step], map[step + 1], at - step);
}

/* 1, 2 or 5 times a power of ten, so that there are about a dozen levels. */
static double level_spacing(const struct slice *slice)
{
    const double rough = (slice->max - slice->min) / 12;
    const double power = pow(10, floor(log10(rough)));
    const double digit = rough / power;
    return power * (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10);
}

/* How much of a pixel a line of `width` pixels covers whose middle is `distance` pixels away. */
static double coverage(double distance, double width)
{
    return fmin(fmax(0.5 * width + 0.5 - distance, 0), 1);
}

/* The field's colour under its contours: every level thin, zero bold. */
static struct colour shade(const struct slice *slice, size_t at, double spacing)
{
    const double value = slice->values[at];
    const double per_pixel = slice->slopes[at] * slice->pixel + 1e-9 * spacing;
    const double to_level = fabs(value - spacing * round(value / spacing)) / per_pixel;
    const struct colour lined = mix(colour_of(value, slice), INK, 0.45 * coverage(to_level, 1.0));
    return mix(lined, INK, coverage(fabs(value) / per_pixel, 3.5));
}

static void put(struct picture *picture, int x, int y, struct colour colour)
{
    if (x < 0 || y < 0 || x >= picture->width || y >= picture->height)
        return;
    uint8_t *pixel = picture->pixels + 3 * ((size_t)y * (size_t)picture->width + (size_t)x);
    pixel[0] = (uint8_t)(colour.red + 0.5);
    pixel[1] = (uint8_t)(colour.green + 0.5);
    pixel[2] = (uint8_t)(colour.blue + 0.5);
}

static void draw_text(struct picture *picture, int left, int top, const char *text)
{
    const int width = (int)strlen(text) * TEXT_COLUMNS * TEXT_SCALE;
    for (int y = 0; y < TEXT_ROWS * TEXT_SCALE; ++y)
        for (int x = 0; x < width; ++x)
            if (text_has_ink(text, x, y))
                put(picture, left + x, top + y, INK);
}

static void draw_slice(struct picture *picture, const struct slice *slice, double spacing)
{
    for (int y = 0; y < slice->height; ++y)
        for (int x = 0; x < slice->width; ++x)
            put(picture, MARGIN + x, MARGIN + y, shade(slice, (size_t)y * (size_t)slice->width + (size_t)x, spacing));
}

/* A bar of the colours from least to greatest value, its levels named where there is room. */
static void draw_legend(struct picture *picture, const struct slice *slice, double spacing)
{
    const int left = MARGIN + slice->width + MARGIN, top = MARGIN + 2 * TEXT_ROWS * TEXT_SCALE;
    const int height = picture->height - MARGIN - top;
    const double per_row = (slice->max - slice->min) / height;
    draw_text(picture, left, MARGIN, "phi");
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < BAR; ++x)
            put(picture, left + x, top + y, colour_of(slice->max - (y + 0.5) * per_row, slice));

    int last = -TEXT_ROWS * TEXT_SCALE;
    for (double level = floor(slice->max / spacing); level * spacing >= slice->min; --level) {
        const int y = (int)((slice->max - level * spacing) / per_row);
        const int thick = level == 0 ? 1 : 0;
        for (int row = -thick; row <= thick; ++row)
            for (int x = 0; x < BAR + 6; ++x)
                put(picture, left + x, top + y + row, INK);
        if (y - last < TEXT_ROWS * TEXT_SCALE + 4 && level != 0)
            continue;
        char label[32];
        snprintf(label, sizeof label, "%g", level == 0 ? 0 : level * spacing);
        draw_text(picture, left + BAR + 12, top + y - TEXT_ROWS * TEXT_SCALE / 2, label);
        last = y;
    }
}

/* Which axis points where, in the lower left corner. */
static void name_axes(struct picture *picture, const struct slice *slice)
{
    const int left = MARGIN + 14, bottom = MARGIN + slice->height - 22, length = 44;
    const char names[3] = {'x', 'y', 'z'};
    for (int i = 0; i <= length; ++i) {
        for (int thick = 0; thick < 2; ++thick) {
            put(picture, left + i, bottom + thick, INK);
            put(picture, left + thick, bottom - i, INK);
        }
    }
    draw_text(picture, left + length + 6, bottom - TEXT_ROWS * TEXT_SCALE / 2, (char[2]){names[slice->right], '\0'});
    draw_text(picture, left - 4, bottom - length - TEXT_ROWS * TEXT_SCALE - 4, (char[2]){names[slice->up], '\0'});
}

static bool write_png(const struct picture *picture, const char *path)
{
    png_image image;
    memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
    image.width = (png_uint_32)picture->width;
    image.height = (png_uint_32)picture->height;
    image.format = PNG_FORMAT_RGB;
    const bool ok = png_image_write_to_file(&image, path, 0, picture->pixels, 0, NULL) != 0;
    if (!ok)
        fprintf(stderr, "keepout_field: writing %s: %s\n", path, image.message);
    png_image_free(&image);
    return ok;
}

static bool draw(const struct slice *slice, const char *path)
{
    const int height = slice->height > LEAST_HEIGHT ? slice->height : LEAST_HEIGHT; /* the legend's labels need it */
    struct picture picture = {slice->width + 2 * MARGIN + LEGEND, height + 2 * MARGIN, NULL};
    const size_t bytes = 3 * (size_t)picture.width * (size_t)picture.height;
    picture.pixels = malloc(bytes);
    if (picture.pixels == NULL) {
        fprintf(stderr, "keepout_field: no memory for a picture of %zu bytes\n", bytes);
        return false;
    }
    memset(picture.pixels, 255, bytes);
    const double spacing = level_spacing(slice);
    draw_slice(&picture, slice, spacing);
    draw_legend(&picture, slice, spacing);
    name_axes(&picture, slice);
    const bool ok = write_png(&picture, path);
    free(picture.pixels);
    return ok;
}

bool picture_write(const ko_field *field, const ko_fit_report *report, uint32_t n_threads, const char *path)
{
    struct slice slice = {0};
    const bool ok = slice_take(field, report, LONGEST, n_threads, &slice) && draw(&slice, path);
    slice_free(&slice);
    return ok;
}
