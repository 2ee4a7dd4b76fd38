/* Results files and restart (HDF5), in the add-on library libcontact-hdf5.
 * Threads: one at a time in the whole process, whatever the file, unless HDF5 itself was built
 * thread-safe. */
#ifndef LIBCONTACT_OUTPUT_H
#define LIBCONTACT_OUTPUT_H

#include <libcontact/step.h>

/* Part of the add-on library libcontact-hdf5. Where that was built without HDF5, every call, also
 * that of ct_output_close without an output, returns CT_ERROR_UNSUPPORTED. */

CT_BEGIN_DECLS

/** A results file that is being written; opaque, as it holds HDF5 handles. Used by one thread at a
 * time. */
typedef struct ct_output ct_output;

/** What is written. */
typedef struct ct_output_options {
  /** Fields of each recorded step (0 or 1); displacement is also what moves the points in a viewer.
   */
  int displacement;
  int velocity;
  int stress;
  /** A text that goes with the file, for example the scene as TOML, in UTF-8; may be null. */
  const char *scene;
  /** One more field (0 or 1): the contact pressure at the nodes, `ct_state_pressure`. */
  int contact_pressure;
  /** Null, or probes of the run: each record also writes what they have taken up to its time. They
   * must outlive the output. */
  const ct_probes *probes;
  /**
   * Passes of the filter of what is shown, 0 to 8. From one on, each displacement, velocity and
   * stress that is written has a second field with ``_filtered`` behind its name, from
   * `ct_filter_apply`, and the group ``libcontact`` has the attribute ``filter``.
   */
  int filter;
} ct_output_options;

/**
 * Create a transient VTKHDF file (UnstructuredGrid, static points) for the problem. Until the first
 * step is written the file is called `path` with ``.part`` behind it; then it takes the place of an
 * older file called `path`, so that a run that fails at once takes nothing away. The file is locked
 * until it is closed: a second output to `path` is refused, in this process or another, while what
 * a killed run has left blocks nobody. A link at the name with ``.part`` is replaced, not followed.
 * Errors:
 * ``CT_ERROR_FILE`` with the path and the system's reason, or because another run writes the file;
 * ``CT_ERROR_MEMORY``,
 * ``CT_ERROR_ARGUMENT`` for a problem without bodies or with bodies that do not follow one another,
 * ``CT_ERROR_UNSUPPORTED`` when another HDF5 is loaded than the one compiled against. `*output` is
 * null after an error.
 */
CT_API ct_status ct_output_create(const char *path, const ct_problem *problem,
                                  const ct_output_options *options, ct_output **output,
                                  ct_error *error);

/**
 * Append the state as one more time step: fields, ledger rows, and the restart record (the file
 * keeps the newest one). A run that is killed at any moment, also within this call, leaves every
 * earlier step and one whole restart record readable. Errors:
 * ``CT_ERROR_FILE`` with the path and the system's reason; after "No space left" nothing of the
 * step is in the file, and the call may be tried again; after another failed write the output only
 * waits to be closed. ``CT_ERROR_BLOWUP`` (body and node in `error`) for a state that is not
 * finite, which is not written. ``CT_ERROR_ARGUMENT`` for another problem's state.
 */
CT_API ct_status ct_output_append(ct_output *output, const ct_problem *problem, ct_state *state,
                                  ct_error *error);

/**
 * The same with the row of the energy balance that the caller has of this state, with both its
 * arrays, from `ct_monitor_ledger` or `ct_ledger_of`; a null `row` is found anew.
 * ``CT_ERROR_ARGUMENT`` also for a row without its arrays or of another time.
 */
CT_API ct_status ct_output_append_row(ct_output *output, const ct_problem *problem, ct_state *state,
                                      const ct_ledger *row, ct_error *error);

/**
 * Close the file and free `output`, whatever is returned; a null `output` is no error.
 * ``CT_ERROR_FILE`` if a step or the last bytes could not be written. An output without a step
 * leaves no file.
 */
CT_API ct_status ct_output_close(ct_output *output, ct_error *error);

/**
 * Read the newest whole restart record of a file into `state`, which was made for `problem`. The
 * state is changed only when all goes well. ``CT_ERROR_FILE`` when the file can't be read, has no
 * whole record (:eq:`restart-seal`), or belongs to another problem: `error` then names the first
 * difference in bodies, materials, effects, time step or nodes.
 */
CT_API ct_status ct_output_restart(const char *path, const ct_problem *problem, ct_state *state,
                                   ct_error *error);

/**
 * Put the histories that a file has of probes of these names and quantities, up to the time of the
 * state, in place of theirs, after `ct_output_restart`; the history of any other probe begins with
 * the state. ``CT_ERROR_FILE`` when the file can't be read.
 */
CT_API ct_status ct_output_restart_probes(const char *path, const ct_state *state,
                                          ct_probes *probes, ct_error *error);

CT_END_DECLS

#endif
