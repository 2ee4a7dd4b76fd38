/* The rows of the tangential forces and their products (eq:slip-row). */
#include "tangent_rows.h"

#include "../base/grid.h"
#include "../base/lanes.h"
#include "../base/stream.h"
#include "../base/vector.h"
#include "law.h"
#include "matrix.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

enum { WIDE = CT_SOLVER_WIDE, PARTS = CT_QUAD_PARTS };

/* Sum over the nodes of one face. */
CT_INLINE void sum_face(int32_t count, const double *N, const int32_t *place, const double *x,
                        double out[WIDE])
{
  for (int i = 0; i < PARTS; i++) {
    ct_quad t[8];
    for (int32_t a = 0; a < count; a++) t[a] = N[a] * ((const ct_quad *)&x[place[a]])[i];
    ct_sum_face(count, t, (ct_quad *)out + i);
  }
}

/* Motion of a point relative to its partner, in the plane of contact, for a vector at nodes. */
CT_INLINE void relative(int32_t own, int32_t other, const ct_tangent_row *r, const double *x,
                        double out[WIDE])
{
  const ct_constraint *c = r->row;
  const ct_slip *slip = r->slip;
  const int32_t *place = r->place + own;
  double theirs[WIDE], turn[8];
  sum_face(own, c->own_shape, r->place, x, out);
  if (other > 0) {
    sum_face(other, c->other_shape, place, x, theirs);
    for (int32_t b = 0; b < other; b++) turn[b] = ct_vector_dot(slip->lever, &x[place[b]]);
    for (int i = 0; i < PARTS; i++) {
      ct_quad t[8], couple;
      for (int32_t b = 0; b < other; b++) t[b] = turn[b] * ((const ct_quad *)slip->weight[b])[i];
      ct_sum_face(other, t, &couple);
      // -- Σ N_a x_a - Σ N̄_b x_b - Σ w_b (d · x_b) (eq:slip-row)
      ((ct_quad *)out)[i] -= ((const ct_quad *)theirs)[i] + couple;
    }
  }
  ct_vector_make_tangential(c->normal, out);
  out[3] = 0.0;
}

/* A vector of each row from a vector at nodes; `to` is its offset in the row. */
CT_CLONES
static void relative_rows(int64_t count, ct_tangent_row *rows, const double *x, size_t to)
{
  for (ct_tangent_row *r = rows; r < rows + count; r++) {
    const int32_t own = r->row->own_count, other = r->row->other_count;
    double *out = (double *)((char *)r + to);
    if (own == 4 && other == 4) relative(4, 4, r, x, out);
    else if (own == 4 && other == 0) relative(4, 0, r, x, out);
    else relative(own, other, r, x, out);
  }
}

void ct_tangent_motion(ct_tangent *t, const double *x)
{
  relative_rows(t->count, t->rows, x, offsetof(ct_tangent_row, q));
}

/* Add a row times a force to the sums at nodes, as multiples of the grid's spacing: these sums are
 * exact in any order (eq:order-free-sum). */
CT_INLINE void add_row(double coarse, int32_t own, int32_t other, const ct_tangent_row *r,
                       const double *T, double *sums)
{
  const ct_constraint *c = r->row;
  const ct_slip *slip = r->slip;
  const ct_quad *force = (const ct_quad *)T, *lever = (const ct_quad *)slip->lever;
  for (int32_t a = 0; a < own; a++)
    for (int i = 0; i < PARTS; i++)
      // -- N_a T on the own face (eq:slip-row)
      ((ct_quad *)&sums[r->place[a]])[i] += (c->own_shape[a] * force[i] + coarse) - coarse;
  for (int32_t b = 0; b < other; b++) {
    const double turn = ct_vector_dot(slip->weight[b], T);
    for (int i = 0; i < PARTS; i++)
      // -- -(N̄_b T + (w_b · T) d) on the other
      ((ct_quad *)&sums[r->place[own + b]])[i] -=
          ((c->other_shape[b] * force[i] + turn * lever[i]) + coarse) - coarse;
  }
}

