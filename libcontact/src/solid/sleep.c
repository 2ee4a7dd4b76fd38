/* Elements sleep until a wave reaches them. */
#include "sleep.h"

#include "../base/bits.h"
#include "../base/memory.h"

#include <math.h>
#include <string.h>

/* The sleeping part of a body. */
typedef struct body {
  double displacement[3], velocity[3];
  int32_t computed; /* elements that are active */
  int sleeps;       /* whether the others sleep; otherwise there are none */
} body;

struct ct_sleep {
  const ct_solid_part *parts;
  int32_t part_count, node_count;
  int examined;
  body *bodies;   /* of each part */
  uint8_t *batch; /* of each batch of all parts */
  /* One bit per node: further effects act on it; it is moved individually; it is, and has so far
   * only had the displacement of the sleeping part; one of its elements is active. */
  uint64_t *shared, *active, *front, *summed;
};

/* Entry i of a part's table of elements, as a node of the problem. */
static int32_t node_at(const ct_solid_part *part, int64_t i)
{
  int32_t own = part->mesh->elements[i];
  return part->first_node + (part->order != NULL ? part->order->user[own] : own);
}

/* Nodes of a batch, some more than once: first ... last - 1 of the mesh's table. */
static void batch_nodes(const ct_solid_part *part, int32_t b, int64_t *first, int64_t *last)
{
  int64_t per = ct_brick_node_count(part->mesh->kind), end = 8 * (int64_t)b + 8;
  *first = 8 * per * b;
  *last = per * (end < part->mesh->element_count ? end : part->mesh->element_count);
}

ct_status ct_sleep_prepare(ct_solid_part *part)
{
  int32_t nodes = part->mesh->node_count, *latest = ct_allocate((size_t)nodes, sizeof *latest),
          *begin = part->batch_begin = ct_allocate((size_t)nodes + 2, sizeof *begin);
  ct_status status = latest != NULL && begin != NULL ? CT_OK : CT_ERROR_MEMORY;
  // Count, then list: begin[n + 2] is first the count of node n, and finally the end of its list.
  for (int pass = 0; status == CT_OK && pass < 2; pass++) {
    for (int32_t n = 0; n < nodes; n++) latest[n] = -1;
    for (int32_t b = 0; b < part->batch_count; b++) {
      int64_t first, last;
      batch_nodes(part, b, &first, &last);
      for (int64_t i = first; i < last; i++) {
        int32_t n = part->mesh->elements[i];
        if (latest[n] == b) continue;
        latest[n] = b;
        if (pass == 0) begin[n + 2]++;
        else part->batches_at[begin[n + 1]++] = b;
      }
    }
    for (int32_t n = 0; pass == 0 && n < nodes; n++) begin[n + 2] += begin[n + 1];
    if (pass == 0)
      part->batches_at = ct_allocate((size_t)begin[nodes + 1], sizeof *part->batches_at);
    if (part->batches_at == NULL) status = CT_ERROR_MEMORY;
  }
  ct_release(latest);
  return status;
}

/* Batches of the elements of a node of the body, some maybe more than once; returns their number.
 * If there is a ring, its runs have the elements. */
static int32_t batches_of(const ct_solid_part *part, int32_t node, int32_t own[8],
                          const int32_t **batches)
{
  if (part->batch_begin != NULL) {
    *batches = &part->batches_at[part->batch_begin[node]];
    return part->batch_begin[node + 1] - part->batch_begin[node];
  }
  const ct_ring_run *run = ct_force_ring_run(part->ring, node);
  int32_t count = 0;
  for (int k = 0; k < 8; k++)
    if (run->element[k] >= 0) own[count++] = (run->element[k] + node - run->low) / 8;
  *batches = own;
  return count;
}

ct_status ct_sleep_create(const ct_solid_part *parts, int32_t part_count, ct_sleep **out)
{
  ct_sleep *s = ct_allocate(1, sizeof *s);
  *out = s;
  if (s == NULL) return CT_ERROR_MEMORY;
  const ct_solid_part *end = &parts[part_count - 1];
  s->parts = parts;
  s->part_count = part_count;
  s->node_count = end->first_node + end->mesh->node_count;
  size_t words = (size_t)ct_bits_words(s->node_count);
  s->bodies = ct_allocate((size_t)part_count, sizeof *s->bodies);
  s->batch = ct_allocate((size_t)(end->first_batch + end->batch_count), sizeof *s->batch);
  s->shared = ct_allocate(words, sizeof *s->shared);
  s->active = ct_allocate(words, sizeof *s->active);
  s->front = ct_allocate(words, sizeof *s->front);
  s->summed = ct_allocate(words, sizeof *s->summed);
  int whole = s->bodies && s->batch && s->shared && s->active && s->front && s->summed;
  return whole ? CT_OK : CT_ERROR_MEMORY;
}

