/* The matrix G of the constraint problem, and its products. */
#include "matrix.h"
#include "slip.h"

#include "../base/grid.h"
#include "../base/lanes.h"
#include "../base/stream.h"

#include <math.h>
#include <string.h>

enum { WIDE = CT_SOLVER_WIDE, PARTS = CT_QUAD_PARTS, MOST_QUADS = 4 };

/* The node of a face in each lane of its quads: then the sums over lanes pair the nodes as
 * ct_sum_face does, so that a flipped face gives the same bits (eq:tree-sum). */
static const int32_t NODE[8] = {0, 1, 2, 3, 4, 6, 5, 7};

/* Numbers of quads that hold the nodes of a face, and of numbers that a row has in G. */
CT_INLINE int32_t quads_of(int32_t count) { return (int32_t)(((uint32_t)count + 3) / 4); }
CT_INLINE int64_t numbers_of(const ct_group *g)
{
  return 4 * (1 + (int64_t)quads_of(g->own) + quads_of(g->other));
}

/* Places of the nodes of a face in vectors at nodes; the rows there are counted. */
CT_INLINE void find_places(int32_t count, const int32_t *node, const int32_t *number, int32_t rows,
                           int32_t *restrict counts, int32_t *restrict place)
{
  for (int32_t a = 0; a < count; a++) {
    const int32_t own = number[node[a]];
    place[a] = WIDE * own;
    counts[own] += rows;
  }
}

/* Numbers b_a of the nodes of one face; lanes without a node are 0. */
CT_INLINE void fill_face(int32_t count, double sign, const double *N, double *b)
{
  const int32_t whole = count < 4 ? 0 : 4;
  // -- b_a = N_a on the own face, -N̄_a on the other (eq:constraint-force)
  for (int i = 0; whole > 0 && i < PARTS; i++)
    ((ct_quad *)b)[i] = sign * ((const ct_quad *)N)[i];
  for (int32_t l = whole; l < 4 * quads_of(count); l++)
    b[l] = NODE[l] < count ? sign * N[NODE[l]] : 0.0;
}

/* Numbers of one row; inlined for the most frequent numbers of nodes. */
CT_INLINE void fill_row(int32_t own, int32_t other, const ct_constraint *c, double *row)
{
  for (int i = 0; i < 3; i++) row[i] = c->normal[i];
  fill_face(own, 1.0, c->own_shape, row + 4);
  fill_face(other, -1.0, c->other_shape, row + 4 + 4 * quads_of(own));
}

static int has_nodes_of(const ct_constraint *c, const ct_constraint *d)
{
  return c->own == d->own && c->other == d->other && c->own_count == d->own_count &&
         c->other_count == d->other_count;
}

/* Number of rows from the first of some rows on that have its nodes. */
CT_INLINE int32_t count_alike(ct_constraint *const *row, int64_t most)
{
  int32_t rows = 1;
  while (rows < most && has_nodes_of(row[0], row[rows])) rows++;
  return rows;
}

/* Fill one group, with the numbers of nodes of its faces. */
CT_INLINE void fill_group(ct_solver *s, int32_t set, ct_constraint *const *row, int32_t own,
                          int32_t other, const ct_group *g)
{
  const int32_t *number = &s->place[s->first_node[set]];
  const int64_t step = 4 * (1 + quads_of(own) + quads_of(other));
  int32_t *place = &s->entry_place[g->place];
  double *G = &s->G[g->first];
  find_places(own, row[0]->own, number, g->rows, s->row_counts, place);
  find_places(other, row[0]->other, number, g->rows, s->row_counts, place + own);
  for (int32_t r = 0; r < g->rows; r++) fill_row(own, other, row[r], G + r * step);
  for (int32_t r = 0; s->tangent != NULL && r < g->rows; r++)
    if (row[r]->slip != NULL) row[r]->slip->place = g->place;
}

