#ifndef CT_SRC_CONSTRAINT_LAW_H
#define CT_SRC_CONSTRAINT_LAW_H

#include <libcontact/constraint.h>

/* Refuse a law that does not exist, or one whose numbers are out of range: of the row only
 * `enforcement` and the numbers that belong to a law are read. `who` begins the message. */
ct_status ct_law_check(const ct_constraint *law, const char *who, ct_error *error);

/* Force λ that the law of a row asks for if the next gap is `after`; Lagrange multipliers follow no
 * such law: NaN. */
double ct_law_force(const ct_constraint *row, double after);

/* Force λ of a row that is alone: g_{n+1} = `free` + `mobility` λ, and the law holds for this gap
 * (eq:enforcement-solution). */
double ct_law_solve(const ct_constraint *row, double free, double mobility);

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

/* λ = -k (a g + h g_{n+1}) with g_{n+1} = free + W λ. */
static inline double ct_law_line(double k, double a, double g, double h, double free, double W)
{
  return -k * (a * g + h * free) / (1.0 + k * h * W);
}

/* The larger of two, written so that it can be done in lanes. */
static inline double ct_law_larger(double x, double y) { return x > y ? x : y; }

/* The force of a point under the energy-controlled law: the largest of the answers with one part,
 * the other, and both (eq:enforcement-solution). */
static inline double ct_law_controlled(double k, double s, double g, double free, double W)
{
  const double m = 0.5 * (1.0 - s);
  double middle = ct_law_line(k, m, g, m, free, W), end = ct_law_line(k, 0.0, g, s, free, W);
  double both = ct_law_line(k, m, g, m + s, free, W);
  return ct_law_larger(ct_law_larger(middle, 0.0), ct_law_larger(end, both));
}

#endif
