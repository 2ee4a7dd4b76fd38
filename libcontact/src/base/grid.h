#ifndef CT_SRC_GRID_H
#define CT_SRC_GRID_H

#include <math.h>
#include <stdint.h>

/* Two grids for sums that do not depend on the order of their terms (eq:order-free-sum): each term
 * is cut into a multiple of the coarse spacing and a multiple of the fine one, and both sums are
 * exact for up to `count` terms of at most `top`. */
typedef struct ct_grid {
  double coarse, fine;
} ct_grid;

/* Returns 0 if `top` is not finite or too large. */
static inline int ct_grid_init(ct_grid *grid, double top, int64_t count)
{
  int bits = 0, exponent;
  while (bits < 50 && ((int64_t)1 << bits) < count) bits++;
  frexp(top, &exponent);
  if (!isfinite(top) || exponent + bits + 3 > 1023) return 0;
  grid->coarse = ldexp(1.5, exponent + bits + 2);
  grid->fine = ldexp(1.5, exponent + 2 * bits + 2 - 50);
  return 1;
}

/* Cut x into a multiple of each spacing. */
static inline void ct_grid_cut(const ct_grid *grid, double x, double *coarse, double *fine)
{
  // q = G round(x / G), r = g round((x - q) / g) (eq:order-free-sum)
  const double q = (x + grid->coarse) - grid->coarse;
  *coarse = q;
  *fine = ((x - q) + grid->fine) - grid->fine;
}

/* Add x to the two sums. */
static inline void ct_grid_add(const ct_grid *grid, double x, double *sum_coarse, double *sum_fine)
{
  double coarse, fine;
  ct_grid_cut(grid, x, &coarse, &fine);
  *sum_coarse += coarse;
  *sum_fine += fine;
}

#endif
