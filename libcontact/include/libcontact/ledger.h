/* Energies, work, impulse and momentum of a state.
 * Threads: one call at a time per state. */
#ifndef LIBCONTACT_LEDGER_H
#define LIBCONTACT_LEDGER_H

#include <libcontact/step.h>

CT_BEGIN_DECLS

/**
 * Energy of all bodies at t_n, in the discrete form that the leapfrog scheme conserves,
 * :eq:`discrete-energy`, and the work of the effects, :eq:`work-balance`. All [energy].
 */
typedef struct ct_energy {
  /** t_n [time]. */
  double time;
  /** ½ v_{n-1/2} · M v_{n+1/2}. */
  double kinetic;
  /** Stored by the effect "solid". */
  double strain;
  /** Stored by all effects "contact". */
  double contact;
  /** Held by the points of all contacts and obstacles until they open, :eq:`impact-reserve`, half a
   * step after t_n; a part of their stored energy. */
  double reserve;
  /** Work done by supports and loads since t = 0. */
  double external;
  /** kinetic + strain + contact - external: constant for linear forces. */
  double total;
  /** kinetic(t_n) - kinetic(0) - Σ work of every effect: zero to round-off for any forces,
   * :eq:`work-balance`. */
  double balance;
} ct_energy;

/** Momentum of one body at t_n, from the mean of v_{n-1/2} and v_{n+1/2}. */
typedef struct ct_momentum {
  /** t_n [time]. */
  double time;
  /** Number of the body. */
  int32_t body;
  /** Linear momentum [mass · length / time]. */
  double p[3];
  /** Angular momentum about the origin [mass · length² / time]. */
  double L[3];
  /** Impulse of the contacts and ties on the body since t = 0 [mass · length / time],
   * :eq:`impulse-balance`. */
  double contact_impulse[3];
  /** Impulse of the obstacles on the body since t = 0 without their friction [mass · length /
   * time]. */
  double obstacle_impulse[3];
  /** Impulse of the supports on the body since t = 0 [mass · length / time]. */
  double support_impulse[3];
} ct_momentum;

/** Energy of one effect at t_n. All [energy]. */
typedef struct ct_effect_energy {
  /** Its work since t = 0. */
  double work;
  /** Its stored energy; 0 for an effect without `energy`. */
  double stored;
  /** Its external work since t = 0; 0 for an effect without `external`. */
  double external;
} ct_effect_energy;

/** One row of the energy balance. It takes one pass over all nodes, and one over the nodes of each
 * effect except the first. */
typedef struct ct_ledger {
  /** Energies of all bodies, as `ct_energy_of` gives them. */
  ct_energy energy;
  /** Null, or the momenta of the bodies, shape (body_count). */
  ct_momentum *momentum;
  /** Null, or the energies of the effects, shape (effect_count). */
  ct_effect_energy *effects;
} ct_ledger;

/**
 * Compute a row at the state's time; evaluates the forces there if `ct_step` has not. The caller
 * provides the two arrays, or null. ``CT_ERROR_BLOWUP``: the row is not finite (`error` names body
 * and node if the motion is not finite). After an error only the arrays may have changed.
 */
CT_API ct_status ct_ledger_of(const ct_problem *problem, ct_state *state, ct_ledger *ledger,
                              ct_error *error);

/** Energies at the state's time; evaluates the forces there if `ct_step` has not. */
CT_API ct_status ct_energy_of(const ct_problem *problem, ct_state *state, ct_energy *energy,
                              ct_error *error);

/** Work of one effect since t = 0 [energy]. */
CT_API ct_status ct_energy_work(const ct_problem *problem, ct_state *state, int32_t effect,
                                double *work, ct_error *error);

/** Stored energy of one effect at the state's time [energy]. */
CT_API ct_status ct_energy_stored(const ct_problem *problem, ct_state *state, int32_t effect,
                                  double *energy, ct_error *error);

/**
 * Distance of the state from static equilibrium [-], :eq:`residual`: the larger of two ratios. The
 * first is the largest unbalanced nodal force divided by the largest nodal force of any effect; the
 * second is the square root of kinetic energy divided by stored energy. 0 if there is neither
 * motion nor force, infinite if there is motion but no stored energy.
 */
CT_API ct_status ct_energy_residual(const ct_problem *problem, ct_state *state, double *residual,
                                    ct_error *error);

/**
 * Impulse of one effect, not the first, on all nodes since t = 0 [mass · length / time],
 * :eq:`impulse-balance`. An obstacle receives the opposite impulse.
 */
CT_API ct_status ct_energy_impulse(const ct_problem *problem, ct_state *state, int32_t effect,
                                   double impulse[3], ct_error *error);

/** Momentum of one body. */
CT_API ct_status ct_momentum_of(const ct_problem *problem, ct_state *state, int32_t body,
                                ct_momentum *momentum, ct_error *error);

CT_END_DECLS

#endif
