#ifndef CT_SRC_SOLID_LATTICE_H
#define CT_SRC_SOLID_LATTICE_H

#include "kernel.h"

/* A body of equal boxes whose elements and nodes are numbered as ct_mesh_create_box does needs no
 * table: the nodes of an element, and the elements at a node, follow from their numbers. Element
 * forces stand in a ring that the nodes follow closely (eq:lattice-ring). */

/* Threads that have a ring each; more of them share. */
enum { CT_MOST_RINGS = 64 };

/* Cells along a row below which tables are faster than sums row by row. */
enum { CT_SHORTEST_ROW = 8 };

/* Write cells, axes and corners of a part whose mesh is numbered so and has rows that are long
 * enough; answers 0, and writes no cells, otherwise. */
int ct_lattice_find(const ct_mesh *mesh, ct_solid_part *part);

/* Choose the size of its rings; answers how many doubles of the scratch they take. */
int64_t ct_lattice_prepare(ct_solid_part *part);

/* Number of the first node that waits for element `element` or a later one. */
int32_t ct_lattice_ready(const ct_solid_part *part, int32_t element);

/* The first element that the nodes first, first + 1, ... may have. */
int32_t ct_lattice_begin(const ct_solid_part *part, int32_t first);

/* The batches of the elements of a node, some more than once; answers how many, eight at most. */
int32_t ct_lattice_batches(const ct_solid_part *part, int32_t node, int32_t batch[8]);

/* Sum the element forces at the nodes first ... last - 1 of the body, in the order of
 * ct_assembly_gather (eq:tree-sum). */
void ct_lattice_gather(const ct_solid_part *part, const double *values, int32_t first, int32_t last,
                       double *f);

#endif
