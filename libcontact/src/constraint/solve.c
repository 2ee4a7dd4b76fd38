/* The forces of all constraints of a step, found together. */
#include "solve.h"
#include "law.h"

#include <libcontact/base.h>

#include "../base/grid.h"
#include "../base/lanes.h"
#include "../base/memory.h"

#include <math.h>
#include <string.h>

enum { MOST_ITERATIONS = 500, FACE_NODES = 8, WIDE = CT_SOLVER_WIDE };

/* The iteration ends when no force changes by more than this part of the largest. */
static const double TOLERANCE = 1e-10;

void ct_solver_free(ct_solver *s)
{
  if (s == NULL) return;
  void *blocks[] = {s->rows,     s->first,  s->first_node, s->nodes,  s->shared,       s->increment,
                    s->mobility, s->past,   s->moved,      s->active, s->first_active, s->entries,
                    s->C,        s->b,      s->free,       s->force,  s->rest,         s->scale,
                    s->way,      s->answer, s->terms,      s};
  for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; i++) ct_release(blocks[i]);
}

/* List the nodes of all sets, and those that are in several. */
static void number_nodes(ct_solver *s, const ct_row_set *sets, int32_t problem_nodes,
                         int32_t *place)
{
  for (int32_t n = 0; n < problem_nodes; n++) place[n] = -1;
  for (int32_t k = 0, next = 0; k < s->set_count; k++)
    for (int32_t i = 0; i < sets[k].node_count; i++, next++) {
      int32_t node = sets[k].nodes == NULL ? i : sets[k].nodes[i];
      s->nodes[next] = node;
      if (place[node] < 0) place[node] = next;
      else s->shared[s->shared_count++] = (ct_shared_node){place[node], next};
    }
}

ct_status ct_solver_create(const ct_row_set *sets, int32_t count, int32_t problem_nodes,
                           int32_t *place, ct_solver **out)
{
  ct_solver *s = ct_allocate(1, sizeof *s);
  *out = s;
  if (s == NULL) return CT_ERROR_MEMORY;
  s->set_count = count;
  s->first = ct_allocate((size_t)count + 1, sizeof *s->first);
  s->first_active = ct_allocate((size_t)count + 1, sizeof *s->first_active);
  s->first_node = ct_allocate((size_t)count + 1, sizeof *s->first_node);
  if (!s->first || !s->first_active || !s->first_node) return CT_ERROR_MEMORY;
  for (int32_t k = 0; k < count; k++) {
    s->most += sets[k].most;
    s->node_count += sets[k].node_count;
    s->first_node[k + 1] = s->node_count;
  }
  size_t nodes = (size_t)s->node_count, rows = (size_t)s->most;
  s->nodes = ct_allocate(nodes, sizeof *s->nodes);
  s->shared = ct_allocate(nodes, sizeof *s->shared);
  s->entries = ct_allocate(nodes, sizeof *s->entries);
  s->rows = ct_allocate(rows, sizeof *s->rows);
  s->active = ct_allocate(rows, sizeof *s->active);
  int whole = s->nodes && s->shared && s->entries && s->rows && s->active;
  double **vectors[] = {&s->increment, &s->mobility, &s->past, &s->moved};
  for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++)
    whole = (*vectors[i] = ct_allocate(nodes, WIDE * sizeof(double))) != NULL && whole;
  double **numbers[] = {&s->C,     &s->b,   &s->free,   &s->force, &s->rest,
                        &s->scale, &s->way, &s->answer, &s->terms};
  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
    whole = (*numbers[i] = ct_allocate(rows, sizeof(double))) != NULL && whole;
  if (!whole) return CT_ERROR_MEMORY;
  number_nodes(s, sets, problem_nodes, place);
  return CT_OK;
}

/* N or |N|; v or |v|: rows with sizes in the place of directions and shape functions bound those of
 * W. All calls know which. */
CT_INLINE double size_if(int sizes, double x) { return sizes ? fabs(x) : x; }

/* Σ_a N_a x_a over the nodes of one face, paired so that a flipped face gives the same bits
 * (ct_side_sum, four components side by side). */
