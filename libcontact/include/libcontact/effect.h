/* The effects that come with the library: bodies, supports, motions, loads, gravity, damping,
 * viscosity, absorbing faces.
 * Threads: factories at any time; an effect does not change after it was made, so that several
 * states may use it at once. */
#ifndef LIBCONTACT_EFFECT_H
#define LIBCONTACT_EFFECT_H

#include <libcontact/base.h>
#include <libcontact/shape.h>
#include <libcontact/solid.h>
#include <libcontact/step.h>

CT_BEGIN_DECLS

/** The bodies of the solid effect. */
typedef struct ct_solid_def {
  /** Set by `ct_solid_def_default`. */
  int32_t cookie;
  /** The bodies in ascending order of `first_node` without gaps, shape (block_count). */
  const ct_solid_body *blocks;
  /** Number of bodies. */
  int32_t block_count;
} ct_solid_def;

/** A definition with its cookie; all else is zero. */
CT_API ct_solid_def ct_solid_def_default(void);

/**
 * The effect "solid" of all bodies. Meshes must outlive the effect; `problem` is not read and may
 * be null. ``CT_ERROR_UNSUPPORTED`` when a kernel is asked for that does not fit its block. Under a
 * law for large deformation its force fails with
 * ``CT_ERROR_GEOMETRY``, body and element, as soon as an element is turned inside out, and its
 * bound on the step is that of the tangent.
 */
CT_API ct_status ct_solid_create_effect(const ct_solid_def *def, const ct_problem *problem,
                                        ct_effect **effect, ct_error *error);

/**
 * The effect "hourglass" of a solid effect with blocks of CT_KERNEL_REDUCED: it has no force of its
 * own (the solid effect's holds it), and its stored energy is that of the hourglass control, which
 * the energy of the solid effect leaves out. Null, with CT_OK, when no block is of that kind. The
 * solid effect must outlive it.
 */
CT_API ct_status ct_solid_create_hourglass(const ct_effect *solid, ct_effect **effect,
                                           ct_error *error);

/** The kernel that the effect chose for a block, and the floating-point operations and bytes of one
 * update of one element. */
CT_API ct_status ct_solid_body_plan(const ct_effect *effect, int32_t block, ct_solid_kernel *kernel,
                                    double *flops, double *bytes);

/** Components of a set of nodes that keep a constant velocity: 0 for a fixed end or a plane of
 * symmetry. */
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

/** A definition with its cookie; all else is zero. */
CT_API ct_support_def ct_support_def_default(void);

/**
 * The effect of all supports together: it keeps the reaction impulse at each of its nodes. Its
 * prescribed degrees of freedom must have `inverse_mass` 0 and the prescribed initial velocity,
 * which `ct_support_apply` sets. A degree of freedom that two supports give different velocities is
 * ``CT_ERROR_ARGUMENT``.
 */
CT_API ct_status ct_support_create_effect(const ct_support_def *def, const ct_problem *problem,
                                          ct_effect **effect, ct_error *error);

/** Write zero inverse masses and the prescribed velocities, shapes (node_count of the problem, 3).
 */
CT_API ct_status ct_support_apply(const ct_effect *effect, double *inverse_mass, double *velocity);

/** A factor that changes with time: a line through given points, :eq:`amplitude`; constant before
 * the first and after the last. */
typedef struct ct_amplitude {
  /** Number of points; 0: the factor is 1 at all times. */
  int32_t count;
  /** Times [time], not descending, shape (count). Two equal times make a jump; at the jump the
   * later value holds. */
  const double *time;
  /** Values at these times, shape (count). */
  const double *value;
} ct_amplitude;

/** A traction and a pressure on faces, with an amplitude in time. */
typedef struct ct_load_def {
  /** Set by `ct_load_def_default`. */
  int32_t cookie;
  /** What the faces are. */
  ct_face_kind kind;
  /** Number of faces. */
  int32_t face_count;
  /** Node numbers of the problem, shape (face_count, 4 or 8), so that normals point out of the
   * body. */
  const int32_t *faces;
  /** Force for each unit of the undeformed area, of fixed direction [stress]. */
  double traction[3];
  /** Pressure against the normal [stress]. */
  double pressure;
  /** Not zero: the pressure follows the deformed surface, normal and area; zero: it acts as on the
   * undeformed one. */
  int following;
  /** Factor of both in time. */
  ct_amplitude amplitude;
} ct_load_def;

