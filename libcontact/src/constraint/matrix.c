/* Products with the matrix of the constraint problem. */
#include "matrix.h"
#include "bodies.h"
#include "products.h"

#include "../base/grid.h"
#include "../base/lanes.h"
#include "../base/stream.h"

#include <stddef.h>
#include <string.h>

enum { WIDE = CT_SOLVER_WIDE, PARTS = CT_QUAD_PARTS };

/* List the nodes with rows; the largest number of rows of all pieces is found later. */
static void list_active_nodes(ct_solver *s)
{
  int32_t count = 0, most = 0;
  for (int32_t n = 0; n < s->node_count; n++) {
    const int32_t rows = s->row_counts[n];
    if (rows > 0) s->active_nodes[count++] = WIDE * n;
    most = rows > most ? rows : most;
  }
  s->active_node_count = count;
  if (s->pieces == NULL) s->most_row_count = most;
}

void ct_matrix_count(ct_solver *s)
{
  memset(s->row_counts, 0, (size_t)s->node_count * sizeof *s->row_counts);
  for (ct_group *g = s->groups + s->group_count; g-- > s->groups;) {
    const int alike = g + 1 < s->groups + s->group_count && g->own == g[1].own &&
                      g->other == g[1].other && g->face == g[1].face && g->rows == g[1].rows;
    g->alike = alike ? g[1].alike + 1 : 1;
    for (int32_t a = 0; a < g->own + g->other; a++)
      s->row_counts[s->entry_place[g->place + a] / WIDE] += g->rows;
  }
  list_active_nodes(s);
  s->counted = 1;
}

