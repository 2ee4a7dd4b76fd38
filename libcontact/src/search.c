#include "search.h"

#include "error.h"
#include "memory.h"

#include <math.h>
#include <stdlib.h>

/* Node k has the children 2k + 1 and 2k + 2 and covers a range of `order`; leaves hold one item. */
struct ct_search {
  int32_t count;
  int32_t *order;
  ct_bounds *boxes; /* of the items */
  ct_bounds *nodes; /* of the tree, by the range's place in a depth-first walk */
};

enum { STACK = 128 };

double ct_bounds_distance(const ct_bounds *box, const double point[3])
{
  double d[3];
  for (int c = 0; c < 3; c++) d[c] = fmax(fmax(box->low[c] - point[c], point[c] - box->high[c]), 0.0);
  return sqrt((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]);
}

static int overlap(const ct_bounds *a, const ct_bounds *b)
{
  for (int c = 0; c < 3; c++)
    if (a->low[c] > b->high[c] || b->low[c] > a->high[c]) return 0;
  return 1;
}

void ct_search_free(ct_search *search)
{
  if (search == NULL) return;
  ct_release(search->order);
  ct_release(search->boxes);
  ct_release(search->nodes);
  ct_release(search);
}

ct_status ct_search_create(int32_t count, ct_search **out, ct_error *error)
{
  ct_search *search = ct_allocate(1, sizeof *search);
  if (search != NULL) {
    search->count = count;
    search->order = ct_allocate((size_t)count, sizeof *search->order);
    search->boxes = ct_allocate((size_t)count, sizeof *search->boxes);
    search->nodes = ct_allocate(2 * (size_t)count, sizeof *search->nodes);
  }
  if (search == NULL || search->order == NULL || search->boxes == NULL || search->nodes == NULL) {
    ct_search_free(search);
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the search tree");
  }
  *out = search;
  return CT_OK;
}

static double middle(const ct_search *search, int32_t item, int axis)
{
  return search->boxes[item].low[axis] + search->boxes[item].high[axis];
}

/* Sort a range of `order` by the middles along one axis, items with equal middles by number (heap sort: no recursion). */
static int before(const ct_search *search, int axis, int32_t a, int32_t b)
{
  double p = middle(search, a, axis), q = middle(search, b, axis);
  return p < q || (p == q && a < b);
}

static void sift(const ct_search *search, int axis, int32_t *order, int32_t root, int32_t count)
{
  for (int32_t child; (child = 2 * root + 1) < count; root = child) {
    if (child + 1 < count && before(search, axis, order[child], order[child + 1])) child++;
    if (!before(search, axis, order[root], order[child])) return;
    int32_t item = order[root];
    order[root] = order[child];
    order[child] = item;
  }
}

static void sort_range(const ct_search *search, int axis, int32_t *order, int32_t count)
{
  for (int32_t root = count / 2; root-- > 0;) sift(search, axis, order, root, count);
  for (int32_t last = count; last-- > 1;) {
    int32_t item = order[0];
    order[0] = order[last];
    order[last] = item;
    sift(search, axis, order, 0, last);
  }
}

/* A range of `order` and the place of its node: the left child follows it at once, the right child after the left's 2 n - 1 nodes. */
typedef struct range {
  int32_t node, first, last;
} range;

static range left_of(range r) { return (range){r.node + 1, r.first, (r.first + r.last) / 2}; }

static range right_of(range r)
{
  int32_t half = (r.first + r.last) / 2;
  return (range){r.node + 2 * (half - r.first), half, r.last};
}

static ct_bounds range_bounds(const ct_search *search, range r)
{
  ct_bounds box = search->boxes[search->order[r.first]];
  for (int32_t i = r.first + 1; i < r.last; i++)
    for (int c = 0; c < 3; c++) {
      box.low[c] = fmin(box.low[c], search->boxes[search->order[i]].low[c]);
      box.high[c] = fmax(box.high[c], search->boxes[search->order[i]].high[c]);
    }
  return box;
}

void ct_search_build(ct_search *search, const ct_bounds *boxes)
{
  range stack[STACK];
  int depth = 0;
  for (int32_t i = 0; i < search->count; i++) {
    search->order[i] = i;
    search->boxes[i] = boxes[i];
  }
  if (search->count > 0) stack[depth++] = (range){0, 0, search->count};
  while (depth > 0) {
    // -- Split each range at the median along its longest axis (eq:bounding-tree)
    range r = stack[--depth];
    ct_bounds box = range_bounds(search, r);
    search->nodes[r.node] = box;
    if (r.last - r.first == 1) continue;
    int axis = 0;
    for (int c = 1; c < 3; c++)
      if (box.high[c] - box.low[c] > box.high[axis] - box.low[axis]) axis = c;
    sort_range(search, axis, &search->order[r.first], r.last - r.first);
    stack[depth++] = right_of(r);
    stack[depth++] = left_of(r);
  }
}

static int compare_items(const void *a, const void *b)
{
  int32_t p = *(const int32_t *)a, q = *(const int32_t *)b;
  return (p > q) - (p < q);
}

int32_t ct_search_overlaps(const ct_search *search, const ct_bounds *box, int32_t *items, int32_t room)
{
  range stack[STACK];
  int depth = 0;
  int32_t found = 0;
  if (search->count > 0) stack[depth++] = (range){0, 0, search->count};
  while (depth > 0) {
    range r = stack[--depth];
    if (!overlap(&search->nodes[r.node], box)) continue;
    if (r.last - r.first == 1) {
      if (found < room) items[found] = search->order[r.first];
      found++;
      continue;
    }
    stack[depth++] = right_of(r);
    stack[depth++] = left_of(r);
  }
  if (found > 1 && found <= room) qsort(items, (size_t)found, sizeof *items, compare_items);
  return found;
}

int32_t ct_search_nearest(const ct_search *search, const double point[3], double (*distance)(void *user, int32_t item), void *user,
                          double *nearest)
{
  range stack[STACK];
  int depth = 0;
  int32_t best = -1;
  *nearest = INFINITY;
  if (search->count > 0) stack[depth++] = (range){0, 0, search->count};
  while (depth > 0) {
    // -- Leave out every box that is farther than the best item (eq:box-distance)
    range r = stack[--depth];
    if (ct_bounds_distance(&search->nodes[r.node], point) > *nearest) continue;
    if (r.last - r.first == 1) {
      int32_t item = search->order[r.first];
      double d = distance(user, item);
      if (d < *nearest || (d == *nearest && item < best)) {
        *nearest = d;
        best = item;
      }
      continue;
    }
    range near = left_of(r), far = right_of(r);
    if (ct_bounds_distance(&search->nodes[far.node], point) < ct_bounds_distance(&search->nodes[near.node], point)) {
      range swap = near;
      near = far;
      far = swap;
    }
    stack[depth++] = far;
    stack[depth++] = near;
  }
  return best;
}
