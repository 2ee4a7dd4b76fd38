/* The tree of boxes: build, refit, and the two questions. */
#include "box_tree.h"

#include "../base/error.h"
#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>

struct ct_box_tree {
  int32_t count;
  int32_t *items; /* in the order of the leaves */
  ct_bounds *box; /* of each range of more than one item */
  double size;    /* largest extent of the box of all */
  double cost, cost_built;
  int64_t builds;
};

/* A part of the items, and the number of its box. The boxes of a range of n items and of the ranges
 * in it are n - 1 and follow each other, so that no links are needed. */
typedef struct range {
  int32_t first, count, box;
} range;

static range lower_half(range r) { return (range){r.first, r.count / 2, r.box + 1}; }

static range upper_half(range r)
{
  int32_t half = r.count / 2;
  return (range){r.first + half, r.count - half, r.box + (half > 1 ? half : 1)};
}

void ct_box_tree_free(ct_box_tree *tree)
{
  if (tree == NULL) return;
  ct_release(tree->items);
  ct_release(tree->box);
  ct_release(tree);
}

ct_status ct_box_tree_create(int32_t count, ct_box_tree **out, ct_error *error)
{
  ct_box_tree *tree = ct_allocate(1, sizeof *tree);
  if (tree != NULL) {
    tree->count = count;
    tree->items = ct_allocate((size_t)count, sizeof *tree->items);
    tree->box = ct_allocate((size_t)count, sizeof *tree->box);
  }
  if (tree == NULL || tree->items == NULL || tree->box == NULL) {
    ct_box_tree_free(tree);
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a search tree");
  }
  *out = tree;
  return CT_OK;
}

/* Twice the middle of an item's box along an axis. */
static double middle(const ct_bounds *boxes, int32_t item, int axis)
{
  return boxes[item].low[axis] + boxes[item].high[axis];
}

/* Items are ordered by the middles of their boxes, those with equal middles by number. */
static int before(const ct_bounds *boxes, int axis, int32_t a, int32_t b)
{
  double x = middle(boxes, a, axis), y = middle(boxes, b, axis);
  return x < y || (x == y && a < b);
}

/* Put the `rank` first items along an axis in front, by quick-select. */
static void split(int32_t *items, int32_t count, int32_t rank, const ct_bounds *boxes, int axis)
{
  int32_t first = 0, last = count - 1;
  uint32_t random = 12345;
  while (first < last) {
    // -- Pivot: an item that no input can foresee as bad
    random = random * 1664525u + 1013904223u;
    int32_t pivot = items[first + (int32_t)(random >> 1) % (last - first + 1)];
    int32_t i = first, j = last;
    while (i <= j) {
      while (before(boxes, axis, items[i], pivot)) i++;
      while (before(boxes, axis, pivot, items[j])) j--;
      if (i > j) break;
      int32_t item = items[i];
      items[i++] = items[j];
      items[j--] = item;
    }
    if (rank <= j) last = j;
    else if (rank >= i) first = i;
    else return;
  }
}

/* The axis along which the middles of the items are spread most. */
static int longest_axis(const int32_t *items, int32_t count, const ct_bounds *boxes)
{
  int axis = 0;
  double longest = -1.0;
  for (int c = 0; c < 3; c++) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int32_t i = 0; i < count; i++) {
      double x = middle(boxes, items[i], c);
      low = x < low ? x : low;
      high = x > high ? x : high;
    }
    if (high - low <= longest) continue;
    longest = high - low;
    axis = c;
  }
  return axis;
}

/* Order the items so that each range is cut in half at the median along its longest axis
 * (eq:bounding-tree). */
static void arrange(int32_t *items, int32_t count, const ct_bounds *boxes)
{
  if (count < 2) return;
  int32_t half = count / 2;
  split(items, count, half, boxes, longest_axis(items, count, boxes));
  arrange(items, half, boxes);
  arrange(items + half, count - half, boxes);
}

static const ct_bounds *box_of(const ct_box_tree *tree, const ct_bounds *boxes, range r)
{
  return r.count == 1 ? &boxes[tree->items[r.first]] : &tree->box[r.box];
}

/* Half the surface of a box. */
static double surface(const ct_bounds *box)
{
  double edge[3];
  for (int c = 0; c < 3; c++) edge[c] = box->high[c] - box->low[c];
  return (edge[0] * edge[1] + edge[1] * edge[2]) + edge[2] * edge[0];
}

/* Find the boxes of a range and of all ranges in it; answers the sum of their surfaces. */
static double fit_range(ct_box_tree *tree, const ct_bounds *boxes, range r)
{
  if (r.count == 1) return surface(&boxes[tree->items[r.first]]);
  range a = lower_half(r), b = upper_half(r);
  double below = fit_range(tree, boxes, a) + fit_range(tree, boxes, b);
  tree->box[r.box] = *box_of(tree, boxes, a);
  ct_bounds_join(&tree->box[r.box], box_of(tree, boxes, b));
  return below + surface(&tree->box[r.box]);
}

