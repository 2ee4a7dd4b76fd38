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

/* Where the numbers of four rows begin, each four doubles; and those of a row alone, in which
 * vectors have a fourth component, 0, so that they fill a register. */
enum { OTHER = 4 * 4, LEVER = 8 * 4, WEIGHT = 11 * 4, ALONE_WEIGHT = 4 };

/* Most nodes of a face; and the largest η with which couples are small (eq:slip-bound-couples). */
enum { MOST_NODES = 8 };
static const double SMALL_COUPLE = 0.1;

/* Four rows are those of a 2 x 2 rule. In the lanes the rows across the middle of the face stand
 * side by side: 0, 3, 1, 2, so that they are summed in pairs (eq:tree-sum). */
#if CT_ROWS
#define ACROSS(rows) CT_PICK(rows, rows, 0, 3, 1, 2)
#define BACK(lanes) CT_PICK(lanes, lanes, 0, 2, 3, 1)
static const int ROW_OF[4] = {0, 3, 1, 2};
#else
#define ACROSS(rows) (rows)
#define BACK(lanes) (lanes)
static const int ROW_OF[4] = {0, 1, 2, 3};
#endif

/* The numbers of four rows. */
CT_INLINE void fill_four(ct_constraint *const *r, double *to)
{
  const double *from[4];
  double *own[4], *other[4];
  for (int j = 0; j < 4; j++) {
    from[j] = r[ROW_OF[j]]->own_shape;
    own[j] = to + 4 * j, other[j] = to + OTHER + 4 * j;
  }
  ct_turn(from, own);
  if (r[0]->other_count == 0) return;
  for (int j = 0; j < 4; j++) from[j] = r[ROW_OF[j]]->other_shape;
  ct_turn(from, other);
  const double *number = ct_slip_number(r[0]->slip, CT_SLIP_LEVER);
  const int64_t stride = r[0]->slip->of->stride;
  for (int i = 0; i < 15; i++, number += stride)
    for (int k = 0; k < PARTS; k++)
      ((ct_quad *)(to + LEVER + 4 * i))[k] = ACROSS(((const ct_quad *)number)[k]);
}

/* Lever and weights of a row alone. */
static void fill_alone(const ct_constraint *c, double *to)
{
  const int32_t nodes = c->other_count;
  for (int32_t b = -1; b < nodes && nodes > 0; b++) {
    double *v = to + ALONE_WEIGHT + 4 * b;
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
  // Their weights follow on each other; those of other points do not.
  return r[3]->own_shape - r[0]->own_shape == 24;
}

CT_CLONES
void ct_tangent_fill(ct_tangent *t)
{
  for (ct_tangent_group *g = t->groups, *end = g + t->group_count; g < end; g++) {
    ct_constraint *const *r = &t->rows[g->first];
    double *to = &t->lanes[LANES * g->first];
    g->together = stand_together(g, r, t->one_run);
    if (g->together) fill_four(r, to);
    for (int32_t j = 0; !g->together && j < g->rows; j++, to += LANES) fill_alone(r[j], to);
  }
}

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
    for (int c = 0; c < 3; c++) n[c] = ACROSS(((const ct_quad *)&normal->x[c][j])[i]);
    relative_four(other, i, place, lanes, n, x, out, &gap);
    for (int c = 0; c < 3; c++) ((ct_quad *)&to->x[c][j])[i] = BACK(out[c]);
    if (gaps != NULL) ((ct_quad *)&gaps[j])[i] = BACK(gap);
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
  const double *weight = couple + ALONE_WEIGHT;
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

CT_CLONES
static void move_rows(const ct_tangent *t, const double *x, const ct_columns *out, double *gaps)
{
  const ct_columns normal = t->normal,
                   to = *out; // local: no number that is written is part of them
  const double *all = t->lanes;
  for (const ct_tangent_group *g = t->groups, *end = g + t->group_count; g < end; g++) {
    const int64_t j = g->first;
    const double *lanes = &all[LANES * j];
    if (g->together && g->other == 4) move_four(4, g->place, lanes, &normal, j, x, &to, gaps);
    else if (g->together) move_four(0, g->place, lanes, &normal, j, x, &to, gaps);
    else
      for (int32_t r = 0; r < g->rows; r++) move_row(t, g, j + r, x, &to, gaps);
  }
}

void ct_tangent_motion(const ct_tangent *t, const double *x, const ct_columns *out)
{
  move_rows(t, x, out, NULL);
}

/* Add a force to the sums of a node, or subtract it, as multiples of the grids' spacings: these sums
 * are exact in any order (eq:order-free-sum). */
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
  const double *weight = couple + ALONE_WEIGHT;
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
    T[k] = ACROSS(((const ct_quad *)&from->x[k / PARTS][j])[k % PARTS]);
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
    if (g->together && g->other == 4) push_four(&grid, 4, g->place, lanes, &T, j, sums);
    else if (g->together) push_four(&grid, 0, g->place, lanes, &T, j, sums);
    else
      for (int32_t r = 0; r < g->rows; r++) push_row(&grid, t, g, j + r);
  }
}

