/* The contact of two surfaces over a host's own arrays, and contacts, obstacles and friction as
 * effects.
 * Threads: a call that takes a const contact may run at once with others of its kind;
 * ct_contact_update, ct_contact_step, ct_contact_add_..., ct_contact_restore and ct_contact_free
 * must be alone with their contact. Different contacts are independent. */
#ifndef LIBCONTACT_CONTACT_H
#define LIBCONTACT_CONTACT_H

#include <libcontact/shape.h>
#include <libcontact/projection.h>
#include <libcontact/search.h>
#include <libcontact/step.h>
#include <libcontact/effect.h>

CT_BEGIN_DECLS

/** Where on its faces a contact has points, :eq:`unseen`. */
typedef enum ct_contact_rule {
  /** Gauss points, which lie 0.21 h and more inside the face. */
  CT_POINTS_GAUSS,
  /** Points at corners, middles of edges and centres, Lobatto's rule: no corner can enter a face
     unseen. */
  CT_POINTS_LOBATTO
} ct_contact_rule;

/** What a contact as an effect does with points that are inside at the start, deeper than `adjust`,
 * :eq:`initial-shift`. */
typedef enum ct_initial {
  /** Push them out at once, which puts the energy of the penalty into the bodies. */
  CT_INITIAL_PUSH,
  /**
   * End with CT_ERROR_GEOMETRY if a point is deeper than `adjust` and than the rounding of the
   * coordinates; the error reports how many there are, and the place and depth of the deepest.
   */
  CT_INITIAL_REFUSE,
  /** Count the gap of each of them from where it starts, until it has opened. Nothing is pushed, so
     no energy is added. */
  CT_INITIAL_KEEP,
  /** As CT_INITIAL_KEEP, but start gaps fade to nothing in the time `removal_time`; the ledger
     books their work as external. */
  CT_INITIAL_REMOVE
} ct_initial;

/** Choices of a contact. Start from `ct_contact_options_default`. */
typedef struct ct_contact_options {
  /** Penalty ε [stress / length], > 0; see `ct_contact_penalty`. */
  double epsilon;
  /** Search for the closest point. The unconstrained methods miss points whose closest
   * point lies on an edge between faces. */
  ct_method method;
  /** Tolerance of the search in half-widths of a face. */
  double tolerance;
  /**
   * How far points look for the other surface [length]. A point that is deeper than this under a
   * face when it is first seen is not in contact with it, :eq:`point-status`; one that came in
   * from outside is, at any depth. With 0 points look as far as the largest face size at t = 0 and
   * in the first update of two surfaces, and afterwards as far as the width of the narrowest face
   * or 3/4 of the thinnest place, but at least twice `adjust`, :eq:`contact-near`.
   */
  double depth;
  /** Threads; results do not depend on it. */
  int threads;
  /**
   * Not 0: no search while the surfaces are too far from each other to touch, :eq:`contact-clear`;
   * results do not depend on it.
   */
  int separated;
  /**
   * How `ct_contact_step` and the contact effect of a problem make forces of gaps;
   * `ct_contact_update`, which knows of no step, is always the explicit penalty.
   */
  ct_enforcement enforcement;
  /**
   * Damping ratio ζ of the surface mode, 0 ... 1, :eq:`surface-damping`; for the energy-controlled
   * penalty. With 0 lasting contact keeps all energy.
   */
  double dissipation;
  /** Where the points are; Gauss points. */
  ct_contact_rule points;
  /**
   * What becomes of points that are inside at the start; CT_INITIAL_KEEP by default.
   * `ct_contact_step` and the effect obey `initial_penetration` and `adjust`, `ct_contact_update`
   * does not.
   */
  ct_initial initial_penetration;
  /** Time in which CT_INITIAL_REMOVE parts the surfaces [time], > 0 with it. */
  double removal_time;
  /**
   * Distance within which gaps and overlaps at the start are taken as touching [length], >= 0 and
   * at most the depth: the gap of such a point counts from where it starts, :eq:`initial-adjust`.
   * 0, the default: no gap is closed.
   */
  double adjust;
} ct_contact_options;

/**
 * Default options: CT_ROBUST, tolerance 1e-10, depth 0, one thread, no search between separated
 * surfaces, energy-controlled penalty with dissipation 0.15, overlaps at the start kept.
 * ``epsilon`` is 0 and must be set.
 */
