#ifndef CT_SRC_ASSEMBLY_H
#define CT_SRC_ASSEMBLY_H

#include <libcontact/mesh.h>

#include "../base/memory.h"

/* From element corners to nodes. Each node has 8 slots, one for each octant around it: an element
 * for which the node is the corner (-,-,-) fills the slot (+,+,+), and so on. A node's sum is a
 * tree over its slots that pairs along ξ, η, ζ (eq:tree-sum), independent of threads and mirrored
 * with the mesh. Mid-side nodes of hex20 use the slots of the octants that differ in the two
 * directions across their edge.
 *
 * Values of the elements stand in batches of 8: value c of node a of element e is at
 * ((e / 8 * nodes + a) * components + c) * 8 + e % 8, and a slot without element points to a zero.
 */
typedef struct ct_assembly {
  ct_pool pool; /* its arrays */
  int32_t node_count;
  int components;
  /* Index of component 0 for each node and slot, shape (node_count, 8); further components follow
   * at steps of 8. */
  int32_t *place;
  /* Octants with several elements (meshes without lattice order): their sum is in a cell of its own
   * behind the zeros, to which `fold` adds the elements' values in order. */
  int64_t extra_count;
  int32_t *extra_to;
  int32_t *extra_from;
  int64_t cell_count;
  /* Number of doubles of the elements, and in all: elements, zeros, cells. */
  int64_t element_values;
  int64_t value_count;
} ct_assembly;

ct_status ct_assembly_create(const ct_mesh *mesh, int components, ct_assembly **out,
                             ct_error *error);

void ct_assembly_free(ct_assembly *assembly);

/* Sum the cells; call it once after the element values were written. */
void ct_assembly_fold(const ct_assembly *assembly, double *values);

/* Sum the element values at the nodes first ... last - 1 into `sums`, shape (node_count,
 * components). */
void ct_assembly_gather(const ct_assembly *assembly, const double *values, int32_t first,
                        int32_t last, double *sums);

#endif
