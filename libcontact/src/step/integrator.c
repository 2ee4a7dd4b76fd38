/* Common parts of the explicit methods: each is the leapfrog with another drift. */
#include <libcontact/problem.h>

#include "../base/error.h"
#include "workspace.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

/* Smallest, largest and default parameter of each scheme. */
typedef struct range {
  const char *name, *parameter;
  double least, most, usual;
} range;

/* 2 - √2: with a larger τ₁ the dissipation of the method of Noh and Bathe decreases again. */
#define LARGEST_P 0.585786437626905
static const range RANGES[] = {{"central_difference", "no parameter", 0.0, 0.0, 0.0},
                               {"chung_lee", "beta", 1.0, 28.0 / 27.0, 28.0 / 27.0},
                               {"noh_bathe", "p", 0.5, LARGEST_P, 0.54},
                               {"tchamwa_wielgosz", "rho_inf", 0.0, 1.0, 0.9},
                               {"pushforward_pullback", "theta", 0.0, 1.0, 0.7}};

static int is_scheme(ct_scheme scheme)
{
  return (int)scheme >= 0 && (size_t)scheme < sizeof RANGES / sizeof RANGES[0];
}

ct_integrator ct_integrator_default(ct_scheme scheme)
{
  return (ct_integrator){scheme, is_scheme(scheme) ? RANGES[scheme].usual : 0.0, 0.0};
}

ct_status ct_integrator_check(const ct_integrator *integrator, ct_error *error)
{
  if (integrator == NULL || !is_scheme(integrator->scheme))
    return CT_REFUSE(error, "integrator: there is no scheme %d",
                     integrator == NULL ? -1 : (int)integrator->scheme);
  const range *r = &RANGES[integrator->scheme];
  if (integrator->push != 0.0 && !(integrator->push >= 1.0 && integrator->push <= DBL_MAX))
    return CT_REFUSE(error, "integrator: a push of %.17g steps is not 1 or more", integrator->push);
  if (integrator->parameter >= r->least && integrator->parameter <= r->most) return CT_OK;
  return CT_REFUSE(error, "integrator: %s = %.17g of %s is not between %.17g and %.17g",
                   r->parameter, integrator->parameter, r->name, r->least, r->most);
}

int ct_integrator_evaluations(const ct_integrator *integrator)
{
  return integrator->scheme == CT_NOH_BATHE || integrator->scheme == CT_PUSHFORWARD_PULLBACK ? 2
                                                                                             : 1;
}

/* Δt_c / Δt of the pushforward, q. */
static double push_of(const ct_integrator *integrator) { return fmax(1.0, integrator->push); }

/* φ of Tchamwa and Wielgosz. */
static double phi_of(double rho) { return 2.0 / (1.0 + rho); }

int ct_integrator_stages(const ct_integrator *integrator, ct_stage *stages)
{
  const double value = integrator->parameter;
  stages[0] = (ct_stage){1.0, 1.0, 1.0, 0.0};
  switch (integrator->scheme) {
  case CT_CENTRAL_DIFFERENCE:
    break;
  case CT_CHUNG_LEE:
    // -- The drift depends on the change of the force (eq:chung-lee-drift)
    stages[0].r = value;
    stages[0].l = 1.0 - value;
    break;
  case CT_NOH_BATHE: {
    // -- Two stages of the lengths τ₁ and τ₂ = 1 - τ₁ (eq:noh-bathe-stages)
    double tau1 = value, tau2 = 1.0 - tau1, second = tau2 / (2.0 * tau1);
    stages[0] = (ct_stage){tau1, 1.0 - second, tau1, 0.0};
    stages[1] = (ct_stage){tau2, second, 0.5, -(2.0 * tau1 - 1.0) * second};
    return 2;
  }
  case CT_TCHAMWA_WIELGOSZ:
    // -- The drift uses a larger multiple of the force than the velocity
    // (eq:tchamwa-wielgosz-drift)
    stages[0].r = phi_of(value);
    break;
  case CT_PUSHFORWARD_PULLBACK: {
    // -- The drift adds a fraction of the change of acceleration over the pushforward
    // (eq:pullback-drift)
    double q = push_of(integrator);
    stages[0].l = value * (q - 1.0 / q) / 6.0;
    break;
  }
  }
  return 1;
}

double ct_integrator_share(const ct_integrator *integrator)
{
  return integrator->scheme == CT_NOH_BATHE ? 0.5 * integrator->parameter : 0.5;
}

/* (2 / Ω)² at the limit: 1 for the leapfrog (eq:integrator-limits). */
static double stiffening(const ct_integrator *integrator)
{
  const double value = integrator->parameter;
  // -- 1, 4r - 3, (1 - τ₁)(3τ₁ - 1), 2φ - 1
  switch (integrator->scheme) {
  case CT_CENTRAL_DIFFERENCE:
    break;
  case CT_CHUNG_LEE:
    return 4.0 * value - 3.0; // (eq:integrator-limits)
  case CT_NOH_BATHE:
    return (1.0 - value) * (3.0 * value - 1.0);
  case CT_TCHAMWA_WIELGOSZ:
    return 2.0 * phi_of(value) - 1.0;
  case CT_PUSHFORWARD_PULLBACK: {
    // -- 4 - x - χ/6 q(q² - 1) x² = 0 (eq:pullback-limit)
    double q = push_of(integrator);
    return 0.5 * (1.0 + sqrt(1.0 + 8.0 / 3.0 * value * q * (q * q - 1.0)));
  }
  }
  return 1.0;
}

double ct_integrator_limit(const ct_integrator *integrator)
{
  return 2.0 / sqrt(stiffening(integrator));
}

double ct_integrator_step(const ct_integrator *integrator, double omega_squared, double rate)
{
  const double s = stiffening(integrator);
  // 2 / √Σω̂² (eq:step-bound)
  if (rate == 0.0) return 2.0 / sqrt(s * omega_squared);
  // -- A velocity half a step old costs each method as much as the leapfrog; two stages share the
  // cost (eq:integrator-damped-bound)
  if (integrator->scheme == CT_NOH_BATHE)
    return 4.0 / (sqrt(s) * (rate + sqrt(rate * rate + 4.0 * omega_squared)));
  // 4 / (d̂ + √(d̂² + 4 ω̂²)) (eq:damped-step-bound)
  return 4.0 / (rate + sqrt(rate * rate + 4.0 * s * omega_squared));
}
