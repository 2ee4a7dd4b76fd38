/* The forces of all constraints of a step, solved for together. */
#include "solve.h"
#include "active.h"
#include "bodies.h"
#include "law.h"
#include "law_rows.h"
#include "losses.h"
#include "matrix.h"
#include "tangent.h"
#include "tangent_matrix.h"

#include <libcontact/base.h>

#include "../base/lanes.h"
#include "../base/stream.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MOST_ITERATIONS = 2000 };

/* Most times that normal and tangential forces are solved for in turn. They are done when the last
 * tangential forces change no normal force by more than the first fraction of the largest, or by
 * more than the second one if no energy appears. */
enum { MOST_PASSES = 20 };
static const double UNCHANGED = 1e-10, NEARLY = 1e-5;

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
        if (node > s->nodes[s->last_node]) s->last_node = place[node];
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
  int64_t places = 0, most_entries = 0, most_quads = 0, slips = 0;
  for (int32_t k = 0; k < count; k++) {
    places += sets[k].node_count, s->most += sets[k].most, slips += sets[k].slips;
    s->foreign |= sets[k].foreign;
    most_entries += sets[k].row_nodes * sets[k].most;
    most_quads += 2 * (1 + (sets[k].row_nodes + 6) / 4) * sets[k].most;
  }
  // Each point may have a second row in the step in which it opens.
  size_t nodes = (size_t)places, rows = 2 * (size_t)s->most, entries = (size_t)most_entries;
  s->set_count = count;
  s->tolerance = CT_SOLVER_USUAL;
  int64_t **firsts[] = {&s->first, &s->first_point, &s->first_release};
  for (size_t i = 0; i < sizeof firsts / sizeof firsts[0]; i++)
    *firsts[i] = ct_pool_take(pool, (size_t)count + 1, sizeof *s->first);
  s->first_node = ct_pool_take(pool, (size_t)count + 1, sizeof *s->first_node);
  s->nodes = ct_pool_take(pool, nodes, sizeof *s->nodes);
  s->place = ct_pool_take(pool, nodes, sizeof *s->place);
  s->row_counts = ct_pool_take(pool, nodes, sizeof *s->row_counts);
  s->told_counts = ct_pool_take(pool, nodes, sizeof *s->told_counts);
  s->rows = ct_pool_take(pool, rows, sizeof *s->rows);
  s->active = ct_pool_take(pool, rows, sizeof *s->active);
  s->dropped = ct_pool_take(pool, (size_t)s->most, sizeof *s->dropped);
  s->opened = ct_pool_take(pool, (size_t)s->most, sizeof *s->opened);
  ct_law_rows_create(pool, s->most, s->active, &s->laws);
  s->groups = ct_pool_take(pool, rows + 1, sizeof *s->groups);
  s->listed = ct_pool_take(pool, (size_t)s->most, sizeof *s->listed);
  s->active_nodes = ct_pool_take(pool, nodes, sizeof *s->active_nodes);
  s->shared_nodes = ct_pool_take(pool, nodes, sizeof *s->shared_nodes);
  s->own_shared = ct_pool_take(pool, nodes, sizeof *s->own_shared);
  s->all_nodes = ct_pool_take(pool, nodes, sizeof *s->all_nodes);
  s->entry_place = ct_pool_take(pool, entries, sizeof *s->entry_place);
  s->G = ct_pool_take(pool, (size_t)most_quads, 4 * sizeof *s->G);
  double **vectors[] = {&s->increment, &s->mobility, &s->last_increment,
                        &s->sums,      &s->moved,    &s->bound_mobility};
  for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++)
    *vectors[i] = ct_pool_take(pool, nodes, CT_SOLVER_WIDE * sizeof(double));
  double **numbers[] = {&s->C,     &s->b,         &s->free,  &s->force, &s->gradient,
                        &s->scale, &s->direction, &s->image, &s->terms, &s->guide,
                        &s->after, &s->least,     &s->bound};
  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
    *numbers[i] = ct_pool_take(pool, rows, sizeof(double));
  if (pool->failed) return CT_ERROR_MEMORY;
  for (int32_t k = 0; k < count; k++) s->first_node[k + 1] = s->first_node[k] + sets[k].node_count;
  number_nodes(s, sets, problem_nodes, place);
  for (int32_t n = 0; n < s->node_count; n++) s->all_nodes[n] = CT_SOLVER_WIDE * n;
  if (slips > 0) ct_tangent_create(s, slips);
  return pool->failed ? CT_ERROR_MEMORY : CT_OK;
}

