/* The forces of a state: all effects in the order of their phases. */
#include "../base/bits.h"
#include "../base/lanes.h"
#include "../base/stream.h"
#include "../solid/sleep.h"
#include "constraints.h"
#include "piece.h"
#include "workspace.h"

#include <string.h>

enum { NODES_COPIED = 128 };

/* Count the elements whose forces the solid effect has computed and skipped. */
static void count_updates(const ct_problem *problem, ct_state *state)
{
  if (state->workspace->sleep != NULL)
    ct_sleep_count(state->workspace->sleep, state->element_updates);
  else if (problem->effects[0]->kind == CT_EFFECT_SOLID)
    for (int32_t i = 0; i < problem->body_count; i++)
      state->element_updates[ct_problem_is_rigid(problem, i)] +=
          problem->bodies[i].mesh->element_count;
}

/* Copy forces; small pieces are copied by vectors. */
static void copy_row(int64_t count, const double *restrict from, double *restrict to)
{
  for (int64_t d = 0; d < count; d++) to[d] = from[d];
}

/* Save the forces of the first effect at the nodes on which others act. */
static void save_first(const ct_workspace *w)
{
  const int32_t *nodes = w->shared;
  // Nodes with consecutive numbers are copied together.
  for (int32_t i = 0, end; i < w->shared_count; i = end) {
    end = w->shared_count - i < NODES_COPIED ? w->shared_count : i + NODES_COPIED;
    if (nodes[end - 1] - nodes[i] == end - 1 - i)
      copy_row(3 * (int64_t)(end - i), &w->total[3 * (int64_t)nodes[i]],
               &w->shared_first[3 * (int64_t)i]);
    else
      for (int32_t n = i; n < end; n++)
        memcpy(&w->shared_first[3 * (int64_t)n], &w->total[3 * (int64_t)nodes[n]],
               3 * sizeof(double));
  }
}

CT_CLONES
static void add_row(int64_t count, const double *restrict force, double *restrict total)
{
#pragma omp simd
  for (int64_t d = 0; d < count; d++) total[d] += force[d];
}

/* Add the force of an effect to the total. */
static void add_force(const ct_effect *effect, const double *force, double *total)
{
  // Nodes with consecutive numbers are processed together.
  for (int32_t i = 0, end; i < effect->node_count; i = end) {
    end = ct_piece_end(i, effect->node_count);
    if (ct_effect_is_row(effect, i, end))
      add_row(3 * (int64_t)(end - i), &force[3 * (int64_t)i],
              &total[3 * (int64_t)ct_effect_node(effect, i)]);
    else
      for (int32_t n = i; n < end; n++)
        for (int c = 0; c < 3; c++)
          total[3 * (int64_t)ct_effect_node(effect, n) + c] += force[3 * (int64_t)n + c];
  }
}

/* Force of one effect, added to the total. */
static ct_status add_effect(const ct_problem *problem, ct_state *state, int32_t k, ct_error *error)
{
  ct_workspace *w = state->workspace;
  const ct_effect *effect = problem->effects[k];
  ct_view view = ct_workspace_view(problem, state, k);
  double *force = k == 0 ? w->total : w->force[k], begin = ct_run_seconds(problem);
  ct_status status = effect->calls->force(effect, &view, force, error);
  if (status != CT_OK) return status;
  state->effect_seconds[k] += ct_run_seconds(problem) - begin;
  if (k == 0) {
    count_updates(problem, state);
    save_first(w);
  } else add_force(effect, force, w->total);
  return CT_OK;
}

/* Set the force of the last step to zero at the shared nodes, in rows at those at which no element
 * is summed. */
static void clear_shared(const ct_workspace *w, const uint64_t *summed)
{
  const int32_t *nodes = w->shared;
  for (int32_t i = 0, end; i < w->shared_count; i = end) {
    end = ct_piece_end(i, w->shared_count);
    int is_row = nodes[end - 1] - nodes[i] == end - 1 - i;
    if (is_row && ct_bits_next(summed, nodes[i], nodes[end - 1] + 1, 0) > nodes[end - 1]) continue;
    if (is_row) ct_clear(&w->total[3 * (int64_t)nodes[i]], 3 * (size_t)(end - i));
    for (int32_t n = i; !is_row && n < end; n++)
      memset(&w->total[3 * (int64_t)nodes[n]], 0, 3 * sizeof(double));
  }
}

/* Find the sleeping elements. The force is zero at nodes without active elements (eq:sleep). */
static void find_sleep(const ct_problem *problem, ct_state *state)
{
  ct_workspace *w = state->workspace;
  if (w->piece != NULL) clear_shared(w, w->piece->held);
  if (w->sleep == NULL) return;
  if (w->followed) {
    ct_sleep_wake(w->sleep, state->displacement);
    clear_shared(w, ct_sleep_summed(w->sleep));
  } else {
    ct_sleep_examine(w->sleep, state->displacement, state->velocity,
                     ct_stage_last_acceleration(problem, state));
    ct_clear(w->total, 3 * (size_t)problem->node_count);
  }
  if (w->seen) ct_sleep_settle(w->sleep, state->displacement);
}

/* In pieces, get the forces so far on nodes of other pieces, if these have them. */
static ct_status share_total(const ct_workspace *w, ct_status own, ct_error *error)
{
  ct_status status = ct_piece_agree(w->piece, own, error);
  // -- f of a node from its owner (eq:piece-total)
  return status == CT_OK ? ct_piece_share(w->piece, w->total, error) : status;
}

ct_status ct_workspace_forces(const ct_problem *problem, ct_state *state, ct_error *error)
{
  ct_workspace *w = state->workspace;
  if (w->forces_at == state->step) return CT_OK;
  w->forces_at = -1;
  w->known = 0;
  find_sleep(problem, state);
  for (int phase = CT_PHASE_STATE; phase < CT_PHASE_REACTION; phase++) {
    ct_status status = phase == CT_PHASE_CONSTRAINT && w->constraints != NULL
                           ? ct_constraints_solve(problem, state, error)
                           : CT_OK;
    for (int32_t k = 0; status == CT_OK && k < problem->effect_count; k++)
      if ((int)problem->effects[k]->phase == phase) status = add_effect(problem, state, k, error);
    if (w->piece != NULL && phase == CT_PHASE_STATE) status = share_total(w, status, error);
    if (status != CT_OK) return status;
  }
  w->forces_at = state->step;
  w->known = 1;
  w->continued = 0;
  return CT_OK;
}
