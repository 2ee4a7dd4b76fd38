#ifndef CT_SRC_SOLID_PART_H
#define CT_SRC_SOLID_PART_H

#include "kernel.h"

/* Choose the kernel of a body and compute its data; `part` is all zero bytes before. Release it
 * also after an error. */
ct_status ct_part_prepare(ct_solid_part *part, const ct_solid_body *body, ct_error *error);

/* Free the results of `ct_part_prepare`; null pointers are allowed in it. */
void ct_part_release(ct_solid_part *part);

#endif
