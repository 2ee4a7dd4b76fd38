/* Contact of two surfaces, and of a surface with rigid obstacles, on a host's own arrays.
 * Threads: calls that take a const contact may use it at the same time. While ct_contact_update,
 * ct_contact_step, ct_contact_add_..., ct_contact_restore or ct_contact_free runs, no other call
 * may use that contact. Different contacts are independent. */
#ifndef LIBCONTACT_CONTACT_H
#define LIBCONTACT_CONTACT_H

#include <libcontact/constraint.h>
#include <libcontact/projection.h>

CT_BEGIN_DECLS

/** Positions of the contact points on a face, :eq:`unseen`. */
typedef enum ct_contact_rule {
  /** Gauss points, which lie at least 0.21 h from the edges of the face. */
  CT_POINTS_GAUSS,
  /** Points of Lobatto's rule, at corners, midpoints of edges and centres: the penetration of every
     corner is detected. */
  CT_POINTS_LOBATTO
} ct_contact_rule;

/** Treatment of points that penetrate by more than `adjust` at the start, :eq:`initial-shift`. */
typedef enum ct_initial {
  /** Apply the contact force at once; this adds the energy of the penalty to the bodies. */
  CT_INITIAL_FORCE,
  /**
   * Return CT_ERROR_GEOMETRY if a point is deeper than both `adjust` and the rounding of the
   * coordinates. The error gives the number of such points, and the position and depth of the
   * deepest.
   */
  CT_INITIAL_REFUSE,
  /** Measure the gap of each such point from its initial value until the gap has opened. No force
     acts at the start, so no energy is added. */
  CT_INITIAL_KEEP,
  /** As CT_INITIAL_KEEP, but the start gaps decrease to zero within the time `removal_time`; their
     work counts as external in the energy balance. */
  CT_INITIAL_REMOVE
} ct_initial;

/** Options of a contact. Start from `ct_contact_options_default`. */
typedef struct ct_contact_options {
  /** Set by `ct_contact_options_default`. */
  int32_t cookie;
  /** Penalty ε [stress / length], > 0; see `ct_contact_penalty`. */
  double epsilon;
  /** Method that finds the closest point. The unconstrained methods miss points whose closest point
   * lies on an edge between faces. */
  ct_method method;
  /** Tolerance of the search in half-widths of a face. */
  double tolerance;
  /**
   * Search distance D from a point to the other surface [length]. A point that is first found
   * deeper than D below a face is not in contact with it; a point that came from outside is in
   * contact at any depth, :eq:`point-status`. 0 selects D automatically: the largest face size at t
   * = 0 and in the first update of two surfaces; afterwards the width of the narrowest face or 3/4
   * of the smallest thickness, but at least twice `adjust`, :eq:`contact-near`.
   */
  double depth;
  /** Number of threads; results do not depend on it. */
  int threads;
  /** The law by which `ct_contact_step` and the contact effect of a problem compute forces from
   * gaps. `ct_contact_update` does not know the time step and uses the explicit penalty. */
  ct_enforcement enforcement;
  /** Damping ratio ζ of the surface mode, 0 ... 1, :eq:`surface-damping`; for the energy-controlled
   * penalty. With 0, energy is conserved while contact lasts. */
  double dissipation;
  /**
   * Share of the energy lost at closing that a point holds and gives back when it opens, 0 ... 1,
   * :eq:`impact-reserve`; for the energy-controlled penalty. With 1, the default, bodies come to
   * rest only by damping; with 0 an impact stops the layer of nodes at the surface.
   */
  double restitution;
  /**
   * Time h / c₁ in which a wave crosses an element at the surface [time], >= 0, :eq:`travel-time`
   * if the bodies differ. Steps with a `restitution` above 0 need it and refuse 0, the default.
   */
  double travel_time;
  /** Positions of the points; default: Gauss points. */
  ct_contact_rule points;
  /**
   * Treatment of points that penetrate at the start; default CT_INITIAL_KEEP. `ct_contact_step` and
   * the effect use `initial_penetration` and `adjust`; `ct_contact_update` ignores them.
   */
  ct_initial initial_penetration;
  /** Time in which CT_INITIAL_REMOVE separates the surfaces [time], > 0; otherwise not read. */
  double removal_time;
  /**
   * Distance within which gaps and overlaps at the start count as touching [length], >= 0 and at
   * most the depth. The gap of such a point is measured from its initial value,
   * :eq:`initial-adjust`. Default 0: no gap is closed.
   */
  double adjust;
  /** Tolerance of the forces of a step, 1e-12 ... 0.1, :eq:`force-tolerance`; 0: 1e-4. */
  double force_tolerance;
} ct_contact_options;