CT_INLINE void sum_face(int sizes, int32_t count, const int32_t *node, const double *N,
                        const double *x, double out[WIDE])
{
  double t[FACE_NODES][WIDE];
  for (int32_t a = 0; a < count; a++) {
    const double *at = &x[WIDE * (int64_t)node[a]];
#pragma omp simd
    for (int i = 0; i < WIDE; i++) t[a][i] = size_if(sizes, N[a]) * at[i];
  }
  if (count == 3 || count == 6)
    for (int i = 0; i < WIDE; i++) t[count == 3 ? 3 : 6][i] = t[count == 3 ? 3 : 7][i] = 0.0;
#pragma omp simd
  for (int i = 0; i < WIDE; i++) out[i] = (t[0][i] + t[1][i]) + (t[2][i] + t[3][i]);
  if (count <= 4) return;
#pragma omp simd
  for (int i = 0; i < WIDE; i++) out[i] += (t[4][i] + t[6][i]) + (t[5][i] + t[7][i]);
}

/* Σ_a N_a n·x_a - Σ_b N̄_b n·x_b of a row, `x` beginning with its set's first node. Inlined with the
 * numbers of nodes known where they are four, as in most faces: the numbers stay in registers. */
CT_INLINE double along_nodes(int sizes, int32_t own_count, int32_t other_count,
                             const ct_constraint *c, const double *x)
{
  double own[WIDE], other[WIDE] = {0.0}, d[3];
  sum_face(sizes, own_count, c->own, c->own_shape, x, own);
  if (other_count > 0) sum_face(sizes, other_count, c->other, c->other_shape, x, other);
  for (int i = 0; i < 3; i++)
    d[i] = size_if(sizes, c->normal[i]) * (sizes ? own[i] + other[i] : own[i] - other[i]);
  return (d[0] + d[1]) + d[2];
}

CT_INLINE double along(int sizes, const ct_constraint *c, const double *x)
{
  return c->own_count == 4 && c->other_count == 4
             ? along_nodes(sizes, 4, 4, c, x)
             : along_nodes(sizes, c->own_count, c->other_count, c, x);
}

/* A vector at the nodes of a set. */
static double *at_set(const ct_solver *s, int32_t k, double *x)
{
  return &x[WIDE * (int64_t)s->first_node[k]];
}

/* Gaps of the steps before and after without the constraints; answers the largest motion or depth.
 */
static double predict_gaps(ct_solver *s)
{
  double most = 0.0;
  for (int32_t i = 0; i < s->shared_count; i++) {
    const ct_shared_node *n = &s->shared[i];
    double *vectors[] = {s->increment, s->mobility, s->past};
    for (int v = 0; v < 3; v++)
      memcpy(&vectors[v][WIDE * (int64_t)n->copy], &vectors[v][WIDE * (int64_t)n->first],
             WIDE * sizeof(double));
  }
  for (int32_t k = 0; k < s->set_count; k++)
    for (int64_t j = s->first[k]; j < s->first[k + 1]; j++) {
      ct_constraint *c = s->rows[j];
      c->before = c->gap - (along(0, c, at_set(s, k, s->past)) + c->moved);
      c->after = c->gap + (along(0, c, at_set(s, k, s->increment)) + c->moved);
      most = fmax(most, fmax(fabs(c->after - c->gap), -c->gap));
    }
  return most;
}

/* Leave out the rows that the motions of this step cannot close (eq:near-constraints). */
static void choose_active(ct_solver *s)
{
  double most = predict_gaps(s);
  s->count = 0;
  for (int32_t k = 0; k < s->set_count; k++) {
    s->first_active[k] = s->count;
    for (int64_t j = s->first[k]; j < s->first[k + 1]; j++) {
      ct_constraint *c = s->rows[j];
      double force = c->force;
      c->force = 0.0;
      if (!(fmin(c->gap, c->after) <= 2.0 * most) || !ct_law_presses(c)) continue;
      s->free[s->count] = c->after;
      s->force[s->count] = force;
      s->active[s->count++] = c;
    }
  }
  s->first_active[s->set_count] = s->count;
}

