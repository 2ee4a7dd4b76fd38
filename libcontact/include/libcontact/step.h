/* The contract of an effect; the problem, which does not change in a run, and the state, which
 * does; time steps, stable step, energy and momentum, and the monitor of a run.
 * Threads: a call must be alone with its state and its monitor; several states of one problem may
 * be stepped at once. One step may itself use several threads (ct_problem.threads), with the same
 * bits. */
#ifndef LIBCONTACT_STEP_H
#define LIBCONTACT_STEP_H

#include <libcontact/base.h>
#include <libcontact/mesh.h>
#include <libcontact/constraint.h>

CT_BEGIN_DECLS

/**
 * What an effect is shown when it is asked for its force: the state of all bodies, one after
 * another, at one time. Nothing here may be changed by the effect but its own `memory` and
 * `scratch`.
 */
typedef struct ct_view {
  /** Time t_n [time]. */
  double time;
  /** Threads that the effect may use; results must not depend on it. */
  int threads;
  /** Reference coordinates X [length], shape (node_count, 3). */
  const double *reference;
  /** Displacement u_n [length], shape (node_count, 3). */
  const double *displacement;
  /**
   * Time until the next evaluation of the forces [time], Δt for most integrators; 0 while the start
   * is made, before v_{-1/2} is known, and while no step is chosen yet.
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
  /** Acceleration of the evaluation before [length / time²], shape (node_count, 3), for integrators
   * that use it; or null. */
  const double *acceleration_before;
  /**
   * Sum of the forces that were computed before this one in the same step [force], shape
   * (node_count, 3); in `force`, and in `energy` the sum of all.
   */
  const double *total;
  /** Velocity half a step back, v_{n-1/2} [length / time], before this evaluation, shape
   * (node_count, 3).
   */
  const double *velocity;
  /** What the effect remembers from step n - 1 (memory_count doubles). */
  const double *memory;
  /** Where it writes what step n + 1 shall see. */
  double *next_memory;
  /** What `create_scratch` made for this state. */
  void *scratch;
  /** Scratch space of the effect that this one `reads`, as its `force` has left it for the same
   * time; null without one. */
  const void *read;
} ct_view;

/**
 * What an effect is, and so what its `data`, memory and scratch space hold. The library decides by
 * the kind and never by the name.
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
  /** prescribed paths, whose name is "support", too: `ct_motion_create_effect` */
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
 * When in a step the force of an effect is computed. Forces of one phase follow the order of the
 * problem's list.
 */
typedef enum ct_phase {
  /** first: the force follows from the state alone */
  CT_PHASE_STATE = 0,
  /** the force follows from the constraints of all effects, :eq:`constraint-problem` */
  CT_PHASE_CONSTRAINT = 1,
  /** the force follows from those, as friction from the pressure of a contact */
  CT_PHASE_FOLLOWING = 2,
  /** the force follows from `total`, as that of dynamic relaxation; one effect at most */
  CT_PHASE_TOTAL = 3,
  /** the force takes nodes to a prescribed place against all others; one effect at most */
  CT_PHASE_PRESCRIBED = 4,
  /**
   * no force at all: the effect holds degrees of freedom at a constant velocity (inverse mass 0).
   * The time loop takes minus the sum of all other forces there and keeps its impulse only, as its
   * work is impulse times velocity.
   */
  CT_PHASE_REACTION = 5
} ct_phase;

struct ct_effect;

/**
 * What an effect adds to the constraints of a step, :eq:`constraint-problem`. Both functions may be
 * null.
 */
typedef struct ct_effect_constraints {
  /**
   * Write where the rows of the points that may be active in this step stand into `rows`, which has
   * room for `constraint_count`, and their number into `count`. The rows stay the effect's, in its
   * scratch space. The forces of all effects' rows are then found together, given the forces of
   * CT_PHASE_STATE, and stand in the rows when `force` is called. What `memory` holds of the last
   * step's force must go into a row, and `force` must write the present one into `next_memory`.
   */
  ct_status (*list)(const struct ct_effect *effect, const ct_view *view, ct_constraint **rows,
                    int64_t *count, ct_error *error);
  /**
   * Where the effect prescribes the motion, whatever the forces: write the displacement increment
   * until the next step, and NaN for the other degrees of freedom, shape (node_count, 3) [length].
   */
  ct_status (*increment)(const struct ct_effect *effect, const ct_view *view, double *increment,
                         ct_error *error);
} ct_effect_constraints;

struct ct_problem;

/**
 * One physical effect: a force on some nodes, its energy, and its bound on the time step. The time
 * loop runs over the effects that a problem lists and over nothing else. Only `label`, `nodes` with
 * `node_count`, and `force` are needed; what does not apply is zero or null.
 */
