#ifndef CT_SRC_SOLID_CALL_H
#define CT_SRC_SOLID_CALL_H

#include "../base/bits.h"
#include "sleep.h"

/* Fewest operations of a thread: a fraction of a millisecond. */
enum { CT_LEAST_FLOPS = 2000000 };

/* One force evaluation of one body; the rings of all bodies share their memory. */
typedef struct ct_part_call {
  const ct_solid_part *part;
  const ct_force_ring *ring; /* ring of element forces, of the part or its plane; null: none */
  ct_solid_batches *batches;
  const double *displacement; /* of the body, in the order of the part */
  const double *given;        /* the same in the order of the user */
  double *ordered;            /* memory for the former of a part with its own order, else null */
  double *values;
  double *f;              /* of the body, in the order of the user */
  int64_t ring_stride;    /* numbers between the rings of two threads */
  const uint8_t *batch;   /* state of its batches, CT_ASLEEP and so on; null: all are active */
  const uint64_t *summed; /* one bit per node of the problem: whether it is summed; null: all are */
  int examined; /* whether the states of batches are new, so that forces of sleeping batches may not
                   be zero */
} ct_part_call;

/* The task of a part: its forces f from the values `given` at its nodes, which are displacements,
 * or velocities for the forces of dashpots; all elements are active. `values` is the array of all
 * parts (ct_parts_place). */
ct_part_call ct_part_task(const ct_solid_part *part, const double *given, double *values,
                          int64_t ring_stride, double *f);

/* Copy the displacements that are `given` into the order of those bodies that have their own; nodes
 * that are not summed may be omitted. */
void ct_part_arrange(const ct_part_call *calls, int32_t count, int threads);

/* The forces at the nodes of `count` bodies. A thread computes its parts of all of them in order,
 * without waiting in between. */
void ct_part_forces(const ct_part_call *calls, int32_t count, int threads);

/* The next nodes that are summed, from `first` on and before `last`; returns the end of their run
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