/* Add N_a times a vector to the sums at the nodes of one face, as multiples of the spacing of the
 * coarse grid: these sums are exact in any order (eq:order-free-sum). */
CT_INLINE void add_nodes(int sizes, const ct_grid *grid, int32_t count, const int32_t *node,
                         const double *N, const double v[WIDE], double *moved)
{
  for (int32_t a = 0; a < count; a++) {
    double *sum = &moved[WIDE * (int64_t)node[a]], n = size_if(sizes, N[a]);
#pragma omp simd
    for (int i = 0; i < WIDE; i++) sum[i] += (n * v[i] + grid->coarse) - grid->coarse;
  }
}

/* The same; with four nodes, as most faces have, the loop is unrolled. */
CT_INLINE void add_face(int sizes, const ct_grid *grid, int32_t count, const int32_t *node,
                        const double *N, const double v[WIDE], double *moved)
{
  if (count == 4) add_nodes(sizes, grid, 4, node, N, v, moved);
  else add_nodes(sizes, grid, count, node, N, v, moved);
}

/* Add the forces `values` of some rows; or of rows of sizes, all of the force 1. */
CT_INLINE void add_rows_of(int sizes, const ct_grid *grid, int64_t count,
                           ct_constraint *const *rows, const double *values, double *moved)
{
  for (int64_t r = 0; r < count; r++) {
    const ct_constraint *c = rows[r];
    double v[WIDE] = {0.0}, back[WIDE] = {0.0};
    if (values[r] == 0.0) continue;
    for (int i = 0; i < 3; i++) {
      v[i] = values[r] * size_if(sizes, c->normal[i]);
      back[i] = sizes ? v[i] : -v[i];
    }
    add_face(sizes, grid, c->own_count, c->own, c->own_shape, v, moved);
    add_face(sizes, grid, c->other_count, c->other, c->other_shape, back, moved);
  }
}

CT_CLONES
static void add_rows(const ct_grid *grid, int64_t count, ct_constraint *const *rows,
                     const double *values, double *restrict moved)
{
  add_rows_of(0, grid, count, rows, values, moved);
}

static void add_sizes(const ct_grid *grid, int64_t count, ct_constraint *const *rows,
                      const double *values, double *restrict moved)
{
  add_rows_of(1, grid, count, rows, values, moved);
}

/* Each node that is in several sets gets the sum of what came to its places. */
static void join_shared(ct_solver *s)
{
  for (int back = 0; back < 2; back++)
    for (int32_t i = 0; i < s->shared_count; i++) {
      double *first = &s->moved[WIDE * (int64_t)s->shared[i].first],
             *copy = &s->moved[WIDE * (int64_t)s->shared[i].copy];
      for (int c = 0; c < WIDE; c++)
        if (back) copy[c] = first[c];
        else first[c] += copy[c];
    }
}

/* The larger of two, written so that it can be done in lanes. */
static inline double larger(double x, double y) { return x > y ? x : y; }

/* What forces of the rows do to nodes, in sums that do not depend on their order: `moved` becomes
 * the displacement A Gᵀ values. */
static int add_up(ct_solver *s, int sizes, const double *values)
{
  ct_grid grid;
  double top = 0.0;
  size_t size = WIDE * (size_t)s->node_count * sizeof(double);
  for (int64_t r = 0; r < s->count; r++) top = larger(top, fabs(values[r]));
  memset(s->moved, 0, size);
  // Shape functions of quadratic faces stay below 1 in size; a factor 2 is room enough.
  if (top == 0.0) return 1;
  if (!ct_grid_init(&grid, 2.0 * top, s->crowd)) return 0;
  for (int32_t k = 0; k < s->set_count; k++) {
    int64_t first = s->first_active[k];
    (sizes ? add_sizes : add_rows)(&grid, s->first_active[k + 1] - first, s->active + first,
                                   values + first, at_set(s, k, s->moved));
  }
  join_shared(s);
  for (int64_t d = 0; d < WIDE * (int64_t)s->node_count; d++) s->moved[d] *= s->mobility[d];
  return 1;
}

