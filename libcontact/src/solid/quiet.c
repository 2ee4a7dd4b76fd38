/* Quiet regions: batches whose nodes have moved alike have no force and are not computed. */
#include "quiet.h"

#include "../bits.h"
#include "../memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int compare_numbers(const void *a, const void *b)
{
  int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
  return (x > y) - (x < y);
}

/* Ranges of consecutive numbers among the nodes of a batch; `range` null: only count them. */
static int32_t batch_ranges(const ct_solid_part *part, int32_t b, ct_node_range *range)
{
  int32_t number[8 * 20], size = 8 * ct_brick_node_count(part->mesh->kind), count = 0;
  memcpy(number, &part->batch_nodes[(int64_t)b * size], (size_t)size * sizeof *number);
  qsort(number, (size_t)size, sizeof *number, compare_numbers);
  for (int32_t i = 0; i < size; i++) {
    if (i > 0 && number[i] <= number[i - 1] + 1) {
      if (range != NULL) range[count - 1].last = part->first_node + number[i];
      continue;
    }
    if (range != NULL) range[count] = (ct_node_range){part->first_node + number[i], part->first_node + number[i]};
    count++;
  }
  return count;
}

ct_status ct_quiet_prepare(ct_solid_part *part)
{
  part->range_first = ct_allocate((size_t)part->batch_count + 1, sizeof *part->range_first);
  if (part->range_first == NULL) return CT_ERROR_MEMORY;
  for (int32_t b = 0; b < part->batch_count; b++) part->range_first[b + 1] = part->range_first[b] + batch_ranges(part, b, NULL);
  part->ranges = ct_allocate((size_t)part->range_first[part->batch_count], sizeof *part->ranges);
  if (part->ranges == NULL) return CT_ERROR_MEMORY;
  for (int32_t b = 0; b < part->batch_count; b++) batch_ranges(part, b, &part->ranges[part->range_first[b]]);
  return CT_OK;
}

/* Whether all nodes of a batch have the same displacement, to the last bit, and a finite one (eq:quiet-batch). */
static int moved_alike(const ct_solid_part *part, int32_t b, const double *displacement)
{
  const ct_node_range *range = &part->ranges[part->range_first[b]], *end = &part->ranges[part->range_first[b + 1]];
  const double *u = &displacement[3 * (int64_t)range->first];
  for (const ct_node_range *r = range; r < end; r++)
    // A range is compared with itself, shifted by a node.
    if (memcmp(&displacement[3 * (int64_t)r->first], u, 3 * sizeof *u) != 0 ||
        memcmp(&displacement[3 * (int64_t)r->first], &displacement[3 * (int64_t)r->first + 3], 3 * (size_t)(r->last - r->first) * sizeof *u) != 0)
      return 0;
  return isfinite(u[0]) && isfinite(u[1]) && isfinite(u[2]);
}

int ct_quiet_skip(ct_quiet *quiet, const ct_solid_part *part, int32_t b, const double *displacement)
{
  uint8_t *found = &quiet->batch[part->first_batch + b];
  int alike = moved_alike(part, b, displacement), skip = alike && *found != CT_BATCH_MOVING;
  *found = (uint8_t)(skip ? CT_BATCH_QUIET : alike ? CT_BATCH_FRESH : CT_BATCH_MOVING);
  return skip;
}

void ct_quiet_confirm(ct_quiet *quiet, const ct_solid_part *part, int32_t first, int32_t last, const double *values)
{
  int64_t size = 24 * (int64_t)ct_brick_node_count(part->mesh->kind);
  for (int32_t b = first; b < last; b++) {
    uint8_t *found = &quiet->batch[part->first_batch + b];
    for (int64_t i = b * size; *found == CT_BATCH_FRESH && i < (b + 1) * size; i++)
      if (values[i] != 0.0) *found = CT_BATCH_MOVING;
  }
}

void ct_quiet_mark(ct_quiet *quiet, const ct_solid_part *part, int32_t first, int32_t last)
{
  for (int32_t b = first; b < last; b++) {
    if (quiet->batch[part->first_batch + b] == CT_BATCH_QUIET) continue;
    for (int32_t i = part->range_first[b]; i < part->range_first[b + 1]; i++)
      ct_bits_put(quiet->changed, part->ranges[i].first, part->ranges[i].last + 1, 1);
  }
}
