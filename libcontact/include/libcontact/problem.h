/* The interface of an effect, the methods of time integration, and the problem, which is constant
 * during a run.
 * Threads: an effect and a problem are constant; several states may use them at the same time. */
#ifndef LIBCONTACT_PROBLEM_H
#define LIBCONTACT_PROBLEM_H

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
  /** Settings of the run, with the threads that the effect may use; null: one thread. */
  const ct_run_settings *settings;
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
  /** Whether `memory` is what this effect stored in the last evaluation of this state, unchanged
   * since, so that what its scratch space holds of that evaluation needs no update. */
  int continued;
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
  /* 13 was the averaged mass, which is gone. */
  /** `ct_stiffness_damping_create_effect` */
  CT_EFFECT_STIFFNESS_DAMPING = 14,
  /** `ct_initial_stress_create_effect` */
  CT_EFFECT_INITIAL_STRESS = 15,
  /** `ct_rigid_create_effect` */
  CT_EFFECT_RIGID = 16,
  /** `ct_tie_create_effect` */
  CT_EFFECT_TIE = 17
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
  /** the force depends on constraint forces */
  CT_PHASE_FOLLOWING = 2,
  /** the force depends on `total`, as in dynamic relaxation; one effect at most */
  CT_PHASE_TOTAL = 3,
  /** the force moves nodes to prescribed positions against all other forces; each node belongs to
   * at most one such effect */
  CT_PHASE_PRESCRIBED = 4,
  /**
   * no function `force`: the effect keeps degrees of freedom at a constant velocity (inverse mass
   * 0). Its force is minus the sum of all other forces there. The time loop stores only the
   * impulse, as the work is impulse times velocity.
   */
  CT_PHASE_REACTION = 5
} ct_phase;

struct ct_effect;
struct ct_problem;
struct ct_piece;

/** Bounds of an effect on the time step. All may be null. */
typedef struct ct_effect_bounds {
  /** Write an upper bound of the effect's contribution to the largest ω² of the problem [1 /
   * time²], :eq:`step-bound`. */
  ct_status (*omega2)(const struct ct_effect *effect, const ct_view *view, double *omega2,
                      ct_error *error);
  /** Write an upper bound of the largest eigenvalue of M⁻¹C [1 / time] for a force -C v_{n-1/2},
   * :eq:`damped-step-bound`. */
  ct_status (*rate)(const struct ct_effect *effect, const ct_view *view, double *rate,
                    ct_error *error);
  /**
   * Add to `matrix`, shape (24, 24), the term of the effect in :eq:`joint-bound`, in addition to
   * Δt² K, for one brick along x, y, z at a step Δt [time]. The brick belongs to the body whose
   * first node is `first_node`, and has the edges `edge` [length]. The bound of the sum may then
   * replace the sum of the bounds.
   */
  void (*add_element)(const struct ct_effect *effect, int32_t first_node, const double edge[3],
                      double dt, double *matrix);
  /**
   * Return a bound on the largest eigenvalue of M⁻¹ A for the solid, where A is the sum of
   * `stiffness` times K, `mass` times M and the `add_element` terms of all effects at Δt,
   * :eq:`joint-bound`; infinite if not all bodies are boxes of equal bricks.
   */
  ct_status (*joint)(const struct ct_effect *effect, const struct ct_problem *problem, double dt,
                     double stiffness, double mass, double *largest, ct_error *error);
} ct_effect_bounds;

/** How a rigid body moves until the next step by forces on its nodes, :eq:`rigid-mobility`. */
typedef struct ct_body_mobility {
  /** Displacement of its centre along x, y, z by a unit force [length / force]. */
  double translation[3];
  /** Its turn by a unit moment about the centre, in the order xx yy zz xy yz zx [1 / (force
   * length)]. */
  double rotation[6];
} ct_body_mobility;

