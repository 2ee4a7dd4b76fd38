#ifndef CONTACT_ABSORB_H
#define CONTACT_ABSORB_H

#include <contact/segment.h>
#include <contact/step.h>

CT_BEGIN_DECLS

/** Faces through which waves leave the body instead of being reflected. */
typedef struct ct_absorb {
  /** What the faces are. */
  ct_face_kind kind;
  /** Number of faces; all belong to one body. */
  int32_t face_count;
  /** Node numbers of the problem, shape (face_count, 4 or 8). */
  const int32_t *faces;
} ct_absorb;

/**
 * The effect "absorb" of Lysmer and Kuhlemeyer: a traction against the velocity, ρ c₁ along the
 * normal and ρ c₂ across, :eq:`absorb-traction`. It stores nothing; what leaves stands in the
 * ledger as negative work. The problem is a joined one, see `ct_scene_join`. ``CT_ERROR_ARGUMENT``:
 * faces of several bodies.
 */
CT_API ct_status ct_absorb_create_effect(const ct_absorb *absorb, const ct_problem *problem,
                                         ct_effect **effect, ct_error *error);

CT_END_DECLS

#endif