typedef struct ct_effect {
  /** What the effect is; a host leaves it at ``CT_EFFECT_USER``. */
  ct_effect_kind kind;
  /** Names a column of the energy balance; the library decides nothing by it. */
  const char *label;
  /** When in a step the force is computed. */
  ct_phase phase;
  /** What the effect's functions need, fixed once the problem is made. */
  void *data;
  /** Free `data`. */
  void (*free_data)(void *data);
  /** Nodes that the force acts on, ascending; null: all nodes. */
  const int32_t *nodes;
  /** Number of nodes that the force acts on. */
  int32_t node_count;
  /** Doubles of the state that the effect keeps from step to step (a restart carries them). */
  int64_t memory_count;
  /** Write the force on the effect's nodes, shape (node_count, 3) [force]. */
  ct_status (*force)(const struct ct_effect *effect, const ct_view *view, double *force,
                     ct_error *error);
  /** Stored energy for the same view, after `force` was called with it [energy]. */
  ct_status (*energy)(const struct ct_effect *effect, const ct_view *view, double *energy,
                      ct_error *error);
  /** Upper bound of what the effect adds to the largest ω² of the problem [1 / time²],
   * :eq:`step-bound`. */
  ct_status (*omega2_bound)(const struct ct_effect *effect, const ct_view *view, double *omega2,
                            ct_error *error);
  /** Upper bound of the largest eigenvalue of M⁻¹C [1 / time] for a force -C v that goes with the
   * velocity half a step back, :eq:`damped-step-bound`. */
  ct_status (*rate_bound)(const struct ct_effect *effect, const ct_view *view, double *rate,
                          ct_error *error);
  /**
   * Bound of the factor >= 1 by which the effect enlarges the ω² and the rates of all effects at a
   * step Δt [time], :eq:`averaged-bound`, as its force follows from theirs; it must not grow with
   * Δt. Such an effect is the last one of CT_PHASE_STATE, and for central differences.
   */
  double (*amplification)(const struct ct_effect *effect, double dt);
  /**
   * Null, or add to `matrix`, shape (24, 24), what the effect has beside Δt² K in :eq:`joint-bound`
   * for one brick along x, y, z of the body that begins at a node, with the edges `edge` [length],
   * at a step Δt [time]. The sums of bounds may then be replaced by the bound of the sum.
   */
  void (*add_element)(const struct ct_effect *effect, int32_t first_node, const double edge[3],
                      double dt, double *matrix);
  /**
   * Null, or bound the largest eigenvalue of M⁻¹ A for the solid, where A is `stiffness` times K,
   * `mass` times M and the elements of all effects of the problem at Δt, :eq:`joint-bound`;
   * infinite where the bodies are not all boxes of equal bricks.
   */
  ct_status (*joint_bound)(const struct ct_effect *effect, const struct ct_problem *problem,
                           double dt, double stiffness, double mass, double *largest,
                           ct_error *error);
  /** Work since t = 0 that comes in from outside through an effect that stores energy, as of a
   * moving obstacle [energy], for the view of the last `force`; it counts as external. */
  ct_status (*external)(const struct ct_effect *effect, const ct_view *view, double *work,
                        ct_error *error);
  /** Scratch space of one state. */
  ct_status (*create_scratch)(const struct ct_effect *effect, void **scratch, ct_error *error);
  /** Free the scratch space. */
  void (*free_scratch)(void *scratch);
  /** Null, or what the effect adds to the constraints of a step. */
  const ct_effect_constraints *constraints;
  /** Most constraints that it can list. */
  int64_t constraint_count;
  /** Most nodes of one of them, those of both faces together, for which room is kept; 0: 16. */
  int32_t constraint_nodes;
  /** Null, or an effect that stands before this one in the problem's list, and whose scratch space
   * the view shows as `read`. */
  const struct ct_effect *reads;
  /**
   * Approximate flops per call of `force`; 0 if unknown (reporting only). For an effect with
   * constraints this counts `list`, too, with all its points active, but not the rounds of the
   * solver, which are :eq:`round-flops` times `constraint_rounds` of the state.
   */
  double flops;
  /** Approximate bytes that one call of `force` moves; 0 if unknown (reporting only). */
  double bytes;
} ct_effect;

/**
 * An effect of the caller's own: a copy of a filled `ct_effect` that `ct_scene_add_effect` can take
 * over and `ct_effect_free` frees. `nodes` and `data` stay the caller's until `free_data` is
 * called, once. ``CT_ERROR_ARGUMENT``: no name, nodes not ascending, a force missing or beside
 * `reaction`, a kind of the library's own (as in a copy of one of its effects: both would free the
 * same data).
 */
