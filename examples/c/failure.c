/* SPDX-License-Identifier: Apache-2.0 OR MIT */
#include "failure.h"

#include <keepout.h>
#include <stdio.h>

bool succeeded(int32_t status, const char *doing)
{
    if (status < 0)
        fprintf(stderr, "keepout: %s: %s (%s)\n", doing, ko_last_error(), ko_status_string(status));
    return status >= 0;
}
