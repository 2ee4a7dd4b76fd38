#include <libcontact/step.h>

#include "effect_internal.h"
#include "../base/error.h"
#include "../base/memory.h"

ct_status ct_effect_copy(const ct_effect *filled, ct_effect **effect, ct_error *error)
{
  if (filled == NULL || effect == NULL || filled->name == NULL || filled->node_count < 0 ||
      filled->memory_count < 0)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "effect: null argument, no name or negative counts");
  if ((filled->force == NULL) != (filled->reaction != 0))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "effect %s: needs a force, or to be a reaction without one", filled->name);
  if ((filled->create_scratch == NULL) != (filled->free_scratch == NULL))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "effect %s: scratch space needs both a maker and a way back", filled->name);
  for (int32_t i = 0; filled->nodes != NULL && i < filled->node_count; i++)
    if (filled->nodes[i] < 0 || (i > 0 && filled->nodes[i] <= filled->nodes[i - 1]))
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, filled->nodes[i]},
                     "effect %s: node %d at place %d is not in ascending order", filled->name,
                     (int)filled->nodes[i], (int)i);
  *effect = ct_allocate(1, sizeof **effect);
  if (*effect == NULL)
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for effect %s", filled->name);
  **effect = *filled;
  return CT_OK;
}

ct_status ct_effect_create(const ct_effect *filled, ct_effect **effect, ct_error *error)
{
  if (filled != NULL && filled->kind != CT_EFFECT_USER)
    return ct_fail(
        error, CT_ERROR_ARGUMENT, CT_NOWHERE,
        "effect: its kind is %d, one of the library's own, which only the library can make",
        (int)filled->kind);
  return ct_effect_copy(filled, effect, error);
}

void ct_effect_free(ct_effect *effect)
{
  if (effect == NULL) return;
  if (effect->free_data != NULL) effect->free_data(effect->data);
  ct_release(effect);
}

int32_t ct_effect_body_of(const ct_problem *problem, int32_t node)
{
  int32_t body = 0;
  while (body + 1 < problem->body_count && problem->bodies[body + 1].first_node <= node) body++;
  return body;
}

ct_status ct_effect_body_nodes(const ct_problem *problem, const int32_t *bodies, int32_t body_count,
                               const char *name, int32_t **nodes, int32_t *node_count,
                               ct_error *error)
{
  if (bodies != NULL && body_count < 1)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "%s: the list of bodies is empty", name);
  for (int32_t i = 0; bodies != NULL && i < body_count; i++)
    if (bodies[i] < 0 || bodies[i] >= problem->body_count)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){bodies[i], -1, -1},
                     "%s: there is no body %d", name, (int)bodies[i]);
  *node_count = 0;
  *nodes = ct_allocate((size_t)problem->node_count, sizeof **nodes);
  if (*nodes == NULL) return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "%s: no memory", name);
  for (int32_t b = 0; b < problem->body_count; b++) {
    int listed = bodies == NULL;
    for (int32_t i = 0; !listed && i < body_count; i++) listed = bodies[i] == b;
    const ct_body *body = &problem->bodies[b];
    for (int32_t n = 0; listed && n < body->mesh->node_count; n++)
      (*nodes)[(*node_count)++] = body->first_node + n;
  }
  return CT_OK;
}
