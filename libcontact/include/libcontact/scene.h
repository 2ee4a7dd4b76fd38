/* Scenes: bodies, contacts and supports, from which a problem is built with its numbering, masses,
 * effects and stable step.
 * Threads: one call at a time per scene; different scenes are independent. States of the built
 * problem may be stepped at the same time while no call builds or frees the scene. */
#ifndef LIBCONTACT_SCENE_H
#define LIBCONTACT_SCENE_H

#include <libcontact/effect.h>
#include <libcontact/contact_effect.h>

CT_BEGIN_DECLS

/** A scene: the caller adds bodies, contacts, supports and effects, and then builds a problem. It
 * owns copies of their definitions; opaque. */
typedef struct ct_scene ct_scene;

/** A body. Members that are zero select defaults; a mesh or a box, and a material are required. */
typedef struct ct_scene_body {
  /** Name for error messages, cut to 63 bytes; null: none. */
  const char *name;
  /** The mesh, copied; null: `box`. */
  const ct_mesh *mesh;
  /** Instead of a mesh: kind of the bricks of `box`. */
  ct_brick_kind kind;
  /** The box, read only when there is no mesh. */
  ct_box box;
  /** The material of all its elements, read only without `materials`. */
  ct_material material;
  /** How masses are lumped. */
  ct_lumping lumping;
  /** The kernel of its forces. */
  ct_solid_kernel kernel;
  /** Velocity of the whole body at t = 0 [length / time]. */
  double velocity[3];
  /** Null, or, instead of `velocity`, the velocity of each node at t = 0 [length / time], shape
   * (node_count, 3), copied. */
  const double *velocities;
  /** Coefficient Q of the hourglass control with CT_KERNEL_REDUCED [-], :eq:`hourglass-stiffness`;
   * 0: the default. */
  double hourglass;
  /** Coefficient β of damping in proportion to stiffness [time], :eq:`stiffness-damping-force`; 0:
   * none, at no cost. */
  double stiffness_damping;
  /** Null, or the displacement of each node at t = 0 [length], shape (node_count, 3), copied. */
  const double *displacements;
  /** Uniform stress of the body without displacement, xx yy zz xy yz zx [stress],
   * :eq:`initial-stress`; 0: none, at no cost. */
  double initial_stress[6];
  /** Null, or the material of each element of the mesh or box, shape (element_count), copied. All
   * have one law, and the kernel is CT_KERNEL_GENERAL or CT_KERNEL_REDUCED. */
  const ct_material *materials;
} ct_scene_body;

/** The side of a body's mesh with the smallest or largest coordinate. */
typedef enum ct_box_side {
  /** no side is given */
  CT_SIDE_NONE = 0,
  /** smallest x */
  CT_X_MIN = 1,
  /** largest x */
  CT_X_MAX = 2,
  /** smallest y */
  CT_Y_MIN = 3,
  /** largest y */
  CT_Y_MAX = 4,
  /** smallest z */
  CT_Z_MIN = 5,
  /** largest z */
  CT_Z_MAX = 6
} ct_box_side;

/** A contact between surfaces of two bodies. Each surface is a list of faces or a side. */
typedef struct ct_scene_contact {
  /** Number of the first body. */
  int32_t body_a;
  /** Number of the second body. */
  int32_t body_b;
  /** Faces of the first body. */
  int32_t face_count_a;
  /** Faces of the second body. */
  int32_t face_count_b;
  /** Node numbers of the first body's own mesh, as `ct_mesh_plane_faces` writes them. */
  const int32_t *faces_a;
  /** Likewise of the second body. */
  const int32_t *faces_b;
  /**
   * Penalty factor β of ε = β E / h [-], with the smaller E and the shortest edge of the two
   * bodies; 0: the penalty is `options.epsilon`, or, if both are 0, `ct_contact_penalty_default`.
   */
  double beta;
  /** Options of the contact; `epsilon` is an alternative to `beta`. */
  ct_contact_options options;
  /** Coefficient μ of friction [-]; 0: no friction, at no cost. */
  double friction;
  /**
   * Stiffness of friction's tangential spring over that of the penalty [-], :eq:`slip-law`; 0:
   * automatic. The automatic value is 1, or less if a body deforms and the penalty is stiffer than
   * the usual explicit one: then the forces converge in fewer rounds.
   */
  double tangent;
  /** Instead of `faces_a`: the outer faces in this side of the first body. */
  ct_box_side side_a;
  /** Likewise of the second body. */
  ct_box_side side_b;
} ct_scene_contact;

/** Prescribed velocity of a set of nodes of one body. */
typedef struct ct_scene_support {
  /** Number of the body. */
  int32_t body;
  /** Node numbers of the body's own mesh, shape (node_count). */
  const int32_t *nodes;
  /** Number of nodes. */
  int32_t node_count;
  /** Which of x, y, z are prescribed (0 or 1). */
  int fixed[3];
  /** Their velocity [length / time]. */
  double velocity[3];
} ct_scene_support;

