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

/* 64 bits from bit n on, of a table of `words` words; zeros follow. */
static inline uint64_t bits_from(const uint64_t *bits, int64_t words, int64_t n)
{
  int64_t word = n / 64;
  int shift = (int)(n % 64);
  uint64_t low = word < words ? bits[word] >> shift : 0;
  return shift == 0 || word + 1 >= words ? low : low | bits[word + 1] << (64 - shift);
}

/* Find for each batch of a lattice, where rows of elements lie between four rows of nodes, whether one of its nodes has a bit, after a flip of all: all batches of a
 * row at once. */
static void lattice_near(uint8_t *near, const ct_solid_part *part, const uint64_t *bits, int64_t words, uint64_t flip)
{
  enum { AT_ONCE = 56 };
  int32_t nx = part->cells[0], row = nx + 1, layer = row * (part->cells[1] + 1);
  memset(near, 0, (size_t)part->batch_count);
  for (int32_t r = 0; r < part->cells[1] * part->cells[2]; r++) {
    int64_t first = part->first_node + row * (int64_t)(r % part->cells[1]) + layer * (int64_t)(r / part->cells[1]);
    for (int32_t i = 0; i < nx; i += AT_ONCE) {
      int32_t count = nx - i < AT_ONCE ? nx - i : AT_ONCE, e = nx * r + i;
      uint64_t found = 0;
      for (int k = 0; k < 4; k++) found |= bits_from(bits, words, first + i + (k & 1) * row + (k >> 1) * layer) ^ flip;
      // Bit i of an element is that of the nodes before or after it.
      found = ((found | found >> 1) & ct_bits_span(0, count)) << (e % 8);
      for (uint8_t *batch = &near[e / 8]; found != 0; batch++, found >>= 8) *batch |= (found & 0xff) != 0;
    }
  }
}

/* Find for each batch of a part whether one of its nodes has the bit `value`. */
static void find_near(uint8_t *near, const ct_solid_part *part, const uint64_t *bits, int32_t node_count, int value)
{
  if (part->cells[0] > 0) {
    lattice_near(near, part, bits, ct_bits_words(node_count), value ? 0 : ~(uint64_t)0);
    return;
  }
  for (int32_t b = 0; b < part->batch_count; b++) {
    near[b] = 0;
    for (int32_t i = part->range_first[b]; !near[b] && i < part->range_first[b + 1]; i++) {
      const ct_node_range *range = &part->ranges[i];
      near[b] = ct_bits_next(bits, range->first, range->last + 1, value) <= range->last;
    }
  }
}

void ct_quiet_wake(ct_quiet *quiet, const ct_solid_part *part, int32_t number, const uint64_t *drifted, int32_t node_count)
{
  int32_t word = part->first_node / 64;
  uint64_t *seen = &quiet->seen[word + number];
  size_t size = (size_t)((part->first_node + part->mesh->node_count - 1) / 64 - word + 1) * sizeof *seen;
  if (drifted == NULL) {
    memset(&quiet->woken[part->first_batch], 1, (size_t)part->batch_count);
    quiet->kept[number] &= (uint8_t)~CT_KEPT_WOKEN;
    return;
  }
  // While a wave passes through a batch nothing new wakes.
  if (quiet->kept[number] & CT_KEPT_WOKEN && memcmp(seen, &drifted[word], size) == 0) return;
  memcpy(seen, &drifted[word], size);
  quiet->kept[number] |= CT_KEPT_WOKEN;
  find_near(&quiet->woken[part->first_batch], part, drifted, node_count, 0);
}

/* Whether two nodes have the same three numbers, to the last bit. */
static inline int same(const double *u, const double *v)
{
  uint64_t a[3], b[3];
  memcpy(a, u, sizeof a);
  memcpy(b, v, sizeof b);
  return ((a[0] ^ b[0]) | (a[1] ^ b[1]) | (a[2] ^ b[2])) == 0;
}

/* Whether all nodes of some ranges have the same three numbers, to the last bit, and finite ones. */
static int alike(const ct_node_range *range, int32_t count, const double *values)
{
  const double *u = &values[3 * (int64_t)range->first];
  for (const ct_node_range *r = range; r < range + count; r++) {
    const double *v = &values[3 * (int64_t)r->first];
    // A range is compared with itself, shifted by a node.
    if (!same(v, u) || memcmp(v, v + 3, 3 * (size_t)(r->last - r->first) * sizeof *u) != 0) return 0;
  }
  return isfinite(u[0]) && isfinite(u[1]) && isfinite(u[2]);
}

