#ifndef CT_SRC_SOLID_CALL_H
#define CT_SRC_SOLID_CALL_H

#include <libcontact/step.h>

#include "quiet.h"

/* One call of the force for one body. */
typedef struct ct_part_call {
  const ct_solid_part *part;
  const double *displacement; /* of the problem */
  double *values, *f;         /* of the body */
  ct_quiet *quiet;            /* null: compute every batch, sum every node */
} ct_part_call;

/* Let all nodes of body `number` be summed. */
void ct_part_sum_all(ct_quiet *quiet, const ct_solid_part *part, int32_t number);

/* Find which batches of body `number` are quiet, and mark the nodes of the others; `node_count`: of
 * the problem. */
void ct_part_find_quiet(const ct_part_call *call, int32_t number, const ct_view *view,
                        int32_t node_count);

/* The forces at its nodes, but for those of a plane. */
void ct_part_force(const ct_part_call *call, int threads);

/* Add the elements of body `number` that a call computes, and those that it leaves out. */
void ct_part_count_updates(const ct_part_call *call, int32_t number, int64_t updates[2]);

#endif
