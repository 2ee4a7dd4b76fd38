/* The forces of friction at the nodes. */
#include <libcontact/base.h>

#include "../base/error.h"
#include "../base/lanes.h"
#include "../base/vector.h"
#include "friction_internal.h"
#include "heap.h"

#include <math.h>
#include <string.h>

/* The sums of two sides before they are added to those of all nodes. */
typedef struct heaps {
  const ct_side_fixed *other;
  ct_heap own, theirs;
} heaps;

/* Add the traction and the couple of a listed point of side `k`. */
CT_INLINE void add_point(int stride, const ct_friction_call *now, const ct_grid *grid,
                         ct_friction_place at, const ct_friction_memory *s, heaps *to)
{
  const ct_point *point = &now->side[at.s]->points[at.i];
  const ct_slip *p = &s->points[at.j];
  const double back[3] = {-p->force[0], -p->force[1], -p->force[2]},
               lever[3] = {-p->lever[0], -p->lever[1], -p->lever[2]};
  if (ct_vector_dot(p->force, p->force) == 0.0) return;
  // -- N_a T on the own face; -N̄_b T - (w_b · T) d on the other (eq:slip-row)
  ct_heap_add(stride, grid, point->row.own, point->row.own_shape, p->force, &to->own);
  if (now->data->rigid) return;
  const int32_t *node = ct_side_row_nodes(to->other, point->other);
  ct_heap_add(stride, grid, node, point->N, back, &to->theirs);
  ct_heap_add(stride, grid, node, s->turn[at.j], lever, &to->theirs);
}

/* Whether four listed points from the given one on are those of one face and meet one face. */
static int are_four(const ct_friction_call *now, const int64_t *listed, int64_t left)
{
  const ct_friction_place first = ct_friction_place_of(now, *listed);
  const ct_point *point = &now->side[first.s]->points[first.i];
  if (left < 4 || listed[3] != *listed + 3 || now->data->side[first.s]->point_count <= first.i + 3)
    return 0;
  for (int q = 1; q < 4; q++)
    if (point[q].row.own != point->row.own || point[q].other != point->other) return 0;
  return now->data->side[first.s]->rule.count == 4;
}

/* Tractions and couples of four points, on a face of the other side with `count` nodes; summed
 * first, as in `ct_heap_add_four`. */
CT_INLINE void add_theirs(int count, const ct_grid *grid, const int32_t *node,
                          const ct_point *point, const ct_slip *slip, double (*const turn)[8],
                          const ct_heap *heap)
{
  for (int b = 0; b < count; b++) {
    double *coarse = &heap->coarse_sum[3 * (int64_t)node[b]],
           *fine = &heap->fine_sum[3 * (int64_t)node[b]], v[4][4];
    for (int q = 0; q < 4; q++)
#pragma omp simd
      for (int c = 0; c < 4; c++)
        // -- -N̄_b T - (w_b · T) d (eq:slip-row)
        v[q][c] = -(point[q].N[b] * slip[q].force[c]) - turn[q][b] * slip[q].lever[c];
#pragma omp simd
    for (int c = 0; c < 4; c++)
      ct_grid_add(grid, (v[0][c] + v[3][c]) + (v[1][c] + v[2][c]), &coarse[c], &fine[c]);
  }
}

/* As `add_point`, of four such points together. */
CT_INLINE void add_four(const ct_friction_call *now, const ct_grid *grid, ct_friction_place at,
                        const ct_friction_memory *s, const heaps *to)
{
  const ct_point *point = &now->side[at.s]->points[at.i];
  const ct_slip *slip = &s->points[at.j];
  const double *N[4];
  double force[4][4];
  for (int q = 0; q < 4; q++) {
    memcpy(force[q], slip[q].force, sizeof force[q]);
    N[q] = point[q].row.own_shape;
  }
  // -- N_a T on the own face (eq:slip-row)
  const int own = to->own.count;
  ct_heap_add_four(own == 4 ? 4 : own, grid, point->row.own, N, 1.0, force, &to->own);
  if (now->data->rigid) return;
  const int32_t *node = ct_side_row_nodes(to->other, point->other);
  const int count = to->theirs.count;
  if (count == 4) add_theirs(4, grid, node, point, slip, &s->turn[at.j], &to->theirs);
  else add_theirs(count, grid, node, point, slip, &s->turn[at.j], &to->theirs);
}

/* Add the tractions and couples of the listed points of side `k` to the sums at the nodes. */
CT_INLINE void add_side(int stride, const ct_friction_call *now, int k, const ct_grid *grid,
                        ct_friction_memory *s)
{
  const ct_side_fixed *side = now->data->side[k],
                      *other = now->data->side[now->data->sides - 1 - k];
  heaps to = {other,
              {s->coarse, s->fine, side->search->per, NULL, {0}, {0}},
              {s->coarse, s->fine, other->search->per, NULL, {0}, {0}}};
  for (int64_t n = 0; n < s->listed_count;) {
    const ct_friction_place at = ct_friction_place_of(now, s->listed[n]);
    const int four = at.s == k && are_four(now, &s->listed[n], s->listed_count - n);
    if (four) add_four(now, grid, at, s, &to);
    else if (at.s == k) add_point(stride, now, grid, at, s, &to);
    n += four ? 4 : 1;
  }
  ct_heap_bring(stride, &to.own, NULL);
  ct_heap_bring(stride, &to.theirs, NULL);
}

/* Tractions and couples of the points of side `k`, of faces with at most four nodes or with more.
 */
CT_CLONES
static void push(const ct_friction_call *now, int k, const ct_grid *grid, ct_friction_memory *s)
{
  if (now->data->side[0]->search->per <= 4 &&
      now->data->side[now->data->sides - 1]->search->per <= 4)
    add_side(4, now, k, grid, s);
  else add_side(8, now, k, grid, s);
}

ct_status ct_friction_gather(const ct_friction_call *now, ct_friction_memory *s, int32_t nodes,
                             double *force, ct_error *error)
{
  const ct_friction *data = now->data;
  const size_t size = 3 * (size_t)nodes * sizeof *force;
  double top = 0.0;
  ct_grid grid;
  for (int64_t n = 0; n < s->listed_count; n++) {
    const double own = s->terms[s->listed[n]];
    top = own > top || isnan(own) ? own : top;
  }
  ct_pieces_largest(s->pieces, &top, 1);
  memset(s->coarse, 0, size);
  memset(s->fine, 0, size);
  if (top > 0.0 && !ct_grid_init(&grid, 2.0 * top, 24 * data->points))
    return ct_fail(
        error, CT_ERROR_BLOWUP, CT_NOWHERE,
        "friction: the largest force, %g, is too large or not finite; the motion has diverged",
        top);
  for (int k = 0; top > 0.0 && k < data->sides; k++) push(now, k, &grid, s);
  if (top > 0.0) {
    ct_pieces_sum(s->pieces, s->coarse, 3 * (int64_t)nodes);
    ct_pieces_sum(s->pieces, s->fine, 3 * (int64_t)nodes);
  }
  for (int64_t d = 0; d < 3 * (int64_t)nodes; d++) force[d] = s->coarse[d] + s->fine[d];
  return CT_OK;
}
