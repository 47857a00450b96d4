/* How this program says that something failed. SPDX-License-Identifier: Apache-2.0 OR MIT */
#ifndef FAILURE_H
#define FAILURE_H

#include <stdbool.h>
#include <stdint.h>

/* Whether a call of Keepout's did what it says; where not, the library's message goes to stderr behind `doing`. */
bool succeeded(int32_t status, const char *doing);

#endif
