/* The products of the tangential rows with vectors (eq:slip-row). */
#include "tangent_matrix.h"

#include "../base/grid.h"
#include "../base/lanes.h"
#include "../base/stream.h"
#include "../base/vector.h"
#include "bodies.h"
#include "matrix.h"

#include <math.h>
#include <string.h>

enum { WIDE = CT_SOLVER_WIDE, PARTS = CT_QUAD_PARTS, LANES = CT_TANGENT_LANES };

/* a · b. */
CT_INLINE void dot(const ct_quad a[3], const ct_quad b[3], ct_quad *out)
{
  *out = (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

/* Motion of the points of four rows relative to their partners, and without the couples along their
 * normals; `other` is 4 or 0. Part i of each quad is computed. */
CT_INLINE void relative_four(int32_t other, int i, const int32_t *place, const double *lanes,
                             const ct_quad n[3], const double *x, ct_quad out[3], ct_quad *gap)
{
  const ct_quad *N = (const ct_quad *)lanes + i, *O = N + PARTS * 4, *d = N + PARTS * 8,
                *w = N + PARTS * 11;
  ct_quad t[8], turn[4], theirs, couple[3], along;
  for (int c = 0; c < 3; c++) {
    for (int32_t a = 0; a < 4; a++) t[a] = N[PARTS * a] * x[place[a] + c];
    ct_sum_face(4, t, &out[c]);
  }
  for (int32_t b = 0; b < other; b++) {
    const double *u = &x[place[4 + b]];
    turn[b] = (d[0] * u[0] + d[PARTS] * u[1]) + d[2 * PARTS] * u[2];
  }
  for (int c = 0; c < 3 && other > 0; c++) {
    for (int32_t b = 0; b < 4; b++) t[b] = O[PARTS * b] * x[place[4 + b] + c];
    ct_sum_face(4, t, &theirs);
    for (int32_t b = 0; b < 4; b++) t[b] = turn[b] * w[PARTS * (3 * b + c)];
    ct_sum_face(4, t, &couple[c]);
    out[c] -= theirs;
  }
  dot(n, out, gap);
  // -- Σ N_a x_a - Σ N̄_b x_b - Σ w_b (d · x_b) (eq:slip-row)
  for (int c = 0; c < 3 && other > 0; c++) out[c] -= couple[c];
  dot(n, out, &along);
  for (int c = 0; c < 3; c++) out[c] -= along * n[c];
}

/* The four rows from `j` on, with the places of their nodes and their numbers. */
CT_INLINE void move_four(int32_t other, const int32_t *place, const double *lanes,
                         const ct_columns *normal, int64_t j, const double *x, const ct_columns *to,
                         double *gaps)
{
  for (int i = 0; i < PARTS; i++) {
    ct_quad n[3], out[3], gap;
    for (int c = 0; c < 3; c++) n[c] = CT_TANGENT_ACROSS(((const ct_quad *)&normal->x[c][j])[i]);
    relative_four(other, i, place, lanes, n, x, out, &gap);
    for (int c = 0; c < 3; c++) ((ct_quad *)&to->x[c][j])[i] = CT_TANGENT_BACK(out[c]);
    if (gaps != NULL) ((ct_quad *)&gaps[j])[i] = CT_TANGENT_BACK(gap);
  }
}

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

/* The same for one row with any faces; `couple`: its lever and weights. Returns the motion along
 * the normal. */
CT_INLINE double relative(int32_t own, int32_t other, const ct_constraint *c, const double *couple,
                          const int32_t *place, const double *x, double out[WIDE])
{
  const double *weight = couple + CT_TANGENT_ALONE;
  double theirs[WIDE] = {0.0}, turn[8];
  sum_face(own, c->own_shape, place, x, out);
  place += own;
  if (other > 0) sum_face(other, c->other_shape, place, x, theirs);
  for (int i = 0; i < WIDE; i++) out[i] -= theirs[i];
  const double gap = ct_vector_dot(c->normal, out);
  if (other > 0) {
    for (int32_t b = 0; b < other; b++) turn[b] = ct_vector_dot(couple, &x[place[b]]);
    for (int i = 0; i < PARTS; i++) {
      ct_quad t[8], sum;
      for (int32_t b = 0; b < other; b++) t[b] = turn[b] * ((const ct_quad *)&weight[4 * b])[i];
      ct_sum_face(other, t, &sum);
      // -- Σ N_a x_a - Σ N̄_b x_b - Σ w_b (d · x_b) (eq:slip-row)
      ((ct_quad *)out)[i] -= sum;
    }
  }
  ct_vector_make_tangential(c->normal, out);
  return gap;
}

CT_INLINE void move_row(const ct_tangent *t, const ct_tangent_group *g, int64_t j, const double *x,
                        const ct_columns *to, double *gaps)
{
  const ct_constraint *c = t->rows[j];
  const double *couple = &t->lanes[LANES * j];
  double out[WIDE], gap;
  if (g->own == 4 && g->other == 4) gap = relative(4, 4, c, couple, g->place, x, out);
  else if (g->own == 4 && g->other == 0) gap = relative(4, 0, c, couple, g->place, x, out);
  else gap = relative(g->own, g->other, c, couple, g->place, x, out);
  ct_columns_set(to, j, out);
  if (gaps != NULL) gaps[j] = gap;
}

/* The motion of all groups that press, and 0 in others; or if `presses` is 0 of the others. */
CT_CLONES
static void move_rows(const ct_tangent *t, int presses, const double *x, const ct_columns *out,
                      double *gaps)
{
  const ct_columns normal = t->normal,
                   to = *out; // local: no number that is written is part of them
  const double *all = t->lanes;
  for (const ct_tangent_group *g = t->groups, *end = g + t->group_count; g < end; g++) {
    const int64_t j = g->first;
    const double *lanes = &all[LANES * j];
    if (g->presses != presses) {
      for (int c = 0; c < 3 && presses; c++)
        memset(&to.x[c][j], 0, (size_t)g->rows * sizeof(double));
      continue;
    }
    if (g->together && g->other == 4) move_four(4, g->place, lanes, &normal, j, x, &to, gaps);
    else if (g->together) move_four(0, g->place, lanes, &normal, j, x, &to, gaps);
    else
      for (int32_t r = 0; r < g->rows; r++) move_row(t, g, j + r, x, &to, gaps);
  }
}

void ct_tangent_motion(const ct_tangent *t, const double *x, const ct_columns *out)
{
  move_rows(t, 1, x, out, NULL);
}

/* Add a force to the sums of a node, or subtract it, as multiples of the grids' spacings: these
 * sums are exact in any order (eq:order-free-sum). */
CT_INLINE void add_node(const ct_grid *grid, int subtract, const ct_quad *force, double *sums)
{
  ct_quad *coarse = (ct_quad *)sums, *fine = coarse + PARTS;
  for (int i = 0; i < PARTS; i++) {
    const ct_quad most = (force[i] + grid->coarse) - grid->coarse,
                  rest = ((force[i] - most) + grid->fine) - grid->fine;
    if (subtract) coarse[i] -= most, fine[i] -= rest;
    else coarse[i] += most, fine[i] += rest;
  }
}

/* Add a row times a force to the sums at nodes. */
CT_INLINE void add_row(const ct_grid *grid, int32_t own, int32_t other, const ct_constraint *c,
                       const int32_t *place, const double *couple, const double T[WIDE],
                       double *sums)
{
  const double *weight = couple + CT_TANGENT_ALONE;
  const ct_quad *force = (const ct_quad *)T, *lever = (const ct_quad *)couple;
  ct_quad part[PARTS];
  for (int32_t a = 0; a < own; a++) {
    // -- N_a T on the own face (eq:slip-row)
    for (int i = 0; i < PARTS; i++) part[i] = c->own_shape[a] * force[i];
    add_node(grid, 0, part, &sums[2 * place[a]]);
  }
  for (int32_t b = 0; b < other; b++) {
    const double turn = ct_vector_dot(&weight[4 * b], T);
    // -- -(N̄_b T + (w_b · T) d) on the other
    for (int i = 0; i < PARTS; i++) part[i] = c->other_shape[b] * force[i] + turn * lever[i];
    add_node(grid, 1, part, &sums[2 * place[own + b]]);
  }
}

CT_INLINE void push_row(const ct_grid *grid, const ct_tangent *t, const ct_tangent_group *g,
                        int64_t j)
{
  const double *couple = &t->lanes[LANES * j];
  double T[WIDE] = {0.0};
  ct_columns_get(&t->T, j, T);
  if (g->own == 4 && g->other == 4) add_row(grid, 4, 4, t->rows[j], g->place, couple, T, t->cut);
  else if (g->own == 4 && g->other == 0)
    add_row(grid, 4, 0, t->rows[j], g->place, couple, T, t->cut);
  else add_row(grid, g->own, g->other, t->rows[j], g->place, couple, T, t->cut);
}

/* The sums over four rows of three numbers each, in pairs across the middle of their face
 * (eq:tree-sum): x, y, z and 0. */
CT_INLINE void sum_lanes(const ct_quad *v, ct_quad *out)
{
#if CT_ROWS
  const ct_quad none = {0.0};
  const ct_quad xy = CT_PICK(v[0], v[1], 0, 4, 2, 6) + CT_PICK(v[0], v[1], 1, 5, 3, 7),
                z = CT_PICK(v[2], none, 0, 4, 2, 6) + CT_PICK(v[2], none, 1, 5, 3, 7);
  *out = CT_PICK(xy, z, 0, 1, 4, 5) + CT_PICK(xy, z, 2, 3, 6, 7);
#else
  double *sum = (double *)out;
  for (int c = 0; c < 3; c++) {
    const double *row = (const double *)&v[PARTS * c];
    sum[c] = (row[0] + row[3]) + (row[1] + row[2]);
  }
  sum[3] = 0.0;
#endif
}

/* As `add_row`, of four rows. */
CT_INLINE void add_four(const ct_grid *grid, int32_t other, const int32_t *place,
                        const double *lanes, const ct_quad *T, double *sums)
{
  const ct_quad *N = (const ct_quad *)lanes, *O = N + PARTS * 4, *d = N + PARTS * 8,
                *w = N + PARTS * 11;
  ct_quad v[3 * PARTS], sum[PARTS];
  for (int32_t a = 0; a < 4; a++) {
    // -- N_a T on the own face (eq:slip-row)
    for (int k = 0; k < 3 * PARTS; k++) v[k] = N[PARTS * a + k % PARTS] * T[k];
    sum_lanes(v, sum);
    add_node(grid, 0, sum, &sums[2 * place[a]]);
  }
  for (int32_t b = 0; b < other; b++, w += 3 * PARTS) {
    ct_quad turn[PARTS];
    for (int i = 0; i < PARTS; i++)
      turn[i] = (w[i] * T[i] + w[PARTS + i] * T[PARTS + i]) + w[2 * PARTS + i] * T[2 * PARTS + i];
    // -- -(N̄_b T + (w_b · T) d) on the other
    for (int k = 0; k < 3 * PARTS; k++)
      v[k] = O[PARTS * b + k % PARTS] * T[k] + turn[k % PARTS] * d[k];
    sum_lanes(v, sum);
    add_node(grid, 1, sum, &sums[2 * place[4 + b]]);
  }
}

CT_INLINE void push_four(const ct_grid *grid, int32_t other, const int32_t *place,
                         const double *lanes, const ct_columns *from, int64_t j, double *sums)
{
  ct_quad T[3 * PARTS];
  for (int k = 0; k < 3 * PARTS; k++)
    T[k] = CT_TANGENT_ACROSS(((const ct_quad *)&from->x[k / PARTS][j])[k % PARTS]);
  add_four(grid, other, place, lanes, T, sums);
}

/* The sums of the forces T of some groups. */
CT_CLONES
static void push_groups(const ct_tangent *t, const ct_tangent_group *g, const ct_tangent_group *end)
{
  const ct_columns T = t->T; // local, as in move_rows
  const ct_grid grid = t->grid;
  const double *all = t->lanes;
  double *sums = t->cut;
  ct_tangent_clear(t);
  for (; g < end; g++) {
    const int64_t j = g->first;
    const double *lanes = &all[LANES * j];
    if (!g->presses) continue;
    if (g->together && g->other == 4) push_four(&grid, 4, g->place, lanes, &T, j, sums);
    else if (g->together) push_four(&grid, 0, g->place, lanes, &T, j, sums);
    else
      for (int32_t r = 0; r < g->rows; r++) push_row(&grid, t, g, j + r);
  }
}

void ct_tangent_clear(const ct_tangent *t)
{
  for (int32_t k = 0; k < t->node_count; k++)
    memset(&t->cut[2 * t->nodes[k]], 0, CT_TANGENT_CUT * sizeof *t->cut);
}

void ct_tangent_join(ct_solver *s, int first, int some)
{
  double *sums = s->tangent->sums;
  if (s->pieces == NULL) return;
  if (!s->tangent->active) ct_pieces_sum(s->pieces, sums, WIDE * (int64_t)s->node_count);
  if (!s->tangent->active || s->shared_count == 0) return;
  ct_matrix_join(s, first, some, sums, s->sums);
  ct_clear(s->sums, (size_t)some * (size_t)s->shared_count);
}

int ct_tangent_push(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  if (t->pushed) return 1;
  // Shape functions of quadratic faces are below 1 in size; the factor 4 is a margin.
  if (!ct_grid_init(&t->grid, 4.0 * s->weight * t->most_force, t->most_row_count)) return 0;
  push_groups(t, t->groups, t->groups + t->group_count);
  for (int32_t k = 0; k < t->node_count; k++)
    memcpy(&t->sums[t->nodes[k]], &t->cut[2 * t->nodes[k]], WIDE * sizeof *t->sums);
  ct_tangent_join(s, 0, 3);
  ct_matrix_move(s, t->node_count, t->nodes, t->sums, t->moved);
  s->iterations++;
  t->pushed = 1;
  return 1;
}

void ct_tangent_give(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  const ct_tangent_group *g = t->groups, *end = g + t->group_count, *next;
  for (; g < end; g = next) {
    const ct_slips *of = t->rows[g->first]->slip->of;
    for (next = g + 1; next < end && t->rows[next->first]->slip->of == of;) next++;
    if (!t->pushed || next - g < t->group_count) push_groups(t, g, next), t->pushed = 0;
    for (int64_t n = 0; n < of->node_count; n++)
      for (int c = 0; c < 6; c++)
        of->sums[CT_SLIP_SUMS * n + c] = t->cut[CT_TANGENT_CUT * (int64_t)of->place[n] + c + c / 3];
  }
}

int ct_tangent_push_all(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  if (!ct_tangent_push(s)) return 0;
  for (int32_t n = 0; n < s->node_count; n++)
    memcpy(&t->sums[WIDE * (int64_t)n], &t->cut[CT_TANGENT_CUT * (int64_t)n],
           WIDE * sizeof *t->sums);
  ct_pieces_sum(s->pieces, t->sums, WIDE * (int64_t)s->node_count);
  ct_matrix_move(s, s->node_count, s->all_nodes, t->sums, t->drift);
  return 1;
}

int ct_tangent_apply(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  if (t->current) return 1;
  if (!ct_tangent_push(s)) return 0;
  move_rows(t, 1, t->moved, &t->image, t->coupled ? t->opened : NULL);
  t->current = 1;
  return 1;
}

void ct_tangent_apply_rest(const ct_tangent *t)
{
  if (t->coupled && t->pushed) move_rows(t, 0, t->moved, &t->image, t->opened);
}