/* Look at one batch; answers what it is. */
static uint8_t look(const ct_quiet *quiet, const ct_solid_part *part, int32_t b, const double *displacement, const double *velocity)
{
  uint8_t was = quiet->batch[part->first_batch + b];
  int woken = quiet->woken[part->first_batch + b];
  if (was == CT_BATCH_ASLEEP && !woken) return was;
  if (was == CT_BATCH_MOVING && (b + quiet->call) % 8 != 0) return was;
  ct_node_range room[CT_MOST_RANGES];
  int32_t count;
  const ct_node_range *range = ranges_of(part, b, room, &count);
  if (!alike(range, count, displacement)) return CT_BATCH_MOVING;
  if (was < CT_BATCH_FRESH) return CT_BATCH_FRESH;
  // One that is woken has to be looked at in the next call anyway.
  return velocity != NULL && !woken && alike(range, count, velocity) ? CT_BATCH_ASLEEP : CT_BATCH_QUIET;
}

/* Whether eight bytes are all the same one. */
static inline int all_are(const uint8_t *eight, uint8_t value)
{
  uint64_t bytes;
  memcpy(&bytes, eight, sizeof bytes);
  return bytes == value * (UINT64_MAX / 255);
}

int ct_quiet_look(ct_quiet *quiet, const ct_solid_part *part, int32_t first, int32_t last, const double *displacement, const double *velocity)
{
  int crossed = 0;
  for (int32_t b = first, end; b < last; b = end) {
    uint8_t *found = &quiet->batch[part->first_batch + b];
    int32_t from = b;
    end = b + 8 < last ? b + 8 : last;
    // Most of them are asleep, or move and are looked at one out of eight.
    if (end - b == 8 && all_are(found, CT_BATCH_ASLEEP) && all_are(&quiet->woken[part->first_batch + b], 0)) continue;
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

void ct_quiet_confirm(ct_quiet *quiet, const ct_solid_part *part, int32_t first, int32_t last, double *values)
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

/* Mark the nodes of the elements first ... last - 1 of a lattice: four rows for each row of elements. */
static void lattice_mark(uint64_t *changed, const ct_solid_part *part, int32_t first, int32_t last)
{
  int32_t nx = part->cells[0], row = nx + 1, layer = row * (part->cells[1] + 1);
  for (int32_t e = first, end; e < last; e = end) {
    int32_t i = e % nx, r = e / nx, node = part->first_node + i + row * (r % part->cells[1]) + layer * (r / part->cells[1]);
    end = e + nx - i < last ? e + nx - i : last;
    for (int k = 0; k < 4; k++) {
      int32_t begin = node + (k & 1) * row + (k >> 1) * layer;
      ct_bits_put(changed, begin, begin + end - e + 1, 1);
    }
  }
}

/* Mark the nodes of the batches that are not quiet. */
static void mark_nodes(ct_quiet *quiet, const ct_solid_part *part)
{
  const uint8_t *found = &quiet->batch[part->first_batch];
  for (int32_t b = 0, end; b < part->batch_count; b = end) {
    end = b + 1;
    if (found[b] >= CT_BATCH_QUIET) continue;
    if (part->cells[0] > 0) {
      while (end < part->batch_count && found[end] < CT_BATCH_QUIET) end++;
      lattice_mark(quiet->changed, part, 8 * b, 8 * end < part->mesh->element_count ? 8 * end : part->mesh->element_count);
      continue;
    }
    for (int32_t i = part->range_first[b]; i < part->range_first[b + 1]; i++)
      ct_bits_put(quiet->changed, part->ranges[i].first, part->ranges[i].last + 1, 1);
  }
}

void ct_quiet_mark(ct_quiet *quiet, const ct_solid_part *part, int32_t node_count)
{
  ct_bits_put(quiet->changed, part->first_node, part->first_node + part->mesh->node_count, 0);
  mark_nodes(quiet, part);
  // Of the batches that are skipped, those matter whose nodes are summed.
  find_near(&quiet->read[part->first_batch], part, quiet->changed, node_count, 1);
}
