/* The laws that compute the force of a point from its gaps. Each law has a block of functions and a
 * row in LAWS; nothing else in this file depends on the law. */
#include "law_rows.h"

#include "../base/error.h"
#include "../base/lanes.h"

#include <float.h>
#include <math.h>

/* The smaller of two numbers, as ct_larger. */
CT_INLINE double smaller(double x, double y) { return x < y ? x : y; }

/* min(g, 0). */
CT_INLINE double below(double g) { return g < 0.0 ? g : 0.0; }

/* ½ k ⟨-g⟩². */
CT_INLINE double ramp_energy(double k, double g) { return 0.5 * k * below(g) * below(g); }

/* Compliances and offsets of rows with one law, which the caller inlines. */
CT_INLINE void fill_ramps(ct_ramp (*ramp)(const ct_constraint *c), const ct_law_rows *of,
                          int64_t first, int64_t end, double *C, double *b)
{
#pragma omp simd
  for (int64_t r = first; r < end; r++) {
    const ct_constraint c = ct_law_row(of, r);
    const ct_ramp one = ramp(&c);
    C[r] = one.C;
    b[r] = one.b;
  }
}

/* Energies that they store, likewise. */
CT_INLINE void fill_stores(double (*store)(double k, double g0, double g1), int64_t count,
                           const double *k, const double *g0, const double *g1, double *stored)
{
#pragma omp simd
  for (int64_t r = 0; r < count; r++) stored[r] = store(k[r], g0[r], g1[r]);
}

/* Energy-controlled penalty (eq:energy-controlled). */

CT_INLINE ct_ramp controlled_ramp(const ct_constraint *c)
{
  const double k = c->stiffness, a = c->dashpot, before = below(c->before);
  // -- k ⟨-½ [(1 + a) g_{n+1} + (1 - a) min(g_{n-1}, 0)]⟩ (eq:energy-controlled)
  return (ct_ramp){.C = 2.0 / (k * (1.0 + a)), .b = (1.0 - a) / (1.0 + a) * before};
}

CT_INLINE double controlled_stored(double k, double g0, double g1)
{
  // -- The mean of Π at both ends of the step (eq:controlled-store)
  return 0.5 * (ramp_energy(k, g0) + ramp_energy(k, g1));
}

CT_CLONES
static void controlled_ramps(const ct_law_rows *of, int64_t first, int64_t end, double *C,
                             double *b)
{
  fill_ramps(controlled_ramp, of, first, end, C, b);
}

CT_CLONES
static void controlled_stores(int64_t count, const double *k, const double *g0, const double *g1,
                              double *stored)
{
  fill_stores(controlled_stored, count, k, g0, g1, stored);
}

/* With the depths x = -g_n and y = -g_{n-1} = x + e the store is ¼ k (⟨x⟩² + ⟨y⟩²). */
static double controlled_raise(const ct_constraint *c, double most)
{
  const double e = c->gap - c->before, r = 4.0 * most / c->stiffness;
  // -- The larger depth with the store `most`: both gaps are inside, or one (eq:admitted-store)
  const double deeper = r > e * e ? 0.5 * (fabs(e) + sqrt(2.0 * r - e * e)) : sqrt(r);
  return fmax(-fmin(c->gap, c->before) - deeper, 0.0);
}

/* Tie (eq:tie-force). */

CT_INLINE ct_ramp tie_ramp(const ct_constraint *c)
{
  // -- -½ k (g_{n+1} + g_{n-1}), of either sign (eq:tie-force)
  return (ct_ramp){.C = 2.0 / c->stiffness, .b = c->before};
}

CT_INLINE double tie_stored(double k, double g0, double g1)
{
  // -- The mean of ½ k g² at both ends of the step (eq:tie-store)
  return 0.25 * k * (g0 * g0 + g1 * g1);
}

CT_CLONES
static void tie_ramps(const ct_law_rows *of, int64_t first, int64_t end, double *C, double *b)
{
  fill_ramps(tie_ramp, of, first, end, C, b);
}

CT_CLONES
static void tie_stores(int64_t count, const double *k, const double *g0, const double *g1,
                       double *stored)
{
  fill_stores(tie_stored, count, k, g0, g1, stored);
}

/* No point of a tie is found inside. */
static double tie_raise(const ct_constraint *c, double most)
{
  (void)c, (void)most;
  return 0.0;
}

/* All laws. */

