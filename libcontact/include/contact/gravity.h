#ifndef CONTACT_GRAVITY_H
#define CONTACT_GRAVITY_H

#include <contact/step.h>

CT_BEGIN_DECLS

/** A uniform acceleration of bodies. */
typedef struct ct_gravity {
  /** Acceleration [length / time²]. */
  double acceleration[3];
  /** Numbers of the bodies that fall, shape (body_count); null: all. */
  const int32_t *bodies;
  /** Number of them. */
  int32_t body_count;
} ct_gravity;

/**
 * The effect "gravity": f = m g at each node, with the potential :eq:`gravity-potential`. The
 * problem is a joined one, see `ct_scene_join`.
 */
CT_API ct_status ct_gravity_create_effect(const ct_gravity *gravity, const ct_problem *problem,
                                          ct_effect **effect, ct_error *error);

CT_END_DECLS

#endif
