/* When a point opens and gives back what its impact has stored, and with which force
 * (eq:release-time, eq:release-ramp). */
#include "law_rows.h"

#include "../base/lanes.h"

#include <math.h>

CT_INLINE int is_recent(const ct_constraint *c) { return c->impact.idle <= 2.0 * c->travel_time; }

/* Whether a contact shorter than τ has ended: its point does not oscillate with its node any more
 * (eq:release-time). */
CT_INLINE int is_over(const ct_constraint *c)
{
  const double T = c->travel_time;
  return (c->impact.idle >= T) & (c->impact.pressed + c->impact.idle >= 1.5 * T);
}

CT_INLINE int may_release(const ct_constraint *c)
{
  const double K = c->impact.reserve; // may be rounding below zero, or too small to square
  return (K > 0.0) & (K * K > 0.0) & ((ct_law_is_fresh(c) == 0) | is_over(c)) & is_recent(c);
}

int ct_law_may_release(const ct_constraint *c) { return may_release(c); }

/* Parts of the last force below which a point opens. */
static const double PARTS[CT_OPENINGS] = {
    [CT_OPENS_ALONE] = 1.0 / 3.0, [CT_OPENS_TOGETHER] = 0.7, [CT_OPENS_PASSED] = 1.2};

/* Whether a wave that crosses a layer and comes `back` reaches a point in this step or the next. */
CT_INLINE int is_met(const ct_constraint *c, double dt, double back)
{
  // -- -½ <= (t_c - t_b) / Δt < 3/2, where a tie is not left to rounding (eq:release-passed)
  const double late = c->impact.pressed - back + 1e-6 * dt;
  return (back > 0.0) & (c->impact.idle == 0.0) & (late >= -0.5 * dt) & (late < 1.5 * dt);
}

/* Whether the force of a point falls enough, or a wave tells it to open. */
CT_INLINE int is_due(const ct_constraint *c, double dt, double force, ct_opening how, double back)
{
  if (how == CT_OPENS_PASSED) return is_met(c, dt, back);
  const double part = ct_law_is_younger(c, CT_LASTING) ? PARTS[how] : PARTS[CT_OPENS_ALONE];
  return force <= part * (c->force - c->impact.release);
}

/* Whether the spring of a point can stop its node while a wave crosses the element. */
CT_INLINE int is_stiff(const ct_constraint *c, double bound, double dt)
{
  const double T = c->travel_time / dt;
  // -- k D (T / Δt)² > 1/100 (eq:release-time)
  return 100.0 * c->stiffness * bound * T * T > 1.0;
}

CT_INLINE int releases(const ct_constraint *c, double bound, double dt, double force,
                       ct_opening how, double back)
{
  const double x = c->after - c->before;
  // -- The step that is nearest to the zero of the extrapolated force, or in which the contact
  // falls; a point that comes nearer holds more than its motion has (eq:release-time)
  return may_release(c) & is_due(c, dt, force, how, back) & is_stiff(c, bound, dt) &
         ((x >= 0.0) | (8.0 * c->impact.reserve * bound > x * x));
}

int ct_law_releases(const ct_constraint *c, double bound, double dt, double force, ct_opening how,
                    double back)
{
  return releases(c, bound, dt, force, how, back);
}

/* `how` is a constant in each call, so each loop has only its own conditions. */
CT_INLINE void find_releases(const ct_law_rows *of, const double *bound, double dt,
                             const double *force, ct_opening how, const double *back, double *opens)
{
#pragma omp simd
  for (int64_t r = 0; r < of->count; r++) {
    const ct_constraint c = ct_law_row(of, r);
    const double t = how == CT_OPENS_PASSED ? back[r] : 0.0;
    opens[r] = (bound[r] > 0.0) & releases(&c, bound[r], dt, force[r], how, t) ? 1.0 : 0.0;
  }
}

CT_CLONES
int ct_law_fall(const ct_law_rows *rows, const double *alone)
{
  const ct_law_rows of = *rows; // whose arrays are not read again after each number
  const double part = PARTS[CT_OPENS_TOGETHER];
  double some = 0.0;
#pragma omp simd reduction(+ : some)
  for (int64_t r = 0; r < of.count; r++)
    some +=
        ((of.reserve[r] > 0.0) & (alone[r] <= part * (of.force[r] - of.release[r]))) ? 1.0 : 0.0;
  return some != 0.0;
}

CT_CLONES
void ct_law_find_releases(const ct_law_rows *of, const double *bound, double dt,
                          const double *force, ct_opening how, const double *back, double *opens)
{
  if (how == CT_OPENS_ALONE) find_releases(of, bound, dt, force, CT_OPENS_ALONE, back, opens);
  else if (how == CT_OPENS_TOGETHER)
    find_releases(of, bound, dt, force, CT_OPENS_TOGETHER, back, opens);
  else find_releases(of, bound, dt, force, CT_OPENS_PASSED, back, opens);
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

CT_CLONES
void ct_law_find_falls(const ct_law_rows *of, ct_opening how, const double *alone,
                       const double *last, double *restrict falls)
{
  const double part = PARTS[how];
#pragma omp simd
  for (int64_t r = 0; r < of->count; r++)
    // -- ⟨λ_u⟩ - 0.7 λ_{n-1} (eq:release-together), or 1.2 (eq:release-passed)
    falls[r] = ct_larger(alone[r], 0.0) - part * last[r];
}
