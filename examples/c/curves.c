/* SPDX-License-Identifier: Apache-2.0 OR MIT */
#include "curves.h"

#include "failure.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST_LINE = 1024 };

struct curves {
    double *points; /* [2 * n_points] */
    size_t n_points, points_room;
    size_t *starts; /* [n_curves], index of the first point of each */
    size_t n_curves, starts_room;
};

/* What a line of a file is to its reader. */
enum line { LINE_POINT, LINE_EMPTY, LINE_TEXT };

struct reader {
    const char *path;
    size_t line;
    bool in_boundaries; /* .yaml: below the key "boundaries:" */
    bool ends_curve;    /* the next point begins a curve */
    struct curves curves;
};

static bool fails(const struct reader *reader, const char *what)
{
    fprintf(stderr, "keepout_field: %s, line %zu: %s\n", reader->path, reader->line, what);
    return false;
}

/* Makes room for one entry of `size` more; `*room` counts entries. */
static bool grow(void **array, size_t n, size_t *room, size_t size)
{
    if (n < *room)
        return true;
    const size_t more = *room == 0 ? 256 : 2 * *room;
    void *grown = realloc(*array, more * size);
    if (grown == NULL)
        return false;
    *array = grown;
    *room = more;
    return true;
}

static bool add(struct reader *reader, const double point[2])
{
    struct curves *curves = &reader->curves;
    void *starts = curves->starts, *points = curves->points;
    const bool ok = grow(&starts, curves->n_curves, &curves->starts_room, sizeof *curves->starts) &&
                    grow(&points, curves->n_points, &curves->points_room, 2 * sizeof *curves->points);
    curves->starts = starts;
    curves->points = points;
    if (!ok)
        return fails(reader, "no memory for more points");
    if (reader->ends_curve)
        curves->starts[curves->n_curves++] = curves->n_points;
    reader->ends_curve = false;
    memcpy(curves->points + 2 * curves->n_points++, point, 2 * sizeof *point);
    return true;
}

/* Two numbers with blanks or one of , ; between, and nothing behind them but blanks and `end`. */
static enum line parse_pair(const char *text, char end, double point[2])
{
    const char *at = text + strspn(text, " \t\r\n");
    if (*at == '\0')
        return LINE_EMPTY;
    for (int k = 0; k < 2; ++k) {
        char *behind;
        point[k] = strtod(at, &behind);
        if (behind == at)
            return LINE_TEXT;
        at = behind + strspn(behind, " \t\r\n");
        if (k == 0 && (*at == ',' || *at == ';'))
            ++at;
    }
    if (end != '\0' && *at == end)
        ++at;
    return at[strspn(at, " \t\r\n")] == '\0' ? LINE_POINT : LINE_TEXT;
}

static bool take_yaml(struct reader *reader, const char *text)
{
    const char *at = text + strspn(text, " \t\r\n");
    if (*at == '\0' || *at == '#')
        return true;
    if (at == text && *at != '-') /* a key of the file's own */
        reader->in_boundaries = strncmp(text, "boundaries:", strlen("boundaries:")) == 0;
    if (!reader->in_boundaries)
        return true;
    if (*at != '-') {
        reader->ends_curve = true;
        return true;
    }
    at += 1 + strspn(at + 1, " \t");
    double point[2];
    if (*at != '[' || parse_pair(at + 1, ']', point) != LINE_POINT)
        return fails(reader, "a boundary's point is expected, '- [x, y]'");
    return add(reader, point);
}

/* Of .csv and .dat; in a .dat an empty line ends nothing, since airfoils are one curve. */
static bool take_pair(struct reader *reader, const char *text, bool empty_line_ends)
{
    double point[2];
    switch (parse_pair(text, '\0', point)) {
    case LINE_POINT:
        return add(reader, point);
    case LINE_EMPTY:
        reader->ends_curve = reader->ends_curve || empty_line_ends;
        return true;
    default:
        return reader->curves.n_points == 0 || fails(reader, "two numbers are expected, x and y");
    }
}

static bool ends_with(const char *text, const char *end)
{
    const size_t n = strlen(text), m = strlen(end);
    return n >= m && strcmp(text + n - m, end) == 0;
}

static bool is_yaml(const char *path)
{
    return ends_with(path, ".yaml") || ends_with(path, ".yml");
}

