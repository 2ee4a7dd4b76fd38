#ifndef CT_SRC_CONSTRAINT_TANGENT_H
#define CT_SRC_CONSTRAINT_TANGENT_H

#include "solve.h"

/* The tangential forces of all rows with friction, solved for together within discs that the normal
 * forces fix (eq:slip-problem). */

/* Allocate for at most `most` rows with friction, from the solver's pool, which may fail. */
void ct_tangent_create(ct_solver *solver, int64_t most);

/* Begin a step: list the rows, and let the gaps `free` follow the forces with which the iteration
 * begins. Returns 0 if they are not finite. */
int ct_tangent_begin(ct_solver *solver);

/* Solve for the tangential forces, given those of the normals. The gaps `free` and the gradient
 * follow them; `change` is the largest change of a normal force by this, as a fraction of the
 * largest. Returns 0 if forces are not finite. */
int ct_tangent_solve(ct_solver *solver, int pass, double *change);

/* Without a solution: no tangential forces in this step, so that they add no energy. The gaps and
 * the gradient follow. Returns 0 if they are not finite. */
int ct_tangent_drop(ct_solver *solver);

/* Store the tangential forces in the rows. */
void ct_tangent_store(ct_solver *solver);

#endif
