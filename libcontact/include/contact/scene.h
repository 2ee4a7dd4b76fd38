#ifndef CONTACT_SCENE_H
#define CONTACT_SCENE_H

#include <contact/contact.h>
#include <contact/mass.h>
#include <contact/mesh.h>
#include <contact/solid.h>
#include <contact/step.h>
#include <contact/support.h>

/** A scene is filled piece by piece and then built into a problem; opaque, as it owns copies of all it was given. */
typedef struct ct_scene ct_scene;

/** One contact between two surfaces of two bodies. */
typedef struct ct_scene_contact {
  /** Bodies, and their faces as `ct_mesh_plane_faces` gives them (node numbers of the body's own mesh). */
  int32_t body_a;
  int32_t body_b;
  int32_t face_count_a;
  int32_t face_count_b;
  const int32_t *faces_a;
  const int32_t *faces_b;
  /** Penalty factor β of ε = β E / h, with the smaller E and the shortest edge of the two bodies; or 0 and `options.epsilon` > 0. */
  double beta;
  ct_contact_options options;
} ct_scene_contact;

/** Prescribed velocity of a set of nodes of one body. */
typedef struct ct_scene_support {
  int32_t body;
  /** Node numbers of the body's own mesh. */
  const int32_t *nodes;
  int32_t node_count;
  int fixed[3];
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
  /** Threads, >= 1. */
  int threads;
} ct_scene_time;

CT_API ct_status ct_scene_create(ct_scene **scene, ct_error *error);

/** Add a body with a copy of the mesh; `*body` gets its number. */
CT_API ct_status ct_scene_add_body(ct_scene *scene, const char *name, const ct_mesh *mesh, const ct_material *material,
                                   ct_lumping lumping, ct_solid_kernel kernel, const double velocity[3], int32_t *body,
                                   ct_error *error);

CT_API ct_status ct_scene_add_contact(ct_scene *scene, const ct_scene_contact *contact, ct_error *error);

CT_API ct_status ct_scene_add_support(ct_scene *scene, const ct_scene_support *support, ct_error *error);

/**
 * Build the problem: masses, effects, stable step, and the largest Δt not above the asked one that reaches `end` in a whole
 * number of steps (`*step_count`). ``CT_ERROR_STEP`` when the asked Δt is above the stable one. The scene keeps the
 * problem: it lives until `ct_scene_free`.
 */
CT_API ct_status ct_scene_build(ct_scene *scene, const ct_scene_time *time, const ct_problem **problem, int64_t *step_count,
                                ct_stable_step *stable, ct_error *error);

/** Penalty ε that the contact of this number uses, after `ct_scene_build` [stress / length]. */
CT_API ct_status ct_scene_contact_epsilon(const ct_scene *scene, int32_t contact, double *epsilon);

CT_API void ct_scene_free(ct_scene *scene);

#endif
