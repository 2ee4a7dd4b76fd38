#ifndef CT_SRC_CONSTRAINT_ACTIVE_H
#define CT_SRC_CONSTRAINT_ACTIVE_H

#include "solve.h"

/* Choose the rows that take part in this step, after G is filled: those that are near
 * (eq:near-constraints), or all. */
void ct_active_choose(ct_solver *solver, int all);

/* Fill G for the next solution: then the nodes with rows are known. */
void ct_active_read(ct_solver *solver);

/* Fill G unless that was done, choose these rows, and find their laws and the scale of each.
 * Returns 0 if they are not finite. */
int ct_active_set_up(ct_solver *solver, int all);

/* Whether the forces throw inside a row that takes no part: then all must (eq:thrown-constraints).
 * -1 if they are not finite. */
int ct_active_throws(ct_solver *solver);

/* Afterwards: rows that take no part have no force, and keep nothing of their last one. */
void ct_active_leave(const ct_solver *solver);

#endif