/* terms = x y, row by row; returns a bound of their sizes. */
CT_CLONES
static double multiply(int64_t count, const double *x, const double *y, double *restrict terms)
{
  double top = 0.0, all = 0.0;
#ifndef __clang__ // as in ct_largest
#pragma omp simd reduction(max : top) reduction(+ : all)
#endif
  for (int64_t r = 0; r < count; r++) {
    const double term = x[r] * y[r], size = fabs(term);
    terms[r] = term;
    all += size;
    top = size > top ? size : top;
  }
  return isfinite(all) ? top : INFINITY;
}

/* Σ of terms as multiples of the coarse grid's spacing, exact in any order (eq:order-free-sum). */
CT_CLONES
static double add_coarse(double coarse, const double *terms, int64_t count)
{
  double sum = 0.0;
#pragma omp simd reduction(+ : sum)
  for (int64_t r = 0; r < count; r++) sum += (terms[r] + coarse) - coarse;
  return sum;
}

/* The gradient, from the gaps that the forces open. */
CT_CLONES
static void add_laws(int64_t count, const double *gaps, const double *C, const double *force,
                     const double *free, const double *b, double *gradient)
{
#pragma omp simd
  for (int64_t r = 0; r < count; r++)
    // -- r = (W + C) λ + g_free + b (eq:constraint-function)
    gradient[r] = (gaps[r] + C[r] * force[r]) + (free[r] + b[r]);
}

/* Whether friction needs the motion of the nodes by the forces, and cannot have it at once. */
static int is_followed(const ct_solver *s)
{
  return s->tangent != NULL && s->tangent->coupled && !s->along;
}

/* The gradient at the present forces; W times those with which it begins may be known. */
static int find_gradient(ct_solver *s)
{
  const double *gaps = s->applied ? s->after : s->gradient;
  if (!s->applied && !ct_matrix_apply(s, s->force, s->gradient)) return 0;
  s->applied = 0;
  if (is_followed(s)) ct_matrix_take(s, s->tangent->pressed);
  add_laws(s->count, gaps, s->C, s->force, s->free, s->b, s->gradient);
  return 1;
}

/* Whether the gradients of all pieces are finite. */
static int is_finite(const ct_solver *s)
{
  double most = ct_largest(s->gradient, s->count);
  ct_pieces_largest(s->pieces, &most, 1);
  return isfinite(most);
}

/* Σ of terms that are known, the largest of all pieces being `top`, independent of their order, on
 * one grid only: a search needs no more. */
static double sum_terms(const ct_solver *s, double top)
{
  ct_grid grid;
  if (top == 0.0 || !ct_grid_init(&grid, top, s->all_count)) return top == 0.0 ? 0.0 : NAN;
  double sum = add_coarse(grid.coarse, s->terms, s->count);
  ct_pieces_sum(s->pieces, &sum, 1);
  return sum;
}

/* Σ x_r y_r. */
static double product(const ct_solver *s, const double *x, const double *y)
{
  double top = multiply(s->count, x, y, s->terms);
  ct_pieces_largest(s->pieces, &top, 1);
  return sum_terms(s, top);
}

/* Measures of a unit step down the gradient that keeps forces at their least value or above: the
 * largest change of any force, the largest change of a force that has this value, the largest
 * force, and the largest term of the guide times the gradient. */
enum { MOST, LIFT, TOP, TERM, MEASURES };

/* Step along the direction, of which `image` is the image, if that `moves`; then `image` becomes
 * the steps of all rows. `guide` is the gradient over D in rows with a force, and `terms` those of
 * its product with the gradient. */
