#include "memory.h"
#include "error.h"

#include <libcontact/base.h>

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { ALIGNMENT = 64, HEADER = 2 * sizeof(void *) };

/* The host's functions, or null for those of the C library: one of the two variables of the whole
 * process. A host writes it before it creates any object. */
static ct_allocator host;

ct_status ct_set_allocator(const ct_allocator *allocator, ct_error *error)
{
  static const ct_allocator none;
  if (allocator != NULL && (allocator->allocate == NULL || allocator->release == NULL))
    return CT_REFUSE(error, "allocator: allocate and release must be given together");
  host = allocator == NULL ? none : *allocator;
  return CT_OK;
}

/* Zeroed bytes. The C library need not write the zeros of new memory. */
static void *zeroed(size_t bytes)
{
  if (host.allocate == NULL) return calloc(bytes, 1);
  void *raw = host.allocate(bytes, host.context);
  return raw == NULL || host.zeroes ? raw : memset(raw, 0, bytes);
}

void *ct_allocate(size_t count, size_t size)
{
  if (count == 0) count = 1;
  if (size != 0 && count > (SIZE_MAX - ALIGNMENT - HEADER) / size) return NULL;
  char *raw = zeroed(count * size + ALIGNMENT + HEADER);
  if (raw == NULL) return NULL;
  // The allocated address is stored just before the aligned block, and before it the preceding
  // block of a pool.
  uintptr_t start = (uintptr_t)raw + HEADER;
  size_t shift = (ALIGNMENT - start % ALIGNMENT) % ALIGNMENT;
  void **block = (void **)(void *)(raw + HEADER + shift);
  block[-1] = raw;
  return block;
}

void ct_release(void *memory)
{
  if (memory == NULL) return;
  void *raw = ((void **)memory)[-1];
  if (host.release == NULL) free(raw);
  else host.release(raw, host.context);
}

void *ct_duplicate(const void *from, size_t bytes)
{
  void *copy = ct_allocate(bytes, 1);
  if (copy != NULL && bytes > 0) memcpy(copy, from, bytes);
  return copy;
}

void *ct_pool_take(ct_pool *pool, size_t count, size_t size)
{
  void **block = ct_allocate(count, size);
  if (block == NULL) pool->failed = 1;
  else block[-2] = pool->last, pool->last = block;
  return block;
}

void *ct_pool_copy(ct_pool *pool, const void *from, size_t bytes)
{
  void *copy = ct_pool_take(pool, bytes, 1);
  return copy != NULL && bytes > 0 ? memcpy(copy, from, bytes) : copy;
}

void ct_pool_empty(ct_pool *pool)
{
  for (void **block = pool->last, *before; block != NULL; block = before) {
    before = block[-2];
    ct_release(block);
  }
  *pool = (ct_pool){NULL, 0};
}

void ct_pool_free(void *object)
{
  if (object == NULL) return;
  ct_pool_empty(object);
  ct_release(object);
}