/** Contribution of an effect to the constraints of a step, :eq:`constraint-problem`. */
typedef struct ct_effect_constraints {
  /**
   * Required in CT_PHASE_CONSTRAINT, not called in another. Write pointers to the rows of the
   * points that may be active in this step into `rows` (capacity `constraint_count`), and their
   * number into `count`. The effect owns the rows, in its scratch space. The solver then computes
   * the forces of the rows of all effects together, given the forces of CT_PHASE_STATE, and writes
   * them into the rows before `force` is called. `list` must copy the force of the last step from
   * `memory` into each row; `force` must write the new one to `next_memory`.
   */
  ct_status (*list)(const struct ct_effect *effect, const ct_view *view, ct_constraint **rows,
                    int64_t *count, ct_error *error);
  /**
   * Null, or for degrees of freedom whose motion the effect prescribes, write the displacement
   * increment until the next step; NaN for the others, shape (node_count, 3) [length].
   */
  ct_status (*increment)(const struct ct_effect *effect, const ct_view *view, double *increment,
                         ct_error *error);
  /**
   * Null, or write a fraction a: the effect will scale the velocity of its nodes by (1 - a)/(1 + a)
   * and what all forces change of it by 1/(1 + a) (:eq:`relaxation-force`).
   */
  ct_status (*slow)(const struct ct_effect *effect, const ct_view *view, double *fraction,
                    ct_error *error);
  /**
   * Null, or, for an effect whose nodes are those of whole bodies that are rigid, write how each of
   * these moves, in the order of their nodes, and the vector from its centre to each node, shape
   * (node_count, 3) [length]. `increment` is then the motion without the constraints, and was
   * called before with the same view.
   */
  ct_status (*mobility)(const struct ct_effect *effect, const ct_view *view,
                        ct_body_mobility *bodies, double *arms, ct_error *error);
  /** Null, or write the external work since t = 0 of an effect that stores energy, such as a moving
   * obstacle [energy], for the view of the last `force`; also in other phases. */
  ct_status (*external)(const struct ct_effect *effect, const ct_view *view, double *work,
                        ct_error *error);
  /** Null, or write the part of the stored energy that is held until points open [energy],
   * :eq:`impact-reserve`; `energy` was called before with the same view. */
  ct_status (*reserve)(const struct ct_effect *effect, const ct_view *view, double *reserve,
                       ct_error *error);
  /**
   * Null, or add to `memory`, which was that of the view, the work of the forces at t_n on the
   * change of velocity by which the step is divided to `dt` [time], :eq:`divided-work`; `force` was
   * called before with the same view.
   */
  void (*divide)(const struct ct_effect *effect, const ct_view *view, double dt, double *memory);
} ct_effect_constraints;

/** How an effect is computed in pieces, :doc:`/theory/pieces`. */
typedef struct ct_effect_pieces {
  /** Prepare the scratch space of one piece. Null: nothing is to be done if `common` is not 0, else
   * the effect can't be computed in pieces. */
  ct_status (*cut)(const struct ct_effect *effect, const struct ct_piece *piece, void *scratch,
                   ct_error *error);
  /** Required of an effect with memory: set to 0 those of its numbers in `memory` that belong to
   * another piece, and unless `common` is 1 those that all pieces have. */
  void (*keep)(const struct ct_effect *effect, const struct ct_piece *piece, int common,
               double *memory);
  /** Not zero: every piece needs the motion of all nodes of the effect, and computes its forces. */
  int common;
} ct_effect_pieces;

/**
 * The calls of an effect: one constant table for all effects of a kind, which must live as long as
 * they do. Only `force` is required; calls that do not apply are null.
 */
