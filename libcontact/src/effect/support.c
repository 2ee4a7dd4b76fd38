#include <libcontact/effect.h>

#include "../step/effect_internal.h"
#include "../step/piece.h"
#include "held.h"

#include <string.h>

ct_support_def ct_support_def_default(void) { return (ct_support_def){.cookie = CT_DEF_COOKIE}; }

static const ct_effect_calls CALLS = {.free_data = ct_pool_free, .pieces = {.cut = ct_piece_local}};

/* A support as a motion: its velocity in place of the displacement. */
static ct_status fill(ct_held *held, const ct_support_def *def, const ct_problem *problem,
                      ct_error *error)
{
  int32_t count = def->supports == NULL ? 0 : def->support_count;
  ct_motion *motions = ct_allocate(count < 1 ? 1 : (size_t)count, sizeof *motions);
  held->pool.failed = motions == NULL;
  for (int32_t i = 0; motions != NULL && i < count; i++) {
    motions[i] =
        (ct_motion){.nodes = def->supports[i].nodes, .node_count = def->supports[i].node_count};
    memcpy(motions[i].fixed, def->supports[i].fixed, sizeof motions[i].fixed);
    memcpy(motions[i].displacement, def->supports[i].velocity, sizeof motions[i].displacement);
  }
  ct_status status = ct_held_fill(held, CT_PART_SUPPORT, problem, motions, count, error);
  ct_release(motions);
  return status;
}

ct_status ct_support_create_effect(const ct_support_def *def, const ct_problem *problem,
                                   ct_effect **effect, ct_error *error)
{
  ct_status status;
  ct_held *held = ct_effect_begin(def, problem, effect, "support", sizeof *held, &status, error);
  if (held == NULL) return status;
  status = fill(held, def, problem, error);
  ct_effect filled = {.kind = CT_EFFECT_SUPPORT,
                      .label = "support",
                      .phase = CT_PHASE_REACTION,
                      .calls = &CALLS,
                      .data = held,
                      .nodes = held->nodes,
                      .node_count = held->node_count};
  return ct_effect_finish(status, &filled, effect, error);
}

ct_status ct_support_apply(const ct_effect *effect, double *inverse_mass, double *velocity,
                           ct_error *error)
{
  if (effect == NULL || inverse_mass == NULL || velocity == NULL) return CT_REFUSE_NULL(error);
  if (effect->kind != CT_EFFECT_SUPPORT)
    return CT_REFUSE(error, "support: the effect is %s, not a support", effect->label);
  const ct_held *held = effect->data;
  for (int32_t i = 0; i < effect->node_count; i++)
    for (int c = 0; c < 3; c++) {
      int32_t holder = held->holder[3 * (int64_t)i + c];
      if (holder == 0) continue;
      int64_t dof = 3 * (int64_t)ct_effect_node(effect, i) + c;
      // -- No force moves the component, and it starts with the velocity of its support
      // (eq:support-mass)
      inverse_mass[dof] = 0.0;
      velocity[dof] = held->motions[holder - 1].displacement[c];
    }
  return CT_OK;
}
