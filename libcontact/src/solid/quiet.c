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

/* The same of a body in the order of a lattice, without a table: four rows for each row of elements. Rows may be there twice. */
static int32_t lattice_ranges(const ct_solid_part *part, int32_t b, ct_node_range *range)
{
  int32_t row = part->cells[0] + 1, layer = row * (part->cells[1] + 1), count = 0;
  int32_t last = 8 * b + 8 < part->mesh->element_count ? 8 * b + 8 : part->mesh->element_count;
  for (int32_t e = 8 * b, end; e < last; e = end) {
    int32_t i = e % part->cells[0], j = e / part->cells[0] % part->cells[1], k = e / part->cells[0] / part->cells[1];
    int32_t first = part->first_node + i + row * j + layer * k;
    end = e + part->cells[0] - i < last ? e + part->cells[0] - i : last;
    for (int r = 0; r < 4; r++) {
      int32_t begin = first + (r & 1) * row + (r >> 1) * layer;
      range[count++] = (ct_node_range){begin, begin + end - e};
    }
  }
  return count;
}

/* The ranges of a batch, from the part's table or made in `room`. */
static const ct_node_range *ranges_of(const ct_solid_part *part, int32_t b, ct_node_range room[CT_MOST_RANGES], int32_t *count)
{
  if (part->cells[0] > 0) {
    *count = lattice_ranges(part, b, room);
    return room;
  }
  *count = part->range_first[b + 1] - part->range_first[b];
  return &part->ranges[part->range_first[b]];
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
  ct_node_range room[CT_MOST_RANGES];
  int32_t count;
  const ct_node_range *range = ranges_of(part, b, room, &count);
  const double *u = &displacement[3 * (int64_t)range->first];
  for (const ct_node_range *r = range; r < range + count; r++)
    // A range is compared with itself, shifted by a node.
    if (memcmp(&displacement[3 * (int64_t)r->first], u, 3 * sizeof *u) != 0 ||
        memcmp(&displacement[3 * (int64_t)r->first], &displacement[3 * (int64_t)r->first + 3], 3 * (size_t)(r->last - r->first) * sizeof *u) != 0)
      return 0;
  return isfinite(u[0]) && isfinite(u[1]) && isfinite(u[2]);
}

void ct_quiet_find(ct_quiet *quiet, const ct_solid_part *part, int32_t b, const double *displacement)
{
  uint8_t *found = &quiet->batch[part->first_batch + b];
  int alike = moved_alike(part, b, displacement);
  *found = (uint8_t)(!alike ? CT_BATCH_MOVING : *found == CT_BATCH_MOVING ? CT_BATCH_FRESH : CT_BATCH_QUIET);
}

void ct_quiet_confirm(ct_quiet *quiet, const ct_solid_part *part, int32_t first, int32_t last, double *values)
{
  int per = ct_brick_node_count(part->mesh->kind);
  for (int32_t b = first; b < last; b++) {
    uint8_t *found = &quiet->batch[part->first_batch + b];
    int64_t stride;
    const double *v = ct_batch_values(part, values, b, &stride);
    for (int i = 0; *found == CT_BATCH_FRESH && i < 3 * per * 8; i++)
      if (v[i / 8 * stride + i % 8] != 0.0) *found = CT_BATCH_MOVING;
  }
}

void ct_quiet_mark(ct_quiet *quiet, const ct_solid_part *part)
{
  for (int32_t b = 0; b < part->batch_count; b++) {
    ct_node_range room[CT_MOST_RANGES];
    int32_t count;
    if (quiet->batch[part->first_batch + b] == CT_BATCH_QUIET) continue;
    const ct_node_range *range = ranges_of(part, b, room, &count);
    for (int32_t i = 0; i < count; i++) ct_bits_put(quiet->changed, range[i].first, range[i].last + 1, 1);
  }
}
