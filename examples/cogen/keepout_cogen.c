/* Two parts out of a motion alone: the case studies of Morris and Behandish 2022, section 5. Finds the family of pairs that never collide, prints
 * it, and writes a page on which one of them runs. SPDX-License-Identifier: Apache-2.0 OR MIT */
#include "cases.h"
#include "family.h"
#include "page.h"

#include "../c/failure.h"
#include "../c/progress.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct options {
    const char *study, *folder;
    size_t cells, pairs;
    double gamma; /* of the pair that is shown; below 0: the paper's */
    bool paper, asymptotes;
};

static void usage(FILE *file)
{
    fputs("usage: keepout_cogen STUDY [OPTION...], of", file);
    for (size_t i = 0; STUDIES[i] != NULL; ++i)
        fprintf(file, " %s", STUDIES[i]);
    fputs("\n"
          "  --cells N      cells along the parts' edge L; those of the paper otherwise, 400 in the plane, then 105 and 50\n"
          "  --pairs N      pairs of the family, for gammas from 0 to 1; 11 otherwise, in space 5\n"
          "  --gamma X      shows the pair that is nearest to this; that of the paper otherwise\n"
          "  --paper        conflicts of the paper's measure, instead of those of whole cells at all times\n"
          "  --asymptotes   finds pairs by the paper's method too, moving asymptotes, for comparison\n"
          "  --folder PATH  where page and pictures go, which must be there; . otherwise\n",
          file);
}

static bool number_of(const char *text, double *number)
{
    char *end = NULL;
    errno = 0;
    *number = strtod(text, &end);
    if (end != text && *end == '\0' && errno == 0 && isfinite(*number))
        return true;
    fprintf(stderr, "keepout_cogen: '%s' is not a number\n", text);
    return false;
}

static bool count_of(const char *text, size_t *count)
{
    double number;
    if (!number_of(text, &number))
        return false;
    if (!(number >= 1 && number <= 1e6 && number == floor(number))) {
        fprintf(stderr, "keepout_cogen: %s is no count; a whole number from 1 to 1e6 is\n", text);
        return false;
    }
    *count = (size_t)number;
    return true;
}

static bool read_options(int argc, char **argv, struct options *options)
{
    *options = (struct options){.folder = ".", .gamma = -1};
    for (int i = 1; i < argc; ++i) {
        const char *name = argv[i], *value = i + 1 < argc ? argv[i + 1] : NULL;
        if (strcmp(name, "--paper") == 0)
            options->paper = true;
        else if (strcmp(name, "--asymptotes") == 0)
            options->asymptotes = true;
        else if (strncmp(name, "--", 2) != 0 && options->study == NULL)
            options->study = name;
        else if (value != NULL && strcmp(name, "--cells") == 0 && count_of(value, &options->cells))
            ++i;
        else if (value != NULL && strcmp(name, "--pairs") == 0 && count_of(value, &options->pairs))
            ++i;
        else if (value != NULL && strcmp(name, "--gamma") == 0 && number_of(value, &options->gamma))
            ++i;
        else if (value != NULL && strcmp(name, "--folder") == 0 && ++i > 0)
            options->folder = value;
        else {
            fprintf(stderr, "keepout_cogen: what is '%s'?\n", name);
            return false;
        }
    }
    return options->study != NULL;
}

static bool make_pair(const struct study *study, const struct options *wanted, ko_pair **pair)
{
    struct progress progress = progress_start();
    ko_pair_options options;
    ko_pair_options_init(&options, sizeof options);
    options.conflicts = wanted->paper ? KO_CONFLICTS_OF_MEASURE : KO_CONFLICTS_OF_OVERLAP;
    options.measure_steps = wanted->paper || wanted->asymptotes ? study->steps : 0;
    options.progress = progress_show;
    options.progress_data = &progress;
    const int32_t status = ko_pair_create(study->parts[0], study->motions[0], study->parts[1], study->motions[1], &options, pair);
    progress_end(&progress);
    return succeeded(status, "finding conflicts");
}

static void print_pair(const ko_pair *pair)
{
    ko_pair_report report;
    if (!succeeded(ko_pair_get_report(pair, sizeof report, &report), "asking for a report"))
        return;
    printf("conflicts: %.3g, in %.0f MB; cells that collide at the beginning: %llu of %llu, and %llu of %llu\n", (double)report.n_edges,
           (double)report.graph_bytes / 1e6, (unsigned long long)report.n_colliding[0], (unsigned long long)report.n_cells[0],
           (unsigned long long)report.n_colliding[1], (unsigned long long)report.n_cells[1]);
}

/* The pair that comes nearest to `gamma`. */
static size_t nearest(const struct family *family, double gamma)
{
    size_t best = 0;
    for (size_t k = 1; k < family->n; ++k)
        if (fabs(family->reached[k] - gamma) < fabs(family->reached[best] - gamma))
            best = k;
    return best;
}

static bool run(const struct study *study, const struct options *options)
{
    ko_pair *pair = NULL;
    struct family family = {0};
    const size_t n = options->pairs > 0 ? options->pairs : study->dim == 2 ? 11 : 5;
    bool ok = make_pair(study, options, &pair);
    if (ok)
        print_pair(pair);
    ok = ok && family_find(pair, study, n, study->dim == 2 ? 1000 : 200, &family);
    ok = ok && (!options->asymptotes || family_optimise(pair, study, &family));
    if (ok) {
        family_print(&family);
        const size_t shown = nearest(&family, options->gamma < 0 ? study->gamma : options->gamma);
        ok = page_write(study, family.cells[0] + shown * study->n_cells[0], family.cells[1] + shown * study->n_cells[1], &family, shown,
                        options->folder);
        if (ok)
            printf("page: %s/%s.html\n", options->folder, study->name);
    }
    family_free(&family);
    ko_pair_free(pair);
    return ok;
}

int main(int argc, char **argv)
{
    struct options options;
    struct study study;
    if (argc == 2 && (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0)) {
        usage(stdout);
        return EXIT_SUCCESS;
    }
    if (!read_options(argc, argv, &options)) {
        usage(stderr);
        return EXIT_FAILURE;
    }
    if (!study_make(options.study, options.cells, &study))
        return EXIT_FAILURE;
    printf("%s, %zu cells along L\n", study.title, study.cells);
    const bool ok = run(&study, &options);
    study_free(&study);
    return ok ? EXIT_SUCCESS : EXIT_FAILURE;
}