typedef struct ct_effect_calls {
  /** Write the force on the effect's nodes, shape (node_count, 3) [force]. Null in, and only in,
   * CT_PHASE_REACTION. */
  ct_status (*force)(const struct ct_effect *effect, const ct_view *view, double *force,
                     ct_error *error);
  /** Write the stored energy [energy]; `force` was called before with the same view. */
  ct_status (*energy)(const struct ct_effect *effect, const ct_view *view, double *energy,
                      ct_error *error);
  /** Allocate the scratch space of one state; needs `free_scratch`. */
  ct_status (*create_scratch)(const struct ct_effect *effect, void **scratch, ct_error *error);
  /** Free the scratch space. */
  void (*free_scratch)(void *scratch);
  /** Free the effect's `data`. */
  void (*free_data)(void *data);
  /** Its bounds on the time step. */
  ct_effect_bounds bounds;
  /** Its contribution to the constraints of a step. */
  ct_effect_constraints constraints;
  /** How it is computed in pieces. */
  ct_effect_pieces pieces;
} ct_effect_calls;

/** Approximate cost of one call of `force`; 0 if unknown (reporting only). */
typedef struct ct_effect_cost {
  /** Flops. For an effect with constraints this includes `list` with all points active, but not the
   * solver, whose flops are :eq:`round-flops` times `constraint_rounds` of the state. */
  double flops;
  /** Bytes that it moves. */
  double bytes;
} ct_effect_cost;

/**
 * One physical effect: a force on some nodes, its energy, and its bound on the time step. The time
 * loop computes exactly the effects in the problem's list. Only `label`, `calls` and `nodes` with
 * `node_count` are required; members that do not apply are zero or null.
 */
typedef struct ct_effect {
  /** Kind of the effect; ``CT_EFFECT_USER`` for an effect of a host. */
  ct_effect_kind kind;
  /** When in a step the force is computed. */
  ct_phase phase;
  /** Name of its column in the energy balance; has no other use. */
  const char *label;
  /** Its calls. */
  const ct_effect_calls *calls;
  /** Data of the calls, constant once the problem exists. */
  void *data;
  /** Nodes that the force acts on, ascending; null: all nodes. */
  const int32_t *nodes;
  /** Number of nodes that the force acts on. */
  int32_t node_count;
  /** Largest number of nodes of one constraint, both faces together; 0: 16. */
  int32_t constraint_nodes;
  /** Largest number of constraints that the effect can list; of friction, to which it adds its law.
   */
  int64_t constraint_count;
  /** Number of doubles that the effect stores from step to step; part of a restart. */
  int64_t memory_count;
  /** Null, or an effect earlier in the problem's list; the view gives its scratch space as `read`.
   */
  const struct ct_effect *reads;
  /** What its force costs. */
  ct_effect_cost cost;
} ct_effect;

/**
 * Create an effect of the caller: a copy of `filled`, which `ct_scene_add_effect` takes over or
 * `ct_effect_free` frees. The caller owns `nodes`, `calls` and `data` until `free_data` is called,
 * once.
 * ``CT_ERROR_ARGUMENT``: no label or table of calls; nodes not ascending; a required call is
 * missing, or a `force` with CT_PHASE_REACTION; a kind of the library (in a copy of one of its
 * effects both would free the same data).
 */
CT_API ct_status ct_effect_create(const ct_effect *filled, ct_effect **effect, ct_error *error);

/** Free an effect made by `ct_effect_create` or one of the library's `ct_..._create_effect` calls.
 */
CT_API void ct_effect_free(ct_effect *effect);

/** Explicit methods of time integration, :doc:`/theory/integrator`. `ct_integrator_facts` gives the
 * range of the parameter. */
typedef enum ct_scheme {
  /** Central difference in leapfrog form, :eq:`leapfrog`; no parameter (0). */
  CT_CENTRAL_DIFFERENCE,
  /** Chung and Lee; parameter β, :eq:`chung-lee-drift`. */
  CT_CHUNG_LEE,
  /** Noh and Bathe, two stages in a step; parameter p, :eq:`noh-bathe-stages`. */
  CT_NOH_BATHE,
  /** Tchamwa and Wielgosz; parameter ρ∞, :eq:`tchamwa-wielgosz-drift`. */
  CT_TCHAMWA_WIELGOSZ,
  /* 4 was the pushforward-pullback, which is gone: the next method is 5. */
  /** Number of methods; it grows with later versions. */
  CT_SCHEME_COUNT
} ct_scheme;

