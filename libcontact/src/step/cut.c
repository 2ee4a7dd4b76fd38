/* From a whole state to a piece of it, and back. */
#include "../base/error.h"
#include "constraints.h"
#include "effect_internal.h"
#include "piece.h"
#include "workspace.h"

#include <string.h>

/* Let all effects compute their piece only. */
static ct_status cut_effects(ct_state *state, ct_error *error)
{
  ct_workspace *w = state->workspace;
  const ct_problem *problem = state->problem;
  ct_status status = CT_OK;
  for (int32_t k = 0; status == CT_OK && k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    const ct_effect_pieces *calls = &effect->calls->pieces;
    if ((calls->cut == NULL && !calls->common) || (calls->keep == NULL && effect->memory_count > 0))
      status =
          ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                  "the effect %s can't be computed in pieces; step the whole state", effect->label);
    else if (calls->cut != NULL) status = calls->cut(effect, w->piece, w->scratch[k], error);
    if (status == CT_OK && effect->memory_count > 0)
      calls->keep(effect, w->piece, 1, state->memory + ct_state_starts(problem, k).memory);
  }
  w->sleep = NULL;
  if (w->constraints != NULL) w->constraints->solver->pieces = &w->piece->join;
  return status;
}

ct_status ct_state_cut(const ct_state *whole, const ct_piece_def *def, ct_state **piece,
                       ct_error *error)
{
  ct_piece *made = NULL;
  ct_state *state = NULL;
  int64_t none = 0;
  if (whole == NULL || piece == NULL) return CT_REFUSE_NULL(error);
  ct_status status = ct_piece_check(def, error);
  if (status != CT_OK) return status;
  // From here on an error of one piece ends all of them.
  status = ct_stage_check(whole, error);
  if (status == CT_OK) status = ct_piece_refuse(whole, error);
  if (status == CT_OK) status = ct_piece_create(whole->problem, def, &made, error);
  status = ct_pieces_agree(&def->join, status, &none, error);
  if (status == CT_OK) status = ct_piece_check_same(made, def, error);
  if (status != CT_OK) {
    ct_pool_free(made);
    return status;
  }
  status = ct_state_allocate(whole->problem, &state, error);
  if (status == CT_OK) status = ct_state_equip(state, error);
  if (status == CT_OK) status = ct_state_copy(whole->problem, whole, state, error);
  if (status == CT_OK) {
    state->workspace->piece = made;
    state->unconverged = whole->unconverged;
    status = cut_effects(state, error);
  }
  status = ct_piece_agree(made, status, error);
  if (status == CT_OK) {
    *piece = state;
    return CT_OK;
  }
  if (state == NULL || state->workspace == NULL || state->workspace->piece == NULL)
    ct_pool_free(made);
  ct_state_free(state);
  return status;
}

/* A state that is a piece. */
static ct_status check_piece(const ct_state *piece, ct_error *error)
{
  if (piece != NULL && piece->workspace != NULL && piece->workspace->piece != NULL) return CT_OK;
  return CT_REFUSE(error, "the state is no piece; ct_state_cut makes one");
}

ct_status ct_piece_counts_of(const ct_state *piece, ct_piece_counts *out, ct_error *error)
{
  if (out == NULL) return CT_REFUSE_NULL(error);
  ct_status status = check_piece(piece, error);
  if (status == CT_OK) *out = piece->workspace->piece->counts;
  return status;
}

/* Collect an array with three numbers at each node of an effect; null: of the problem. */
static ct_status collect_nodes(const ct_piece *piece, const ct_effect *effect, const double *from,
                               double *to, ct_error *error)
{
  const int32_t count = effect == NULL ? piece->problem->node_count : effect->node_count;
  for (int32_t i = 0; i < count; i++) {
    const int32_t node = effect == NULL ? i : ct_effect_node(effect, i);
    if (ct_piece_owns(piece, node))
      memcpy(&to[3 * (int64_t)i], &from[3 * (int64_t)i], 3 * sizeof *to);
    else memset(&to[3 * (int64_t)i], 0, 3 * sizeof *to);
  }
  return ct_piece_collect(piece, to, 3 * (int64_t)count, error);
}

/* Collect work, impulse and memory of an effect. */
static ct_status collect_effect(const ct_state *from, int32_t k, ct_state *to, ct_error *error)
{
  const ct_piece *piece = from->workspace->piece;
  const ct_effect *effect = from->problem->effects[k];
  const ct_starts at = ct_state_starts(from->problem, k);
  const int64_t half = from->impulse_count / 2;
  ct_status status = CT_OK;
  if (effect->phase != CT_PHASE_REACTION)
    status = collect_nodes(piece, effect, from->work + at.work, to->work + at.work, error);
  for (int i = 0; k > 0 && status == CT_OK && i < 2; i++)
    status = collect_nodes(piece, effect, from->impulse + i * half + at.impulse,
                           to->impulse + i * half + at.impulse, error);
  if (status != CT_OK || effect->memory_count == 0) return status;
  double *memory = to->memory + at.memory;
  memcpy(memory, from->memory + at.memory, (size_t)effect->memory_count * sizeof *memory);
  effect->calls->pieces.keep(effect, piece, piece->def.number == 0, memory);
  return ct_piece_collect(piece, memory, effect->memory_count, error);
}

ct_status ct_state_collect(const ct_state *from, ct_state *to, ct_error *error)
{
  ct_status status = check_piece(from, error);
  if (status != CT_OK) return status;
  if (to == NULL) return CT_REFUSE_NULL(error);
  status = ct_piece_refuse(to, error);
  if (status != CT_OK) return status;
  if (to->problem != from->problem) return CT_REFUSE(error, "the states are of two problems");
  const ct_problem *problem = from->problem;
  const ct_piece *piece = from->workspace->piece;
  const int64_t after = ct_state_starts(problem, problem->effect_count).memory;
  // All of it is overwritten, and `to` becomes a state whose forces are not known.
  status = ct_state_copy(problem, from, to, error);
  if (status == CT_OK)
    status = collect_nodes(piece, NULL, from->displacement, to->displacement, error);
  if (status == CT_OK) status = collect_nodes(piece, NULL, from->velocity, to->velocity, error);
  for (int32_t k = 0; status == CT_OK && k < problem->effect_count; k++)
    status = collect_effect(from, k, to, error);
  if (status == CT_OK && from->memory_count > after)
    status = collect_nodes(piece, NULL, from->memory + after, to->memory + after, error);
  to->unconverged = from->unconverged;
  to->constraint_rounds = from->constraint_rounds;
  memcpy(to->element_updates, from->element_updates, sizeof to->element_updates);
  memcpy(to->effect_seconds, from->effect_seconds,
         ((size_t)problem->effect_count + 1) * sizeof *to->effect_seconds);
  return status;
}
