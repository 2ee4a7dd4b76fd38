#ifndef CT_SRC_SOLID_PLANE_H
#define CT_SRC_SOLID_PLANE_H

#include "call.h"

/* Whether the layers have moved alike, and not at all along their axis, as far as they are summed.
 */
int ct_plane_holds(const ct_part_call *call);

/* Forces of the lower layer, into the ring of the part's plane. */
ct_solid_batches ct_plane_batches;

#endif