/** Time of a scene. Exactly one of `courant`, `fraction`, `dt` must be > 0. */
typedef struct ct_scene_time {
  /** End of the run [time], > 0. */
  double end;
  /** Courant number c₁ Δt / h [-], for the body with the smallest h / c₁. */
  double courant;
  /** Δt divided by the stable step [-]. */
  double fraction;
  /** Δt itself [time]. */
  double dt;
  /**
   * Not zero: use `dt` exactly, and end the run with the first step at or after `end`. A run that
   * is continued needs its old Δt.
   */
  int keep_dt;
  /** The method of the time steps; all bytes zero: central difference. */
  ct_integrator integrator;
  /**
   * Not zero: the stable step of linear bodies follows from the assembled bound,
   * :eq:`assembled-bound`, where it is larger. This costs about 70 force evaluations, once.
   */
  int assembled;
  /** Tolerance of the contact forces, as in ct_problem; 0: its default. */
  double force_tolerance;
} ct_scene_time;

/** Create an empty scene. */
CT_API ct_status ct_scene_create(ct_scene **scene, ct_error *error);

/**
 * Set threads and clock of the scene's run; best before the first body, which is then prepared with
 * these threads. By default one thread, no clock. ``CT_ERROR_ARGUMENT``: fewer than 0 or more than
 * 1024 threads.
 */
CT_API ct_status ct_scene_set_run_settings(ct_scene *scene, const ct_run_settings *settings,
                                           ct_error *error);

/**
 * Add a body and write its number to `*body`, unless `body` is null. ``CT_ERROR_ARGUMENT``: an
 * invalid member, or a call after `ct_scene_join`; ``CT_INVALID``: a velocity is not finite
 * (`error` names the node).
 */
CT_API ct_status ct_scene_add_body(ct_scene *scene, const ct_scene_body *def, int32_t *body,
                                   ct_error *error);

/**
 * Add a contact; its arrays are copied. ``CT_ERROR_ARGUMENT``: an invalid member, or an earlier
 * contact has faces of both surfaces, too, so that their force would act twice; the text names the
 * elements.
 */
CT_API ct_status ct_scene_add_contact(ct_scene *scene, const ct_scene_contact *contact,
                                      ct_error *error);

/** Add a support; its nodes are copied. */
CT_API ct_status ct_scene_add_support(ct_scene *scene, const ct_scene_support *support,
                                      ct_error *error);

/**
 * Number the nodes of all bodies one after another. `*problem` then has bodies, reference
 * coordinates, masses and initial velocities, but no effects yet; the library's
 * `ct_..._create_effect` calls need this problem. After this call no body can be added. The scene
 * owns the problem.
 */
CT_API ct_status ct_scene_join(ct_scene *scene, const ct_problem **problem, ct_error *error);

/** Set the optimisations of the scene from its next build on. By default all are on. */
CT_API ct_status ct_scene_set_optimisations(ct_scene *scene, const ct_optimisations *optimisations,
                                            ct_error *error);

/**
 * Add an effect of the library or of the caller that was created for the joined problem. The scene
 * takes it over, also if the call fails, and frees it. ``CT_ERROR_ARGUMENT``: `ct_scene_join` was
 * not called, a node is out of range, or the scene already has this effect.
 */
CT_API ct_status ct_scene_add_effect(ct_scene *scene, ct_effect *effect, ct_error *error);

/**
 * Build the problem: masses, effects, stable step, and the time step. Δt is the largest value not
 * above the requested one that reaches `end` in a whole number of steps, `*step_count`. `stable`
 * may be null. ``CT_ERROR_STEP``: the requested Δt exceeds the stable one. With `keep_dt` and
 * without `stable` Δt is not checked, and no state is created for that: another process has built
 * the problem with it. The scene owns the problem until `ct_scene_free`.
 */
CT_API ct_status ct_scene_build(ct_scene *scene, const ct_scene_time *time,
                                const ct_problem **problem, int64_t *step_count,
                                ct_stable_step *stable, ct_error *error);

/**
 * `ct_scene_build` followed by `ct_state_create`, with the same results bit by bit, but the first
 * forces are computed once instead of twice. The caller frees the state before the scene. If
 * `state` is null, no state is created.
 */
CT_API ct_status ct_scene_start(ct_scene *scene, const ct_scene_time *time,
                                const ct_problem **problem, int64_t *step_count,
                                ct_stable_step *stable, ct_state **state, ct_error *error);

/** Write the penalty ε of contact number `contact` after `ct_scene_build` [stress / length]. */
CT_API ct_status ct_scene_contact_epsilon(const ct_scene *scene, int32_t contact, double *epsilon,
                                          ct_error *error);

/** Free a scene and its problem; null is allowed. Free the states of the problem first. */
CT_API void ct_scene_free(ct_scene *scene);

CT_END_DECLS

#endif
