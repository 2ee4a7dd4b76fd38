/* Results files and restart (HDF5), in the add-on library libcontact-hdf5.
 * Threads: one call at a time in the whole process, for all files together, unless HDF5 itself was
 * built thread-safe. */
#ifndef LIBCONTACT_OUTPUT_H
#define LIBCONTACT_OUTPUT_H

#include <libcontact/observe.h>

/* Part of the add-on library libcontact-hdf5. Where that was built without HDF5, every status is
 * CT_ERROR_UNSUPPORTED, also ct_output_close with a null output. */

CT_BEGIN_DECLS

/** A results file that is open for writing; opaque. One thread at a time may use it. */
typedef struct ct_output ct_output;

/** Content of a results file. Start from `ct_output_options_default`. */
typedef struct ct_output_options {
  /** Set by `ct_output_options_default`. */
  int32_t cookie;
  /** Fields of each recorded step (0 or 1). A viewer needs the displacement to show the motion. */
  int displacement;
  int velocity;
  int stress;
  /** A text in UTF-8 that is stored in the file, for example the scene as TOML; may be null. */
  const char *scene;
  /** Field of the contact pressure at the nodes (0 or 1), `ct_state_pressure`. */
  int contact_pressure;
  /** Null, or probes of the run; each record also writes their rows up to its time. They must
   * outlive the output. */
  const ct_probes *probes;
  /**
   * Number of passes of the filter of output fields, 0 to 8. If it is not 0, each written
   * displacement, velocity and stress has a second field from `ct_filter_apply`, whose name ends in
   * ``_filtered``, and the group ``libcontact`` has the attribute ``filter``.
   */
  int filter;
} ct_output_options;

/** No fields, no text, no probes, no filter: the energy balance and the restart record alone. */
CT_API ct_output_options ct_output_options_default(void);

/**
 * Create a transient VTKHDF file (UnstructuredGrid, static points) for the problem. Until the first
 * step is written, the name of the file is `path` followed by ``.part``. Then it replaces an older
 * file `path`, so that a run that fails at the start does not destroy old results. The file is
 * locked until it is closed: a second output to `path`, in this process or another, is rejected. A
 * file left by a killed run does not block `path`. A link at the name with ``.part`` is replaced,
 * not followed. Errors: ``CT_ERROR_FILE``: the file can't be created (`error` gives the path and
 * the system's reason), or another run writes it; ``CT_ERROR_MEMORY``; ``CT_ERROR_ARGUMENT``: a
 * problem without bodies, or with bodies whose nodes do not follow one another;
 * ``CT_ERROR_UNSUPPORTED``: the loaded HDF5 is not the version that the library was compiled with.
 * `*output` is null after an error.
 */
CT_API ct_status ct_output_create(const char *path, const ct_problem *problem,
                                  const ct_output_options *options, ct_output **output,
                                  ct_error *error);

/**
 * Append the state as a time step: fields, rows of the energy balance, and the restart record, of
 * which the file keeps the newest. If a run is killed at any moment, also within this call, every
 * earlier step and one complete restart record stay readable. Errors: ``CT_ERROR_FILE``: a write
 * failed (`error` gives the path and the system's reason). After "No space left" the file contains
 * nothing of this step, and the call may be repeated; after any other failed write the output can
 * only be closed. ``CT_ERROR_BLOWUP``: the state is not finite (`error` names body and node) and
 * was not written. ``CT_ERROR_ARGUMENT``: the state belongs to another problem.
 */
CT_API ct_status ct_output_append(ct_output *output, const ct_problem *problem, ct_state *state,
                                  ct_error *error);

/**
 * `ct_output_append` with a row of the energy balance of this state that the caller already has,
 * with both its arrays, from `ct_monitor_ledger` or `ct_ledger_of`. If `row` is null, it is
 * computed. ``CT_ERROR_ARGUMENT``: also for a row without its arrays or of another time.
 */
CT_API ct_status ct_output_append_row(ct_output *output, const ct_problem *problem, ct_state *state,
                                      const ct_ledger *row, ct_error *error);

/**
 * The observer of `ct_run` that appends the state every `every` steps, and after the last step if
 * the caller sets `last`. The state at the start is not appended. Errors are those of
 * `ct_output_append`; without HDF5 `ct_run` returns them before the first step.
 */
CT_API ct_observer ct_output_observer(ct_output *output, int64_t every);

/**
 * Close the file and free `output`, also after an error; `output` may be null. ``CT_ERROR_FILE``: a
 * step or the last bytes could not be written. An output without a step leaves no file.
 */
CT_API ct_status ct_output_close(ct_output *output, ct_error *error);

/**
 * Read the newest complete restart record of a file into `state`, a state of `problem`. An error
 * leaves the state unchanged. ``CT_ERROR_FILE``: the file can't be read, has no complete record
 * (:eq:`restart-seal`), or belongs to another problem; `error` then names the first difference in
 * bodies, materials, effects, nodes or time step, which must be that of the record
 * (`ct_output_restart_step`).
 */
CT_API ct_status ct_output_restart(const char *path, const ct_problem *problem, ct_state *state,
                                   ct_error *error);

/**
 * The step of the newest complete restart record of a file [time]: that of the file, or a whole
 * fraction of it if the run has divided its step since, :eq:`record-step`. A problem that continues
 * the run must have this step. `problem` may have any step, and `state`, a state of it, does not
 * change. Errors are those of `ct_output_restart`.
 */
CT_API ct_status ct_output_restart_step(const char *path, const ct_problem *problem,
                                        const ct_state *state, double *dt, ct_error *error);

/**
 * After `ct_output_restart`: replace the histories of the probes by those in a file, up to the time
 * of the state, if name and quantities agree. The history of any other probe begins with the state.
 * ``CT_ERROR_FILE``: the file can't be read.
 */
CT_API ct_status ct_output_restart_probes(const char *path, const ct_state *state,
                                          ct_probes *probes, ct_error *error);

CT_END_DECLS

#endif
