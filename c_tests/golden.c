/* Fields that earlier versions wrote, kept for good: every later version must read them to the same numbers.
 *
 *   golden FOLDER             checks each FOLDER/NAME.kof against FOLDER/NAME.txt, then spoils copies of it in every way
 *   golden --write FOLDER     makes those that are not there: c_tests/abi/bless.sh calls this before a release. What is there stays
 *
 * A line of the text holds a point, value, gradient and Hessian: 13 numbers in space, 8 in the plane. The file's layout is told in
 * src/field/file.rs. */

#include "check.h"

enum { N_POINTS = 60, MOST_NUMBERS = 13, HEADER = 160, CONTROL_POINTS = 8 };

/* A field kept: of the sphere or the circle, where refined of a lens, named by the version that wrote it first. */
struct golden {
    const char *name;
    int dim;
    /* Points of its cloud, and control points in all. */
    size_t n_points, n_unknowns;
    /* Of the fit: 0 for one grid. */
    double max_error;
    uint32_t n_levels;
};

static const struct golden kept[] = {
    {"field-0.1", 3, 500, CONTROL_POINTS * CONTROL_POINTS * CONTROL_POINTS, 0.0, 1},
    {"field-0.2-plane", 2, 200, CONTROL_POINTS * CONTROL_POINTS, 0.0, 1},
    {"field-0.3-refined", 3, 500, 11565, 1e-2, 3},
    {"field-0.3-refined-plane", 2, 200, 1033, 1e-3, 5},
};
enum { N_KEPT = sizeof kept / sizeof *kept };

static const char *spoiled = "golden-spoiled.kof";

static const char *in_folder(const char *folder, const struct golden *golden, const char *ending) {
    static char path[4096];
    snprintf(path, sizeof path, "%s/%s%s", folder, golden->name, ending);
    return path;
}

/* Numbers of a line: point, value, gradient, Hessian. */
static int n_numbers(const struct golden *golden) {
    return golden->dim == 2 ? 2 + 1 + 2 + 3 : 3 + 1 + 3 + 6;
}

/* ---- the file's bytes ---- */

static unsigned char bytes[131072];
static size_t n_bytes;

static void read_bytes(const char *path) {
    FILE *file = fopen(path, "rb");
    CHECK(file != NULL);
    n_bytes = file == NULL ? 0 : fread(bytes, 1, sizeof bytes, file);
    if (file != NULL) {
        fclose(file);
    }
}

static void write_bytes(const unsigned char *from, size_t n) {
    FILE *file = fopen(spoiled, "wb");
    CHECK(file != NULL && fwrite(from, 1, n, file) == n && fclose(file) == 0);
}

/* Bytes that tell of the cuts of a refined field: their number, less than 2^32 here, and their tiles. */
static size_t cut_bytes(const struct golden *golden) {
    size_t n = 0;
    for (int i = 3; i >= 0; i--) {
        n = n << 8 | bytes[HEADER + i];
    }
    return golden->max_error > 0.0 ? 8 + 4 * n : 0;
}

static uint32_t crc32(const unsigned char *from, size_t n) {
    uint32_t crc = ~(uint32_t)0;
    for (size_t i = 0; i < n; i++) {
        crc ^= from[i];
        for (int bit = 0; bit < 8; bit++) {
            crc = (crc >> 1) ^ (0xedb88320u & (0u - (crc & 1u)));
        }
    }
    return ~crc;
}

static void put_u32(unsigned char *to, uint32_t x) {
    for (int i = 0; i < 4; i++) {
        to[i] = (unsigned char)(x >> (8 * i));
    }
}

static void put_f64(unsigned char *to, double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    put_u32(to, (uint32_t)bits);
    put_u32(to + 4, (uint32_t)(bits >> 32));
}

/* ---- the numbers ---- */

static void evaluate(const ko_field *field, int dim, const double *point, double *numbers) {
    memcpy(numbers, point, (size_t)dim * sizeof *point);
    OK(ko_field_eval(field, point, 1, numbers + dim, numbers + dim + 1, numbers + 2 * dim + 1));
}

/* Points in the box, on its faces and outside it. */
static void place(const ko_fit_report *report, int i, uint64_t *seed, double *point) {
    int dim = (int)report->dim;
    for (int a = 0; a < dim; a++) {
        double low = report->box_min[a], high = report->box_max[a];
        double stretch = i % 3 == 2 ? 3.0 : 1.0;
        point[a] = 0.5 * (low + high) + stretch * (high - low) * (check_random(seed) - 0.5);
    }
    if (i % 3 == 1) {
        int axis = i / 3 % dim;
        point[axis] = i / 9 % 2 ? report->box_min[axis] : report->box_max[axis];
    }
}

