/* The laws that make a force of the gaps of one point. */
#include <contact/enforcement.h>

#include "law.h"

#include <math.h>
#include <stddef.h>

const char *ct_enforcement_name(ct_enforcement enforcement)
{
  static const char *const names[] = {"penalty", "energy_controlled", "bipenalty", "lagrange"};
  return (int)enforcement >= 0 && (size_t)enforcement < sizeof names / sizeof names[0] ? names[enforcement] : NULL;
}

double ct_enforcement_force(const ct_constraint *c, double after)
{
  const double k = c->stiffness, s = c->dissipation, g = c->gap;
  switch (c->enforcement) {
  case CT_ENFORCE_PENALTY: return k * fmax(-g, 0.0);
  case CT_ENFORCE_ENERGY_CONTROLLED:
    // -- One part at the middle of the step, one at its end (eq:energy-controlled)
    return k * ((1.0 - s) * fmax(-0.5 * (g + after), 0.0) + s * fmax(-after, 0.0));
  case CT_ENFORCE_BIPENALTY:
    // -- k g + m d²g/dt² with m = k Δt² / 4, while the point is inside and is pushed (eq:bipenalty)
    return g < 0.0 ? fmax(-0.25 * k * ((after + c->before) + 2.0 * g), 0.0) : 0.0;
  case CT_ENFORCE_LAGRANGE: break;
  }
  return NAN;
}

double ct_enforcement_solve(const ct_constraint *c, double free, double W)
{
  const double k = c->stiffness, g = c->gap;
  switch (c->enforcement) {
  case CT_ENFORCE_PENALTY: return k * fmax(-g, 0.0);
  case CT_ENFORCE_ENERGY_CONTROLLED:
    // -- The largest of the answers with one part, the other, and both (eq:enforcement-solution)
    return ct_law_controlled(k, c->dissipation, g, free, W);
  case CT_ENFORCE_BIPENALTY: return g < 0.0 ? fmax(-0.25 * k * ((free + c->before) + 2.0 * g) / (1.0 + 0.25 * k * W), 0.0) : 0.0;
  case CT_ENFORCE_LAGRANGE: return W > 0.0 ? fmax(-free / W, 0.0) : 0.0;
  }
  return NAN;
}

/* ½ k ⟨-g⟩². */
static double stored(double k, double g) { return g < 0.0 ? 0.5 * k * g * g : 0.0; }

/* (1 - s) Π at the middle of a step plus s times the mean of both its ends. */
static double stored_between(const ct_constraint *c, double g0, double g1)
{
  const double k = c->stiffness, s = c->dissipation;
  return (1.0 - s) * stored(k, 0.5 * (g0 + g1)) + 0.5 * s * (stored(k, g0) + stored(k, g1));
}

double ct_enforcement_energy(const ct_constraint *c)
{
  if (c->enforcement == CT_ENFORCE_PENALTY) return stored(c->stiffness, c->gap);
  // -- Mean of the two half steps around t_n, and what the leapfrog's energy lacks there (eq:controlled-energy)
  const double bend = (c->after + c->before) - 2.0 * c->gap;
  double held = 0.0;
  if (c->enforcement == CT_ENFORCE_ENERGY_CONTROLLED)
    held = 0.5 * (stored_between(c, c->before, c->gap) + stored_between(c, c->gap, c->after));
  if (c->enforcement == CT_ENFORCE_BIPENALTY && c->gap < 0.0) {
    const double m0 = 0.5 * (c->before + c->gap), m1 = 0.5 * (c->gap + c->after);
    held = 0.25 * c->stiffness * (m0 * m0 + m1 * m1);
  }
  return held + 0.25 * c->force * bend;
}