CT_API ct_status ct_effect_create(const ct_effect *filled, ct_effect **effect, ct_error *error);

/** Free an effect made by `ct_effect_create` or one of the library's `ct_..._create_effect` calls.
 */
CT_API void ct_effect_free(ct_effect *effect);

/** Explicit methods that take a problem from one moment to the next, :doc:`/theory/integrator`. */
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
  /** Its parameter, as the method says. */
  double parameter;
  /** With CT_PUSHFORWARD_PULLBACK: the time Δt_c of the pushforward over Δt, at least 1; 0: 1, and
   * the method is the central difference. `ct_scene_build` sets it to the stable step over Δt. */
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
  /** Coefficient l of the acceleration before in the velocity that moves the nodes. */
  double l;
} ct_stage;

/** The method of this scheme with its usual parameter: β = 28/27, p = 0.54, ρ∞ = 0.9, θ = 0.7.
 */
CT_API ct_integrator ct_integrator_default(ct_scheme scheme);

/** ``CT_ERROR_ARGUMENT`` for an unknown scheme or a parameter out of its range, with the range in
 * `error`. */
CT_API ct_status ct_integrator_check(const ct_integrator *integrator, ct_error *error);

/** Forces of the bodies in a step (1 or 2). */
CT_API int ct_integrator_evaluations(const ct_integrator *integrator);

/** Fill the stages of one step, shape (2); the number of them (1 or 2). */
CT_API int ct_integrator_stages(const ct_integrator *integrator, ct_stage *stages);

/** Largest stable Ω = ω Δt of an oscillator without damping, :eq:`integrator-limits`. */
CT_API double ct_integrator_limit(const ct_integrator *integrator);

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
   * Not zero: linear bodies are bounded together, :eq:`assembled-bound`, where that allows a
   * larger step; it costs some 70 forces once.
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
  /** v_{n-1/2} [length / time], the velocity before this evaluation, :eq:`stage`, shape
   * (node_count, 3); written by `ct_step`. */
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
   * of the largest within 2000 rounds, so far; the last of them is used then. Not part of a
   * restart; written by `ct_step`.
   */
  int64_t unconverged;
  /**
   * Work of the search for the forces of the constraints so far: rounds of
   * :eq:`proportioning` times the constraints that they went over, summed over the steps.
   * Not part of a restart.
   */
  int64_t constraint_rounds;
  /**
   * Elements whose forces the solid effect has computed so far, and those that slept, :eq:`sleep`,
   * summed over all evaluations. Not part of a restart.
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
CT_API ct_status ct_state_subdivide_step(const ct_problem *problem, ct_state *from, ct_state *to,
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
 * Largest stable step of the problem in this state (a null `state`: at t = 0).
 * An upper bound of ω² of each element plus the bound of the contact points, so never above the
 * true limit of the linear problem.
 */
CT_API ct_status ct_stable(const ct_problem *problem, ct_state *state, ct_stable_step *out,
                           ct_error *error);

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
  /** Impulse of the obstacles on the body since t = 0 [mass · length / time]; that of friction on
   * them is not in it. */
  double obstacle_impulse[3];
  /** Impulse of the supports on the body since t = 0 [mass · length / time]. */
  double support_impulse[3];
} ct_momentum;

/** What one effect has done by t_n. All [energy]. */
typedef struct ct_effect_energy {
  /** Its work since t = 0. */
  double work;
  /** What it stores; 0 for an effect without `energy`. */
  double stored;
  /** What came in through it from outside; 0 for an effect without `external`. */
  double external;
} ct_effect_energy;

/** A row of the energy balance. All of it is found in one pass over the nodes, and one more over
 * those of each effect but the first. */
typedef struct ct_ledger {
  /** Energies of all bodies, as `ct_energy_of` gives them. */
  ct_energy energy;
  /** Null, or the momenta of the bodies, shape (body_count). */
  ct_momentum *momentum;
  /** Null, or what each effect has done, shape (effect_count). */
  ct_effect_energy *effects;
} ct_ledger;

/**
 * A row at the state's time (evaluates the forces there if `ct_step` has not). The caller gives the
 * two arrays, or null. ``CT_ERROR_BLOWUP`` where it is not finite, with body and node where the
 * motion is not; after an error only the arrays may have changed.
 */
