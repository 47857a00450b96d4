/* Digits in a picture. SPDX-License-Identifier: Apache-2.0 OR MIT */
#ifndef TEXT_H
#define TEXT_H

#include <stdint.h>

/* Cells of a glyph, the gap behind it included, and picture pixels of a cell. */
enum { TEXT_COLUMNS = 6, TEXT_ROWS = 7, TEXT_SCALE = 2 };

/* Whether the pixel `x`, `y` of `text`, drawn from 0, 0, is ink. Knows what "%g" writes, "phi", x, y and z. */
int text_has_ink(const char *text, int x, int y);

#endif
