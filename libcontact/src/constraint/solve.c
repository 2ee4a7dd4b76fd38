/* The forces of all constraints of a step, solved for together. */
#include "solve.h"
#include "law.h"
#include "matrix.h"
#include "tangent.h"

#include <libcontact/base.h>

#include "../base/lanes.h"
#include "../base/stream.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Most iterations; and of these most Chebyshev steps, which converge slowly where W has small
 * eigenvalues. */
enum { MOST_ITERATIONS = 2000, MOST_CHEBYSHEV = 12 };

/* Most times that normal and tangential forces are solved for in turn. They are done when the last
 * tangential forces change no normal force by more than the first fraction of the largest, or by
 * more than the second one if no energy appears. */
enum { MOST_PASSES = 20 };
static const double UNCHANGED = 1e-10, NEARLY = 1e-5;

/* Smallest eigenvalue of D⁻¹ (W + C) that Chebyshev steps count on (eq:chebyshev); the largest is
 * at most 1. */
static const double LOWEST = 0.08;

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
  int64_t places = 0, most_entries = 0, slips = 0;
  for (int32_t k = 0; k < count; k++) {
    places += sets[k].node_count, s->most += sets[k].most, slips += sets[k].slips;
    most_entries += sets[k].row_nodes * sets[k].most;
  }
  // Each point may have a second row in the step in which it opens.
  size_t nodes = (size_t)places, rows = 2 * (size_t)s->most, entries = (size_t)most_entries;
  s->set_count = count;
  s->tolerance = CT_SOLVER_TIGHT;
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
  s->G = ct_pool_take(pool, entries, CT_SOLVER_WIDE * sizeof *s->G);
  double **vectors[] = {&s->increment, &s->mobility, &s->last_increment, &s->sums, &s->moved};
  for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++)
    *vectors[i] = ct_pool_take(pool, nodes, CT_SOLVER_WIDE * sizeof(double));
  double **numbers[] = {&s->C,     &s->b,         &s->free,  &s->force, &s->gradient,
                        &s->scale, &s->direction, &s->image, &s->terms, &s->guide};
  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
    *numbers[i] = ct_pool_take(pool, rows, sizeof(double));
  if (pool->failed) return CT_ERROR_MEMORY;
  for (int32_t k = 0; k < count; k++) s->first_node[k + 1] = s->first_node[k] + sets[k].node_count;
  number_nodes(s, sets, problem_nodes, place);
  if (slips > 0) ct_tangent_create(s, slips);
  return pool->failed ? CT_ERROR_MEMORY : CT_OK;
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
  if (!ct_matrix_apply(s, force, out)) return 0;
  // -- W λ + C λ
  add_times(s->count, s->C, force, out);
  s->iterations++;
  return 1;
}

/* Gaps at t_{n-1} and t_{n+1} without the constraints; returns the largest motion or depth. */
static double predict_gaps(ct_solver *s)
{
  double most = 0.0;
  const int64_t count = s->first[s->set_count];
  ct_matrix_times(s, count, s->last_increment, s->terms);
  ct_matrix_times(s, count, s->increment, s->free);
  for (int64_t j = 0; j < count; j++) {
    ct_constraint *c = s->rows[j];
    // -- Before t = 0 there was no step: g_{-1} = g_0 (eq:energy-start)
    c->before = s->starts ? c->gap : c->gap - (s->terms[j] + c->came);
    c->after = c->gap + (s->free[j] + c->moved);
    double motion = fabs(c->after - c->gap), depth = -c->gap, far = motion > depth ? motion : depth;
    most = far > most ? far : most;
    if (s->starts && !s->again) c->impact = (ct_impact){.stored = ct_law_claim(c)};
  }
  return most;
}

/* Drop the rows that have no force in this step (eq:near-constraints). */
static void choose_active(ct_solver *s)
{
  double most = predict_gaps(s);
  ct_pieces_largest(s->pieces, &most, 1);
  const int64_t end = s->first[s->set_count];
  const double near = 2.0 * most;
  int64_t count = 0;
  for (int64_t j = 0; j < end; j++) {
    ct_constraint *c = s->rows[j];
    // The force of a row without a law is given; it has friction.
    if (s->tangent != NULL && !ct_law_has_rows(c->enforcement)) continue;
    // -- Inside neither before, nor now, nor without the force (eq:near-constraints), nor held
    if (!(c->before < 0.0 || c->gap <= near || c->after <= near || ct_law_may_release(c))) {
      c->force = 0.0;
      if (s->again) c->impact = (ct_impact){.reserve = 0.0};
      else ct_law_leave(c, s->dt);
      continue;
    }
    s->entries[count] = s->entries[j];
    s->free[count] = c->after;
    s->force[count] = c->force - c->impact.release;
    // Nothing opens at t = 0, so the place is free; the point closes now.
    if (s->again) c->impact.release = c->force, c->impact.pressed = 0.0;
    s->active[count++] = c;
  }
  s->count = s->point_count = count;
}

static void set_all(double *numbers, int64_t first, int64_t end, double value)
{
  for (int64_t r = first; r < end; r++) numbers[r] = value;
}

