/* SPDX-License-Identifier: Apache-2.0 OR MIT */
#define _POSIX_C_SOURCE 200112L /* isatty */

#include "page.h"

#include <errno.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { WIDTH_PLANE = 480, WIDTH_SPACE = 400, LONGEST_PATH = 4096 };

static bool failed(const char *path, const char *why)
{
    fprintf(stderr, "\nwriting %s: %s\n", path, why);
    return false;
}

/* The picture as PNG; to be freed. */
static uint8_t *png_of(const struct scene *scene, const uint8_t *pixels, size_t *bytes)
{
    png_image image;
    memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
    image.width = (png_uint_32)scene->width;
    image.height = (png_uint_32)scene->height;
    image.format = PNG_FORMAT_RGB;
    png_alloc_size_t size = 0;
    uint8_t *png = NULL;
    if (png_image_write_to_memory(&image, NULL, &size, 0, pixels, 0, NULL) != 0)
        png = malloc(size);
    if (png != NULL && png_image_write_to_memory(&image, png, &size, 0, pixels, 0, NULL) == 0) {
        free(png);
        png = NULL;
    }
    png_image_free(&image);
    *bytes = size;
    return png;
}

static bool write_file(const char *path, const uint8_t *bytes, size_t n)
{
    FILE *file = fopen(path, "wb");
    if (file == NULL)
        return failed(path, strerror(errno));
    const bool ok = fwrite(bytes, 1, n, file) == n;
    return (fclose(file) == 0 && ok) || failed(path, strerror(errno));
}

static void write_base64(FILE *file, const uint8_t *bytes, size_t n)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < n; i += 3) {
        const uint32_t b1 = i + 1 < n ? bytes[i + 1] : 0, b2 = i + 2 < n ? bytes[i + 2] : 0;
        const uint32_t group = (uint32_t)bytes[i] << 16 | b1 << 8 | b2;
        fputc(digits[group >> 18], file);
        fputc(digits[group >> 12 & 63], file);
        fputc(i + 1 < n ? digits[group >> 6 & 63] : '=', file);
        fputc(i + 2 < n ? digits[group & 63] : '=', file);
    }
}

/* Draws the frames, each into a file of its own and into the page. */
static bool write_frames(FILE *page, const struct scene *scene, const char *folder)
{
    const bool terminal = isatty(STDERR_FILENO) != 0;
    uint8_t *pixels = malloc(3 * (size_t)scene->width * (size_t)scene->height);
    if (pixels == NULL)
        return failed(folder, "no memory for a picture");
    bool ok = true;
    for (int frame = 0; ok && frame < PAGE_FRAMES; ++frame) {
        char path[LONGEST_PATH];
        size_t bytes = 0;
        snprintf(path, sizeof path, "%s/%s_%03d.png", folder, scene->study->name, frame);
        ok = scene_draw(scene, (frame + 0.5) / PAGE_FRAMES, pixels);
        uint8_t *png = ok ? png_of(scene, pixels, &bytes) : NULL;
        ok = ok && (png != NULL ? write_file(path, png, bytes) : failed(path, "libpng refuses the picture"));
        if (ok) {
            fputs(frame > 0 ? ",\n\"data:image/png;base64," : "\"data:image/png;base64,", page);
            write_base64(page, png, bytes);
            fputc('"', page);
        }
        free(png);
        if (terminal)
            fprintf(stderr, "\rpictures: %d of %d", frame + 1, PAGE_FRAMES);
    }
    if (terminal)
        fputc('\n', stderr);
    free(pixels);
    return ok;
}

static void write_table(FILE *page, const struct family *family, size_t shown)
{
    fputs("<table><tr><th>gamma</th><th>reached</th><th>V<sub>1</sub></th><th>V<sub>2</sub></th><th>sum</th><th>bound</th>"
          "<th>largest gap</th><th>mean gap</th></tr>\n",
          page);
    for (size_t k = 0; k < family->n; ++k) {
        const double *v = family->volumes + 2 * k;
        fprintf(page, "<tr%s><td>%.2f</td><td>%.4f</td><td>%.4f</td><td>%.4f</td><td>%.4f</td><td>%.4f</td>",
                k == shown ? " class=\"shown\"" : "", family->gammas[k], family->reached[k], v[0], v[1], v[0] + v[1], family->bounds[k]);
        fprintf(page, "<td>%.4f</td><td>%.4f</td></tr>\n", family->largest_gaps[k], family->mean_gaps[k]);
    }
    fputs("</table>\n", page);
}

static bool write_page(FILE *page, const struct study *study, const uint8_t *set_1, const uint8_t *set_2, const struct family *family,
                       size_t shown, const char *folder)
{
    struct scene scene;
    const int width = study->dim == 2 ? WIDTH_PLANE : WIDTH_SPACE;
    fprintf(page,
            "<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\n"
            "<title>%s</title>\n<style>body{font:16px sans-serif;max-width:60em;margin:1em auto;padding:0 1em}img,svg{max-width:100%%}"
            "table{border-collapse:collapse}td,th{padding:.15em .7em;text-align:right}.shown{background:#fff0d8}"
            "input{width:20em;max-width:90%%}</style>\n",
            study->title);
    fprintf(page, "<h1>%s</h1>\n<p>Part 1 is blue, part 2 is orange.", study->title);
    if (family != NULL)
        fprintf(page, " The pair of gamma %.2f.", family->reached[shown]);
    fprintf(page,
            "</p>\n<img id=\"frame\" alt=\"both parts\"><br>\n"
            "<input id=\"time\" type=\"range\" min=\"0\" max=\"%d\" value=\"0\" aria-label=\"time\"> <button id=\"run\">stop</button>\n",
            PAGE_FRAMES - 1);
    if (family != NULL) {
        fputs("<h2>The family</h2>\n", page);
        family_chart(page, family, shown);
        write_table(page, family, shown);
    }
    fputs("<script>\nconst frames = [\n", page);
    if (!scene_make(study, set_1, set_2, width, &scene))
        return false;
    const bool ok = write_frames(page, &scene, folder);
    scene_free(&scene);
    fputs("];\nconst image = document.getElementById('frame'), time = document.getElementById('time'), run = document.getElementById('run');\n"
          "const show = () => { image.src = frames[time.value]; };\n"
          "let timer = null;\n"
          "const toggle = () => {\n"
          "  if (timer) { clearInterval(timer); timer = null; run.textContent = 'run'; return; }\n"
          "  timer = setInterval(() => { time.value = (Number(time.value) + 1) % frames.length; show(); }, 80);\n"
          "  run.textContent = 'stop';\n"
          "};\n"
          "time.oninput = show;\nrun.onclick = toggle;\nshow();\ntoggle();\n</script>\n</html>\n",
          page);
    return ok;
}

bool page_write(const struct study *study, const uint8_t *set_1, const uint8_t *set_2, const struct family *family, size_t shown,
                const char *folder)
{
    char path[LONGEST_PATH];
    snprintf(path, sizeof path, "%s/%s.html", folder, study->name);
    FILE *page = fopen(path, "w");
    if (page == NULL)
        return failed(path, strerror(errno));
    const bool ok = write_page(page, study, set_1, set_2, family, shown, folder), written = ferror(page) == 0;
    if (fclose(page) != 0 || !written)
        return failed(path, "the disk is full, or gone");
    return ok;
}