CT_INLINE void descend(int moves, double length, int64_t count, const double *scale,
                       const double *least, const double *direction, double *restrict force,
                       double *restrict gradient, double *restrict image, double *restrict guide,
                       double *restrict terms, double measures[MEASURES])
{
  double most = 0.0, top = 0.0, lift = 0.0, largest = 0.0, all = 0.0;
#pragma omp simd reduction(max : most, top, lift, largest) reduction(+ : all)
  for (int64_t r = 0; r < count; r++) {
    if (moves) {
      const double next = force[r] - length * direction[r];
      force[r] = next > least[r] ? next : least[r];
      gradient[r] -= length * image[r];
    }
    // -- Decrease of a force by a step down, which keeps it positive (eq:constraint-iteration), or
    // that of a tie, which has no limit (eq:tie-force)
    double down = gradient[r] * scale[r], above = force[r] - least[r],
           step = down < above ? down : above, size = fabs(step), up = above > 0.0 ? 0.0 : size,
           strength = fabs(force[r]), leads = above > 0.0 ? down : 0.0, term = leads * gradient[r],
           part = fabs(term);
    guide[r] = leads;
    image[r] = step;
    terms[r] = term;
    all += part; // as in ct_largest
    largest = part > largest ? part : largest;
    most = size > most ? size : most;
    top = strength > top ? strength : top;
    lift = up > lift ? up : lift;
  }
  measures[MOST] = most, measures[LIFT] = lift, measures[TOP] = top;
  measures[TERM] = isfinite(all) ? largest : INFINITY;
}

/* The image of a direction, of which it has the gaps, and the terms of the product of both. The
 * measures are the largest part of any force by which a step along the direction decreases it, and
 * the largest term. */
