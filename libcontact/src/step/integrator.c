/* The explicit methods of time integration: a table with a row for each. Every one is the leapfrog
 * with another drift. */
#include <libcontact/problem.h>

#include "../base/error.h"
#include "workspace.h"

#include <math.h>
#include <stddef.h>

/* A row of the table. */
typedef struct method {
  ct_scheme_facts facts;
  /* Write the stages of a step, and return their number (eq:stage). */
  int (*stages)(const ct_integrator *integrator, ct_stage *stages);
  /* S = (2 / Ω)² at the limit; 1 for the leapfrog (eq:integrator-limits). */
  double (*stiffening)(const ct_integrator *integrator);
} method;

static int leapfrog_stages(const ct_integrator *integrator, ct_stage *stages)
{
  (void)integrator;
  stages[0] = (ct_stage){1.0, 1.0, 1.0, 0.0};
  return 1;
}

static double leapfrog_stiffening(const ct_integrator *integrator)
{
  (void)integrator;
  return 1.0;
}

static int chung_lee_stages(const ct_integrator *integrator, ct_stage *stages)
{
  const double r = integrator->parameter;
  // -- The drift depends on the change of the force (eq:chung-lee-drift)
  stages[0] = (ct_stage){1.0, 1.0, r, 1.0 - r};
  return 1;
}

static double chung_lee_stiffening(const ct_integrator *integrator)
{
  return 4.0 * integrator->parameter - 3.0; // (eq:integrator-limits)
}

static int noh_bathe_stages(const ct_integrator *integrator, ct_stage *stages)
{
  // -- Two stages of the lengths τ₁ and τ₂ = 1 - τ₁ (eq:noh-bathe-stages)
  double tau1 = integrator->parameter, tau2 = 1.0 - tau1, second = tau2 / (2.0 * tau1);
  stages[0] = (ct_stage){tau1, 1.0 - second, tau1, 0.0};
  stages[1] = (ct_stage){tau2, second, 0.5, -(2.0 * tau1 - 1.0) * second};
  return 2;
}

static double noh_bathe_stiffening(const ct_integrator *integrator)
{
  const double tau1 = integrator->parameter;
  // -- (1 - τ₁)(3τ₁ - 1) (eq:integrator-limits)
  return (1.0 - tau1) * (3.0 * tau1 - 1.0);
}

/* φ of Tchamwa and Wielgosz. */
static double phi_of(const ct_integrator *integrator)
{
  return 2.0 / (1.0 + integrator->parameter);
}

static int tchamwa_wielgosz_stages(const ct_integrator *integrator, ct_stage *stages)
{
  // -- The drift uses a larger multiple of the force than the velocity (eq:tchamwa-wielgosz-drift)
  stages[0] = (ct_stage){1.0, 1.0, phi_of(integrator), 0.0};
  return 1;
}

static double tchamwa_wielgosz_stiffening(const ct_integrator *integrator)
{
  // -- 2φ - 1 (eq:integrator-limits)
  return 2.0 * phi_of(integrator) - 1.0;
}

/* 2 - √2: with a larger τ₁ the dissipation of the method of Noh and Bathe decreases again. */
#define LARGEST_P 0.585786437626905

/* All methods: name, parameter, its least, largest and usual value, order, stores. */
static const method METHODS[] = {
    [CT_CENTRAL_DIFFERENCE] = {{"central_difference", "no parameter", 0.0, 0.0, 0.0, 2, 0},
                               leapfrog_stages,
                               leapfrog_stiffening},
    [CT_CHUNG_LEE] = {{"chung_lee", "beta", 1.0, 28.0 / 27.0, 28.0 / 27.0, 2, 1},
                      chung_lee_stages,
                      chung_lee_stiffening},
    [CT_NOH_BATHE] = {{"noh_bathe", "p", 0.5, LARGEST_P, 0.54, 2, 0},
                      noh_bathe_stages,
                      noh_bathe_stiffening},
    [CT_TCHAMWA_WIELGOSZ] = {{"tchamwa_wielgosz", "rho_inf", 0.0, 1.0, 0.9, 1, 0},
                             tchamwa_wielgosz_stages,
                             tchamwa_wielgosz_stiffening}};

