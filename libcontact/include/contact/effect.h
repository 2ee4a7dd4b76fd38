#ifndef CONTACT_EFFECT_H
#define CONTACT_EFFECT_H

#include <contact/enforcement.h>
#include <contact/status.h>

CT_BEGIN_DECLS

/**
 * Work that may be left out where leaving it out changes no result, :doc:`/theory/savings`; each 1
 * (may be) or 0. A scene begins with `ct_savings_default`; turning one off is good for measuring
 * what it saves, and for nothing else.
 */
typedef struct ct_savings {
  /** Elements whose nodes have moved all alike are not computed, and nodes without force are only
   * moved on. */
  int quiet;
  /** One layer of bricks held along y is computed in two dimensions. */
  int plane_strain;
  /** Elements of one shape and material share what is stored for them. */
  int congruent;
  /** Contact surfaces that are too far from each other to touch are not searched. */
  int distant;
} ct_savings;

/** All savings on. */
CT_API ct_savings ct_savings_default(void);

/** One motion of many nodes that drift alike, :eq:`adrift-node`. */
typedef struct ct_leader {
  /** Nodes `first` ... `last` - 1 of the problem may follow it; none when both are equal. */
  int32_t first, last;
  /** u_n [length]; the time loop moves it on. */
  double displacement[3];
  /** v_{n-1/2} [length / time]. */
  double velocity[3];
} ct_leader;

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
  /**
   * Velocity after the kick: `velocity` + `kick` times the sum of all forces over the mass [time],
   * :eq:`stage`; Δt for most integrators, 0 with `dt`.
   */
  double kick;
  /**
   * The displacement goes on by `dt` times (`velocity` + `push` times the sum of all forces over
   * the mass + `carry` times `past`) [time], :eq:`stage`; 0 with `dt`.
   */
  double push;
  /** See `push` [time]; 0 where `past` is null. */
  double carry;
  /** Acceleration of the evaluation before [length / time²], shape (node_count, 3), for integrators
   * that carry it on; or null. */
  const double *past;
  /**
   * Sum of the forces of the effects that stand before this one in the problem's list [force],
   * shape (node_count, 3); in `force` only.
   */
  const double *total;
  /** Velocity half a step back, v_{n-1/2} [length / time], before the kick, shape (node_count, 3).
   */
  const double *velocity;
  /** What the effect remembers from step n - 1 (memory_count doubles). */
  const double *memory;
  /** Where it writes what step n + 1 shall see. */
  double *next_memory;
  /** What `create_scratch` made for this state. */
  void *scratch;
  /**
   * Null, except for the first effect when `force` still holds what it wrote in its last call: then
   * a bit a node, node n being bit n % 64 of word n / 64, all 0. The effect may set the bit of a
   * node on which its force is zero, as it was in the last call, and leave that force as it stands,
   * :eq:`still-node`.
   */
  uint64_t *still;
  /**
   * Null, except for the first effect in the midst of ct_step_many: then a bit a node as in
   * ``still``, set for nodes that since the last call were only moved on with the velocity that
   * they had and have.
   */
  const uint64_t *drifted;
  /**
   * Null, except where ``drifted`` is not and each other effect is `local` or a reaction: then a
   * bit a node as in ``still``, all 0. The effect may set the bits of nodes that stand in a range
   * of `leaders`, :eq:`adrift-node`: until a call in which it does not set them, the time loop
   * moves the leader instead, so that their displacement in this view is an older one.
   */
  uint64_t *adrift;
  /**
   * As many as there are bodies; with ``adrift`` only. What the effect writes there stays, moved
   * on, as long as it sets bits of that range.
   */
  ct_leader *leaders;
  /** How many there are. */
  int32_t leader_count;
  /** Null, or for the first effect two counters: it adds the elements that it computes and those
   * that it leaves out. */
  int64_t *element_updates;
  /** Scratch space of the effect that this one `reads`, as its `force` has left it for the same
   * time; null without one. */
  const void *read;
  /**
   * What the effect has listed in `constrain` for the same time, with the forces that solve all
   * constraints together; in `force` only.
   */
  const ct_constraint *constraints;
  /** How many it has listed. */
  int64_t constraint_count;
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
  CT_EFFECT_ABSORB = 12
} ct_effect_kind;

/**
 * One physical effect: a force on some nodes, its energy, and its bound on the time step.
 * The time loop runs over the effects that a problem lists and over nothing else. Callbacks that do
 * not apply are null.
 */
