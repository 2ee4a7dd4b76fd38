#ifndef CT_SRC_CONSTRAINT_PRODUCTS_H
#define CT_SRC_CONSTRAINT_PRODUCTS_H

#include "../base/lanes.h"
#include "solve.h"

/* Products of the groups of G with vectors. */

/* The node of a face in each lane of its quads: then the sums over lanes pair the nodes as
 * ct_sum_face does, so that a flipped face gives the same bits (eq:tree-sum). */
static const int32_t CT_LANE_NODE[8] = {0, 1, 2, 3, 4, 6, 5, 7};

/* Numbers of quads that hold the nodes of a face, and of numbers that a row has in G. */
CT_INLINE int32_t ct_quads_of(int32_t count) { return (int32_t)(((uint32_t)count + 3) / 4); }
CT_INLINE int64_t ct_group_numbers(const ct_group *g)
{
  return 4 * (1 + (int64_t)ct_quads_of(g->own) + ct_quads_of(g->other));
}

/* `out` = G times vectors at nodes, of the first `count` rows: b_a n · x, or b_a times their fourth
 * components, which are motions along the one normal of all rows. And both b_a n · x and |b_a|
 * times fourth components, into `sizes`. `places` are those of the nodes. */
typedef void ct_times(const ct_group *groups, int64_t count, const int32_t *places, const double *G,
                      const double *x, double *out);
ct_times ct_times_full, ct_times_along;
void ct_times_bound(const ct_group *groups, int64_t count, const int32_t *places, const double *G,
                    const double *x, double *out, double *sizes);

/* Add the forces of the rows of `count` groups to sums at nodes: b_a n times the force, or b_a
 * times it, to the fourth components. The sums are exact multiples of the spacing of the grid
 * `coarse` (eq:order-free-sum). And both b_a n times the force and, to the fourth components, |b_a|
 * of unit forces, on the grid `sizes`. */
typedef void ct_add(double coarse, const ct_group *groups, int64_t count, const int32_t *places,
                    const double *G, const double *force, double *restrict sums);
ct_add ct_add_full, ct_add_along;
void ct_add_bound(double coarse, double sizes, const ct_group *groups, int64_t count,
                  const int32_t *places, const double *G, const double *force,
                  double *restrict sums);

#endif
