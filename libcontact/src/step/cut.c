/* From a whole state to a piece of it, and back. */
#include "../base/bits.h"
#include "../base/error.h"
#include "constraints.h"
#include "effect_internal.h"
#include "layers.h"
#include "piece.h"
#include "workspace.h"

#include <math.h>
#include <string.h>

/* The numbers of a state go from the whole one of piece 0 to all pieces, or from these to whole
 * ones; null: this process has none, or gets none. */
typedef struct passage {
  const ct_piece *piece;
  const ct_state *from;
  ct_state *to;
  int spread;
} passage;

/* The place in the whole problem of the i-th node of an effect, or of the problem. */
static int32_t place_of(const ct_piece_numbers *numbers, int32_t i)
{
  return numbers->at == NULL ? i : numbers->at[i];
}

/* Pass an array with three numbers at each node of an effect; null: of the problem. Each is known
 * to the owner of its node, or to piece 0. */
static ct_status pass_nodes(const passage *p, const ct_effect *effect,
                            const ct_piece_numbers *numbers, const double *from, double *to,
                            ct_error *error)
{
  const ct_piece *piece = p->piece;
  double *part = piece->passed;
  ct_status status = CT_OK;
  int32_t next = 0;
  for (int32_t first = 0, end; status == CT_OK && first < numbers->whole; first = end) {
    const int32_t begin = next;
    end = numbers->whole - first < CT_COLLECTED / 3 ? numbers->whole : first + CT_COLLECTED / 3;
    memset(part, 0, 3 * (size_t)(end - first) * sizeof *part);
    for (; next < numbers->count && place_of(numbers, next) < end; next++) {
      const int32_t node = effect == NULL ? next : ct_effect_node(effect, next);
      const int known = p->spread ? piece->def.number == 0 : ct_piece_owns(piece, node);
      double *x = &part[3 * (int64_t)(place_of(numbers, next) - first)];
      if (known) memcpy(x, &from[3 * (int64_t)next], 3 * sizeof *x);
    }
    status = ct_piece_collect(piece, part, 3 * (int64_t)(end - first), error);
    for (int32_t i = begin; status == CT_OK && to != NULL && i < next; i++) {
      const int32_t node = effect == NULL ? i : ct_effect_node(effect, i);
      if (!p->spread || ct_bits_get(piece->held, node))
        memcpy(&to[3 * (int64_t)i], &part[3 * (int64_t)(place_of(numbers, i) - first)],
               3 * sizeof *to);
    }
  }
  return status;
}

/* Pass the memory of an effect, which is not in the order of its nodes. */
static ct_status pass_memory(const passage *p, const ct_effect *effect, const double *from,
                             double *to, ct_error *error)
{
  const ct_piece *piece = p->piece;
  const int64_t count = effect->memory_count;
  const int known = !p->spread || piece->def.number == 0;
  double *all = ct_allocate((size_t)count, sizeof *all);
  ct_status status = all == NULL ? CT_NO_MEMORY(error, "a state") : CT_OK;
  status = ct_piece_agree(piece, status, error);
  if (status == CT_OK && known) memcpy(all, from, (size_t)count * sizeof *all);
  if (status == CT_OK && !p->spread)
    effect->calls->pieces.keep(effect, piece, piece->def.number == 0, all);
  if (status == CT_OK) status = ct_piece_collect(piece, all, count, error);
  if (status == CT_OK && p->spread) effect->calls->pieces.keep(effect, piece, 1, all);
  // What a piece does not keep is 0 already.
  for (int64_t i = 0; status == CT_OK && to != NULL && i < count; i++)
    if (!p->spread || all[i] != 0.0 || signbit(all[i])) to[i] = all[i];
  ct_release(all);
  return status;
}

/* The part of an array from a number on; null if there is no array. */
static double *part_of(double *array, int64_t first)
{
  return array == NULL ? NULL : array + first;
}

