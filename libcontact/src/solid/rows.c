/* Quiet regions of a lattice, whose elements and nodes are bits in rows. */
#include "rows.h"

#include "../base/bits.h"
#include "../base/memory.h"

#include <math.h>
#include <string.h>

ct_status ct_rows_create(const ct_solid_part *part, ct_rows *rows)
{
  rows->words = (int32_t)ct_bits_words(part->cells[0]);
  rows->count = part->cells[1] * part->cells[2];
  size_t size = (size_t)rows->words * (size_t)rows->count;
  rows->moving = ct_allocate(size, sizeof *rows->moving);
  rows->fresh = ct_allocate(size, sizeof *rows->fresh);
  rows->asleep = ct_allocate(size, sizeof *rows->asleep);
  rows->led = ct_allocate(size, sizeof *rows->led);
  rows->reached = ct_allocate(size, sizeof *rows->reached);
  rows->awake = ct_allocate(size, sizeof *rows->awake);
  int all =
      rows->moving && rows->fresh && rows->asleep && rows->led && rows->reached && rows->awake;
  return all ? CT_OK : CT_ERROR_MEMORY;
}

void ct_rows_free(ct_rows *rows)
{
  uint64_t *blocks[] = {rows->moving, rows->fresh,   rows->asleep,
                        rows->led,    rows->reached, rows->awake};
  for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++) ct_release(blocks[i]);
}

/* One look at a body: where its rows stand, and with what they are compared. */
typedef struct look {
  ct_rows *rows;
  const ct_solid_part *part;
  int32_t row, layer;      /* nodes from one row to the next, and from one layer to the next */
  int64_t bit_words;       /* of a table of nodes */
  const uint64_t *drifted; /* null: nobody knows */
  const double *displacement,
      *velocity;           /* of the problem; without a velocity (null) nothing falls asleep */
  uint64_t turn;           /* of the elements that move, those that are looked at in this call */
  const ct_leader *leader; /* null: none */
} look;

/* One word of a row. */
typedef struct word {
  int64_t own;   /* its number in the tables of elements */
  int32_t first; /* its first element in the body */
  int32_t count; /* its elements */
  uint64_t all;  /* their bits */
  int64_t node;  /* the first node of its first element, in the problem */
} word;

static word word_of(const look *l, int32_t r, int32_t w)
{
  const int32_t *cells = l->part->cells;
  int32_t left = cells[0] - 64 * w, count = left < 64 ? left : 64;
  return (word){.own = r * (int64_t)l->rows->words + w,
                .first = cells[0] * r + 64 * w,
                .count = count,
                .all = ct_bits_span(0, count),
                .node = l->part->first_node + l->row * (int64_t)(r % cells[1]) +
                        l->layer * (int64_t)(r / cells[1]) + 64 * w};
}

/* Nodes from the first one of a row of elements to the first of each of the four rows of nodes
 * around it. */
static inline int64_t to_row(const look *l, int k)
{
  return (k & 1) * l->row + (k >> 1) * l->layer;
}

/* The elements of a word with a node whose bit, after `flip`, is set: an element is between two
 * nodes of each of four rows. */
static uint64_t elements_near(const look *l, const uint64_t *nodes, uint64_t flip, const word *e)
{
  uint64_t found = 0, next = 0;
  for (int k = 0; k < 4; k++) {
    int64_t from = e->node + to_row(l, k), at = from / 64;
    int shift = (int)(from % 64);
    uint64_t low = nodes[at], high = at + 1 < l->bit_words ? nodes[at + 1] : 0;
    found |= (low >> shift | high << 1 << (63 - shift)) ^ flip;
    next |= (high >> shift) ^ flip;
  }
  return (found | found >> 1 | next << 63) & e->all;
}

/* Bits that are written one after another: those of the present word, and how many. */
typedef struct writer {
  uint64_t *to, hold;
  int fill;
} writer;

static inline void write_bits(writer *out, int count, uint64_t value)
{
  value &= ct_bits_span(0, count);
  out->hold |= value << out->fill;
  if (out->fill + count >= 64) {
    *out->to++ = out->hold;
    out->hold = value >> 1 >> (63 - out->fill);
    out->fill -= 64;
  }
  out->fill += count;
}

static writer begin_bits(uint64_t *bits, int32_t n)
{
  int fill = n % 64;
  return (writer){&bits[n / 64], fill == 0 ? 0 : bits[n / 64] & ct_bits_span(0, fill), fill};
}

static void end_bits(const writer *out)
{
  if (out->fill > 0) *out->to = (*out->to & ~ct_bits_span(0, out->fill)) | out->hold;
}