/* The largest number of rows that act on one node. */
static void count_crowd(ct_solver *s)
{
  memset(s->entries, 0, (size_t)s->node_count * sizeof *s->entries);
  s->crowd = 0;
  for (int32_t k = 0; k < s->set_count; k++)
    for (int64_t r = s->first_active[k]; r < s->first_active[k + 1]; r++) {
      const ct_constraint *c = s->active[r];
      int32_t *entries = &s->entries[s->first_node[k]];
      for (int32_t a = 0; a < c->own_count; a++) entries[c->own[a]]++;
      for (int32_t a = 0; a < c->other_count; a++) entries[c->other[a]]++;
    }
  for (int32_t i = 0; i < s->shared_count; i++)
    s->entries[s->shared[i].first] += s->entries[s->shared[i].copy];
  for (int32_t n = 0; n < s->node_count; n++)
    s->crowd = s->entries[n] > s->crowd ? s->entries[n] : s->crowd;
}

/* The laws of the rows in this step, and bounds D of the rows of W + C (eq:constraint-bound). */
static int fix_laws(ct_solver *s)
{
  for (int64_t r = 0; r < s->count; r++) s->way[r] = 1.0;
  if (!add_up(s, 1, s->way)) return 0;
  for (int32_t k = 0; k < s->set_count; k++)
    for (int64_t r = s->first_active[k]; r < s->first_active[k + 1]; r++) {
      ct_constraint *c = s->active[r];
      double mobility = along(1, c, at_set(s, k, s->moved));
      c->dashpot = ct_law_dashpot(c, mobility / s->share);
      ct_ramp ramp = ct_law_ramp(c);
      s->C[r] = ramp.C;
      s->b[r] = ramp.b;
      s->scale[r] = mobility + ramp.C;
    }
  return 1;
}

/* (W + C) times some forces, or with `rest` what it leaves of the laws: g_{n+1} + b + C λ. */
CT_CLONES
static void apply_rows(int64_t count, ct_constraint *const *rows, const double *C,
                       const double *values, const double *moved, double *out)
{
  for (int64_t r = 0; r < count; r++) out[r] = along(0, rows[r], moved) + C[r] * values[r];
}

static int apply(ct_solver *s, const double *values, double *out)
{
  if (!add_up(s, 0, values)) return 0;
  for (int32_t k = 0; k < s->set_count; k++) {
    int64_t first = s->first_active[k];
    apply_rows(s->first_active[k + 1] - first, s->active + first, s->C + first, values + first,
               at_set(s, k, s->moved), out + first);
  }
  s->iterations++;
  return 1;
}

/* The slope at the forces now. */
static int find_rest(ct_solver *s)
{
  if (!apply(s, s->force, s->rest)) return 0;
  for (int64_t r = 0; r < s->count; r++) s->rest[r] += s->free[r] + s->b[r];
  return 1;
}

/* How far the slope moves a force in a step of the length 1, which does not end below 0. */
static double descent(const ct_solver *s, int64_t r)
{
  double down = s->scale[r] > 0.0 ? s->rest[r] / s->scale[r] : 0.0;
  return down < s->force[r] ? down : s->force[r];
}

/* Σ x_r y_r, whatever the order of the rows. */
static double product(ct_solver *s, const double *x, const double *y)
{
  for (int64_t r = 0; r < s->count; r++) s->terms[r] = x[r] * y[r];
  return ct_sum(s->terms, s->count);
}

/* Σ of what pressed rows, or those without force, have to gain by a step down (eq:proportioning).
 */
static double gain(ct_solver *s, int pressed)
{
  for (int64_t r = 0; r < s->count; r++)
    s->terms[r] = (s->force[r] > 0.0) == pressed ? s->rest[r] * descent(s, r) : 0.0;
  return ct_sum(s->terms, s->count);
}

/* Whether no force would move by more than a part of the largest. */
static int is_solved(const ct_solver *s, double tolerance)
{
  double most = 0.0, top = 0.0;
  for (int64_t r = 0; r < s->count; r++) {
    most = larger(most, fabs(descent(s, r)));
    top = larger(top, s->force[r]);
  }
  return most <= tolerance * top;
}

