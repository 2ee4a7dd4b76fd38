#ifndef CONTACT_INTEGRATOR_H
#define CONTACT_INTEGRATOR_H

#include <contact/status.h>

CT_BEGIN_DECLS

/** Explicit methods that take a problem from one moment to the next, :doc:`/theory/integrator`. */
typedef enum ct_scheme {
  /** Central difference in leapfrog form, :eq:`leapfrog`; no parameter (0). */
  CT_CENTRAL_DIFFERENCE,
  /** Chung and Lee; parameter β, 1 ... 28/27, :eq:`chung-lee-drift`. */
  CT_CHUNG_LEE,
  /** Noh and Bathe, two evaluations of the forces in a step; parameter p, 1/2 ... 2 - √2,
     :eq:`noh-bathe-stages`. */
  CT_NOH_BATHE,
  /** Tchamwa and Wielgosz; parameter ρ∞, 0 ... 1, :eq:`tchamwa-wielgosz-drift`. */
  CT_TCHAMWA_WIELGOSZ
} ct_scheme;

/** A method and its one parameter. All bytes zero: central difference. */
typedef struct ct_integrator {
  /** The method. */
  ct_scheme scheme;
  /** Its parameter, as the method says. */
  double parameter;
} ct_integrator;

/** One evaluation of the forces and the motion after it, :eq:`stage`. All numbers are shares of Δt.
 */
typedef struct ct_stage {
  /** Time τ until the next evaluation. */
  double drift;
  /** Weight c of the force in the kick of the velocity. */
  double kick;
  /** Weight r of the force in the velocity of the drift. */
  double push;
  /** Weight l of the force of the evaluation before in the velocity of the drift. */
  double carry;
} ct_stage;

/** The method of this scheme with its usual parameter: β = 28/27, p = 0.54, ρ∞ = 0.9. */
CT_API ct_integrator ct_integrator_default(ct_scheme scheme);

/** Name of a scheme: "central_difference", "chung_lee", "noh_bathe" or "tchamwa_wielgosz"; null for
 * another number. */
CT_API const char *ct_scheme_name(ct_scheme scheme);

/** ``CT_ERROR_ARGUMENT`` for an unknown scheme or a parameter out of its range, with the range in
 * `error`. */
CT_API ct_status ct_integrator_check(const ct_integrator *integrator, ct_error *error);

/** Fill the stages of one step, shape (2); the number of them (1 or 2). */
CT_API int ct_integrator_stages(const ct_integrator *integrator, ct_stage *stages);

/** Share g of Δt by which the force at t_n completes the velocity there, v_n = v + g Δt f_n / m,
 * :eq:`stage-velocity`. */
CT_API double ct_integrator_share(const ct_integrator *integrator);

/** Largest stable Ω = ω Δt of an oscillator without damping, :eq:`integrator-limits`. */
CT_API double ct_integrator_limit(const ct_integrator *integrator);

/**
 * Largest stable Δt [time] for the sums `omega_squared` of ω² [1 / time²] and `rate` of the damping
 * rates [1 / time], :eq:`integrator-damped-bound`.
 */
CT_API double ct_integrator_step(const ct_integrator *integrator, double omega_squared,
                                 double rate);

CT_END_DECLS

#endif