/* Pass work, impulse and memory of an effect. */
static ct_status pass_effect(const passage *p, const ct_state *from, const ct_state *to, int32_t k,
                             ct_error *error)
{
  const ct_effect *effect = p->piece->problem->effects[k];
  const ct_piece_numbers *numbers = &p->piece->effects[k];
  const ct_starts at = ct_state_starts(p->piece->problem, k),
                  end = ct_state_starts(p->piece->problem, p->piece->problem->effect_count);
  ct_status status = CT_OK;
  if (effect->phase != CT_PHASE_REACTION)
    status = pass_nodes(p, effect, numbers, part_of(from->work, at.work),
                        part_of(to->work, at.work), error);
  for (int64_t i = 0; k > 0 && status == CT_OK && i < 2; i++)
    status = pass_nodes(p, effect, numbers, part_of(from->impulse, i * end.impulse + at.impulse),
                        part_of(to->impulse, i * end.impulse + at.impulse), error);
  if (status != CT_OK || effect->memory_count == 0) return status;
  return pass_memory(p, effect, part_of(from->memory, at.memory), part_of(to->memory, at.memory),
                     error);
}

static ct_status pass_state(const passage *p, ct_error *error)
{
  static const ct_state none = {.step = 0};
  const ct_problem *problem = p->piece->problem;
  const ct_state *from = p->from != NULL ? p->from : &none, *to = p->to != NULL ? p->to : &none;
  const ct_piece_numbers *nodes = &p->piece->nodes;
  const int64_t after = ct_state_starts(problem, problem->effect_count).memory;
  ct_status status = pass_nodes(p, NULL, nodes, from->displacement, to->displacement, error);
  if (status == CT_OK) status = pass_nodes(p, NULL, nodes, from->velocity, to->velocity, error);
  for (int32_t k = 0; status == CT_OK && k < problem->effect_count; k++)
    status = pass_effect(p, from, to, k, error);
  if (status == CT_OK && ct_scheme_of(problem)->stores)
    status =
        pass_nodes(p, NULL, nodes, part_of(from->memory, after), part_of(to->memory, after), error);
  return status;
}

/* Give the state of piece 0 to all pieces. */
static ct_status spread(const ct_piece *piece, const ct_state *whole, ct_state *state,
                        ct_error *error)
{
  double numbers[5] = {0.0};
  if (piece->def.number == 0)
    numbers[0] = (double)whole->step, numbers[1] = whole->time, numbers[2] = whole->kinetic_start,
    numbers[3] = (double)whole->unconverged, numbers[4] = (double)whole->constraint_rounds;
  ct_status status = ct_piece_collect(piece, numbers, 5, error);
  state->step = (int64_t)numbers[0], state->time = numbers[1], state->kinetic_start = numbers[2];
  state->unconverged = (int64_t)numbers[3], state->constraint_rounds = (int64_t)numbers[4];
  return status == CT_OK ? pass_state(&(passage){piece, whole, state, 1}, error) : status;
}

/* Number the nodes of an effect as in the whole problem, whose piece 0 tells them to the others. */
static ct_status number_effect(const ct_piece *piece, int32_t k, ct_error *error)
{
  const ct_effect *effect = piece->problem->effects[k];
  ct_piece_numbers *numbers = &piece->effects[k];
  const int first = piece->def.number == 0, listed = effect->nodes != NULL;
  double told[3] = {first ? numbers->whole : 0.0, first ? (double)effect->memory_count : 0.0,
                    first && listed};
  int32_t next = 0;
  ct_status status = ct_piece_collect(piece, told, 3, error);
  if (status == CT_OK && (told[1] != (double)effect->memory_count || told[2] != listed))
    status = ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                     "the effect %s can't be computed in parts of the problem; give all processes "
                     "the whole one",
                     effect->label);
  status = ct_piece_agree(piece, status, error);
  if (!listed) return status;
  numbers->whole = (int32_t)told[0];
  for (int32_t i = 0, some; status == CT_OK && i < numbers->whole; i += some) {
    some = numbers->whole - i < CT_COLLECTED ? numbers->whole - i : CT_COLLECTED;
    for (int32_t j = 0; j < some; j++)
      piece->passed[j] = first ? ct_effect_node(effect, i + j) : 0.0;
    status = ct_piece_collect(piece, piece->passed, some, error);
    for (int32_t j = 0; status == CT_OK && numbers->at != NULL && j < some; j++)
      if (next < numbers->count &&
          place_of(&piece->nodes, ct_effect_node(effect, next)) == (int32_t)piece->passed[j])
        numbers->at[next++] = i + j;
  }
  if (status == CT_OK && numbers->at != NULL && next < numbers->count)
    status = CT_REFUSE(error, "the effect %s has a node that it has not in the whole problem",
                       effect->label);
  return ct_piece_agree(piece, status, error);
}

