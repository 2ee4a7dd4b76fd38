/* Quiet regions of bodies that are no lattice: batches whose nodes have moved alike have no force
 * and are not computed. */
#include "quiet.h"

#include "../base/bits.h"
#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

ct_status ct_quiet_create(const ct_solid_part *parts, int32_t part_count, int64_t batch_count,
                          int32_t node_count, ct_quiet *quiet)
{
  size_t words = (size_t)ct_bits_words(node_count),
         batches = (size_t)batch_count + 9; // rows mark nine at once
  quiet->part_count = part_count;
  quiet->rows = ct_allocate((size_t)part_count, sizeof *quiet->rows);
  quiet->batch = ct_allocate(batches, sizeof *quiet->batch);
  quiet->woken = ct_allocate(batches, sizeof *quiet->woken);
  quiet->read = ct_allocate(batches, sizeof *quiet->read);
  quiet->changed = ct_allocate(words, sizeof *quiet->changed);
  quiet->adrift = ct_allocate(words, sizeof *quiet->adrift);
  quiet->seen = ct_allocate(words + (size_t)part_count, sizeof *quiet->seen);
  quiet->kept = ct_allocate((size_t)part_count, sizeof *quiet->kept);
  if (!quiet->rows || !quiet->batch || !quiet->woken || !quiet->read || !quiet->changed ||
      !quiet->adrift || !quiet->seen || !quiet->kept)
    return CT_ERROR_MEMORY;
  for (int32_t i = 0; i < part_count; i++)
    if (parts[i].savings.quiet && parts[i].cells[0] > 0 &&
        ct_rows_create(&parts[i], &quiet->rows[i]) != CT_OK)
      return CT_ERROR_MEMORY;
  return CT_OK;
}

void ct_quiet_free(ct_quiet *quiet)
{
  void *blocks[] = {quiet->batch,  quiet->woken, quiet->read, quiet->changed,
                    quiet->adrift, quiet->seen,  quiet->kept, quiet->rows};
  for (int32_t i = 0; quiet->rows != NULL && i < quiet->part_count; i++)
    ct_rows_free(&quiet->rows[i]);
  for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++) ct_release(blocks[i]);
}

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
    if (range != NULL)
      range[count] = (ct_node_range){part->first_node + number[i], part->first_node + number[i]};
    count++;
  }
  return count;
}

ct_status ct_quiet_prepare(ct_solid_part *part)
{
  part->range_first = ct_allocate((size_t)part->batch_count + 1, sizeof *part->range_first);
  if (part->range_first == NULL) return CT_ERROR_MEMORY;
  for (int32_t b = 0; b < part->batch_count; b++)
    part->range_first[b + 1] = part->range_first[b] + batch_ranges(part, b, NULL);
  part->ranges = ct_allocate((size_t)part->range_first[part->batch_count], sizeof *part->ranges);
  if (part->ranges == NULL) return CT_ERROR_MEMORY;
  for (int32_t b = 0; b < part->batch_count; b++)
    batch_ranges(part, b, &part->ranges[part->range_first[b]]);
  return CT_OK;
}

/* Find for each batch of a part whether one of its nodes has the bit `value`. */
static void find_near(uint8_t *near, const ct_solid_part *part, const uint64_t *bits, int value)
{
  for (int32_t b = 0; b < part->batch_count; b++) {
    near[b] = 0;
    for (int32_t i = part->range_first[b]; !near[b] && i < part->range_first[b + 1]; i++) {
      const ct_node_range *range = &part->ranges[i];
      near[b] = ct_bits_next(bits, range->first, range->last + 1, value) <= range->last;
    }
  }
}

void ct_quiet_wake(ct_quiet *quiet, const ct_solid_part *part, int32_t number,
                   const uint64_t *drifted)
{
  int32_t word = part->first_node / 64;
  uint64_t *seen = &quiet->seen[word + number];
  size_t size =
      (size_t)((part->first_node + part->mesh->node_count - 1) / 64 - word + 1) * sizeof *seen;
  if (drifted == NULL) {
    memset(&quiet->woken[part->first_batch], 1, (size_t)part->batch_count);
    quiet->kept[number] &= (uint8_t)~CT_KEPT_WOKEN;
    return;
  }
  // While a wave passes through a batch nothing new wakes.
  if (quiet->kept[number] & CT_KEPT_WOKEN && memcmp(seen, &drifted[word], size) == 0) return;
  memcpy(seen, &drifted[word], size);
  quiet->kept[number] |= CT_KEPT_WOKEN;
  find_near(&quiet->woken[part->first_batch], part, drifted, 0);
}

/* Whether two nodes have the same three numbers, to the last bit. */
static inline int same(const double *u, const double *v)
{
  uint64_t a[3], b[3];
  memcpy(a, u, sizeof a);
  memcpy(b, v, sizeof b);
  return ((a[0] ^ b[0]) | (a[1] ^ b[1]) | (a[2] ^ b[2])) == 0;
}

