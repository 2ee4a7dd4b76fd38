#ifndef CONTACT_SUPPORT_H
#define CONTACT_SUPPORT_H

#include <contact/effect.h>

CT_BEGIN_DECLS

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

/**
 * The effect of all supports together: it keeps the reaction impulse at each of its nodes. Its
 * prescribed degrees of freedom must have `inverse_mass` 0 and the prescribed initial velocity,
 * which `ct_support_apply` sets. A degree of freedom that two supports give different velocities is
 * ``CT_ERROR_ARGUMENT``.
 */
CT_API ct_status ct_support_create_effect(const ct_support *supports, int32_t support_count,
                                          int32_t node_count, ct_effect **effect, ct_error *error);

/** Write zero inverse masses and the prescribed velocities, shapes (node_count of the problem, 3).
 */
CT_API ct_status ct_support_apply(const ct_effect *effect, double *inverse_mass, double *velocity);

CT_END_DECLS

#endif
