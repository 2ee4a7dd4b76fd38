/* Sums over nodes for a row of the energy balance: each array is read once for all of them. */
#include "sums.h"

#include "../base/bits.h"
#include "../base/lanes.h"
#include "../base/list.h"
#include "../base/stream.h"

#include <math.h>
#include <string.h>

enum { KINETIC, WORK, HALF_WORK, MOMENTUM, BODY_SUMS = MOMENTUM + 6 };
enum { EFFECT_WORK, IMPULSE, EFFECT_SUMS = IMPULSE + 3 };

size_t ct_sum_grids(const ct_problem *problem)
{
  return (size_t)problem->body_count *
         (BODY_SUMS + EFFECT_SUMS * ((size_t)problem->effect_count - 1));
}

/* Grids of the last row for the sums of effect `k` in a body; k = 0: of the body. */
static ct_grid *grids_of(const ct_problem *problem, const ct_state *state, int32_t k, int32_t body)
{
  size_t bodies = (size_t)problem->body_count, b = (size_t)body,
         own = k == 0 ? BODY_SUMS * b
                      : BODY_SUMS * bodies + EFFECT_SUMS * ((size_t)(k - 1) * bodies + b);
  return &state->workspace->grids[own];
}

/* First node of a body; for the number after the last one, the number of nodes. */
static int32_t first_node(const ct_problem *problem, int32_t body)
{
  return body == problem->body_count ? problem->node_count : problem->bodies[body].first_node;
}

/* Begin sums with the grids of the last row. */
static void begin(ct_stream *sums, int count, const ct_grid *grids)
{
  for (int i = 0; i < count; i++) sums[i] = (ct_stream){.grid = grids[i]};
}

/* Save their grids for the next row. */
static void keep(const ct_stream *sums, int count, ct_grid *grids)
{
  for (int i = 0; i < count; i++) grids[i] = sums[i].grid;
}

/* (a_x + a_y) + a_z. */
CT_INLINE double sum_of(const double a[3]) { return (a[0] + a[1]) + a[2]; }

/* Terms of one node, the i-th ones of the sums; `own` is the first effect's force, `begun` says
 * that a constraint's force begins at t = 0. Inlined with a known `begun`. */
CT_INLINE void node_terms(const ct_problem *problem, const ct_state *state, int32_t node,
                          double share, const double *own, int begun, const double middle[3],
                          double (*restrict term)[CT_PIECE], int32_t i)
{
  int64_t d = 3 * (int64_t)node;
  const double *u = &state->displacement[d], *before = &state->velocity[d], *done = &state->work[d],
               *X = &problem->reference[d], *inverse = &problem->inverse_mass[d],
               *total = &state->workspace->total[d];
  double m = problem->mass[node], kick = 2.0 * share * problem->dt, product[3], work[3], half[3],
         v[3], x[3];
  for (int c = 0; c < 3; c++) {
    // -- v_{n+1/2} as far after v_n as v_{n-1/2} is before (eq:stage-velocity)
    double after = ct_kick(before[c], kick, inverse[c], total[c]);
    // -- v_n = ½ (v⁻ + v⁺), x_n
    v[c] = 0.5 * (before[c] + after);
    x[c] = X[c] + u[c];
    // -- v⁻ v⁺ of each component, v_0² where a force begins (eq:discrete-energy, eq:energy-start)
    product[c] = begun ? v[c] * v[c] : before[c] * after;
    // -- Σ f (v⁻ + v⁺) + f_n v_{n-1/2} (eq:work-sum, eq:stage-work)
    work[c] = done[c] + 2.0 * share * own[c] * before[c];
    // -- -f (u - middle) (eq:stored-by-forces)
    half[c] = own[c] * (middle[c] - u[c]);
  }
  term[KINETIC][i] = 0.5 * m * sum_of(product);
  term[WORK][i] = sum_of(work);
  term[HALF_WORK][i] = 0.5 * sum_of(half);
  // -- m v_n, and m x_n × v_n about the origin
  for (int c = 0; c < 3; c++) {
    int p = (c + 1) % 3, q = (c + 2) % 3;
    term[MOMENTUM + c][i] = m * v[c];
    term[MOMENTUM + 3 + c][i] = m * (x[p] * v[q] - x[q] * v[p]);
  }
}

/* Terms of the nodes first ... end - 1. */
CT_CLONES_NODES
static void body_terms(const ct_problem *problem, const ct_state *state, int32_t first, int32_t end,
                       const double middle[3], double (*restrict term)[CT_PIECE])
{
  const ct_workspace *w = state->workspace;
  const uint64_t *begun = ct_workspace_begun(state);
  double share = ct_integrator_share(&problem->integrator), own[3 * CT_PIECE];
  const int32_t count = end - first;
  // `total` is the first effect's force except at nodes where others were added.
  memcpy(own, &w->total[3 * (int64_t)first], 3 * (size_t)count * sizeof *own);
  for (int32_t k = ct_lower_bound(w->shared, w->shared_count, first);
       k < w->shared_count && w->shared[k] < end; k++)
    memcpy(&own[3 * (w->shared[k] - first)], &w->shared_first[3 * (int64_t)k], 3 * sizeof *own);
#pragma omp simd
  for (int32_t i = 0; i < count; i++)
    node_terms(problem, state, first + i, share, &own[3 * i], 0, middle, term, i);
  for (int32_t i = 0; begun != NULL && i < count; i++)
    if (ct_bits_get(begun, first + i))
      node_terms(problem, state, first + i, share, &own[3 * i], 1, middle, term, i);
}

