#ifndef CT_SRC_CONSTRAINT_LAW_H
#define CT_SRC_CONSTRAINT_LAW_H

#include <libcontact/constraint.h>

/* Refuse a law that does not exist, or one whose numbers are out of range: of the row only
 * `enforcement` and the numbers that belong to a law are read. `who` begins the message. */
ct_status ct_law_check(const ct_constraint *law, const char *who, ct_error *error);

/* A law in one step: λ = ⟨-(g_{n+1} + b)⟩ / C (eq:ramp). */
typedef struct ct_ramp {
  double C; /* compliance, > 0 */
  double b; /* what the next gap counts from */
} ct_ramp;

/* Whether a law has rows: its force depends on the gap to come. */
int ct_law_has_rows(const ct_constraint *law);

/* Whether a row can have a force in the coming step, as far as its gap g_n tells. */
int ct_law_presses(const ct_constraint *row);

/* The law of a row in the coming step, once all that is known at t_n stands in it. */
ct_ramp ct_law_ramp(const ct_constraint *row);

/* Share a of the dashpot of a row whose gap moves by `mobility` when all forces around it are 1
 * (eq:surface-damping). */
double ct_law_dashpot(const ct_constraint *row, double mobility);

/* Energy that the row holds at t_n, so that the sum with what the bodies hold never grows
 * (eq:controlled-energy). What it stored in the last step is computed from `before`, as if it had
 * met the same nodes then. */
double ct_law_energy(const ct_constraint *row);

/* The parts of the energy of a solved constraint: what it stores in the middle of the coming step,
 * S_{n+1/2}; what the leapfrog's energy lacks at t_n because of its force (eq:controlled-energy);
 * and all that it holds at t = 0 (eq:energy-start). */
double ct_law_stored(const ct_constraint *c);
double ct_law_lag(const ct_constraint *c);
double ct_law_start(const ct_constraint *c);

/* Whether a force that the law finds at t = 0 begins there; that of a law which knows only gaps
 * that have been is taken as if it had always acted (eq:energy-start). */
int ct_law_begins(const ct_constraint *c);

#endif