static const struct law {
  /* The law in one step; null: its force does not depend on the next gap, and it has no rows. */
  ct_ramp (*ramp)(const ct_constraint *c);
  /* Energy that a row with the stiffness k stores at the middle of a step from the gap g0 to g1. */
  double (*stored)(double k, double g0, double g1);
  /* Compliances and offsets of rows from `first` to `end` - 1; and stored energies of some rows. */
  void (*ramps)(const ct_law_rows *of, int64_t first, int64_t end, double *C, double *b);
  void (*stores)(int64_t count, const double *k, const double *g0, const double *g1,
                 double *stored);
  /* Least addition to both gaps of the last step with which it stored at most `most`. Not null only
     if the work of a row is minus what it stores and loses (eq:contact-step-work); null: the store
     counts as that of the present gap. */
  double (*raise)(const ct_constraint *c, double most);
  /* Factor of the default penalty (eq:penalty-default). */
  double usual;
  /* The least force: 0, or none. */
  double least;
} LAWS[] = {
    [CT_ENFORCE_PENALTY] = {.usual = 4.0},
    [CT_ENFORCE_ENERGY_CONTROLLED] = {controlled_ramp, controlled_stored, controlled_ramps,
                                      controlled_stores, controlled_raise, 40.0, 0.0},
    [CT_ENFORCE_TIE] = {tie_ramp, tie_stored, tie_ramps, tie_stores, tie_raise, 40.0, -HUGE_VAL}};

/* A value of ct_enforcement without a row does not compile, nor a tie without one. */
typedef char every_law_has_its_row[sizeof LAWS / sizeof LAWS[0] == CT_ENFORCE_TIE + 1 ? 1 : -1];

static int is_known(ct_enforcement law) { return (int)law >= 0 && law < CT_ENFORCE_COUNT; }

ct_status ct_law_check(const ct_constraint *c, const char *who, ct_error *error)
{
  if (!is_known(c->enforcement))
    return CT_REFUSE(error, "%s: there is no enforcement %d", who, (int)c->enforcement);
  if (!(c->dissipation >= 0.0 && c->dissipation <= 1.0))
    return CT_REFUSE(error, "%s: dissipation must be 0 to 1, not %g", who, c->dissipation);
  if (!(c->restitution >= 0.0 && c->restitution <= 1.0))
    return CT_REFUSE(error, "%s: restitution must be 0 to 1, not %g", who, c->restitution);
  if (!(c->travel_time >= 0.0 && isfinite(c->travel_time)))
    return CT_REFUSE(error, "%s: travel_time must be 0 or positive and finite, not %g", who,
                     c->travel_time);
  return CT_OK;
}

