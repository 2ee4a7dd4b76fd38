#ifndef CT_SRC_HELD_H
#define CT_SRC_HELD_H

#include <libcontact/effect.h>

#include "../base/memory.h"

/* Nodes with prescribed components, shared by supports and motions. */
typedef struct ct_held {
  ct_pool pool;
  int32_t *nodes; /* ascending; null: all of the problem */
  int32_t node_count;
  int32_t *holder;    /* of each node and component: the number of its motion plus 1, or 0 if it is
                         free, shape (node_count, 3) */
  ct_motion *motions; /* copies without nodes; a support has its velocity in place of the
                         displacement, and no amplitude */
  const double *mass, *inverse_mass; /* of the problem */
} ct_held;

/* Check and copy motions, or supports if errors must name these. `held` begins with only its pool.
 */
ct_status ct_held_fill(ct_held *held, ct_scene_part part, const ct_problem *problem,
                       const ct_motion *motions, int32_t count, ct_error *error);

#endif