static void fit(ct_box_tree *tree, const ct_bounds *boxes)
{
  range all = {0, tree->count, 0};
  if (tree->count == 0) return;
  // -- Sum the surfaces of all boxes, over that of the whole (eq:tree-cost)
  double sum = fit_range(tree, boxes, all);
  const ct_bounds *whole = box_of(tree, boxes, all);
  tree->cost = sum / surface(whole);
  tree->size = 0.0;
  for (int c = 0; c < 3; c++) tree->size = fmax(tree->size, whole->high[c] - whole->low[c]);
}

void ct_box_tree_build(ct_box_tree *tree, const ct_bounds *boxes)
{
  for (int32_t i = 0; i < tree->count; i++) tree->items[i] = i;
  arrange(tree->items, tree->count, boxes);
  fit(tree, boxes);
  tree->cost_built = tree->cost;
  tree->builds++;
}

void ct_box_tree_refit(ct_box_tree *tree, const ct_bounds *boxes)
{
  // -- Build anew when the boxes have grown, seen from the whole, by half (eq:tree-cost)
  if (tree->builds > 0) fit(tree, boxes);
  if (tree->builds == 0 || tree->cost > 1.5 * tree->cost_built) ct_box_tree_build(tree, boxes);
}

double ct_box_tree_cost(const ct_box_tree *tree)
{
  return tree->cost_built > 0.0 ? tree->cost / tree->cost_built : 1.0;
}

int64_t ct_box_tree_builds(const ct_box_tree *tree) { return tree->builds; }

static int compare_items(const void *a, const void *b)
{
  int32_t p = *(const int32_t *)a, q = *(const int32_t *)b;
  return (p > q) - (p < q);
}

static int overlap(const ct_bounds *a, const ct_bounds *b)
{
  for (int c = 0; c < 3; c++)
    if (a->low[c] > b->high[c] || b->low[c] > a->high[c]) return 0;
  return 1;
}

int32_t ct_box_tree_overlaps(const ct_box_tree *tree, const ct_bounds *boxes, const ct_bounds *box,
                             int32_t *items, int32_t room)
{
  enum { STACK = 64 }; /* a range waits for each time that its count was halved */
  range stack[STACK];
  int32_t found = 0;
  int depth = 0;
  if (tree->count > 0) stack[depth++] = (range){0, tree->count, 0};
  while (depth > 0) {
    range r = stack[--depth];
    if (!overlap(box_of(tree, boxes, r), box)) continue;
    if (r.count > 1) {
      stack[depth++] = upper_half(r);
      stack[depth++] = lower_half(r);
    } else {
      if (found < room) items[found] = tree->items[r.first];
      found++;
    }
  }
  if (found > 1 && found <= room) qsort(items, (size_t)found, sizeof *items, compare_items);
  return found;
}

/* A point that looks for its nearest item; `limit` is the square of the distance from which on no
 * box needs to be looked at. */
typedef struct query {
  const ct_box_tree *tree;
  const ct_bounds *boxes;
  const double *point;
  ct_box_visit *visit;
  void *user;
  double limit;
} query;

/* The limit for a distance that is known, with room for the roundings of those who tie with it. */
static double limit_of(const ct_box_tree *tree, double square)
{
  double far = sqrt(square) * (1.0 + 1e-12) + 1e-12 * tree->size;
  return far * far;
}

/* Visit the items of a range that may be near enough, those in the nearer half first. */
static void visit_range(query *q, range r)
{
  if (r.count == 1) {
    q->limit = limit_of(q->tree, q->visit(q->user, q->tree->items[r.first]));
    return;
  }
  range part[2] = {lower_half(r), upper_half(r)};
  double square[2];
  for (int k = 0; k < 2; k++)
    square[k] = ct_bounds_square(box_of(q->tree, q->boxes, part[k]), q->point);
  int nearer = square[1] < square[0];
  // -- Leave out every box that is farther than the best item (eq:box-distance)
  if (square[nearer] <= q->limit) visit_range(q, part[nearer]);
  if (square[1 - nearer] <= q->limit) visit_range(q, part[1 - nearer]);
}

void ct_box_tree_visit(const ct_box_tree *tree, const ct_bounds *boxes, const double point[3],
                       double square, ct_box_visit *visit, void *user)
{
  query q = {tree, boxes, point, visit, user, limit_of(tree, square)};
  if (tree->count > 0) visit_range(&q, (range){0, tree->count, 0});
}
