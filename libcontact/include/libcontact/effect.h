/* Effects of the library: solid bodies, supports, prescribed motions, loads, gravity, damping,
 * viscosity, absorbing faces, ties, rigid bodies; and the filter of output fields.
 * Threads: effects may be created at any time. An effect is constant, so several states may use it
 * at the same time. */
#ifndef LIBCONTACT_EFFECT_H
#define LIBCONTACT_EFFECT_H

#include <libcontact/solid.h>
#include <libcontact/step.h>

CT_BEGIN_DECLS

/** The bodies of the solid effect. */
typedef struct ct_solid_def {
  /** Set by `ct_solid_def_default`. */
  int32_t cookie;
  /** The bodies in ascending order of `first_node` without gaps, shape (body_count). */
  const ct_solid_body *bodies;
  /** Number of bodies. */
  int32_t body_count;
} ct_solid_def;

/** A definition with its cookie set and all other members zero. */
CT_API ct_solid_def ct_solid_def_default(void);

/**
 * Create the effect "solid" of all bodies. Meshes must outlive the effect; `problem` is not read
 * and may be null. ``CT_ERROR_UNSUPPORTED``: the requested kernel cannot compute a body. With a law
 * for large deformation, `force` returns ``CT_ERROR_GEOMETRY`` (`error` names body and element) if
 * an element is inverted, and the bound on the step is that of the tangent stiffness.
 */
CT_API ct_status ct_solid_create_effect(const ct_solid_def *def, const ct_problem *problem,
                                        ct_effect **effect, ct_error *error);

/**
 * Create the effect "hourglass" of a solid effect with bodies of CT_KERNEL_REDUCED. Its stored
 * energy is that of the hourglass control, which the energy of the solid effect does not include.
 * It has no force of its own, because the force of the solid effect includes the hourglass force.
 * `*effect` is null, with CT_OK, if no body has that kernel. The solid effect must outlive it.
 */
CT_API ct_status ct_solid_create_hourglass(const ct_effect *solid, ct_effect **effect,
                                           ct_error *error);

/** Write the kernel that the effect uses for a body, and the flops and bytes per update of one
 * element (estimates). */
CT_API ct_status ct_solid_body_plan(const ct_effect *effect, int32_t body, ct_solid_kernel *kernel,
                                    double *flops, double *bytes, ct_error *error);

/** Prescribed constant velocity of some components of a set of nodes; 0 for a fixed end or a plane
 * of symmetry. */
typedef struct ct_support {
  /** Node numbers of the problem, shape (node_count). */
  const int32_t *nodes;
  /** Number of nodes. */
  int32_t node_count;
  /** Which of x, y, z are prescribed (0 or 1). */
  int fixed[3];
  /** Their velocity [length / time]. */
  double velocity[3];
} ct_support;

/** All supports of a problem. */
typedef struct ct_support_def {
  /** Set by `ct_support_def_default`. */
  int32_t cookie;
  /** The supports, shape (support_count). */
  const ct_support *supports;
  /** Number of supports. */
  int32_t support_count;
} ct_support_def;

/** A definition with its cookie set and all other members zero. */
CT_API ct_support_def ct_support_def_default(void);

/**
 * Create the effect of all supports together; it stores the reaction impulse at each of its nodes.
 * Its prescribed degrees of freedom must have `inverse_mass` 0 and the prescribed initial velocity;
 * `ct_support_apply` sets both. ``CT_ERROR_ARGUMENT``: two supports prescribe different velocities
 * for one component.
 */
CT_API ct_status ct_support_create_effect(const ct_support_def *def, const ct_problem *problem,
                                          ct_effect **effect, ct_error *error);

/** Write zero inverse masses and the prescribed velocities, shapes (node_count of the problem, 3).
 */
CT_API ct_status ct_support_apply(const ct_effect *effect, double *inverse_mass, double *velocity,
                                  ct_error *error);