void ct_matrix_add(ct_solver *s, const ct_group *of, int64_t row)
{
  ct_group one = *of, *end = &s->groups[s->group_count];
  s->counted = 0;
  one.first += row * ct_group_numbers(of);
  one.rows = 1;
  if (s->group_count > 0 && end[-1].place == one.place &&
      end[-1].first + end[-1].rows * ct_group_numbers(of) == one.first)
    end[-1].rows++;
  else s->groups[s->group_count++] = one;
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

/* Add the sums of all pieces at shared nodes. Inlined with a known number of components. */
CT_INLINE void join(const ct_solver *s, int some, double *restrict sums, double *restrict joined)
{
  const int64_t count = some * (int64_t)s->shared_count;
  // Where this piece has rows at all of them none is left out.
  if (s->own_shared_count < s->shared_count) ct_clear(joined, (size_t)count);
  for (int32_t k = 0; k < s->own_shared_count; k++) {
    const int32_t at = s->own_shared[k];
    for (int c = 0; c < some; c++) joined[some * (int64_t)at + c] = sums[s->shared_nodes[at] + c];
  }
  ct_pieces_sum(s->pieces, joined, count);
  for (int32_t k = 0; k < s->own_shared_count; k++) {
    const int32_t at = s->own_shared[k];
    for (int c = 0; c < some; c++) sums[s->shared_nodes[at] + c] = joined[some * (int64_t)at + c];
  }
}

void ct_matrix_join(const ct_solver *s, int first, int some, double *sums, double *joined)
{
  if (some == 3) join(s, 3, sums + first, joined);
  else join(s, some, sums + first, joined);
}

/* Mobilities of the nodes along the one normal of all rows, as fourth components. */
static void project_mobilities(const ct_solver *s)
{
  const double *n = s->normal;
  for (int32_t k = 0; k < s->active_node_count; k++) {
    double *A = &s->mobility[s->active_nodes[k]];
    A[3] = (n[0] * n[0] * A[0] + n[1] * n[1] * A[1]) + n[2] * n[2] * A[2];
  }
}

/* The grid of sums of forces at nodes, of which the largest is `top`. Returns 0 if they are not
 * finite. */
static int init_grid(const ct_solver *s, double top, ct_grid *grid)
{
  // Shape functions of quadratic faces are below 1 in size; the factor 2 is a margin.
  return ct_grid_init(grid, 2.0 * s->weight * top, s->most_row_count);
}

/* Sums of the forces of rows at the nodes of this piece's active rows, or at all; the largest is
 * `top`. Returns 0 if they are not finite. */
static int add_forces(ct_solver *s, ct_add *add, const double *force, double top, int all)
{
  ct_grid grid;
  ct_pieces_largest(s->pieces, &top, 1);
  if (!init_grid(s, top, &grid)) return 0;
  add(grid.coarse, s->groups, s->group_count, s->entry_place, s->G, force, s->sums);
  if (all) ct_pieces_sum(s->pieces, s->sums, WIDE * (int64_t)s->node_count);
  else if (s->shared_count > 0 && add == ct_add_full) ct_matrix_join(s, 0, 3, s->sums, s->moved);
  else if (s->shared_count > 0) ct_matrix_join(s, 3, 1, s->sums, s->moved);
  return 1;
}

void ct_matrix_move(const ct_solver *s, int32_t count, const int32_t *place, double *sums,
                    double *moved)
{
  if (s->bodies != NULL) ct_bodies_push(s->bodies, count, place, NULL, sums);
  move_active_nodes(count, place, s->mobility, sums, moved);
  if (s->bodies != NULL) ct_bodies_move(s->bodies, count, place, NULL, moved);
}

void ct_matrix_take(const ct_solver *s, double *total)
{
  for (int32_t k = 0; k < s->active_node_count; k++)
    memcpy(&total[s->active_nodes[k]], &s->moved[s->active_nodes[k]], WIDE * sizeof *total);
}

CT_CLONES
void ct_matrix_follow(const ct_solver *s, double share, double *total)
{
  for (int32_t k = 0; k < s->active_node_count; k++)
    for (int i = 0; i < PARTS; i++)
      ((ct_quad *)&total[s->active_nodes[k]])[i] +=
          share * ((const ct_quad *)&s->moved[s->active_nodes[k]])[i];
}

int ct_matrix_push(ct_solver *s, const double *force)
{
  if (!add_forces(s, ct_add_full, force, ct_largest(force, s->count), 0)) return 0;
  ct_matrix_move(s, s->active_node_count, s->active_nodes, s->sums, s->moved);
  return 1;
}

int ct_matrix_push_all(ct_solver *s, const double *force)
{
  if (!add_forces(s, ct_add_full, force, ct_largest(force, s->count), 1)) return 0;
  ct_matrix_move(s, s->node_count, s->all_nodes, s->sums, s->moved);
  return 1;
}

/* Count the rows of all pieces at each node, and list the nodes with rows of several pieces. A
 * piece that has a node of a rigid body with rows has all of them, whose forces move all of the
 * body. */
CT_CLONES_NODES
static void list_shared_nodes(ct_solver *s)
{
  const double one = 4294967296.0; // a piece, as a number that no count of rows reaches
  const int32_t *counts = s->row_counts;
  double *restrict all = s->moved, most = 0.0;
#pragma omp simd
  for (int32_t n = 0; n < s->node_count; n++) all[n] = counts[n] + (counts[n] > 0 ? one : 0.0);
  ct_pieces_sum(s->pieces, all, s->node_count);
#ifndef __clang__ // as in ct_largest
#pragma omp simd reduction(max : most)
#endif
  for (int32_t n = 0; n < s->node_count; n++) {
    const double rows = all[n] < 2.0 * one ? all[n] - one : 0.0;
    most = rows > most ? rows : most;
  }
  s->shared_count = s->own_shared_count = 0;
  for (int32_t n = 0; n < s->node_count; n++) {
    const int rigid = s->bodies != NULL && s->bodies->of[n] >= 0 && all[n] > 0.0;
    if (!(all[n] >= 2.0 * one) && !rigid) continue;
    const double rows = all[n] - one * (double)((int64_t)all[n] >> 32);
    most = rows > most ? rows : most;
    if (rigid) s->row_counts[n] = (int32_t)rows;
    if (s->row_counts[n] > 0) s->own_shared[s->own_shared_count++] = s->shared_count;
    s->shared_nodes[s->shared_count++] = WIDE * n;
  }
  s->most_row_count = (int32_t)most;
}

int ct_matrix_bound(ct_solver *s, int64_t from, double *gaps, double *out)
{
  const int32_t count = s->active_node_count, *place = s->active_nodes;
  double top = ct_largest(s->force, s->count);
  ct_grid forces, sizes;
  for (int32_t k = 0; k < count; k++) {
    double *A = &s->mobility[place[k]];
    A[3] = ct_larger(ct_larger(A[0], A[1]), A[2]);
  }
  ct_pieces_largest(s->pieces, &top, 1);
  if (!init_grid(s, top, &forces) || !init_grid(s, 1.0, &sizes)) return 0;
  ct_add_bound(forces.coarse, sizes.coarse, s->groups + from, s->group_count - from, s->entry_place,
               s->G, s->force, s->sums);
  if (s->shared_count > 0) ct_matrix_join(s, 0, WIDE, s->sums, s->moved);
  if (s->bodies != NULL) ct_bodies_push_sizes(s->bodies, count, place, s->sums);
  move_active_nodes(count, place, s->mobility, s->sums, s->moved);
  if (s->bodies != NULL) ct_bodies_move_sizes(s->bodies, count, place, s->moved);
  ct_times_bound(s->groups, s->count, s->entry_place, s->G, s->moved, gaps, out);
  if (s->along) project_mobilities(s);
  return 1;
}

void ct_matrix_times(const ct_solver *s, int64_t count, const double *x, double *out)
{
  ct_times_full(s->groups, count, s->entry_place, s->G, x, out);
}

int ct_matrix_times_group(const ct_solver *s, const ct_group *of, const double *x, double *out)
{
  int moves = 0;
  for (int32_t a = 0; a < of->own + of->other; a++) {
    const double *node = &x[s->entry_place[of->place + a]];
    moves |= node[0] != 0.0 || node[1] != 0.0 || node[2] != 0.0;
  }
  if (moves) ct_times_full(of, of->rows, s->entry_place, s->G, x, out);
  return moves;
}

/* The fourth components of vectors at some nodes become those along a normal. */
CT_CLONES
static void project_nodes(int32_t count, const double *normal, double *x)
{
  for (; count > 0; count--, x += WIDE)
    x[3] = (normal[0] * x[0] + normal[1] * x[1]) + normal[2] * x[2];
}

void ct_matrix_motion(const ct_solver *s, int64_t count, double *x, double *out)
{
  if (!s->along) ct_matrix_times(s, count, x, out);
  if (!s->along) return;
  project_nodes(s->node_count, s->normal, x);
  ct_times_along(s->groups, count, s->entry_place, s->G, x, out);
}

/* Motions along the one normal of all rows, as fourth components of `moved`. */
static int slide(ct_solver *s, const double *force)
{
  const int32_t count = s->active_node_count, *place = s->active_nodes;
  if (!add_forces(s, ct_add_along, force, ct_largest(force, s->count), 0)) return 0;
  if (s->bodies != NULL) ct_bodies_push(s->bodies, count, place, s->normal, s->sums);
  // -- n · A n (Gᵀ λ), of which all forces have one direction (eq:constraint-problem)
  move_active_nodes(count, place, s->mobility, s->sums, s->moved);
  if (s->bodies != NULL) ct_bodies_move(s->bodies, count, place, s->normal, s->moved);
  return 1;
}

int ct_matrix_apply(ct_solver *s, const double *force, double *out)
{
  const int along = s->along;
  s->iterations++;
  // -- W λ = G (A Gᵀ λ) (eq:constraint-problem)
  if (!(along ? slide(s, force) : ct_matrix_push(s, force))) return 0;
  (along ? ct_times_along : ct_times_full)(s->groups, s->count, s->entry_place, s->G, s->moved,
                                           out);
  return 1;
}

void ct_matrix_choose(ct_solver *s)
{
  if (!s->counted) ct_matrix_count(s), s->kept = 0;
  if (s->pieces == NULL) return;
  const size_t size = (size_t)s->node_count * sizeof *s->row_counts;
  double some = s->bodies != NULL || memcmp(s->row_counts, s->told_counts, size) != 0;
  s->counted = s->bodies == NULL;
  ct_pieces_largest(s->pieces, &some, 1);
  if (some == 0.0) return;
  memcpy(s->told_counts, s->row_counts, size);
  list_shared_nodes(s);
  if (s->bodies != NULL) list_active_nodes(s); // the counts became those of all pieces
}
