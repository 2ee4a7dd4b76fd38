#ifndef CT_SRC_CONSTRAINT_LAW_H
#define CT_SRC_CONSTRAINT_LAW_H

#include <libcontact/constraint.h>

#include <stdint.h>

/* The law of a tie, which no row of a host has: a force of either sign, from the means of the gaps
 * before and after (eq:tie-force). */
enum { CT_ENFORCE_TIE = CT_ENFORCE_COUNT };

/* The least force of a law: 0, or that of a tie without a limit. */
double ct_law_least(ct_enforcement law);

/* Refuse an unknown law, or parameters out of range: of the row only `enforcement` and the
 * parameters of its law are read. `who` begins the message. */
ct_status ct_law_check(const ct_constraint *law, const char *who, ct_error *error);

/* Refuse a missing travel time, which only steps need (eq:impact-reserve). */
ct_status ct_law_check_time(const ct_constraint *law, const char *who, ct_error *error);

/* What an effect of the library tells the solver of the rows that it lists, in the dashpot of the
 * first of them, which the solver writes anyway and which is never negative: something has changed
 * what the solver has written to them; they are all rows of the effect, and of their numbers only
 * the gaps have changed otherwise since they were listed last. */
enum { CT_ROWS_CHANGED = 1, CT_ROWS_STAY = 2 };
static inline void ct_rows_tell(ct_constraint *first, int what) { first->dashpot = -what; }
static inline int ct_rows_told(const ct_constraint *first)
{
  return first->dashpot < 0.0 ? (int)-first->dashpot : 0;
}

/* A law in one step: λ = ⟨-(g_{n+1} + b)⟩ / C (eq:ramp). */
typedef struct ct_ramp {
  double C; /* compliance, > 0 */
  double b; /* offset of the next gap */
} ct_ramp;

/* The factor of ρ c₁² / h in the default penalty (eq:penalty-default); for an unknown law, too. */
double ct_law_usual(ct_enforcement law);

/* Whether a law has rows: its force depends on the next gap. */
int ct_law_has_rows(ct_enforcement law);

/* Whether the work of a row is minus what it stores and loses (eq:contact-step-work): only then its
 * account limits what points found inside may store (eq:admitted-store). */
int ct_law_keeps_account(ct_enforcement law);

/* The law of a row in the next step, after all its values at t_n are set. */
ct_ramp ct_law_ramp(const ct_constraint *row);

/* The coefficients a of dashpots with the damping ratios `zeta` on springs, for steps in which
 * forces act on a `fraction` of the time (eq:surface-damping). */
void ct_law_dampings(int64_t count, const double *zeta, const double *stiffness,
                     const double *mobility, double fraction, double *a);

/* The coefficient a of the dashpot of a row; `mobility` is the change of its gap by unit forces on
 * all points around it (eq:surface-damping). */
double ct_law_dashpot(const ct_constraint *row, double mobility);

/* Energy that a row takes from the bodies and does not store in the step with the given force and
 * next gap: negative if the forces do not solve the problem (eq:row-loss). */
double ct_law_loss(const ct_constraint *row, double force, double after);

/* Stored impact: what closing takes from the bodies is held, and an extra row of the same problem
 * gives it back in the step in which the point opens (eq:impact-reserve). */

/* Whether a row holds energy that it may give back in this step; then it takes part wherever its
 * gap is (eq:release-time). */
int ct_law_may_release(const ct_constraint *row);

/* How a point may open: by itself; because the force of its contact falls (eq:release-together); or
 * because what closing took is on its way through a layer to the next contact (eq:release-passed).
 */
typedef enum ct_opening {
  CT_OPENS_ALONE,
  CT_OPENS_TOGETHER,
  CT_OPENS_PASSED,
  CT_OPENINGS
} ct_opening;

/* Whether a row opens so in a step: its `after` is the next gap without the constraints, `force`
 * what it would have without its neighbours, and `bound` that of W (eq:release-time); `back` is the
 * time t_b after closing in which a layer sends the wave back, 0 if none does (eq:release-passed).
 */
int ct_law_releases(const ct_constraint *row, double bound, double dt, double force, ct_opening how,
                    double back);

/* The extra row: its ramp, and the force with which it gives back all of the reserve if all
 * points that open move alike. `free` is g_{n+1} without the constraints, `bound` the change of the
 * gap by unit forces of all such points (eq:release-ramp). */
ct_ramp ct_law_release(const ct_constraint *row, double free, double bound, double *force);

/* The memory of a row after a step of the length dt: its forces and gaps are known, and half of a
 * force times x is its work; `enters` tells whether it would have a force without its neighbours.
 * And of a row that has no force and is not listed (eq:impact-reserve). */
