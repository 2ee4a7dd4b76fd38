/* The interface of an effect; the problem, which is constant during a run, and the state, which
 * changes; time steps, stable step, energy, momentum, probes, and the monitor of a run.
 * Threads: one call at a time per state and per monitor; several states of one problem may be
 * stepped at the same time. One step may itself use several threads (ct_problem.threads), with the
 * same results bit by bit. */
#ifndef LIBCONTACT_STEP_H
#define LIBCONTACT_STEP_H

#include <libcontact/base.h>
#include <libcontact/mesh.h>
#include <libcontact/constraint.h>

CT_BEGIN_DECLS

/**
 * Input of the functions of an effect: the state of all bodies, one after another, at one time. The
 * time loop writes it. The effect may write only to `next_memory` and `scratch`.
 */
typedef struct ct_view {
  /** Time t_n [time]. */
  double time;
  /** Number of threads that the effect may use; results must not depend on it. */
  int threads;
  /** Reference coordinates X [length], shape (node_count, 3). */
  const double *reference;
  /** Displacement u_n [length], shape (node_count, 3). */
  const double *displacement;
  /**
   * Time until the next evaluation of the forces [time], Δt for most integrators. 0 at the start,
   * before v_{-1/2} is known, and before a step is chosen.
   */
  double dt;
  /** c Δt of :eq:`stage` [time]: the new velocity is `velocity` + `c_dt` times the sum of all
   * forces over the mass; 0 with `dt`. */
  double c_dt;
  /** r Δt [time]: nodes move by `dt` times (`velocity` + `r_dt` times the sum of all forces over
   * the mass + `l_dt` times `acceleration_before`), :eq:`stage`; 0 with `dt`. */
  double r_dt;
  /** l Δt [time]; 0 where `acceleration_before` is null. */
  double l_dt;
  /** Acceleration of the previous evaluation [length / time²], shape (node_count, 3), for
   * integrators that use it; otherwise null. */
  const double *acceleration_before;
  /**
   * In `force`: sum of the forces computed so far in this step; in `energy`: sum of all forces
   * [force], shape (node_count, 3).
   */
  const double *total;
  /**
   * Velocity half a step back, v_{n-1/2} [length / time], before this evaluation, shape
   * (node_count, 3).
   */
  const double *velocity;
  /** What the effect stored in step n - 1, shape (memory_count). */
  const double *memory;
  /** Where the effect stores what step n + 1 needs, shape (memory_count). */
  double *next_memory;
  /** Scratch space that `create_scratch` allocated for this state. */
  void *scratch;
  /** Scratch space of the effect that this one `reads`, as that effect's `force` left it at the
   * same time; null if it reads none. */
  const void *read;
} ct_view;

/**
 * Kind of an effect; it determines the types of its `data`, memory and scratch space. The library
 * decides by the kind, not by the label.
 */
typedef enum ct_effect_kind {
  /** an effect of a host */
  CT_EFFECT_USER = 0,
  /** internal forces of all bodies: `ct_solid_create_effect` */
  CT_EFFECT_SOLID = 1,
  /** energy of the hourglass control: `ct_solid_create_hourglass` */
  CT_EFFECT_HOURGLASS = 2,
  /** contact of two surfaces, or of one with itself: `ct_contact_create_effect` */
  CT_EFFECT_CONTACT = 3,
  /** `ct_friction_create_effect` */
  CT_EFFECT_FRICTION = 4,
  /** `ct_obstacle_create_effect` */
  CT_EFFECT_OBSTACLE = 5,
  /** prescribed constant velocities: `ct_support_create_effect` */
  CT_EFFECT_SUPPORT = 6,
  /** prescribed displacements, also with the label "support": `ct_motion_create_effect` */
  CT_EFFECT_MOTION = 7,
  /** `ct_load_create_effect` */
  CT_EFFECT_LOAD = 8,
  /** `ct_gravity_create_effect` */
  CT_EFFECT_GRAVITY = 9,
  /** `ct_damping_create_effect` */
  CT_EFFECT_DAMPING = 10,
  /** `ct_viscosity_create_effect` */
  CT_EFFECT_VISCOSITY = 11,
  /** `ct_absorb_create_effect` */
  CT_EFFECT_ABSORB = 12,
  /** `ct_averaging_create_effect` */
  CT_EFFECT_AVERAGING = 13
} ct_effect_kind;

