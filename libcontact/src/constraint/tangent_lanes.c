/* The numbers of the tangential rows, for four of them side by side or for one (eq:slip-row). */
#include "../base/lanes.h"
#include "../base/vector.h"
#include "matrix.h"
#include "tangent_matrix.h"

/* The numbers of four rows. */
CT_INLINE void fill_four(ct_constraint *const *r, double *to)
{
  const double *from[4];
  double *own[4], *other[4];
  for (int j = 0; j < 4; j++) {
    from[j] = r[CT_TANGENT_ROW[j]]->own_shape;
    own[j] = to + 4 * j, other[j] = to + CT_TANGENT_OTHER + 4 * j;
  }
  ct_turn(from, own);
  if (r[0]->other_count == 0) return;
  for (int j = 0; j < 4; j++) from[j] = r[CT_TANGENT_ROW[j]]->other_shape;
  ct_turn(from, other);
  const double *number = ct_slip_number(r[0]->slip, CT_SLIP_LEVER);
  const int64_t stride = r[0]->slip->of->stride;
  for (int i = 0; i < 15; i++, number += stride)
    for (int k = 0; k < CT_QUAD_PARTS; k++)
      ((ct_quad *)(to + CT_TANGENT_LEVER + 4 * i))[k] =
          CT_TANGENT_ACROSS(((const ct_quad *)number)[k]);
}

/* Lever and weights of a row alone. */
static void fill_alone(const ct_constraint *c, double *to)
{
  const int32_t nodes = c->other_count;
  for (int32_t b = -1; b < nodes && nodes > 0; b++) {
    double *v = to + CT_TANGENT_ALONE + 4 * b;
    ct_slip_vector(c->slip, CT_SLIP_WEIGHT + 3 * b, v);
    v[3] = 0.0;
  }
}

/* Whether the rows of a group are those of a 2 x 2 rule, with points side by side. */
CT_INLINE int stand_together(const ct_tangent_group *g, ct_constraint *const *r, int one_run)
{
  if (g->rows != 4 || g->own != 4 || (g->other & ~4) != 0) return 0;
  for (int j = 1; j < 4 && !one_run; j++)
    if (r[j]->slip->of != r[0]->slip->of || r[j]->slip->at != r[0]->slip->at + j) return 0;
  return ct_rows_are_square(r);
}

/* Let `most` be at least |w_b|² |d|² of four rows, lane by lane. */
CT_INLINE void square_four(const double *lanes, double most[4])
{
  const double *d = lanes + CT_TANGENT_LEVER, *w = lanes + CT_TANGENT_WEIGHT;
  double top[4] = {0.0};
  for (int32_t b = 0; b < 4; b++, w += 12)
#pragma omp simd
    for (int i = 0; i < 4; i++)
      top[i] = ct_larger((w[i] * w[i] + w[4 + i] * w[4 + i]) + w[8 + i] * w[8 + i], top[i]);
#pragma omp simd
  for (int i = 0; i < 4; i++)
    most[i] =
        ct_larger(top[i] * ((d[i] * d[i] + d[4 + i] * d[4 + i]) + d[8 + i] * d[8 + i]), most[i]);
}

/* The same of a row alone. */
static double square_alone(int32_t other, const double *lanes, double most)
{
  for (int32_t b = 0; b < other; b++) {
    const double *w = lanes + CT_TANGENT_ALONE + 4 * b;
    most = ct_larger(ct_vector_dot(w, w) * ct_vector_dot(lanes, lanes), most);
  }
  return most;
}

CT_CLONES
double ct_tangent_fill(const ct_tangent *t)
{
  double most = 0.0, four[4] = {0.0};
  for (ct_tangent_group *g = t->groups, *end = g + t->group_count; g < end; g++) {
    ct_constraint *const *r = &t->rows[g->first];
    double *to = &t->lanes[CT_TANGENT_LANES * g->first];
    g->together = (int8_t)stand_together(g, r, t->one_run);
    if (g->together) fill_four(r, to);
    if (g->together && g->other > 0) square_four(to, four);
    for (int32_t j = 0; !g->together && j < g->rows; j++, to += CT_TANGENT_LANES) {
      fill_alone(r[j], to);
      most = square_alone(g->other, to, most);
    }
  }
  for (int i = 0; i < 4; i++) most = ct_larger(four[i], most);
  return most;
}