CT_API ct_contact_options ct_contact_options_default(void);

/** Penalty ε = β E / h [stress / length], :eq:`penalty-factor`. β between 3 and 5 suits Courant
 * numbers near 0.125. */
CT_API double ct_contact_penalty(double beta, double young, double h);

/**
 * The penalty that suits an enforcement [stress / length], :eq:`penalty-default`: 40 M / h for the
 * energy-controlled penalty and 4 M / h for the others, with the smaller modulus M = ρ c₁² of the
 * materials and the shortest edge h of their elements.
 */
CT_API double ct_contact_penalty_default(ct_enforcement enforcement, double modulus, double h);

/** The contact of two surfaces; opaque, as it holds the search tree. */
typedef struct ct_contact ct_contact;

/**
 * Prepare the contact of two surfaces (both are slave once and master once). The surfaces' arrays
 * are copied.
 *
 * With `a` and `b` the same pointer it is the contact of a surface with itself: a fold, two layers,
 * the ends of a C. Every point looks for the nearest face that shares no node with its own and does
 * not look the same way, :eq:`self-adjacent`. A point under this face is in contact if it is less
 * deep than half the body's thickness there in the reference shape, :eq:`self-depth`, and no deeper
 * than its motion since the last update can have brought it, :eq:`self-status`. Parts that overlap
 * in the reference shape meet only after they have come apart. In the calls below, what belongs to
 * surface b is neither read nor written then and may be null.
 *
 * With `b` null there is no contact: the surface meets the obstacles of `ct_contact_add_obstacle`
 * only, and of the options only `threads` matters, though all must be possible.
 *
 * ``CT_ERROR_ARGUMENT``: empty surface, node number out of range, coordinates not finite, ε not
 * positive;
 * ``CT_ERROR_GEOMETRY``: a face without area (`error` names the body 0 or 1 and the face).
 */
CT_API ct_status ct_contact_create(const ct_surface *a, const ct_surface *b,
                                   const ct_contact_options *options, ct_contact **out,
                                   ct_error *error);

/**
 * Find who meets whom at the current coordinates `xa`, `xb` [length], shapes (node_count of a
 * surface, 3), and compute forces and energy. ``CT_INVALID``: a coordinate is not finite (`error`
 * names body and node); all is then as the last good call left it.
 */
CT_API ct_status ct_contact_update(ct_contact *contact, const double *xa, const double *xb,
                                   ct_error *error);

/**
 * Add the contact forces of the last update or step to `fa`, `fb` [force], shapes (node_count, 3);
 * after a step also those of obstacles and friction. With them, two surfaces over one array of
 * nodes have one array of forces: ``CT_ERROR_ARGUMENT`` for two.
 * This and all calls below that take a const contact only read it: several threads may ask one
 * contact at once.
 */
CT_API ct_status ct_contact_add_force(const ct_contact *contact, double *fa, double *fb);

/**
 * Energy that the contact holds after the last update or step [energy]: the potential Π of
 * :eq:`contact-potential`, or that of the solved forces, :eq:`controlled-energy`; after a step with
 * that of obstacles and the elastic slip of friction, :eq:`friction-dissipation`.
 */
CT_API double ct_contact_energy(const ct_contact *contact);

/**
 * What a host knows at t_n of its coming step, once it has all forces but those of the contact.
 * The step is v_{n+1/2} = v_{n-1/2} + kick f / m, x_{n+1} = x_n + dt v_{n+1/2}, :eq:`host-step`.
 * Arrays have the shape (node_count, 3) of a surface; what belongs to surface b is not read for the
 * contact of a surface with itself. If both surfaces were given with one array of reference
 * coordinates, give one array for both here too.
 */
typedef struct ct_contact_prediction {
  /** Coordinates x_n [length]. */
  const double *x_a, *x_b;
  /** Velocities v_{n-1/2} [length / time]; in the first step v_0. */
  const double *velocity_a, *velocity_b;
  /** Sum of all other forces f_n [force]; null: none. */
  const double *force_a, *force_b;
  /** Inverse masses 1 / m of all components [1 / mass], >= 0; 0 where the motion is prescribed. */
  const double *inverse_mass_a, *inverse_mass_b;
  /**
   * Displacement increments x_{n+1} - x_n without the contact [length], for motions that are
   * prescribed and for hosts with damping or another drift; null: those of the step above. `force`
   * is not read then.
   */
  const double *increment_a, *increment_b;
  /** Length Δt of the coming step [time], > 0. */
  double dt;
  /**
   * Time for which f_n changes the velocity [time], > 0: Δt; half of it in the first step, which
   * begins with v_0; and the mean of two steps where they differ. Without `increment` a time that
   * is none of these is refused; in the first step any up to Δt is good.
   */
  double kick;
} ct_contact_prediction;

