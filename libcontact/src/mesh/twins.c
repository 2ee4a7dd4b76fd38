/* Elements that are listed twice. */
#include "../base/error.h"
#include "../base/memory.h"
#include "mesh_internal.h"

#include <stdlib.h>
#include <string.h>

/* A hash of the corners of an element in any order. */
static uint64_t corner_hash(const int32_t *node)
{
  uint64_t sum = 0;
  for (int a = 0; a < 8; a++) {
    uint64_t h = ((uint64_t)node[a] + 1) * UINT64_C(0x9e3779b97f4a7c15);
    h = (h ^ (h >> 32)) * UINT64_C(0xd6e8feb86659fd93);
    sum += h ^ (h >> 32);
  }
  return sum;
}

static int compare_numbers(const void *a, const void *b)
{
  const int32_t *m = a, *n = b;
  return (*m > *n) - (*m < *n);
}

/* Whether two elements have the same corners in any order; `hash` is that of the first. */
static int same_corners(const int32_t *one, const int32_t *other, uint64_t hash)
{
  int32_t a[8], b[8];
  if (corner_hash(other) != hash) return 0;
  memcpy(a, one, sizeof a);
  memcpy(b, other, sizeof b);
  qsort(a, 8, sizeof *a, compare_numbers);
  qsort(b, 8, sizeof *b, compare_numbers);
  return memcmp(a, b, sizeof a) == 0;
}

ct_status ct_mesh_check_twins(const ct_mesh *mesh, ct_error *error)
{
  const size_t per = (size_t)ct_brick_node_count(mesh->kind), count = (size_t)mesh->element_count;
  size_t capacity = 1;
  while (capacity < count) capacity *= 2;
  // Number + 1 of the latest element of a hash, and of the one before it.
  int32_t *latest = ct_allocate(capacity, sizeof *latest), *next = ct_allocate(count, sizeof *next);
  ct_status status = latest == NULL || next == NULL ? CT_NO_MEMORY(error, "a mesh") : CT_OK;
  for (size_t e = 0; status == CT_OK && e < count; e++) {
    const int32_t *node = &mesh->elements[e * per];
    const uint64_t hash = corner_hash(node);
    int32_t *head = &latest[(hash >> 20) & (capacity - 1)], k = *head;
    while (k > 0 && !same_corners(node, &mesh->elements[(size_t)(k - 1) * per], hash))
      k = next[k - 1];
    if (k > 0)
      status = ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, (int64_t)e, -1},
                       "element %d has the corners of element %d; each element must be listed once",
                       (int)e, (int)k - 1);
    next[e] = *head;
    *head = (int32_t)e + 1;
  }
  ct_release(latest);
  ct_release(next);
  return status;
}
