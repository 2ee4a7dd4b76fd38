#ifndef CT_SRC_CONSTRAINT_TANGENT_ITERATE_H
#define CT_SRC_CONSTRAINT_TANGENT_ITERATE_H

#include "solve.h"

/* Take the forces with which the iteration begins; at t = 0 they are given. */
void ct_tangent_start(ct_solver *solver);

/* Solve for the tangential forces with the present normal ones. Allowed forces that already meet
 * twice the tolerance `least` are not changed. Returns the number of rounds that changed them; -1
 * if they are not finite. */
int ct_tangent_iterate(ct_solver *solver, double least);

#endif
