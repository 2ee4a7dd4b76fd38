/* Random numbers, the same in each run, and the largest of errors. */
#ifndef UNIFORM_H
#define UNIFORM_H

#include <math.h>

static unsigned long long random_seed = 88172645463325252ull;

/* Uniform on (-a, a). */
static inline double uniform(double a)
{
  random_seed ^= random_seed << 13, random_seed ^= random_seed >> 7,
      random_seed ^= random_seed << 17;
  return a * (2 * ((double)(random_seed >> 11) / 9007199254740992.0) - 1);
}

static inline double worst(double so_far, double error)
{
  return fabs(error) > so_far || isnan(error) ? fabs(error) : so_far;
}

#endif
