#include "problem.h"

#include "../base/error.h"
#include "../base/lanes.h"

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

/* Motion of some nodes; `last` is the duration of the last one. */
CT_CLONES
static void predict_nodes(int32_t count, const int32_t *nodes, const ct_prediction *p, double last,
                          double *restrict increment, double *restrict mobility,
                          double *restrict last_increment)
{
  const ct_prediction of = *p;
  const double unit = of.tau * of.force_time;
  for (int32_t i = 0; i < count; i++) {
    const int64_t own = CT_SOLVER_WIDE * (int64_t)i, dof = 3 * (int64_t)nodes[i];
    for (int c = 0; c < 3; c++) {
      // -- Motion without the constraints, that of a unit force, and the last one
      // (eq:constraint-problem, eq:host-step)
      increment[own + c] = ct_prediction_increment(&of, dof + c);
      mobility[own + c] = unit * of.inverse_mass[dof + c];
      // -- at t = 0 the motion of a step with the first velocity (eq:reserve-start)
      last_increment[own + c] = last * of.velocity[dof + c];
    }
  }
}

void ct_rows_predict(ct_solver *solver, const ct_prediction *p)
{
  solver->fraction = p->force_time / p->whole;
  solver->dt = p->tau;
  solver->starts = !(p->before > 0.0);
  solver->again = p->again;
  predict_nodes(solver->node_count, solver->nodes, p, solver->starts ? p->tau : p->before,
                solver->increment, solver->mobility, solver->last_increment);
}

ct_status ct_rows_solve(ct_solver *solver, double time, ct_error *error)
{
  if (ct_solver_solve(solver)) return CT_OK;
  return ct_fail(error, CT_ERROR_BLOWUP, CT_NOWHERE,
                 "the contact forces stopped being finite at t = %g", time);
}