/**
 * Default options: CT_ROBUST, tolerance 1e-10, depth 0, one thread, energy-controlled penalty with
 * dissipation 0.15 and restitution 1, CT_INITIAL_KEEP, force_tolerance 1e-4. ``epsilon`` and
 * ``travel_time`` are 0; the caller must set them.
 */
CT_API ct_contact_options ct_contact_options_default(void);

/** Penalty ε = β E / h [stress / length], :eq:`penalty-factor`. β between 3 and 5 suits Courant
 * numbers near 0.125. */
CT_API double ct_contact_penalty(double beta, double young, double h);

/**
 * Default penalty of an enforcement [stress / length], :eq:`penalty-default`: 40 M / h for the
 * energy-controlled penalty and 4 M / h for the others. M = ρ c₁² is the smaller modulus of the two
 * materials, h the shortest edge of their elements.
 */
CT_API double ct_contact_penalty_default(ct_enforcement enforcement, double modulus, double h);

/** The contact of two surfaces; opaque. */
typedef struct ct_contact ct_contact;

/**
 * Prepare the contact of two surfaces, each of which is slave in one pass and master in the other.
 * The surfaces' arrays are copied.
 *
 * If `a` and `b` are the same pointer, the surface is in contact with itself, as in a fold, two
 * layers, or the ends of a C. For every point the closest face is found that shares no node with
 * the point's own face and does not point in the same direction, :eq:`self-adjacent`. A point below
 * this face is in contact under two conditions. Its depth is less than half the body's thickness
 * there in the reference shape, :eq:`self-depth`; and its motion since the last update can explain
 * the depth, :eq:`self-status`. Parts that overlap in the reference shape come into contact only
 * after they have separated. The calls below then neither read nor write the arguments of surface
 * b, which may be null.
 *
 * If `b` is null, the surface is in contact only with the obstacles of `ct_contact_add_obstacle`.
 * All options must be valid, but only `threads` is used.
 *
 * ``CT_ERROR_ARGUMENT``: empty surface, node number out of range, coordinates not finite, an option
 * out of its range; ``CT_ERROR_GEOMETRY``: a face without area (`error` names the body 0 or 1 and
 * the face).
 */
CT_API ct_status ct_contact_create(const ct_surface *a, const ct_surface *b,
                                   const ct_contact_options *options, ct_contact **out,
                                   ct_error *error);

/**
 * Find the points in contact at the current coordinates `xa`, `xb` [length], shapes (node_count of
 * a surface, 3), and compute forces and energy. ``CT_INVALID``: a coordinate is not finite (`error`
 * names body and node); the contact then stays as the last successful call left it.
 */
CT_API ct_status ct_contact_update(ct_contact *contact, const double *xa, const double *xb,
                                   ct_error *error);

/**
 * Add the contact forces of the last update or step to `fa`, `fb` [force], shapes (node_count, 3);
 * after a step also the forces of obstacles and friction. With obstacles or friction, two surfaces
 * on one array of nodes need one array of forces: ``CT_ERROR_ARGUMENT`` for two, and no force is
 * added then. This call and all calls below that take a const contact only read it, so several
 * threads may use one contact at the same time.
 */
CT_API ct_status ct_contact_add_force(const ct_contact *contact, double *fa, double *fb,
                                      ct_error *error);

/**
 * Energy stored by the contact after the last update or step [energy]: the potential Π of
 * :eq:`contact-potential`, or the energy of the solved forces, :eq:`controlled-energy`. After a
 * step it includes the energy of obstacles and what friction stores, :eq:`slip-held`.
 */
CT_API double ct_contact_energy(const ct_contact *contact);

/**
 * State of a host at t_n and all forces except those of the contact, from which the host would
 * compute its next step v_{n+1/2} = v_{n-1/2} + force_time f / m, x_{n+1} = x_n + dt v_{n+1/2},
 * :eq:`host-step`. The host writes all members. Arrays have the shape (node_count, 3) of a surface;
 * those of surface b are not read for the contact of a surface with itself. If both surfaces use
 * one array of reference coordinates, they must use one array here, too.
 */