/** A traction and a pressure on faces, with an amplitude in time. */
typedef struct ct_load_def {
  /** Set by `ct_load_def_default`. */
  int32_t cookie;
  /** Kind of the faces. */
  ct_face_kind kind;
  /** Number of faces. */
  int32_t face_count;
  /** Node numbers of the problem, shape (face_count, 4 or 8), so that normals point out of the
   * body. */
  const int32_t *faces;
  /** Force per undeformed area, of fixed direction [stress]. */
  double traction[3];
  /** Pressure, which acts against the outward normal [stress]. */
  double pressure;
  /** Not zero: the pressure acts along the normal of the deformed surface and on its area; zero: on
   * the undeformed surface. */
  int following;
  /** Factor of traction and pressure in time. */
  ct_amplitude amplitude;
} ct_load_def;

/** A definition with its cookie set and all other members zero. */
CT_API ct_load_def ct_load_def_default(void);

/**
 * Create the effect "load", :eq:`load-force`. Its stored energy is 0; its work is in the energy
 * balance. Arrays are copied. `problem` comes from `ct_scene_join`. ``CT_ERROR_ARGUMENT``: a
 * missing or invalid argument; ``CT_INVALID``: a number is not finite; ``CT_ERROR_GEOMETRY``: a
 * face without area (`error` names the face).
 */
CT_API ct_status ct_load_create_effect(const ct_load_def *def, const ct_problem *problem,
                                       ct_effect **effect, ct_error *error);

/** Prescribed displacement of some components of a set of nodes: a vector times an amplitude. */
typedef struct ct_motion {
  /** Node numbers of the problem, shape (node_count). */
  const int32_t *nodes;
  /** Number of nodes. */
  int32_t node_count;
  /** Which of x, y, z are prescribed (0 or 1). */
  int fixed[3];
  /** Displacement, multiplied by the amplitude [length]. */
  double displacement[3];
  /** Factor in time; at least one point. A jump takes one step. */
  ct_amplitude amplitude;
} ct_motion;

/** All prescribed motions of a problem. */
typedef struct ct_motion_def {
  /** Set by `ct_motion_def_default`. */
  int32_t cookie;
  /** The motions, shape (motion_count). */
  const ct_motion *motions;
  /** Number of motions. */
  int32_t motion_count;
} ct_motion_def;

/** A definition with its cookie set and all other members zero. */
CT_API ct_motion_def ct_motion_def_default(void);

/**
 * Create the effect "support" of all motions together, :eq:`motion-force`: a force that moves its
 * nodes to their prescribed positions at t_{n+1} against all other forces and their inertia. Its
 * stored energy is 0; its work is in the energy balance. Arrays are copied. A problem has at most
 * one such effect. It must be the last in the list except for supports, because it depends on all
 * other forces. ``CT_ERROR_ARGUMENT``: no nodes, or a component that two motions, or a motion and a
 * support, prescribe; ``CT_INVALID``: a number is not finite.
 */
CT_API ct_status ct_motion_create_effect(const ct_motion_def *def, const ct_problem *problem,
                                         ct_effect **effect, ct_error *error);

/** A uniform acceleration of bodies, with an amplitude in time. */
typedef struct ct_gravity_def {
  /** Set by `ct_gravity_def_default`. */
  int32_t cookie;
  /** Acceleration [length / time²]. */
  double acceleration[3];
  /** Numbers of the bodies that it acts on, shape (body_count); null: all. */
  const int32_t *bodies;
  /** Number of bodies in `bodies`. */
  int32_t body_count;
  /** Factor of the acceleration in time; no points: 1 at all times. */
  ct_amplitude amplitude;
} ct_gravity_def;

/** A definition with its cookie set and all other members zero. */
CT_API ct_gravity_def ct_gravity_def_default(void);

/**
 * Create the effect "gravity": f = m g at each node, with the potential :eq:`gravity-potential`.
 * With an amplitude the weight has no potential; its stored energy is then 0, and its work is in
 * the energy balance, :eq:`gravity-amplitude`. The amplitude is copied. `problem` comes from
 * `ct_scene_join`. ``CT_ERROR_ARGUMENT``: an unknown body, or an amplitude whose times descend;
 * ``CT_INVALID``: a number is not finite.
 */
