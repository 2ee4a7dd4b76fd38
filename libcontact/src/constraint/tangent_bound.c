/* Bounds of the tangential rows (eq:slip-bound). */
#include "../base/grid.h"
#include "../base/lanes.h"
#include "../base/stream.h"
#include "../base/vector.h"
#include "bodies.h"
#include "tangent_matrix.h"

#include <math.h>

enum { LANES = CT_TANGENT_LANES };

/* Most nodes of a face; and the largest η with which couples are small (eq:slip-bound-couples). */
enum { MOST_NODES = 8 };
static const double SMALL_COUPLE = 0.1;

/* Sizes of the entries of one row, for each node (eq:slip-bound). Returns the largest. */
static double size_row(const ct_constraint *c, const double *couple, double *size)
{
  const double d = ct_vector_dot(couple, couple);
  double top = 0.0;
  for (int32_t a = 0; a < c->own_count; a++) {
    size[a] = fabs(c->own_shape[a]);
    top = ct_larger(size[a], top);
  }
  size += c->own_count;
  for (int32_t b = 0; b < c->other_count; b++) {
    const double *w = &couple[CT_TANGENT_ALONE + 4 * b];
    // -- |N̄_b| + |w_b| |d| (eq:slip-bound)
    size[b] = fabs(c->other_shape[b]) + sqrt(ct_vector_dot(w, w) * d);
    top = ct_larger(size[b], top);
  }
  return top;
}

/* The same of four rows, side by side. */
CT_INLINE double size_four(int32_t other, const double *lanes, double *size)
{
  const double *O = lanes + CT_TANGENT_OTHER, *d = lanes + CT_TANGENT_LEVER;
  double most[4] = {0.0};
  for (int32_t a = 0; a < 4; a++)
#pragma omp simd
    for (int i = 0; i < 4; i++) {
      size[4 * a + i] = fabs(lanes[4 * a + i]);
      most[i] = ct_larger(size[4 * a + i], most[i]);
    }
  for (int32_t b = 0; b < other; b++) {
    const double *w = lanes + CT_TANGENT_WEIGHT + 12 * b;
#pragma omp simd
    for (int i = 0; i < 4; i++) {
      const double d2 = (d[i] * d[i] + d[4 + i] * d[4 + i]) + d[8 + i] * d[8 + i],
                   w2 = (w[i] * w[i] + w[4 + i] * w[4 + i]) + w[8 + i] * w[8 + i];
      // -- |N̄_b| + |w_b| |d| (eq:slip-bound)
      size[16 + 4 * b + i] = fabs(O[4 * b + i]) + sqrt(w2 * d2);
      most[i] = ct_larger(size[16 + 4 * b + i], most[i]);
    }
  }
  return ct_larger(ct_larger(most[0], most[1]), ct_larger(most[2], most[3]));
}

/* The sizes of all rows; those of four rows together lie side by side. Returns the largest. */
CT_CLONES
static double size_rows(const ct_tangent *t)
{
  double top = 1.0;
  for (const ct_tangent_group *g = t->groups, *end = g + t->group_count; g < end; g++) {
    const double *lanes = &t->lanes[LANES * g->first];
    double *size = &t->size[CT_ROW_NODES * g->first];
    if (g->together)
      top = ct_larger(g->other == 4 ? size_four(4, lanes, size) : size_four(0, lanes, size), top);
    for (int32_t r = 0; !g->together && r < g->rows; r++)
      top = ct_larger(size_row(t->rows[g->first + r], lanes + LANES * r, size + CT_ROW_NODES * r),
                      top);
  }
  return top;
}

/* Add the sizes of some rows to the sums at their nodes. */
CT_INLINE void sum_rows(double coarse, int rows, int32_t nodes, const int32_t *place,
                        const double *size, double *sums)
{
  for (int32_t a = 0; a < nodes; a++) {
    double v[4];
    for (int i = 0; i < rows; i++) v[i] = (size[rows * a + i] + coarse) - coarse;
    sums[place[a] + 3] += rows == 1 ? v[0] : (v[0] + v[1]) + (v[2] + v[3]);
  }
}

/* Σ_k β_ka of all nodes a, into the fourth components of the sums. */
CT_CLONES
static void sum_sizes(double coarse, const ct_tangent *t)
{
  for (const ct_tangent_group *g = t->groups, *end = g + t->group_count; g < end; g++) {
    const int32_t nodes = g->own + g->other;
    const double *size = &t->size[CT_ROW_NODES * g->first];
    if (g->together && nodes == 8) sum_rows(coarse, 4, 8, g->place, size, t->sums);
    else if (g->together) sum_rows(coarse, 4, 4, g->place, size, t->sums);
    else
      for (int32_t r = 0; r < g->rows; r++, size += CT_ROW_NODES)
        sum_rows(coarse, 1, nodes, g->place, size, t->sums);
  }
}