CT_CLONES
void ct_matrix_fill(ct_solver *s)
{
  ct_group *g = s->groups;
  int64_t next = 0, place = 0;
  memset(s->row_counts, 0, (size_t)s->node_count * sizeof *s->row_counts);
  for (int32_t k = 0; k < s->set_count; k++)
    for (int64_t j = s->first[k]; j < s->first[k + 1]; j += g++->rows) {
      ct_constraint *const *row = &s->rows[j];
      const int32_t own = row[0]->own_count, other = row[0]->other_count;
      *g = (ct_group){next, place, own, other, count_alike(row, s->first[k + 1] - j)};
      if (own == 4 && other == 4) fill_group(s, k, row, 4, 4, g);
      else if (own == 4 && other == 0) fill_group(s, k, row, 4, 0, g);
      else fill_group(s, k, row, own, other, g);
      next += g->rows * numbers_of(g);
      place += own + other;
    }
  s->group_count = g - s->groups;
  s->counted = 1;
}

void ct_matrix_add(ct_solver *s, const ct_group *of, int64_t row)
{
  ct_group one = *of, *end = &s->groups[s->group_count];
  s->counted = 0;
  one.first += row * numbers_of(of);
  one.rows = 1;
  if (s->group_count > 0 && end[-1].place == one.place &&
      end[-1].first + end[-1].rows * numbers_of(of) == one.first)
    end[-1].rows++;
  else s->groups[s->group_count++] = one;
}

/* Components of vectors at four nodes, as x, y and z of all. */
CT_INLINE void turn_nodes(const double *const at[4], ct_quad *out)
{
#if CT_ROWS
  const ct_quad a = *(const ct_quad *)at[0], b = *(const ct_quad *)at[1],
                c = *(const ct_quad *)at[2], d = *(const ct_quad *)at[3];
  const ct_quad low = CT_PICK(a, b, 0, 4, 2, 6), low2 = CT_PICK(c, d, 0, 4, 2, 6);
  out[0] = CT_PICK(low, low2, 0, 1, 4, 5);
  out[1] = CT_PICK(CT_PICK(a, b, 1, 5, 3, 7), CT_PICK(c, d, 1, 5, 3, 7), 0, 1, 4, 5);
  out[2] = CT_PICK(low, low2, 2, 3, 6, 7);
#else
  for (int l = 0; l < 4; l++)
    for (int i = 0; i < 3; i++) ((double *)out)[4 * i + l] = at[l][i];
#endif
}

/* The reverse. */
CT_INLINE void turn_back(const ct_quad *v, ct_quad *out)
{
#if CT_ROWS
  const ct_quad none = {0.0}, low = CT_PICK(v[0], v[1], 0, 4, 2, 6),
                high = CT_PICK(v[0], v[1], 1, 5, 3, 7), low2 = CT_PICK(v[2], none, 0, 4, 2, 6),
                high2 = CT_PICK(v[2], none, 1, 5, 3, 7);
  out[0] = CT_PICK(low, low2, 0, 1, 4, 5);
  out[1] = CT_PICK(high, high2, 0, 1, 4, 5);
  out[2] = CT_PICK(low, low2, 2, 3, 6, 7);
  out[3] = CT_PICK(high, high2, 2, 3, 6, 7);
#else
  for (int l = 0; l < 4; l++)
    for (int i = 0; i < WIDE; i++)
      ((double *)out)[WIDE * l + i] = i < 3 ? ((const double *)v)[4 * i + l] : 0.0;
#endif
}

/* Sums over the lanes of four quads: (0 + 1) + (2 + 3) of each. */
CT_INLINE void sum_lanes(const ct_quad *t, ct_quad *out)
{
#if CT_ROWS
  const ct_quad a = CT_PICK(t[0], t[1], 0, 4, 2, 6) + CT_PICK(t[0], t[1], 1, 5, 3, 7),
                b = CT_PICK(t[2], t[3], 0, 4, 2, 6) + CT_PICK(t[2], t[3], 1, 5, 3, 7);
  *out = CT_PICK(a, b, 0, 1, 4, 5) + CT_PICK(a, b, 2, 3, 6, 7);
#else
  for (int r = 0; r < 4; r++) {
    const double *own = (const double *)&t[PARTS * r];
    ((double *)out)[r] = (own[0] + own[1]) + (own[2] + own[3]);
  }
#endif
}

