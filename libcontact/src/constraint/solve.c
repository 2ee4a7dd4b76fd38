/* The forces of all constraints of a step, solved for together. */
#include "solve.h"
#include "law.h"

#include <libcontact/base.h>

#include "../base/grid.h"
#include "../base/lanes.h"
#include "../base/memory.h"
#include "../base/stream.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MOST_ITERATIONS = 2000, WIDE = CT_SOLVER_WIDE, PARTS = CT_QUAD_PARTS };

/* The iteration ends when the largest change of a force is below this fraction of the largest
 * force. */
static const double TOLERANCE = 1e-10;

/* Number the nodes of all sets, each once. */
static void number_nodes(ct_solver *s, const ct_row_set *sets, int32_t problem_nodes,
                         int32_t *place)
{
  for (int32_t n = 0; n < problem_nodes; n++) place[n] = -1;
  for (int32_t k = 0, next = 0; k < s->set_count; k++)
    for (int32_t i = 0; i < sets[k].node_count; i++, next++) {
      int32_t node = sets[k].nodes == NULL ? i : sets[k].nodes[i];
      if (place[node] < 0) {
        place[node] = s->node_count;
        s->nodes[s->node_count++] = node;
      }
      s->place[next] = place[node];
    }
}

ct_status ct_solver_create(const ct_row_set *sets, int32_t count, int32_t problem_nodes,
                           int32_t *place, ct_solver **out)
{
  ct_solver *s = *out = ct_allocate(1, sizeof *s);
  if (s == NULL) return CT_ERROR_MEMORY;
  ct_pool *pool = &s->pool;
  int64_t places = 0, most_entries = 0;
  for (int32_t k = 0; k < count; k++) {
    places += sets[k].node_count, s->most += sets[k].most;
    most_entries += sets[k].row_nodes * sets[k].most;
  }
  size_t nodes = (size_t)places, rows = (size_t)s->most, entries = (size_t)most_entries;
  s->set_count = count;
  s->first = ct_pool_take(pool, (size_t)count + 1, sizeof *s->first);
  s->first_node = ct_pool_take(pool, (size_t)count + 1, sizeof *s->first_node);
  s->nodes = ct_pool_take(pool, nodes, sizeof *s->nodes);
  s->place = ct_pool_take(pool, nodes, sizeof *s->place);
  s->row_counts = ct_pool_take(pool, nodes, sizeof *s->row_counts);
  s->rows = ct_pool_take(pool, rows, sizeof *s->rows);
  s->active = ct_pool_take(pool, rows, sizeof *s->active);
  s->entries = ct_pool_take(pool, rows, sizeof *s->entries);
  s->active_nodes = ct_pool_take(pool, nodes, sizeof *s->active_nodes);
  s->shared_nodes = ct_pool_take(pool, nodes, sizeof *s->shared_nodes);
  s->entry_place = ct_pool_take(pool, entries, sizeof *s->entry_place);
  s->G = ct_pool_take(pool, entries, WIDE * sizeof *s->G);
  double **vectors[] = {&s->increment, &s->mobility, &s->last_increment, &s->sums, &s->moved};
  for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++)
    *vectors[i] = ct_pool_take(pool, nodes, WIDE * sizeof(double));
  double **numbers[] = {&s->C,     &s->b,         &s->free,  &s->force, &s->gradient,
                        &s->scale, &s->direction, &s->image, &s->terms, &s->guide};
  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
    *numbers[i] = ct_pool_take(pool, rows, sizeof(double));
  if (pool->failed) return CT_ERROR_MEMORY;
  for (int32_t k = 0; k < count; k++) s->first_node[k + 1] = s->first_node[k] + sets[k].node_count;
  number_nodes(s, sets, problem_nodes, place);
  return CT_OK;
}

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

/* Entries of one row. */
CT_INLINE void fill_row(const ct_constraint *c, double *G)
{
  const double *n = c->normal, to[WIDE] = {n[0], n[1], n[2]}, from[WIDE] = {-n[0], -n[1], -n[2]};
  fill_face(c->own_count, c->own_shape, to, G);
  fill_face(c->other_count, c->other_shape, from, G + WIDE * c->own_count);
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
  for (int32_t k = 0; k < s->set_count; k++)
    for (int64_t j = s->first[k]; j < s->first[k + 1]; j++) {
      const ct_constraint *c = s->rows[j];
      ct_entries e = {next, places, c->own_count, c->other_count, 1};
      int32_t nodes = e.own + e.other;
      if (j > s->first[k] && has_nodes_of(c, s->rows[j - 1])) e.place -= nodes;
      else find_places(s, k, c, places), places += nodes;
      s->entries[j] = e;
      fill_row(c, &s->G[WIDE * next]);
      next += nodes;
    }
}

