#ifndef CT_SRC_CONSTRAINT_TANGENT_FOLLOW_H
#define CT_SRC_CONSTRAINT_TANGENT_FOLLOW_H

#include "solve.h"

/* Let the gaps of all active rows follow the tangential forces of the last step, as far as these
 * opened them. */
void ct_tangent_shift_first(ct_solver *solver);

/* Let them follow the present tangential forces. Writes the largest change of a normal force that
 * this causes, as a fraction of the largest. Returns 0 if it is not finite. */
int ct_tangent_shift(ct_solver *solver, double *change);

#endif