CT_API ct_status ct_gravity_create_effect(const ct_gravity_def *def, const ct_problem *problem,
                                          ct_effect **effect, ct_error *error);

/** Damping in proportion to mass, or dynamic relaxation. */
typedef struct ct_damping_def {
  /** Set by `ct_damping_def_default`. */
  int32_t cookie;
  /** Rate α >= 0 [1 / time]: a free velocity decays by exp(-α t), :eq:`damping-decay`. */
  double rate;
  /**
   * Not zero: dynamic relaxation, which estimates the rate from the state, :eq:`relaxation-rate`,
   * so that the bodies reach equilibrium quickly; `rate` must be 0. Give contacts and obstacles
   * restitution 0 then: energy that they give back keeps points in motion.
   */
  int relaxation;
  /** Numbers of the bodies that are damped, shape (body_count); null: all. */
  const int32_t *bodies;
  /** Number of bodies in `bodies`. */
  int32_t body_count;
} ct_damping_def;

/** A definition with its cookie set and all other members zero. */
CT_API ct_damping_def ct_damping_def_default(void);

/**
 * Create the effect "damping": f = -α m v_{n-1/2}, :eq:`damping-force`. Its stored energy is 0; its
 * negative work is in the energy balance. With `relaxation` the force is :eq:`relaxation-force` and
 * does not limit the step; the effect must then follow all others in the list except motions and
 * supports. `problem` comes from `ct_scene_join`.
 */
CT_API ct_status ct_damping_create_effect(const ct_damping_def *def, const ct_problem *problem,
                                          ct_effect **effect, ct_error *error);

/** Damping in proportion to stiffness. */
typedef struct ct_stiffness_damping_def {
  /** Set by `ct_stiffness_damping_def_default`. */
  int32_t cookie;
  /** The effect of all bodies, from `ct_solid_create_effect`; it must outlive this one. */
  const ct_effect *solid;
  /** Coefficient β >= 0 of each body [time], shape (number of bodies); 0: the body is not damped.
   */
  const double *coefficients;
} ct_stiffness_damping_def;

/** A definition with its cookie set and all other members zero. */
CT_API ct_stiffness_damping_def ct_stiffness_damping_def_default(void);

/**
 * Create the effect "damping" in proportion to stiffness: f = -β K v_{n-1/2},
 * :eq:`stiffness-damping-force`. Its stored energy is 0; its negative work is in the energy
 * balance. It costs one more force evaluation of its bodies per step, and shortens the stable step,
 * :eq:`stiffness-damping-bound`. `ct_scene_build` creates it for bodies with `stiffness_damping`.
 * ``CT_INVALID``: a coefficient is negative or not finite; ``CT_ERROR_ARGUMENT``: all are 0;
 * ``CT_ERROR_UNSUPPORTED``: a damped body has a law other than ``CT_LINEAR``.
 */
CT_API ct_status ct_stiffness_damping_create_effect(const ct_stiffness_damping_def *def,
                                                    const ct_problem *problem, ct_effect **effect,
                                                    ct_error *error);

/** Initial stress of bodies. */
typedef struct ct_initial_stress_def {
  /** Set by `ct_initial_stress_def_default`. */
  int32_t cookie;
  /** The effect of all bodies, from `ct_solid_create_effect`. */
  const ct_effect *solid;
} ct_initial_stress_def;

/** A definition with its cookie set and all other members zero. */
CT_API ct_initial_stress_def ct_initial_stress_def_default(void);

/**
 * Create the effect "initial_stress": the constant nodal forces :eq:`initial-stress-force` of the
 * stress `initial_stress` of the problem's bodies, with the potential
 * :eq:`initial-stress-potential`. `ct_scene_build` creates it for bodies that have one.
 * ``CT_INVALID``: a stress is not finite; ``CT_ERROR_ARGUMENT``: no body has one;
 * ``CT_ERROR_UNSUPPORTED``: a body with one has a law other than ``CT_LINEAR``.
 */
