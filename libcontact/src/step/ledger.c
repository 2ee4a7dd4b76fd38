/* Work and impulses of the effects, summed during the motion. */
#include "ledger.h"

#include "../base/lanes.h"
#include "../base/list.h"

#include <string.h>

void ct_ledger_keep(ct_state *state)
{
  ct_workspace *w = state->workspace;
  for (int32_t i = 0; i < w->shared_count; i++) {
    int64_t dof = 3 * (int64_t)w->shared[i];
    memcpy(&w->shared_velocity[3 * (int64_t)i], &state->velocity[dof], 3 * sizeof(double));
    memcpy(&w->shared_work[3 * (int64_t)i], &state->work[dof], 3 * sizeof(double));
  }
}

/* After the step: at nodes with several effects the first effect's work is that of its own force
 * (eq:work-balance, eq:stage-work). */
static void correct_shared(ct_state *state, double share)
{
  ct_workspace *w = state->workspace;
  for (int32_t i = 0; i < w->shared_count; i++)
    for (int c = 0; c < 3; c++) {
      int64_t dof = 3 * (int64_t)w->shared[i] + c, own = 3 * (int64_t)i + c;
      state->work[dof] = w->shared_work[own] + share * w->shared_first[own] *
                                                   (w->shared_velocity[own] + state->velocity[dof]);
    }
}

/* A number, or +0 if `wanted` is 0; with bit operations, because compilers turn a choice into a
 * branch. */
CT_INLINE double only_where(int wanted, double x)
{
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  bits &= -(uint64_t)wanted;
  memcpy(&x, &bits, sizeof x);
  return x;
}

/* Subtract the forces on prescribed degrees of freedom from an impulse. */
CT_CLONES
static void react(int64_t count, double share, const double *restrict inverse_mass,
                  const double *restrict force, double *restrict impulse)
{
#pragma omp simd
  for (int64_t d = 0; d < count; d++)
    impulse[d] -= only_where(inverse_mass[d] == 0.0, share * force[d]);
}

/* The impulse of one reaction: minus all other forces on its degrees of freedom. */
static void count_reaction(const ct_problem *problem, const double *total, const ct_effect *effect,
                           double share, int32_t first, int32_t last, double *impulse)
{
  const int32_t *nodes = effect->nodes;
  int32_t i = nodes == NULL ? first : ct_lower_bound(nodes, effect->node_count, first), end = last;
  for (; i < effect->node_count && ct_effect_node(effect, i) < last; i = end) {
    // Nodes with consecutive numbers are processed together.
    for (end = i + 1; nodes != NULL && end < effect->node_count && nodes[end] < last &&
                      nodes[end] == nodes[end - 1] + 1;)
      end++;
    if (nodes == NULL) end = last;
    int64_t dof = 3 * (int64_t)ct_effect_node(effect, i);
    react(3 * (int64_t)(end - i), share, &problem->inverse_mass[dof], &total[dof],
          &impulse[3 * (int64_t)i]);
  }
}

void ct_ledger_reactions(const ct_problem *problem, ct_state *state, double share, int32_t first,
                         int32_t last)
{
  for (int32_t k = 1; k < problem->effect_count; k++)
    if (problem->effects[k]->phase == CT_PHASE_REACTION)
      count_reaction(problem, state->workspace->total, problem->effects[k], share, first, last,
                     state->impulse + ct_state_starts(problem, k).impulse);
}

/* Work and impulse of the effects other than the first and the reactions, for a stage whose kick is
 * `share` of the step. */
static void count_work(const ct_problem *problem, ct_state *state, double share)
{
  ct_workspace *w = state->workspace;
  for (int32_t k = 1; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    ct_starts start = ct_state_starts(problem, k);
    double *impulse = state->impulse + start.impulse, *work = state->work + start.work;
    for (int32_t i = 0, at = 0; effect->phase != CT_PHASE_REACTION && i < effect->node_count; i++) {
      int32_t node = ct_effect_node(effect, i);
      const double *after = &state->velocity[3 * (int64_t)node];
      // Both lists ascend, so one pass finds the velocity before the step.
      while (w->shared[at] < node) at++;
      const double *before = &w->shared_velocity[3 * (int64_t)at],
                   *force = &w->force[k][3 * (int64_t)i];
      // -- Work and impulse of one node
      for (int64_t c = 0; c < 3; c++) {
        double f = share * force[c];
        // f (v⁻ + v⁺) (eq:work-balance, eq:stage-work)
        work[3 * (int64_t)i + c] += f * (before[c] + after[c]);
        impulse[3 * (int64_t)i + c] += f; // (eq:impulse-balance)
      }
    }
  }
}

void ct_ledger_count(const ct_problem *problem, ct_state *state, double share)
{
  correct_shared(state, share);
  count_work(problem, state, share);
}

void ct_ledger_fold(ct_state *state)
{
  int64_t count = state->impulse_count / 2;
  for (int64_t i = 0; i < count; i++) {
    state->impulse[count + i] += state->impulse[i]; // (eq:impulse-parts)
    state->impulse[i] = 0.0;
  }
}