/**
 * Phase of a step in which the force of an effect is computed. Within a phase the order is that of
 * the problem's list.
 */
typedef enum ct_phase {
  /** first: the force depends only on the state */
  CT_PHASE_STATE = 0,
  /** the force depends on the constraints of all effects, :eq:`constraint-problem` */
  CT_PHASE_CONSTRAINT = 1,
  /** the force depends on constraint forces, as friction does on contact pressure */
  CT_PHASE_FOLLOWING = 2,
  /** the force depends on `total`, as in dynamic relaxation; one effect at most */
  CT_PHASE_TOTAL = 3,
  /** the force moves nodes to prescribed positions against all other forces; one effect at most */
  CT_PHASE_PRESCRIBED = 4,
  /**
   * no function `force`: the effect keeps degrees of freedom at a constant velocity (inverse mass
   * 0). Its force is minus the sum of all other forces there. The time loop stores only the
   * impulse, as the work is impulse times velocity.
   */
  CT_PHASE_REACTION = 5
} ct_phase;

struct ct_effect;

/**
 * Contribution of an effect to the constraints of a step, :eq:`constraint-problem`. Both functions
 * may be null.
 */
typedef struct ct_effect_constraints {
  /**
   * Write pointers to the rows of the points that may be active in this step into `rows` (capacity
   * `constraint_count`), and their number into `count`. The effect owns the rows, in its scratch
   * space. The solver then computes the forces of the rows of all effects together, given the
   * forces of CT_PHASE_STATE, and writes them into the rows before `force` is called. `list` must
   * copy the force of the last step from `memory` into each row; `force` must write the new one to
   * `next_memory`.
   */
  ct_status (*list)(const struct ct_effect *effect, const ct_view *view, ct_constraint **rows,
                    int64_t *count, ct_error *error);
  /**
   * For degrees of freedom whose motion the effect prescribes, write the displacement increment
   * until the next step; NaN for the others, shape (node_count, 3) [length].
   */
  ct_status (*increment)(const struct ct_effect *effect, const ct_view *view, double *increment,
                         ct_error *error);
} ct_effect_constraints;

struct ct_problem;

/**
 * One physical effect: a force on some nodes, its energy, and its bound on the time step. The time
 * loop computes exactly the effects in the problem's list. Only `label`, `nodes` with `node_count`,
 * and `force` are required; members that do not apply are zero or null.
 */