/* Refuse definitions that are not the same in all pieces; or number the parts of the problem. */
static ct_status compare(const ct_piece *piece, const ct_piece_def *def, ct_error *error)
{
  double parts = def->part != NULL;
  ct_pieces_largest(&piece->join, &parts, 1);
  if (parts == 0.0) return ct_piece_check_same(piece, def, error);
  ct_status status = CT_OK;
  for (int32_t k = 0; status == CT_OK && k < piece->problem->effect_count; k++)
    status = number_effect(piece, k, error);
  return status;
}

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
  }
  w->sleep = NULL;
  if (w->constraints != NULL) w->constraints->solver->pieces = &w->piece->join;
  return status;
}

/* Cut the whole state of piece 0; on other pieces it may be null. */
static ct_status cut(const ct_problem *problem, const ct_state *whole, const ct_piece_def *def,
                     ct_state **piece, ct_error *error)
{
  ct_piece *made = NULL;
  ct_state *state = NULL;
  int64_t none = 0;
  ct_status status = ct_piece_check(def, error);
  if (status != CT_OK) return status;
  // From here on an error of one piece ends all of them.
  if (whole == NULL && def->number == 0)
    status = CT_REFUSE(error, "piece: the first piece needs a whole state; call ct_state_cut");
  if (status == CT_OK && whole != NULL) status = ct_stage_check(whole, error);
  if (status == CT_OK && whole != NULL) status = ct_piece_refuse(whole, error);
  if (status == CT_OK) status = ct_piece_create(problem, def, &made, error);
  status = ct_pieces_agree(&def->join, status, &none, error);
  if (status == CT_OK) status = compare(made, def, error);
  if (status != CT_OK) {
    ct_pool_free(made);
    return status;
  }
  status = ct_state_allocate(problem, &state, error);
  if (status == CT_OK) status = ct_state_equip(state, error);
  if (status == CT_OK) {
    state->workspace->piece = made;
    status = cut_effects(state, error);
  }
  status = ct_piece_agree(made, status, error);
  if (status == CT_OK && state->workspace->constraints != NULL)
    status = ct_layers_spread(made, state->workspace->constraints->solver, error);
  if (status == CT_OK) status = spread(made, whole, state, error);
  if (status == CT_OK) {
    *piece = state;
    return CT_OK;
  }
  if (state == NULL || state->workspace == NULL || state->workspace->piece == NULL)
    ct_pool_free(made);
  ct_state_free(state);
  return status;
}

ct_status ct_state_cut(const ct_state *whole, const ct_piece_def *def, ct_state **piece,
                       ct_error *error)
{
  if (whole == NULL || piece == NULL) return CT_REFUSE_NULL(error);
  return cut(whole->problem, whole, def, piece, error);
}

ct_status ct_state_receive(const ct_problem *problem, const ct_piece_def *def, ct_state **piece,
                           ct_error *error)
{
  if (problem == NULL || piece == NULL) return CT_REFUSE_NULL(error);
  return cut(problem, NULL, def, piece, error);
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

ct_status ct_state_collect(const ct_state *from, ct_state *to, ct_error *error)
{
  ct_status status = check_piece(from, error);
  if (status != CT_OK) return status;
  status = ct_stage_check(from, error);
  if (status != CT_OK) return status;
  const ct_piece *piece = from->workspace->piece;
  if (to == NULL) return pass_state(&(passage){piece, from, NULL, 0}, error);
  status = ct_piece_refuse(to, error);
  if (status != CT_OK) return status;
  const ct_problem *problem = from->problem;
  if (to->problem != problem) return CT_REFUSE(error, "the states are of two problems");
  // All of it is overwritten, and `to` becomes a state whose forces are not known.
  status = ct_state_copy(problem, from, to, error);
  if (status == CT_OK) status = pass_state(&(passage){piece, from, to, 0}, error);
  to->unconverged = from->unconverged;
  to->constraint_rounds = from->constraint_rounds;
  memcpy(to->element_updates, from->element_updates, sizeof to->element_updates);
  memcpy(to->effect_seconds, from->effect_seconds,
         ((size_t)problem->effect_count + 1) * sizeof *to->effect_seconds);
  return status;
}