static ko_field *field_to_keep(const struct golden *golden) {
    if (golden->max_error == 0.0) {
        return golden->dim == 2 ? check_circle_field(CONTROL_POINTS) : check_sphere_field(CONTROL_POINTS);
    }
    ko_cloud *cloud = check_lens((uint32_t)golden->dim, golden->n_points);
    ko_fit_options options = check_options(CONTROL_POINTS);
    options.max_error = golden->max_error;
    ko_field *field = NULL;
    OK(ko_field_fit(cloud, &options, &field));
    ko_cloud_free(cloud);
    return field;
}

static void write_golden(const char *folder, const struct golden *golden) {
    FILE *there = fopen(in_folder(folder, golden, ".kof"), "rb");
    if (there != NULL) {
        fclose(there);
        return;
    }
    ko_field *field = field_to_keep(golden);
    OK(ko_field_save(field, in_folder(folder, golden, ".kof")));
    ko_fit_report report;
    OK(ko_field_get_report(field, sizeof report, &report));
    FILE *file = fopen(in_folder(folder, golden, ".txt"), "w");
    CHECK(file != NULL);
    uint64_t seed = 1;
    for (int i = 0; file != NULL && i < N_POINTS; i++) {
        double point[3], numbers[MOST_NUMBERS];
        place(&report, i, &seed, point);
        evaluate(field, golden->dim, point, numbers);
        for (int j = 0; j < n_numbers(golden); j++) {
            fprintf(file, "%.17g%c", numbers[j], j == n_numbers(golden) - 1 ? '\n' : ' ');
        }
    }
    CHECK(file != NULL && fclose(file) == 0);
    ko_field_free(field);
}

static void numbers_are_the_same(const char *folder, const struct golden *golden) {
    ko_field *field = NULL;
    OK(ko_field_load(in_folder(folder, golden, ".kof"), &field));
    FILE *file = fopen(in_folder(folder, golden, ".txt"), "r");
    CHECK(file != NULL);
    double right[MOST_NUMBERS], numbers[MOST_NUMBERS];
    int n = 0, j = 0;
    while (file != NULL && fscanf(file, "%lf", &right[j]) == 1) {
        if (++j == n_numbers(golden)) {
            evaluate(field, golden->dim, right, numbers);
            double size = 1.0;
            for (j = golden->dim; j < n_numbers(golden); j++) {
                size = fmax(size, fabs(right[j]));
            }
            for (j = golden->dim; j < n_numbers(golden); j++) {
                CHECK_NEAR(numbers[j], right[j], 1e-13 * size);
            }
            j = 0;
            n++;
        }
    }
    CHECK(n == N_POINTS && j == 0);
    if (file != NULL) {
        fclose(file);
    }
    ko_fit_report report;
    OK(ko_field_get_report(field, sizeof report, &report));
    CHECK(report.dim == (uint32_t)golden->dim);
    CHECK(report.n_unknowns == golden->n_unknowns && report.n_points == golden->n_points);
    CHECK(report.n_levels == golden->n_levels && report.control_points[0] == CONTROL_POINTS);
    CHECK(report.feasible == KO_FEASIBLE_OUTSIDE && report.rms > 0.0 && report.rms < report.max);
    ko_field_free(field);
}

/* ---- files gone bad ---- */

static void fails_to_load(int32_t status, const char *words) {
    ko_field *field = (ko_field *)(uintptr_t)8;
    FAILS(ko_field_load(spoiled, &field), status, words);
    CHECK(field == NULL);
}

/* Places in a file that are looked at: all of the header, one in `step` behind it. */
static size_t next_place(size_t i, size_t step) {
    return i + (i < HEADER ? 1 : step);
}

/* `words` tell what is wrong: how long a refined file should be its header does not say, so a checksum may be what tells. */
static void every_cut_is_an_error(const char *words, size_t step) {
    bytes[n_bytes] = 0;
    write_bytes(bytes, n_bytes + 1);
    fails_to_load(KO_ERR_FORMAT, words);
    write_bytes(bytes, n_bytes);
    for (size_t n = 0; n < n_bytes; n = next_place(n, step)) {
        write_bytes(bytes, n);
        fails_to_load(KO_ERR_FORMAT, words);
    }
}

static void every_change_is_an_error(size_t step) {
    write_bytes(bytes, n_bytes);
    FILE *file = fopen(spoiled, "r+b");
    CHECK(file != NULL);
    for (size_t i = 0; file != NULL && i < n_bytes; i = next_place(i, step)) {
        for (int bit = 1; bit < 256; bit *= 4) {
            const int changes[] = {bytes[i] ^ bit, bytes[i]};
            for (int c = 0; c < 2; c++) {
                CHECK(fseek(file, (long)i, SEEK_SET) == 0 && fputc(changes[c], file) == changes[c] && fflush(file) == 0);
                if (c == 0) {
                    fails_to_load(KO_ERR_FORMAT, spoiled);
                }
            }
        }
    }
    if (file != NULL) {
        fclose(file);
    }
}

