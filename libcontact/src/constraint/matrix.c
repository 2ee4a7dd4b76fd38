/* The matrix G of the constraint problem, and its products. */
#include "matrix.h"
#include "slip.h"

#include "../base/grid.h"
#include "../base/lanes.h"
#include "../base/stream.h"

#include <math.h>
#include <string.h>

enum { WIDE = CT_SOLVER_WIDE, PARTS = CT_QUAD_PARTS };

/* Places of the nodes of a row in vectors at nodes, from `at` on. */
static void find_places(ct_solver *s, int32_t set, const ct_constraint *c, int64_t at)
{
  const int32_t *place = &s->place[s->first_node[set]];
  int32_t *out = &s->entry_place[at];
  for (int32_t a = 0; a < c->own_count; a++) *out++ = WIDE * place[c->own[a]];
  for (int32_t a = 0; a < c->other_count; a++) *out++ = WIDE * place[c->other[a]];
}

/* Entries of the nodes of one face, N times a direction; the fourth component is the size |b_a|. */
CT_INLINE void fill_face(int32_t count, const double *N, const double direction[WIDE], double *G)
{
  for (int32_t a = 0; a < count; a++) {
    // -- b_a n (eq:constraint-force)
    for (int i = 0; i < PARTS; i++)
      ((ct_quad *)&G[WIDE * a])[i] = N[a] * ((const ct_quad *)direction)[i];
    G[WIDE * a + 3] = fabs(N[a]);
  }
}

/* Entries of one row, with `own` and `other` nodes; inlined for the most frequent numbers. */
CT_INLINE void fill_nodes(int32_t own, int32_t other, const ct_constraint *c, double *G)
{
  const double *n = c->normal, to[WIDE] = {n[0], n[1], n[2]}, from[WIDE] = {-n[0], -n[1], -n[2]};
  fill_face(own, c->own_shape, to, G);
  fill_face(other, c->other_shape, from, G + WIDE * own);
}

/* Entries of one row. */
CT_INLINE void fill_row(const ct_constraint *c, double *G)
{
  if (c->own_count == 4 && c->other_count == 4) fill_nodes(4, 4, c, G);
  else if (c->own_count == 4 && c->other_count == 0) fill_nodes(4, 0, c, G);
  else fill_nodes(c->own_count, c->other_count, c, G);
}

static int has_nodes_of(const ct_constraint *c, const ct_constraint *d)
{
  return c->own == d->own && c->other == d->other && c->own_count == d->own_count &&
         c->other_count == d->other_count;
}

/* The rows of G: b_a n for the nodes a of each listed row (eq:constraint-force). */
CT_CLONES
static void fill_entries(ct_solver *s)
{
  int64_t next = 0, places = 0;
  ct_entries *head = s->entries; // of the first of the rows with the same nodes
  for (int32_t k = 0; k < s->set_count; k++)
    for (int64_t j = s->first[k]; j < s->first[k + 1]; j++) {
      const ct_constraint *c = s->rows[j];
      ct_entries e = {next, places, c->own_count, c->other_count, 1};
      int32_t nodes = e.own + e.other;
      if (j > s->first[k] && has_nodes_of(c, s->rows[j - 1])) {
        e.place -= nodes;
        head->alike++;
      } else {
        head = &s->entries[j];
        find_places(s, k, c, places), places += nodes;
      }
      s->entries[j] = e;
      if (c->slip != NULL) c->slip->place = e.place;
      fill_row(c, &s->G[WIDE * next]);
      next += nodes;
    }
}

/* Whether row `later` has the same nodes as row `r`, and its entries are those that follow on the
 * entries of all rows between them. */
static int follows(const ct_entries *entries, int64_t r, int64_t later)
{
  const ct_entries e = entries[r], l = entries[later];
  return l.place == e.place && l.first == e.first + (later - r) * (e.own + e.other);
}

/* Find for each of some rows how many from it on have the same nodes, with consecutive entries. Of
 * most rows all that were listed with the same nodes are there. */
static void find_alike(int64_t count, ct_entries *entries)
{
  for (int64_t r = 0, end; r < count; r = end) {
    end = r + entries[r].alike;
    if (end > count || !follows(entries, r, end - 1)) end = r + 1;
    while (end < count && follows(entries, r, end)) end++;
    entries[r].alike = (int32_t)(end - r);
  }
}

