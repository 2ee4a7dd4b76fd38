#ifndef CT_SRC_THREADS_H
#define CT_SRC_THREADS_H

#include <stdint.h>

/* How many threads a parallel loop may have when `wanted` are asked for: as many, but one in a
 * child of fork whose parent had several. OpenMP's threads are not there after a fork, and libgomp
 * waits for them for ever. */
int ct_threads(int wanted);

/* The same for a loop over `count` pieces, with at least `least` of them for each thread: a loop
 * that is shorter ends later in threads than alone, as they must be woken and waited for. The
 * library for the sanitizers is compiled with CT_SHORT_LOOPS, and has threads in each loop. */
int ct_threads_for(int wanted, int64_t count, int64_t least);

/* Where share i of `shares` of a loop begins. */
static inline int32_t ct_share(int32_t count, int i, int shares)
{
  return (int32_t)((int64_t)count * i / shares);
}

#endif
