#ifndef CT_SRC_SOLID_PART_H
#define CT_SRC_SOLID_PART_H

#include "kernel.h"

/* Choose the kernel of a body and lay down what it needs; `part` is all zero bytes before. What is
 * there after an error is to be released, too. */
ct_status ct_part_prepare(ct_solid_part *part, const ct_solid_body *block, ct_error *error);

/* Give back what `ct_part_prepare` made; null pointers are allowed in it. */
void ct_part_release(ct_solid_part *part);

#endif