void ct_matrix_fill(ct_solver *s) { fill_entries(s); }

/* One quad for each of some nodes. */
CT_INLINE void load_nodes(int32_t count, const int32_t *place, const double *x, ct_quad *at)
{
  for (int32_t a = 0; a < count; a++)
    for (int i = 0; i < PARTS; i++) at[PARTS * a + i] = ((const ct_quad *)&x[place[a]])[i];
}

/* Σ over the nodes of one face. */
CT_INLINE void sum_face(int32_t count, const ct_quad *G, const ct_quad *at, ct_quad *out)
{
  for (int i = 0; i < PARTS; i++) {
    ct_quad t[8];
    for (int32_t a = 0; a < count; a++) t[a] = G[PARTS * a + i] * at[PARTS * a + i];
    ct_sum_face(count, t, &out[i]);
  }
}

/* Some rows of G with the same nodes times a vector, or their sizes times its fourth components.
 * Inlined for faces with four and eight nodes, the most frequent ones, so that the values at the
 * nodes stay in registers. */
CT_INLINE void times_rows(int sizes, int32_t own, int32_t other, int32_t rows, const int32_t *place,
                          const double *G, const double *x, double *out)
{
  ct_quad at[PARTS * CT_ROW_NODES], mine[PARTS], theirs[PARTS];
  load_nodes(own + other, place, x, at);
  for (int32_t r = 0; r < rows; r++, G += WIDE * (own + other)) {
    sum_face(own, (const ct_quad *)G, at, mine);
    if (other > 0) sum_face(other, (const ct_quad *)G + PARTS * own, at + PARTS * own, theirs);
    for (int i = 0; other > 0 && i < PARTS; i++) mine[i] += theirs[i];
    const double *sum = (const double *)mine;
    out[r] = sizes ? sum[3] : (sum[0] + sum[1]) + sum[2];
  }
}

/* G times a vector at nodes; with `sizes` the absolute entries times its fourth components. */
CT_CLONES
static void times_G(int sizes, const ct_entries *rows, int64_t count, const int32_t *places,
                    const double *G, const double *x, double *out)
{
  for (const ct_entries *e = rows; e < rows + count; e += e->alike) {
    const int32_t *place = &places[e->place], alike = e->alike;
    const double *g = &G[WIDE * e->first];
    if (e->own == 4 && e->other == 4 && alike == 4) times_rows(sizes, 4, 4, 4, place, g, x, out);
    else if (e->own == 4 && e->other == 0 && alike == 4)
      times_rows(sizes, 4, 0, 4, place, g, x, out);
    else if (e->own == 4 && e->other == 4) times_rows(sizes, 4, 4, alike, place, g, x, out);
    else if (e->own == 4 && e->other == 0) times_rows(sizes, 4, 0, alike, place, g, x, out);
    else if (e->own == 8 && e->other == 8) times_rows(sizes, 8, 8, alike, place, g, x, out);
    else if (e->own == 8 && e->other == 0) times_rows(sizes, 8, 0, alike, place, g, x, out);
    else times_rows(sizes, e->own, e->other, alike, place, g, x, out);
    out += alike;
  }
}

/* Add the four rows of a linear face, times their forces, to the sums at the nodes: as `add_rows`,
 * all at once. */
CT_INLINE void add_four(double coarse, int32_t nodes, const int32_t *place, const double *G,
                        const double *force, double *sums)
{
  const ct_quad *g = (const ct_quad *)G;
  const int32_t row = PARTS * nodes;
  for (int32_t a = 0; a < row; a++)
    ((ct_quad *)&sums[place[a / PARTS]])[a % PARTS] +=
        ((g[a] * force[0] + coarse) - (coarse - g[row + a] * force[1])) +
        ((g[2 * row + a] * force[2] + coarse) - (coarse - g[3 * row + a] * force[3]));
}

/* Add some rows of G with the same nodes, times their forces, to the sums at the nodes, as
 * multiples of the coarse grid's spacing: these sums are exact in any order (eq:order-free-sum).
 * Two rows together need three operations per number instead of four. */