/* |x| of each lane. */
#if defined(__GNUC__)
typedef int64_t quad_bits __attribute__((vector_size(32), aligned(8), may_alias));
#define SIZE_OF(x) ((ct_quad)((quad_bits)(x)&INT64_MAX))
#else
#define SIZE_OF(x) fabs(x)
#endif

/* The node of a row in lane l of the quads of both faces, or -1. */
CT_INLINE int32_t node_in(int32_t own, int32_t other, int32_t l)
{
  const int32_t theirs = l - 4 * quads_of(own);
  if (theirs < 0) return NODE[l] < own ? NODE[l] : -1;
  return NODE[theirs] < other ? own + NODE[theirs] : -1;
}

/* The vectors at the nodes of both faces: for each quad x, y and z, or with `sizes` the fourth
 * components. */
CT_INLINE void load_nodes(int sizes, int32_t own, int32_t other, const int32_t *place,
                          const double *x, ct_quad *at)
{
  for (int32_t q = 0; q < quads_of(own) + quads_of(other); q++) {
    const double *node[4];
    for (int32_t l = 0; l < 4; l++) {
      const int32_t a = node_in(own, other, 4 * q + l);
      node[l] = &x[a < 0 ? 0 : place[a]]; // times 0
    }
    double *fourth = (double *)&at[3 * PARTS * q];
    if (!sizes) turn_nodes(node, &at[3 * PARTS * q]);
    for (int l = 0; sizes && l < 4; l++) fourth[l] = node[l][3];
  }
}

/* Σ over the lanes of some quads, b_a times the motion of the node along the normal, or |b_a| times
 * its fourth component, of four rows. */
CT_INLINE void sum_quads(int sizes, int32_t first, int32_t count, const double *const row[4],
                         const ct_quad *at, ct_quad *out)
{
  for (int32_t q = first; q < first + count; q++) {
    ct_quad t[4 * PARTS], sum[PARTS];
    const ct_quad *x = &at[3 * PARTS * q];
    for (int r = 0; r < 4; r++)
      for (int i = 0; i < PARTS; i++) {
        const double *n = row[r];
        const ct_quad b = ((const ct_quad *)&row[r][4 + 4 * q])[i];
        t[PARTS * r + i] =
            sizes ? SIZE_OF(b) * x[i]
                  : ((n[0] * x[i] + n[1] * x[PARTS + i]) + n[2] * x[2 * PARTS + i]) * b;
      }
    sum_lanes(t, sum);
    for (int i = 0; i < PARTS; i++)
      if (q == first) out[i] = sum[i];
      else out[i] += sum[i];
  }
}

/* Rows of G with the same nodes times a vector, or their sizes times its fourth components. Inlined
 * for faces with four and eight nodes, the most frequent ones, so that the vectors at the nodes
 * stay in registers. */
CT_INLINE void times_rows(int sizes, int32_t own, int32_t other, int32_t rows, const int32_t *place,
                          const double *G, const double *x, double *out)
{
  const int32_t mine = quads_of(own), theirs = quads_of(other), step = 4 * (1 + mine + theirs);
  const ct_quad none = {0.0};
  ct_quad at[3 * PARTS * MOST_QUADS], sum[PARTS], more[PARTS];
  load_nodes(sizes, own, other, place, x, at);
  for (int32_t r = 0; r < rows; r += 4, G += 4 * step) {
    const double *row[4];
    for (int i = 0; i < 4; i++) row[i] = G + (r + i < rows ? i : 0) * step;
    for (int i = 0; i < PARTS; i++) sum[i] = more[i] = none;
    sum_quads(sizes, 0, mine, row, at, sum);
    sum_quads(sizes, mine, theirs, row, at, more);
    for (int i = 0; theirs > 0 && i < PARTS; i++) sum[i] += more[i];
    for (int i = 0; i < 4 && r + i < rows; i++) out[r + i] = ((const double *)sum)[i];
  }
}

