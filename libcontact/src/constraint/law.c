/* The laws that compute the force of a point from its gaps. Each law has a block of functions and a
 * row in LAWS; nothing else in this file depends on the law. */
#include "law.h"

#include "../base/error.h"

#include <math.h>

/* The larger of two numbers, without the call of fmax. */
static inline double larger(double x, double y) { return x > y ? x : y; }

/* min(g, 0). */
static inline double below(double g) { return g < 0.0 ? g : 0.0; }

/* ½ k ⟨-g⟩². */
static inline double ramp_energy(double k, double g) { return 0.5 * k * below(g) * below(g); }

/* Energy-controlled penalty (eq:energy-controlled). */

static ct_ramp controlled_ramp(const ct_constraint *c)
{
  const double k = c->stiffness, a = c->dashpot, before = below(c->before);
  // -- k ⟨-½ [(1 + a) g_{n+1} + (1 - a) min(g_{n-1}, 0)]⟩ (eq:energy-controlled)
  return (ct_ramp){.C = 2.0 / (k * (1.0 + a)), .b = (1.0 - a) / (1.0 + a) * before};
}

static double controlled_stored(const ct_constraint *c, double g0, double g1)
{
  // -- The mean of Π at both ends of the step (eq:controlled-store)
  return 0.5 * (ramp_energy(c->stiffness, g0) + ramp_energy(c->stiffness, g1));
}

/* With the depths x = -g_n and y = -g_{n-1} = x + e the store is ¼ k (⟨x⟩² + ⟨y⟩²). */
static double controlled_raise(const ct_constraint *c, double most)
{
  const double e = c->gap - c->before, r = 4.0 * most / c->stiffness;
  // -- The larger depth with the store `most`: both gaps are inside, or one (eq:admitted-store)
  const double deeper = r > e * e ? 0.5 * (fabs(e) + sqrt(2.0 * r - e * e)) : sqrt(r);
  return fmax(-fmin(c->gap, c->before) - deeper, 0.0);
}

/* All laws. */

static const struct law {
  /* The law in one step; null: its force does not depend on the next gap, and it has no rows. */
  ct_ramp (*ramp)(const ct_constraint *c);
  /* Energy stored at the middle of a step from the gap g0 to g1. */
  double (*stored)(const ct_constraint *c, double g0, double g1);
  /* Least addition to both gaps of the last step with which it stored at most `most`. Not null only
     if the work of a row is minus what it stores and loses (eq:contact-step-work); null: the store
     counts as that of the present gap. */
  double (*raise)(const ct_constraint *c, double most);
  /* Factor of the default penalty (eq:penalty-default). */
  double usual;
} LAWS[] = {
    [CT_ENFORCE_PENALTY] = {NULL, NULL, NULL, 4.0},
    [CT_ENFORCE_ENERGY_CONTROLLED] = {controlled_ramp, controlled_stored, controlled_raise, 40.0}};

/* A value of ct_enforcement without a row does not compile. */
typedef char every_law_has_its_row[sizeof LAWS / sizeof LAWS[0] == CT_ENFORCE_COUNT ? 1 : -1];

static int is_known(ct_enforcement law) { return (int)law >= 0 && law < CT_ENFORCE_COUNT; }

ct_status ct_law_check(const ct_constraint *c, const char *who, ct_error *error)
{
  if (!is_known(c->enforcement))
    return CT_REFUSE(error, "%s: there is no enforcement %d", who, (int)c->enforcement);
  if (!(c->dissipation >= 0.0 && c->dissipation <= 1.0))
    return CT_REFUSE(error, "%s: dissipation must be 0 to 1, not %g", who, c->dissipation);
  if (!(c->restitution >= 0.0 && c->restitution <= 1.0))
    return CT_REFUSE(error, "%s: restitution must be 0 to 1, not %g", who, c->restitution);
  return CT_OK;
}

ct_status ct_law_check_time(const ct_constraint *c, const char *who, ct_error *error)
{
  if (!ct_law_has_rows(c->enforcement) || c->restitution == 0.0 ||
      (c->travel_time > 0.0 && isfinite(c->travel_time)))
    return CT_OK;
  return CT_REFUSE(error,
                   "%s: travel_time must be positive, not %g: give h / c1, the time in which a "
                   "wave crosses an element at the surface, or restitution 0",
                   who, c->travel_time);
}

