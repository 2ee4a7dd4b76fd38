#ifndef CT_SRC_SOLID_PLANE_H
#define CT_SRC_SOLID_PLANE_H

#include "kernel.h"

/* One layer of equal boxes in plane strain: the nodes of the lower layer stand for both. */
typedef struct ct_plane {
  /* The direction that the layer is held in, and the two others, ascending. */
  int axis, p, q;
  /* Nodes of the lower layer, shape (batches, 4, 8 lanes); corners (-,-), (+,-), (-,+), (+,+) in p and q. */
  int32_t *batch_nodes;
  /* Null where the body is a lattice (`cells` of the part). For each node of the body: its partner in the other layer, and where component 0 of the forces of its four elements stands in the
   * values, shape (node_count, 4). */
  int32_t *twin, *place;
  /* For each node: 0 in the lower layer, 1 in the upper one. */
  int8_t *upper;
  /* Runs of nodes of the lower layer whose numbers follow each other, as their partners' do: first node, partner, count. */
  int32_t (*runs)[3], run_count;
  /* The elements' values: where a batch begins after the one before, and each of its 12 rows of 8, corner by corner, after the one before. Zeros follow. */
  int64_t batch_step, row_step, value_count;
} ct_plane;

/* The plane of a part of boxes, if it is one layer along `axis` and each node has at most one element in each quadrant; else null, with
 * CT_OK. CT_ERROR_MEMORY. */
ct_status ct_plane_create(const ct_solid_part *part, int axis, ct_plane **plane);

void ct_plane_free(ct_plane *plane);

/* Whether the layers have moved alike, to the bit, and not at all along `axis`. */
int ct_plane_holds(const ct_plane *plane, const double *displacement);

/* Forces of the lower layer by the batches first ... last - 1. */
void ct_plane_batches(const ct_solid_part *part, int32_t first, int32_t last, const double *displacement, double *values);

/* Sum them at the nodes first ... last - 1 of both layers. */
void ct_plane_gather(const ct_solid_part *part, const double *values, int32_t first, int32_t last, double *sums);

#endif