CT_INLINE void add_rows(double coarse, int32_t nodes, int32_t rows, const int32_t *place,
                        const double *G, const double *force, double *sums)
{
  const ct_quad *g = (const ct_quad *)G;
  for (; rows > 1; rows -= 2, g += 2 * PARTS * nodes, force += 2)
    for (int32_t a = 0; a < nodes; a++)
      for (int i = 0; i < PARTS; i++)
        ((ct_quad *)&sums[place[a]])[i] += (g[PARTS * a + i] * force[0] + coarse) -
                                           (coarse - g[PARTS * (nodes + a) + i] * force[1]);
  for (int32_t a = 0; rows > 0 && a < nodes; a++)
    for (int i = 0; i < PARTS; i++)
      ((ct_quad *)&sums[place[a]])[i] += (g[PARTS * a + i] * force[0] + coarse) - coarse;
}

/* Gᵀ times the forces of rows. */
CT_CLONES
static void times_G_transposed(const ct_grid *grid, const ct_entries *rows, int64_t count,
                               const int32_t *places, const double *G, const double *force,
                               double *restrict sums)
{
  const double coarse = grid->coarse;
  for (const ct_entries *e = rows; e < rows + count; e += e->alike) {
    const int32_t *place = &places[e->place], nodes = e->own + e->other;
    const double *g = &G[WIDE * e->first];
    if (nodes == 8 && e->alike == 4) add_four(coarse, 8, place, g, force, sums);
    else if (nodes == 4 && e->alike == 4) add_four(coarse, 4, place, g, force, sums);
    else if (nodes == 4) add_rows(coarse, 4, e->alike, place, g, force, sums);
    else if (nodes == 8) add_rows(coarse, 8, e->alike, place, g, force, sums);
    else add_rows(coarse, nodes, e->alike, place, g, force, sums);
    force += e->alike;
  }
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

int ct_matrix_push(ct_solver *s, const double *force)
{
  ct_grid grid;
  double top = ct_largest(force, s->count);
  ct_pieces_largest(s->pieces, &top, 1);
  // Shape functions of quadratic faces are below 1 in size; the factor 2 is a margin.
  if (!ct_grid_init(&grid, 2.0 * top, s->most_row_count)) return 0;
  times_G_transposed(&grid, s->entries, s->count, s->entry_place, s->G, force, s->sums);
  if (s->shared_count > 0) join_nodes(s);
  move_active_nodes(s->active_node_count, s->active_nodes, s->mobility, s->sums, s->moved);
  return 1;
}

/* List the nodes on which active rows act, and count the rows at each. */
static void list_active_nodes(ct_solver *s)
{
  int32_t *counts = s->row_counts, *nodes = s->active_nodes, count = 0, most = 0;
  for (int32_t k = 0; k < s->active_node_count; k++) counts[nodes[k] / WIDE] = 0;
  for (int64_t r = 0; r < s->count; r += s->entries[r].alike) {
    const ct_entries *e = &s->entries[r];
    const int32_t *place = &s->entry_place[e->place], *end = place + (e->own + e->other);
    for (; place < end; place++) {
      int32_t *own = &counts[(uint32_t)*place / WIDE];
      if (*own == 0) nodes[count++] = *place;
      *own += e->alike;
    }
  }
  for (int32_t k = 0; k < count; k++) {
    const int32_t own = counts[nodes[k] / WIDE];
    most = own > most ? own : most;
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

int ct_matrix_bound(ct_solver *s, const double *ones, double *out)
{
  for (int32_t k = 0; k < s->active_node_count; k++) {
    double *A = &s->mobility[s->active_nodes[k]];
    A[3] = fmax(fmax(A[0], A[1]), A[2]);
  }
  if (!ct_matrix_push(s, ones)) return 0;
  times_G(1, s->entries, s->count, s->entry_place, s->G, s->moved, out);
  return 1;
}

void ct_matrix_times(const ct_solver *s, int64_t count, const double *x, double *out)
{
  times_G(0, s->entries, count, s->entry_place, s->G, x, out);
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
  find_alike(s->count, s->entries);
  list_active_nodes(s);
  if (s->pieces != NULL) list_shared_nodes(s);
}

void ct_matrix_move(int32_t count, const int32_t *place, const double *mobility, double *sums,
                    double *moved)
{
  move_active_nodes(count, place, mobility, sums, moved);
}