/** A definition with its cookie; all else is zero. */
CT_API ct_load_def ct_load_def_default(void);

/**
 * The effect "load", :eq:`load-force`. It stores nothing; its work stands in the ledger. Arrays are
 * copied. The problem is a joined one, see `ct_scene_join`. ``CT_ERROR_ARGUMENT``, ``CT_INVALID``,
 * ``CT_ERROR_GEOMETRY``: what is missing, not finite, or a face without area, named by its number.
 */
CT_API ct_status ct_load_create_effect(const ct_load_def *def, const ct_problem *problem,
                                       ct_effect **effect, ct_error *error);

/** Components of a set of nodes whose displacement follows an amplitude. */
typedef struct ct_motion {
  /** Node numbers of the problem, shape (node_count). */
  const int32_t *nodes;
  /** Number of nodes. */
  int32_t node_count;
  /** Which of x, y, z are prescribed (0 or 1). */
  int fixed[3];
  /** Displacement that the amplitude multiplies [length]. */
  double displacement[3];
  /** Factor in time; at least one point. A jump is made within one step. */
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

/** A definition with its cookie; all else is zero. */
CT_API ct_motion_def ct_motion_def_default(void);

/**
 * The effect "support" of all motions together, :eq:`motion-force`: a force that takes its nodes to
 * their place at t_{n+1}, against all other forces and their own inertia. It stores nothing; its
 * work stands in the ledger. Arrays are copied. It must be the last effect of the problem but for
 * supports, as it has to see the forces of all others; so a problem has at most one.
 * ``CT_ERROR_ARGUMENT``: no nodes, a component that two motions, or a motion and a support, hold;
 * ``CT_INVALID``: a number is not finite.
 */
CT_API ct_status ct_motion_create_effect(const ct_motion_def *def, const ct_problem *problem,
                                         ct_effect **effect, ct_error *error);

/** A uniform acceleration of bodies. */
typedef struct ct_gravity_def {
  /** Set by `ct_gravity_def_default`. */
  int32_t cookie;
  /** Acceleration [length / time²]. */
  double acceleration[3];
  /** Numbers of the bodies that fall, shape (body_count); null: all. */
  const int32_t *bodies;
  /** Number of them. */
  int32_t body_count;
} ct_gravity_def;

/** A definition with its cookie; all else is zero. */
CT_API ct_gravity_def ct_gravity_def_default(void);

/**
 * The effect "gravity": f = m g at each node, with the potential :eq:`gravity-potential`. The
 * problem is a joined one, see `ct_scene_join`.
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
   * Not zero: dynamic relaxation, which chooses the rate by itself, :eq:`relaxation-rate`, so that
   * bodies come to rest soon; `rate` must be 0.
   */
  int relaxation;
  /** Numbers of the bodies that are damped, shape (body_count); null: all. */
  const int32_t *bodies;
  /** Number of them. */
  int32_t body_count;
} ct_damping_def;

/** A definition with its cookie; all else is zero. */
CT_API ct_damping_def ct_damping_def_default(void);

/**
 * The effect "damping": f = -α m v with the velocity half a step back, :eq:`damping-force`. It
 * stores nothing; its work is negative and stands in the ledger. With `relaxation` it is
 * :eq:`relaxation-force`, does not limit the step, and must stand behind all effects but motions
 * and supports. The problem is a joined one, see `ct_scene_join`.
 */
CT_API ct_status ct_damping_create_effect(const ct_damping_def *def, const ct_problem *problem,
                                          ct_effect **effect, ct_error *error);

/**
 * Bulk viscosity: a pressure against compression that spreads a front over a few elements,
 * :eq:`bulk-viscosity`. It takes energy out of the bodies, which the ledger shows as the (negative)
 * work of the effect "viscosity".
 */
typedef struct ct_viscosity_def {
  /** Set by `ct_viscosity_def_default`. */
  int32_t cookie;
  /** Coefficient Q₁ of the part that grows with the strain rate, >= 0; 0.06 is usual. */
  double linear;
  /** Coefficient Q₂ of the part that grows with its square while it is small, >= 0; 1.2 is usual.
   * If it is not zero, the stable step is that of Q₁ + 0.06, :eq:`viscous-bound`. */
  double quadratic;
  /** Numbers of the bodies, shape (body_count); null: all. */
  const int32_t *bodies;
  /** Number of bodies in `bodies`. */
  int32_t body_count;
} ct_viscosity_def;

