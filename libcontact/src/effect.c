#include <contact/effect.h>

#include "error.h"
#include "memory.h"

ct_savings ct_savings_default(void) { return (ct_savings){.quiet = 1, .plane_strain = 1, .congruent = 1, .distant = 1}; }

ct_status ct_effect_create(const ct_effect *filled, ct_effect **effect, ct_error *error)
{
  if (filled == NULL || effect == NULL || filled->name == NULL || filled->node_count < 0 || filled->memory_count < 0)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "effect: null argument, no name or negative counts");
  if ((filled->force == NULL) != (filled->reaction != 0))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "effect %s: needs a force, or to be a reaction without one", filled->name);
  if ((filled->create_scratch == NULL) != (filled->free_scratch == NULL))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "effect %s: scratch space needs both a maker and a way back", filled->name);
  for (int32_t i = 0; filled->nodes != NULL && i < filled->node_count; i++)
    if (filled->nodes[i] < 0 || (i > 0 && filled->nodes[i] <= filled->nodes[i - 1]))
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, filled->nodes[i]}, "effect %s: node %d at place %d is not in ascending order",
                     filled->name, (int)filled->nodes[i], (int)i);
  *effect = ct_allocate(1, sizeof **effect);
  if (*effect == NULL) return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for effect %s", filled->name);
  **effect = *filled;
  return CT_OK;
}

void ct_effect_free(ct_effect *effect)
{
  if (effect == NULL) return;
  if (effect->free_data != NULL) effect->free_data(effect->data);
  ct_release(effect);
}
