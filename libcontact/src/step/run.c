/* Steps with those who observe them. */
#include "workspace.h"

#include <string.h>

static ct_status check_arguments(const ct_problem *problem, const ct_state *state, int64_t count,
                                 const ct_observers *by, ct_error *error)
{
  if (problem == NULL || state == NULL || count < 0)
    return CT_REFUSE(error, "run: null argument, or %lld steps", (long long)count);
  if (by->monitor == NULL && by->check_last)
    return CT_REFUSE(error, "run: check_last needs a monitor");
  if (by->monitor != NULL && ct_monitor_problem(by->monitor) != problem)
    return CT_REFUSE(error, "run: the monitor belongs to another problem");
  return CT_OK;
}

/* Add time and body to the error of an effect. */
static ct_status complete(const ct_problem *problem, const ct_state *state, ct_status status,
                          ct_error *error)
{
  char text[sizeof error->text];
  if (status == CT_OK || error == NULL || strstr(error->text, "(step ") != NULL) return status;
  memcpy(text, error->text, sizeof text);
  int named = error->body >= 0 && error->body < problem->body_count;
  const char *name = named ? problem->bodies[error->body].name : "", *quote = named ? "\"" : "";
  ct_fail(error, error->code, (ct_place){error->body, error->element, error->point},
          "at t = %g (step %lld)%s%s%s%s", state->time, (long long)state->step,
          named ? ", body " : "", quote, name, quote);
  if (error->element >= 0) ct_error_add(error, ", element %lld", (long long)error->element);
  ct_error_add(error, ": %s", text);
  return status;
}

ct_status ct_run(const ct_problem *problem, ct_state *state, int64_t count,
                 const ct_observers *observers, ct_error *error)
{
  static const ct_observers nobody;
  const ct_observers *by = observers != NULL ? observers : &nobody;
  ct_monitor *monitor = by->monitor;
  const ct_sampler sampler = {ct_probes_take, by->probes};
  ct_status status = check_arguments(problem, state, count, by, error);
  if (status == CT_OK && by->probes != NULL)
    status = ct_probes_prepare(by->probes, state, count, error);
  if (status != CT_OK) return status;
  ct_series_begin(state, monitor != NULL && ct_monitor_knows(monitor, state));
  while (status == CT_OK && count > 0) {
    int64_t due = monitor != NULL ? ct_monitor_due(monitor, state) : count,
            now = count < due ? count : due;
    status = ct_series_steps(problem, state, now, by->probes != NULL ? &sampler : NULL, error);
    count -= now;
    if (status == CT_OK && monitor != NULL && (now == due || (by->check_last && count == 0)))
      status = ct_monitor_examine(monitor, state, error);
  }
  ct_series_end(state);
  return monitor != NULL ? complete(problem, state, status, error) : status;
}