CT_API ct_status ct_ledger_of(const ct_problem *problem, ct_state *state, ct_ledger *ledger,
                              ct_error *error);

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
 * How far the state is from rest, :eq:`residual`: the larger of the largest nodal force that is not
 * balanced over the largest nodal force of any effect, and the root of the kinetic over the stored
 * energy. 0 where nothing moves and no force acts, infinite where something moves and nothing is
 * stored.
 */
CT_API ct_status ct_energy_residual(const ct_problem *problem, ct_state *state, double *unrest,
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

/** The same at `count` nodes from `first` on, shape (count, 3), for who has no room for all. */
CT_API ct_status ct_state_velocity_at(const ct_problem *problem, ct_state *state, int32_t first,
                                      int32_t count, double *velocity, ct_error *error);

/** Force of one effect at t_n on the problem's nodes [force], shape (node_count, 3); zero where it
 * does not act. */
CT_API ct_status ct_state_force(const ct_problem *problem, ct_state *state, int32_t effect,
                                double *force, ct_error *error);

/** What a probe takes down. Each is one number a row, or as many as are said. */
typedef enum ct_quantity {
  /** t_n [time]; every row begins with it */
  CT_QUANTITY_TIME = 0,
  /** u_n [length], 3 numbers */
  CT_QUANTITY_DISPLACEMENT = 1,
  /** v_n, the mean of the two half steps [length / time], :eq:`stage-velocity`, 3 numbers */
  CT_QUANTITY_VELOCITY = 2,
  /** a_n, all forces over the mass [length / time²], 3 numbers; 0 where a support holds */
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
 * A probe: what is taken down of a run at every step, and where. Start from `ct_probe_def_default`.
 * Everything given is copied.
 */
typedef struct ct_probe_def {
  /** Set by `ct_probe_def_default`. */
  int32_t cookie;
  /** Names its table in a results file: 1 to 63 bytes, no slash. */
  const char *name;
  /** For each `ct_quantity` whether it is taken (0 or 1); the time always is. */
  int take[8];
  /** Steps between two rows, >= 1: rows are those of the steps that it divides. */
  int64_t every;
  /**
   * Nodes of the problem, ascending: their motion, which for several nodes is that of their centre
   * of mass, :eq:`probe-mean`; or the nodes on which forces are summed, and then null means all on
   * which the effects act.
   */
  const int32_t *nodes;
  /** Number of nodes. */
  int32_t node_count;
  /** Body and element (of that body) for stress and pressure. */
  int32_t body;
  /** Number of the element, or -1: none. */
  int32_t element;
  /** Effects of the problem whose forces are summed, such as a contact and its friction. */
  const int32_t *effects;
  /** Number of effects. */
  int32_t effect_count;
  /** Which of x, y, z of a force count (0 or 1): all three, or those that one support holds. */
  int axes[3];
} ct_probe_def;

/** Every step, all axes, and nothing taken yet. */
CT_API ct_probe_def ct_probe_def_default(void);

/** Probes with their histories, which grow by rows in the time loop; opaque. */
typedef struct ct_probes ct_probes;

/** The history of one probe so far. */
typedef struct ct_probe_history {
  /** Its name. */
  const char *name;
  /** Doubles in a row. */
  int32_t width;
  /** Where each `ct_quantity` begins in a row; -1: not taken. */
  int32_t column[8];
  /** Number of rows. */
  int64_t row_count;
  /** Rows in the order of time, shape (row_count, width); they stay the probes', until the next
   * call. */
  const double *rows;
} ct_probe_history;

/**
 * Probes of states of a problem, which must outlive them. They belong to one run, that is to one
 * state at a time. ``CT_ERROR_ARGUMENT`` tells what is wrong with which definition.
 */
CT_API ct_status ct_probes_create(const ct_problem *problem, const ct_probe_def *defs,
                                  int32_t count, ct_probes **probes, ct_error *error);

/** Free probes and their histories; null is allowed. */
CT_API void ct_probes_free(ct_probes *probes);

/**
 * Like `ct_step_many`, with the same bits of the state; the probes take their rows of the states
 * before each step. `probes` of `ct_monitor_options` does the same in `ct_monitor_steps`. Rows that
 * are later than the state, which may be that of a restart, are dropped first.
 * ``CT_ERROR_MEMORY``: there is no room for the rows, and no step was taken.
 */
CT_API ct_status ct_probes_steps(ct_probes *probes, ct_state *state, int64_t count,
                                 ct_error *error);

/** Take the rows of the present state, as after the last step or at a record; those that are there
 * are not taken again. */
CT_API ct_status ct_probes_sample(ct_probes *probes, ct_state *state, ct_error *error);

/** The history of one probe. ``CT_ERROR_ARGUMENT``: there is none of this number. */
CT_API ct_status ct_probes_history(const ct_probes *probes, int32_t probe,
                                   ct_probe_history *history);

/** Put these rows in place of the history of one probe, to continue a run; copied. */
CT_API ct_status ct_probes_restore(ct_probes *probes, int32_t probe, const double *rows,
                                   int64_t count, ct_error *error);

/** What a monitor looks for, and how often. */
typedef struct ct_monitor_options {
  /** Steps between two checks, >= 1: the state is checked whenever its number of steps is a
   * multiple of this. */
  int64_t every;
  /**
   * Energy that may appear from nothing over the energy that should be there, :eq:`energy-appears`,
   * > 0; infinite: energy is not monitored.
   */
  double energy_limit;
  /**
   * Largest ω Δt of the motion of the solid alone, :eq:`step-quotient`, > 0, as for central
   * differences: 2 is the limit of every integrator; infinite: stiffening is not monitored.
   */
  double omega_limit;
  /** The stable step at the start [time], where the caller knows it; 0: it is asked when the
   * monitor is made. */
  double stable;
  /**
   * Spurious energy over the energy that should be there, from which on `ct_monitor_growth` reports
   * it, :eq:`energy-growth`, >= 0; the run goes on.
   */
  double growth_limit;
  /** Null, or probes of the state that take their rows in `ct_monitor_steps`. */
  ct_probes *probes;
} ct_monitor_options;

/** Every 1024 steps; as much energy again as should be there; ω Δt up to 2; growth is reported from
 * 1 % on. */
CT_API ct_monitor_options ct_monitor_options_default(void);

/** Checks one state while it is stepped, and keeps a copy of the last state that was good;
 * opaque. */
typedef struct ct_monitor ct_monitor;

/**
 * A monitor over a state of the problem, which is its first good state. The problem must outlive
 * it.
 * ``CT_ERROR_ARGUMENT``: an option out of range; what the forces of the state fail with is
 * returned, too.
 */
CT_API ct_status ct_monitor_create(const ct_problem *problem, ct_state *state,
                                   const ct_monitor_options *options, ct_monitor **monitor,
                                   ct_error *error);

/** Free a monitor; null is allowed. */
CT_API void ct_monitor_free(ct_monitor *monitor);

/**
 * Like `ct_step_many`, with a check at every multiple of `every`; the bits of the state are the
 * same. An error names the time, the step, and the body with its element or node:
 * ``CT_ERROR_GEOMETRY`` (an element is turned inside out), ``CT_ERROR_BLOWUP`` (not finite),
 * ``CT_ERROR_STEP`` (the solid has become too stiff for Δt), ``CT_ERROR_ENERGY`` (energy appears),
 * or what else an effect fails with.
 */
CT_API ct_status ct_monitor_steps(ct_monitor *monitor, ct_state *state, int64_t count,
                                  ct_error *error);

/**
 * `ct_monitor_steps` and a check after the last step, whose row is `ct_monitor_ledger`. Where
 * nobody changes the state between such calls, elements that sleep, :eq:`sleep`, sleep on over
 * them.
 */
CT_API ct_status ct_monitor_advance(ct_monitor *monitor, ct_state *state, int64_t count,
                                    ct_error *error);

/** Check at once, at any step; with CT_OK the state is the last good one. Errors as above. */
CT_API ct_status ct_monitor_check(ct_monitor *monitor, ct_state *state, ct_error *error);

/**
 * The last good state, which belongs to the monitor; the next check changes it. Null for a null
 * monitor, or without memory for its forces.
 */
CT_API ct_state *ct_monitor_good(const ct_monitor *monitor);

/**
 * The row of the energy balance of the last good state, with both arrays, which a check has made
 * anyway; it belongs to the monitor, and the next check changes it. Null for a null monitor.
 */
CT_API const ct_ledger *ct_monitor_ledger(const ct_monitor *monitor);

/** Spurious energy growth, as it was at the first check that found more than `growth_limit`. */
typedef struct ct_growth {
  /** Spurious energy over the energy that should be there, :eq:`energy-growth`; 0 as long as no
   * check has found too much. */
  double share;
  /** Time of the check [time]. */
  double time;
  /** Its number of steps. */
  int64_t step;
  /** Number of the effect of the problem whose work and store have grown most. */
  int32_t effect;
  /** The body with the node of the largest kinetic energy. */
  int32_t body;
} ct_growth;

/** The growth that was found since the monitor was made; zeros for a null monitor, or as long as no
 * check has found too much. */
CT_API ct_growth ct_monitor_growth(const ct_monitor *monitor);

CT_END_DECLS

#endif
