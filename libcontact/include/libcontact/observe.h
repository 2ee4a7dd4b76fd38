/* A run, and what observes it: probes, the monitor, which checks the state, and a host's own
 * observers.
 * Threads: one call at a time per state, per set of probes and per monitor. */
#ifndef LIBCONTACT_OBSERVE_H
#define LIBCONTACT_OBSERVE_H

#include <libcontact/ledger.h>

CT_BEGIN_DECLS

/**
 * What an observer does, :doc:`/develop/observers`. Calls that do not apply are null; none of them
 * changes the state.
 */
typedef struct ct_observer_calls {
  /** Before the first of `count` steps: here an observer allocates. An error ends the run. */
  ct_status (*prepare)(void *data, const ct_problem *problem, ct_state *state, int64_t count,
                       ct_error *error);
  /**
   * Within the step that begins at t_n, as soon as the forces f_n are known and before the nodes
   * move. Nodes that sleep, :eq:`sleep`, have the displacement of the last check.
   */
  void (*sample)(void *data, const ct_state *state);
  /** After a step. All calls that read a state are allowed, such as `ct_energy_of` and
   * `ct_output_append`. An error ends the run. */
  ct_status (*check)(void *data, ct_state *state, ct_error *error);
} ct_observer_calls;

/** An observer of a run. */
typedef struct ct_observer {
  /** Its calls. */
  const ct_observer_calls *calls;
  /** Passed to its calls. */
  void *data;
  /** Steps between two calls, >= 1: it is called where the number of steps is a multiple of this.
   */
  int64_t every;
  /** Not zero: `check` is also called after the last step. */
  int last;
} ct_observer;

/** Quantities that a probe records; one number per row unless stated otherwise. */
typedef enum ct_quantity {
  /** t_n [time]; every row begins with it */
  CT_QUANTITY_TIME = 0,
  /** u_n [length], 3 numbers */
  CT_QUANTITY_DISPLACEMENT = 1,
  /** v_n, the mean of the two half steps [length / time], :eq:`stage-velocity`, 3 numbers */
  CT_QUANTITY_VELOCITY = 2,
  /** a_n, sum of all forces over the mass [length / time²], 3 numbers; 0 in directions of a support
   */
  CT_QUANTITY_ACCELERATION = 3,
  /** xx yy zz xy yz zx at the centre of the element [stress], 6 numbers */
  CT_QUANTITY_STRESS = 4,
  /** minus the mean of xx, yy, zz [stress] */
  CT_QUANTITY_PRESSURE = 5,
  /** Σ f_n of the effects on the nodes [force], :eq:`probe-resultant`, 3 numbers */
  CT_QUANTITY_FORCE = 6,
  /** Σ x_n × f_n about the origin [force · length], :eq:`probe-resultant`, 3 numbers */
  CT_QUANTITY_MOMENT = 7
} ct_quantity;

/**
 * A probe: the quantities that it records during a run, where, and how often. Start from
 * `ct_probe_def_default`. All arrays are copied.
 */
typedef struct ct_probe_def {
  /** Set by `ct_probe_def_default`. */
  int32_t cookie;
  /** Name of its table in a results file: 1 to 63 bytes, no slash. */
  const char *name;
  /** For each `ct_quantity` whether it is recorded (0 or 1); the time always is. */
  int take[8];
  /** Steps between two rows, >= 1: rows are recorded at the steps whose number it divides. */
  int64_t every;
  /**
   * Nodes of the problem, ascending. The motion of several nodes is that of their centre of mass,
   * :eq:`probe-mean`. For forces these are the nodes over which forces are summed; null then means
   * all nodes on which the effects act.
   */
  const int32_t *nodes;
  /** Number of nodes. */
  int32_t node_count;
  /** Body and element (of that body) for stress and pressure. */
  int32_t body;
  /** Number of the element; -1: none. */
  int32_t element;
  /** Effects of the problem whose forces are summed, such as a contact and its friction. */
  const int32_t *effects;
  /** Number of effects. */
  int32_t effect_count;
  /** Which components x, y, z of a force are summed (0 or 1): all three, or those that one support
   * prescribes. */
  int axes[3];
} ct_probe_def;

