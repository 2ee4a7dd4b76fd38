#ifndef CT_SRC_LANES_H
#define CT_SRC_LANES_H

/* Any header of libc: it defines __GLIBC__, without which the kernels would be compiled for the
 * oldest machine only, without a warning. */
#include <stdint.h>

/* Eight numbers that are computed side by side, one per element of a batch. Arithmetic on a
 * ct_lanes is arithmetic on each lane, rounded like one double, so all instruction sets give the
 * same bits. gcc and clang have the type; with other compilers the loops run one lane at a time. */
#if defined(__GNUC__)
typedef double ct_lanes __attribute__((vector_size(64), may_alias));
typedef double ct_loose __attribute__((vector_size(64), aligned(8), may_alias)); /* unaligned */
#define CT_LANES_WIDE 1
#else
typedef double ct_lanes, ct_loose;
#define CT_LANES_WIDE 0
#endif

/* Lanes selected from two vectors, and whether the compiler can do it: 1 or 0. */
#define CT_PICK __builtin_shufflevector
#if CT_LANES_WIDE && defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define CT_ROWS 1
#endif
#endif
#ifndef CT_ROWS
#define CT_ROWS 0
#endif

enum { CT_BATCH = 8, CT_LANES_COUNT = CT_LANES_WIDE ? 8 : 1 };

/* Four numbers side by side, unaligned: one vector, or CT_QUAD_PARTS of them; and their bits. */
#if defined(__GNUC__)
typedef double ct_quad __attribute__((vector_size(32), aligned(8), may_alias));
typedef int64_t ct_quad_bits __attribute__((vector_size(32), aligned(8), may_alias));
enum { CT_QUAD_PARTS = 1 };
#else
typedef double ct_quad;
typedef int64_t ct_quad_bits;
enum { CT_QUAD_PARTS = 4 };
#endif

/* A part of a kernel: compiled for the instruction set of the kernel that calls it. */
#if defined(__GNUC__)
#define CT_INLINE static inline __attribute__((always_inline))
#else
#define CT_INLINE static inline
#endif

/* Add two numbers to two others, side by side. */
CT_INLINE void ct_add_pair(const double from[2], double to[2])
{
#if defined(__GNUC__)
  typedef double pair __attribute__((vector_size(16), aligned(8), may_alias));
  *(pair *)to += *(const pair *)from;
#else
  for (int i = 0; i < 2; i++) to[i] += from[i];
#endif
}

/* The larger of two numbers without a call, as fmax would be in a loop over lanes; b if a is NaN.
 */
CT_INLINE double ct_larger(double a, double b) { return a > b ? a : b; }

/* The same number in all lanes. */
CT_INLINE void ct_lanes_fill(double number, ct_lanes *v)
{
  for (int l = 0; l < CT_LANES_COUNT; l++) ((double *)v)[l] = number;
}

/* Sum over the `count` nodes of a face, at most 8, paired so that a flipped face gives the same
 * bits (eq:tree-sum). */
CT_INLINE void ct_sum_face(int32_t count, ct_quad t[8], ct_quad *out)
{
  const ct_quad none = {0.0};
  for (int32_t a = count; a < 8; a++) t[a] = none;
  *out = (t[0] + t[1]) + (t[2] + t[3]);
  if (count > 4) *out += (t[4] + t[6]) + (t[5] + t[7]);
}

/* Four rows of four numbers become columns, or the reverse. */
CT_INLINE void ct_turn(const double *const from[4], double *const to[4])
{
#if CT_ROWS
  const ct_quad *a = (const ct_quad *)from[0], *b = (const ct_quad *)from[1],
                *c = (const ct_quad *)from[2], *d = (const ct_quad *)from[3];
  const ct_quad low = CT_PICK(*a, *b, 0, 4, 2, 6), high = CT_PICK(*a, *b, 1, 5, 3, 7),
                low2 = CT_PICK(*c, *d, 0, 4, 2, 6), high2 = CT_PICK(*c, *d, 1, 5, 3, 7);
  *(ct_quad *)to[0] = CT_PICK(low, low2, 0, 1, 4, 5);
  *(ct_quad *)to[1] = CT_PICK(high, high2, 0, 1, 4, 5);
  *(ct_quad *)to[2] = CT_PICK(low, low2, 2, 3, 6, 7);
  *(ct_quad *)to[3] = CT_PICK(high, high2, 2, 3, 6, 7);
#else
  for (int i = 0; i < 4; i++)
    for (int k = 0; k < 4; k++) to[k][i] = from[i][k];
#endif
}

