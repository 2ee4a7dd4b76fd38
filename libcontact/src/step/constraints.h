#ifndef CT_SRC_CONSTRAINTS_H
#define CT_SRC_CONSTRAINTS_H

#include <libcontact/problem.h>

#include "../constraint/solve.h"
#include "workspace.h"

/* The constraints of a problem in a state: input and output of the solver. */
typedef struct ct_constraints {
  ct_solver *solver;
  int32_t *effects;  /* the effect of each set of rows */
  int32_t **place;   /* of each effect that prescribes motion: its nodes' places among the solver's,
                        or -1 */
  double *increment; /* prescribed by one effect; null if none does */
  int32_t rigid;     /* the effect of the rigid bodies, or -1 */
  ct_body_mobility *bodies; /* of them, and the arms of its nodes */
  double *arms;
  int solved;      /* whether the solver has rows of this step, and the motion of rigid bodies */
  uint64_t *begun; /* one bit per node of the problem: a force of a constraint begins there at t = 0
                      (eq:energy-start) */
} ct_constraints;

/* The workspace's constraints, from its pool, which may fail; null if no effect has any. */
void ct_constraints_create(const ct_problem *problem, ct_workspace *w);

/* List the constraints of all effects and solve for their forces, given the sum of all other forces
 * (eq:constraint-problem). */
ct_status ct_constraints_solve(const ct_problem *problem, ct_state *state, ct_error *error);

/* After the nodes have moved by a kick of this share of the step: give the work of these forces on
 * the part of the motion of rigid bodies that is not linear in them to the rigid bodies
 * (eq:rigid-turned). */
void ct_constraints_share(const ct_problem *problem, ct_state *state, double share);

#endif