typedef struct ct_effect {
  /** Kind of the effect; ``CT_EFFECT_USER`` for an effect of a host. */
  ct_effect_kind kind;
  /** Name of its column in the energy balance; has no other use. */
  const char *label;
  /** When in a step the force is computed. */
  ct_phase phase;
  /** Data of the effect's functions, constant once the problem exists. */
  void *data;
  /** Free `data`. */
  void (*free_data)(void *data);
  /** Nodes that the force acts on, ascending; null: all nodes. */
  const int32_t *nodes;
  /** Number of nodes that the force acts on. */
  int32_t node_count;
  /** Number of doubles that the effect stores from step to step; part of a restart. */
  int64_t memory_count;
  /** Write the force on the effect's nodes, shape (node_count, 3) [force]. */
  ct_status (*force)(const struct ct_effect *effect, const ct_view *view, double *force,
                     ct_error *error);
  /** Write the stored energy [energy]; `force` was called before with the same view. */
  ct_status (*energy)(const struct ct_effect *effect, const ct_view *view, double *energy,
                      ct_error *error);
  /** Write an upper bound of the effect's contribution to the largest ω² of the problem [1 /
   * time²], :eq:`step-bound`. */
  ct_status (*omega2_bound)(const struct ct_effect *effect, const ct_view *view, double *omega2,
                            ct_error *error);
  /** Write an upper bound of the largest eigenvalue of M⁻¹C [1 / time] for a force -C v_{n-1/2},
   * :eq:`damped-step-bound`. */
  ct_status (*rate_bound)(const struct ct_effect *effect, const ct_view *view, double *rate,
                          ct_error *error);
  /**
   * Return a bound >= 1 of the factor by which the effect multiplies the ω² and the rates of all
   * effects at a step Δt [time], :eq:`averaged-bound`, for an effect whose force depends on the
   * forces of the others. It must not grow with Δt. Such an effect must be the last one of
   * CT_PHASE_STATE and needs central differences.
   */
  double (*amplification)(const struct ct_effect *effect, double dt);
  /**
   * Null, or add to `matrix`, shape (24, 24), the term of the effect in :eq:`joint-bound`, in
   * addition to Δt² K, for one brick along x, y, z at a step Δt [time]. The brick belongs to the
   * body whose first node is `first_node`, and has the edges `edge` [length]. The bound of the sum
   * may then replace the sum of the bounds.
   */
  void (*add_element)(const struct ct_effect *effect, int32_t first_node, const double edge[3],
                      double dt, double *matrix);
  /**
   * Null, or return a bound on the largest eigenvalue of M⁻¹ A for the solid, where A is the sum of
   * `stiffness` times K, `mass` times M and the `add_element` terms of all effects at Δt,
   * :eq:`joint-bound`; infinite if not all bodies are boxes of equal bricks.
   */
  ct_status (*joint_bound)(const struct ct_effect *effect, const struct ct_problem *problem,
                           double dt, double stiffness, double mass, double *largest,
                           ct_error *error);
  /** Write the external work since t = 0 of an effect that stores energy, such as a moving obstacle
   * [energy], for the view of the last `force`. */
  ct_status (*external)(const struct ct_effect *effect, const ct_view *view, double *work,
                        ct_error *error);
  /** Allocate the scratch space of one state; needs `free_scratch`. */
  ct_status (*create_scratch)(const struct ct_effect *effect, void **scratch, ct_error *error);
  /** Free the scratch space. */
  void (*free_scratch)(void *scratch);
  /** Null, or the effect's contribution to the constraints of a step. */
  const ct_effect_constraints *constraints;
  /** Largest number of constraints that the effect can list. */
  int64_t constraint_count;
  /** Largest number of nodes of one constraint, both faces together; 0: 16. */
  int32_t constraint_nodes;
  /** Null, or an effect earlier in the problem's list; the view gives its scratch space as `read`.
   */
  const struct ct_effect *reads;
  /**
   * Approximate flops per call of `force`; 0 if unknown (reporting only). For an effect with
   * constraints this includes `list` with all points active, but not the solver, whose flops are
   * :eq:`round-flops` times `constraint_rounds` of the state.
   */
  double flops;
  /** Approximate bytes that one call of `force` moves; 0 if unknown (reporting only). */
  double bytes;
} ct_effect;

/**
 * Create an effect of the caller: a copy of `filled`, which `ct_scene_add_effect` takes over or
 * `ct_effect_free` frees. The caller owns `nodes` and `data` until `free_data` is called, once.
 * ``CT_ERROR_ARGUMENT``: no label; nodes not ascending; no `force`, or a `force` with
 * CT_PHASE_REACTION; a kind of the library (in a copy of one of its effects both would free the
 * same data).
 */
CT_API ct_status ct_effect_create(const ct_effect *filled, ct_effect **effect, ct_error *error);

/** Free an effect made by `ct_effect_create` or one of the library's `ct_..._create_effect` calls.
 */
CT_API void ct_effect_free(ct_effect *effect);

