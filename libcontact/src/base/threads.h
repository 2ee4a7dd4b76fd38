#ifndef CT_SRC_THREADS_H
#define CT_SRC_THREADS_H

#include <libcontact/base.h>

#include <stddef.h>
#include <stdint.h>

/* Number of threads of a run's settings; without them one. */
static inline int ct_threads_of(const ct_run_settings *settings)
{
  return settings == NULL || settings->threads < 1 ? 1 : settings->threads;
}

/* Number of threads of a parallel loop over `count` pieces for which `wanted` were requested: with
 * at least `least` pieces per thread, because threads must be started and joined; and one in a
 * child of fork whose parent had several, because OpenMP's threads do not exist after a fork, and
 * libgomp would wait for them forever. The library for the sanitizers is compiled with
 * CT_SHORT_LOOPS, and uses threads in each loop. */
int ct_threads_for(int wanted, int64_t count, int64_t least);

/* Begin of part i of `shares` parts of a loop. */
static inline int32_t ct_share(int32_t count, int i, int shares)
{
  return (int32_t)((int64_t)count * i / shares);
}

#endif