/** A definition with its cookie; all else is zero. */
CT_API ct_viscosity_def ct_viscosity_def_default(void);

/**
 * The effect "viscosity" of some bodies of the joined problem. ``CT_ERROR_UNSUPPORTED``: a body is
 * not of hex8.
 * ``CT_ERROR_ARGUMENT``: a coefficient is negative, both are 0, or a body does not exist or is
 * named twice.
 */
CT_API ct_status ct_viscosity_create_effect(const ct_viscosity_def *def, const ct_problem *problem,
                                            ct_effect **effect, ct_error *error);

/** Faces through which waves leave the body instead of being reflected. */
typedef struct ct_absorb_def {
  /** Set by `ct_absorb_def_default`. */
  int32_t cookie;
  /** What the faces are. */
  ct_face_kind kind;
  /** Number of faces; all belong to one body. */
  int32_t face_count;
  /** Node numbers of the problem, shape (face_count, 4 or 8). */
  const int32_t *faces;
} ct_absorb_def;

/** A definition with its cookie; all else is zero. */
CT_API ct_absorb_def ct_absorb_def_default(void);

/**
 * The effect "absorb" of Lysmer and Kuhlemeyer: a traction against the velocity, ρ c₁ along the
 * normal and ρ c₂ across, :eq:`absorb-traction`. It stores nothing; what leaves stands in the
 * ledger as negative work. The problem is a joined one, see `ct_scene_join`. ``CT_ERROR_ARGUMENT``:
 * faces of several bodies.
 */
CT_API ct_status ct_absorb_create_effect(const ct_absorb_def *def, const ct_problem *problem,
                                         ct_effect **effect, ct_error *error);

/** Bodies whose accelerations are averaged. */
typedef struct ct_averaging_def {
  /** Set by `ct_averaging_def_default`. */
  int32_t cookie;
  /** Numbers of the bodies, shape (body_count); null: all bodies. */
  const int32_t *bodies;
  /** Number of bodies. */
  int32_t body_count;
  /**
   * Nodes of the problem, in any order, whose elements are left out, shape (apart_count): those on
   * which a force acts that is not known before the averaging, as of a contact, its friction, an
   * obstacle, or a motion that is prescribed.
   */
  const int32_t *apart;
  /** Number of these nodes. */
  int32_t apart_count;
} ct_averaging_def;

/** A definition with its cookie; all else is zero. */
CT_API ct_averaging_def ct_averaging_def_default(void);

/**
 * The effect "averaging" of a mass that is averaged with its neighbours, :eq:`averaging-force`: it
 * takes the error of fourth order from the speed of dilatation waves along the axes. It must stand
 * behind all other effects of CT_PHASE_STATE, and the steps are central differences with the `dt`
 * of this problem, which must outlive the effect. Its stored energy, :eq:`averaged-energy`, is what
 * the averaged mass has less than the lumped one as kinetic energy; so it is negative. The problem
 * is a joined one, see `ct_scene_join`. ``CT_ERROR_UNSUPPORTED``: a body is not of linear hex8
 * elements that are equal bricks along the axes.
 */
CT_API ct_status ct_averaging_create_effect(const ct_averaging_def *def, const ct_problem *problem,
                                            ct_effect **effect, ct_error *error);

/** A filter of what is shown of a state, :doc:`/theory/filter`; opaque. Used by one thread at a
 * time. */
typedef struct ct_filter ct_filter;

/**
 * A filter of so many passes, 1 ... 8, for the states of a problem, which must outlive it. Each
 * pass costs one force of the bodies for each field. ``CT_ERROR_UNSUPPORTED``: a body is not
 * linear.
 */
CT_API ct_status ct_filter_create(const ct_problem *problem, int passes, ct_filter **filter,
                                  ct_error *error);

/**
 * Write the displacement and the velocity of a state at its time without the waves that the mesh
 * does not carry, :eq:`filter-pass`, each shape (node_count, 3) or null. No wave changes its place,
 * a stress that is constant in a body stays as it is, and the motion of the state is not touched.
 */
CT_API ct_status ct_filter_apply(ct_filter *filter, ct_state *state, double *displacement,
                                 double *velocity, ct_error *error);

/** Free a filter; null is allowed. */
CT_API void ct_filter_free(ct_filter *filter);

CT_END_DECLS

#endif
