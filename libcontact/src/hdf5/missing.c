#include "../base/error.h"

#include <libcontact/output.h>

/* libcontact-hdf5 on a system without POSIX files: every call refuses. */

int ct_hdf5_load(void *(*find)(const char *name));
int ct_hdf5_load(void *(*find)(const char *name))
{
  (void)find;
  return 0;
}

static ct_status refuse(ct_error *error)
{
  return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                 "libcontact was built without HDF5, so it can't write or read a results file");
}

ct_output_options ct_output_options_default(void)
{
  return (ct_output_options){.cookie = CT_DEF_COOKIE};
}

ct_status ct_output_create(const char *path, const ct_problem *problem,
                           const ct_output_options *options, ct_output **output, ct_error *error)
{
  (void)path, (void)problem, (void)options;
  if (output != NULL) *output = NULL;
  return refuse(error);
}

ct_status ct_output_append(ct_output *output, const ct_problem *problem, ct_state *state,
                           ct_error *error)
{
  (void)output, (void)problem, (void)state;
  return refuse(error);
}

ct_status ct_output_append_row(ct_output *output, const ct_problem *problem, ct_state *state,
                               const ct_ledger *row, ct_error *error)
{
  (void)output, (void)problem, (void)state, (void)row;
  return refuse(error);
}

static ct_status refuse_steps(void *output, const ct_problem *problem, ct_state *state,
                              int64_t count, ct_error *error)
{
  (void)output, (void)problem, (void)state, (void)count;
  return refuse(error);
}

ct_observer ct_output_observer(ct_output *output, int64_t every)
{
  static const ct_observer_calls CALLS = {.prepare = refuse_steps};
  return (ct_observer){.calls = &CALLS, .data = output, .every = every};
}

ct_status ct_output_close(ct_output *output, ct_error *error)
{
  (void)output;
  return refuse(error);
}

ct_status ct_output_restart(const char *path, const ct_problem *problem, ct_state *state,
                            ct_error *error)
{
  (void)path, (void)problem, (void)state;
  return refuse(error);
}

ct_status ct_output_restart_step(const char *path, const ct_problem *problem, const ct_state *state,
                                 double *dt, ct_error *error)
{
  (void)path, (void)problem, (void)state, (void)dt;
  return refuse(error);
}

ct_status ct_output_restart_probes(const char *path, const ct_state *state, ct_probes *probes,
                                   ct_error *error)
{
  (void)path, (void)state, (void)probes;
  return refuse(error);
}
