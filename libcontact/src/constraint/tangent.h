#ifndef CT_SRC_CONSTRAINT_TANGENT_H
#define CT_SRC_CONSTRAINT_TANGENT_H

#include "solve.h"

/* The tangential forces of all rows with friction, solved for together within discs that the normal
 * forces fix (eq:slip-problem). */

/* Allocate for at most `most` rows with friction, from the solver's pool, which may fail. */
void ct_tangent_create(ct_solver *solver, int64_t most);

/* Begin a step: no tangential force. */
void ct_tangent_begin(ct_solver *solver);

/* Solve for the tangential forces, given those of the normals, and store them in the rows. Returns
 * 1 if they move the gaps, so that the normals must be solved for again, with the gaps `free`, and
 * this function called again; 0 when all is done; -1 if forces are not finite. */
int ct_tangent_solve(ct_solver *solver);

#endif
