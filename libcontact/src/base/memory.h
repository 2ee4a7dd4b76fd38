#ifndef CT_SRC_MEMORY_H
#define CT_SRC_MEMORY_H

#include <stddef.h>
#include <string.h>

/* Zeroed memory for `count` items of `size` bytes, aligned to 64 bytes (a cache line, a batch of
 * lanes); null if out of memory or if the product overflows. At least one item is allocated. Free
 * with ct_release. */
void *ct_allocate(size_t count, size_t size);

/* A copy of `bytes` bytes, to be freed likewise; null if out of memory. */
void *ct_duplicate(const void *from, size_t bytes);

void ct_release(void *memory);

/* All memory of one object, which is freed together. A zeroed pool is empty. */
typedef struct ct_pool {
  void *last;
  int failed; /* an allocation failed */
} ct_pool;

/* As ct_allocate, from a pool. */
void *ct_pool_take(ct_pool *pool, size_t count, size_t size);

/* As ct_duplicate. */
void *ct_pool_copy(ct_pool *pool, const void *from, size_t bytes);

/* Free all blocks. */
void ct_pool_empty(ct_pool *pool);

/* The same, and the object that begins with the pool; null is allowed. */
void ct_pool_free(void *object);

/* Set numbers to zero, and copy bytes. Pieces of a kilobyte take few instructions each, where libc
 * would begin a string operation. */
enum { CT_KILOBYTE = 1024 };
static inline void ct_clear(double *values, size_t count)
{
  enum { PIECE = CT_KILOBYTE / sizeof(double) };
  for (size_t i = 0; i < count; i += PIECE)
    memset(&values[i], 0, (count - i < PIECE ? count - i : PIECE) * sizeof *values);
}

static inline void ct_copy(void *to, const void *from, size_t bytes)
{
  for (size_t i = 0; i < bytes; i += CT_KILOBYTE)
    memcpy((char *)to + i, (const char *)from + i,
           bytes - i < CT_KILOBYTE ? bytes - i : CT_KILOBYTE);
}

#endif