/**
 * The contact of a host's own time loop in one step, as that of a scene: find who meets whom at
 * x_n, and solve for the forces of all points together, :eq:`constraint-problem`, those of
 * obstacles among them, by the law in the options; and then for those of friction. Call it once per
 * step; the contact remembers what the next step needs. Then `ct_contact_add_force` adds the forces
 * to f_n. They leave the stable step of the host as it is and, for steps of one length in which
 * gaps are linear in the motion, never add energy, :eq:`controlled-energy`. With CT_ENFORCE_PENALTY
 * they are those of `ct_contact_update`. Start gaps begin at the first call, which also allocates;
 * later calls do so only where lists of candidates grow.
 * ``CT_ERROR_ARGUMENT``: a pointer is missing, or a time impossible. ``CT_INVALID``: a number at
 * a node of a surface is not finite, or an inverse mass negative (`error` names surface and node);
 * all is then as the last good call left it.
 * ``CT_ERROR_GEOMETRY``: surfaces overlap at the start and CT_INITIAL_REFUSE was chosen.
 * ``CT_ERROR_STEP``: the last step may have brought the surfaces through each other.
 * ``CT_ERROR_BLOWUP``: forces are not finite.
 */
CT_API ct_status ct_contact_step(ct_contact *contact, const ct_contact_prediction *prediction,
                                 ct_error *error);

/** Energy balance of the steps of a contact; everything is written by `ct_contact_balance_of`. */
typedef struct ct_contact_balance {
  /** Energy that the contact holds at t_n [energy], as `ct_contact_energy`. */
  double energy;
  /**
   * Work that its forces, with obstacles and friction, have done on the bodies from t_0 to t_n
   * [energy], :eq:`host-work`. Without friction the sum `energy` + `work` - `removal` - `motion`
   * never grows, for steps of one length in which gaps are linear in the motion.
   */
  double work;
  /** Work that start gaps have done while they fade [energy], :eq:`initial-work`. */
  double removal;
  /** Number of steps in which the forces did not converge. */
  int64_t unconverged;
  /** What friction has dissipated [energy], :eq:`friction-dissipation`. */
  double friction;
  /** Work that the motion of obstacles has put into the bodies [energy], :eq:`obstacle-work`. */
  double motion;
} ct_contact_balance;

/** Energy balance of a contact after `ct_contact_step`. ``CT_ERROR_ARGUMENT``: the last call was no
 * good step. */
CT_API ct_status ct_contact_balance_of(const ct_contact *contact, ct_contact_balance *out);

/**
 * What the contact must remember to continue after the last good step with the same bits: written
 * into `memory`, unless it is null. The number of doubles; 0 for a null contact. It changes only
 * when an obstacle or friction is added.
 */
CT_API int64_t ct_contact_save(const ct_contact *contact, double *memory);

/**
 * Go on from what `ct_contact_save` has written, `count` doubles of a contact that was made alike.
 * The next call must be a step; until then there are no forces.
 * ``CT_ERROR_ARGUMENT``: another number of doubles; ``CT_INVALID``: numbers that no contact has
 * saved. All is then as it was.
 */
CT_API ct_status ct_contact_restore(ct_contact *contact, const double *memory, int64_t count,
                                    ct_error *error);

/** Resultant force on each surface and its moment about the origin [force, force · length], without
 * obstacles and friction; their sums vanish to round-off. */
CT_API ct_status ct_contact_resultant(const ct_contact *contact, double force_a[3],
                                      double moment_a[3], double force_b[3], double moment_b[3]);

