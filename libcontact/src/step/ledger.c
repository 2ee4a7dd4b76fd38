/* Work and impulses of the effects, summed during the motion. */
#include "ledger.h"

#include "../base/lanes.h"
#include "../base/list.h"

#include <string.h>

/* Length of the row of consecutive nodes with which the shared nodes of a piece from the i-th on
 * begin. */
static int32_t row_of(const ct_workspace *w, ct_moved piece, int32_t i)
{
  return ct_row_length(&w->shared[i], piece.shared_last - i);
}

CT_CLONES_NODES
void ct_ledger_keep(const ct_state *state, ct_moved piece, double *sum, double *work)
{
  const int32_t *nodes = state->workspace->shared;
  for (int32_t i = piece.shared_first, row; i < piece.shared_last; i += row) {
    const int64_t count = 3 * (int64_t)(row = row_of(state->workspace, piece, i));
    const double *v = &state->velocity[3 * (int64_t)nodes[i]],
                 *from = &state->work[3 * (int64_t)nodes[i]];
    double *restrict before = &sum[3 * (nodes[i] - piece.first)], *restrict kept = work;
#pragma omp simd
    for (int64_t d = 0; d < count; d++) before[d] = v[d], kept[d] = from[d];
    work += count;
  }
}

CT_CLONES_NODES
void ct_ledger_correct(ct_state *state, double share, ct_moved piece, const double *work,
                       double *sum)
{
  const ct_workspace *w = state->workspace;
  for (int32_t i = piece.shared_first, row; i < piece.shared_last; i += row) {
    const int64_t dof = 3 * (int64_t)w->shared[i], count = 3 * (int64_t)(row = row_of(w, piece, i));
    const double *v = &state->velocity[dof], *force = &w->shared_first[3 * (int64_t)i];
    double *restrict both = &sum[dof - 3 * (int64_t)piece.first], *restrict to = &state->work[dof];
#pragma omp simd
    for (int64_t d = 0; d < count; d++) {
      both[d] += v[d];
      // (eq:work-balance, eq:stage-work)
      to[d] = work[d] + share * force[d] * both[d];
    }
    work += count;
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
  int32_t i = ct_effect_below(effect, first), stop = ct_effect_below(effect, last);
  // Nodes with consecutive numbers are processed together.
  for (int32_t end; i < stop; i = end) {
    end = effect->nodes == NULL ? stop : i + ct_row_length(&effect->nodes[i], stop - i);
    int64_t dof = 3 * (int64_t)ct_effect_node(effect, i);
    react(3 * (int64_t)(end - i), share, &problem->inverse_mass[dof], &total[dof],
          &impulse[3 * (int64_t)i]);
  }
}

/* Work and impulse of consecutive degrees of freedom, from v⁻ + v⁺. */
CT_INLINE void count_dofs(int64_t count, double share, const double *restrict force,
                          const double *restrict sum, double *restrict work,
                          double *restrict impulse)
{
#pragma omp simd
  for (int64_t d = 0; d < count; d++) {
    double f = share * force[d];
    work[d] += f * sum[d]; // f (v⁻ + v⁺) (eq:work-balance, eq:stage-work)
    impulse[d] += f;       // (eq:impulse-balance)
  }
}

CT_CLONES
static void count_row(int64_t count, double share, const double *force, const double *sum,
                      double *work, double *impulse)
{
  int64_t d = 0;
  for (; d + CT_BATCH <= count; d += CT_BATCH)
    count_dofs(CT_BATCH, share, &force[d], &sum[d], &work[d], &impulse[d]);
  count_dofs(count - d, share, &force[d], &sum[d], &work[d], &impulse[d]);
}

void ct_ledger_count(const ct_problem *problem, ct_state *state, double share, int32_t p,
                     const double *sum)
{
  const ct_workspace *w = state->workspace;
  const int32_t first = CT_MOVED * p;
  double *work = state->work + 3 * (int64_t)problem->node_count, *impulse = state->impulse;
  for (int32_t k = 1; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    int64_t dofs = 3 * (int64_t)effect->node_count;
    if (effect->phase != CT_PHASE_REACTION) {
      // Nodes with consecutive numbers are processed together.
      int32_t i = w->places[k][p], stop = w->places[k][p + 1];
      for (int32_t end; i < stop; i = end) {
        int is_row = stop - i >= CT_BATCH && ct_effect_is_row(effect, i, stop);
        end = is_row ? stop : i + 1;
        int64_t d = 3 * (int64_t)i, at = 3 * (int64_t)(ct_effect_node(effect, i) - first);
        if (is_row)
          count_row(3 * (int64_t)(stop - i), share, &w->force[k][d], &sum[at], &work[d],
                    &impulse[d]);
        else count_dofs(3, share, &w->force[k][d], &sum[at], &work[d], &impulse[d]);
      }
      work += dofs;
    }
    impulse += dofs;
  }
}

void ct_ledger_reactions(const ct_problem *problem, ct_state *state, double share, int32_t first,
                         int32_t last)
{
  double *impulse = state->impulse;
  for (int32_t k = 1; k < problem->effect_count; k++) {
    if (problem->effects[k]->phase == CT_PHASE_REACTION)
      count_reaction(problem, state->workspace->total, problem->effects[k], share, first, last,
                     impulse);
    impulse += 3 * (int64_t)problem->effects[k]->node_count;
  }
}

void ct_ledger_fold(ct_state *state)
{
  int64_t count = state->impulse_count / 2;
  for (int64_t i = 0; i < count; i++) {
    state->impulse[count + i] += state->impulse[i]; // (eq:impulse-parts)
    state->impulse[i] = 0.0;
  }
}
