#ifndef CONTACT_FRICTION_H
#define CONTACT_FRICTION_H

#include <contact/step.h>

CT_BEGIN_DECLS

/** Coulomb friction with stick on the points of a contact or of an obstacle. */
typedef struct ct_friction {
  /**
   * The effect whose points rub: one of `ct_contact_create_effect` or `ct_obstacle_create_effect`.
   * It must outlive the friction and stand before it.
   */
  const ct_effect *on;
  /** Coefficient μ of friction, > 0. */
  double coefficient;
  /** Ratio ρ of the tangential penalty to the normal one, > 0; 0: 1. */
  double tangent;
} ct_friction;

/**
 * The return of an elastic slip to the limit of Coulomb, :eq:`friction-return`. `slip` [length] is
 * tangential; where it is longer than `limit` it is shortened to it. Answers by how much [length]:
 * the sliding of this step, 0 in stick.
 */
CT_API double ct_friction_return(double limit, double slip[3]);

/**
 * The effect of friction, named "friction": tangential forces in stick and in slip. It stores
 * nothing in the ledger; its work counts there as that of outside forces and is minus what it holds
 * and has dissipated. ``CT_ERROR_ARGUMENT``: no contact or obstacle to rub on, μ or ρ not positive.
 */
CT_API ct_status ct_friction_create_effect(const ct_friction *friction, const ct_problem *problem,
                                           ct_effect **effect, ct_error *error);

/**
 * What friction holds as elastic slip at the state's time, and what it has dissipated since t = 0
 * [energy], :eq:`friction-dissipation`.
 */
CT_API ct_status ct_friction_energy(const ct_problem *problem, ct_state *state, int32_t effect,
                                    double *held, double *dissipated, ct_error *error);

CT_END_DECLS

#endif
