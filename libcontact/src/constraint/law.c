/* The laws that make a force of the gaps of one point. */
#include "law.h"

#include <math.h>

double ct_law_force(const ct_constraint *c, double after)
{
  const double k = c->stiffness, s = c->dissipation, g = c->gap;
  switch (c->enforcement) {
  case CT_ENFORCE_PENALTY:
    return k * fmax(-g, 0.0);
  case CT_ENFORCE_ENERGY_CONTROLLED:
    // -- One part at the middle of the step, one at its end (eq:energy-controlled)
    return k * ((1.0 - s) * fmax(-0.5 * (g + after), 0.0) + s * fmax(-after, 0.0));
  case CT_ENFORCE_BIPENALTY:
    // -- k g + m d²g/dt² with m = k Δt² / 4, while the point is inside and is pushed (eq:bipenalty)
    return g < 0.0 ? fmax(-0.25 * k * ((after + c->before) + 2.0 * g), 0.0) : 0.0;
  case CT_ENFORCE_LAGRANGE:
    break;
  }
  return NAN;
}

double ct_law_solve(const ct_constraint *c, double free, double W)
{
  const double k = c->stiffness, g = c->gap;
  switch (c->enforcement) {
  case CT_ENFORCE_PENALTY:
    return k * fmax(-g, 0.0);
  case CT_ENFORCE_ENERGY_CONTROLLED:
    // -- The largest of the answers with one part, the other, and both (eq:enforcement-solution)
    return ct_law_controlled(k, c->dissipation, g, free, W);
  case CT_ENFORCE_BIPENALTY:
    return g < 0.0 ? fmax(-0.25 * k * ((free + c->before) + 2.0 * g) / (1.0 + 0.25 * k * W), 0.0)
                   : 0.0;
  case CT_ENFORCE_LAGRANGE:
    return W > 0.0 ? fmax(-free / W, 0.0) : 0.0;
  }
  return NAN;
}

/* ½ k ⟨-g⟩². */
static double stored(double k, double g) { return g < 0.0 ? 0.5 * k * g * g : 0.0; }

/* What the law stores in the middle of a step between two gaps; that of the bipenalty holds on both
 * sides of 0 while the point is inside. */
static double stored_between(const ct_constraint *c, double g0, double g1)
{
  const double k = c->stiffness, s = c->dissipation, middle = 0.5 * (g0 + g1);
  switch (c->enforcement) {
  case CT_ENFORCE_PENALTY:
    return stored(k, c->gap);
  case CT_ENFORCE_ENERGY_CONTROLLED:
    // -- (1 - s) Π at the middle plus s times the mean of both ends (eq:controlled-energy)
    return (1.0 - s) * stored(k, middle) + 0.5 * s * (stored(k, g0) + stored(k, g1));
  case CT_ENFORCE_BIPENALTY:
    return c->gap < 0.0 ? 0.5 * k * middle * middle : 0.0;
  case CT_ENFORCE_LAGRANGE:
    break;
  }
  return 0.0;
}

double ct_law_stored(const ct_constraint *c) { return stored_between(c, c->gap, c->after); }

double ct_law_lag(const ct_constraint *c)
{
  return c->enforcement == CT_ENFORCE_PENALTY
             ? 0.0
             : 0.25 * c->force * ((c->after + c->before) - 2.0 * c->gap);
}

double ct_law_energy(const ct_constraint *c)
{
  // -- Mean of the two half steps around t_n, and what the leapfrog's energy lacks there
  // (eq:controlled-energy)
  return 0.5 * (stored_between(c, c->before, c->gap) + ct_law_stored(c)) + ct_law_lag(c);
}

int ct_law_begins(const ct_constraint *c)
{
  return c->enforcement == CT_ENFORCE_ENERGY_CONTROLLED || c->enforcement == CT_ENFORCE_LAGRANGE;
}

double ct_law_start(const ct_constraint *c)
{
  // -- What the gap itself stores, before the force has acted (eq:energy-start)
  if (!ct_law_begins(c)) return ct_law_energy(c);
  return c->enforcement == CT_ENFORCE_ENERGY_CONTROLLED ? stored(c->stiffness, c->gap) : 0.0;
}
