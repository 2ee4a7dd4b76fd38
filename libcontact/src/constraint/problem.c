#include "problem.h"
#include "active.h"

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
  if (status == CT_OK && solver->first[solver->set_count] == 0) solver->written = 0; // none tells
  return status;
}

/* Motion of one node, into the place of its first component; `last` is the duration of the last
 * one. Four components are computed side by side; the fourth, of the next node, is then cleared.
 * That of the mobility stays: it is the one along a normal, which is often the same. */
CT_INLINE void predict_node(const ct_solver *s, const ct_prediction *p, double last, int components,
                            int64_t place, int64_t dof)
{
  double *increment = &s->increment[place], *mobility = &s->mobility[place],
         *last_increment = &s->last_increment[place];
  const double along = mobility[3];
#pragma omp simd
  for (int c = 0; c < components; c++) {
    // -- Motion without the constraints, that of a unit force, and the last one
    // (eq:constraint-problem, eq:host-step)
    increment[c] = ct_prediction_increment(p, dof + c);
    mobility[c] = p->tau * p->force_time * p->inverse_mass[dof + c];
    // -- at t = 0 the motion of a step with the first velocity (eq:reserve-start)
    last_increment[c] = last * p->velocity[dof + c];
  }
  increment[3] = last_increment[3] = 0.0;
  mobility[3] = along;
}

/* Motion of the nodes with rows, and of all where a rigid body moves some. Behind the one with the
 * largest number there may be no other. */
CT_INLINE void predict_nodes(const ct_solver *s, const ct_prediction *p, double last)
{
  const int some = s->bodies == NULL;
  const int32_t *place = some ? s->active_nodes : s->all_nodes,
                *end = place + (some ? s->active_node_count : s->node_count),
                other = CT_SOLVER_WIDE * s->last_node;
  for (; place < end; place++)
    if (*place != other)
      predict_node(s, p, last, 4, *place, 3 * (int64_t)s->nodes[(uint32_t)*place / CT_SOLVER_WIDE]);
  if (s->node_count > 0) predict_node(s, p, last, 3, other, 3 * (int64_t)s->nodes[s->last_node]);
}

/* The same, with a loop for each kind of prediction. */
CT_CLONES
static void predict(const ct_solver *solver, const ct_prediction *p, double last)
{
  const ct_solver s = *solver;
  ct_prediction of = *p;
  if (p->increment != NULL) predict_nodes(&s, &of, last);
  else if (p->acceleration != NULL) of.increment = NULL, predict_nodes(&s, &of, last);
  else of.increment = of.acceleration = NULL, predict_nodes(&s, &of, last);
}

void ct_rows_predict(ct_solver *solver, const ct_prediction *p)
{
  solver->fraction = p->force_time / p->whole;
  solver->dt = p->tau;
  solver->starts = !(p->before > 0.0);
  solver->again = p->again;
  ct_active_read(solver);
  predict(solver, p, solver->starts ? p->tau : p->before);
}

ct_status ct_rows_solve(ct_solver *solver, double time, ct_error *error)
{
  if (ct_solver_solve(solver)) return CT_OK;
  return ct_fail(error, CT_ERROR_BLOWUP, CT_NOWHERE,
                 "the contact forces stopped being finite at t = %g", time);
}
