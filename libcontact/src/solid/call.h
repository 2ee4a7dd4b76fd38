#ifndef CT_SRC_SOLID_CALL_H
#define CT_SRC_SOLID_CALL_H

#include "../base/bits.h"
#include "sleep.h"

/* One call of the force for one body; the rings of all bodies stand in the same place. */
typedef struct ct_part_call {
  const ct_solid_part *part;
  const ct_force_ring
      *ring; /* through which element forces go, the part's or its plane's; null: none */
  ct_solid_batches *batches;
  const double *displacement; /* of the body */
  double *values, *f;         /* of the body */
  int64_t ring_room;          /* numbers between the rings of two threads */
  const uint8_t *batch;       /* what its batches are, CT_ASLEEP and so on; null: all are active */
  const uint64_t *summed;     /* a bit a node of the problem: whether it is summed; null: all are */
  int examined; /* whether that was found anew, so that forces of batches that sleep are not zero */
} ct_part_call;

/* The forces at the nodes of `count` bodies. A thread takes its shares of all of them one after
 * the other and waits for nobody in between. */
void ct_part_forces(const ct_part_call *calls, int32_t count, int threads);

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