/* Find for each of some rows how many from it on have the same nodes, with consecutive entries. */
static void find_alike(int64_t count, ct_entries *entries)
{
  for (int64_t r = 0, end; r < count; r = end) {
    ct_entries e = entries[r];
    for (end = r + 1; end < count; end++)
      if (entries[end].place != e.place ||
          entries[end].first != e.first + (end - r) * (e.own + e.other))
        break;
    entries[r].alike = (int32_t)(end - r);
  }
}

/* One quad for each of some nodes. */
CT_INLINE void load_nodes(int32_t count, const int32_t *place, const double *x, ct_quad *at)
{
  for (int32_t a = 0; a < count; a++)
    for (int i = 0; i < PARTS; i++) at[PARTS * a + i] = ((const ct_quad *)&x[place[a]])[i];
}

/* Σ over the nodes of one face, paired so that a flipped face gives the same bits (eq:tree-sum). */
CT_INLINE void sum_face(int32_t count, const ct_quad *G, const ct_quad *at, ct_quad *out)
{
  ct_quad t[8];
  const ct_quad none = {0.0};
  for (int i = 0; i < PARTS; i++) {
    for (int32_t a = 0; a < count; a++) t[a] = G[PARTS * a + i] * at[PARTS * a + i];
    for (int32_t a = count; a < 8; a++) t[a] = none;
    out[i] = (t[0] + t[1]) + (t[2] + t[3]);
    if (count > 4) out[i] += (t[4] + t[6]) + (t[5] + t[7]);
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
    if (e->own == 4 && e->other == 4) times_rows(sizes, 4, 4, alike, place, g, x, out);
    else if (e->own == 4 && e->other == 0) times_rows(sizes, 4, 0, alike, place, g, x, out);
    else if (e->own == 8 && e->other == 8) times_rows(sizes, 8, 8, alike, place, g, x, out);
    else if (e->own == 8 && e->other == 0) times_rows(sizes, 8, 0, alike, place, g, x, out);
    else times_rows(sizes, e->own, e->other, alike, place, g, x, out);
    out += alike;
  }
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
    if (nodes == 4) add_rows(coarse, 4, e->alike, place, g, force, sums);
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

/* `moved` = A Gᵀ times forces. Returns 0 if they are not finite. */
static int move_nodes(ct_solver *s, const double *force)
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

/* terms = x y, row by row. */
CT_CLONES
static void multiply(int64_t count, const double *x, const double *y, double *restrict terms)
{
#pragma omp simd
  for (int64_t r = 0; r < count; r++) terms[r] = x[r] * y[r];
}

/* out += a x, row by row. */
CT_CLONES
static void add_times(int64_t count, const double *a, const double *x, double *restrict out)
{
#pragma omp simd
  for (int64_t r = 0; r < count; r++) out[r] += a[r] * x[r];
}

/* `out` = (W + C) times forces: the gaps that they open plus the compliances times the forces
 * (eq:constraint-problem). */
static int apply(ct_solver *s, const double *force, double *out)
{
  // -- W λ = G (A Gᵀ λ)
  if (!move_nodes(s, force)) return 0;
  times_G(0, s->entries, s->count, s->entry_place, s->G, s->moved, out);
  // -- and C λ
  add_times(s->count, s->C, force, out);
  s->iterations++;
  return 1;
}

/* Gaps at t_{n-1} and t_{n+1} without the constraints; returns the largest motion or depth. */
static double predict_gaps(ct_solver *s)
{
  double most = 0.0;
  int64_t count = s->first[s->set_count];
  times_G(0, s->entries, count, s->entry_place, s->G, s->last_increment, s->terms);
  times_G(0, s->entries, count, s->entry_place, s->G, s->increment, s->free);
  for (int64_t j = 0; j < count; j++) {
    ct_constraint *c = s->rows[j];
    c->before = c->gap - (s->terms[j] + c->came);
    c->after = c->gap + (s->free[j] + c->moved);
    double motion = fabs(c->after - c->gap), depth = -c->gap, far = motion > depth ? motion : depth;
    most = far > most ? far : most;
  }
  return most;
}

/* Drop the rows that the motions of this step cannot close (eq:near-constraints). */
static void choose_active(ct_solver *s)
{
  double most = predict_gaps(s);
  ct_pieces_largest(s->pieces, &most, 1);
  s->count = 0;
  for (int64_t j = 0; j < s->first[s->set_count]; j++) {
    ct_constraint *c = s->rows[j];
    double force = c->force;
    c->force = 0.0;
    // -- Neither touched now nor without the force of the step (eq:near-constraints)
    if (!(c->gap <= 2.0 * most || c->after <= 2.0 * most)) continue;
    s->entries[s->count] = s->entries[j];
    s->free[s->count] = c->after;
    s->force[s->count] = force;
    s->active[s->count++] = c;
  }
  find_alike(s->count, s->entries);
}

/* List the nodes on which active rows act, and count the rows at each. */
static void list_active_nodes(ct_solver *s)
{
  for (int32_t k = 0; k < s->active_node_count; k++) s->row_counts[s->active_nodes[k] / WIDE] = 0;
  s->active_node_count = s->most_row_count = 0;
  for (int64_t r = 0; r < s->count; r += s->entries[r].alike) {
    ct_entries e = s->entries[r];
    for (int64_t i = e.place; i < e.place + e.own + e.other; i++) {
      int32_t place = s->entry_place[i], *row_counts = &s->row_counts[place / WIDE];
      if (*row_counts == 0) s->active_nodes[s->active_node_count++] = place;
      *row_counts += e.alike;
      s->most_row_count = *row_counts > s->most_row_count ? *row_counts : s->most_row_count;
    }
  }
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

/* An upper bound of Σ_k |W_jk| of each row, into `scale` (eq:constraint-bound). */
static int bound_rows(ct_solver *s)
{
  for (int32_t k = 0; k < s->active_node_count; k++) {
    double *A = &s->mobility[s->active_nodes[k]];
    A[3] = fmax(fmax(A[0], A[1]), A[2]);
  }
  for (int64_t r = 0; r < s->count; r++) s->direction[r] = 1.0;
  if (!move_nodes(s, s->direction)) return 0;
  times_G(1, s->entries, s->count, s->entry_place, s->G, s->moved, s->scale);
  return 1;
}

/* The laws of the rows in this step, and the scale of each (eq:constraint-bound). */
static int fix_laws(ct_solver *s)
{
  if (!bound_rows(s)) return 0;
  for (int64_t r = 0; r < s->count; r++) {
    ct_constraint *c = s->active[r];
    double bound = s->scale[r];
    c->dashpot = ct_law_dashpot(c, bound / s->fraction);
    ct_ramp ramp = ct_law_ramp(c);
    s->C[r] = ramp.C;
    s->b[r] = ramp.b;
    // -- 1 / D (eq:constraint-bound)
    s->scale[r] = 1.0 / (bound + ramp.C);
  }
  return 1;
}

/* The gradient at the present forces. */
static int find_gradient(ct_solver *s)
{
  if (!apply(s, s->force, s->gradient)) return 0;
  // -- r = (W + C) λ + g_free + b (eq:constraint-function)
  for (int64_t r = 0; r < s->count; r++) s->gradient[r] += s->free[r] + s->b[r];
  return 1;
}

/* Σ x_r y_r, independent of the order of the rows. */
static double product(ct_solver *s, const double *x, const double *y)
{
  multiply(s->count, x, y, s->terms);
  return ct_sum_over(s->pieces, s->terms, s->count);
}

/* Measures of a unit step down the gradient that keeps forces non-negative: the largest change of
 * any force, the largest change of a force that is 0, and the largest force. */
enum { MOST, LIFT, TOP, MEASURES };

/* `steps` are set for all rows, and `guide`, the gradient over D, for rows with a force. */
CT_CLONES
static void descend(int64_t count, const double *gradient, const double *scale, const double *force,
                    double *restrict steps, double *restrict guide, double measures[MEASURES])
{
  double most = 0.0, top = 0.0, lift = 0.0;
#pragma omp simd reduction(max : most, top, lift)
  for (int64_t r = 0; r < count; r++) {
    // -- Decrease of a force by a step down, which keeps it positive (eq:constraint-iteration)
    double down = gradient[r] * scale[r], step = down < force[r] ? down : force[r],
           size = fabs(step), up = force[r] > 0.0 ? 0.0 : size;
    guide[r] = force[r] > 0.0 ? down : 0.0;
    steps[r] = step;
    most = size > most ? size : most;
    top = force[r] > top ? force[r] : top;
    lift = up > lift ? up : lift;
  }
  measures[MOST] = most, measures[LIFT] = lift, measures[TOP] = top;
}

/* The largest part of any force by which a step along the direction decreases it. */
CT_CLONES
static double fastest_decrease(int64_t count, const double *force, const double *direction)
{
  double fastest = 0.0;
#pragma omp simd reduction(max : fastest)
  for (int64_t r = 0; r < count; r++) {
    double part = direction[r] / force[r]; // NaN if both are 0
    fastest = part > fastest ? part : fastest;
  }
  return fastest;
}

/* Largest step along the direction until the first force becomes 0. */
static double longest_step(const ct_solver *s)
{
  double fastest = fastest_decrease(s->count, s->force, s->direction);
  ct_pieces_largest(s->pieces, &fastest, 1);
  return fastest > 0.0 ? 1.0 / fastest : DBL_MAX;
}

/* Step along the direction, and update the gradient. */
CT_CLONES
static void step_along(int64_t count, double length, const double *direction, const double *image,
                       double *restrict force, double *restrict gradient)
{
#pragma omp simd
  for (int64_t r = 0; r < count; r++) {
    double next = force[r] - length * direction[r];
    force[r] = next > 0.0 ? next : 0.0;
    gradient[r] -= length * image[r];
  }
}

/* The next direction: the guide, plus a multiple of the last direction that makes both conjugate,
 * unless it is the first. */
CT_CLONES
static void next_direction(int64_t count, double share, const double *guide,
                           double *restrict direction)
{
#pragma omp simd
  for (int64_t r = 0; r < count; r++) direction[r] = guide[r] + share * direction[r];
}

/* Step all forces down the gradient without making one negative: this always decreases the function
 * (eq:constraint-iteration). */
static int step_down(ct_solver *s)
{
  double measures[MEASURES];
  descend(s->count, s->gradient, s->scale, s->force, s->image, s->guide, measures);
  for (int64_t r = 0; r < s->count; r++) s->force[r] -= s->image[r];
  return find_gradient(s);
}

/* Step along the direction, whose product with the gradient is given, to the minimum or the first
 * zero force (eq:proportioning). Returns whether a new first direction is needed, or -1 if forces
 * are not finite. */
static int improve(ct_solver *s, double slope)
{
  if (!apply(s, s->direction, s->image)) return -1;
  double curvature = product(s, s->direction, s->image), longest = longest_step(s),
         best = slope / curvature;
  if (slope > 0.0 && curvature > 0.0) { // else the numbers are too small to square
    step_along(s->count, best < longest ? best : longest, s->direction, s->image, s->force,
               s->gradient);
    if (best < longest) return 0;
  }
  // -- Beyond this length a force would be tensile
  return step_down(s) ? 1 : -1;
}

/* Whether the rows without a force promise a larger decrease than those with one; then their steps
 * become the direction (eq:proportioning). */
static int releases(ct_solver *s)
{
  double gain[2];
  for (int with_force = 0; with_force < 2; with_force++) {
    // -- Σ r_j δ_j of the rows without a force, and of those with one
    for (int64_t r = 0; r < s->count; r++)
      s->terms[r] = (s->force[r] > 0.0) == with_force ? s->gradient[r] * s->image[r] : 0.0;
    gain[with_force] = ct_sum_over(s->pieces, s->terms, s->count);
  }
  if (!(gain[0] > gain[1])) return 0; // (eq:proportioning)
  for (int64_t r = 0; r < s->count; r++) s->direction[r] = s->force[r] > 0.0 ? 0.0 : s->image[r];
  return 1;
}

/* Solve from the forces of the last step. Forces that already meet the tolerance are not changed,
 * so a repeated start gives the same bits. */
static int iterate(ct_solver *s)
{
  double last = 0.0, tolerance = 10.0 * TOLERANCE;
  int first = 1;
  if (!find_gradient(s) || !isfinite(ct_sum_over(s->pieces, s->gradient, s->count))) return 0;
  for (;; tolerance = TOLERANCE) {
    double d[MEASURES];
    descend(s->count, s->gradient, s->scale, s->force, s->image, s->guide, d);
    ct_pieces_largest(s->pieces, d, MEASURES);
    s->converged = d[MOST] <= tolerance * d[TOP];
    if (s->converged || s->iterations >= MOST_ITERATIONS) return 1;
    int release = d[LIFT] > 0.0 && releases(s);
    double slope = product(s, release ? s->direction : s->guide, s->gradient);
    if (!release)
      next_direction(s->count, first || !(last > 0.0) ? 0.0 : slope / last, s->guide, s->direction);
    first = improve(s, slope);
    if (first < 0) return 0;
    first = first || release;
    last = slope;
  }
}

/* Store forces and gaps of the solution in the rows. */
static void store_solution(ct_solver *s)
{
  for (int64_t r = 0; r < s->count; r++) {
    s->active[r]->force = s->force[r];
    // -- g_{n+1}, of the slope g_{n+1} + b + C λ
    s->active[r]->after = s->gradient[r] - s->b[r] - s->C[r] * s->force[r];
  }
}

int ct_solver_solve(ct_solver *s)
{
  fill_entries(s);
  find_alike(s->first[s->set_count], s->entries);
  choose_active(s);
  list_active_nodes(s);
  if (s->pieces != NULL) list_shared_nodes(s);
  s->iterations = 0;
  s->converged = 1;
  if (!fix_laws(s) || !iterate(s)) return 0;
  store_solution(s);
  return 1;
}