/** Explicit methods of time integration, :doc:`/theory/integrator`. */
typedef enum ct_scheme {
  /** Central difference in leapfrog form, :eq:`leapfrog`; no parameter (0). */
  CT_CENTRAL_DIFFERENCE,
  /** Chung and Lee; parameter β, 1 ... 28/27, :eq:`chung-lee-drift`. */
  CT_CHUNG_LEE,
  /** Noh and Bathe, two evaluations of the forces in a step; parameter p, 1/2 ... 2 - √2,
     :eq:`noh-bathe-stages`. */
  CT_NOH_BATHE,
  /** Tchamwa and Wielgosz; parameter ρ∞, 0 ... 1, :eq:`tchamwa-wielgosz-drift`. */
  CT_TCHAMWA_WIELGOSZ,
  /** Pushforward-pullback of Park, Lim and Huh for linear bodies, two forces of the bodies in a
     step; parameter θ, 0 ... 1, :eq:`pullback-drift`. */
  CT_PUSHFORWARD_PULLBACK
} ct_scheme;

/** A method and its one parameter. All bytes zero: central difference. */
typedef struct ct_integrator {
  /** The method. */
  ct_scheme scheme;
  /** Its parameter; see `ct_scheme`. */
  double parameter;
  /**
   * For CT_PUSHFORWARD_PULLBACK: the time Δt_c of the pushforward divided by Δt, >= 1. 0 means 1,
   * with which the method is the central difference. `ct_scene_build` sets it to the stable step
   * divided by Δt.
   */
  double push;
} ct_integrator;

/** One evaluation of the forces and the motion after it, :eq:`stage`. All numbers are fractions of
 * Δt. */
typedef struct ct_stage {
  /** Time τ until the next evaluation. */
  double tau;
  /** Coefficient c of the acceleration in the new velocity. */
  double c;
  /** Coefficient r of the acceleration in the velocity that moves the nodes. */
  double r;
  /** Coefficient l of the previous acceleration in the velocity that moves the nodes. */
  double l;
} ct_stage;

/** A method with its usual parameter: β = 28/27, p = 0.54, ρ∞ = 0.9, θ = 0.7. */
CT_API ct_integrator ct_integrator_default(ct_scheme scheme);

/** Check a method. ``CT_ERROR_ARGUMENT``: unknown scheme, or parameter out of range (`error` gives
 * the range). */
CT_API ct_status ct_integrator_check(const ct_integrator *integrator, ct_error *error);

/** Number of force evaluations of the bodies per step (1 or 2). */
CT_API int ct_integrator_evaluations(const ct_integrator *integrator);

/** Write the stages of one step, shape (2), and return their number (1 or 2). */
CT_API int ct_integrator_stages(const ct_integrator *integrator, ct_stage *stages);

/** Largest stable Ω = ω Δt of an oscillator without damping, :eq:`integrator-limits`. */
CT_API double ct_integrator_limit(const ct_integrator *integrator);

/** One body of a problem. */
typedef struct ct_body {
  /** A name for messages, ended by a zero byte. */
  char name[64];
  /** Its nodes and elements. */
  const ct_mesh *mesh;
  /** Its material. */
  ct_material material;
  /** Its nodes are first_node ... first_node + mesh->node_count - 1 of the problem. */
  int32_t first_node;
} ct_body;

/**
 * Everything that is constant during a run. `ct_scene_build` creates a problem; a host may also
 * fill one itself. The nodes of all bodies follow one another.
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
   * support prescribes a constant velocity, which then does not change.
   */
  const double *inverse_mass;
  /** Velocity at t = 0 [length / time], shape (node_count, 3). */
  const double *initial_velocity;
  /** The effects; the first one acts on all nodes (usually "solid"). */
  int32_t effect_count;
  /** List of the effects, shape (effect_count). */
  const ct_effect *const *effects;
  /** Time step Δt [time]. */
  double dt;
  /** Threads, >= 1; results do not depend on it. */
  int threads;
  /**
   * Null, or a clock [seconds] with which the time loop measures the time spent in each effect
   * (`effect_seconds` of the state); results do not depend on it.
   */
  double (*clock)(void);
  /** The method of the time steps; all bytes zero: central difference. */
  ct_integrator integrator;
  /**
   * Not zero: the stable step of linear bodies follows from the assembled bound,
   * :eq:`assembled-bound`, where it is larger. This costs about 70 force evaluations, once.
   */
  int assembled;
} ct_problem;

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
   * loop [seconds], shape (effect_count + 1); zero without the problem's clock. Not part of a
   * restart; written by `ct_step`.
   */
  double *effect_seconds;
  /**
   * Number of steps so far in which the constraint forces, :eq:`constraint-problem`, did not
   * converge to 1e-10 of the largest force within 2000 iterations; the last iterate is used then.
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

/** Take `count` steps. ``CT_ERROR_BLOWUP``: the state is no longer finite (`error` names body, node
 * and time); the remaining steps are not taken. */
