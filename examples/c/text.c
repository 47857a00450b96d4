/* SPDX-License-Identifier: Apache-2.0 OR MIT */
#include "text.h"

#include <string.h>

/* Rows of five cells from the top, the leftmost cell in the highest bit. */
static const struct {
    char letter;
    uint8_t rows[TEXT_ROWS];
} glyphs[] = {
    {'0', {14, 17, 19, 21, 25, 17, 14}}, {'1', {4, 12, 4, 4, 4, 4, 14}},    {'2', {14, 17, 1, 6, 8, 16, 31}},
    {'3', {14, 17, 1, 6, 1, 17, 14}},    {'4', {2, 6, 10, 18, 31, 2, 2}},   {'5', {31, 16, 30, 1, 1, 17, 14}},
    {'6', {6, 8, 16, 30, 17, 17, 14}},   {'7', {31, 1, 2, 4, 8, 8, 8}},     {'8', {14, 17, 17, 14, 17, 17, 14}},
    {'9', {14, 17, 17, 15, 1, 2, 12}},   {'.', {0, 0, 0, 0, 0, 12, 12}},    {'-', {0, 0, 0, 31, 0, 0, 0}},
    {'+', {0, 4, 4, 31, 4, 4, 0}},       {'e', {0, 0, 14, 17, 31, 16, 14}}, {'p', {0, 0, 30, 17, 30, 16, 16}},
    {'h', {16, 16, 22, 25, 17, 17, 17}}, {'i', {4, 0, 12, 4, 4, 4, 14}},    {'x', {0, 0, 17, 10, 4, 10, 17}},
    {'y', {0, 0, 17, 17, 15, 1, 14}},    {'z', {0, 0, 31, 2, 4, 8, 31}},
};

int text_has_ink(const char *text, int x, int y)
{
    if (x < 0 || y < 0 || y >= TEXT_ROWS * TEXT_SCALE)
        return 0;
    const int column = x / TEXT_SCALE, row = y / TEXT_SCALE;
    const size_t at = (size_t)(column / TEXT_COLUMNS);
    if (at >= strlen(text))
        return 0;
    for (size_t g = 0; g < sizeof glyphs / sizeof glyphs[0]; ++g)
        if (glyphs[g].letter == text[at])
            return (glyphs[g].rows[row] << (column % TEXT_COLUMNS)) & 16 ? 1 : 0;
    return 0;
}