CT_CLONES
static void add_rows(double coarse, int64_t count, const ct_tangent_row *rows, int at, double *sums)
{
  for (const ct_tangent_row *r = rows; r < rows + count; r++) {
    const int32_t own = r->row->own_count, other = r->row->other_count;
    const double *T = at ? r->at : r->T;
    if (own == 4 && other == 4) add_row(coarse, 4, 4, r, T, sums);
    else if (own == 4 && other == 0) add_row(coarse, 4, 0, r, T, sums);
    else add_row(coarse, own, other, r, T, sums);
  }
}

/* The sums of all pieces. */
static void join_sums(ct_solver *s)
{
  if (s->pieces != NULL) ct_pieces_sum(s->pieces, s->tangent->sums, WIDE * (int64_t)s->node_count);
}

/* Largest component of the forces; NaN if one is. */
static double largest_force(const ct_tangent *t, int at)
{
  double top = 0.0;
  for (const ct_tangent_row *r = t->rows; r < t->rows + t->count; r++) {
    const double *T = at ? r->at : r->T;
    for (int i = 0; i < 3; i++) top = fabs(T[i]) > top || isnan(T[i]) ? fabs(T[i]) : top;
  }
  return top;
}

int ct_tangent_apply(ct_solver *s, int at)
{
  ct_tangent *t = s->tangent;
  ct_grid grid;
  double top = largest_force(t, at);
  ct_pieces_largest(s->pieces, &top, 1);
  // Shape functions of quadratic faces are below 1 in size; the factor 4 is a margin.
  if (!ct_grid_init(&grid, 4.0 * top, t->most_row_count)) return 0;
  add_rows(grid.coarse, t->count, t->rows, at, t->sums);
  join_sums(s);
  ct_matrix_move(t->node_count, t->nodes, s->mobility, t->sums, t->moved);
  relative_rows(t->count, t->rows, t->moved, offsetof(ct_tangent_row, image));
  s->iterations++;
  return 1;
}

/* Count the rows at each node and list the nodes on which any acts. */
static void list_nodes(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  double most = 0.0;
  for (int32_t k = 0; k < t->node_count; k++)
    memset(&t->moved[t->nodes[k]], 0, WIDE * sizeof *t->moved);
  t->node_count = 0;
  for (const ct_tangent_row *r = t->rows; r < t->rows + t->count; r += r->alike)
    for (int32_t a = 0; a < r->row->own_count + r->row->other_count; a++) {
      double *count = &t->sums[r->place[a] + 3];
      if (*count == 0.0 && s->pieces == NULL) t->nodes[t->node_count++] = r->place[a];
      *count += r->alike;
    }
  join_sums(s);
  for (int32_t n = 0; s->pieces != NULL && n < s->node_count; n++)
    t->nodes[t->node_count++] = WIDE * n;
  for (int32_t k = 0; k < t->node_count; k++) {
    double *count = &t->sums[t->nodes[k] + 3];
    most = *count > most ? *count : most;
    *count = 0.0;
  }
  t->most_row_count = (int32_t)most;
}

/* Add a row to the list. */
static void list_row(ct_solver *s, ct_constraint *c)
{
  ct_tangent *t = s->tangent;
  ct_tangent_row *r = &t->rows[t->count++], *last = t->count > 1 ? r - 1 : NULL;
  r->row = c, r->slip = c->slip;
  r->place = &s->entry_place[c->slip->place];
  r->alike = 1;
  if (last != NULL && last->place == r->place) {
    while (last > t->rows && last[-1].place == r->place) last--;
    last->alike++;
  }
  for (int i = 0; i < 3; i++) r->T[i] = c->slip->force[i];
  r->T[3] = 0.0;
  ct_vector_make_tangential(c->normal, r->T);
}

