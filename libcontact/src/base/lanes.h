#ifndef CT_SRC_LANES_H
#define CT_SRC_LANES_H

/* Any header of libc: it defines __GLIBC__, without which the kernels would silently be compiled
 * for the oldest machine alone. */
#include <stdint.h>

/* Eight numbers that are computed side by side, one for each element of a batch. Arithmetic on a
 * ct_lanes is arithmetic on each lane, rounded as one double is; so every instruction set gives the
 * same bits. gcc and clang know the type; other compilers get one lane at a time. */
#if defined(__GNUC__)
typedef double ct_lanes __attribute__((vector_size(64), may_alias));
typedef double ct_loose __attribute__((vector_size(64), aligned(8), may_alias));
#define CT_LANES_WIDE 1
#else
typedef double ct_lanes;
#define CT_LANES_WIDE 0
#endif

/* Whether the compiler can pick lanes out of two vectors: 1 or 0. */
#if defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define CT_ROWS 1
#endif
#endif
#ifndef CT_ROWS
#define CT_ROWS 0
#endif

enum { CT_BATCH = 8, CT_LANES_COUNT = CT_LANES_WIDE ? 8 : 1 };

/* Four numbers side by side, anywhere in memory: one vector, or CT_QUAD_PARTS of them. */
#if defined(__GNUC__)
typedef double ct_quad __attribute__((vector_size(32), aligned(8), may_alias));
enum { CT_QUAD_PARTS = 1 };
#else
typedef double ct_quad;
enum { CT_QUAD_PARTS = 4 };
#endif

/* A part of a kernel: compiled for the instruction set of the kernel that calls it. */
#if defined(__GNUC__)
#define CT_INLINE static inline __attribute__((always_inline))
#else
#define CT_INLINE static inline
#endif

/* Compile a kernel for several instruction sets; the loader picks the best that the machine has. */
#if defined(__GNUC__) && !defined(__clang__) && defined(__GLIBC__) && defined(__x86_64__) && \
    !defined(CT_NO_CLONES)
#define CT_CLONES __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define CT_CLONES
#endif

#endif