typedef struct ct_effect {
  /** What the effect is; a host leaves it at ``CT_EFFECT_USER``. */
  ct_effect_kind kind;
  /** A label, which names a column of the ledger; the library decides nothing by it. */
  const char *name;
  /** What the effect's functions need, fixed once the problem is made; `free_data` gives it back.
   */
  void *data;
  /** Nodes that the force acts on, ascending; null when it acts on all nodes. */
  const int32_t *nodes;
  /** Number of nodes that the force acts on. */
  int32_t node_count;
  /** Doubles of the state that the effect keeps from step to step (a restart carries them). */
  int64_t memory_count;
  /**
   * Not zero: the effect holds degrees of freedom at a constant velocity (inverse mass 0). It has
   * no `force`; the time loop takes minus the sum of all other forces there, and keeps its impulse
   * only, as its work is impulse times velocity.
   */
  int reaction;
  /**
   * Not zero: the force needs `total` of all others, so only reactions and effects with a larger
   * `last` may stand after the effect in the problem's list.
   */
  int last;
  /**
   * Not zero: `constrain`, `path` and `force` read displacement and velocity of the effect's own
   * nodes only. Nodes that drift far from all effects are then moved together.
   */
  int local;
  /**
   * Floating-point operations of one call of `force`, about; 0: not told. A plan shows it, nothing
   * depends on it. An effect with `constrain` counts that call, too, and all its points as
   * pressing, but not the rounds of the iteration, which are :eq:`round-flops` times
   * `constraint_rounds` of the state.
   */
  double flops;
  /** Bytes that one call of `force` moves between memory and processor, about; 0: not told. */
  double bytes;
  /**
   * Null, or an effect that stands before this one in the problem's list and whose scratch space it
   * is shown as `read` of the view.
   */
  const struct ct_effect *reads;
  /** Most constraints that `constrain` can list. */
  int64_t constraint_count;
  /** Scratch space of one state. */
  ct_status (*create_scratch)(const struct ct_effect *effect, void **scratch, ct_error *error);
  /** Give the scratch space back. */
  void (*free_scratch)(void *scratch);
  /**
   * List the points that may press in this step into `list`, of room `constraint_count`; `count`
   * tells how many. The forces of all effects' constraints are then found together,
   * :eq:`constraint-problem`, with the forces of all effects known that stand before the first such
   * effect, and `force` is shown its own. What `memory` holds of the last step's force must go into
   * `list`, and `force` must write the present one into `next_memory`. Null: the effect has none.
   */
  ct_status (*constrain)(const struct ct_effect *effect, const ct_view *view, ct_constraint *list,
                         int64_t *count, ct_error *error);
  /**
   * Where an effect takes some degrees of freedom along a path, whatever the forces: write their
   * way until the next step, and NaN for the others, shape (node_count, 3) [length]. Constraints
   * reckon with it. Null: it takes none.
   */
  ct_status (*path)(const struct ct_effect *effect, const ct_view *view, double *way,
                    ct_error *error);
  /** Write the force on the effect's nodes, shape (node_count, 3) [force]. */
  ct_status (*force)(const struct ct_effect *effect, const ct_view *view, double *force,
                     ct_error *error);
  /** Stored energy for the same view, after `force` was called with it [energy]. */
  ct_status (*energy)(const struct ct_effect *effect, const ct_view *view, double *energy,
                      ct_error *error);
  /** Upper bound of what the effect adds to the largest ω² of the problem [1 / time²],
   * :eq:`step-bound`. */
  ct_status (*frequency)(const struct ct_effect *effect, const ct_view *view, double *omega_squared,
                         ct_error *error);
  /**
   * Upper bound of the largest eigenvalue of M⁻¹C [1 / time] for a force -C v that goes with the
   * velocity half a step back, :eq:`damped-step-bound`. Null for a force that does not depend on
   * velocity.
   */
  ct_status (*damping)(const struct ct_effect *effect, const ct_view *view, double *rate,
                       ct_error *error);
  /**
   * Work since t = 0 that comes in from outside through an effect that stores energy, as of a
   * moving obstacle [energy], for the view of the last `force`; the ledger books it as external.
   * Null: none does.
   */
  ct_status (*external)(const struct ct_effect *effect, const ct_view *view, double *work,
                        ct_error *error);
  /** Give `data` back. */
  void (*free_data)(void *data);
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

CT_END_DECLS

#endif