/* The laws of the points in this step, and the bound of each row, into `scale`
 * (eq:constraint-bound). */
static int fix_laws(ct_solver *s)
{
  set_all(s->direction, 0, s->count, 1.0);
  if (!ct_matrix_bound(s, s->direction, s->scale)) return 0;
  for (int64_t r = 0; r < s->count; r++) {
    ct_constraint *c = s->active[r];
    c->dashpot = ct_law_dashpot(c, s->scale[r] / s->fraction);
    ct_ramp ramp = ct_law_ramp(c);
    s->C[r] = ramp.C;
    s->b[r] = ramp.b;
  }
  return 1;
}

/* Add a second row for each point that opens in this step and gives back what it holds
 * (eq:release-ramp). */
static int add_releases(ct_solver *s)
{
  const int64_t points = s->count;
  for (int64_t r = 0; r < points; r++) {
    ct_constraint *c = s->active[r];
    // -- Its force without those of its neighbours (eq:release-time)
    const double alone = -(s->free[r] + s->b[r]) / (s->C[r] + s->scale[r]);
    if (s->starts || !(s->scale[r] > 0.0) || !ct_law_releases(c, s->scale[r], s->dt, alone))
      continue;
    s->entries[s->count] = s->entries[r];
    s->free[s->count] = s->free[r];
    s->scale[s->count] = s->scale[r];
    s->active[s->count++] = c;
  }
  double some = (double)(s->count - points);
  ct_pieces_largest(s->pieces, &some, 1);
  if (some == 0.0) return 1;
  ct_matrix_choose(s);
  set_all(s->direction, 0, points, 0.0);
  set_all(s->direction, points, s->count, 1.0);
  if (!ct_matrix_bound(s, s->direction, s->terms)) return 0;
  for (int64_t r = points; r < s->count; r++) {
    ct_ramp ramp = ct_law_release(s->active[r], s->free[r], s->terms[r], &s->force[r]);
    s->C[r] = ramp.C;
    s->b[r] = ramp.b;
  }
  for (int64_t r = 0; r < s->count; r++) s->scale[r] += s->terms[r];
  return 1;
}

