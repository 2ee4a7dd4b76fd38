/* Work and impulses of the effects, summed up along with the motion. */
#include "ledger.h"

#include "../base/lanes.h"

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

/* After the step: the first effect's work at nodes with several effects is that of its own force
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

/* A number, or +0 where it is not wanted; by its bits, as compilers make a branch of a choice. */
CT_INLINE double only_where(int wanted, double x)
{
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  bits &= -(uint64_t)wanted;
  memcpy(&x, &bits, sizeof x);
  return x;
}

/* Take the forces on held degrees of freedom from an impulse. */
CT_CLONES
static void react(int64_t count, double share, const double *restrict inverse_mass,
                  const double *restrict force, double *restrict impulse)
{
#pragma omp simd
  for (int64_t d = 0; d < count; d++)
    impulse[d] -= only_where(inverse_mass[d] == 0.0, share * force[d]);
}

/* How many of the nodes i, i + 1, ... of an effect, of `left` that are asked for, have numbers that
 * follow each other. They ascend, so the last one tells. */
static int32_t run_of(const ct_effect *effect, int32_t i, int32_t left)
{
  int32_t count = 1;
  if (effect->nodes == NULL) return left;
  for (int32_t more = 1; more > 0;) {
    int32_t longer = count + more;
    int follows = longer <= left && effect->nodes[i + longer - 1] - effect->nodes[i] == longer - 1;
    count = follows ? longer : count;
    more = follows ? 2 * more : more / 2;
  }
  return count;
}

/* The first of an effect's nodes that is `node` or a later one; it has some. */
static int32_t entry_from(const ct_effect *effect, int32_t node)
{
  int32_t first = 0, last = effect->node_count, start = ct_effect_node(effect, 0);
  // Where the numbers follow each other there is nothing to look for.
  if (effect->nodes == NULL || effect->nodes[last - 1] - start == last - 1)
    return node <= start ? 0 : node - start < last ? node - start : last;
  while (first < last) {
    int32_t middle = first + (last - first) / 2;
    if (effect->nodes[middle] < node) first = middle + 1;
    else last = middle;
  }
  return first;
}

/* The impulse of one reaction: minus all other forces on the degrees of freedom that it holds. */
static void count_reaction(const ct_problem *problem, const double *total, const ct_effect *effect,
                           double share, int32_t first, int32_t last, double *impulse)
{
  int32_t stop = entry_from(effect, last);
  for (int32_t i = entry_from(effect, first), run; i < stop; i += run) {
    int64_t dof = 3 * (int64_t)ct_effect_node(effect, i);
    run = run_of(effect, i, stop - i);
    react(3 * (int64_t)run, share, &problem->inverse_mass[dof], &total[dof],
          &impulse[3 * (int64_t)i]);
  }
}

void ct_ledger_reactions(const ct_problem *problem, ct_state *state, double share, int32_t first,
                         int32_t last)
{
  for (int32_t k = 1; k < problem->effect_count; k++)
    if (problem->effects[k]->phase == CT_PHASE_REACTION && problem->effects[k]->node_count > 0)
      count_reaction(problem, state->workspace->total, problem->effects[k], share, first, last,
                     state->impulse + ct_state_impulse_start(problem, k));
}

/* Work and impulse of the effects beside the first and the reactions (eq:work-balance,
 * eq:impulse-balance), of a stage whose kick is `share` of the step (eq:stage-work). */
static void count_work(const ct_problem *problem, ct_state *state, double share)
{
  ct_workspace *w = state->workspace;
  for (int32_t k = 1; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    double *impulse = state->impulse + ct_state_impulse_start(problem, k),
           *work = state->work + ct_state_work_start(problem, k);
    for (int32_t i = 0, at = 0; effect->phase != CT_PHASE_REACTION && i < effect->node_count; i++) {
      int32_t node = ct_effect_node(effect, i);
      const double *after = &state->velocity[3 * (int64_t)node];
      // Both lists ascend, so a walk finds the velocity before the step.
      while (w->shared[at] < node) at++;
      const double *before = &w->shared_velocity[3 * (int64_t)at],
                   *force = &w->force[k][3 * (int64_t)i];
      for (int64_t c = 0; c < 3; c++) {
        double f = share * force[c];
        work[3 * (int64_t)i + c] += f * (before[c] + after[c]);
        impulse[3 * (int64_t)i + c] += f;
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
    state->impulse[count + i] += state->impulse[i];
    state->impulse[i] = 0.0;
  }
}