static bool read_lines(FILE *file, struct reader *reader)
{
    const bool yaml = is_yaml(reader->path), airfoil = ends_with(reader->path, ".dat");
    char text[LONGEST_LINE];
    for (reader->line = 1; fgets(text, sizeof text, file) != NULL; ++reader->line) {
        if (strlen(text) == sizeof text - 1)
            return fails(reader, "the line is too long");
        if (!(yaml ? take_yaml(reader, text) : take_pair(reader, text, !airfoil)))
            return false;
    }
    return ferror(file) ? fails(reader, "cannot be read") : reader->curves.n_points > 0 || fails(reader, "there are no points");
}

/* Reverses the points from `from` until `to`. */
static void reverse(double *points, size_t from, size_t to)
{
    for (size_t i = from, j = to; i + 1 < j; ++i) {
        --j;
        for (int k = 0; k < 2; ++k) {
            const double kept = points[2 * i + k];
            points[2 * i + k] = points[2 * j + k];
            points[2 * j + k] = kept;
        }
    }
}

/*
 * Lednicer's airfoils begin with the counts of both sides where a coordinate, in chords, would be; each side runs from the nose. Drops the
 * counts and turns the upper side, so that the points run around as Selig's do.
 */
static bool join_sides(struct reader *reader)
{
    struct curves *curves = &reader->curves;
    double *points = curves->points;
    if (!(points[0] > 1.5 && points[1] > 1.5))
        return true;
    if (!(points[0] + points[1] + 1 == (double)curves->n_points))
        return fails(reader, "the counts of the airfoil's sides are not those of its points");
    reverse(points, 1, 1 + (size_t)points[0]);
    --curves->n_points;
    memmove(points, points + 2, 2 * curves->n_points * sizeof *points);
    return true;
}

static size_t end_of(const struct curves *curves, size_t curve)
{
    return curve + 1 < curves->n_curves ? curves->starts[curve + 1] : curves->n_points;
}

static double signed_area(const struct curves *curves, size_t curve)
{
    const size_t from = curves->starts[curve], to = end_of(curves, curve);
    const double *origin = curves->points + 2 * from;
    double sum = 0;
    for (size_t i = from; i + 1 < to; ++i) {
        const double *a = curves->points + 2 * i, *b = a + 2;
        sum += (a[0] - origin[0]) * (b[1] - origin[1]) - (a[1] - origin[1]) * (b[0] - origin[0]);
    }
    return 0.5 * sum;
}

/* Whether `curve` goes around `p`: it crosses the ray from p along x an odd number of times. */
static bool goes_around(const struct curves *curves, size_t curve, const double *p)
{
    const size_t from = curves->starts[curve], to = end_of(curves, curve);
    bool inside = false;
    for (size_t i = from, j = to - 1; i < to; j = i++) {
        const double *a = curves->points + 2 * i, *b = curves->points + 2 * j;
        if ((a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
            inside = !inside;
    }
    return inside;
}

/* Turns each curve so that the solid is on its left: counter-clockwise but for holes, which lie in an odd number of others. */
static void orient(struct curves *curves)
{
    for (size_t curve = 0; curve < curves->n_curves; ++curve) {
        bool hole = false;
        for (size_t other = 0; other < curves->n_curves; ++other)
            hole ^= other != curve && goes_around(curves, other, curves->points + 2 * curves->starts[curve]);
        if ((signed_area(curves, curve) < 0) != hole)
            reverse(curves->points, curves->starts[curve], end_of(curves, curve));
    }
}

bool curves_are_in(const char *path)
{
    return is_yaml(path) || ends_with(path, ".dat") || ends_with(path, ".csv");
}

bool curves_read(const char *path, ko_mesh **mesh)
{
    struct reader reader = {.path = path, .ends_curve = true};
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        fprintf(stderr, "keepout_field: %s cannot be opened\n", path);
        return false;
    }
    bool ok = read_lines(file, &reader) && (!ends_with(path, ".dat") || join_sides(&reader));
    fclose(file);
    if (ok) {
        const struct curves *curves = &reader.curves;
        orient(&reader.curves);
        ok = succeeded(ko_mesh_from_polylines(curves->points, curves->n_points, curves->starts, curves->n_curves, /*closed*/ 1, mesh),
                       "making curves");
    }
    free(reader.curves.points);
    free(reader.curves.starts);
    return ok;
}