void ct_tangent_clear(const ct_tangent *t)
{
  for (int32_t k = 0; k < t->node_count; k++)
    memset(&t->cut[2 * t->nodes[k]], 0, CT_SLIP_SUMS * sizeof *t->cut);
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
    for (int32_t n = 0; n < of->node_count; n++)
      memcpy(&of->sums[CT_SLIP_SUMS * (int64_t)n], &t->cut[CT_SLIP_SUMS * (int64_t)of->place[n]],
             CT_SLIP_SUMS * sizeof *t->cut);
  }
}

int ct_tangent_apply(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  if (t->current) return 1;
  if (!ct_tangent_push(s)) return 0;
  move_rows(t, t->moved, &t->image, t->coupled ? t->opened : NULL);
  t->current = 1;
  return 1;
}

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
    const double *w = &couple[ALONE_WEIGHT + 4 * b];
    // -- |N̄_b| + |w_b| |d| (eq:slip-bound)
    size[b] = fabs(c->other_shape[b]) + sqrt(ct_vector_dot(w, w) * d);
    top = ct_larger(size[b], top);
  }
  return top;
}

/* The same of four rows, side by side. */
CT_INLINE double size_four(int32_t other, const double *lanes, double *size)
{
  const double *O = lanes + OTHER, *d = lanes + LEVER;
  double most[4] = {0.0};
  for (int32_t a = 0; a < 4; a++)
#pragma omp simd
    for (int i = 0; i < 4; i++) {
      size[4 * a + i] = fabs(lanes[4 * a + i]);
      most[i] = ct_larger(size[4 * a + i], most[i]);
    }
  for (int32_t b = 0; b < other; b++) {
    const double *w = lanes + WEIGHT + 12 * b;
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
      top = ct_larger(
          size_row(t->rows[g->first + r], lanes + LANES * r, size + CT_ROW_NODES * r), top);
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
  for (int i = 0; i < rows; i++) out[rows == 1 ? 0 : ROW_OF[i]] = D[i];
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

/* The largest |w_b|² |d|² of four rows. */
CT_INLINE double couple_four(const double *lanes)
{
  const double *d = lanes + LEVER, *w = lanes + WEIGHT;
  double most[4] = {0.0};
  for (int32_t b = 0; b < 4; b++, w += 12)
#pragma omp simd
    for (int i = 0; i < 4; i++)
      most[i] = ct_larger((w[i] * w[i] + w[4 + i] * w[4 + i]) + w[8 + i] * w[8 + i], most[i]);
#pragma omp simd
  for (int i = 0; i < 4; i++) most[i] *= (d[i] * d[i] + d[4 + i] * d[4 + i]) + d[8 + i] * d[8 + i];
  return ct_larger(ct_larger(most[0], most[1]), ct_larger(most[2], most[3]));
}

/* The largest e² of all rows (eq:slip-bound-couples). */
CT_CLONES
static double largest_couple(const ct_tangent *t)
{
  double most = 0.0;
  for (const ct_tangent_group *g = t->groups, *end = g + t->group_count; g < end; g++) {
    const double *lanes = &t->lanes[LANES * g->first];
    if (g->other > 0 && g->together) most = ct_larger(couple_four(lanes), most);
    for (int32_t r = 0; g->other > 0 && !g->together && r < g->rows; r++, lanes += LANES)
      for (int32_t b = 0; b < g->other; b++) {
        const double *w = lanes + ALONE_WEIGHT + 4 * b;
        most = ct_larger(ct_vector_dot(w, w) * ct_vector_dot(lanes, lanes), most);
      }
  }
  return most;
}

/* The largest mobility of the nodes with rows, and minus the smallest bound of these. */
CT_CLONES
static void find_extremes(const ct_solver *s, double m[2])
{
  double mobile = 0.0, least = HUGE_VAL;
  for (int32_t k = 0; k < s->active_node_count; k++)
    for (int c = 0; c < 3; c++) mobile = ct_larger(s->mobility[s->active_nodes[k] + c], mobile);
#pragma omp simd reduction(min : least)
  for (int64_t r = 0; r < s->point_count; r++) least = s->bound[r] < least ? s->bound[r] : least;
  m[0] = mobile, m[1] = -least;
}

/* Take the bounds of the normal rows, if these are the same rows and their couples are small.
 * Returns 0 if not. */
static int widen_bound(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  if (!t->active || s->bodies != NULL) return 0;
  double m[3] = {largest_couple(t)};
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