/* Σ_a β_a A_a Σ_k β_ka of the nodes of one face of `rows` rows, with the inner sums in the fourth
 * components of a vector at nodes, paired so that a flipped face gives the same bits
 * (eq:tree-sum). */
CT_INLINE void bound_face(int rows, int32_t count, const double *size, const int32_t *place,
                          const double *moved, double *out)
{
  double term[8][4] = {{0.0}};
  for (int32_t b = 0; b < count; b++)
    // -- β_a A_a Σ_k β_ka of one node (eq:slip-bound)
    for (int i = 0; i < rows; i++) term[b][i] = size[rows * b + i] * moved[place[b] + 3];
  for (int i = 0; i < rows; i++)
    out[i] += ((term[0][i] + term[1][i]) + (term[2][i] + term[3][i])) +
              ((term[4][i] + term[6][i]) + (term[5][i] + term[7][i]));
}

/* The bounds of one row or of four. */
CT_INLINE void bound_rows(int rows, int32_t own, int32_t other, const int32_t *place,
                          const double *size, const double *moved, double *out)
{
  double D[4] = {0.0};
  bound_face(rows, own, size, place, moved, D);
  bound_face(rows, other, size + rows * own, place + own, moved, D);
  for (int i = 0; i < rows; i++) out[rows == 1 ? 0 : CT_TANGENT_ROW[i]] = D[i];
}

CT_CLONES
static void bound_all(const ct_tangent *t)
{
  for (const ct_tangent_group *g = t->groups, *end = g + t->group_count; g < end; g++) {
    const double *size = &t->size[CT_ROW_NODES * g->first];
    double *to = &t->scale[g->first];
    if (g->together && g->other == 4) bound_rows(4, 4, 4, g->place, size, t->moved, to);
    else if (g->together) bound_rows(4, 4, 0, g->place, size, t->moved, to);
    else
      for (int32_t r = 0; r < g->rows; r++, size += CT_ROW_NODES)
        bound_rows(1, g->own, g->other, g->place, size, t->moved, to + r);
  }
}

/* The largest mobility of the nodes with rows, and minus the smallest bound of these. */
CT_CLONES
static void find_extremes(const ct_solver *s, double m[2])
{
  const double *bound = s->bound;
  const int64_t count = s->point_count;
  double mobile = 0.0, least = HUGE_VAL;
  for (int32_t k = 0; k < s->active_node_count; k++)
    for (int c = 0; c < 3; c++) mobile = ct_larger(s->mobility[s->active_nodes[k] + c], mobile);
#pragma omp simd reduction(min : least)
  for (int64_t r = 0; r < count; r++) least = bound[r] < least ? bound[r] : least;
  m[0] = mobile, m[1] = -least;
}

/* Take the bounds of the normal rows, if these are the same rows and their couples are small.
 * Returns 0 if not. */
static int widen_bound(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  if (!t->active || s->bodies != NULL) return 0;
  double m[3] = {t->couple};
  find_extremes(s, m + 1);
  ct_pieces_largest(s->pieces, m, 3);
  // -- η = √(8 r e² max A / min B) (eq:slip-bound-couples)
  const double eta = sqrt(MOST_NODES * t->most_row_count * m[0] * m[1] / -m[2]);
  if (!(eta <= SMALL_COUPLE)) return 0;
  ct_copy(t->scale, s->bound, (size_t)t->count * sizeof *t->scale);
  t->widening = (1.0 + eta) * (1.0 + eta);
  return 1;
}

int ct_tangent_bound(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  ct_grid grid;
  if (widen_bound(s)) return 1;
  t->widening = 1.0;
  double top = size_rows(t);
  ct_pieces_largest(s->pieces, &top, 1);
  if (!ct_grid_init(&grid, top, t->most_row_count)) return 0;
  sum_sizes(grid.coarse, t);
  ct_tangent_join(s, 3, 1);
  if (s->bodies != NULL) ct_bodies_push_sizes(s->bodies, t->node_count, t->nodes, t->sums);
  for (int32_t k = 0; k < t->node_count; k++) {
    const double *A = &s->mobility[t->nodes[k]];
    double *sum = &t->sums[t->nodes[k] + 3], most = A[0] > A[1] ? A[0] : A[1];
    t->moved[t->nodes[k] + 3] = *sum * (most > A[2] ? most : A[2]);
    *sum = 0.0;
  }
  if (s->bodies != NULL) ct_bodies_move_sizes(s->bodies, t->node_count, t->nodes, t->moved);
  bound_all(t);
  return 1;
}