double ct_law_usual(ct_enforcement law)
{
  return LAWS[is_known(law) ? law : CT_ENFORCE_PENALTY].usual;
}

int ct_law_has_rows(ct_enforcement law) { return LAWS[law].ramp != NULL; }

int ct_law_keeps_account(ct_enforcement law) { return LAWS[law].raise != NULL; }

ct_ramp ct_law_ramp(const ct_constraint *c) { return LAWS[c->enforcement].ramp(c); }

/* Travel times after which a contact counts as lasting: those of an impact of twenty layers
 * (eq:impact-reserve). */
static const double LASTING = 40.0;

/* Whether the point closed less than so many travel times ago. */
static int is_younger(const ct_constraint *c, double times)
{
  return c->restitution > 0.0 && c->impact.pressed < times * c->travel_time;
}

/* Whether the point closed less than τ = 1.5 h / c₁ ago (eq:release-time). */
static int is_fresh(const ct_constraint *c) { return is_younger(c, 1.5); }

double ct_law_damping(double zeta, double stiffness, double mobility)
{
  // -- a = ζ √(1 + 4 / (ω Δt)²), (ω Δt)² = k Δt² / m (eq:surface-damping)
  const double a = zeta * sqrt(1.0 + 4.0 / (stiffness * mobility));
  return isfinite(a) ? a : 0.0;
}

double ct_law_dashpot(const ct_constraint *c, double mobility)
{
  // -- A point that has just closed does not rebound on its own spring (eq:impact-reserve)
  const double zeta = is_fresh(c) ? larger(c->dissipation, 0.5) : c->dissipation;
  return ct_law_damping(zeta, c->stiffness, mobility);
}

/* Stored impact (eq:impact-reserve). */

static int is_recent(const ct_constraint *c) { return c->impact.idle <= 2.0 * c->travel_time; }

/* Whether a contact shorter than τ has ended: its point does not oscillate with its node any more
 * (eq:release-time). */
static int is_over(const ct_constraint *c)
{
  const double T = c->travel_time;
  return c->impact.idle >= T && c->impact.pressed + c->impact.idle >= 1.5 * T;
}

int ct_law_may_release(const ct_constraint *c)
{
  const double K = c->impact.reserve; // may be rounding below zero, or too small to square
  return K > 0.0 && K * K > 0.0 && (!is_fresh(c) || is_over(c)) && is_recent(c);
}

int ct_law_releases(const ct_constraint *c, double bound, double dt, double force)
{
  const double last = c->force - c->impact.release, T = c->travel_time / dt;
  // -- The step that is nearest to the zero of the extrapolated force, if the spring can stop its
  // node while a wave crosses the element, k W (T / Δt)² > 1/100 (eq:release-time)
  return ct_law_may_release(c) && force <= last / 3.0 && 100.0 * c->stiffness * bound * T * T > 1.0;
}

ct_ramp ct_law_release(const ct_constraint *c, double free, double bound, double *force)
{
  const double K = c->impact.reserve, x = free - c->before, root = sqrt(x * x + 8.0 * K * bound);
  // -- λ* x* / 2 = K with x* = x_free + D λ*, without cancellation (eq:release-ramp)
  const double lambda = x < 0.0 ? (root - x) / (2.0 * bound) : 4.0 * K / (root + x),
               opening = 2.0 * K / lambda;
  *force = lambda;
  // -- ⟨2 λ* - (λ* / x*) (g_{n+1} - g_{n-1})⟩, a tangent of the hyperbola (eq:release-ramp)
  return (ct_ramp){.C = opening / lambda, .b = -(c->before + 2.0 * opening)};
}

/* The time from closing to the last step with a force, and that since then. A point without a force
 * that `enters` without its neighbours' forces stays closed: they hold its nodes (eq:release-time).
 */