/* The rows of the problem, their laws, and the scale of each. */
static int set_up(ct_solver *s)
{
  ct_matrix_fill(s);
  choose_active(s);
  ct_matrix_choose(s);
  if (!fix_laws(s) || !add_releases(s)) return 0;
  // -- 1 / D (eq:constraint-bound)
  for (int64_t r = 0; r < s->count; r++) s->scale[r] = 1.0 / (s->scale[r] + s->C[r]);
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

/* Iterate from the present forces to a tolerance. Forces that already meet ten times the tolerance
 * are not changed, so a repeated start gives the same bits. */
static int iterate(ct_solver *s, double least)
{
  double last = 0.0, tolerance = 10.0 * least;
  int first = 1;
  if (!find_gradient(s) || !isfinite(ct_sum_over(s->pieces, s->gradient, s->count))) return 0;
  for (;; tolerance = least) {
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

/* Energy that a row loses. The second row of a point that opens takes from what the point holds
 * (eq:release-ramp). */
static double loss_of(const ct_solver *s, int64_t r, double after)
{
  const ct_constraint *c = s->active[r];
  if (r < s->point_count) return ct_law_loss(c, s->force[r], after);
  return fmin(c->impact.reserve - 0.5 * s->force[r] * (after - c->before), 0.0);
}

/* Whether all rows together lose energy, to rounding: then the energy of the bodies and of the rows
 * does not grow, whatever the forces are (eq:energy-stop). */
static int loses_energy(ct_solver *s)
{
  double sum[2] = {-1.0, 0.0};
  // Round-off counts only where the losses are not positive.
  for (int sizes = 0; sizes < 2 && sum[0] < 0.0; sizes++) {
    for (int64_t r = 0; r < s->count; r++) {
      // -- g_{n+1}, of the slope g_{n+1} + b + C λ
      const double force = s->force[r], after = s->gradient[r] - s->b[r] - s->C[r] * force;
      s->terms[r] =
          sizes ? force * (fabs(after) + fabs(s->active[r]->before)) : loss_of(s, r, after);
    }
    sum[sizes] = ct_sum_over(s->pieces, s->terms, s->count);
  }
  return sum[0] >= -4.0 * DBL_EPSILON * sum[1];
}

/* Move the forces along the direction, which gets a share of the last one and a multiple of the
 * gradient over D, without making one negative (eq:chebyshev). */
CT_CLONES
static void step_chebyshev(int64_t count, double share, double length, const double *gradient,
                           const double *scale, double *restrict direction, double *restrict force)
{
#pragma omp simd
  for (int64_t r = 0; r < count; r++) {
    // -- d = ρ' ρ d + 2 ρ' r / (δ D), λ' = ⟨λ - d⟩, d = λ - λ' (eq:chebyshev)
    const double next = force[r] - (share * direction[r] + length * (gradient[r] * scale[r])),
                 kept = next > 0.0 ? next : 0.0;
    direction[r] = force[r] - kept;
    force[r] = kept;
  }
}

/* Approach the solution from the forces that an even pressure would have. Sets `converged` if they
 * meet the tolerance and no energy appears; returns 0 if they are not finite. */
static int approach(ct_solver *s)
{
  const double middle = 0.5 * (1.0 + LOWEST), half = 0.5 * (1.0 - LOWEST), ratio = middle / half;
  double share = 0.0, length = 1.0 / middle, rho = 1.0 / ratio;
  // -- λ = ⟨-q / D⟩ (eq:chebyshev)
  for (int64_t r = 0; r < s->count; r++) {
    s->force[r] = fmax(-(s->free[r] + s->b[r]) * s->scale[r], 0.0);
    s->direction[r] = 0.0;
  }
  for (int i = 0; i < MOST_CHEBYSHEV; i++) {
    double d[MEASURES];
    if (!find_gradient(s)) return 0;
    if (i == 0 && !isfinite(ct_sum_over(s->pieces, s->gradient, s->count))) return 0;
    descend(s->count, s->gradient, s->scale, s->force, s->image, s->guide, d);
    ct_pieces_largest(s->pieces, d, MEASURES);
    s->converged = d[MOST] <= s->tolerance * d[TOP] && loses_energy(s);
    if (s->converged) return 1;
    step_chebyshev(s->count, share, length, s->gradient, s->scale, s->direction, s->force);
    const double next = 1.0 / (2.0 * ratio - rho);
    share = next * rho, length = 2.0 * next / half, rho = next;
  }
  return 1;
}

/* The forces of all active rows. A loose solution goes on until no energy appears (eq:energy-stop).
 */
static int find_forces(ct_solver *s)
{
  s->converged = 0;
  if (s->tolerance < CT_SOLVER_LOOSE) return iterate(s, s->tolerance);
  if (!approach(s)) return 0;
  for (double least = 0.1 * s->tolerance; !s->converged; least *= 0.01) {
    if (!iterate(s, fmax(least, CT_SOLVER_TIGHT))) return 0;
    if (!s->converged || least <= CT_SOLVER_TIGHT) return 1;
    s->converged = loses_energy(s);
  }
  return 1;
}

/* Store the forces of the points, without those of the second rows. */
static void store_forces(ct_solver *s)
{
  for (int64_t r = 0; r < s->point_count; r++) s->active[r]->force = s->force[r];
}

/* Store the gaps of the points. */
static void store_gaps(ct_solver *s)
{
  for (int64_t r = 0; r < s->point_count; r++)
    // -- g_{n+1}, of the slope g_{n+1} + b + C λ
    s->active[r]->after = s->gradient[r] - s->b[r] - s->C[r] * s->force[r];
}

/* The forces of all active rows and the tangential ones, in turn, until the second no longer change
 * the first, or hardly and without energy (eq:energy-stop). Returns 0 if they are not finite. */
static int find_all_forces(ct_solver *s)
{
  const double nearly = fmax(NEARLY, 0.1 * s->tolerance);
  for (int pass = 0;; pass++) {
    double change = 0.0;
    if (!find_forces(s)) return 0;
    store_forces(s);
    if (s->tangent == NULL) return 1;
    if (!ct_tangent_solve(s, pass, &change)) return 0;
    if (change <= UNCHANGED || (change <= nearly && loses_energy(s))) return 1;
    if (pass < MOST_PASSES) continue;
    s->converged = 0;
    return 1;
  }
}

/* Add the forces of the second rows, and store what the points hold. */
static void settle(ct_solver *s)
{
  for (int64_t r = 0; s->again && r < s->point_count; r++)
    ct_law_settle_again(s->active[r], s->dt, s->active[r]->impact.release);
  if (s->again) return;
  for (int64_t r = 0; r < s->point_count; r++) s->active[r]->impact.release = 0.0;
  for (int64_t r = s->point_count; r < s->count; r++) {
    s->active[r]->impact.release = s->force[r];
    s->active[r]->force += s->force[r];
  }
  if (s->starts) ct_matrix_times(s, s->point_count, s->last_increment, s->terms);
  for (int64_t r = 0; r < s->point_count; r++) {
    ct_constraint *c = s->active[r];
    // -- Twice the mean motion while the force acts: of two steps, or of half a step with v_0 and
    // v_{1/2} (eq:contact-step-work, eq:reserve-start)
    const double x =
        s->starts ? 0.5 * ((c->after - c->gap) + (s->terms[r] + c->moved)) : c->after - c->before;
    // -- λ_u > 0 (eq:release-time)
    ct_law_settle(c, s->dt, x, s->free[r] + s->b[r] < 0.0);
  }
}

int ct_solver_solve(ct_solver *s)
{
  s->iterations = 0;
  s->converged = 1;
  if (!set_up(s)) return 0;
  if (s->tangent != NULL && !ct_tangent_begin(s)) return 0;
  if (!find_all_forces(s)) return 0;
  if (s->tangent != NULL) ct_tangent_store(s);
  store_gaps(s);
  settle(s);
  return 1;
}
