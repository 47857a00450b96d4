/* A page of HTML that needs nothing else: pictures that run, a chart, a table. SPDX-License-Identifier: Apache-2.0 OR MIT */
#ifndef PAGE_H
#define PAGE_H

#include "family.h"
#include "scene.h"

enum { PAGE_FRAMES = 48 };

/* Writes `folder`/NAME.html, on which both sets run, and its frames as PNG to `folder`/NAME_000.png and on. `family`, of which the pair is number
 * `shown`, may be NULL. Says on stderr where that fails. */
bool page_write(const struct study *study, const uint8_t *set_1, const uint8_t *set_2, const struct family *family, size_t shown,
                const char *folder);

#endif
