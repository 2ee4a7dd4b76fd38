#ifndef CT_SRC_TRIDIAGONAL_H
#define CT_SRC_TRIDIAGONAL_H

#include <math.h>

/* Gershgorin's bound on the eigenvalues of a symmetric tridiagonal matrix with this diagonal (n)
 * and off-diagonal (n - 1). */
static inline double ct_tridiagonal_reach(int n, const double *diagonal, const double *side)
{
  double reach = 0.0;
  for (int i = 0; i < n; i++) {
    double row =
        fabs(diagonal[i]) + (i + 1 < n ? fabs(side[i]) : 0.0) + (i > 0 ? fabs(side[i - 1]) : 0.0);
    reach = row > reach ? row : reach;
  }
  return reach;
}

/* Whether all eigenvalues of the tridiagonal matrix lie below x: all pivots of T - x are negative
 * (Sturm). */
static inline int ct_tridiagonal_all_below(int n, const double *diagonal, const double *side,
                                           double x)
{
  double pivot = diagonal[0] - x;
  for (int i = 1; i < n; i++) {
    if (!(pivot < 0.0)) return 0;
    // p_i = d_i - x - b² / p_{i-1} (eq:sturm)
    pivot = diagonal[i] - x - side[i - 1] * side[i - 1] / pivot;
  }
  return pivot < 0.0;
}

#endif
