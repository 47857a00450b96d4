/* SPDX-License-Identifier: Apache-2.0 OR MIT */
#include "family.h"

#include "../c/failure.h"
#include "../c/progress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool reserve(size_t n, const struct study *study, struct family *family)
{
    memset(family, 0, sizeof *family);
    family->n = n;
    double **arrays[] = {&family->gammas, &family->reached, &family->bounds, &family->largest_gaps, &family->mean_gaps,
                         &family->mma_gammas, &family->mma_sums};
    bool ok = true;
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; ++i)
        ok = (*arrays[i] = calloc(n, sizeof(double))) != NULL && ok;
    ok = (family->volumes = calloc(2 * n, sizeof(double))) != NULL && ok;
    for (int k = 0; k < 2; ++k)
        ok = (family->cells[k] = malloc(n * study->n_cells[k])) != NULL && ok;
    if (!ok)
        fprintf(stderr, "no memory for %zu pairs\n", n);
    return ok;
}

/* How far the parts are from each other over the motion; a part without cells has no gaps. */
static bool measure_gaps(const ko_pair *pair, const struct study *study, size_t n_times, struct family *family)
{
    struct progress progress = progress_start();
    for (size_t k = 0; k < family->n; ++k) {
        const size_t n_1 = study->n_cells[0], n_2 = study->n_cells[1];
        const int32_t status = ko_pair_contact(pair, family->cells[0] + k * n_1, n_1, family->cells[1] + k * n_2, n_2, n_times, 0, NULL, NULL,
                                               NULL, NULL, NULL, &family->largest_gaps[k], &family->mean_gaps[k]);
        if (status == KO_ERR_DEGENERATE)
            family->largest_gaps[k] = family->mean_gaps[k] = NAN;
        else if (!succeeded(status, "measuring gaps"))
            return false;
        progress_show((double)(k + 1) / (double)family->n, "gaps", &progress);
    }
    progress_end(&progress);
    return true;
}

bool family_find(const ko_pair *pair, const struct study *study, size_t n, size_t n_times, struct family *family)
{
    struct progress progress = progress_start();
    ko_family_options options;
    ko_family_options_init(&options, sizeof options);
    options.progress = progress_show;
    options.progress_data = &progress;
    if (!reserve(n, study, family))
        return false;
    for (size_t k = 0; k < n; ++k)
        family->gammas[k] = n > 1 ? (double)k / (double)(n - 1) : study->gamma;
    const int32_t status = ko_pair_family(pair, NULL, NULL, family->gammas, n, &options, study->n_cells[0], study->n_cells[1], family->cells[0],
                                          family->cells[1], family->reached, family->volumes, family->bounds);
    progress_end(&progress);
    return succeeded(status, "finding the family") && measure_gaps(pair, study, n_times, family);
}

static bool optimise_each(const ko_pair *pair, const struct study *study, struct family *family, uint8_t *cells_1, uint8_t *cells_2)
{
    struct progress progress = progress_start();
    for (size_t k = 1; k + 1 < family->n; ++k) {
        ko_optimise_options options;
        ko_optimise_report report;
        ko_optimise_options_init(&options, sizeof options);
        options.gamma = family->gammas[k];
        if (!succeeded(ko_pair_optimise(pair, &options, study->n_cells[0], study->n_cells[1], NULL, NULL, cells_1, cells_2, NULL, sizeof report,
                                        &report),
                       "optimising by moving asymptotes"))
            return false;
        family->mma_gammas[family->n_mma] = report.gamma;
        family->mma_sums[family->n_mma++] = report.volumes[0] + report.volumes[1];
        progress_show((double)k / (double)(family->n - 2), "asymptotes", &progress);
    }
    progress_end(&progress);
    return true;
}