/* G times a vector at nodes; with `sizes` the absolute numbers times its fourth components. */
CT_INLINE void times_groups(int sizes, const ct_group *groups, int64_t count,
                            const int32_t *places, const double *G, const double *x, double *out)
{
  const double *end = out + count;
  for (const ct_group *e = groups; out < end; out += e->rows, e++) {
    const int32_t *place = &places[e->place], rows = e->rows;
    const double *g = &G[e->first];
    if (e->own == 4 && e->other == 4 && rows == 4) times_rows(sizes, 4, 4, 4, place, g, x, out);
    else if (e->own == 4 && e->other == 0 && rows == 4)
      times_rows(sizes, 4, 0, 4, place, g, x, out);
    else if (e->own == 4 && e->other == 4) times_rows(sizes, 4, 4, rows, place, g, x, out);
    else if (e->own == 8 && e->other == 8) times_rows(sizes, 8, 8, rows, place, g, x, out);
    else times_rows(sizes, e->own, e->other, rows, place, g, x, out);
  }
}

CT_CLONES
static void times_G(const ct_group *groups, int64_t count, const int32_t *places, const double *G,
                    const double *x, double *out)
{
  times_groups(0, groups, count, places, G, x, out);
}

CT_CLONES
static void times_sizes(const ct_group *groups, int64_t count, const int32_t *places,
                        const double *G, const double *x, double *out)
{
  times_groups(1, groups, count, places, G, x, out);
}

/* Add one row times its force, or two of them, to the sums of its nodes, as multiples of the coarse
 * grid's spacing: these sums are exact in any order (eq:order-free-sum). Two rows together need
 * three operations per number instead of four. With `sizes`, |b_a| times the force. */
CT_INLINE void add_row(int sizes, int32_t quads, int two, double coarse, int32_t step,
                       const double *row, const double *force, ct_quad *sum)
{
  const double *next = row + step;
  for (int32_t q = 0; q < quads; q++)
    for (int c = 0; c < (sizes ? 1 : 3); c++)
      for (int i = 0; i < PARTS; i++) {
        const ct_quad b = ((const ct_quad *)&row[4 + 4 * q])[i];
        const ct_quad f = sizes ? SIZE_OF(b) * force[0] : b * (row[c] * force[0]);
        ct_quad *to = &sum[PARTS * (3 * q + c) + i];
        if (two) {
          const ct_quad d = ((const ct_quad *)&next[4 + 4 * q])[i];
          const ct_quad g = sizes ? SIZE_OF(d) * force[1] : d * (next[c] * force[1]);
          *to += (f + coarse) - (coarse - g);
        } else *to += (f + coarse) - coarse;
      }
}

/* Add the sums of the nodes of a group to those of all nodes. */
CT_INLINE void add_nodes(int sizes, int32_t own, int32_t other, const int32_t *place,
                         const ct_quad *sum, double *sums)
{
  for (int32_t q = 0; q < quads_of(own) + quads_of(other); q++) {
    const ct_quad none = {0.0};
    ct_quad node[4 * PARTS];
    const double *fourth = (const double *)&sum[3 * PARTS * q];
    for (int i = 0; i < 4 * PARTS; i++) node[i] = none;
    if (!sizes) turn_back(&sum[3 * PARTS * q], node);
    for (int32_t l = 0; l < 4; l++) {
      const int32_t a = node_in(own, other, 4 * q + l);
      if (a < 0) continue;
      const int32_t to = place[a];
      if (sizes) sums[to + 3] += fourth[l];
      for (int i = 0; !sizes && i < PARTS; i++) ((ct_quad *)&sums[to])[i] += node[PARTS * l + i];
    }
  }
}

