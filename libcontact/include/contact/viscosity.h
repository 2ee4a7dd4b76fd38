#ifndef CONTACT_VISCOSITY_H
#define CONTACT_VISCOSITY_H

#include <contact/effect.h>
#include <contact/step.h>

CT_BEGIN_DECLS

/**
 * Bulk viscosity: a pressure against compression that spreads a front over a few elements,
 * :eq:`bulk-viscosity`. It takes energy out of the bodies, which the ledger shows as the (negative)
 * work of the effect "viscosity".
 */
typedef struct ct_viscosity {
  /** Coefficient Q₁ of the part that grows with the strain rate, >= 0; 0.06 is usual. */
  double linear;
  /** Coefficient Q₂ of the part that grows with its square, >= 0; 1.2 is usual. */
  double quadratic;
  /** Numbers of the bodies, shape (body_count); null: all. */
  const int32_t *bodies;
  /** Number of bodies in `bodies`. */
  int32_t body_count;
} ct_viscosity;

/**
 * The effect "viscosity" of some bodies of the joined problem. ``CT_ERROR_UNSUPPORTED``: a body is
 * not of hex8.
 * ``CT_ERROR_ARGUMENT``: a coefficient is negative, both are 0, or a body does not exist or is
 * named twice.
 */
CT_API ct_status ct_viscosity_create_effect(const ct_viscosity *options, const ct_problem *problem,
                                            ct_effect **effect, ct_error *error);

/**
 * The pressure of one hex8 element, the readable form, :eq:`bulk-viscosity`: `nodes` and `velocity`
 * have shape (8, 3), `c1` is the speed of the dilatation wave. Writes the pressure [stress], 0
 * unless the element is compressed, and the force on the nodes, shape (8, 3) [force],
 * :eq:`viscous-force`.
 */
CT_API ct_status ct_viscosity_element(const double *nodes, const double *velocity, double density,
                                      double c1, double linear, double quadratic, double *pressure,
                                      double *force, ct_error *error);

CT_END_DECLS

#endif