CT_API ct_status ct_step_many(const ct_problem *problem, ct_state *state, int64_t count,
                              ct_error *error);

/**
 * Contribution of one effect to the bound of the step in this state: ω² [1 / time²] and its damping
 * rate [1 / time], :eq:`damped-step-bound`; 0 if the effect has no such bound.
 */
CT_API ct_status ct_stable_share(const ct_problem *problem, ct_state *state, int32_t effect,
                                 double *omega_squared, double *rate, ct_error *error);

/**
 * Largest stable step of the problem in this state; a null `state` means t = 0. It uses an upper
 * bound of ω² of the elements plus that of the contact points, so it does not exceed the true limit
 * of the linear problem, :eq:`step-bound`.
 */
CT_API ct_status ct_stable(const ct_problem *problem, ct_state *state, ct_stable_step *out,
                           ct_error *error);

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
  /** Impulse of the contacts on the body since t = 0 [mass · length / time], :eq:`impulse-balance`.
   */
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

/**
 * Take `count` steps as `ct_step_many`, with the same results bit by bit; the probes record their
 * rows before each step. `probes` of `ct_monitor_options` does the same in `ct_monitor_steps`. Rows
 * later than the state, for example after a restart, are removed first. ``CT_ERROR_MEMORY``: not
 * enough memory for the rows; no step was taken.
 */
CT_API ct_status ct_probes_steps(ct_probes *probes, ct_state *state, int64_t count,
                                 ct_error *error);

/** Record the rows of the present state, for example after the last step. A row that exists is not
 * recorded again. */
CT_API ct_status ct_probes_sample(ct_probes *probes, ct_state *state, ct_error *error);

/** The history of one probe. ``CT_ERROR_ARGUMENT``: unknown probe. */
CT_API ct_status ct_probes_history(const ct_probes *probes, int32_t probe,
                                   ct_probe_history *history);

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
   * `ct_monitor_growth` reports it [-], :eq:`energy-growth`, >= 0; the run continues.
   */
  double growth_limit;
  /** Null, or probes of the state, which record their rows in `ct_monitor_steps`. */
  ct_probes *probes;
} ct_monitor_options;

/** Checks every 1024 steps; limits: spurious energy as large as the energy that the bodies should
 * have, and ω Δt = 2; spurious growth is reported above 1 %. */
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

/**
 * Take `count` steps as `ct_step_many`, with the same results bit by bit, and check the state at
 * every multiple of `every`. An error names the time, the step, and the body with its element or
 * node. ``CT_ERROR_GEOMETRY``: an inverted element; ``CT_ERROR_BLOWUP``: the state is not finite;
 * ``CT_ERROR_STEP``: the solid has become too stiff for Δt; ``CT_ERROR_ENERGY``: spurious energy
 * growth; or any error of an effect.
 */
CT_API ct_status ct_monitor_steps(ct_monitor *monitor, ct_state *state, int64_t count,
                                  ct_error *error);

/**
 * `ct_monitor_steps`, and a check after the last step; `ct_monitor_ledger` returns its row. If the
 * caller does not change the state between such calls, sleeping elements, :eq:`sleep`, stay asleep.
 */
CT_API ct_status ct_monitor_advance(ct_monitor *monitor, ct_state *state, int64_t count,
                                    ct_error *error);

/** Check the state now. After CT_OK this is the last good state. Errors as `ct_monitor_steps`. */
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
  double share;
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

CT_END_DECLS

#endif
