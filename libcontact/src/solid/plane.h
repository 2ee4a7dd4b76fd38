#ifndef CT_SRC_SOLID_PLANE_H
#define CT_SRC_SOLID_PLANE_H

#include "call.h"

/* Whether both layers have the same displacements, and none along their axis, at the nodes that are
 * summed. */
int ct_plane_holds(const ct_part_call *call);

/* Let the plane of a part compute its forces, if it has one and that is possible; `values` as for
 * ct_part_task. */
void ct_plane_take(ct_part_call *call, double *values);

/* Forces of the lower layer, into the ring of the part's plane. */
ct_solid_batches ct_plane_batches;

#endif