/* The slope in the rows that a direction may move: those pressed, or those without a force that
 * want one; over D. */
static void steepest(const ct_solver *s, int pressed, double *way)
{
  for (int64_t r = 0; r < s->count; r++) {
    int free = (s->force[r] > 0.0) == pressed && s->scale[r] > 0.0;
    double down = free ? s->rest[r] / s->scale[r] : 0.0;
    way[r] = pressed ? down : fmin(down, 0.0);
  }
}

/* How far along the direction the first force becomes 0. */
static double room_ahead(const ct_solver *s)
{
  double room = HUGE_VAL;
  for (int64_t r = 0; r < s->count; r++)
    if (s->way[r] > 0.0) room = fmin(room, s->force[r] / s->way[r]);
  return room;
}

/* Go along the direction, and know the slope there. */
static void go(ct_solver *s, double length)
{
  for (int64_t r = 0; r < s->count; r++) {
    s->force[r] -= length * s->way[r];
    s->rest[r] -= length * s->answer[r];
    if (!(s->force[r] > 0.0)) s->force[r] = 0.0;
  }
}

/* The next conjugate direction, among the pressed rows. */
static void conjugate(ct_solver *s, double curvature)
{
  double *down = s->terms;
  // `product` needs the terms: the slope over D is computed where it is used.
  for (int64_t r = 0; r < s->count; r++)
    down[r] =
        s->force[r] > 0.0 && s->scale[r] > 0.0 ? s->rest[r] / s->scale[r] * s->answer[r] : 0.0;
  double share = ct_sum(down, s->count) / curvature;
  for (int64_t r = 0; r < s->count; r++) {
    int free = s->force[r] > 0.0 && s->scale[r] > 0.0;
    s->way[r] = free ? s->rest[r] / s->scale[r] - share * s->way[r] : 0.0;
  }
}

/* One round of the method of proportioning (eq:proportioning). */
static int improve(ct_solver *s)
{
  int pressed = gain(s, 0) <= gain(s, 1);
  if (!pressed) steepest(s, 0, s->way);
  if (!apply(s, s->way, s->answer)) return 0;
  double curvature = product(s, s->way, s->answer), slope = product(s, s->way, s->rest);
  double best = curvature > 0.0 ? slope / curvature : 1.0, room = room_ahead(s);
  if (best <= room) {
    go(s, best);
    if (pressed) conjugate(s, curvature);
    else steepest(s, 1, s->way);
    return 1;
  }
  // -- A force would pull: go as far as none does, then down with all that are pressed
  go(s, room);
  for (int64_t r = 0; r < s->count; r++)
    if (s->force[r] > 0.0) s->force[r] -= descent(s, r);
  if (!find_rest(s)) return 0;
  steepest(s, 1, s->way);
  return 1;
}

/* From the forces of the last step to those of this one. Forces that hold already stay as they are:
 * a start that is made twice gives the same bits. */
static int iterate(ct_solver *s)
{
  if (!find_rest(s)) return 0;
  s->converged = is_solved(s, 10.0 * TOLERANCE);
  while (!s->converged && s->iterations < MOST_ITERATIONS) {
    steepest(s, 1, s->way);
    while (!is_solved(s, TOLERANCE) && s->iterations < MOST_ITERATIONS)
      if (!improve(s)) return 0;
    // -- The slope that was carried along is off by its roundings
    if (!find_rest(s)) return 0;
    s->converged = is_solved(s, 2.0 * TOLERANCE);
  }
  return 1;
}

/* Forces and gaps of the solution into the rows. */
static void hand_out(ct_solver *s)
{
  for (int64_t r = 0; r < s->count; r++) {
    s->active[r]->force = s->force[r];
    // -- g_{n+1}, of the slope g_{n+1} + b + C λ
    s->active[r]->after = s->rest[r] - s->b[r] - s->C[r] * s->force[r];
  }
}

int ct_solver_solve(ct_solver *s)
{
  choose_active(s);
  count_crowd(s);
  s->iterations = 0;
  s->converged = 1;
  if (!fix_laws(s) || !iterate(s)) return 0;
  hand_out(s);
  return 1;
}
