#ifndef CONTACT_DAMPING_H
#define CONTACT_DAMPING_H

#include <contact/step.h>

CT_BEGIN_DECLS

/** Damping in proportion to mass, or dynamic relaxation. */
typedef struct ct_damping {
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
} ct_damping;

/**
 * The effect "damping": f = -α m v with the velocity half a step back, :eq:`damping-force`. It
 * stores nothing; its work is negative and stands in the ledger. With `relaxation` it is
 * :eq:`relaxation-force`, does not limit the step, and must stand behind all effects but motions
 * and supports. The problem is a joined one, see `ct_scene_join`.
 */
CT_API ct_status ct_damping_create_effect(const ct_damping *damping, const ct_problem *problem,
                                          ct_effect **effect, ct_error *error);

CT_END_DECLS

#endif
