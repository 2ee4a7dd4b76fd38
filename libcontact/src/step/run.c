/* Steps with those who observe them. */
#include "piece.h"
#include "workspace.h"

#include <string.h>

static ct_status prepare(const ct_problem *problem, ct_state *state, int64_t count,
                         const ct_observers *by, ct_error *error)
{
  if (problem == NULL || state == NULL || by->count < 0 || (by->count > 0 && by->list == NULL))
    return CT_REFUSE(error, "run: problem, state or the list of observers is null");
  if (count < 0)
    return CT_REFUSE(error, "run: the number of steps must be at least 0, not %lld",
                     (long long)count);
  for (int32_t i = 0; i < by->count; i++)
    if (by->list[i].calls == NULL)
      return CT_REFUSE(error, "run: the table of calls of observer %d is null", (int)i);
    else if (by->list[i].every < 1)
      return CT_REFUSE(error, "run: every of observer %d must be at least 1 step, not %lld", (int)i,
                       (long long)by->list[i].every);
  ct_status status = CT_OK;
  state->workspace->unchanged = 0;
  for (int32_t i = 0; status == CT_OK && i < by->count; i++) {
    const ct_observer *o = &by->list[i];
    if (o->calls->prepare != NULL)
      status = o->calls->prepare(o->data, problem, state, count, error);
  }
  return ct_piece_agree(state->workspace->piece, status, error);
}

/* Whether an observer samples. */
static int any_samples(const ct_observers *by)
{
  for (int32_t i = 0; i < by->count; i++)
    if (by->list[i].calls->sample != NULL) return 1;
  return 0;
}

/* Number of steps until the next check, at most `count`. */
static int64_t steps_to_check(const ct_observers *by, const ct_state *state, int64_t count)
{
  for (int32_t i = 0; i < by->count; i++) {
    int64_t due = by->list[i].every - state->step % by->list[i].every;
    if (by->list[i].calls->check != NULL && due < count) count = due;
  }
  return count;
}

static ct_status check(const ct_observers *by, ct_state *state, int last, ct_error *error)
{
  ct_status status = CT_OK;
  for (int32_t i = 0; status == CT_OK && i < by->count; i++) {
    const ct_observer *o = &by->list[i];
    if (o->calls->check != NULL && (state->step % o->every == 0 || (last && o->last)))
      status = o->calls->check(o->data, state, error);
  }
  return status;
}

ct_status ct_run_complete(const ct_problem *problem, const ct_state *state, ct_status status,
                          const ct_error *own, ct_error *error)
{
  if (status == CT_OK || error == NULL) return status;
  *error = *own;
  if (strstr(own->text, "(step ") != NULL) return status;
  int named = own->body >= 0 && own->body < problem->body_count;
  const char *name = named ? problem->bodies[own->body].name : "", *quote = named ? "\"" : "";
  ct_fail(error, status, (ct_place){own->body, own->element, own->point},
          "at t = %g (step %lld)%s%s%s%s", state->time, (long long)state->step,
          named ? ", body " : "", quote, name, quote);
  if (own->element >= 0) ct_error_add(error, ", element %lld", (long long)own->element);
  ct_error_add(error, ": %s", own->text[0] != 0 ? own->text : ct_status_name(status));
  return status;
}

ct_status ct_run(const ct_problem *problem, ct_state *state, int64_t count,
                 const ct_observer *observers, int32_t observer_count, ct_error *error)
{
  const ct_observers by = {observers, observer_count};
  ct_error own = {.body = -1, .element = -1, .point = -1};
  ct_status status = prepare(problem, state, count, &by, &own);
  if (status != CT_OK) {
    own.code = status;
    if (error != NULL) *error = own;
    return status;
  }
  const ct_observers *samplers = any_samples(&by) ? &by : NULL;
  ct_series_begin(state, state->workspace->unchanged);
  while (status == CT_OK && count > 0) {
    int64_t now = steps_to_check(&by, state, count);
    status = ct_series_steps(problem, state, now, samplers, &own);
    count -= now;
    if (status == CT_OK) status = check(&by, state, count == 0, &own);
  }
  ct_series_end(state);
  return ct_run_complete(problem, state, status, &own, error);
}
