#ifndef CT_SRC_CONSTRAINT_PROBLEM_H
#define CT_SRC_CONSTRAINT_PROBLEM_H

#include "solve.h"

/* The constraint problem of a step: list the rows of all sets, predict the motion without them,
 * and solve for their forces. The time loop of a problem and that of a host use the same calls. */

/* List the rows of one set, at most as many as it was created with. */
typedef ct_status ct_rows_list(void *user, int32_t set, ct_constraint **rows, int64_t *count,
                               ct_error *error);

/* List the rows of all sets in order. */
ct_status ct_rows_list_all(ct_solver *solver, ct_rows_list *list, void *user, ct_error *error);

/* The next step without the constraints: a node moves by `tau` times (v + `force_time` f / m + `l`
 * times the last acceleration) (eq:stage). Arrays have the numbering of the solver's `nodes`. */
typedef struct ct_prediction {
  double tau, force_time, l;
  double whole;  /* the value of `force_time` in a step that does not begin at t = 0 */
  double before; /* Δt of the last step; 0: none */
  int again;     /* whether the step at t = 0 was already solved, with v_0 (eq:stage-start) */
  const double *velocity, *inverse_mass, *force;
  const double *acceleration; /* of the last evaluation, or null */
  const double *increment;    /* given displacement increments, or null */
} ct_prediction;

/* Displacement increment of a component. */
static inline double ct_prediction_increment(const ct_prediction *p, int64_t dof)
{
  if (p->increment != NULL) return p->increment[dof];
  // -- Δt v_{n+1/2} = Δt (v_{n-1/2} + τ f / m) (eq:host-step, eq:stage)
  double velocity = p->velocity[dof] + p->force_time * p->inverse_mass[dof] * p->force[dof];
  if (p->acceleration != NULL) velocity += p->l * p->acceleration[dof];
  return p->tau * velocity;
}

/* Displacement increment of each of the solver's nodes with rows, which must be listed, further
 * increment of each component per unit force, and its increment in the last step
 * (eq:constraint-problem). */
void ct_rows_predict(ct_solver *solver, const ct_prediction *p);

/* Solve for the forces of the listed rows. ``CT_ERROR_BLOWUP``: they are not finite. */
ct_status ct_rows_solve(ct_solver *solver, double time, ct_error *error);

#endif
