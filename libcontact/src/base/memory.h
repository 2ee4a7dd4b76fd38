#ifndef CT_SRC_MEMORY_H
#define CT_SRC_MEMORY_H

#include <stddef.h>

/* Zeroed memory for `count` items of `size` bytes, aligned to 64 bytes (a cache line, a batch of
 * lanes); null when there is none or the product overflows. At least one item is allocated. Free
 * with ct_release. */
void *ct_allocate(size_t count, size_t size);

/* A copy of `bytes` bytes, to be given back likewise; null when there is no memory. */
void *ct_duplicate(const void *from, size_t bytes);

void ct_release(void *memory);

#endif
