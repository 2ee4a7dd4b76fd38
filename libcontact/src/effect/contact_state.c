/* Contacts, obstacles and friction of a state: what they tell about its time. */
#include "contact.h"

#include "../base/error.h"
#include "../base/vector.h"
#include "../step/workspace.h"

#include <math.h>
#include <string.h>

/* The interaction of an effect in a state, with the forces of its time; null, with `status` and
 * `error` filled, for an effect of another kind. */
static void *state_of(const ct_problem *problem, ct_state *state, int32_t effect,
                      ct_effect_kind kind, const char *what, ct_status *status, ct_error *error)
{
  int is = problem != NULL && state != NULL && effect >= 0 && effect < problem->effect_count &&
           problem->effects[effect]->kind == kind;
  *status = is ? ct_workspace_forces(problem, state, error)
               : CT_REFUSE(error, "effect %d of the problem is not %s", (int)effect, what);
  return *status == CT_OK ? ct_touch_state(state->workspace->scratch[effect]) : NULL;
}

const ct_contact *ct_state_contact(const ct_problem *problem, ct_state *state, int32_t effect,
                                   ct_error *error)
{
  ct_status status;
  ct_contact *contact =
      state_of(problem, state, effect, CT_EFFECT_CONTACT, "a contact", &status, error);
  if (contact != NULL) ct_contact_complete(contact);
  return contact;
}

static const ct_contact *obstacle_of(const ct_problem *problem, ct_state *state, int32_t effect,
                                     ct_status *status, ct_error *error)
{
  ct_contact *contact =
      state_of(problem, state, effect, CT_EFFECT_OBSTACLE, "an obstacle", status, error);
  if (contact != NULL) ct_contact_complete(contact);
  return contact;
}

ct_status ct_obstacle_reaction(const ct_problem *problem, ct_state *state, int32_t effect,
                               double force[3], double *work, ct_error *error)
{
  if (force == NULL || work == NULL) return CT_REFUSE_NULL(error);
  ct_status status = CT_OK;
  const ct_contact *s = obstacle_of(problem, state, effect, &status, error);
  if (s == NULL) return status;
  memcpy(force, s->reaction, sizeof s->reaction);
  *work = s->record.motion;
  return CT_OK;
}

ct_status ct_obstacle_traction(const ct_problem *problem, ct_state *state, int32_t effect,
                               double *traction, double *area, ct_error *error)
{
  if (traction == NULL || area == NULL) return CT_REFUSE_NULL(error);
  ct_status status = CT_OK;
  const ct_contact *s = obstacle_of(problem, state, effect, &status, error);
  return s == NULL ? status
                   : ct_side_traction(s->gaps.side, ct_contact_acting(s, 0), traction, area, error);
}

ct_status ct_obstacle_friction(const ct_problem *problem, ct_state *state, int32_t effect,
                               double *traction, int32_t *slip, ct_error *error)
{
  if (traction == NULL || slip == NULL) return CT_REFUSE_NULL(error);
  ct_status status = CT_OK;
  const ct_contact *s = obstacle_of(problem, state, effect, &status, error);
  return s == NULL ? status
                   : ct_side_friction(s->gaps.side, ct_contact_acting(s, 0), traction, slip, error);
}

ct_status ct_obstacle_penetration(const ct_problem *problem, ct_state *state, int32_t effect,
                                  ct_penetration_at at, ct_penetration *out, ct_error *error)
{
  ct_status status = CT_OK;
  const ct_contact *s = obstacle_of(problem, state, effect, &status, error);
  return s == NULL ? status : ct_contact_penetration(s, at, out, error);
}

ct_status ct_friction_energy(const ct_problem *problem, ct_state *state, int32_t effect,
                             double *stored, double *dissipated, ct_error *error)
{
  if (stored == NULL || dissipated == NULL) return CT_REFUSE_NULL(error);
  ct_status status = CT_OK;
  ct_interaction_energy energy;
  void *s = state_of(problem, state, effect, CT_EFFECT_FRICTION, "friction", &status, error);
  if (s == NULL) return status;
  ((const ct_touch *)problem->effects[effect]->data)->is->calls->find_energy(s, &energy);
  *stored = energy.stored;
  *dissipated = energy.dissipated;
  return CT_OK;
}

/* Add the pressures of one surface at its nodes; `buffer` is memory for the tractions and areas of
 * all nodes of the problem. */
static ct_status add_pressure(const ct_side *side, const ct_side *other, int32_t count,
                              double *buffer, double *pressure, ct_error *error)
{
  ct_status status = ct_side_traction(side, other, buffer, &buffer[3 * (int64_t)count], error);
  for (int32_t n = 0; status == CT_OK && n < side->search->node_count; n++) {
    const int64_t node = side->search->nodes[n];
    pressure[node] += sqrt(ct_vector_dot(&buffer[3 * node], &buffer[3 * node]));
  }
  return status;
}

ct_status ct_state_pressure(const ct_problem *problem, ct_state *state, double *pressure,
                            ct_error *error)
{
  if (problem == NULL || state == NULL || pressure == NULL) return CT_REFUSE_NULL(error);
  ct_status status = ct_workspace_forces(problem, state, error);
  if (status != CT_OK) return status;
  const int32_t nodes = problem->node_count;
  double *buffer = ct_allocate(4 * (size_t)nodes, sizeof *buffer);
  if (buffer == NULL) return CT_NO_MEMORY(error, "tractions");
  memset(pressure, 0, (size_t)nodes * sizeof *pressure);
  for (int32_t k = 0; status == CT_OK && k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    if (effect->kind != CT_EFFECT_CONTACT && effect->kind != CT_EFFECT_OBSTACLE) continue;
    ct_contact *contact = ct_touch_state(state->workspace->scratch[k]);
    ct_contact_complete(contact);
    for (int s = 0; status == CT_OK && s < ct_gaps_surfaces(contact->gaps.fixed); s++)
      status = add_pressure(&contact->gaps.side[s], ct_contact_acting(contact, s), nodes, buffer,
                            pressure, error);
  }
  ct_release(buffer);
  return status;
}
