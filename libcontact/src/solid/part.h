#ifndef CT_SRC_SOLID_PART_H
#define CT_SRC_SOLID_PART_H

#include "kernel.h"

/* Choose the kernel of a body and compute its data; `part` is all zero bytes before. Release it
 * also after an error. */
ct_status ct_part_prepare(ct_solid_part *part, const ct_solid_body *body, ct_error *error);

/* The same part with some of its elements, those that are `mine` (not 0), in their order, and all
 * of its nodes. Free it with ct_part_release, before the whole part. */
ct_status ct_part_cut(const ct_solid_part *whole, const uint8_t *mine, ct_solid_part *part,
                      ct_error *error);

/* The layout of a hex8 part with a mesh and kernel of its own: rows of batches, and a ring or a
 * table for the sums at the nodes. Release it also after an error. */
ct_status ct_part_lay_out(ct_solid_part *part, ct_error *error);

/* Set the begin of each part's values in one array, and of the displacements in its own order;
 * returns the size of the array. A ring is read before a thread computes the next part, so it has
 * one ring, of `ring_stride` numbers, for all parts. */
int64_t ct_parts_place(ct_solid_part *parts, int32_t count, int64_t *ring_stride);

/* Memory for the displacements of a part in its own order; else null. */
static inline double *ct_part_ordered(const ct_solid_part *part, double *values)
{
  return part->order != NULL ? values + part->first_ordered : NULL;
}

/* Free the results of `ct_part_prepare` or `ct_part_lay_out`; null pointers are allowed in it. */
void ct_part_release(ct_solid_part *part);

#endif
