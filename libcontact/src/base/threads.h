#ifndef CT_SRC_THREADS_H
#define CT_SRC_THREADS_H

#include <stdint.h>

/* Number of threads of a parallel loop for which `wanted` were requested: the same number, but one
 * in a child of fork whose parent had several. OpenMP's threads do not exist after a fork, and
 * libgomp would wait for them forever. */
int ct_threads(int wanted);

/* The same for a loop over `count` pieces, with at least `least` of them per thread: a shorter loop
 * is faster with one thread, because threads must be started and joined. The library for the
 * sanitizers is compiled with CT_SHORT_LOOPS, and uses threads in each loop. */
int ct_threads_for(int wanted, int64_t count, int64_t least);

/* Begin of part i of `shares` parts of a loop. */
static inline int32_t ct_share(int32_t count, int i, int shares)
{
  return (int32_t)((int64_t)count * i / shares);
}

#endif
