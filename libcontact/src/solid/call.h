#ifndef CT_SRC_SOLID_CALL_H
#define CT_SRC_SOLID_CALL_H

#include "../base/bits.h"
#include "sleep.h"

/* One call of the force for one body. */
typedef struct ct_part_call {
  const ct_solid_part *part;
  const double *displacement; /* of the body */
  double *values, *f;         /* of the body */
  const uint8_t *batch;       /* what its batches are, CT_ASLEEP and so on; null: all are active */
  const uint64_t *summed;     /* a bit a node of the problem: whether it is summed; null: all are */
  int examined; /* whether that was found anew, so that forces of batches that sleep are not zero */
} ct_part_call;

/* The forces at its nodes. */
void ct_part_force(const ct_part_call *call, int threads);

/* Whether a batch is computed. */
static inline int ct_call_computes(const ct_part_call *call, int32_t b)
{
  return call->batch == NULL || call->batch[b] == CT_ACTIVE;
}

/* The end of the batches from b on, and before `last`, that are computed as b is, or left out. */
static inline int32_t ct_call_run(const ct_part_call *call, int32_t b, int32_t last)
{
  if (call->batch == NULL) return last;
  int32_t end = b + 1;
  for (int computes = ct_call_computes(call, b);
       end < last && ct_call_computes(call, end) == computes;)
    end++;
  return end;
}

/* Whether somebody reads the forces of a batch that is left out, and they may not be zero yet. */
static inline int ct_call_clears(const ct_part_call *call, int32_t b)
{
  return call->examined || call->batch[b] == CT_BORDER;
}

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
