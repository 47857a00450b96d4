/* What the program prints. SPDX-License-Identifier: Apache-2.0 OR MIT */
#ifndef TABLES_H
#define TABLES_H

#include <keepout.h>
#include <stdbool.h>

/* `dim` 2: of curves in the plane. */
void print_mesh_report(const ko_mesh_report *report, uint32_t dim);

void print_fit_report(const ko_fit_report *report);

/* Evaluates the field at a few points on a line through its box and beyond, beside the exact distance to the mesh. */
bool print_probe(const ko_mesh *mesh, const ko_field *field, const ko_fit_report *report);

#endif
