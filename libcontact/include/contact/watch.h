#ifndef CONTACT_WATCH_H
#define CONTACT_WATCH_H

#include <contact/step.h>

CT_BEGIN_DECLS

/** What a watch looks for, and how often. */
typedef struct ct_watch_options {
  /** Steps between two looks, >= 1: the state is looked at whenever its number of steps is a
   * multiple of this. */
  int64_t every;
  /**
   * Energy that may appear from nothing over the energy that should be there, :eq:`energy-appears`,
   * > 0; infinite: energy is not watched.
   */
  double energy_limit;
  /**
   * Largest ω Δt of the motion of the solid alone, :eq:`step-quotient`, > 0, as for central
   * differences: 2 is the limit of every integrator; infinite: stiffening is not watched.
   */
  double omega_limit;
  /** The stable step at the start [time], where the caller knows it; 0: it is asked when the watch
   * is made. */
  double stable;
  /**
   * Spurious energy over the energy that should be there, from which on `ct_watch_growth` reports
   * it, :eq:`energy-growth`, >= 0; the run goes on.
   */
  double growth_limit;
} ct_watch_options;

/** Every 1024 steps; as much energy again as should be there; ω Δt up to 2; growth is reported from
 * 1 % on. */
CT_API ct_watch_options ct_watch_options_default(void);

/** Looks at one state while it is stepped, and keeps a copy of the last state that was good;
 * opaque. */
typedef struct ct_watch ct_watch;

/**
 * A watch over a state of the problem, which is its first good state. The problem must outlive it.
 * ``CT_ERROR_ARGUMENT``: an option out of range; what the forces of the state fail with is
 * returned, too.
 */
CT_API ct_status ct_watch_create(const ct_problem *problem, ct_state *state,
                                 const ct_watch_options *options, ct_watch **watch,
                                 ct_error *error);

/** Free a watch; null is allowed. */
CT_API void ct_watch_free(ct_watch *watch);

/**
 * Like `ct_step_many`, with a look at every multiple of `every`; the bits of the state are the
 * same. An error names the time, the step, and the body with its element or node:
 * ``CT_ERROR_GEOMETRY`` (an element is turned inside out), ``CT_ERROR_BLOWUP`` (not finite),
 * ``CT_ERROR_STEP`` (the solid has become too stiff for Δt), ``CT_ERROR_ENERGY`` (energy appears),
 * or what else an effect fails with.
 */
CT_API ct_status ct_watch_steps(ct_watch *watch, ct_state *state, int64_t count, ct_error *error);

/** Look at once, at any step; with CT_OK the state is the last good one. Errors as above. */
CT_API ct_status ct_watch_look(ct_watch *watch, ct_state *state, ct_error *error);

/**
 * The last good state, which belongs to the watch; the next look changes it. Null for a null watch,
 * or without memory for its forces.
 */
CT_API ct_state *ct_watch_good(const ct_watch *watch);

/** Spurious energy growth, as it was at the first look that found more than `growth_limit`. */
typedef struct ct_growth {
  /** Spurious energy over the energy that should be there, :eq:`energy-growth`; 0 as long as no
   * look has found too much. */
  double share;
  /** Time of the look [time]. */
  double time;
  /** Its number of steps. */
  int64_t step;
  /** Number of the effect of the problem whose work and store have grown most. */
  int32_t effect;
  /** The body with the node of the largest kinetic energy. */
  int32_t body;
} ct_growth;

/** The growth that was found since the watch was made; zeros for a null watch, or as long as no
 * look has found too much. */
CT_API ct_growth ct_watch_growth(const ct_watch *watch);

/**
 * Largest ω² of the solid that the watch has found in its last look [1 / time²], a lower bound of
 * the true one; 0 where no body can stiffen.
 */
CT_API double ct_watch_omega_squared(const ct_watch *watch);

CT_END_DECLS

#endif