CT_CLONES
static void find_image(int64_t count, const double *C, const double *force, const double *least,
                       const double *direction, double *restrict image, double *restrict terms,
                       double measures[2])
{
  double fastest = 0.0, largest = 0.0, all = 0.0;
#ifndef __clang__ // as in ct_largest
#pragma omp simd reduction(max : fastest, largest) reduction(+ : all)
#endif
  for (int64_t r = 0; r < count; r++) {
    // -- W d + C d (eq:constraint-problem)
    const double own = image[r] + C[r] * direction[r], term = direction[r] * own, size = fabs(term),
                 part = direction[r] / (force[r] - least[r]); // NaN if both are 0; 0 of a tie
    image[r] = own;
    terms[r] = term;
    all += size;
    largest = size > largest ? size : largest;
    fastest = part > fastest ? part : fastest;
  }
  measures[0] = fastest;
  measures[1] = isfinite(all) ? largest : INFINITY;
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

/* The same, with a loop for each kind. */
CT_CLONES
static void descend_along(const ct_solver *s, double length, double measures[MEASURES])
{
  if (length != 0.0)
    descend(1, length, s->count, s->scale, s->least, s->direction, s->force, s->gradient, s->image,
            s->guide, s->terms, measures);
  else
    descend(0, 0.0, s->count, s->scale, s->least, s->direction, s->force, s->gradient, s->image,
            s->guide, s->terms, measures);
}

/* Step all forces down the gradient, after one along the direction, none below its least value:
 * this always decreases the function (eq:constraint-iteration). */
static int step_down(ct_solver *s, double length)
{
  double measures[MEASURES];
  descend_along(s, length, measures);
  for (int64_t r = 0; r < s->count; r++) s->force[r] -= s->image[r];
  return find_gradient(s);
}

/* Step along the direction, whose product with the gradient is given, to the minimum, the `length`
 * of which is left to the next descent, or the first zero force (eq:proportioning). Returns whether
 * a new first direction is needed, or -1 if forces are not finite. */
static int improve(ct_solver *s, double slope, double *length)
{
  double measures[2];
  if (!ct_matrix_apply(s, s->direction, s->image)) return -1;
  find_image(s->count, s->C, s->force, s->least, s->direction, s->image, s->terms, measures);
  ct_pieces_largest(s->pieces, measures, 2);
  const double longest = measures[0] > 0.0 ? 1.0 / measures[0] : DBL_MAX,
               curvature = sum_terms(s, measures[1]), best = slope / curvature;
  *length = 0.0;
  if (slope > 0.0 && curvature > 0.0) { // else the numbers are too small to square
    *length = best < longest ? best : longest;
    if (is_followed(s)) ct_matrix_follow(s, -*length, s->tangent->pressed);
    if (best < longest) return 0;
  }
  // -- Beyond this length a force would be tensile
  const int stepped = step_down(s, *length);
  *length = 0.0;
  return stepped ? 1 : -1;
}

/* Whether the rows without a force promise a larger decrease than those with one; then their steps
 * become the direction (eq:proportioning). */
static int releases(ct_solver *s)
{
  double gain[2];
  for (int with_force = 0; with_force < 2; with_force++) {
    // -- Σ r_j δ_j of the rows without a force, and of those with one
    for (int64_t r = 0; r < s->count; r++)
      s->terms[r] = (s->force[r] > s->least[r]) == with_force ? s->gradient[r] * s->image[r] : 0.0;
    gain[with_force] = ct_sum_over(s->pieces, s->terms, s->count);
  }
  if (!(gain[0] > gain[1])) return 0; // (eq:proportioning)
  for (int64_t r = 0; r < s->count; r++)
    s->direction[r] = s->force[r] > s->least[r] ? 0.0 : s->image[r];
  return 1;
}

/* At t = 0 forces act for half a step, which the losses of rows do not know: they are tight
 * (eq:reserve-start). */
static double tolerance_of(const ct_solver *s)
{
  return s->starts ? fmin(s->tolerance, CT_SOLVER_TIGHT) : s->tolerance;
}

/* Whether forces of which a further step changes none by more than `most`, the largest being `top`,
 * meet a tolerance. If the solution is loose, no energy may appear (eq:energy-stop). */
static int is_solved(ct_solver *s, double tolerance, double most, double top)
{
  s->judged = 0;
  if (!(most <= tolerance * top)) return 0;
  s->judged = tolerance_of(s) > CT_SOLVER_TIGHT && most > CT_SOLVER_TIGHT * top;
  return !s->judged || ct_loses_energy(s);
}

/* The forces of all active rows, beginning with the present ones. Those that already meet ten times
 * a tight tolerance are not changed, so a repeated start gives the same bits. */
static int find_forces(ct_solver *s)
{
  const double least = tolerance_of(s);
  double last = 0.0, length = 0.0, tolerance = least <= CT_SOLVER_TIGHT ? 10.0 * least : least;
  int first = 1;
  if (!find_gradient(s) || !is_finite(s)) return 0;
  for (;; tolerance = least) {
    double d[MEASURES];
    descend_along(s, length, d);
    ct_pieces_largest(s->pieces, d, MEASURES);
    s->converged = is_solved(s, tolerance, d[MOST], d[TOP]);
    if (s->converged || s->iterations >= MOST_ITERATIONS) return 1;
    const int lifts = d[LIFT] > 0.0, release = lifts && releases(s);
    // The last calls may have used the place of the terms.
    const double slope = lifts || s->judged
                             ? product(s, release ? s->direction : s->guide, s->gradient)
                             : sum_terms(s, d[TERM]);
    if (!release)
      next_direction(s->count, first || !(last > 0.0) ? 0.0 : slope / last, s->guide, s->direction);
    first = improve(s, slope, &length);
    if (first < 0) return 0;
    first = first || release;
    last = slope;
  }
}

/* Store the forces of the points, of both rows where there are two: friction is limited by the
 * whole normal force (eq:slip-set). */
static void store_forces(ct_solver *s)
{
  for (int64_t r = 0; r < s->point_count; r++) s->active[r]->force = s->force[r];
  for (int64_t r = s->point_count; r < s->count; r++) s->active[r]->force += s->force[r];
}

/* The forces of all active rows and the tangential ones, in turn, until the second no longer change
 * the first, or hardly and without energy (eq:energy-stop); else those of a step without friction.
 * Returns 0 if they are not finite. */
static int find_all_forces(ct_solver *s)
{
  const double nearly = fmax(NEARLY, 0.1 * tolerance_of(s));
  for (int pass = 0;; pass++) {
    double change = 0.0;
    if (!find_forces(s)) return 0;
    if (s->tangent == NULL) return 1;
    store_forces(s);
    if (!ct_tangent_solve(s, pass, &change)) return 0;
    s->judged = 0;
    if (change <= UNCHANGED || (change <= nearly && ct_loses_energy(s))) return 1;
    if (pass == MOST_PASSES) break;
  }
  if (!ct_tangent_drop(s) || !find_forces(s)) return 0;
  store_forces(s);
  s->converged = 0;
  return 1;
}

/* Twice the mean motion of each point while the force acts: of two steps, or of half a step with
 * v_0 and v_{1/2}, of which `last` is the motion of the nodes (eq:contact-step-work,
 * eq:reserve-start); and its gradient without any force. */
CT_CLONES
static void find_ways(const ct_law_rows *of, int starts, const double *last, const double *free,
                      const double *b, double *restrict way, double *restrict alone)
{
#pragma omp simd
  for (int64_t r = 0; r < of->count; r++) {
    const double begins = 0.5 * ((of->after[r] - of->gap[r]) + (last[r] + of->moved[r])),
                 both = of->after[r] - of->before[r];
    way[r] = starts ? begins : both;
    alone[r] = free[r] + b[r];
  }
}

/* Add the forces of the second rows, and what the points hold after the step. */
static void settle(ct_solver *s)
{
  const ct_law_rows *of = &s->laws;
  ct_clear(of->release, (size_t)of->count);
  for (int64_t r = s->point_count; r < s->count; r++) {
    const int64_t own = s->opened[r - s->point_count];
    of->release[own] = s->force[r];
    of->force[own] += s->force[r];
  }
  if (s->starts) ct_matrix_times(s, s->point_count, s->last_increment, s->terms);
  find_ways(of, s->starts, s->terms, s->free, s->b, s->image, s->guide);
  ct_law_settle_all(of, s->dt, s->image, s->guide, s->judged);
}

/* Write the forces, gaps and memory of the points. */
static void store(ct_solver *s)
{
  const ct_law_rows *of = &s->laws;
  if (s->judged) ct_copy(of->after, s->after, (size_t)of->count * sizeof *of->after);
  else ct_find_after(of->count, s->gradient, s->b, s->C, s->force, of->after);
  ct_copy(of->force, s->force, (size_t)of->count * sizeof *of->force);
  if (!s->again) settle(s);
  ct_law_rows_write(of);
  for (int64_t r = 0; s->again && r < of->count; r++)
    ct_law_settle_again(of->row[r], s->dt, of->row[r]->impact.release);
  s->written = !s->again;
}

/* The forces of the rows that are near, or of all. Returns 0 if they are not finite. */
static int solve(ct_solver *s, int all)
{
  return ct_active_set_up(s, all) && (s->tangent == NULL || ct_tangent_begin(s)) &&
         find_all_forces(s);
}

int ct_solver_solve(ct_solver *s)
{
  s->iterations = 0;
  s->converged = 1;
  if (!solve(s, 0)) return 0;
  const int again = ct_active_throws(s);
  for (int64_t r = 0; again > 0 && r < s->point_count; r++)
    s->active[r]->force = s->laws.force[r]; // of the last step
  if (again < 0 || (again > 0 && !solve(s, 1))) return 0;
  ct_active_leave(s);
  if (s->tangent != NULL) ct_tangent_store(s);
  store(s);
  return 1;
}

int ct_solver_follow(ct_solver *s)
{
  ct_bodies *b = s->bodies;
  if (!ct_matrix_push(s, s->force)) return 0;
  if (s->tangent != NULL && s->tangent->some) {
    memcpy(b->sum, b->push, (size_t)b->count * sizeof *b->push);
    s->tangent->pushed = 0;
    if (!ct_tangent_push(s)) return 0;
    for (int32_t k = 0; k < b->count; k++)
      for (int c = 0; c < 6; c++) b->push[k][c] += b->sum[k][c];
  }
  ct_bodies_move(b, s->active_node_count, s->active_nodes, NULL, s->moved);
  return 1;
}