/* Changes that a checksum of their own makes look right: made on a copy of `n` bytes, the last four of which become it. */
static unsigned char crafted[131072];

static void craft(size_t n) {
    put_u32(crafted + n - 4, crc32(crafted, n - 4));
    write_bytes(crafted, n);
}

struct count {
    size_t at;
    uint32_t x;
    const char *words;
};

static void crafted_counts_are_not_believed(const struct count *counts, size_t n_counts) {
    memcpy(crafted, bytes, n_bytes);
    craft(n_bytes);
    ko_field *field = NULL;
    OK(ko_field_load(spoiled, &field)); /* The checksum here is the right one. */
    ko_field_free(field);
    for (size_t i = 0; i < n_counts; i++) {
        memcpy(crafted, bytes, n_bytes);
        put_u32(crafted + counts[i].at, counts[i].x);
        craft(n_bytes);
        fails_to_load(KO_ERR_FORMAT, counts[i].words);
    }
}

/* What is said of z in the plane is 0. */
static void crafted_headers_of_the_plane_are_not_believed(void) {
    const struct count counts[] = {
        {8, 3, "version 3"},  {8, 2, "altered"},           {12, 3, "0 control points"}, {12, 1, "dimension 1"}, {16, 3, "3 control points"},
        {20, 9, "announces"}, {24, 4, "along z"},          {28, 2, "side is 2"},
    };
    crafted_counts_are_not_believed(counts, sizeof counts / sizeof *counts);
    const size_t of_z[] = {48, 72};
    for (int i = 0; i < 2; i++) {
        memcpy(crafted, bytes, n_bytes);
        put_f64(crafted + of_z[i], 0.5);
        craft(n_bytes);
        fails_to_load(KO_ERR_FORMAT, "along z");
    }
}

static void crafted_headers_are_not_believed(void) {
    const struct count counts[] = {
        {8, 3, "version 3"},         {8, 2, "altered"},         {12, 4, "dimension 4"}, {12, 2, "along z"},   {16, 3, "3 control points"},
        {20, 0, "0 control points"}, {24, 9, "announces"},   {24, 7, "announces"}, {16, UINT32_MAX, "announces"},
        {28, 2, "side is 2"},
    };
    crafted_counts_are_not_believed(counts, sizeof counts / sizeof *counts);
    memcpy(crafted, bytes, n_bytes);
    for (int a = 0; a < 3; a++) {
        put_u32(crafted + 16 + 4 * a, UINT32_MAX);
    }
    craft(n_bytes);
    fails_to_load(KO_ERR_FORMAT, "announces");
    craft(HEADER + 4);
    fails_to_load(KO_ERR_FORMAT, "announces");

    /* Corner, cell edge, diagonal, a control point. */
    const struct {
        size_t at;
        double x;
    } numbers[] = {{32, NAN}, {48, INFINITY}, {56, 0.0}, {64, -1.0}, {72, NAN}, {80, 0.0}, {HEADER + 8 * 77, NAN}};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        memcpy(crafted, bytes, n_bytes);
        put_f64(crafted + numbers[i].at, numbers[i].x);
        craft(n_bytes);
        fails_to_load(KO_ERR_FORMAT, "finite");
    }
}

static void crafted_cuts_are_not_believed(void) {
    const struct count counts[] = {
        {8, 1, "announces"}, {8, 3, "version 3"}, {20, 9, "control points"}, {HEADER, UINT32_MAX, "announces"},
        {HEADER + 8, UINT32_MAX, "cut 0 is of tile"},
    };
    crafted_counts_are_not_believed(counts, sizeof counts / sizeof *counts);
}

int main(int argc, char **argv) {
    if (argc == 3 && strcmp(argv[1], "--write") == 0) {
        for (int i = 0; i < N_KEPT; i++) {
            write_golden(argv[2], &kept[i]);
        }
        return check_result();
    }
    if (argc != 2) {
        fprintf(stderr, "usage: golden [--write] FOLDER\n");
        return EXIT_FAILURE;
    }
    for (int i = 0; i < N_KEPT; i++) {
        numbers_are_the_same(argv[1], &kept[i]);
        read_bytes(in_folder(argv[1], &kept[i], ".kof"));
        CHECK(n_bytes == HEADER + cut_bytes(&kept[i]) + 8 * kept[i].n_unknowns + 4);
        if (check_failures > 0) {
            break;
        }
        int refined = kept[i].max_error > 0.0;
        every_cut_is_an_error(refined ? spoiled : "bytes", refined ? 101 : 1);
        every_change_is_an_error(refined ? 101 : 11);
        if (refined) {
            crafted_cuts_are_not_believed();
        } else if (kept[i].dim == 2) {
            crafted_headers_of_the_plane_are_not_believed();
        } else {
            crafted_headers_are_not_believed();
        }
    }
    CHECK(remove(spoiled) == 0);
    return check_result();
}