/* Whether all nodes of some ranges have the same three numbers, to the last bit, and finite ones.
 */
static int alike(const ct_node_range *range, int32_t count, const double *values)
{
  const double *u = &values[3 * (int64_t)range->first];
  for (const ct_node_range *r = range; r < range + count; r++) {
    const double *v = &values[3 * (int64_t)r->first];
    // A range is compared with itself, shifted by a node.
    if (!same(v, u) || memcmp(v, v + 3, 3 * (size_t)(r->last - r->first) * sizeof *u) != 0)
      return 0;
  }
  return isfinite(u[0]) && isfinite(u[1]) && isfinite(u[2]);
}

/* Look at one batch; answers what it is. */
static uint8_t look(const ct_quiet *quiet, const ct_solid_part *part, int32_t b,
                    const double *displacement, const double *velocity)
{
  uint8_t was = quiet->batch[part->first_batch + b];
  int woken = quiet->woken[part->first_batch + b];
  if (was == CT_BATCH_ASLEEP && !woken) return was;
  if (was == CT_BATCH_MOVING && (b + quiet->call) % 8 != 0) return was;
  const ct_node_range *range = &part->ranges[part->range_first[b]];
  int32_t count = part->range_first[b + 1] - part->range_first[b];
  if (!alike(range, count, displacement)) return CT_BATCH_MOVING;
  if (was < CT_BATCH_FRESH) return CT_BATCH_FRESH;
  // One that is woken has to be looked at in the next call anyway.
  return velocity != NULL && !woken && alike(range, count, velocity) ? CT_BATCH_ASLEEP
                                                                     : CT_BATCH_QUIET;
}

/* Whether eight bytes are all the same one. */
static inline int all_are(const uint8_t *eight, uint8_t value)
{
  uint64_t bytes;
  memcpy(&bytes, eight, sizeof bytes);
  return bytes == value * (UINT64_MAX / 255);
}

int ct_quiet_look(ct_quiet *quiet, const ct_solid_part *part, int32_t first, int32_t last,
                  const double *displacement, const double *velocity)
{
  int crossed = 0;
  for (int32_t b = first, end; b < last; b = end) {
    uint8_t *found = &quiet->batch[part->first_batch + b];
    int32_t from = b;
    end = b + 8 < last ? b + 8 : last;
    // Most of them are asleep, or move and are looked at one out of eight.
    if (end - b == 8 && all_are(found, CT_BATCH_ASLEEP) &&
        all_are(&quiet->woken[part->first_batch + b], 0))
      continue;
    if (end - b == 8 && all_are(found, CT_BATCH_MOVING)) {
      from = b + (8 - (b + quiet->call) % 8) % 8;
      end = from + 1;
    }
    for (int32_t i = from; i < end; i++) {
      uint8_t now = look(quiet, part, i, displacement, velocity);
      crossed |= (now < CT_BATCH_QUIET) != (found[i - b] < CT_BATCH_QUIET);
      found[i - b] = now;
    }
    end = b + 8 < last ? b + 8 : last;
  }
  return crossed;
}

void ct_quiet_confirm(ct_quiet *quiet, const ct_solid_part *part, int32_t first, int32_t last,
                      double *values)
{
  int per = ct_brick_node_count(part->mesh->kind);
  for (int32_t b = first; b < last; b++) {
    uint8_t *found = &quiet->batch[part->first_batch + b];
    if (*found != CT_BATCH_FRESH) continue;
    int64_t stride;
    const double *v = ct_batch_values(part, values, b, &stride);
    for (int i = 0; *found == CT_BATCH_FRESH && i < 3 * per * 8; i++)
      if (v[i / 8 * stride + i % 8] != 0.0) *found = CT_BATCH_MOVING;
  }
}

/* Mark the nodes of the batches that are not quiet. */
static void mark_nodes(ct_quiet *quiet, const ct_solid_part *part)
{
  const uint8_t *found = &quiet->batch[part->first_batch];
  for (int32_t b = 0; b < part->batch_count; b++)
    for (int32_t i = part->range_first[b];
         found[b] < CT_BATCH_QUIET && i < part->range_first[b + 1]; i++)
      ct_bits_put(quiet->changed, part->ranges[i].first, part->ranges[i].last + 1, 1);
}

void ct_quiet_mark(ct_quiet *quiet, const ct_solid_part *part)
{
  ct_bits_put(quiet->changed, part->first_node, part->first_node + part->mesh->node_count, 0);
  mark_nodes(quiet, part);
  // Of the batches that are skipped, those matter whose nodes are summed.
  find_near(&quiet->read[part->first_batch], part, quiet->changed, 1);
}