static void count_time(ct_constraint *c, int pressed, int enters, double dt)
{
  ct_impact *impact = &c->impact;
  if (!pressed && enters && is_fresh(c)) {
    impact->idle = 0.0; // it is paid a while after its neighbours have left, too
  } else if (pressed || (enters && impact->pressed > 0.0)) {
    impact->pressed += dt + impact->idle;
    impact->idle = 0.0;
  } else if (impact->pressed > 0.0) {
    impact->idle += dt;
    if (!is_recent(c)) impact->pressed = impact->idle = 0.0;
  }
}

/* A row takes what it gains: it pays a debt first, and keeps the share e of the rest
 * (eq:impact-reserve). */
static void take(ct_constraint *c, double gain)
{
  const double debt = fmax(-c->impact.reserve, 0.0);
  if (c->restitution > 0.0)
    c->impact.reserve += fmin(gain, debt) + c->restitution * fmax(gain - debt, 0.0);
}

void ct_law_settle(ct_constraint *c, double dt, double x, int enters)
{
  ct_impact *impact = &c->impact;
  const double release = impact->release, own = c->force - release, stored = ct_law_stored(c);
  // -- The loss of the dashpot while contact lasts stays lost (eq:impact-reserve)
  const int lasts = own > 0.0 && c->before < 0.0 && !is_younger(c, LASTING);
  const double closed = c->after - c->before,
               dash = lasts ? 0.25 * c->dashpot * c->stiffness * closed * closed : 0.0;
  take(c, impact->stored - stored - 0.5 * own * x - dash);
  impact->reserve -= 0.5 * release * x;
  impact->stored = stored;
  count_time(c, own > 0.0, enters, dt);
}

void ct_law_settle_again(ct_constraint *c, double dt, double first)
{
  const double change = fabs(c->force - first);
  c->impact.release = 0.0;
  c->impact.pressed = c->force > 0.0 ? dt : 0.0;
  // A change within ten times the solver's tolerance is none.
  if (c->restitution > 0.0 && change <= 1e-9 * first) return;
  // -- 2 λ_0 - λ acts in the first half step, λ being the first solution (eq:reserve-start)
  c->impact.reserve *= first > 0.0 ? fmin(fmax(2.0 * c->force / first - 1.0, 0.0), 1.0) : 0.0;
  c->impact.stored = ct_law_stored(c);
}

void ct_law_leave(ct_constraint *c, double dt)
{
  // -- What the last partner had stored (eq:impact-reserve)
  take(c, c->impact.stored);
  c->force = c->impact.release = c->impact.stored = 0.0;
  count_time(c, 0, 0, dt);
}

static double stored_between(const ct_constraint *c, double g0, double g1)
{
  return LAWS[c->enforcement].stored(c, g0, g1);
}

double ct_law_loss(const ct_constraint *c, double force, double after)
{
  // -- ½ (Π(g_{n-1}) - Π(g_{n+1})) - ½ λ (g_{n+1} - g_{n-1}) (eq:row-loss)
  return stored_between(c, c->before, c->gap) - stored_between(c, c->gap, after) -
         0.5 * force * (after - c->before);
}

double ct_law_stored(const ct_constraint *c) { return stored_between(c, c->gap, c->after); }

double ct_law_lag(const ct_constraint *c)
{
  // -- Correction of the leapfrog's energy at t_n by the force (eq:controlled-energy)
  return 0.25 * c->force * ((c->after + c->before) - 2.0 * c->gap);
}

double ct_law_energy(const ct_constraint *c)
{
  // -- The mean of the stores of two half steps (eq:controlled-energy)
  return 0.5 * (stored_between(c, c->before, c->gap) + ct_law_stored(c)) + ct_law_lag(c);
}

double ct_law_claim(const ct_constraint *c)
{
  return ct_law_keeps_account(c->enforcement) ? stored_between(c, c->before, c->gap)
                                              : ramp_energy(c->stiffness, c->gap);
}

double ct_law_raise(const ct_constraint *c, double most)
{
  if (ct_law_keeps_account(c->enforcement)) return LAWS[c->enforcement].raise(c, most);
  return fmax(-c->gap - sqrt(2.0 * most / c->stiffness), 0.0);
}

double ct_law_start(const ct_constraint *c)
{
  // -- Energy of the gap itself, before the force has acted (eq:energy-start)
  return ramp_energy(c->stiffness, c->gap);
}