typedef struct ct_contact_prediction {
  /** Coordinates x_n [length]. */
  const double *x_a, *x_b;
  /** Velocities v_{n-1/2} of the motion to x_n [length / time]; v_0 in the first step. */
  const double *velocity_a, *velocity_b;
  /** Sum of all other forces f_n [force]; null: none. */
  const double *force_a, *force_b;
  /** Inverse masses 1 / m of all components [1 / mass], >= 0; 0 where the motion is prescribed. */
  const double *inverse_mass_a, *inverse_mass_b;
  /**
   * Displacement increments x_{n+1} - x_n without the contact [length], for prescribed motions and
   * for hosts with damping or another update of positions; `force` is then not read. Null: the
   * increments of the step above.
   */
  const double *increment_a, *increment_b;
  /** Length Δt of the next step [time], > 0. */
  double dt;
  /**
   * Time for which f_n changes the velocity [time], > 0: Δt, half of it in the first step, which
   * begins with v_0, and the mean of two steps of different length. In the first step any value up
   * to Δt is accepted. Without `increment`, other values are rejected.
   */
  double force_time;
} ct_contact_prediction;

/**
 * Contact in one step of a host's own time loop, as in a scene. The call finds the points in
 * contact at x_n and solves for the forces of all points, including those of obstacles and of
 * friction, together, :eq:`constraint-problem`, :eq:`slip-problem`. Call it once per step; the
 * contact stores what the next step needs. `ct_contact_add_force` then adds the forces to f_n. The
 * energy-controlled penalty does not change the stable step of the host. For steps of equal length
 * the bodies get back at most what they have given to the contact, and a thousandth of it,
 * :eq:`admitted-account`. A point that is found inside without having come in through the surface
 * counts from there, :eq:`admitted`. With CT_ENFORCE_PENALTY the forces are those of
 * `ct_contact_update`. Start gaps are measured in the first call, which also allocates; later calls
 * allocate only if lists of candidates grow. That the velocities lead to x_n is not checked.
 * ``CT_ERROR_ARGUMENT``: a missing pointer, or an invalid time. ``CT_INVALID``: a number at a node
 * of a surface is not finite, or an inverse mass is negative (`error` names surface and node); the
 * contact then stays as the last successful call left it. ``CT_ERROR_GEOMETRY``: surfaces overlap
 * at the start and CT_INITIAL_REFUSE was chosen. ``CT_ERROR_STEP``: the surfaces may have passed
 * through each other in the last step. ``CT_ERROR_BLOWUP``: forces are not finite.
 */
CT_API ct_status ct_contact_step(ct_contact *contact, const ct_contact_prediction *prediction,
                                 ct_error *error);

/** Energy balance of a contact; `ct_contact_balance_of` writes all members. */
typedef struct ct_contact_balance {
  /** Energy stored by the contact at t_n [energy], as `ct_contact_energy`. */
  double energy;
  /**
   * Work of its forces, including obstacles and friction, on the bodies from t_0 to t_n [energy],
   * :eq:`host-work`. The sum `energy` + `work` - `removal` - `motion` does not
   * grow, for steps of equal length in which gaps are linear in the motion. Where they are not, it
   * may grow again after a loss; without obstacles it stays below its value at the start.
   */
  double work;
  /** Work of the decreasing start gaps, also of obstacles [energy], :eq:`initial-work`. */
  double removal;
  /** Number of steps in which the forces did not converge. */
  int64_t unconverged;
  /** Energy dissipated by friction [energy], :eq:`friction-dissipation`. */
  double friction;
  /** Work of moving obstacles on the bodies [energy], :eq:`obstacle-work`. */
  double motion;
  /**
   * Number of points that were found deeper than 0.01 of the largest face without having come in
   * through the surface, :eq:`admitted`; a point counts each time.
   */
  int64_t late;
  /** Largest of their depths [length]. */
  double late_depth;
} ct_contact_balance;

/** Energy balance of a contact after `ct_contact_step`. ``CT_ERROR_ARGUMENT``: the last call was
 * not a successful step. */