void ct_sleep_free(ct_sleep *s)
{
  if (s == NULL) return;
  void *blocks[] = {s->bodies, s->batch, s->shared, s->active, s->front, s->summed, s};
  for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++) ct_release(blocks[i]);
}

void ct_sleep_share(ct_sleep *s, int32_t count, const int32_t *nodes)
{
  for (int32_t i = 0; s != NULL && i < count; i++) {
    const int32_t n = nodes[i];
    ct_bits_put(s->shared, n, n + 1, 1);
    // The sets of the steps that follow may be known already.
    if (ct_bits_get(s->active, n)) continue;
    ct_bits_put(s->active, n, n + 1, 1);
    ct_bits_put(s->front, n, n + 1, 1);
  }
}

/* Whether two nodes differ in one of three numbers, which are then not equal or not finite. */
static inline int differ(const double *a, const double *b)
{
  // One sum, because most nodes do not differ, and branches would all be evaluated.
  return !((fabs(a[0] - b[0]) + fabs(a[1] - b[1])) + fabs(a[2] - b[2]) == 0.0);
}

/* Make a batch active from now on, with all of its nodes; `u` is null if everything is examined,
 * because then the displacement of each node is known. */
static void wake_batch(ct_sleep *s, int32_t p, int32_t b, double *u)
{
  const ct_solid_part *part = &s->parts[p];
  int64_t first, last;
  batch_nodes(part, b, &first, &last);
  s->batch[part->first_batch + b] = CT_ACTIVE;
  s->bodies[p].computed += (int32_t)((last - first) / ct_brick_node_count(part->mesh->kind));
  for (int64_t i = first; i < last; i++) {
    int32_t own = part->mesh->elements[i], n = node_at(part, i), around[8];
    const int32_t *at;
    if (ct_bits_get(s->summed, n)) continue;
    ct_bits_put(s->summed, n, n + 1, 1);
    for (int32_t k = batches_of(part, own, around, &at) - 1; k >= 0; k--) {
      uint8_t *neighbour = &s->batch[part->first_batch + at[k]];
      if (*neighbour == CT_ASLEEP) *neighbour = CT_BORDER;
    }
    if (ct_bits_get(s->active, n)) continue;
    ct_bits_put(s->active, n, n + 1, 1);
    ct_bits_put(s->front, n, n + 1, 1);
    if (u != NULL) memcpy(&u[3 * (int64_t)n], s->bodies[p].displacement, 3 * sizeof *u);
  }
}

/* Whether a node moves differently from the sleeping part. */
static inline int stirs(const body *own, const double *u, const double *v,
                        const double *last_acceleration, int64_t n)
{
  static const double rest[3] = {0.0, 0.0, 0.0};
  return differ(&u[3 * n], own->displacement) || differ(&v[3 * n], own->velocity) ||
         (last_acceleration != NULL && differ(&last_acceleration[3 * n], rest));
}

/* Take the motion of the first batch whose nodes move alike; returns whether there is one. */
static int choose_motion(const ct_solid_part *part, const double *u, const double *v,
                         const double *last_acceleration, body *own)
{
  for (int32_t b = 0; b < part->batch_count; b++) {
    int64_t i, last;
    batch_nodes(part, b, &i, &last);
    int64_t node = node_at(part, i);
    memcpy(own->displacement, &u[3 * node], sizeof own->displacement);
    memcpy(own->velocity, &v[3 * node], sizeof own->velocity);
    while (i < last && !stirs(own, u, v, last_acceleration, node_at(part, i))) i++;
    if (i == last) return 1;
  }
  return 0;
}

/* Let those batches of a part sleep that move like the first possible one; returns whether there
 * are any. */
static int examine(ct_sleep *s, int32_t p, const double *u, const double *v,
                   const double *last_acceleration)
{
  const ct_solid_part *part = &s->parts[p];
  body *own = &s->bodies[p];
  uint8_t *batch = &s->batch[part->first_batch];
  int32_t begin = part->first_node, end = begin + part->mesh->node_count;
  if (!part->optimisations.sleep || !choose_motion(part, u, v, last_acceleration, own)) return 0;
  // -- Mark the nodes that do not move like the first possible batch
  for (int32_t n = begin, last; n < end; n = last) {
    uint64_t word = 0;
    last = ct_bits_word_end(n, end);
    for (int32_t i = n; i < last; i++)
      word |= (uint64_t)stirs(own, u, v, last_acceleration, i) << (i % 64);
    ct_bits_write(s->front, n, last, word);
  }
  // -- A batch without such a node sleeps
  for (int32_t b = 0; b < part->batch_count; b++) {
    int64_t i, last;
    for (batch_nodes(part, b, &i, &last); i < last && !ct_bits_get(s->front, node_at(part, i));)
      i++;
    batch[b] = i < last ? CT_ACTIVE : CT_ASLEEP;
  }
  // -- Begin the sets of nodes with the shared nodes, and wake the other batches
  ct_bits_put(s->summed, begin, end, 0);
  for (int32_t n = begin, last; n < end; n = last) {
    last = ct_bits_word_end(n, end);
    ct_bits_write(s->active, n, last, s->shared[n / 64]);
    ct_bits_write(s->front, n, last, s->shared[n / 64]);
  }
  for (int32_t b = 0; b < part->batch_count; b++)
    if (batch[b] == CT_ACTIVE) wake_batch(s, p, b, NULL);
  return 1;
}

