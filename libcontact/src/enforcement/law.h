#ifndef CT_SRC_ENFORCEMENT_LAW_H
#define CT_SRC_ENFORCEMENT_LAW_H

/* λ = -k (a g + h g_{n+1}) with g_{n+1} = free + W λ. */
static inline double ct_law_line(double k, double a, double g, double h, double free, double W)
{
  return -k * (a * g + h * free) / (1.0 + k * h * W);
}

/* The larger of two, written so that it can be done in lanes. */
static inline double ct_law_larger(double x, double y) { return x > y ? x : y; }

/* The force of a point under the energy-controlled law: the largest of the answers with one part, the other, and both
 * (eq:enforcement-solution). */
static inline double ct_law_controlled(double k, double s, double g, double free, double W)
{
  const double m = 0.5 * (1.0 - s);
  double middle = ct_law_line(k, m, g, m, free, W), end = ct_law_line(k, 0.0, g, s, free, W);
  double both = ct_law_line(k, m, g, m + s, free, W);
  return ct_law_larger(ct_law_larger(middle, 0.0), ct_law_larger(end, both));
}

#endif
