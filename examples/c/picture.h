/* A slice of a field as a picture. SPDX-License-Identifier: Apache-2.0 OR MIT */
#ifndef PICTURE_H
#define PICTURE_H

#include <keepout.h>
#include <stdbool.h>

/* Writes a slice through the middle of the field's box to `path`, a PNG: colours, contours, a legend. Says on stderr where that fails. */
bool picture_write(const ko_field *field, const ko_fit_report *report, uint32_t n_threads, const char *path);

#endif
