/* The forces of friction at the nodes. */
#include <libcontact/base.h>

#include "../base/error.h"
#include "../base/lanes.h"
#include "../base/stream.h"
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

/* Add the traction and the couple of the listed point number `n`. */
CT_INLINE void add_point(int stride, const ct_friction_call *now, const ct_grid *grid, int64_t n,
                         const ct_friction_memory *s, heaps *to)
{
  const ct_point *point = s->listed[n].point;
  double T[3], back[3], lever[3], turn[8];
  for (int c = 0; c < 3; c++) {
    T[c] = *ct_friction_numbers(s, CT_SLIP_FORCE + c, n);
    back[c] = -T[c];
  }
  if (ct_vector_dot(T, T) == 0.0) return;
  // -- N_a T on the own face; -N̄_b T - (w_b · T) d on the other (eq:slip-row)
  ct_heap_add(stride, grid, point->row.own, point->row.own_shape, T, &to->own);
  if (now->data->rigid) return;
  for (int c = 0; c < 3; c++) lever[c] = -*ct_friction_numbers(s, CT_SLIP_LEVER + c, n);
  for (int b = 0; b < 8; b++)
    turn[b] = b < now->data->other_nodes ? s->turn[s->slips.stride * b + n] : 0.0;
  const int32_t *node = ct_side_row_nodes(to->other, point->other);
  ct_heap_add(stride, grid, node, point->N, back, &to->theirs);
  ct_heap_add(stride, grid, node, turn, lever, &to->theirs);
}

/* Whether four listed points from the given one on are those of one face and meet one face. */
CT_INLINE int are_four(const ct_friction_call *now, const ct_friction_point *listed, int64_t left)
{
  const ct_point *point = listed->point;
  if (left < 4 || listed[3].point != point + 3) return 0;
  for (int q = 1; q < 4; q++)
    if (point[q].row.own != point->row.own || point[q].other != point->other) return 0;
  return now->data->side[listed->s]->rule.count == 4;
}

/* Vectors of four points side by side, each with a fourth component, 0. */
CT_INLINE void load_vectors(const double *first, int64_t stride, double (*v)[4])
{
  const double none[4] = {0.0};
  const double *const from[4] = {first, first + stride, first + 2 * stride, none};
  double *const to[4] = {v[0], v[1], v[2], v[3]};
  ct_turn(from, to);
}

/* Tractions and couples of four points, on a face of the other side with `count` nodes; summed
 * first, as in `ct_heap_add_four`. `turn` are those of the first point. */
CT_INLINE void add_theirs(int count, const ct_grid *grid, const int32_t *node,
                          const ct_point *point, double (*const T)[4], double (*const lever)[4],
                          const double *turn, int64_t stride, const ct_heap *heap)
{
  const ct_grid g = *grid;
  for (int b = 0; b < count; b++, turn += stride) {
    double *coarse = &heap->coarse_sum[3 * (int64_t)node[b]],
           *fine = &heap->fine_sum[3 * (int64_t)node[b]];
    for (int i = 0; i < CT_QUAD_PARTS; i++) {
      ct_quad v[4];
      for (int q = 0; q < 4; q++)
        // -- N̄_b T + (w_b · T) d, taken off the other face (eq:slip-row)
        v[q] =
            point[q].N[b] * ((const ct_quad *)T[q])[i] + turn[q] * ((const ct_quad *)lever[q])[i];
      const ct_quad x = (v[0] + v[3]) + (v[1] + v[2]), most = (x + g.coarse) - g.coarse;
      ((ct_quad *)coarse)[i] -= most;
      ((ct_quad *)fine)[i] -= ((x - most) + g.fine) - g.fine;
    }
  }
}

/* As `add_point`, of four such points together. */
CT_INLINE void add_four(const ct_friction_call *now, const ct_grid *grid, int64_t n,
                        const ct_friction_memory *s, const heaps *to)
{
  const ct_point *point = s->listed[n].point;
  const int64_t stride = s->slips.stride;
  const double *N[4], *turn = &s->turn[n];
  double T[4][4], lever[4][4];
  load_vectors(ct_friction_numbers(s, CT_SLIP_FORCE, n), stride, T);
  for (int q = 0; q < 4; q++) N[q] = point[q].row.own_shape;
  // -- N_a T on the own face (eq:slip-row)
  if (to->own.count == 4) ct_heap_add_four(4, grid, point->row.own, N, 1.0, T, &to->own);
  else ct_heap_add_four(to->own.count, grid, point->row.own, N, 1.0, T, &to->own);
  if (now->data->rigid) return;
  const int32_t *node = ct_side_row_nodes(to->other, point->other);
  const int count = to->theirs.count;
  load_vectors(ct_friction_numbers(s, CT_SLIP_LEVER, n), stride, lever);
  if (count == 4) add_theirs(4, grid, node, point, T, lever, turn, stride, &to->theirs);
  else add_theirs(count, grid, node, point, T, lever, turn, stride, &to->theirs);
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
  const int64_t end = s->listed_end[k];
  for (int64_t n = k == 0 ? 0 : s->listed_end[0]; n < end;) {
    const int four = are_four(now, &s->listed[n], end - n);
    if (four) add_four(now, grid, n, s, &to);
    else add_point(stride, now, grid, n, s, &to);
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
  const size_t size = 3 * (size_t)nodes;
  double top = ct_largest(s->terms, s->listed_count);
  ct_grid grid;
  ct_pieces_largest(s->pieces, &top, 1);
  ct_clear(s->coarse, size);
  ct_clear(s->fine, size);
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
