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
  const double *displacement; /* of the body, in the order of the part */
  const double *given;        /* the same in the order of the user */
  double *room;               /* where a part with an order of its own has the former, else null */
  double *values;
  double *f;              /* of the body, in the order of the user */
  int64_t ring_room;      /* numbers between the rings of two threads */
  const uint8_t *batch;   /* what its batches are, CT_ASLEEP and so on; null: all are active */
  const uint64_t *summed; /* a bit a node of the problem: whether it is summed; null: all are */
  int examined; /* whether that was found anew, so that forces of batches that sleep are not zero */
} ct_part_call;

/* Copy the displacements that are `given` to the rooms of those of the bodies that have an order of
 * their own; of nodes that are not summed maybe not. */
void ct_part_arrange(const ct_part_call *calls, int32_t count, int threads);

/* The forces at the nodes of `count` bodies. A thread takes its shares of all of them one after
 * the other and waits for nobody in between. */
void ct_part_forces(const ct_part_call *calls, int32_t count, int threads);

/* The next nodes to be summed, from `first` on and before `last`; returns the end of their run
 * (ct_bits_run). */
static inline int32_t ct_call_nodes(const ct_part_call *call, int32_t *first, int32_t last)
{
  // The bits are in the order of the user.
  const uint64_t *summed = call->part->order == NULL ? call->summed : NULL;
  int32_t shift = call->part->first_node, from = shift + *first,
          end = ct_bits_run(summed, &from, shift + last);
  *first = from - shift;
  return end - shift;
}

#endif