void ct_sleep_examine(ct_sleep *s, const double *displacement, const double *velocity,
                      const double *last_acceleration)
{
  if (s == NULL) return;
  s->examined = 1;
  for (int32_t p = 0; p < s->part_count; p++) {
    const ct_solid_part *part = &s->parts[p];
    int32_t begin = part->first_node, end = begin + part->mesh->node_count;
    s->bodies[p] = (body){.computed = 0};
    s->bodies[p].sleeps = examine(s, p, displacement, velocity, last_acceleration);
    if (s->bodies[p].sleeps) continue;
    s->bodies[p].computed = part->batch_count == 0 ? 0 : part->mesh->element_count;
    memset(&s->batch[part->first_batch], CT_ACTIVE, (size_t)part->batch_count);
    ct_bits_put(s->active, begin, end, 1);
    ct_bits_put(s->summed, begin, end, 1);
    ct_bits_put(s->front, begin, end, 0);
  }
}

/* Wake all batches of a node. */
static void wake_around(ct_sleep *s, int32_t p, int32_t n, double *u)
{
  const ct_solid_part *part = &s->parts[p];
  int32_t own = n - part->first_node, around[8];
  const int32_t *at;
  if (part->order != NULL) own = part->order->inside[own];
  for (int32_t k = batches_of(part, own, around, &at) - 1; k >= 0; k--)
    if (s->batch[part->first_batch + at[k]] != CT_ACTIVE) wake_batch(s, p, at[k], u);
}

void ct_sleep_wake(ct_sleep *s, double *displacement)
{
  if (s == NULL) return;
  s->examined = 0;
  for (int32_t p = 0; p < s->part_count; p++) {
    int32_t n = s->parts[p].first_node, end = n + s->parts[p].mesh->node_count;
    if (!s->bodies[p].sleeps) continue;
    // -- A node with a different motion wakes its elements, and is not checked again
    for (n = ct_bits_next(s->front, n, end, 1); n < end;
         n = ct_bits_next(s->front, n + 1, end, 1)) {
      if (!differ(&displacement[3 * (int64_t)n], s->bodies[p].displacement)) continue;
      ct_bits_put(s->front, n, n + 1, 0);
      wake_around(s, p, n, displacement);
    }
  }
}

void ct_sleep_drift(ct_sleep *s, double time)
{
  for (int32_t p = 0; s != NULL && p < s->part_count; p++)
    for (int c = 0; c < 3; c++) s->bodies[p].displacement[c] += time * s->bodies[p].velocity[c];
}

void ct_sleep_settle(const ct_sleep *s, double *displacement)
{
  for (int32_t p = 0; s != NULL && p < s->part_count; p++) {
    int32_t n = s->parts[p].first_node, end = n + s->parts[p].mesh->node_count;
    const double *u = s->bodies[p].displacement, x = u[0], y = u[1], z = u[2];
    while ((n = ct_bits_next(s->active, n, end, 0)) < end) {
      int32_t last = ct_bits_next(s->active, n, end, 1);
      for (double *to = &displacement[3 * (int64_t)n]; n < last; n++, to += 3)
        to[0] = x, to[1] = y, to[2] = z;
    }
  }
}

const uint64_t *ct_sleep_active(const ct_sleep *s) { return s == NULL ? NULL : s->active; }

const uint64_t *ct_sleep_summed(const ct_sleep *s) { return s == NULL ? NULL : s->summed; }

const uint8_t *ct_sleep_batches(const ct_sleep *s, int32_t part)
{
  return s == NULL || !s->bodies[part].sleeps ? NULL : &s->batch[s->parts[part].first_batch];
}

int ct_sleep_examined(const ct_sleep *s) { return s != NULL && s->examined; }

void ct_sleep_count(const ct_sleep *s, int64_t updates[2])
{
  for (int32_t p = 0; p < s->part_count; p++) {
    updates[0] += s->bodies[p].computed;
    updates[1] += s->parts[p].mesh->element_count - s->bodies[p].computed;
  }
}
