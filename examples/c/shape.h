/* A shape to work on where no file is given. SPDX-License-Identifier: Apache-2.0 OR MIT */
#ifndef SHAPE_H
#define SHAPE_H

#include <keepout.h>
#include <stdbool.h>

/* Makes a tube around a trefoil knot, closed, normals out; says on stderr where that fails. The mesh is the caller's. */
bool shape_trefoil(ko_mesh **mesh);

#endif