CT_API ct_status ct_initial_stress_create_effect(const ct_initial_stress_def *def,
                                                 const ct_problem *problem, ct_effect **effect,
                                                 ct_error *error);

/**
 * Bulk viscosity: a pressure against compression that spreads a wave front over a few elements,
 * :eq:`bulk-viscosity`. It dissipates energy, which the energy balance shows as negative work of
 * the effect "viscosity".
 */
typedef struct ct_viscosity_def {
  /** Set by `ct_viscosity_def_default`. */
  int32_t cookie;
  /** Coefficient Q₁ of the part proportional to the strain rate [-], >= 0; usually 0.06. */
  double linear;
  /**
   * Coefficient Q₂ of the part that grows with the square of the strain rate while it is small
   * [-], >= 0; usually 1.2. If it is not zero, the stable step is that of Q₁ + 0.06,
   * :eq:`viscous-bound`.
   */
  double quadratic;
  /** Numbers of the bodies, shape (body_count); null: all. */
  const int32_t *bodies;
  /** Number of bodies in `bodies`. */
  int32_t body_count;
} ct_viscosity_def;

/** A definition with its cookie set and all other members zero. */
CT_API ct_viscosity_def ct_viscosity_def_default(void);

/**
 * Create the effect "viscosity". `problem` comes from `ct_scene_join`. ``CT_ERROR_UNSUPPORTED``:
 * the elements of a body are not hex8, or its law is not CT_LINEAR. ``CT_ERROR_ARGUMENT``: a
 * coefficient is negative, both are 0, or a body is unknown or listed twice.
 */
CT_API ct_status ct_viscosity_create_effect(const ct_viscosity_def *def, const ct_problem *problem,
                                            ct_effect **effect, ct_error *error);

/** Faces through which waves leave the body instead of being reflected. */
typedef struct ct_absorb_def {
  /** Set by `ct_absorb_def_default`. */
  int32_t cookie;
  /** Kind of the faces. */
  ct_face_kind kind;
  /** Number of faces; all belong to one body. */
  int32_t face_count;
  /** Node numbers of the problem, shape (face_count, 4 or 8). */
  const int32_t *faces;
} ct_absorb_def;

/** A definition with its cookie set and all other members zero. */
CT_API ct_absorb_def ct_absorb_def_default(void);

/**
 * Create the effect "absorb" of Lysmer and Kuhlemeyer: a traction against the velocity, with the
 * coefficient ρ c₁ along the normal and ρ c₂ in the tangent plane, :eq:`absorb-traction`. Its
 * stored energy is 0; the absorbed energy is in the energy balance as negative work. `problem`
 * comes from `ct_scene_join`. ``CT_ERROR_ARGUMENT``: faces of several bodies.
 */
CT_API ct_status ct_absorb_create_effect(const ct_absorb_def *def, const ct_problem *problem,
                                         ct_effect **effect, ct_error *error);

/** Two surfaces that are glued together. */
typedef struct ct_tie_def {
  /** Set by `ct_tie_def_default`. */
  int32_t cookie;
  /** Kind of the faces of each surface. */
  ct_face_kind kind[2];
  /** Number of faces of each surface. */
  int32_t face_count[2];
  /** Node numbers of the problem, shapes (face_count, nodes of a face). */
  const int32_t *faces[2];
  /** Penalty ε > 0 [stress / length], the stiffness of the glue per area. */
  double epsilon;
  /** Largest distance in the reference shape over which a point is tied, > 0 [length]. */
  double reach;
} ct_tie_def;

/** A definition with its cookie set and all other members zero. */
CT_API ct_tie_def ct_tie_def_default(void);

