/* The laws that make a force of the gaps of one point. Each law has a block of functions and a row
 * in LAWS; nothing else in this file knows it. */
#include "law.h"

#include "../base/error.h"

#include <math.h>

/* ½ k ⟨-g⟩². */
static double ramp_energy(double k, double g) { return g < 0.0 ? 0.5 * k * g * g : 0.0; }

/* Explicit penalty (eq:contact-penalty). */

static double penalty_force(const ct_constraint *c, double after)
{
  (void)after;
  return c->stiffness * fmax(-c->gap, 0.0);
}

static double penalty_solve(const ct_constraint *c, double free, double W)
{
  (void)W;
  return penalty_force(c, free);
}

static double penalty_stored(const ct_constraint *c, double g0, double g1)
{
  (void)g0, (void)g1;
  return ramp_energy(c->stiffness, c->gap);
}

/* Energy-controlled penalty (eq:energy-controlled). */

static double controlled_force(const ct_constraint *c, double after)
{
  const double k = c->stiffness, s = c->dissipation, g = c->gap;
  // -- One part at the middle of the step, one at its end (eq:energy-controlled)
  return k * ((1.0 - s) * fmax(-0.5 * (g + after), 0.0) + s * fmax(-after, 0.0));
}

static double controlled_solve(const ct_constraint *c, double free, double W)
{
  return ct_law_controlled(c->stiffness, c->dissipation, c->gap, free, W);
}

static double controlled_stored(const ct_constraint *c, double g0, double g1)
{
  const double k = c->stiffness, s = c->dissipation, middle = 0.5 * (g0 + g1);
  // -- (1 - s) Π at the middle plus s times the mean of both ends (eq:controlled-energy)
  return (1.0 - s) * ramp_energy(k, middle) + 0.5 * s * (ramp_energy(k, g0) + ramp_energy(k, g1));
}

static double controlled_start(const ct_constraint *c) { return ramp_energy(c->stiffness, c->gap); }

/* Bipenalty (eq:bipenalty). */

static double bipenalty_force(const ct_constraint *c, double after)
{
  const double k = c->stiffness, g = c->gap;
  // -- k g + m d²g/dt² with m = k Δt² / 4, while the point is inside and is pushed (eq:bipenalty)
  return g < 0.0 ? fmax(-0.25 * k * ((after + c->before) + 2.0 * g), 0.0) : 0.0;
}

static double bipenalty_solve(const ct_constraint *c, double free, double W)
{
  const double k = c->stiffness, g = c->gap;
  return g < 0.0 ? fmax(-0.25 * k * ((free + c->before) + 2.0 * g) / (1.0 + 0.25 * k * W), 0.0)
                 : 0.0;
}

/* Holds on both sides of 0 while the point is inside. */
static double bipenalty_stored(const ct_constraint *c, double g0, double g1)
{
  const double middle = 0.5 * (g0 + g1);
  return c->gap < 0.0 ? 0.5 * c->stiffness * middle * middle : 0.0;
}

/* Lagrange multipliers (eq:forward-increment). */

static double multiplier_force(const ct_constraint *c, double after)
{
  (void)c, (void)after;
  return NAN;
}

static double multiplier_solve(const ct_constraint *c, double free, double W)
{
  (void)c;
  return W > 0.0 ? fmax(-free / W, 0.0) : 0.0;
}

static double multiplier_stored(const ct_constraint *c, double g0, double g1)
{
  (void)c, (void)g0, (void)g1;
  return 0.0;
}

static double multiplier_start(const ct_constraint *c)
{
  (void)c;
  return 0.0;
}

/* All laws. */

typedef struct law {
  /* The force if the next gap is `after`; it must not grow with `after`. */
  double (*force)(const ct_constraint *c, double after);
  /* The force λ with λ = force(free + W λ). */
  double (*solve)(const ct_constraint *c, double free, double W);
  /* Energy stored in the middle of a step from the gap g0 to g1. */
  double (*stored)(const ct_constraint *c, double g0, double g1);
  /* Energy held at t = 0 by a force that begins there; null: the force is taken as if it had always
   * acted (eq:energy-start). */
  double (*start)(const ct_constraint *c);
  /* Whether the force depends on the gap g_n alone; then the energy at t_n lacks nothing. */
  int is_explicit;
} law;

static const law LAWS[] = {
    [CT_ENFORCE_PENALTY] = {penalty_force, penalty_solve, penalty_stored, NULL, 1},
    [CT_ENFORCE_ENERGY_CONTROLLED] = {controlled_force, controlled_solve, controlled_stored,
                                      controlled_start, 0},
    [CT_ENFORCE_BIPENALTY] = {bipenalty_force, bipenalty_solve, bipenalty_stored, NULL, 0},
    [CT_ENFORCE_LAGRANGE] = {multiplier_force, multiplier_solve, multiplier_stored,
                             multiplier_start, 0}};

static int exists(ct_enforcement enforcement)
{
  return (int)enforcement >= 0 && (size_t)enforcement < sizeof LAWS / sizeof LAWS[0] &&
         LAWS[enforcement].solve != NULL;
}

ct_status ct_law_check(const ct_constraint *c, const char *who, ct_error *error)
{
  if (!exists(c->enforcement) || !(c->dissipation >= 0.0 && c->dissipation <= 1.0))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "%s: enforcement %d with dissipation %g",
                   who, (int)c->enforcement, c->dissipation);
  return CT_OK;
}

double ct_law_force(const ct_constraint *c, double after)
{
  return exists(c->enforcement) ? LAWS[c->enforcement].force(c, after) : NAN;
}

double ct_law_solve(const ct_constraint *c, double free, double W)
{
  return exists(c->enforcement) ? LAWS[c->enforcement].solve(c, free, W) : NAN;
}

static double stored_between(const ct_constraint *c, double g0, double g1)
{
  return exists(c->enforcement) ? LAWS[c->enforcement].stored(c, g0, g1) : 0.0;
}

double ct_law_stored(const ct_constraint *c) { return stored_between(c, c->gap, c->after); }

double ct_law_lag(const ct_constraint *c)
{
  if (exists(c->enforcement) && LAWS[c->enforcement].is_explicit) return 0.0;
  return 0.25 * c->force * ((c->after + c->before) - 2.0 * c->gap);
}

double ct_law_energy(const ct_constraint *c)
{
  // -- Mean of the two half steps around t_n, and what the leapfrog's energy lacks there
  // (eq:controlled-energy)
  return 0.5 * (stored_between(c, c->before, c->gap) + ct_law_stored(c)) + ct_law_lag(c);
}

int ct_law_begins(const ct_constraint *c)
{
  return exists(c->enforcement) && LAWS[c->enforcement].start != NULL;
}

double ct_law_start(const ct_constraint *c)
{
  // -- What the gap itself stores, before the force has acted (eq:energy-start)
  return ct_law_begins(c) ? LAWS[c->enforcement].start(c) : ct_law_energy(c);
}
