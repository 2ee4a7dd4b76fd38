#include "memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { ALIGNMENT = 64 };

void *ct_allocate(size_t count, size_t size)
{
  if (count == 0) count = 1;
  if (size != 0 && count > (SIZE_MAX - ALIGNMENT - sizeof(void *)) / size) return NULL;
  char *raw = calloc(count * size + ALIGNMENT + sizeof(void *), 1);
  if (raw == NULL) return NULL;
  // The address that calloc gave stands just before the aligned block.
  uintptr_t start = (uintptr_t)raw + sizeof(void *);
  size_t shift = (ALIGNMENT - start % ALIGNMENT) % ALIGNMENT;
  void **block = (void **)(void *)(raw + sizeof(void *) + shift);
  block[-1] = raw;
  return block;
}

void ct_release(void *memory)
{
  if (memory != NULL) free(((void **)memory)[-1]);
}

void *ct_duplicate(const void *from, size_t bytes)
{
  void *copy = ct_allocate(bytes, 1);
  if (copy != NULL && bytes > 0) memcpy(copy, from, bytes);
  return copy;
}