/* Add rows of G with the same nodes, times their forces, to the sums at the nodes. */
CT_INLINE void add_rows(int sizes, double coarse, int32_t own, int32_t other, int32_t rows,
                        const int32_t *place, const double *G, const double *force, double *sums)
{
  const int32_t quads = quads_of(own) + quads_of(other), step = 4 * (1 + quads);
  const ct_quad none = {0.0};
  ct_quad sum[3 * PARTS * MOST_QUADS];
  for (int32_t i = 0; i < 3 * PARTS * quads; i++) sum[i] = none;
  int32_t r = 0;
  for (; r + 1 < rows; r += 2)
    add_row(sizes, quads, 1, coarse, step, G + r * step, force + r, sum);
  if (r < rows) add_row(sizes, quads, 0, coarse, step, G + r * step, force + r, sum);
  add_nodes(sizes, own, other, place, sum, sums);
}

/* Gᵀ times the forces of rows; with `sizes` their absolute numbers times the forces, to the fourth
 * components. */
CT_INLINE void add_groups(int sizes, double coarse, const ct_group *groups, int64_t count,
                          const int32_t *places, const double *G, const double *force,
                          double *restrict sums)
{
  for (const ct_group *e = groups; e < groups + count; force += e->rows, e++) {
    const int32_t *place = &places[e->place], rows = e->rows;
    const double *g = &G[e->first];
    if (e->own == 4 && e->other == 4 && rows == 4)
      add_rows(sizes, coarse, 4, 4, 4, place, g, force, sums);
    else if (e->own == 4 && e->other == 0 && rows == 4)
      add_rows(sizes, coarse, 4, 0, 4, place, g, force, sums);
    else if (e->own == 4 && e->other == 4)
      add_rows(sizes, coarse, 4, 4, rows, place, g, force, sums);
    else if (e->own == 8 && e->other == 8)
      add_rows(sizes, coarse, 8, 8, rows, place, g, force, sums);
    else add_rows(sizes, coarse, e->own, e->other, rows, place, g, force, sums);
  }
}

CT_CLONES
static void times_G_transposed(double coarse, const ct_group *groups, int64_t count,
                               const int32_t *places, const double *G, const double *force,
                               double *restrict sums)
{
  add_groups(0, coarse, groups, count, places, G, force, sums);
}

CT_CLONES
static void times_sizes_transposed(double coarse, const ct_group *groups, int64_t count,
                                   const int32_t *places, const double *G, const double *force,
                                   double *restrict sums)
{
  add_groups(1, coarse, groups, count, places, G, force, sums);
}

/* `moved` = A times the sums at the nodes of active rows; the sums are then cleared. */
CT_CLONES
static void move_active_nodes(int32_t count, const int32_t *place, const double *mobility,
                              double *restrict sums, double *restrict moved)
{
  const ct_quad none = {0.0};
  for (int32_t k = 0; k < count; k++)
    for (int i = 0; i < PARTS; i++) {
      ct_quad *sum = (ct_quad *)&sums[place[k]] + i;
      // -- A (Gᵀ λ), of which G takes the gaps (eq:constraint-problem)
      ((ct_quad *)&moved[place[k]])[i] = *sum * ((const ct_quad *)&mobility[place[k]])[i];
      *sum = none;
    }
}

/* Add the sums of the other pieces at the nodes that they share; `moved` is free until then. */
static void join_nodes(ct_solver *s)
{
  const size_t size = WIDE * sizeof *s->sums;
  for (int32_t k = 0; k < s->shared_count; k++)
    memcpy(&s->moved[WIDE * (int64_t)k], &s->sums[s->shared_nodes[k]], size);
  ct_pieces_sum(s->pieces, s->moved, WIDE * (int64_t)s->shared_count);
  for (int32_t k = 0; k < s->shared_count; k++)
    if (s->row_counts[s->shared_nodes[k] / WIDE] > 0)
      memcpy(&s->sums[s->shared_nodes[k]], &s->moved[WIDE * (int64_t)k], size);
}