/** Every step, all axes, and no quantity; the caller sets the rest. */
CT_API ct_probe_def ct_probe_def_default(void);

/** Probes with their histories, to which the time loop appends rows; opaque. */
typedef struct ct_probes ct_probes;

/** The history of one probe so far; `ct_probes_history` writes all members. */
typedef struct ct_probe_history {
  /** Its name. */
  const char *name;
  /** Number of doubles in a row. */
  int32_t width;
  /** First column of each `ct_quantity` in a row; -1: not recorded. */
  int32_t column[8];
  /** Number of rows. */
  int64_t row_count;
  /** Rows in the order of time, shape (row_count, width); owned by the probes and valid until the
   * next call. */
  const double *rows;
} ct_probe_history;

/**
 * Create probes for the states of a problem, which must outlive them. They belong to one run, that
 * is to one state at a time. ``CT_ERROR_ARGUMENT``: an invalid definition (`error` names it).
 */
CT_API ct_status ct_probes_create(const ct_problem *problem, const ct_probe_def *defs,
                                  int32_t count, ct_probes **probes, ct_error *error);

/** Free probes and their histories; null is allowed. */
CT_API void ct_probes_free(ct_probes *probes);

/** The observer that records rows: every step, as each probe has its own `every`. */
CT_API ct_observer ct_probes_observer(ct_probes *probes);

/** Record the rows of the present state, for example after the last step. A row that exists is not
 * recorded again. */
CT_API ct_status ct_probes_sample(ct_probes *probes, ct_state *state, ct_error *error);

/** The history of one probe. ``CT_ERROR_ARGUMENT``: unknown probe. */
CT_API ct_status ct_probes_history(const ct_probes *probes, int32_t probe,
                                   ct_probe_history *history, ct_error *error);

/**
 * Continue with a problem whose step is Δt divided by `parts`, after `ct_state_subdivide_step`:
 * a row is recorded every `parts` times as many steps. Rows later than the next state are dropped.
 * ``CT_ERROR_ARGUMENT``: the problems differ, or `parts` < 1.
 */
CT_API ct_status ct_probes_subdivide_step(ct_probes *probes, const ct_problem *problem,
                                          int64_t parts, ct_error *error);

/** Replace the history of one probe by these rows, to continue a run; the rows are copied. */
CT_API ct_status ct_probes_restore(ct_probes *probes, int32_t probe, const double *rows,
                                   int64_t count, ct_error *error);

/** What a monitor checks, and how often. Start from `ct_monitor_options_default`. */
typedef struct ct_monitor_options {
  /** Set by `ct_monitor_options_default`. */
  int32_t cookie;
  /** Steps between two checks, >= 1: the state is checked whenever its number of steps is a
   * multiple of this. */
  int64_t every;
  /**
   * Largest allowed ratio of spurious energy to the energy that the bodies should have [-],
   * :eq:`energy-appears`, > 0; infinite: energy is not monitored.
   */
  double energy_limit;
  /**
   * Largest allowed ω Δt of the motion of the solid alone [-], :eq:`step-quotient`, > 0. It is
   * scaled as for central differences, so that 2 is the limit of every integrator. Infinite:
   * stiffening is not monitored.
   */
  double omega_limit;
  /** The stable step at the start [time], if the caller knows it; 0: `ct_monitor_create` computes
   * it. */
  double stable;
  /**
   * Ratio of spurious energy to the energy that the bodies should have, above which
   * `ct_monitor_growth` reports it [-], :eq:`energy-growth`, >= 0, or five times as much after a
   * loss, :eq:`growth-again`; the run continues.
   */
  double growth_limit;
  /** Total energy [energy] from which growth counts, :eq:`energy-growth`, of a run that goes on
   * with another step, :eq:`divided-energy`; NaN: that of the state. */
  double first_total;
} ct_monitor_options;