/* A value of ct_scheme without a row does not compile, if it is the last one. */
typedef char
    every_scheme_has_its_row[sizeof METHODS / sizeof METHODS[0] == CT_SCHEME_COUNT ? 1 : -1];

const ct_scheme_facts *ct_integrator_facts(ct_scheme scheme)
{
  return (int)scheme >= 0 && scheme < CT_SCHEME_COUNT ? &METHODS[scheme].facts : NULL;
}

/* A scheme that ct_integrator_check refuses must not read behind the table. */
static const method *method_of(const ct_integrator *integrator)
{
  const int known = ct_integrator_facts(integrator->scheme) != NULL;
  return &METHODS[known ? integrator->scheme : CT_CENTRAL_DIFFERENCE];
}

ct_integrator ct_integrator_default(ct_scheme scheme)
{
  const ct_scheme_facts *facts = ct_integrator_facts(scheme);
  return (ct_integrator){scheme, facts == NULL ? 0.0 : facts->usual};
}

ct_status ct_integrator_check(const ct_integrator *integrator, ct_error *error)
{
  const ct_scheme_facts *f = integrator == NULL ? NULL : ct_integrator_facts(integrator->scheme);
  if (f == NULL)
    return CT_REFUSE(error, "integrator: there is no scheme %d",
                     integrator == NULL ? -1 : (int)integrator->scheme);
  if (integrator->parameter >= f->least && integrator->parameter <= f->most) return CT_OK;
  return CT_REFUSE(error, "integrator: %s = %.17g of %s is not between %.17g and %.17g",
                   f->parameter, integrator->parameter, f->name, f->least, f->most);
}

int ct_integrator_stages(const ct_integrator *integrator, ct_stage *stages)
{
  return method_of(integrator)->stages(integrator, stages);
}

int ct_integrator_evaluations(const ct_integrator *integrator)
{
  ct_stage stages[2];
  return ct_integrator_stages(integrator, stages);
}

int ct_integrator_is_leapfrog(const ct_integrator *integrator)
{
  ct_stage s[2];
  return ct_integrator_stages(integrator, s) == 1 && s[0].tau == 1.0 && s[0].c == 1.0 &&
         s[0].r == 1.0 && s[0].l == 0.0 && !method_of(integrator)->facts.stores;
}

double ct_integrator_share(const ct_integrator *integrator)
{
  ct_stage stages[2];
  ct_integrator_stages(integrator, stages);
  return 0.5 * stages[0].tau;
}

/* S = (2 / Ω)² at the limit (eq:integrator-limits). */
static double stiffening(const ct_integrator *integrator)
{
  return method_of(integrator)->stiffening(integrator);
}

double ct_integrator_limit(const ct_integrator *integrator)
{
  return 2.0 / sqrt(stiffening(integrator));
}

double ct_integrator_step(const ct_integrator *integrator, double omega_squared, double rate)
{
  const double s = stiffening(integrator);
  ct_stage stages[2];
  // 2 / √Σω̂² (eq:step-bound)
  if (rate == 0.0) return 2.0 / sqrt(s * omega_squared);
  // -- A velocity half a step old costs each method as much as the leapfrog; two stages share the
  // cost (eq:integrator-damped-bound)
  if (ct_integrator_stages(integrator, stages) > 1)
    return 4.0 / (sqrt(s) * (rate + sqrt(rate * rate + 4.0 * omega_squared)));
  // 4 / (d̂ + √(d̂² + 4 ω̂²)) (eq:damped-step-bound)
  return 4.0 / (rate + sqrt(rate * rate + 4.0 * s * omega_squared));
}
