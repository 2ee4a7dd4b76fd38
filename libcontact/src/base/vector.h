#ifndef CT_SRC_VECTOR_H
#define CT_SRC_VECTOR_H

#include <math.h>

/* Longer lengths are refused: a product of four of them would overflow. */
#define CT_LARGEST_LENGTH 1e70

/* Products of vectors with three components, always summed as (x + y) + z, so that a mirrored pair
 * gives mirrored bits. */
static inline double ct_vector_dot(const double a[3], const double b[3])
{
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

static inline void ct_vector_cross(const double a[3], const double b[3], double c[3])
{
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

/* Remove the component of v along the unit vector n. */
static inline void ct_vector_make_tangential(const double n[3], double v[3])
{
  const double along = ct_vector_dot(n, v);
  for (int k = 0; k < 3; k++) v[k] -= along * n[k];
}

/* The unit vector along a x b. Returns 0 if rounding determines its direction: a and b are parallel
 * to 1e-14, zero, or not finite. */
static inline int ct_vector_unit_normal(const double a[3], const double b[3], double n[3])
{
  double la = sqrt(ct_vector_dot(a, a)), lb = sqrt(ct_vector_dot(b, b)), u[3], v[3];
  if (!(la > 0 && lb > 0 && la < HUGE_VAL && lb < HUGE_VAL)) return 0;
  for (int k = 0; k < 3; k++) u[k] = a[k] / la, v[k] = b[k] / lb;
  ct_vector_cross(u, v, n);
  double length = sqrt(ct_vector_dot(n, n));
  if (!(length > 1e-14)) return 0;
  for (int k = 0; k < 3; k++) n[k] /= length;
  return 1;
}

#endif