/**
 * Largest stable step of the contact alone [time], 2 / ω, with every point taken as active at
 * its nearest face, :eq:`contact-bound`, as the explicit penalty. With obstacles or friction it is
 * that of the forces of `ct_contact_step`: of friction, :eq:`friction-bound`, and of explicit
 * penalties; infinite where there are none. A host combines it with its own limit
 * dt_host as 1 / sqrt(1 / dt² + 1 / dt_host²), :eq:`step-bound`. `mass_a`, `mass_b`: nodal masses,
 * shapes (node_count).
 */
CT_API ct_status ct_contact_stable_step(const ct_contact *contact, const double *mass_a,
                                        const double *mass_b, double *dt);

/** One contact point, for pictures and tests. */
typedef struct ct_contact_point {
  /** 0: a point of surface a; 1: of surface b. */
  int32_t side;
  /** Face of the point. */
  int32_t face;
  /** Number of the point on its face. */
  int32_t point;
  /** Face of the other surface that it met, or -1. */
  int32_t other;
  /** Position y [length]. */
  double position[3];
  /** Closest point ȳ on the other surface [length]; NaN when `other` is -1. */
  double closest[3];
  /** Parameters of ȳ on the other face. */
  double xi[2];
  /**
   * Gap that the contact law sees [length], negative where the point is in contact: the signed
   * distance less `start_gap`; NaN when `other` is -1.
   */
  double gap;
  /** Traction [stress]: ε⟨-g⟩, or that of the enforcement. */
  double pressure;
  /** Weight w J_ref [area]. */
  double weight;
  /**
   * Start gap [length] that `gap` counts from, :eq:`initial-shift`: negative for an overlap that is
   * kept, positive for a gap that was adjusted, else 0. The signed distance of the point from the
   * other surface is `gap` + `start_gap`.
   */
  double start_gap;
} ct_contact_point;

/** Number of Gauss points of both surfaces, those of a first. */
CT_API int64_t ct_contact_point_count(const ct_contact *contact);

/** The points of the last update, `points` of shape (ct_contact_point_count). */
CT_API ct_status ct_contact_points(const ct_contact *contact, ct_contact_point *points);

/**
 * Tractions at the nodes of surface `side` (0 or 1), recovered from the forces of the last update
 * or step, without friction, or, with `side` = 2 + k, those of obstacle k at the nodes of the
 * surface that meets it; averaged over both passes and the faces around a node,
 * :eq:`recovered-traction`. The pressure at a node is the size of its traction. Areas times
 * tractions add up to the force on the surface, and their moments to its moment where edges are
 * straight. Entries of nodes that are not on the surface are left as they are.
 *
 * `traction` [stress], shape (node_count, 3): force on the surface per reference area; at a
 * mid-side node the mean of the two corners, and 0 where no face carries forces. `area` [area],
 * shape (node_count): the part of the faces in contact that belongs to a corner; 0 at mid-sides.
 * ``CT_ERROR_ARGUMENT``: null argument, no such side; ``CT_ERROR_MEMORY``.
 */
CT_API ct_status ct_contact_traction(const ct_contact *contact, int32_t side, double *traction,
                                     double *area, ct_error *error);

/** Places where penetration is looked for. */
typedef enum ct_penetration_at {
  /** The points of the contact. */
  CT_AT_POINTS,
  /** The corners of all faces. */
  CT_AT_CORNERS,
  /** The middles of the edges of all faces. */
  CT_AT_EDGES
} ct_penetration_at;

/**
 * How far two surfaces are inside each other, by true distances, whatever start gaps there are;
 * everything is written by `ct_contact_penetration`.
 */
typedef struct ct_penetration {
  /** Number of places inside; a corner or an edge counts once for each face. */
  int64_t inside;
  /**
   * Of them, points that are inside without being in contact, as they did not come in from outside,
   * :eq:`point-status`; 0 at corners and edges.
   */
  int64_t buried;
  /** Depth of the deepest place that is not buried [length]; 0 when there is none. */
  double deepest;
  /** 0 or 1: the surface that the deepest place belongs to; -1 when there is none. */
  int32_t side;
  /** Its face; -1 when there is none. */
  int32_t face;
  /** Its position [length]; NaN when there is none. */
  double position[3];
  /**
   * Depth [length] up to which two surfaces only touch: 1e-9 of the largest face, or the rounding
   * of their coordinates if that is more.
   */
  double touching;
} ct_penetration;