/* Rows first ... last; none when last < first. */
typedef struct span {
  int32_t first, last;
} span;

static span joined(span a, span b)
{
  if (a.last < a.first || b.last < b.first) return a.last < a.first ? b : a;
  return (span){a.first < b.first ? a.first : b.first, a.last > b.last ? a.last : b.last};
}

/* The same rows and so many before and after them, as far as there are any. */
static span widened(const look *l, span s, int32_t by)
{
  if (s.last < s.first) return s;
  return (span){s.first > by ? s.first - by : 0,
                s.last + by < l->rows->count ? s.last + by : l->rows->count - 1};
}

/* Write for the nodes of some rows, before a `flip` of their bits, whether one of their elements
 * has its bit set. */
static void spread_to_nodes(const look *l, span s, const uint64_t *elements, uint64_t flip,
                            uint64_t *nodes)
{
  const int32_t *cells = l->part->cells, words = l->rows->words;
  // Row (j, k) of elements lies between the lines (j, k) and (j + 1, k + 1) of nodes.
  int32_t k = s.first / cells[1], j = s.first % cells[1], lines = cells[1] + 1;
  int32_t line = j + lines * k, end = s.last % cells[1] + 1 + lines * (s.last / cells[1] + 1);
  writer out = begin_bits(nodes, l->part->first_node + l->row * line);
  for (; line <= end; line++) {
    const uint64_t *around[4];
    int rows = 0;
    for (int32_t z = k > 0 ? k - 1 : 0; z <= k && z < cells[2]; z++)
      for (int32_t y = j > 0 ? j - 1 : 0; y <= j && y < cells[1]; y++)
        around[rows++] = &elements[words * (int64_t)(y + cells[1] * z)];
    uint64_t before = 0;
    for (int32_t w = 0; 64 * w <= cells[0]; w++) {
      uint64_t found = 0;
      for (int a = 0; w < words && a < rows; a++) found |= around[a][w];
      write_bits(&out, l->row - 64 * w < 64 ? l->row - 64 * w : 64,
                 (found | found << 1 | before) ^ flip);
      before = found >> 63;
    }
    j = j < cells[1] ? j + 1 : 0;
    k += j == 0;
  }
  end_bits(&out);
}

/* Mark the batches of eight with one of some elements of a word, which begins with element e: eight
 * batches at once, and the one that the word ends in. */
static inline void mark_word(uint64_t elements, int32_t e, uint8_t *batch)
{
  const uint64_t low = 0x0101010101010101u;
  uint64_t here = elements << e % 8, rest = elements >> 1 >> (63 - e % 8), marks;
  here |= here >> 4;
  here |= here >> 2;
  here |= here >> 1;
  memcpy(&marks, &batch[e / 8], sizeof marks);
  marks |= here & low;
  memcpy(&batch[e / 8], &marks, sizeof marks);
  batch[e / 8 + 8] |= rest != 0;
}

/* The elements of a word that are in marked batches. */
static inline uint64_t in_batches(const uint8_t *batch, const word *e)
{
  int shift = e->first % 8;
  uint64_t marks;
  memcpy(&marks, &batch[e->first / 8], sizeof marks);
  marks *= 0xff;
  uint64_t rest = (uint64_t)batch[e->first / 8 + 8] * 0xff;
  return (marks >> shift | rest << 1 << (63 - shift)) & e->all;
}

/* Mark the batches of some rows that have one of some elements. A batch may end in the next row. */
static void mark_batches(const look *l, span s, const uint64_t *elements, uint8_t *batch)
{
  int32_t nx = l->part->cells[0], first = s.first * nx / 8, end = ((s.last + 1) * nx + 7) / 8;
  memset(&batch[first], 0, (size_t)(end - first));
  s = widened(l, s, 1);
  for (int32_t r = s.first; r <= s.last; r++)
    for (int32_t w = 0; w < l->rows->words; w++) {
      word e = word_of(l, r, w);
      mark_word(elements[e.own], e.first, batch);
    }
}

/* Whether two nodes have the same three numbers, to the last bit. */
static inline int same(const double *a, const double *b)
{
  return memcmp(a, b, 3 * sizeof *a) == 0;
}

/* Whether the eight nodes of an element, of which the first is given, have the same three numbers,
 * to the last bit, and finite ones. */
static inline int alike(const look *l, const double *values, int64_t node)
{
  const double *first = &values[3 * node];
  for (int k = 0; k < 4; k++) {
    const double *v = &values[3 * (node + to_row(l, k))];
    if (!same(v, first) || !same(v + 3, first)) return 0;
  }
  return isfinite(first[0]) && isfinite(first[1]) && isfinite(first[2]);
}

