#ifndef CT_SRC_SOLID_PLANE_H
#define CT_SRC_SOLID_PLANE_H

#include "call.h"

/* Nodes of the lower layer whose numbers follow each other, as do those of their partners in the
 * upper layer and of the elements around them. */
typedef struct ct_plane_run {
  int32_t low, high, count;
  /* The first node's elements, quadrants (-,-), (+,-), (-,+), (+,+) in p and q; -1: none, at all
   * nodes of the run. */
  int32_t element[4];
} ct_plane_run;

/* One layer of equal boxes in plane strain: the nodes of the lower layer stand for both. */
typedef struct ct_plane {
  /* The direction that the layer is held in, and the two others, ascending. */
  int axis, p, q;
  /* Nodes of the lower layer, shape (batches, 4, 8 lanes); corners (-,-), (+,-), (-,+), (+,+) in p
   * and q. */
  int32_t *batch_nodes;
  /* All nodes, by those of the lower layer, ascending. */
  ct_plane_run *runs;
  int32_t run_count;
  /* Each thread has a ring of `ring` elements, a power of two, for their forces: component c at
   * corner k stands 3 k + c strides from the first one. */
  int rings;
  int64_t ring, stride, value_count;
} ct_plane;

/* The plane of a part of boxes, for `rings` threads, if it is one layer along `axis` and each node
 * has at most one element in each quadrant; else null, with CT_OK. CT_ERROR_MEMORY. */
ct_status ct_plane_create(const ct_solid_part *part, int axis, int rings, ct_plane **plane);

void ct_plane_free(ct_plane *plane);

/* Whether the layers have moved alike, and not at all along `axis`, as far as they are summed. */
int ct_plane_holds(const ct_part_call *call);

/* Forces at the nodes of the part, as ct_part_force; the call's values are room for the rings. */
void ct_plane_force(const ct_part_call *call, int threads);

#endif
