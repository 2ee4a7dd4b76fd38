#ifndef CT_SRC_CONSTRAINT_ACTIVE_H
#define CT_SRC_CONSTRAINT_ACTIVE_H

#include "solve.h"

/* Choose the rows that take part in this step, after G is filled (eq:near-constraints). */
void ct_active_choose(ct_solver *solver);

/* Fill G, choose these rows, and find their laws and the scale of each. Returns 0 if they are not
 * finite. */
int ct_active_set_up(ct_solver *solver);

#endif
