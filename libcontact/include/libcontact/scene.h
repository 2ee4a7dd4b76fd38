/* From bodies, contacts and supports to a problem: numbering, masses, effects, stable step.
 * Threads: a call must be alone with its scene; different scenes are independent. States of the
 * built problem may be stepped at once as long as nobody builds or frees the scene. */
#ifndef LIBCONTACT_SCENE_H
#define LIBCONTACT_SCENE_H

#include <libcontact/mesh.h>
#include <libcontact/solid.h>
#include <libcontact/step.h>
#include <libcontact/effect.h>
#include <libcontact/contact.h>

CT_BEGIN_DECLS

/** A scene is filled piece by piece and then built into a problem; opaque, as it owns copies of all
 * it was given. */
typedef struct ct_scene ct_scene;

/** A body. What is left zero has its default; a mesh or a box, and a material are needed. */
typedef struct ct_scene_body {
  /** Label for errors, at most 63 bytes are kept; null: none. */
  const char *name;
  /** The mesh, copied; null: `box`. */
  const ct_mesh *mesh;
  /** In place of a mesh: a box of bricks of this kind. */
  ct_brick_kind kind;
  /** The box, read only when there is no mesh. */
  ct_box box;
  /** The material of all its elements. */
  ct_material material;
  /** How masses are lumped. */
  ct_lumping lumping;
  /** The kernel of its forces. */
  ct_solid_kernel kernel;
  /** Velocity of the whole body at t = 0 [length / time]. */
  double velocity[3];
  /** Null, or in place of `velocity` one of each node, shape (node_count, 3), copied. */
  const double *velocities;
  /** Coefficient κ of the hourglass control with CT_KERNEL_REDUCED, :eq:`hourglass-stiffness`; 0:
   * the default. */
  double hourglass;
  /** Most threads that check and prepare the body (ct_mesh.threads); 0: one. They change no bit. */
  int threads;
} ct_scene_body;

/** The side of a body's mesh with the smallest or largest coordinate. */
typedef enum ct_box_side {
  /** none is named */
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

/** One contact between two surfaces of two bodies: each a list of faces or a side. */
typedef struct ct_scene_contact {
  /** Number of the first body. */
  int32_t body_a;
  /** Number of the second body. */
  int32_t body_b;
  /** Faces of the first body. */
  int32_t face_count_a;
  /** Faces of the second body. */
  int32_t face_count_b;
  /** Node numbers of the first body's own mesh, as `ct_mesh_plane_faces` gives them. */
  const int32_t *faces_a;
  /** Likewise of the second body. */
  const int32_t *faces_b;
  /**
   * Penalty factor β of ε = β E / h, with the smaller E and the shortest edge of the two bodies, or
   * `options.epsilon`; both 0: `ct_contact_penalty_default`.
   */
  double beta;
  /** Search, depth; `epsilon` in place of `beta`. */
  ct_contact_options options;
  /** Coefficient μ of friction; 0: none, and nothing is kept or computed for it. */
  double friction;
  /** Ratio of the tangential to the normal penalty of friction; 0: 1, or less where the normal one
   * is stiffer than the usual explicit penalty, so that friction does not shorten the step more. */
  double tangent;
  /** In place of `faces_a`: the outer faces in this side of the first body. */
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

/** Time of a scene: exactly one of `courant`, `fraction`, `dt` is > 0. */
typedef struct ct_scene_time {
  /** End of the run [time], > 0. */
  double end;
  /** c₁ Δt / h, with the body that has the smallest h / c₁. */
  double courant;
  /** Δt over the reported stable step. */
  double fraction;
  /** Δt itself [time]. */
  double dt;
  /**
   * Not zero: `dt` is kept to the last bit, and the run ends with the first step that is not before
   * `end`. A run that is continued needs the Δt that it had.
   */
  int keep_dt;
  /** Threads, >= 1. */
  int threads;
  /** Null, or the clock [seconds] that the problem gets. */
  double (*clock)(void);
  /** The method of the time steps; all bytes zero: central difference. */
  ct_integrator integrator;
  /**
   * Not zero: linear bodies are bounded together, :eq:`assembled-bound`, where that allows a
   * larger step; it costs some 70 forces once.
   */
  int assembled;
} ct_scene_time;

/** An empty scene. */
CT_API ct_status ct_scene_create(ct_scene **scene, ct_error *error);

/**
 * Add a body; `*body`, which may be null, gets its number. ``CT_ERROR_ARGUMENT``: an impossible
 * choice, or after `ct_scene_join`; ``CT_INVALID``: a velocity is not finite (`error`
 * names the node).
 */
CT_API ct_status ct_scene_add_body(ct_scene *scene, const ct_scene_body *def, int32_t *body,
                                   ct_error *error);

/** Add a contact; its arrays are copied. */
CT_API ct_status ct_scene_add_contact(ct_scene *scene, const ct_scene_contact *contact,
                                      ct_error *error);

/** Add a support; its nodes are copied. */
CT_API ct_status ct_scene_add_support(ct_scene *scene, const ct_scene_support *support,
                                      ct_error *error);

/**
 * Number the nodes of all bodies one after another. `*problem` then has its bodies, reference
 * coordinates, masses and initial velocities, but no effects yet: what the library's
 * `ct_..._create_effect` calls need. No body can be added after it. The problem lives as long as
 * the scene.
 */
CT_API ct_status ct_scene_join(ct_scene *scene, const ct_problem **problem, ct_error *error);

/** What may be left out when the scene is computed, from its next build on; all of it if this is
 * not called. */
CT_API ct_status ct_scene_set_optimisations(ct_scene *scene, const ct_optimisations *optimisations,
                                            ct_error *error);

/**
 * Add an effect that was made for the joined problem, the library's or the caller's own. The scene
 * takes it over, also when the call fails, and frees it. ``CT_ERROR_ARGUMENT``: the bodies are not
 * joined, a node is out of range, the scene has this effect already.
 */
CT_API ct_status ct_scene_add_effect(ct_scene *scene, ct_effect *effect, ct_error *error);

/**
 * Build the problem: masses, effects, stable step, and the largest Δt not above the asked one that
 * reaches `end` in a whole number of steps (`*step_count`; `stable` may be null). ``CT_ERROR_STEP``
 * when the asked Δt is above the stable one. The scene keeps the problem: it lives until
 * `ct_scene_free`.
 */
CT_API ct_status ct_scene_build(ct_scene *scene, const ct_scene_time *time,
                                const ct_problem **problem, int64_t *step_count,
                                ct_stable_step *stable, ct_error *error);

/**
 * `ct_scene_build`, and `ct_state_create` of its problem, with the same bits: the state that tells
 * the stable step is the one that the caller gets, who frees it before the scene. So the first
 * forces are computed once, not twice. A null `state` is not made.
 */
CT_API ct_status ct_scene_start(ct_scene *scene, const ct_scene_time *time,
                                const ct_problem **problem, int64_t *step_count,
                                ct_stable_step *stable, ct_state **state, ct_error *error);

/** Penalty ε that the contact of this number uses, after `ct_scene_build` [stress / length]. */
CT_API ct_status ct_scene_contact_epsilon(const ct_scene *scene, int32_t contact, double *epsilon);

/** Free a scene and the problem that it built; null is allowed. States of the problem are freed
 * before. */
CT_API void ct_scene_free(ct_scene *scene);

CT_END_DECLS

#endif
