#ifndef CT_SRC_SOLID_PLANE_H
#define CT_SRC_SOLID_PLANE_H

#include "call.h"

/* Let the plane of a part compute its forces, if it has one and that is possible; `values` as for
 * ct_part_task. */
void ct_plane_take(ct_part_call *call, double *values);

#endif