bool family_optimise(const ko_pair *pair, const struct study *study, struct family *family)
{
    uint8_t *cells[2] = {malloc(study->n_cells[0]), malloc(study->n_cells[1])};
    bool ok = cells[0] != NULL && cells[1] != NULL;
    if (ok)
        ok = optimise_each(pair, study, family, cells[0], cells[1]);
    else
        fprintf(stderr, "no memory for a pair\n");
    free(cells[0]);
    free(cells[1]);
    return ok;
}

void family_print(const struct family *family)
{
    printf("  gamma  reached      V_1      V_2      sum    bound  largest gap  mean gap\n");
    for (size_t k = 0; k < family->n; ++k) {
        const double *v = family->volumes + 2 * k;
        printf("%7.3f  %7.4f  %7.4f  %7.4f  %7.4f  %7.4f  %11.5f  %8.5f\n", family->gammas[k], family->reached[k], v[0], v[1], v[0] + v[1],
               family->bounds[k], family->largest_gaps[k], family->mean_gaps[k]);
    }
    if (family->n_mma > 0)
        printf("by moving asymptotes, closed:\n");
    for (size_t k = 0; k < family->n_mma; ++k)
        printf("         %7.4f                    %7.4f\n", family->mma_gammas[k], family->mma_sums[k]);
}

enum { LEFT = 60, TOP = 16, WIDTH = 560, HEIGHT = 300 };

static double x_of(double gamma)
{
    return LEFT + gamma * WIDTH;
}

static double y_of(double sum, double most)
{
    return TOP + (1 - sum / most) * HEIGHT;
}

void family_chart(FILE *file, const struct family *family, size_t shown)
{
    double most = 0;
    for (size_t k = 0; k < family->n; ++k)
        most = fmax(most, family->bounds[k]);
    most = most > 0 ? 1.05 * most : 1;
    fprintf(file,
            "<svg viewBox=\"0 0 %d %d\" width=\"%d\" xmlns=\"http://www.w3.org/2000/svg\" font-family=\"sans-serif\" font-size=\"13\">\n"
            "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"none\" stroke=\"#999\"/>\n",
            LEFT + WIDTH + 20, TOP + HEIGHT + 46, LEFT + WIDTH + 20, LEFT, TOP, WIDTH, HEIGHT);
    for (int k = 0; k <= 5; ++k) {
        const double gamma = 0.2 * k, sum = most * k / 5;
        fprintf(file, "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%.1f</text>\n", x_of(gamma), TOP + HEIGHT + 18, gamma);
        fprintf(file, "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%.3g</text>\n", LEFT - 6, y_of(sum, most) + 4, sum);
    }
    fprintf(file, "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">gamma; V_1 + V_2: bound (line), pairs (dots), moving asymptotes (rings)</text>\n",
            x_of(0.5), TOP + HEIGHT + 38);
    fputs("<polyline fill=\"none\" stroke=\"#888\" stroke-dasharray=\"5 3\" points=\"", file);
    for (size_t k = 0; k < family->n; ++k)
        fprintf(file, "%.1f,%.1f ", x_of(family->gammas[k]), y_of(family->bounds[k], most));
    fputs("\"/>\n", file);
    for (size_t k = 0; k < family->n_mma; ++k)
        fprintf(file, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4.5\" fill=\"none\" stroke=\"#c33\"/>\n", x_of(family->mma_gammas[k]),
                y_of(family->mma_sums[k], most));
    for (size_t k = 0; k < family->n; ++k)
        fprintf(file, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%d\" fill=\"%s\"/>\n", x_of(family->reached[k]),
                y_of(family->volumes[2 * k] + family->volumes[2 * k + 1], most), k == shown ? 6 : 4, k == shown ? "#ed8c33" : "#4075b8");
    fputs("</svg>\n", file);
}

void family_free(struct family *family)
{
    free(family->gammas);
    free(family->reached);
    free(family->volumes);
    free(family->bounds);
    free(family->largest_gaps);
    free(family->mean_gaps);
    free(family->mma_gammas);
    free(family->mma_sums);
    free(family->cells[0]);
    free(family->cells[1]);
    memset(family, 0, sizeof *family);
}