/* Compile a kernel for several instruction sets. The loader selects the best one for the machine;
 * on Windows each call does. gcc needs glibc for it. clang before 18 gives the kernel another name
 * than its callers use, and clang 22 fails where the C library is musl. Its loader on macOS is
 * untried. */
#if !defined(__x86_64__) || defined(CT_NO_CLONES)
#define CT_CLONES
#elif defined(__clang__) && __clang_major__ >= 18 && (defined(__GLIBC__) || defined(_WIN32))
#define CT_CLONES __attribute__((target_clones("default", "avx2", "avx512f")))
#elif defined(__GNUC__) && !defined(__clang__) && defined(__GLIBC__)
#define CT_CLONES __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define CT_CLONES
#endif

/* Kernels that have one version in wheels, which have to be small: one that runs for output, or
 * once an element, compiled for size; and one that runs once a step for nodes. */
#if defined(CT_OWN_RUNTIME)
#define CT_CLONES_RARE __attribute__((minsize))
#define CT_CLONES_NODES
#else
#define CT_CLONES_RARE CT_CLONES
#define CT_CLONES_NODES CT_CLONES
#endif

/* A loop whose choices run in lanes: the compiler may compute both sides of each. No result depends
 * on it; all kernels compiled so would be slower (gcc 12). */
#if defined(__GNUC__) && !defined(__clang__)
#define CT_CHOICES __attribute__((optimize("no-trapping-math")))
#else
#define CT_CHOICES
#endif

/* The numbers of 4 consecutive nodes, each three times, for their degrees of freedom; only if
 * CT_ROWS. */
CT_INLINE void ct_thrice(const double *p, ct_quad t[3])
{
#if CT_ROWS
  ct_quad m = *(const ct_quad *)(const void *)p;
  t[0] = CT_PICK(m, m, 0, 0, 0, 1);
  t[1] = CT_PICK(m, m, 1, 1, 2, 2);
  t[2] = CT_PICK(m, m, 2, 3, 3, 3);
#else
  (void)p, (void)t;
#endif
}

/* Load x, y, z of 8 consecutive nodes, to v[0], v[step], v[2 step]; only if CT_ROWS. */
CT_INLINE void ct_load_row(const double *p, ct_lanes *v, int step)
{
#if CT_ROWS
  const ct_loose *at = (const ct_loose *)(const void *)p;
  ct_lanes a = at[0], b = at[1], c = at[2];
  ct_lanes x = CT_PICK(a, b, 0, 3, 6, 9, 12, 15, 0, 0), y = CT_PICK(a, b, 1, 4, 7, 10, 13, 0, 0, 0),
           z = CT_PICK(a, b, 2, 5, 8, 11, 14, 0, 0, 0);
  v[0] = CT_PICK(x, c, 0, 1, 2, 3, 4, 5, 10, 13);
  v[step] = CT_PICK(y, c, 0, 1, 2, 3, 4, 8, 11, 14);
  v[2 * step] = CT_PICK(z, c, 0, 1, 2, 3, 4, 9, 12, 15);
#else
  (void)p, (void)v, (void)step;
#endif
}

/* Store them: the reverse. */
CT_INLINE void ct_store_row(const ct_lanes v[3], double *p)
{
#if CT_ROWS
  ct_loose *at = (ct_loose *)(void *)p;
  ct_lanes a = CT_PICK(v[0], v[1], 0, 8, 0, 1, 9, 0, 2, 10),
           b = CT_PICK(v[0], v[1], 0, 3, 11, 0, 4, 12, 0, 5),
           c = CT_PICK(v[0], v[1], 13, 0, 6, 14, 0, 7, 15, 0);
  at[0] = CT_PICK(a, v[2], 0, 1, 8, 3, 4, 9, 6, 7);
  at[1] = CT_PICK(b, v[2], 10, 1, 2, 11, 4, 5, 12, 7);
  at[2] = CT_PICK(c, v[2], 0, 13, 2, 3, 14, 5, 6, 15);
#else
  (void)v, (void)p;
#endif
}

#endif