/** Checks every 1024 steps; limits: spurious energy as large as the energy that the bodies should
 * have, and ω Δt = 2; spurious growth is reported above 0.2 %. */
CT_API ct_monitor_options ct_monitor_options_default(void);

/** Checks one state during a run and stores a copy of the last good state, that is the last one
 * that passed the check; opaque. */
typedef struct ct_monitor ct_monitor;

/**
 * Create a monitor of a state of the problem; the state is its first good state. The problem must
 * outlive it. ``CT_ERROR_ARGUMENT``: an option out of range. Errors of the forces of the state are
 * returned, too.
 */
CT_API ct_status ct_monitor_create(const ct_problem *problem, ct_state *state,
                                   const ct_monitor_options *options, ct_monitor **monitor,
                                   ct_error *error);

/** Free a monitor; null is allowed. */
CT_API void ct_monitor_free(ct_monitor *monitor);

/** The observer that checks the state, every `every` steps of the options. */
CT_API ct_observer ct_monitor_observer(ct_monitor *monitor);

/** Check the state now. After CT_OK this is the last good state. Errors as `ct_run`. */
CT_API ct_status ct_monitor_check(ct_monitor *monitor, ct_state *state, ct_error *error);

/**
 * The last good state, owned by the monitor; the next check changes it. Null for a null monitor, or
 * if there is not enough memory for its forces.
 */
CT_API ct_state *ct_monitor_good(const ct_monitor *monitor);

/**
 * The row of the energy balance of the last good state, with both arrays; owned by the monitor, and
 * the next check changes it. Null for a null monitor.
 */
CT_API const ct_ledger *ct_monitor_ledger(const ct_monitor *monitor);

/** Spurious energy growth at the first check that found more than `growth_limit`;
 * `ct_monitor_growth` writes all members. */
typedef struct ct_growth {
  /** Ratio of spurious energy to the energy that the bodies should have [-], :eq:`energy-growth`; 0
   * if no check has found more than the limit. */
  double ratio;
  /** The largest ratio of all checks so far [-]; 0 as above. */
  double largest;
  /** Time of the check [time]. */
  double time;
  /** Its number of steps. */
  int64_t step;
  /** Number of the effect whose work and stored energy have grown most. */
  int32_t effect;
  /** The body with the node of the largest kinetic energy. */
  int32_t body;
} ct_growth;

/** Spurious growth since the monitor was created; zeros for a null monitor, or if no check has
 * found more than the limit. */
CT_API ct_growth ct_monitor_growth(const ct_monitor *monitor);

/**
 * Take `count` steps; `observers` has the shape (observer_count) and may be null without any. They
 * are called in their order. If the caller does not change the state between two calls with a
 * monitor, of which the first ends with a check, sleeping elements, :eq:`sleep`, stay asleep. Rows
 * of probes that are later than the state, for example after a restart, are removed first.
 * ``CT_ERROR_BLOWUP``: the state is no longer finite; the remaining steps are not taken. Errors of
 * observers: for probes ``CT_ERROR_MEMORY``, not enough memory for the rows, no step was taken; for
 * a monitor ``CT_ERROR_GEOMETRY``: an inverted element; ``CT_ERROR_STEP``: the solid has become too
 * stiff for Δt; ``CT_ERROR_ENERGY``: spurious energy growth. `error` names the time, the step, and
 * the body with its element or node. ``CT_ERROR_ARGUMENT``: an observer without calls, with `every`
 * < 1, or of another problem.
 */
CT_API ct_status ct_run(const ct_problem *problem, ct_state *state, int64_t count,
                        const ct_observer *observers, int32_t observer_count, ct_error *error);

CT_END_DECLS

#endif
