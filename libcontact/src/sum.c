#include <contact/sum.h>

#include "grid.h"

#include <float.h>
#include <math.h>

/* Largest |value|; infinite if one is not finite. */
static double largest(const double *values, int64_t count)
{
  double top = 0.0;
  int odd = 0;
#ifndef __clang__ // which knows no vector maximum that minds NaN, and says so
#pragma omp simd reduction(max : top) reduction(| : odd)
#endif
  for (int64_t i = 0; i < count; i++) {
    double a = fabs(values[i]);
    odd |= !(a <= DBL_MAX);
    top = a > top ? a : top;
  }
  return odd ? INFINITY : top;
}

double ct_sum(const double *values, int64_t count)
{
  double top = count > 0 ? largest(values, count) : 0.0;
  if (top == 0.0) return 0.0;

  // -- Choose two grids that the largest number and the count fix (eq:order-free-sum)
  ct_grid grid;
  if (!ct_grid_init(&grid, top, count)) return NAN;

  // -- Cut each number into its parts on the two grids; both sums are exact (eq:order-free-sum)
  double sum_coarse = 0.0, sum_fine = 0.0;
#pragma omp simd reduction(+ : sum_coarse, sum_fine)
  for (int64_t i = 0; i < count; i++) ct_grid_add(&grid, values[i], &sum_coarse, &sum_fine);
  return sum_coarse + sum_fine;
}