/**
 * Penetration at the coordinates of the last update, at the contact's points, or at corners or
 * edges, which a contact with Gauss points does not look at. ``CT_ERROR_UNSUPPORTED``: corners or
 * edges of a surface in contact with itself.
 */
CT_API ct_status ct_contact_penetration(const ct_contact *contact, ct_penetration_at at,
                                        ct_penetration *out);

/** Free a contact; null is allowed. */
CT_API void ct_contact_free(ct_contact *contact);

/** A contact as an effect of a problem. Start from `ct_contact_def_default`. */
typedef struct ct_contact_def {
  /** Written by `ct_contact_def_default`. */
  int32_t cookie;
  /** Two surfaces, whose nodes and reference coordinates are the problem's; the same pointer twice
   * for the contact of a surface with itself. */
  const ct_surface *a, *b;
  /** Choices of the contact. */
  ct_contact_options options;
} ct_contact_def;

/** Default options; the surfaces and the penalty must be set. */
CT_API ct_contact_def ct_contact_def_default(void);

/** The effect of a contact. The problem's masses and coordinates are not copied. */
CT_API ct_status ct_contact_create_effect(const ct_contact_def *def, const ct_problem *problem,
                                          ct_effect **effect, ct_error *error);

/**
 * The contact of an effect at the state's time, for `ct_contact_points` and `ct_contact_resultant`:
 * which surfaces touch, gaps and pressures. It lives as long as the state, and the next step
 * changes it. Null, with `error` filled, for an effect that is no contact.
 */
CT_API const ct_contact *ct_state_contact(const ct_problem *problem, ct_state *state,
                                          int32_t effect, ct_error *error);

/** Shape of a rigid obstacle. */
typedef enum ct_obstacle_shape {
  /** half-space behind a plane; any depth below the plane is inside */
  CT_OBSTACLE_PLANE = 0,
  /** solid sphere */
  CT_OBSTACLE_SPHERE = 1,
  /** solid cylinder without ends */
  CT_OBSTACLE_CYLINDER = 2
} ct_obstacle_shape;

/** A rigid obstacle against a surface of a body, :eq:`obstacle-potential`. It may move, but does
 * not turn. Start from `ct_obstacle_def_default`. */
typedef struct ct_obstacle_def {
  /** Written by `ct_obstacle_def_default`. */
  int32_t cookie;
  /** Plane, sphere or cylinder. */
  ct_obstacle_shape shape;
  /** A point of the plane, the centre of the sphere, a point of the cylinder's axis, at t = 0
   * [length]. */
  double point[3];
  /** Normal of the plane out of the obstacle, or direction of the cylinder's axis, of any length;
   * not read for a sphere. */
  double axis[3];
  /** Radius of sphere or cylinder [length], > 0; not read for a plane. */
  double radius;
  /** Penalty ε [stress / length], > 0; see `ct_contact_penalty`. */
  double epsilon;
  /** How gaps give forces. */
  ct_enforcement enforcement;
  /**
   * Damping ratio ζ of the surface mode, 0 ... 1, :eq:`surface-damping`; for the energy-controlled
   * penalty. With 0 lasting contact keeps all energy.
   */
  double dissipation;
  /** Constant velocity [length / time]. */
  double velocity[3];
  /** What the amplitude's factor multiplies [length]; zero without an amplitude. */
  double travel[3];
  /** Its displacement is velocity times time plus `travel` times this factor,
   * :eq:`obstacle-motion`; no points: no travel. */
  ct_amplitude amplitude;
  /** Kind of the surface's faces. */
  ct_face_kind kind;
  /** Number of faces of the surface. */
  int32_t face_count;
  /** Node numbers of the problem, counter-clockwise from outside, shape (face_count, nodes of a
   * face). */
  const int32_t *faces;
} ct_obstacle_def;

/** A plane at rest with the energy-controlled penalty and dissipation 0.15; the rest must be set.
 */
CT_API ct_obstacle_def ct_obstacle_def_default(void);

/**
 * Add an obstacle that surface `side` (0 or 1) of a host's contact meets in `ct_contact_step`, with
 * all its faces: `kind`, `face_count` and `faces` of the definition are not read. Obstacles count
 * from 0; their time is 0 in the first step. Everything is copied.
 * ``CT_ERROR_ARGUMENT``: no such surface, a step was taken, or what `ct_obstacle_create_effect`
 * refuses.
 */