/* The motion of the last step, along the present rows (eq:slip-set). */
static void find_last(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  if (!s->starts)
    relative_rows(t->count, t->rows, s->last_increment, offsetof(ct_tangent_row, last));
  for (ct_tangent_row *r = t->rows; r < t->rows + t->count; r++) {
    // -- D₋ (eq:slip-set)
    for (int i = 0; i < 3; i++) r->last[i] = (s->starts ? 0.0 : r->last[i]) - r->slip->came[i];
    if (r->row->other_count == 0) ct_vector_make_tangential(r->row->normal, r->last);
  }
}

void ct_tangent_list(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  ct_constraint **active = s->active, **end = s->active + s->point_count;
  t->count = 0;
  for (int64_t j = 0; j < s->first[s->set_count]; j++) {
    ct_constraint *c = s->rows[j];
    int acts = !ct_law_has_rows(c->enforcement) && c->force > 0.0;
    if (active < end && *active == c) acts = 1, active++;
    if (c->slip == NULL) continue;
    if (acts) list_row(s, c);
    else ct_slip_open(c->slip);
  }
  double some = t->count > 0;
  ct_pieces_largest(s->pieces, &some, 1);
  t->some = some > 0.0;
  if (!t->some) return;
  list_nodes(s);
  find_last(s);
}

/* Sizes of the entries of a row (eq:slip-bound); returns the largest. */
static double find_sizes(ct_tangent_row *r)
{
  const ct_constraint *c = r->row;
  const ct_slip *slip = r->slip;
  const double d = ct_vector_dot(slip->lever, slip->lever);
  double top = 0.0, *size = r->size;
  for (int32_t a = 0; a < c->own_count; a++) *size++ = fabs(c->own_shape[a]);
  for (int32_t b = 0; b < c->other_count; b++) {
    const double *w = slip->weight[b];
    // -- |N̄_b| + |w_b| |d| (eq:slip-bound)
    *size++ = fabs(c->other_shape[b]) + sqrt(ct_vector_dot(w, w) * d);
  }
  for (double *each = r->size; each < size; each++) top = *each > top ? *each : top;
  return top;
}

/* Σ_a β_a A_a Σ_k β_ka of a row, with the inner sums in the fourth components of a vector at nodes,
 * paired so that a flipped face gives the same bits (eq:tree-sum). */
static double bound_row(const ct_tangent_row *r, const double *moved)
{
  double face[2] = {0.0, 0.0};
  for (int32_t side = 0, a = 0; side < 2; side++) {
    const int32_t count = side == 0 ? r->row->own_count : r->row->other_count;
    double term[8] = {0.0};
    // -- β_a A_a Σ_k β_ka of one node (eq:slip-bound)
    for (int32_t b = 0; b < count; b++, a++) term[b] = r->size[a] * moved[r->place[a] + 3];
    face[side] =
        ((term[0] + term[1]) + (term[2] + term[3])) + ((term[4] + term[6]) + (term[5] + term[7]));
  }
  return face[0] + face[1];
}

int ct_tangent_bound(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  ct_tangent_row *end = t->rows + t->count;
  ct_grid grid;
  double top = 1.0;
  for (ct_tangent_row *r = t->rows; r < end; r++) {
    const double size = find_sizes(r);
    top = size <= top ? top : size;
  }
  ct_pieces_largest(s->pieces, &top, 1);
  if (!ct_grid_init(&grid, top, t->most_row_count)) return 0;
  for (const ct_tangent_row *r = t->rows; r < end; r++)
    for (int32_t a = 0; a < r->row->own_count + r->row->other_count; a++)
      t->sums[r->place[a] + 3] += (r->size[a] + grid.coarse) - grid.coarse;
  join_sums(s);
  for (int32_t k = 0; k < t->node_count; k++) {
    const double *A = &s->mobility[t->nodes[k]];
    double *sum = &t->sums[t->nodes[k] + 3];
    t->moved[t->nodes[k] + 3] = *sum * fmax(fmax(A[0], A[1]), A[2]);
    *sum = 0.0;
  }
  for (ct_tangent_row *r = t->rows; r < end; r++) r->scale = bound_row(r, t->moved);
  return 1;
}
