#include "incidence.h"

/* List the nodes and their places; `number` is 1 for each node of the list and 0 for others. */
static void fill(ct_incidence *incidence, int64_t entries, const int32_t *faces, int32_t node_count,
                 int32_t *number)
{
  int32_t *first = incidence->first;
  for (int32_t n = 0, next = 0; n < node_count; n++)
    if (number[n]) incidence->nodes[next] = n, number[n] = next++;
  // Count, sum up, and fill: first[i + 1] is where the next place of node i goes.
  for (int64_t i = 0; i < entries; i++) first[number[faces[i]] + 2]++;
  for (int32_t n = 0; n < incidence->count; n++) {
    incidence->most = first[n + 2] > incidence->most ? first[n + 2] : incidence->most;
    first[n + 2] += first[n + 1];
  }
  for (int64_t i = 0; i < entries; i++)
    incidence->place[first[number[faces[i]] + 1]++] = (int32_t)i;
}

ct_status ct_incidence_init(ct_incidence *incidence, int64_t entries, const int32_t *faces,
                            int32_t node_count, int32_t *own, ct_pool *pool)
{
  int32_t *number = ct_allocate((size_t)node_count, sizeof *number);
  if (number == NULL) return CT_ERROR_MEMORY;
  for (int64_t i = 0; i < entries; i++) number[faces[i]] = 1;
  for (int32_t n = 0; n < node_count; n++) incidence->count += number[n];
  incidence->nodes = ct_pool_take(pool, (size_t)incidence->count, sizeof *incidence->nodes);
  incidence->first = ct_pool_take(pool, (size_t)incidence->count + 2, sizeof *incidence->first);
  incidence->place = ct_pool_take(pool, (size_t)entries, sizeof *incidence->place);
  if (!pool->failed) fill(incidence, entries, faces, node_count, number);
  for (int64_t i = 0; !pool->failed && own != NULL && i < entries; i++) own[i] = number[faces[i]];
  ct_release(number);
  return pool->failed ? CT_ERROR_MEMORY : CT_OK;
}
