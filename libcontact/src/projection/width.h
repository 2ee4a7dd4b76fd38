#ifndef CT_SRC_WIDTH_H
#define CT_SRC_WIDTH_H

/* A number for each of WIDTH lanes, and operations on it. A source that defines WIDTH and TARGET,
 * the instruction set, before it includes this header uses gcc vectors; any other has width 1,
 * where `real` is double. Each lane is rounded like a double, so all widths give the same bits. */
#include "../base/lanes.h"

#include <float.h>
#include <math.h>
#include <stdint.h>

#ifndef WIDTH
#define WIDTH 1
#endif

#if WIDTH == 1
typedef double real;
typedef int mask; /* 0 or 1 */

/* A part of a kernel that is inlined; a part that is called; and one that is compiled for each
 * instruction set. */
#define PART CT_INLINE
#define RARE static
#define CLONED static CT_CLONES

PART mask not(mask m) { return !m; }
PART int any(mask m) { return m; } /* one bit for each lane */
PART mask masked(mask m, int n) { return m ? n : 0; }
PART real pick(mask m, real a, real b) { return m ? a : b; }
PART real absolute(real a) { return fabs(a); }
PART real root(real a) { return sqrt(a); }
PART real every(double a) { return a; }
PART real load(const double *x) { return *x; }
PART void store(double *x, real a) { *x = a; }
PART double lane(real a, int l) { return (void)l, a; }
PART int whole(mask m, int l) { return (void)l, m; }
PART void set(mask *m, int l, int n) { (void)l, *m = n; }

#else
#include <immintrin.h>

typedef double real __attribute__((vector_size(8 * WIDTH), may_alias));
typedef double loose __attribute__((vector_size(8 * WIDTH), may_alias, aligned(8)));
typedef int64_t mask __attribute__((vector_size(8 * WIDTH), may_alias)); /* 0 or -1 */

/* gcc splits vectors that a function cannot use before it inlines it, so each part names the
 * instruction set itself. */
#define PART static inline __attribute__((always_inline, target(TARGET)))
#define RARE static __attribute__((noinline, target(TARGET)))
#define CLONED RARE

PART mask not(mask m) { return ~m; }
PART mask masked(mask m, int n) { return m & (int64_t)n; }
PART real absolute(real a) { return (real)((mask)a & INT64_MAX); }
PART real every(double a) { return (real){0} + a; }
PART real load(const double *x) { return *(const loose *)(const void *)x; }
PART void store(double *x, real a) { *(loose *)(void *)x = a; }
PART double lane(real a, int l) { return a[l]; }
PART int whole(mask m, int l) { return (int)m[l]; }
PART void set(mask *m, int l, int n) { (*m)[l] = n; }

#if WIDTH == 4
PART int any(mask m) { return _mm256_movemask_pd((__m256d)m); }
PART real pick(mask m, real a, real b) { return _mm256_blendv_pd(b, a, (__m256d)m); }
PART real root(real a) { return _mm256_sqrt_pd(a); }
#else
PART real pick(mask m, real a, real b) { return (real)((m & (mask)a) | (~m & (mask)b)); }
PART real root(real a) { return _mm512_sqrt_pd(a); }
PART int any(mask m) { return _mm512_test_epi64_mask((__m512i)m, (__m512i)m); }
#endif
#endif

/* fmin and fmax for numbers, without a call. */
PART real least(real a, real b) { return pick(b < a, b, a); }
PART real most(real a, real b) { return pick(b > a, b, a); }

/* Always summed as (x + y) + z, like ct_vector_dot. */
PART real dot(const real a[3], const real b[3])
{
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

#endif
