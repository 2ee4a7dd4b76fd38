#ifndef CT_SRC_SOLID_RING_H
#define CT_SRC_SOLID_RING_H

#include <libcontact/mesh.h>

/* Element forces of hex8 that are kept only until their nodes are summed: in a ring, closely
 * followed by the nodes (eq:lattice-ring). */

/* Nodes with consecutive numbers, as are those of the elements around them, and in a plane those of
 * their partners in the upper layer. */
typedef struct ct_ring_run {
  int32_t low, high, count;
  /* The first node's elements by octant, in a plane by quadrant (bit d: on the positive side along
   * ξ, η, ζ, or p, q); -1: none, at all nodes of the run. */
  int32_t element[8];
  int32_t first, last; /* of all its elements */
} ct_ring_run;

typedef struct ct_force_ring {
  /* 8: bricks; 4: one layer in plane strain, where the nodes of the lower layer represent both. */
  int corners;
  /* The direction in which a layer is fixed, and the two others, ascending; z and x, y for bricks.
   */
  int axis, p, q;
  /* Local numbers of the corners (-,-,-), (+,-,-), (-,+,-), ... in p, q and axis. */
  int local[8];
  /* All nodes, or all of the lower layer, ascending. */
  ct_ring_run *runs;
  int32_t run_count;
  /* Null, or for a mesh whose runs would be short or whose octants have several elements: corner a
   * of element e as 8 e + a, list[begin[n]] ... list[begin[n + 1] - 1] those at node n. Runs are
   * then pieces of the nodes, without elements. */
  int32_t *begin, *list;
  /* Each of `ring_count` threads has a ring of `size` elements, a power of two, of `value_count`
   * numbers. The forces of one component of consecutive nodes have the stride `stride`, those of
   * the next 8 elements follow after 8 `step`. */
  int ring_count;
  int64_t size, stride, step, value_count;
} ct_force_ring;

/* The ring of a mesh of hex8 for the threads of its run, with `axis` that of its one layer as a
 * plane, or -1: bricks. Null, with CT_OK, if a node has two elements in one octant, if there is
 * more than one layer, or if runs are so short that tables are faster. CT_ERROR_MEMORY. */
ct_status ct_force_ring_create(const ct_mesh *mesh, int axis, ct_force_ring **out);

/* The same for any mesh of hex8, by lists; elements of one octant are added in the order of their
 * places in `sequence`. */
ct_status ct_force_ring_create_listed(const ct_mesh *mesh, const int32_t *sequence,
                                      ct_force_ring **out);

void ct_force_ring_free(ct_force_ring *ring);

/* The run of a node of bricks, or of the lower layer. */
const ct_ring_run *ct_force_ring_run(const ct_force_ring *ring, int32_t node);

/* Sum at the nodes first ... last - 1 of a run, in the order of ct_assembly_gather (eq:tree-sum),
 * into `low`, shape (last - first, 3), and `high`, that of their partners in a plane. */
void ct_force_ring_gather(const ct_force_ring *ring, const double *values, const ct_ring_run *run,
                          int32_t first, int32_t last, double *low, double *high);

#endif