ct_status ct_law_check_time(const ct_constraint *c, const char *who, ct_error *error)
{
  if (!ct_law_has_rows(c->enforcement) || c->restitution == 0.0 || c->travel_time > 0.0)
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

double ct_law_least(ct_enforcement law) { return LAWS[law].least; }

int ct_law_has_rows(ct_enforcement law) { return LAWS[law].ramp != NULL; }

int ct_law_keeps_account(ct_enforcement law) { return LAWS[law].raise != NULL; }

ct_ramp ct_law_ramp(const ct_constraint *c) { return LAWS[c->enforcement].ramp(c); }

CT_INLINE double damping(double zeta, double stiffness, double mobility)
{
  // -- a = ζ √(1 + 4 / (ω Δt)²), (ω Δt)² = k Δt² / m (eq:surface-damping)
  const double a = zeta * sqrt(1.0 + 4.0 / (stiffness * mobility));
  return fabs(a) <= DBL_MAX ? a : 0.0;
}

CT_CLONES
void ct_law_dampings(int64_t count, const double *zeta, const double *stiffness,
                     const double *mobility, double fraction, double *restrict a)
{
#pragma omp simd
  for (int64_t r = 0; r < count; r++) a[r] = damping(zeta[r], stiffness[r], mobility[r] / fraction);
}

CT_INLINE double dashpot(const ct_constraint *c, double mobility)
{
  // -- A point that has just closed does not rebound on its own spring (eq:release-time)
  const double zeta = ct_larger(c->dissipation, ct_law_is_fresh(c) ? 0.5 : 0.0);
  return damping(zeta, c->stiffness, mobility);
}

double ct_law_dashpot(const ct_constraint *c, double mobility) { return dashpot(c, mobility); }

CT_CLONES
static void find_dashpots(const ct_law_rows *of, const double *bound, double fraction)
{
#pragma omp simd
  for (int64_t r = 0; r < of->count; r++) {
    const ct_constraint c = ct_law_row(of, r);
    of->dashpot[r] = dashpot(&c, bound[r] / fraction);
  }
}

int64_t ct_law_end(const ct_law_rows *of, int64_t first)
{
  int64_t end = of->one_law ? of->count : first + 1;
  while (end < of->count && of->row[end]->enforcement == of->row[first]->enforcement) end++;
  return end;
}

/* Energy stored at the middle of a step from the gaps g0 to g1. */
static void find_stores(const ct_law_rows *of, const double *g0, const double *g1, double *stored)
{
  for (int64_t r = 0, end; r < of->count; r = end) {
    end = ct_law_end(of, r);
    LAWS[of->row[r]->enforcement].stores(end - r, &of->stiffness[r], &g0[r], &g1[r], &stored[r]);
  }
}

void ct_law_fix(const ct_law_rows *of, const double *bound, double fraction, double *C, double *b)
{
  find_stores(of, of->before, of->gap, of->last);
  find_dashpots(of, bound, fraction);
  for (int64_t r = 0, end; r < of->count; r = end) {
    end = ct_law_end(of, r);
    LAWS[of->row[r]->enforcement].ramps(of, r, end, C, b);
  }
}

/* Stored impact (eq:impact-reserve). */

/* The time from closing to the last step with a force, and that since then. A point without a force
 * that `enters` without its neighbours' forces stays closed: they hold its nodes (eq:release-time).
 */
CT_INLINE void count_time(ct_constraint *c, int pressed, int enters, double dt)
{
  const double t = c->impact.pressed, idle = c->impact.idle, wait = idle + dt;
  // A fresh point is paid a while after its neighbours have left, too.
  const int holds = (pressed == 0) & enters & ct_law_is_fresh(c),
            goes = pressed | (enters & (t > 0.0)),
            waits = (t > 0.0) & (wait <= 2.0 * c->travel_time);
  c->impact.pressed = holds ? t : goes ? t + (dt + idle) : waits ? t : 0.0;
  c->impact.idle = (holds | goes | (waits == 0)) ? 0.0 : wait;
}

/* A row takes what it gains: it pays a debt first, and keeps the share e of the rest
 * (eq:impact-reserve). */
CT_INLINE void take(ct_constraint *c, double gain)
{
  const double debt = ct_larger(-c->impact.reserve, 0.0), e = c->restitution;
  const double kept = smaller(gain, debt) + e * ct_larger(gain - debt, 0.0);
  c->impact.reserve = e > 0.0 ? c->impact.reserve + kept : c->impact.reserve;
}

/* A force is one if its spring gives way by this part of the motion; a smaller one is rounding
 * where surfaces just touch, and must not decide when a contact begins. And this part of a reserve
 * is left where the whole was given back. */
static const double SOME = 1e-9;

/* Now the row stores the energy `stored`. */
CT_INLINE void settle(ct_constraint *c, double dt, double x, int enters, double stored)
{
  const double release = c->impact.release, own = c->force - release;
  // -- The loss of the dashpot while contact lasts stays lost (eq:impact-reserve)
  const int lasts = (own > 0.0) & (c->before < 0.0) & (ct_law_is_younger(c, CT_LASTING) == 0);
  const double closed = c->after - c->before,
               dash = lasts ? 0.25 * c->dashpot * c->stiffness * closed * closed : 0.0;
  const double size = fabs(c->impact.reserve) + c->impact.stored + stored + fabs(0.5 * own * x);
  take(c, c->impact.stored - stored - 0.5 * own * x - dash);
  c->impact.reserve -= 0.5 * release * x;
  // Rounding is nothing to give back, nor what the solver's tolerance leaves of a whole reserve;
  // whether a point opens must not depend on it.
  const double least = (release > 0.0 ? SOME : 1e-12) * size;
  c->impact.reserve =
      ((c->impact.reserve > 0.0) & (c->impact.reserve <= least)) ? 0.0 : c->impact.reserve;
  c->impact.stored = stored;
  count_time(c, own > SOME * c->stiffness * fabs(closed), enters, dt);
}

void ct_law_settle(ct_constraint *c, double dt, double x, int enters)
{
  settle(c, dt, x, enters, ct_law_stored(c));
}

CT_CLONES
CT_CHOICES
static void settle_rows(const ct_law_rows *of, double dt, const double *x, const double *alone)
{
#pragma omp simd
  for (int64_t r = 0; r < of->count; r++) {
    ct_constraint c = ct_law_row(of, r);
    // -- λ_u > 0 (eq:release-time)
    settle(&c, dt, x[r], alone[r] < 0.0, of->next[r]);
    of->reserve[r] = c.impact.reserve;
    of->pressed[r] = c.impact.pressed;
    of->idle[r] = c.impact.idle;
    of->stored[r] = c.impact.stored;
  }
}

void ct_law_settle_all(const ct_law_rows *of, double dt, const double *x, const double *alone,
                       int stored)
{
  if (!stored) find_stores(of, of->gap, of->after, of->next);
  settle_rows(of, dt, x, alone);
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

double ct_law_left(const ct_constraint *c)
{
  // -- ⟨K⟩ where a point has left: t_c > 0 (eq:impact-left)
  return isnan(c->gap) && c->impact.pressed > 0.0 ? ct_larger(c->impact.reserve, 0.0) : 0.0;
}

void ct_law_divide(const ct_constraint *c, double part, ct_impact *memory)
{
  const double last = c->gap - c->before, obstacle = c->moved - c->came,
               bend = c->after - 2.0 * c->gap + c->before - obstacle;
  // -- g'_{n-1}, one smaller step before (eq:divided-work)
  const double before = c->gap - part * (last + 0.5 * (1.0 - part) * bend);
  ct_constraint then = {.restitution = c->restitution, .impact = *memory};
  // -- ½ λ (g'_{n-1} - g_{n-1}) (eq:divided-work)
  take(&then, -0.5 * c->force * (before - c->before));
  *memory = then.impact;
}

static double stored_between(const ct_constraint *c, double g0, double g1)
{
  return LAWS[c->enforcement].stored(c->stiffness, g0, g1);
}

/* `last` and `next`: the energy stored at the middle of the last and the next step. */
CT_INLINE double loss(double before, double after, double force, double last, double next)
{
  // -- ½ (Π(g_{n-1}) - Π(g_{n+1})) - ½ λ (g_{n+1} - g_{n-1}) (eq:row-loss)
  return last - next - 0.5 * force * (after - before);
}

double ct_law_loss(const ct_constraint *c, double force, double after)
{
  return loss(c->before, after, force, stored_between(c, c->before, c->gap),
              stored_between(c, c->gap, after));
}

double ct_law_paid(double K, double held, double debt)
{
  // -- P = min(H, B), K ← K (1 - P / H) or K (1 - P / B) (eq:impact-debt)
  return K * (1.0 - fmin(held, debt) / (K > 0.0 ? held : debt));
}

CT_CLONES
void ct_law_take_debts(const ct_law_rows *of)
{
#pragma omp simd
  for (int64_t r = 0; r < of->count; r++) {
    // -- ⟨Ŝ_{n-1/2} - S_{n-1/2}⟩ (eq:release-debt)
    const double debt =
        of->restitution[r] > 0.0 ? ct_larger(of->last[r] - of->stored[r], 0.0) : 0.0;
    of->reserve[r] -= debt;
    of->stored[r] += debt;
  }
}

CT_CLONES
static void find_losses(const ct_law_rows *of, const double *force, const double *after,
                        double *losses)
{
#pragma omp simd
  for (int64_t r = 0; r < of->count; r++)
    losses[r] = loss(of->before[r], after[r], force[r], of->last[r], of->next[r]);
}

void ct_law_losses(const ct_law_rows *of, const double *force, const double *after, double *losses)
{
  find_stores(of, of->gap, after, of->next);
  find_losses(of, force, after, losses);
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

void ct_law_claims(ct_enforcement law, int64_t count, const double *k, const double *before,
                   const double *gap, double *claims)
{
  if (ct_law_keeps_account(law)) LAWS[law].stores(count, k, before, gap, claims);
  else
    for (int64_t r = 0; r < count; r++) claims[r] = ramp_energy(k[r], gap[r]);
}

double ct_law_raise(const ct_constraint *c, double most)
{
  if (ct_law_keeps_account(c->enforcement)) return LAWS[c->enforcement].raise(c, most);
  return fmax(-c->gap - sqrt(2.0 * most / c->stiffness), 0.0);
}

double ct_law_start(const ct_constraint *c)
{
  // -- Energy of the gap itself, before the force has acted (eq:energy-start)
  return stored_between(c, c->gap, c->gap);
}
