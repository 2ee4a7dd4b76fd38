#include <contact/effect.h>

#include "memory.h"

void ct_effect_free(ct_effect *effect)
{
  if (effect == NULL) return;
  if (effect->free_data != NULL) effect->free_data(effect->data);
  ct_release(effect);
}
