#ifndef CONTACT_STEP_H
#define CONTACT_STEP_H

#include <contact/effect.h>
#include <contact/integrator.h>
#include <contact/material.h>
#include <contact/mesh.h>

CT_BEGIN_DECLS

/** One body of a problem. */
typedef struct ct_body {
  /** A name for people, ended by a zero byte. */
  char name[64];
  /** Its nodes and elements. */
  const ct_mesh *mesh;
  /** What it is made of. */
  ct_material material;
  /** Its nodes are first_node ... first_node + mesh->node_count - 1 of the problem. */
  int32_t first_node;
} ct_body;

/**
 * All that stays fixed during a run. `ct_scene_build` makes one; a host may fill one by hand.
 * The nodes of all bodies stand one after another.
 */
typedef struct ct_problem {
  /** Nodes of all bodies. */
  int32_t node_count;
  /** Number of bodies. */
  int32_t body_count;
  /** The bodies, in the order of their nodes. */
  const ct_body *bodies;
  /** Reference coordinates X [length], shape (node_count, 3). */
  const double *reference;
  /** Lumped mass [mass], shape (node_count). */
  const double *mass;
  /**
   * One over the mass of each degree of freedom, shape (node_count, 3) [1 / mass]; 0 where a
   * support prescribes a constant velocity, which the leapfrog then keeps.
   */
  const double *inverse_mass;
  /** Velocity at t = 0 [length / time], shape (node_count, 3). */
  const double *initial_velocity;
  /** The effects; the first one acts on all nodes (usually "solid"). */
  int32_t effect_count;
  /** The list of them, shape (effect_count). */
  const ct_effect *const *effects;
  /** Time step Δt [time]. */
  double dt;
  /** Threads, >= 1; results do not depend on it. */
  int threads;
  /**
   * Null, or a clock [seconds] with which the time loop measures what each effect costs
   * (`effect_seconds` of the state); results do not depend on it.
   */
  double (*clock)(void);
  /** The method of the time steps; all bytes zero: central difference. */
  ct_integrator integrator;
  /**
   * Not zero: linear bodies are bounded by `ct_stable_assembled` where that allows a larger step;
   * it costs some 70 forces once.
   */
  int assembled;
} ct_problem;

/**
 * All that moves. Everything that a restart needs is `step`, `time`, `kinetic_start`, and the
 * arrays `displacement`, `velocity`, `work`, `impulse` and `memory`; a copy of them continues with
 * the same bits.
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
  /** v_{n-1/2} [length / time], the velocity before the kick, :eq:`stage`, shape (node_count, 3);
   * written by `ct_step`. */
  double *velocity;
  /** Doubles in `work`. */
  int64_t work_count;
  /**
   * For each effect in turn that is no reaction, at each of its nodes and components: the sum over
   * the past steps of f_j · (v_{j-1/2} + v_{j+1/2}), its work divided by Δt / 2,
   * :eq:`work-balance`; with the weights of the stages, :eq:`stage-work`.
   */
  double *work;
  /** Doubles in `impulse`. */
  int64_t impulse_count;
  /**
   * For each effect but the first, likewise: the sum of f_j, its impulse divided by Δt,
   * :eq:`impulse-balance`. In two parts, :eq:`impulse-parts`: what came since the step number was a
   * multiple of 256, and in a second half of the same shape what had come by then.
   */
  double *impulse;
  /** Kinetic energy at t = 0 [energy]. */
  double kinetic_start;
  /** Doubles in `memory`. */
  int64_t memory_count;
  /**
   * Memory of the effects, one after another; then, for Chung and Lee, the acceleration at t_{n-1},
   * shape (node_count, 3) [length / time²], :eq:`chung-lee-drift`.
   */
  double *memory;
  /**
   * Seconds spent in the forces of each effect so far, and after them in the rest of the time loop,
   * shape (effect_count + 1); zero without the problem's clock. Not part of a restart; written by
   * `ct_step`.
   */
  double *effect_seconds;
  /**
   * Steps in which the forces of the constraints, :eq:`constraint-problem`, did not settle to 1e-10
   * of the largest within 500 rounds, so far; the last of them is used then. Not part of a restart;
   * written by `ct_step`.
   */
  int64_t unsettled;
  /**
   * Work of the search for the forces of the constraints so far: rounds of
   * :eq:`constraint-iteration` times the constraints that they went over, summed over the steps.
   * Not part of a restart.
   */
  int64_t constraint_rounds;
  /**
   * Elements whose forces the first effect has computed so far, and those that it has left out as
   * quiet, :eq:`quiet-batch`, summed over all evaluations. Not part of a restart.
   */
  int64_t element_updates[2];
  /** Forces and scratch space of the current step; not part of a restart. */
  struct ct_workspace *workspace;
} ct_state;

