/* The state of a problem, which changes; time steps, and the largest stable step.
 * Threads: one call at a time per state; several states of one problem may be stepped at the same
 * time. One step may itself use several threads (`settings` of the problem), with the same results
 * bit by bit. */
#ifndef LIBCONTACT_STEP_H
#define LIBCONTACT_STEP_H

#include <libcontact/problem.h>

CT_BEGIN_DECLS

/**
 * Everything that changes during a run. A restart needs `step`, `time`, `kinetic_start`, and the
 * arrays `displacement`, `velocity`, `work`, `impulse` and `memory`; a run that continues from a
 * copy of them has the same results bit by bit.
 */
typedef struct ct_state {
  /** The problem that it belongs to. */
  const ct_problem *problem;
  /** Number n of the next step, and its time t_n = n Δt [time]. */
  int64_t step;
  /** t_n [time]. */
  double time;
  /** Nodes of all bodies. */
  int32_t node_count;
  /** u_n [length], shape (node_count, 3); written by `ct_step`. */
  double *displacement;
  /** v_{n-1/2} [length / time], the velocity before this evaluation, :eq:`stage`, shape
   * (node_count, 3); written by `ct_step`. */
  double *velocity;
  /** Number of doubles in `work`. */
  int64_t work_count;
  /**
   * For each effect except reactions, at each of its nodes and components: the sum of f_j ·
   * (v_{j-1/2} + v_{j+1/2}) over the past steps, that is its work divided by Δt / 2,
   * :eq:`work-balance`; with the weights of the stages, :eq:`stage-work`. Written by `ct_step`.
   */
  double *work;
  /** Number of doubles in `impulse`. */
  int64_t impulse_count;
  /**
   * For each effect except the first, at each of its nodes and components: the sum of f_j, that is
   * its impulse divided by Δt, :eq:`impulse-balance`. It has two parts of equal shape,
   * :eq:`impulse-parts`: the sum since the last step whose number is a multiple of 256, and the sum
   * up to that step. Written by `ct_step`.
   */
  double *impulse;
  /** Kinetic energy at t = 0 [energy]. */
  double kinetic_start;
  /** Number of doubles in `memory`. */
  int64_t memory_count;
  /**
   * Memory of the effects, one after another, and then, for Chung and Lee, the acceleration at
   * t_{n-1}, shape (node_count, 3) [length / time²], :eq:`chung-lee-drift`.
   */
  double *memory;
  /**
   * Time spent so far in the forces of each effect, and in a last entry in the rest of the time
   * loop [seconds], shape (effect_count + 1); zero without the run's clock. Not part of a
   * restart; written by `ct_step`.
   */
  double *effect_seconds;
  /**
   * Number of steps so far in which the constraint forces, :eq:`constraint-problem`, did not
   * converge to their tolerance within 2000 iterations; the last iterate is used then.
   * Not part of a restart; written by `ct_step`.
   */
  int64_t unconverged;
  /**
   * Cost of the constraint solver so far: iterations of :eq:`proportioning` times number of
   * constraints, summed over the steps. Not part of a restart; written by `ct_step`.
   */
  int64_t constraint_rounds;
  /**
   * Number of element forces that the solid effect has computed so far, and number of those skipped
   * because the element was asleep, :eq:`sleep`, summed over all evaluations. Not part of a
   * restart; written by `ct_step`.
   */
  int64_t element_updates[2];
  /** Forces and scratch space of the current step; not part of a restart. */
  struct ct_workspace *workspace;
} ct_state;

/** The stable step and its components; `ct_stable` writes all members. */
typedef struct ct_stable_step {
  /**
   * Largest stable Δt with all effects [time]: 2 / sqrt(Σ ω²), :eq:`step-bound`; with damping or
   * other integrators :eq:`integrator-damped-bound`.
   */
  double dt;
  /** The same without contacts, obstacles and their friction [time]. */
  double dt_without_contact;
  /** Smallest ratio of the shortest element edge to c₁ over all bodies [time]: Courant number 1. */
  double dt_courant;
} ct_stable_step;

/** Create a state at t = 0 with zero displacement, and evaluate the first forces. */
CT_API ct_status ct_state_create(const ct_problem *problem, ct_state **state, ct_error *error);

/**
 * Copy what a restart needs. ``CT_ERROR_ARGUMENT``: the states belong to different problems, or
 * `from` is within a step (see `ct_step`).
 */
CT_API ct_status ct_state_copy(const ct_problem *problem, const ct_state *from, ct_state *to,
                               ct_error *error);

/**
 * Continue with a smaller step: write `to`, a state of `problem`, from a state of a problem that
 * differs only in its Δt, which must be a whole multiple of that of `problem`. Displacement,
 * velocity at t_n, work and impulse do not change, :eq:`step-change`; with equal Δt it is a copy.
 * ``CT_ERROR_ARGUMENT``: the problems differ in more than Δt, or Δt is not a whole multiple. After
 * an error the content of `to` is undefined, but `ct_state_copy` can overwrite it.
 */
CT_API ct_status ct_state_subdivide_step(const ct_problem *problem, ct_state *from, ct_state *to,
                                         ct_error *error);

/** Free a state; null is allowed. The problem must outlive its states. */
CT_API void ct_state_free(ct_state *state);

/**
 * One step of the problem's integrator, :eq:`stage`; the central difference method is
 * :eq:`leapfrog`. If the forces of a second stage fail, the state is left within a step. Then only
 * `ct_state_copy` into it and `ct_state_free` are allowed; every other call returns
 * ``CT_ERROR_ARGUMENT``.
 */
CT_API ct_status ct_step(const ct_problem *problem, ct_state *state, ct_error *error);

/**
 * Contribution of one effect to the bound of the step in this state: ω² [1 / time²] and its damping
 * rate [1 / time], :eq:`damped-step-bound`; 0 if the effect has no such bound.
 */
CT_API ct_status ct_stable_contribution(const ct_problem *problem, ct_state *state, int32_t effect,
                                        double *omega_squared, double *rate, ct_error *error);

/**
 * Largest stable step of the problem in this state; a null `state` means t = 0. It uses an upper
 * bound of ω² of the elements plus that of the contact points, so it does not exceed the true limit
 * of the linear problem, :eq:`step-bound`.
 */
CT_API ct_status ct_stable(const ct_problem *problem, ct_state *state, ct_stable_step *out,
                           ct_error *error);

/** Velocity at t_n, ½ (v_{n-1/2} + v_{n+1/2}) [length / time], shape (node_count, 3). */
CT_API ct_status ct_state_velocity(const ct_problem *problem, ct_state *state, double *velocity,
                                   ct_error *error);

/** Velocity at t_n of `count` nodes from `first` on [length / time], shape (count, 3). */
CT_API ct_status ct_state_velocity_at(const ct_problem *problem, ct_state *state, int32_t first,
                                      int32_t count, double *velocity, ct_error *error);

/** Force of one effect at t_n on the problem's nodes [force], shape (node_count, 3); zero where it
 * does not act. */
CT_API ct_status ct_state_force(const ct_problem *problem, ct_state *state, int32_t effect,
                                double *force, ct_error *error);

CT_END_DECLS

#endif
