#ifndef CT_SRC_THREADS_H
#define CT_SRC_THREADS_H

/* How many threads a parallel loop may have when `wanted` are asked for: as many, but one in a
 * child of fork whose parent had several. OpenMP's threads are not there after a fork, and libgomp
 * waits for them for ever. */
int ct_threads(int wanted);

#endif
