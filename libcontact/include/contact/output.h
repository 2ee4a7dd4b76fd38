#ifndef CONTACT_OUTPUT_H
#define CONTACT_OUTPUT_H

/* Part of the add-on library libcontact-hdf5. */

#include <contact/energy.h>
#include <contact/step.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A results file that is being written; opaque, as it holds HDF5 handles. */
typedef struct ct_output ct_output;

/** What is written. */
typedef struct ct_output_options {
  /** Fields of each recorded step (0 or 1); displacement is also what moves the points in a viewer. */
  int displacement;
  int velocity;
  int stress;
  /** A text that goes with the file, for example the scene as TOML; may be null. */
  const char *scene;
} ct_output_options;

/**
 * Create a transient VTKHDF file (UnstructuredGrid, static points) for the problem. An existing file is replaced.
 * ``CT_ERROR_FILE`` with the path and the system's reason.
 */
CT_API ct_status ct_output_create(const char *path, const ct_problem *problem, const ct_output_options *options,
                                  ct_output **output, ct_error *error);

/**
 * Append the state as one more time step: fields, ledger rows, and the restart record (the file keeps the newest one).
 * What was appended is flushed, so that a run that dies leaves every earlier step readable.
 */
CT_API ct_status ct_output_append(ct_output *output, const ct_problem *problem, ct_state *state, ct_error *error);

/** Close the file; ``CT_ERROR_FILE`` if the last bytes could not be written. */
CT_API ct_status ct_output_close(ct_output *output, ct_error *error);

/** Read the newest restart record of a file into `state`, which must belong to a problem of the same size and effects. */
CT_API ct_status ct_output_restart(const char *path, const ct_problem *problem, ct_state *state, ct_error *error);

#ifdef __cplusplus
}
#endif

#endif