/* The same for `count` elements of a row: a run of nodes is compared with itself, shifted by a
 * node. */
static int all_alike(const look *l, const double *values, int64_t node, int32_t count)
{
  for (int k = 0; k < 4; k++) {
    const double *v = &values[3 * (node + to_row(l, k))];
    if (memcmp(v, v + 3, 3 * (size_t)count * sizeof *v) != 0) return 0;
  }
  return alike(l, values, node);
}

/* Those of the wanted elements of a word whose nodes have the same numbers. */
static uint64_t alike_among(const look *l, const double *values, const word *e, uint64_t wanted)
{
  uint64_t found = 0;
  if (wanted == e->all && all_alike(l, values, e->node, e->count)) return wanted;
  for (uint64_t left = wanted; left != 0; left &= left - 1)
    if (alike(l, values, e->node + ct_bits_low_zeros(left))) found |= left & -left;
  return found;
}

/* Those of the wanted elements, whose nodes have one displacement and one velocity, that have those
 * of the leader. */
static uint64_t led_among(const look *l, const word *e, uint64_t wanted)
{
  uint64_t found = 0;
  for (uint64_t left = l->leader == NULL ? 0 : wanted; left != 0; left &= left - 1) {
    int64_t dof = 3 * (e->node + ct_bits_low_zeros(left));
    int alike = same(&l->displacement[dof], l->leader->displacement) &&
                same(&l->velocity[dof], l->leader->velocity);
    if (alike) found |= left & -left;
  }
  return found;
}

/* What has changed in a call. */
enum { CROSSED = 1, SLEPT = 2 };

/* Look at one word of a row; answers what has changed. */
static int look_at(const look *l, const word *e)
{
  const ct_rows *rows = l->rows;
  uint64_t *m = &rows->moving[e->own], *f = &rows->fresh[e->own], *a = &rows->asleep[e->own],
           *led = &rows->led[e->own];
  uint64_t woken = l->drifted == NULL ? e->all : elements_near(l, l->drifted, ~(uint64_t)0, e);
  uint64_t moving = *m, asleep = *a & ~woken, wanted = e->all & ~asleep & (~moving | *f | l->turn);
  uint64_t alike = alike_among(l, l->displacement, e, wanted), calm = alike & (~moving | *f);
  // -- One that has moved alike is computed once more, then it is quiet (eq:quiet-batch)
  *m = (moving | (wanted & ~alike)) & ~calm;
  *f = (*f & ~wanted) | (alike & ~calm);
  // -- One that nothing woke falls asleep if its nodes have one velocity, too (eq:quiet-asleep)
  uint64_t tired = l->velocity == NULL ? 0 : calm & ~woken;
  tired = alike_among(l, l->velocity, e, tired);
  uint64_t lead = (*led & asleep) | led_among(l, e, tired);
  int changed = (*m != moving ? CROSSED : 0) | (*led != lead ? SLEPT : 0);
  *a = asleep | tired;
  *led = lead;
  return changed;
}

/* Take displacement and velocity of the first elements that could sleep as the leader's; answers
 * whether there is one among the first few. */
static int choose_leader(const look *l, ct_leader *leader)
{
  int tries = 64;
  for (int32_t own = 0; own < l->rows->words * l->rows->count; own++) {
    word e = word_of(l, own / l->rows->words, own % l->rows->words);
    uint64_t left = e.all & (~l->rows->moving[own] | l->rows->fresh[own]) &
                    ~elements_near(l, l->drifted, ~(uint64_t)0, &e);
    for (; left != 0; left &= left - 1) {
      int64_t node = e.node + ct_bits_low_zeros(left);
      if (tries-- == 0) return 0;
      if (!alike(l, l->displacement, node) || !alike(l, l->velocity, node)) continue;
      memcpy(leader->displacement, &l->displacement[3 * node], sizeof leader->displacement);
      memcpy(leader->velocity, &l->velocity[3 * node], sizeof leader->velocity);
      leader->first = l->part->first_node;
      leader->last = l->part->first_node + l->part->mesh->node_count;
      return 1;
    }
  }
  return 0;
}

/* From the elements that are computed, of which those of some rows have changed: batches, nodes
 * that are summed, and what has such nodes. Answers for which rows that has changed. */