/* `moved` = A times Gᵀ, or times its sizes, times forces. Returns 0 if they are not finite. */
static int push(ct_solver *s, int sizes, const double *force)
{
  ct_grid grid;
  double top = ct_largest(force, s->count);
  ct_pieces_largest(s->pieces, &top, 1);
  // Shape functions of quadratic faces are below 1 in size; the factor 2 is a margin.
  if (!ct_grid_init(&grid, 2.0 * top, s->most_row_count)) return 0;
  (sizes ? times_sizes_transposed : times_G_transposed)(grid.coarse, s->groups, s->group_count,
                                                        s->entry_place, s->G, force, s->sums);
  if (s->shared_count > 0) join_nodes(s);
  move_active_nodes(s->active_node_count, s->active_nodes, s->mobility, s->sums, s->moved);
  return 1;
}

int ct_matrix_push(ct_solver *s, const double *force) { return push(s, 0, force); }

/* Count the rows at each node again. */
static void count_rows(ct_solver *s)
{
  memset(s->row_counts, 0, (size_t)s->node_count * sizeof *s->row_counts);
  for (const ct_group *g = s->groups; g < s->groups + s->group_count; g++)
    for (int32_t a = 0; a < g->own + g->other; a++)
      s->row_counts[s->entry_place[g->place + a] / WIDE] += g->rows;
}

/* List the nodes with rows. */
static void list_active_nodes(ct_solver *s)
{
  int32_t count = 0, most = 0;
  for (int32_t n = 0; n < s->node_count; n++) {
    const int32_t rows = s->row_counts[n];
    if (rows > 0) s->active_nodes[count++] = WIDE * n;
    most = rows > most ? rows : most;
  }
  s->active_node_count = count;
  s->most_row_count = most;
}

/* Count the rows of all pieces at each node, and list the nodes with rows of several pieces. */
static void list_shared_nodes(ct_solver *s)
{
  s->shared_count = s->most_row_count = 0;
  for (int32_t n = 0; n < s->node_count; n++) {
    s->moved[2 * (int64_t)n] = s->row_counts[n];
    s->moved[2 * (int64_t)n + 1] = s->row_counts[n] > 0;
  }
  ct_pieces_sum(s->pieces, s->moved, 2 * (int64_t)s->node_count);
  for (int32_t n = 0; n < s->node_count; n++) {
    const double rows = s->moved[2 * (int64_t)n], pieces = s->moved[2 * (int64_t)n + 1];
    if (rows > s->most_row_count) s->most_row_count = (int32_t)rows;
    if (pieces > 1.0) s->shared_nodes[s->shared_count++] = WIDE * n;
  }
}

static double larger(double x, double y) { return x > y ? x : y; }

int ct_matrix_bound(ct_solver *s, const double *ones, double *out)
{
  for (int32_t k = 0; k < s->active_node_count; k++) {
    double *A = &s->mobility[s->active_nodes[k]];
    A[3] = larger(larger(A[0], A[1]), A[2]);
  }
  if (!push(s, 1, ones)) return 0;
  times_sizes(s->groups, s->count, s->entry_place, s->G, s->moved, out);
  return 1;
}

void ct_matrix_times(const ct_solver *s, int64_t count, const double *x, double *out)
{
  times_G(s->groups, count, s->entry_place, s->G, x, out);
}

int ct_matrix_apply(ct_solver *s, const double *force, double *out)
{
  // -- W λ = G (A Gᵀ λ) (eq:constraint-problem)
  if (!ct_matrix_push(s, force)) return 0;
  ct_matrix_times(s, s->count, s->moved, out);
  return 1;
}

void ct_matrix_choose(ct_solver *s)
{
  if (!s->counted) count_rows(s);
  s->counted = 1;
  list_active_nodes(s);
  if (s->pieces != NULL) list_shared_nodes(s);
}

void ct_matrix_move(int32_t count, const int32_t *place, const double *mobility, double *sums,
                    double *moved)
{
  move_active_nodes(count, place, mobility, sums, moved);
}
