/* Closed curves of the plane from files. SPDX-License-Identifier: Apache-2.0 OR MIT */
#ifndef CURVES_H
#define CURVES_H

#include <keepout.h>
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Whether `path` ends as the files do that curves_read knows: .dat, .csv, .yaml, .yml. */
bool curves_are_in(const char *path);

/*
 * Reads closed curves into a mesh of the plane, on whose left the solid lies, whichever way the file runs around it:
 *   .dat   an airfoil: a title, then x y a line, around from the trailing edge (Selig), or upper and lower side apart, counted (Lednicer)
 *   .csv   x, y a line, perhaps below a header; an empty line ends a curve and begins another
 *   .yaml  the boundaries of IEA Wind Task 37: lines "- [x, y]" under "boundaries:", a curve below each name
 * A curve inside another is a hole, one inside that an island. Says on stderr what is wrong, with the line. The mesh is the caller's.
 */
bool curves_read(const char *path, ko_mesh **mesh);

#ifdef __cplusplus
}
#endif

#endif