/** The stable step that is reported, and what it is made of. */
typedef struct ct_stable_step {
  /**
   * Largest stable Δt with all effects [time]: 2 / sqrt(Σ ω²), :eq:`step-bound`, or with damping
   * and other integrators :eq:`integrator-damped-bound`.
   */
  double dt;
  /** The same without contacts, obstacles and their friction [time]. */
  double dt_without_contact;
  /** Shortest element edge over the fastest c₁ of the same body [time]: Courant number 1. */
  double dt_courant;
} ct_stable_step;

/** A state at t = 0 with zero displacement; evaluates the first forces. */
CT_API ct_status ct_state_create(const ct_problem *problem, ct_state **state, ct_error *error);

/**
 * Copy what a restart needs. Both states must belong to the same problem. ``CT_ERROR_ARGUMENT``:
 * they don't, or `from` stands within a step.
 */
CT_API ct_status ct_state_copy(const ct_problem *problem, const ct_state *from, ct_state *to,
                               ct_error *error);

/**
 * Go on with a smaller step: make `to`, a state of `problem`, from a state of a problem that is the
 * same but for its Δt, which is a whole number of times that of `problem`. Displacement, velocity
 * at t_n, work and impulse stay what they are, :eq:`step-change`; with the same Δt it is a copy.
 * ``CT_ERROR_ARGUMENT``: the problems differ, or Δt is no such part. After an error `to` may hold
 * anything that `ct_state_copy` can overwrite.
 */
CT_API ct_status ct_state_refine(const ct_problem *problem, ct_state *from, ct_state *to,
                                 ct_error *error);

/** Free a state; null is allowed. The problem must outlive its states. */
CT_API void ct_state_free(ct_state *state);

/**
 * One step of the problem's integrator, :eq:`stage`; the central difference method is
 * :eq:`leapfrog`. When the forces of a second stage fail, the state stands within a step: then
 * every call but `ct_state_copy` into it and `ct_state_free` answers
 * ``CT_ERROR_ARGUMENT``; also one that copies from it.
 */
CT_API ct_status ct_step(const ct_problem *problem, ct_state *state, ct_error *error);

/** `count` steps; ends early with ``CT_ERROR_BLOWUP`` (body, node and time in `error`) when the
 * state stops being finite. */
CT_API ct_status ct_step_many(const ct_problem *problem, ct_state *state, int64_t count,
                              ct_error *error);

/**
 * What one effect adds to the bound of the step in this state: ω² [1 / time²] and the rate of its
 * damping [1 / time], :eq:`damped-step-bound`; 0 where it says nothing.
 */
CT_API ct_status ct_stable_share(const ct_problem *problem, ct_state *state, int32_t effect,
                                 double *omega_squared, double *rate, ct_error *error);

/**
 * Upper bound of the largest ω² of all bodies together, held as they are [1 / time²],
 * :eq:`assembled-bound`: Lanczos' method from a random start, which is the same in every call, with
 * a margin of 6 %; for one start in 10¹² it is too low.
 * ``CT_ERROR_UNSUPPORTED``: a body is not linear.
 */
CT_API ct_status ct_stable_assembled(const ct_problem *problem, ct_state *state,
                                     double *omega_squared, ct_error *error);

/**
 * Largest stable step of the problem in this state (a null `state`: at t = 0).
 * An upper bound of ω² of each element plus the bound of the contact points, so never above the
 * true limit of the linear problem.
 */
CT_API ct_status ct_stable(const ct_problem *problem, ct_state *state, ct_stable_step *out,
                           ct_error *error);

CT_END_DECLS

#endif