CT_API ct_status ct_contact_balance_of(const ct_contact *contact, ct_contact_balance *out,
                                       ct_error *error);

/**
 * Write into `memory` what the contact needs to continue after the last successful step with the
 * same bits, unless `memory` is null. Returns the number of doubles, 0 for a null contact; it
 * changes only if an obstacle or friction is added.
 */
CT_API int64_t ct_contact_save(const ct_contact *contact, double *memory);

/**
 * Continue from the `count` doubles that `ct_contact_save` has written for a contact with the same
 * definition. The next call must be a step; until then there are no forces. ``CT_ERROR_ARGUMENT``:
 * another number of doubles; ``CT_INVALID``: numbers that `ct_contact_save` cannot have written.
 * After an error the contact is unchanged.
 */
CT_API ct_status ct_contact_restore(ct_contact *contact, const double *memory, int64_t count,
                                    ct_error *error);

/** Resultant force on each surface and its moment about the origin [force, force · length], without
 * obstacles and friction. The sums over both surfaces are zero to round-off. */
CT_API ct_status ct_contact_resultant(const ct_contact *contact, double force_a[3],
                                      double moment_a[3], double force_b[3], double moment_b[3],
                                      ct_error *error);

/**
 * Largest stable step of `ct_contact_step` for the contact alone [time], 2 / ω. Only explicit
 * penalties, :eq:`contact-bound`, limit it; without them it is infinite, and a host keeps its own
 * step. A host combines it with its own limit dt_host as 1 / sqrt(1 / dt² + 1 / dt_host²),
 * :eq:`step-bound`. `mass_a`, `mass_b`: nodal masses, shapes (node_count). ``CT_ERROR_ARGUMENT``:
 * null argument, or a mass that is not positive.
 */
CT_API ct_status ct_contact_stable_step(const ct_contact *contact, const double *mass_a,
                                        const double *mass_b, double *dt, ct_error *error);

/**
 * The same for the explicit penalty of `ct_contact_update`, whatever the enforcement, with every
 * point active on its closest face, :eq:`contact-bound`.
 */
CT_API ct_status ct_contact_update_stable_step(const ct_contact *contact, const double *mass_a,
                                               const double *mass_b, double *dt, ct_error *error);

/** Free a contact; null is allowed. */
CT_API void ct_contact_free(ct_contact *contact);

/** Shape of a rigid obstacle. */
typedef enum ct_obstacle_shape {
  /** half-space behind a plane; a point at any depth below the plane penetrates */
  CT_OBSTACLE_PLANE = 0,
  /** solid sphere */
  CT_OBSTACLE_SPHERE = 1,
  /** solid cylinder without ends */
  CT_OBSTACLE_CYLINDER = 2
} ct_obstacle_shape;

/** A rigid obstacle in contact with a surface of a body, :eq:`obstacle-potential`, at rest, moving
 * as given, or carried by a rigid body. Start from `ct_obstacle_def_default`. */
typedef struct ct_obstacle_def {
  /** Written by `ct_obstacle_def_default`. */
  int32_t cookie;
  /** Plane, sphere or cylinder. */
  ct_obstacle_shape shape;
  /** A point of the plane, the centre of the sphere, a point of the cylinder's axis, at t = 0
   * [length]. */
  double point[3];
  /** Normal of the plane, out of the obstacle, or direction of the cylinder's axis; not 0. */
  double axis[3];
  /** Radius of sphere or cylinder [length], > 0; not read for a plane. */
  double radius;
  /** Penalty ε [stress / length], > 0; see `ct_contact_penalty`. */
  double epsilon;
  /** Law by which forces follow from gaps. */
  ct_enforcement enforcement;
  /** Damping ratio, restitution and travel time h / c₁, as in ct_contact_options. */
  double dissipation, restitution, travel_time;
  /** Positions of the points on the faces; default: Gauss points. */
  ct_contact_rule points;
  /** Treatment of points that penetrate at the start; default CT_INITIAL_KEEP. */
  ct_initial initial_penetration;
  /** Time of CT_INITIAL_REMOVE, and the distance that counts as touching, as in
   * ct_contact_options. */
  double removal_time, adjust;
  /** Constant velocity [length / time]. */
  double velocity[3];
  /** Displacement that the amplitude multiplies [length]; zero without an amplitude. */
  double travel[3];
  /** The displacement of the obstacle is velocity times time plus `travel` times this factor,
   * :eq:`obstacle-motion`; an amplitude without points means no travel. */
  ct_amplitude amplitude;
  /** Kind of the surface's faces. */
  ct_face_kind kind;
  /** Number of faces of the surface. */
  int32_t face_count;
  /** Node numbers of the problem, counter-clockwise from outside, shape (face_count, nodes of a
   * face). */
  const int32_t *faces;
  /** Number of the rigid body of the problem that carries the obstacle, so that it moves and turns
   * by its forces, without `velocity` and `travel`; null: none. Not for a host's contact, nor for
   * the explicit penalty. */
  const int32_t *carrier;
} ct_obstacle_def;

