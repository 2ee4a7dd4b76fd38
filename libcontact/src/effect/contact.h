#ifndef CT_SRC_TOUCH_H
#define CT_SRC_TOUCH_H

#include <libcontact/contact_effect.h>

#include "../base/memory.h"
#include "../contact/contact_internal.h"

/* Constant data of the effect of an interaction. */
typedef struct ct_touch {
  ct_interaction *is;
  const ct_problem *problem;
  int32_t carrier; /* body that carries an obstacle, or -1 */
} ct_touch;

/* Scratch space of such an effect. */
typedef struct ct_touch_scratch {
  ct_pool pool;
  const ct_interaction *is;
  void *state;                  /* of the interaction */
  double *x, *velocity;         /* at its nodes, shape (node_count, 3) */
  const struct ct_piece *piece; /* null: of a whole state */
} ct_touch_scratch;

/* State of the interaction in the scratch space of its effect. */
static inline void *ct_touch_state(const void *scratch)
{
  return ((const ct_touch_scratch *)scratch)->state;
}

#endif