/* Middle of the displacements of a body, independent of the order of its nodes; returns the largest
 * component. */
static double middle_of(int64_t count, const double *u, double middle[3])
{
  double low[3], high[3], largest = -INFINITY;
  ct_extent(count, u, NULL, low, high);
  for (int c = 0; c < 3; c++) {
    middle[c] = 0.5 * (low[c] + high[c]);
    largest = fmax(largest, fmax(-low[c], high[c]));
  }
  return largest;
}

void ct_sum_body(const ct_problem *problem, const ct_state *state, int32_t body, ct_body_sums *out)
{
  int32_t start = first_node(problem, body), count = first_node(problem, body + 1) - start;
  ct_stream sums[BODY_SUMS];
  ct_grid *grids = grids_of(problem, state, 0, body);
  double term[BODY_SUMS][CT_PIECE], middle[3],
      largest = middle_of(count, &state->displacement[3 * (int64_t)start], middle);
  begin(sums, BODY_SUMS, grids);
  for (int32_t i, end; ct_stream_piece(sums, BODY_SUMS, count, &i, &end);) {
    body_terms(problem, state, start + i, start + end, middle, term);
    for (int s = 0; s < BODY_SUMS; s++) ct_stream_add(&sums[s], term[s], end - i);
  }
  keep(sums, BODY_SUMS, grids);
  *out = (ct_body_sums){.kinetic = ct_stream_sum(&sums[KINETIC]),
                        .work = ct_stream_sum(&sums[WORK]),
                        .half_work = ct_stream_sum(&sums[HALF_WORK]),
                        .largest = largest};
  for (int c = 0; c < 3; c++) {
    out->p[c] = ct_stream_sum(&sums[MOMENTUM + c]);
    out->L[c] = ct_stream_sum(&sums[MOMENTUM + 3 + c]);
  }
}

/* Forces of a reaction at its nodes first ... end - 1: minus all others on its degrees of freedom
 * (eq:reaction). */
static void reaction_forces(const ct_problem *problem, const ct_state *state,
                            const ct_effect *effect, int32_t first, int32_t end, double *force)
{
  const double *total = state->workspace->total;
  for (int32_t i = first; i < end; i++) {
    int64_t d = 3 * (int64_t)ct_effect_node(effect, i);
    for (int c = 0; c < 3; c++, d++) *force++ = problem->inverse_mass[d] == 0.0 ? -total[d] : 0.0;
  }
}

/* Compute the terms of the nodes first ... end - 1 of effect `k`: impulses, and twice the work.
 * That is summed with the motion, or for a reaction, whose velocity is constant, follows from the
 * impulse. Returns 0 if the effect has done nothing there, so that all would be zero. */
static int effect_terms(const ct_problem *problem, const ct_state *state, int32_t k, int32_t first,
                        int32_t end, double (*term)[CT_PIECE])
{
  const ct_effect *effect = problem->effects[k];
  ct_starts start = ct_state_starts(problem, k);
  int is_reaction = effect->phase == CT_PHASE_REACTION;
  int64_t d = 3 * (int64_t)first, count = 3 * (int64_t)(end - first);
  double share = ct_integrator_share(&problem->integrator), reaction[3 * CT_PIECE], work[3];
  const double *since = state->impulse + start.impulse + d,
               *before = since + state->impulse_count / 2,
               *done = is_reaction ? since : state->work + start.work + d,
               *force = is_reaction ? reaction : state->workspace->force[k] + d;
  if (is_reaction) reaction_forces(problem, state, effect, first, end, reaction);
  if (ct_is_zero(since, count) && ct_is_zero(before, count) && ct_is_zero(force, count) &&
      ct_is_zero(done, count))
    return 0;
  for (int32_t i = first, n = 0; i < end; i++, n++) {
    const double *v = &state->velocity[3 * (int64_t)ct_effect_node(effect, i)];
    for (int c = 0; c < 3; c++) {
      double f = *force++, impulse = *before++ + (*since++ + share * f);
      work[c] = is_reaction ? 2.0 * impulse * v[c] : *done++ + 2.0 * share * f * v[c];
      term[IMPULSE + c][n] = impulse;
    }
    term[EFFECT_WORK][n] = sum_of(work);
  }
  return 1;
}

void ct_sum_effect(const ct_problem *problem, const ct_state *state, int32_t k, int32_t body,
                   ct_effect_sums *out)
{
  const ct_effect *effect = problem->effects[k];
  int32_t start = ct_effect_below(effect, first_node(problem, body)),
          count = ct_effect_below(effect, first_node(problem, body + 1)) - start;
  ct_stream sums[EFFECT_SUMS];
  ct_grid *grids = grids_of(problem, state, k, body);
  double term[EFFECT_SUMS][CT_PIECE];
  begin(sums, EFFECT_SUMS, grids);
  for (int32_t first, end; ct_stream_piece(sums, EFFECT_SUMS, count, &first, &end);) {
    int is_made = effect_terms(problem, state, k, start + first, start + end, term);
    for (int s = 0; s < EFFECT_SUMS; s++)
      ct_stream_add(&sums[s], is_made ? term[s] : NULL, end - first);
  }
  keep(sums, EFFECT_SUMS, grids);
  out->work = ct_stream_sum(&sums[EFFECT_WORK]);
  for (int c = 0; c < 3; c++) out->impulse[c] = ct_stream_sum(&sums[IMPULSE + c]);
}