/** A plane at rest with the energy-controlled penalty, dissipation 0.15, restitution 1 and
 * CT_INITIAL_KEEP; the caller must set the other members, also ``travel_time``. */
CT_API ct_obstacle_def ct_obstacle_def_default(void);

/** The same with a plane through `point` [length]; its `normal` points out of the obstacle. */
CT_API ct_obstacle_def ct_obstacle_def_plane(const double point[3], const double normal[3]);

/** The same with a sphere [length]. */
CT_API ct_obstacle_def ct_obstacle_def_sphere(const double centre[3], double radius);

/** The same with a cylinder [length], whose `axis` passes through `centre`. */
CT_API ct_obstacle_def ct_obstacle_def_cylinder(const double centre[3], const double axis[3],
                                                double radius);

/**
 * Add an obstacle for all faces of surface `side` (0 or 1) of a host's contact; `ct_contact_step`
 * computes its forces. `kind`, `face_count` and `faces` of the definition are not read. Obstacles
 * are numbered from 0; their time is 0 in the first step. All arrays are copied.
 * ``CT_ERROR_ARGUMENT``: unknown surface, a step was already taken, or an error of
 * `ct_obstacle_create_effect`.
 */
CT_API ct_status ct_contact_add_obstacle(ct_contact *contact, int32_t side,
                                         const ct_obstacle_def *obstacle, ct_error *error);

/**
 * Add Coulomb friction to `ct_contact_step`: on obstacle `on`, or with `on` = -1 between the
 * surfaces. `coefficient` is μ > 0 and `tangent` > 0 the stiffness of the tangential spring over
 * that of the penalty, as in :c:struct:`ct_friction_def`; it does not limit the step.
 * ``CT_ERROR_ARGUMENT``: unknown obstacle, friction was already added there, a step was already
 * taken, μ or `tangent` not positive.
 */
CT_API ct_status ct_contact_add_friction(ct_contact *contact, int32_t on, double coefficient,
                                         double tangent, ct_error *error);

/**
 * Let this contact be one piece of several, each with its own `ct_contact` of the same surfaces,
 * obstacles and friction, for a model that is distributed over processes. `owned_a`, `owned_b`,
 * shapes (face_count), not 0 for the faces whose points this piece computes; each face has one
 * piece. Every piece passes the same arrays at all nodes of the surfaces, as a host without pieces
 * does, and gets the forces at all of them, with the bits of one contact that has all faces. From
 * here on all pieces make the same calls on their contacts at the same time, because each may
 * exchange numbers. `ct_contact_points` and `ct_contact_penetration` tell of the own points only,
 * and `ct_contact_save` writes those. Masks and `pieces` are copied. Call it before the first step.
 * ``CT_ERROR_ARGUMENT``: null argument, a step was already taken, the contact is in pieces already,
 * or a face has no piece or several (`error` names surface and face).
 */
CT_API ct_status ct_contact_set_pieces(ct_contact *contact, const uint8_t *owned_a,
                                       const uint8_t *owned_b, const ct_pieces *pieces,
                                       ct_error *error);

/**
 * Force of the bodies on an obstacle of a host's contact in the last step, including friction
 * [force], and the work of its motion on the bodies [energy], :eq:`obstacle-work`.
 * ``CT_ERROR_ARGUMENT``: null argument, unknown obstacle, or the last call was not a successful
 * step.
 */
CT_API ct_status ct_contact_reaction(const ct_contact *contact, int32_t obstacle, double force[3],
                                     double *work, ct_error *error);

CT_END_DECLS

#endif