/**
 * Create the effect "tie": the Gauss points of both surfaces are tied to the closest places on the
 * other one in the reference shape, :eq:`tie-force`. The forces are solved for with those of all
 * contacts, so the stable step does not change. `problem` comes from `ct_scene_join`.
 * ``CT_ERROR_ARGUMENT``: a missing or invalid argument, or no point is tied;
 * ``CT_ERROR_GEOMETRY``: a face without area (`error` names the face).
 */
CT_API ct_status ct_tie_create_effect(const ct_tie_def *def, const ct_problem *problem,
                                      ct_effect **effect, ct_error *error);

/** Write the number of tied points, that of all points, and the largest distance over which a point
 * is tied [length]. ``CT_ERROR_ARGUMENT``: the effect is no tie. */
CT_API ct_status ct_tie_count(const ct_effect *effect, int64_t *tied, int64_t *points,
                              double *farthest, ct_error *error);

/** One body that is rigid, or a part of it, and moves by the forces on it. */
typedef struct ct_rigid {
  /** Number of the body. */
  int32_t body;
  /** Null: the whole body. Or numbers in the problem of its nodes that are rigid, ascending, not on
   * a line, shape (node_count); the elements between them still have forces. */
  const int32_t *nodes;
  /** Number of nodes; not read if `nodes` is null. */
  int32_t node_count;
  /** Which of its freedoms are fixed (0 or 1): x, y, z of its centre, rotation about axes along x,
   * y, z through it. */
  int fixed[6];
  /** Not zero: the body turns about `pivot`, which does not move; zero: about its centre of mass.
   */
  int pivoted;
  /** A point that is fixed in space, read only if `pivoted` [length]. */
  double pivot[3];
} ct_rigid;

/** All rigid bodies of a problem. */
typedef struct ct_rigid_def {
  /** Set by `ct_rigid_def_default`. */
  int32_t cookie;
  /** The bodies, shape (body_count). */
  const ct_rigid *bodies;
  /** Number of bodies. */
  int32_t body_count;
} ct_rigid_def;

/** A definition with its cookie set and all other members zero. */
CT_API ct_rigid_def ct_rigid_def_default(void);

/**
 * Create the effect "rigid" of all rigid bodies together, :eq:`rigid-force`: forces that keep the
 * nodes of a body at their distances while it moves by all other forces, with the mass and the
 * inertia of its nodes. Its stored energy is 0; its work, which is in the energy balance, vanishes
 * with Δt². A problem has at most one such effect, after all others in the list except motions and
 * supports. The solid effect must compute these bodies with CT_KERNEL_RIGID, as a scene does. No
 * support or motion may hold their nodes. The step ends with ``CT_ERROR_STEP`` if a body turns too
 * far in one step. ``CT_ERROR_ARGUMENT``: a body is unknown or listed twice, or its initial
 * velocity is not that of a rigid motion; ``CT_INVALID``: a number is not finite.
 */
CT_API ct_status ct_rigid_create_effect(const ct_rigid_def *def, const ct_problem *problem,
                                        ct_effect **effect, ct_error *error);

/** A filter of output fields, :doc:`/theory/filter`; opaque. One thread at a time may use it. */
typedef struct ct_filter ct_filter;

/**
 * Create a filter of `passes` passes, 1 ... 8, for the states of a problem, which must outlive it.
 * Each pass costs one force evaluation of the bodies per field. ``CT_ERROR_UNSUPPORTED``: a body is
 * not linear.
 */
CT_API ct_status ct_filter_create(const ct_problem *problem, int passes, ct_filter **filter,
                                  ct_error *error);

/**
 * Write displacement [length] and velocity [length / time] of a state at its time without the short
 * waves that the mesh cannot represent, :eq:`filter-pass`, each shape (node_count, 3) or null. The
 * filter shifts no wave and does not change a stress that is constant in a body. The state itself
 * does not change.
 */
CT_API ct_status ct_filter_apply(ct_filter *filter, ct_state *state, double *displacement,
                                 double *velocity, ct_error *error);

/** Free a filter; null is allowed. */
CT_API void ct_filter_free(ct_filter *filter);

CT_END_DECLS

#endif