CT_API ct_status ct_contact_add_obstacle(ct_contact *contact, int32_t side,
                                         const ct_obstacle_def *obstacle, ct_error *error);

/**
 * Add Coulomb friction to `ct_contact_step`: of obstacle `on`, or with `on` = -1 between the
 * surfaces, with the coefficient μ > 0 and the ratio ρ > 0 of the tangential penalty to the normal
 * one, as in :c:struct:`ct_friction_def`. Its springs limit the step, see `ct_contact_stable_step`.
 * ``CT_ERROR_ARGUMENT``: no such obstacle, friction there already, a step was taken, μ or ρ not
 * positive.
 */
CT_API ct_status ct_contact_add_friction(ct_contact *contact, int32_t on, double coefficient,
                                         double tangent, ct_error *error);

/**
 * Force of the bodies on an obstacle of a host's contact in the last step, with its friction
 * [force], and the work that its motion has put into the bodies [energy], :eq:`obstacle-work`.
 * ``CT_ERROR_ARGUMENT``: null argument, no such obstacle, or the last call was no good step.
 */
CT_API ct_status ct_contact_reaction(const ct_contact *contact, int32_t obstacle, double force[3],
                                     double *work);

/**
 * The effect of one obstacle. It stores the penalty's energy; work of its motion is external.
 * ``CT_ERROR_ARGUMENT``: penalty or radius not positive, no axis, no faces, node out of range,
 * amplitude not ascending, travel without an amplitude.
 */
CT_API ct_status ct_obstacle_create_effect(const ct_obstacle_def *def, const ct_problem *problem,
                                           ct_effect **effect, ct_error *error);

/**
 * Force of the bodies on an obstacle at the state's time [force] and the work that its motion has
 * put into the bodies since t = 0 [energy], :eq:`obstacle-work`. ``CT_ERROR_ARGUMENT``: effect
 * number `effect` is no obstacle.
 */
CT_API ct_status ct_obstacle_reaction(const ct_problem *problem, ct_state *state, int32_t effect,
                                      double force[3], double *work, ct_error *error);

/**
 * Tractions at the nodes of the surface that meets an obstacle, at the state's time, as
 * `ct_contact_traction`; `traction` and `area` have the problem's nodes.
 */
CT_API ct_status ct_obstacle_traction(const ct_problem *problem, ct_state *state, int32_t effect,
                                      double *traction, double *area, ct_error *error);

/**
 * Contact pressure at the nodes of a problem at the state's time [stress], shape (node_count): the
 * sizes of the tractions of all contacts and obstacles, added where a node belongs to several; 0
 * elsewhere, :eq:`recovered-traction`.
 */
CT_API ct_status ct_state_pressure(const ct_problem *problem, ct_state *state, double *pressure,
                                   ct_error *error);

/** Coulomb friction with stick on the points of a contact or of an obstacle. Start from
 * `ct_friction_def_default`. */
typedef struct ct_friction_def {
  /** Written by `ct_friction_def_default`. */
  int32_t cookie;
  /**
   * The effect that friction acts on: one of `ct_contact_create_effect` or
   * `ct_obstacle_create_effect`. It must outlive the friction and stand before it.
   */
  const ct_effect *on;
  /** Coefficient μ of friction, > 0. */
  double coefficient;
  /** Ratio ρ of the tangential penalty to the normal one, > 0. */
  double tangent;
} ct_friction_def;

/** ρ = 1; `on` and `coefficient` must be set. */
CT_API ct_friction_def ct_friction_def_default(void);

/**
 * The effect of friction: tangential forces in stick and in slip. It stores nothing in the ledger;
 * its work counts there as that of outside forces and is minus what it holds and has dissipated.
 * ``CT_ERROR_ARGUMENT``: no contact or obstacle to act on, μ or ρ not positive.
 */
CT_API ct_status ct_friction_create_effect(const ct_friction_def *def, const ct_problem *problem,
                                           ct_effect **effect, ct_error *error);

/**
 * What friction holds as elastic slip at the state's time, and what it has dissipated since t = 0
 * [energy], :eq:`friction-dissipation`.
 */
CT_API ct_status ct_friction_energy(const ct_problem *problem, ct_state *state, int32_t effect,
                                    double *held, double *dissipated, ct_error *error);

CT_END_DECLS

#endif
