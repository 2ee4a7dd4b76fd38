#ifndef CT_SRC_SOLID_CALL_H
#define CT_SRC_SOLID_CALL_H

#include "../base/bits.h"
#include "sleep.h"

/* One call of the force for one body. */
typedef struct ct_part_call {
  const ct_solid_part *part;
  const ct_force_ring
      *ring; /* through which element forces go, the part's or its plane's; null: none */
  ct_solid_batches *batches;
  const double *displacement; /* of the body */
  double *values, *f;         /* of the body */
  const uint8_t *batch;       /* what its batches are, CT_ASLEEP and so on; null: all are active */
  const uint64_t *summed;     /* a bit a node of the problem: whether it is summed; null: all are */
  int examined; /* whether that was found anew, so that forces of batches that sleep are not zero */
} ct_part_call;

/* The forces at its nodes. */
void ct_part_force(const ct_part_call *call, int threads);

/* The next nodes to be summed, from `first` on and before `last`; answers the end of their run
 * (ct_bits_run). */
static inline int32_t ct_call_nodes(const ct_part_call *call, int32_t *first, int32_t last)
{
  int32_t shift = call->part->first_node, from = shift + *first,
          end = ct_bits_run(call->summed, &from, shift + last);
  *first = from - shift;
  return end - shift;
}

#endif