/** What a method is and needs: its row in the table of `libcontact/src/step/integrator.c`. */
typedef struct ct_scheme_facts {
  /** Its word in a scene. */
  const char *name;
  /** Name of its parameter. */
  const char *parameter;
  /** Least allowed parameter [-]. */
  double least;
  /** Largest allowed parameter [-]; equal to `least` if the method has none. */
  double most;
  /** Usual parameter [-]. */
  double usual;
  /** Order of accuracy in Δt. */
  int order;
  /** 1 if a step needs the acceleration of the step before, which the state then stores. */
  int stores;
} ct_scheme_facts;

/** A method and its one parameter. All bytes zero: central difference. */
typedef struct ct_integrator {
  /** The method. */
  ct_scheme scheme;
  /** Its parameter; see `ct_scheme`. */
  double parameter;
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

/** The facts of a method; null for an unknown one. */
CT_API const ct_scheme_facts *ct_integrator_facts(ct_scheme scheme);

/** A method with its usual parameter. */
CT_API ct_integrator ct_integrator_default(ct_scheme scheme);

/** Check a method. ``CT_ERROR_ARGUMENT``: unknown scheme, or parameter out of range (`error` gives
 * the range). */
CT_API ct_status ct_integrator_check(const ct_integrator *integrator, ct_error *error);

/** Number of force evaluations of the bodies per step (1 or 2). This call and those below need a
 * method that `ct_integrator_check` accepts. */
CT_API int ct_integrator_evaluations(const ct_integrator *integrator);

/** Write the stages of one step, shape (2), and return their number (1 or 2). */
CT_API int ct_integrator_stages(const ct_integrator *integrator, ct_stage *stages);

/** Whether a method with this parameter is the leapfrog, :eq:`leapfrog`: one stage with τ = c = r =
 * 1 and l = 0. */
CT_API int ct_integrator_is_leapfrog(const ct_integrator *integrator);

/** Largest stable Ω = ω Δt of an oscillator without damping, :eq:`integrator-limits`. */
CT_API double ct_integrator_limit(const ct_integrator *integrator);

/** One body of a problem. */
typedef struct ct_body {
  /** A name for messages, ended by a zero byte. */
  char name[64];
  /** Its nodes and elements. */
  const ct_mesh *mesh;
  /** Its material; of several the stiffest, with the largest c₁. */
  ct_material material;
  /** Its nodes are first_node ... first_node + mesh->node_count - 1 of the problem. */
  int32_t first_node;
  /** Its stress without displacement, xx yy zz xy yz zx [stress], :eq:`initial-stress`. */
  double initial_stress[6];
  /** Null, or the material of each element, shape (mesh->element_count). */
  const ct_material *materials;
} ct_body;

/** The material of an element of a body. */
CT_API const ct_material *ct_body_material(const ct_body *body, int32_t element);

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
  /** Settings of the run. */
  ct_run_settings settings;
  /** The method of the time steps; all bytes zero: central difference. */
  ct_integrator integrator;
  /**
   * Not zero: the stable step of linear bodies follows from the assembled bound,
   * :eq:`assembled-bound`, where it is larger. This costs about 70 force evaluations, once.
   */
  int assembled;
  /**
   * Tolerance of the contact forces, 1e-12 ... 0.1: the largest change by a further iteration, as a
   * fraction of the largest force, :eq:`energy-stop`; 0: 1e-4.
   */
  double force_tolerance;
  /** Displacement at t = 0 [length], shape (node_count, 3); null: none. */
  const double *initial_displacement;
} ct_problem;

/** Whether an effect of `ct_rigid_create_effect` keeps a body of the problem rigid (1 or 0). Its
 * elements have no stress. */
CT_API int ct_problem_is_rigid(const ct_problem *problem, int32_t body);

CT_END_DECLS

#endif
