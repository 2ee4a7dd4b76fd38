#ifndef CONTACT_ENERGY_H
#define CONTACT_ENERGY_H

#include <contact/step.h>

CT_BEGIN_DECLS

/**
 * Energy of all bodies at t_n, in the discrete form that the leapfrog scheme conserves,
 * :eq:`discrete-energy`, and what each effect has done, :eq:`work-balance`. All [energy].
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
  /** Work done by supports and loads since t = 0. */
  double external;
  /** kinetic + strain + contact - external: constant for linear forces. */
  double total;
  /** kinetic(t_n) - kinetic(0) - Σ work of every effect: zero to round-off, always. */
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
  /** Impulse of the contacts on the body since t = 0 [mass · length / time], :eq:`impulse-balance`.
   */
  double contact_impulse[3];
  /** Impulse of the supports on the body since t = 0 [mass · length / time]. */
  double support_impulse[3];
} ct_momentum;

/** Energies at the state's time (evaluates the forces there if `ct_step` has not). */
CT_API ct_status ct_energy_of(const ct_problem *problem, ct_state *state, ct_energy *energy,
                              ct_error *error);

/** Work of one effect since t = 0 [energy]. */
CT_API ct_status ct_energy_work(const ct_problem *problem, ct_state *state, int32_t effect,
                                double *work, ct_error *error);

/** Stored energy of one effect at the state's time [energy]. */
CT_API ct_status ct_energy_stored(const ct_problem *problem, ct_state *state, int32_t effect,
                                  double *energy, ct_error *error);

/**
 * How far the state is from rest, :eq:`unrest`: the larger of the largest nodal force that is not
 * balanced over the largest nodal force of any effect, and the root of the kinetic over the stored
 * energy. 0 where nothing moves and no force acts, infinite where something moves and nothing is
 * stored.
 */
CT_API ct_status ct_energy_unrest(const ct_problem *problem, ct_state *state, double *unrest,
                                  ct_error *error);

/**
 * Impulse of one effect but the first on all nodes since t = 0 [mass · length / time],
 * :eq:`impulse-balance`. What an obstacle has received is minus this.
 */
CT_API ct_status ct_energy_impulse(const ct_problem *problem, ct_state *state, int32_t effect,
                                   double impulse[3], ct_error *error);

/** Momentum of one body. */
CT_API ct_status ct_momentum_of(const ct_problem *problem, ct_state *state, int32_t body,
                                ct_momentum *momentum, ct_error *error);

/** Velocity at t_n, ½ (v_{n-1/2} + v_{n+1/2}) [length / time], shape (node_count, 3). */
CT_API ct_status ct_state_velocity(const ct_problem *problem, ct_state *state, double *velocity,
                                   ct_error *error);

/** Force of one effect at t_n on the problem's nodes [force], shape (node_count, 3); zero where it
 * does not act. */
CT_API ct_status ct_state_force(const ct_problem *problem, ct_state *state, int32_t effect,
                                double *force, ct_error *error);

CT_END_DECLS

#endif
