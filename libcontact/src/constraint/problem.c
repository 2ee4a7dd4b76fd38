#include "problem.h"

#include "../base/error.h"

ct_status ct_rows_list_all(ct_solver *solver, ct_rows_list *list, void *user, ct_error *error)
{
  ct_status status = CT_OK;
  for (int32_t set = 0; status == CT_OK && set < solver->set_count; set++) {
    int64_t count = 0;
    status = list(user, set, solver->rows + solver->first[set], &count, error);
    solver->first[set + 1] = solver->first[set] + count;
  }
  return status;
}

void ct_rows_predict(ct_solver *solver, const ct_prediction *p)
{
  solver->fraction = p->force_time / p->whole;
  solver->dt = p->tau;
  solver->starts = !(p->before > 0.0);
  solver->again = p->again;
  for (int32_t i = 0; i < solver->node_count; i++) {
    int64_t own = CT_SOLVER_WIDE * (int64_t)i, dof = 3 * (int64_t)solver->nodes[i];
    for (int c = 0; c < 3; c++, own++, dof++) {
      // -- Motion without the constraints, that of a unit force, and the last one
      // (eq:constraint-problem, eq:host-step)
      solver->increment[own] = ct_prediction_increment(p, dof);
      solver->mobility[own] = p->tau * p->force_time * p->inverse_mass[dof];
      // -- at t = 0 the motion of a step with the first velocity (eq:reserve-start)
      solver->last_increment[own] = (solver->starts ? p->tau : p->before) * p->velocity[dof];
    }
  }
}

ct_status ct_rows_solve(ct_solver *solver, double time, ct_error *error)
{
  if (ct_solver_solve(solver)) return CT_OK;
  return ct_fail(error, CT_ERROR_BLOWUP, CT_NOWHERE,
                 "the contact forces stopped being finite at t = %g", time);
}