static span find_changed(const look *l, span crossed, const ct_found *found)
{
  const ct_rows *rows = l->rows;
  spread_to_nodes(l, crossed, rows->moving, 0, found->changed);
  mark_batches(l, crossed, rows->moving, found->computed);
  span near = widened(l, crossed, l->part->cells[1] + 1);
  for (int32_t r = near.first; r <= near.last; r++)
    for (int32_t w = 0; w < rows->words; w++) {
      word e = word_of(l, r, w);
      rows->reached[e.own] = elements_near(l, found->changed, 0, &e);
    }
  mark_batches(l, near, rows->reached, found->read);
  l->rows->computed = 0;
  for (int32_t b = 0; b < l->part->batch_count; b++) l->rows->computed += 8 * found->computed[b];
  return near;
}

/* Find the nodes that the leader moves for, where in some rows it has changed what is led or
 * reached. Nobody reads them before the step after the next: in their batches all elements are led
 * and none is reached. */
static void find_adrift(const look *l, span changed, const ct_found *found)
{
  const ct_rows *rows = l->rows;
  // Batches may end in the rows before and after.
  span around = widened(l, changed, 1);
  for (int32_t r = around.first; r <= around.last; r++)
    for (int32_t w = 0; w < rows->words; w++) {
      word e = word_of(l, r, w);
      rows->awake[e.own] = e.all & (~rows->led[e.own] | rows->reached[e.own]);
    }
  mark_batches(l, changed, rows->awake, found->awake);
  for (int32_t r = around.first; r <= around.last; r++)
    for (int32_t w = 0; w < rows->words; w++) {
      word e = word_of(l, r, w);
      rows->awake[e.own] = in_batches(found->awake, &e);
    }
  // -- A node is adrift if none of its elements is in a batch that may be read (eq:adrift-node)
  spread_to_nodes(l, around, rows->awake, ~(uint64_t)0, found->adrift);
}

/* Look at all rows; answers in which of them it has changed what is computed, and what is led. */
static void look_at_all(const look *l, int threads, span *crossed, span *slept)
{
  int32_t first[2] = {INT32_MAX, INT32_MAX}, last[2] = {-1, -1};
  (void)threads;
#ifdef _OPENMP
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1) \
    reduction(min : first[ : 2]) reduction(max : last[ : 2])
#endif
  for (int32_t r = 0; r < l->rows->count; r++)
    for (int32_t w = 0; w < l->rows->words; w++) {
      word e = word_of(l, r, w);
      int changed = look_at(l, &e);
      for (int i = 0; i < 2; i++) {
        if (!(changed & (i == 0 ? CROSSED : SLEPT))) continue;
        first[i] = r < first[i] ? r : first[i];
        last[i] = r > last[i] ? r : last[i];
      }
    }
  *crossed = (span){first[0], last[0]};
  *slept = (span){first[1], last[1]};
}

/* Before anything is known, all elements move. */
static void assume_moving(const look *l)
{
  for (int32_t r = 0; r < l->rows->count; r++)
    for (int32_t w = 0; w < l->rows->words; w++) {
      word e = word_of(l, r, w);
      l->rows->moving[e.own] = e.all;
    }
}

void ct_rows_find(ct_rows *rows, const ct_solid_part *part, const ct_view *view, int32_t call,
                  ct_leader *leader, const ct_found *found)
{
  int32_t row = part->cells[0] + 1, first = part->first_node, last = first + part->mesh->node_count;
  look l = {.rows = rows,
            .part = part,
            .row = row,
            .layer = row * (part->cells[1] + 1),
            .bit_words = ct_bits_words(found->node_count),
            .drifted = view->drifted,
            .displacement = view->displacement,
            .velocity = view->drifted == NULL ? NULL : view->velocity,
            .turn = 0x0101010101010101u << call % 8};
  if (!rows->known) {
    assume_moving(&l);
    l.turn = ~(uint64_t)0;
  }
  rows->known = 1;
  // A host may have changed anything before the first step of a call.
  if (view->drifted == NULL || leader == NULL) rows->leading = 0;
  else if (!rows->leading) rows->leading = choose_leader(&l, leader);
  l.leader = rows->leading ? leader : NULL;
  span crossed, slept, all = {0, rows->count - 1};
  look_at_all(&l, view->threads, &crossed, &slept);
  if (!rows->stands) crossed = all;
  if (crossed.first <= crossed.last) slept = joined(slept, find_changed(&l, crossed, found));
  if (!l.leader) ct_bits_put(found->adrift, first, last, 0);
  else if (!rows->led_stands) slept = all;
  if (l.leader && slept.first <= slept.last) find_adrift(&l, slept, found);
  rows->led_stands = l.leader != NULL;
  rows->stands = view->still != NULL;
  if (rows->stands) return;
  // Nothing stands from before: all nodes are to be summed.
  ct_bits_put(found->changed, first, last, 1);
  memset(found->read, 1, (size_t)part->batch_count);
}