void ct_law_settle(ct_constraint *row, double dt, double x, int enters);
void ct_law_leave(ct_constraint *row, double dt);

/* What a row holds that has lost its partner in a contact that is not over (eq:impact-left). */
double ct_law_left(const ct_constraint *row);

/* Count in the memory before the step the work of its force on the change of velocity by which the
 * step is divided to this part (eq:divided-work). */
void ct_law_divide(const ct_constraint *row, double part, ct_impact *memory);

/* The same after a second solution for t = 0, whose first one had the given force; the memory is
 * that of the first one (eq:reserve-start). */
void ct_law_settle_again(ct_constraint *row, double dt, double first);

/* Energy of the row at t_n, such that its sum with the energy of the bodies never grows
 * (eq:controlled-energy). The stored energy of the last step is computed from `before`, as if the
 * row had had the same nodes. */
double ct_law_energy(const ct_constraint *row);

/* The parts of the energy of a solved constraint: the energy stored at the middle of the next step,
 * S_{n+1/2}; the correction of the leapfrog's energy at t_n by its force (eq:controlled-energy);
 * and the whole energy at t = 0 (eq:energy-start). */
double ct_law_stored(const ct_constraint *c);
double ct_law_lag(const ct_constraint *c);
double ct_law_start(const ct_constraint *c);

/* Energy that the gaps `before` and `gap` of a row would have stored at the middle of the last
 * step: that of the present partner, even if the point had another one then; and of many rows with
 * one law. And the least addition to both gaps with which it is at most `most`
 * (eq:admitted-store). */
double ct_law_claim(const ct_constraint *c);
void ct_law_claims(ct_enforcement law, int64_t count, const double *stiffness, const double *before,
                   const double *gap, double *claims);
double ct_law_raise(const ct_constraint *c, double most);

/* The numbers of many rows side by side: one array for each member of ct_constraint that a law
 * reads, in the order of the members. */
enum { CT_LAW_NUMBERS = 18 };
typedef struct ct_law_rows {
  int64_t most, count;
  ct_constraint **row; /* the rows themselves */
  int one_law;         /* whether all rows have the same law */
  double *stiffness, *dissipation, *restitution, *travel_time;
  double *gap, *moved, *came, *dashpot, *before, *after;
  double *force;                             /* the total of the last step, then the new one */
  double *reserve, *pressed, *idle, *stored; /* the impact */
  double *release;
  double *last, *next; /* energy stored at the middle of the last and the next step */
  double *all;         /* these arrays, one after the other */
} ct_law_rows;

/* End of the rows from `first` on that have one law. */
int64_t ct_law_end(const ct_law_rows *rows, int64_t first);

/* The functions above for all rows, to the same bits. What they stored last, dashpots, and ramps
 * into C and b, where unit forces on all points change the gaps by `bound`, in a whole step by
 * 1 / `fraction` of it. */
void ct_law_fix(const ct_law_rows *rows, const double *bound, double fraction, double *C,
                double *b);

/* `opens` = 1 for the rows that open so, else 0; `back` is read for CT_OPENS_PASSED only. */
void ct_law_find_releases(const ct_law_rows *rows, const double *bound, double dt,
                          const double *force, ct_opening how, const double *back, double *opens);

/* Whether any of the rows holds energy, and has without its neighbours so small a force `alone`
 * that it may open, if not for a wave that a layer sends back: most often there is none. */
int ct_law_fall(const ct_law_rows *rows, const double *alone);

/* What is left of a reserve K, or of a debt, K < 0, when points that hold H pay for those that owe
 * B, both positive, in the same proportion (eq:impact-debt). */
double ct_law_paid(double K, double held, double debt);

/* Let points that come to store more than they have stored pay for it, before they open
 * (eq:release-debt). */
void ct_law_take_debts(const ct_law_rows *rows);

/* Terms of a sum that is negative if points of a contact may open so, given its forces without
 * neighbours, `alone`, and its `last` ones (eq:release-together). */
void ct_law_find_falls(const ct_law_rows *rows, ct_opening how, const double *alone,
                       const double *last, double *falls);

/* Losses with the given forces and next gaps. */
void ct_law_losses(const ct_law_rows *rows, const double *force, const double *after,
                   double *losses);

/* The memory of each row; a row enters without its neighbours' forces if `alone` is negative.
 * `stored`: whether ct_law_losses was the last call, with these gaps. */
void ct_law_settle_all(const ct_law_rows *rows, double dt, const double *x, const double *alone,
                       int stored);

#endif
