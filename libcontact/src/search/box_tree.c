/* The tree of boxes: build, refit, and the two queries. */
#include "box_tree.h"

#include "../base/error.h"
#include "../base/memory.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 4, STACK = 128 };

/* Boxes of the children side by side, for vector lanes. A child >= 0 is a later node in the array,
 * a child < 0 the item ~child. */
typedef struct node {
  float low[3][WIDTH], high[3][WIDTH];
  int32_t child[WIDTH];
  int32_t count, unused[3];
} node;

/* Middle of an item's box, by which the builder sorts. */
typedef struct entry {
  double middle[3];
  int32_t item;
} entry;

struct ct_box_tree {
  int32_t count, node_count;
  node *nodes;
  entry *entries;          /* in the order of the leaves */
  double origin[3], scale; /* single-precision coordinates are (x - origin) scale, about -1 ... 1 */
  double cost, cost_built;
  int64_t builds;
};

/* Coordinates of missing children: farther than any point or limit. */
static const float NOWHERE = 3e18f;

/* Margin of the scaled boxes for all roundings to single precision: of boxes, of points, of their
 * differences. */
static const double MARGIN = 1e-6;

void ct_box_tree_free(ct_box_tree *tree)
{
  if (tree == NULL) return;
  ct_release(tree->nodes);
  ct_release(tree->entries);
  ct_release(tree);
}

ct_status ct_box_tree_create(int32_t count, ct_box_tree **out, ct_error *error)
{
  ct_box_tree *tree = ct_allocate(1, sizeof *tree);
  if (tree != NULL) {
    tree->count = count;
    tree->scale = 1.0;
    tree->nodes = ct_allocate((size_t)count, sizeof *tree->nodes);
    tree->entries = ct_allocate((size_t)count, sizeof *tree->entries);
  }
  if (tree == NULL || tree->nodes == NULL || tree->entries == NULL) {
    ct_box_tree_free(tree);
    return CT_NO_MEMORY(error, "a search tree");
  }
  *out = tree;
  return CT_OK;
}

static int before(const entry *a, const entry *b, int axis)
{
  return a->middle[axis] < b->middle[axis] ||
         (a->middle[axis] == b->middle[axis] && a->item < b->item);
}

static void swap(entry *a, entry *b)
{
  entry t = *a;
  *a = *b;
  *b = t;
}

/* Move the `rank` first entries along an axis to the front, by quick-select; entries with equal
 * middles by number. */
static void split(entry *list, int32_t count, int32_t rank, int axis)
{
  int32_t first = 0, last = count - 1;
  uint32_t random = 12345;
  while (first < last) {
    // -- Pivot: the middle one of three places that no input can foresee as bad
    int32_t at[3];
    for (int i = 0; i < 3; i++) {
      random = random * 1664525u + 1013904223u;
      at[i] = first + (int32_t)(random >> 1) % (last - first + 1);
    }
    if (before(&list[at[1]], &list[at[0]], axis)) {
      int32_t t = at[0];
      at[0] = at[1];
      at[1] = t;
    }
    int32_t pick = before(&list[at[2]], &list[at[0]], axis)   ? at[0]
                   : before(&list[at[2]], &list[at[1]], axis) ? at[2]
                                                              : at[1];
    // -- Entries below the pivot to the front, those above it behind
    entry pivot = list[pick];
    int32_t i = first, j = last;
    while (i <= j) {
      while (before(&list[i], &pivot, axis)) i++;
      while (before(&pivot, &list[j], axis)) j--;
      if (i <= j) swap(&list[i++], &list[j--]);
    }
    if (rank <= j) last = j;
    else if (rank >= i) first = i;
    else return;
  }
}

/* Cut a range in two at the median along the longest axis of its middles, so that the first part
 * fills its leaves; returns the place of the cut. */
static int32_t halve(entry *list, int32_t count)
{
  double low[3], high[3];
  for (int c = 0; c < 3; c++) low[c] = high[c] = list[0].middle[c];
  for (int32_t i = 1; i < count; i++)
    for (int c = 0; c < 3; c++) {
      if (list[i].middle[c] < low[c]) low[c] = list[i].middle[c];
      if (list[i].middle[c] > high[c]) high[c] = list[i].middle[c];
    }
  int axis = 0;
  for (int c = 1; c < 3; c++)
    if (high[c] - low[c] > high[axis] - low[axis]) axis = c;
  int32_t half = count > WIDTH ? WIDTH * ((count + 2 * WIDTH - 1) / (2 * WIDTH)) : count / 2;
  split(list, count, half, axis);
  return half;
}

/* A range of entries and the link in the tree to its future node. */
typedef struct range {
  int32_t first, last, parent, slot;
} range;

/* Cut a range into at most four; returns their number. */
static int quarter(const ct_box_tree *tree, range r, range part[WIDTH])
{
  int32_t count = r.last - r.first;
  int parts = 0;
  if (count <= WIDTH) {
    for (int32_t i = r.first; i < r.last; i++) part[parts++] = (range){i, i + 1, 0, 0};
    return parts;
  }
  int32_t half = r.first + halve(tree->entries + r.first, count);
  range two[2] = {{r.first, half, 0, 0}, {half, r.last, 0, 0}};
  for (int k = 0; k < 2; k++) {
    int32_t own = two[k].last - two[k].first;
    int32_t cut =
        own > WIDTH ? two[k].first + halve(tree->entries + two[k].first, own) : two[k].last;
    part[parts++] = (range){two[k].first, cut, 0, 0};
    if (cut < two[k].last) part[parts++] = (range){cut, two[k].last, 0, 0};
  }
  return parts;
}

/* Links between nodes, without boxes. */
static void link_nodes(ct_box_tree *tree)
{
  range stack[STACK];
  int depth = 0;
  tree->node_count = 0;
  if (tree->count > 0) stack[depth++] = (range){0, tree->count, -1, 0};
  while (depth > 0) {
    // -- Cut each range in four along the longest axes (eq:bounding-tree)
    range r = stack[--depth], part[WIDTH];
    int32_t number = tree->node_count++;
    node *n = &tree->nodes[number];
    if (r.parent >= 0) tree->nodes[r.parent].child[r.slot] = number;
    n->count = quarter(tree, r, part);
    for (int k = n->count; k-- > 0;) {
      n->child[k] = ~tree->entries[part[k].first].item;
      if (part[k].last - part[k].first > 1)
        stack[depth++] = (range){part[k].first, part[k].last, number, k};
    }
  }
}

/* Frame of the single-precision coordinates: an origin, and a power of two. */
static void set_frame(ct_box_tree *tree, const ct_bounds *boxes)
{
  ct_bounds all = boxes[0];
  double size = 0.0;
  int exponent = 0;
  for (int32_t i = 1; i < tree->count; i++) ct_bounds_join(&all, &boxes[i]);
  for (int c = 0; c < 3; c++) {
    tree->origin[c] = 0.5 * all.low[c] + 0.5 * all.high[c];
    size = fmax(size, all.high[c] - all.low[c]);
  }
  if (size > 0.0) (void)frexp(size, &exponent);
  if (exponent > 240) exponent = 240;
  if (exponent < -240) exponent = -240;
  tree->scale = ldexp(1.0, -exponent);
}

static float half_surface(const float edge[3])
{
  return (edge[0] * edge[1] + edge[1] * edge[2]) + edge[2] * edge[0];
}

/* Box of child k, from the item or from the children of the child; returns half its surface. */
static float fit_child(ct_box_tree *tree, const ct_bounds *boxes, node *n, int k)
{
  float edge[3];
  for (int c = 0; c < 3; c++) {
    if (n->child[k] < 0) {
      const ct_bounds *box = &boxes[~n->child[k]];
      n->low[c][k] = (float)((box->low[c] - tree->origin[c]) * tree->scale - MARGIN);
      n->high[c][k] = (float)((box->high[c] - tree->origin[c]) * tree->scale + MARGIN);
    } else {
      const node *below = &tree->nodes[n->child[k]];
      n->low[c][k] = below->low[c][0];
      n->high[c][k] = below->high[c][0];
      for (int i = 1; i < below->count; i++) {
        if (below->low[c][i] < n->low[c][k]) n->low[c][k] = below->low[c][i];
        if (below->high[c][i] > n->high[c][k]) n->high[c][k] = below->high[c][i];
      }
    }
    edge[c] = n->high[c][k] - n->low[c][k];
  }
  return half_surface(edge);
}

/* Half the surface of the box of all. */
static float root_surface(const node *root)
{
  float edge[3];
  for (int c = 0; c < 3; c++) {
    float low = root->low[c][0], high = root->high[c][0];
    for (int k = 1; k < root->count; k++) {
      low = root->low[c][k] < low ? root->low[c][k] : low;
      high = root->high[c][k] > high ? root->high[c][k] : high;
    }
    edge[c] = high - low;
  }
  return half_surface(edge);
}

/* Boxes of all nodes from those of the items, last node first because children follow their
 * parents. */
static void fit(ct_box_tree *tree, const ct_bounds *boxes)
{
  tree->cost = 0.0;
  if (tree->count == 0) return;
  set_frame(tree, boxes);
  for (int32_t i = tree->node_count; i-- > 0;) {
    // -- Sum the surfaces of all boxes, over that of the whole
    node *n = &tree->nodes[i];
    for (int k = 0; k < n->count; k++) tree->cost += (double)fit_child(tree, boxes, n, k);
    for (int k = n->count; k < WIDTH; k++)
      for (int c = 0; c < 3; c++) n->low[c][k] = n->high[c][k] = NOWHERE;
  }
  tree->cost /= (double)root_surface(&tree->nodes[0]);
}

void ct_box_tree_build(ct_box_tree *tree, const ct_bounds *boxes)
{
  for (int32_t i = 0; i < tree->count; i++) {
    tree->entries[i].item = i;
    for (int c = 0; c < 3; c++)
      tree->entries[i].middle[c] = 0.5 * boxes[i].low[c] + 0.5 * boxes[i].high[c];
  }
  link_nodes(tree);
  fit(tree, boxes);
  tree->cost_built = tree->cost;
  tree->builds++;
}

void ct_box_tree_refit(ct_box_tree *tree, const ct_bounds *boxes)
{
  // -- Rebuild if the boxes have grown by half, relative to the whole
  if (tree->builds > 0) fit(tree, boxes);
  // (eq:tree-cost)
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

/* Sort numbers in ascending order: mostly a few. */
static void sort_items(int32_t *items, int32_t count)
{
  enum { FEW = 32 };
  if (count > FEW) qsort(items, (size_t)count, sizeof *items, compare_items);
  for (int32_t i = 1; count <= FEW && i < count; i++) {
    const int32_t item = items[i];
    int32_t k = i;
    for (; k > 0 && items[k - 1] > item; k--) items[k] = items[k - 1];
    items[k] = item;
  }
}

static int overlap(const ct_bounds *a, const ct_bounds *b)
{
  for (int c = 0; c < 3; c++)
    if (a->low[c] > b->high[c] || b->low[c] > a->high[c]) return 0;
  return 1;
}

/* A coordinate in the tree's frame. Far ones are clamped, which moves no box farther away. */
static float scaled(const ct_box_tree *tree, double x, int c)
{
  double y = (x - tree->origin[c]) * tree->scale;
  return (float)(y > 1e17 ? 1e17 : y < -1e17 ? -1e17 : y);
}

int32_t ct_box_tree_overlaps(const ct_box_tree *tree, const ct_bounds *boxes, const ct_bounds *box,
                             int32_t *items, int32_t capacity)
{
  int32_t stack[STACK], found = 0;
  int depth = 0;
  float low[3], high[3];
  for (int c = 0; c < 3; c++) {
    low[c] = scaled(tree, box->low[c], c);
    high[c] = scaled(tree, box->high[c], c);
  }
  // -- Drop every box that does not overlap, with all boxes below it
  if (tree->count > 0) stack[depth++] = 0;
  while (depth > 0) {
    const node *n = &tree->nodes[stack[--depth]];
    for (int k = 0; k < n->count; k++) {
      int apart = 0;
      for (int c = 0; c < 3; c++) apart |= n->low[c][k] > high[c] || low[c] > n->high[c][k];
      if (apart) continue;
      if (n->child[k] >= 0) {
        stack[depth++] = n->child[k];
      } else if (overlap(&boxes[~n->child[k]], box)) {
        if (found < capacity) items[found] = ~n->child[k];
        found++;
      }
    }
  }
  if (found <= capacity) sort_items(items, found);
  return found;
}

/* A child on the stack with four times the square of its distance. For floats that are not negative
 * the order of the bits as integers is that of the values. */
typedef uint64_t waiting;

static inline waiting wait_of(float square, int32_t child)
{
  uint32_t bits;
  memcpy(&bits, &square, sizeof bits);
  return (waiting)bits << 32 | (uint32_t)child;
}

static inline int32_t child_of(waiting w)
{
  uint32_t bits = (uint32_t)w;
  int32_t child;
  memcpy(&child, &bits, sizeof child);
  return child;
}

static inline void order(waiting *near, waiting *far)
{
  waiting a = *near, b = *far;
  *near = a < b ? a : b;
  *far = a < b ? b : a;
}

/* Push the children within the limit on the stack, the nearest on top; returns the new height.
 * Without branches, which processors could not predict: all four are sorted and written, and each
 * stays only if it counts. */
static inline int push(const node *n, const float square[WIDTH], waiting limit, waiting *stack,
                       int depth)
{
  waiting w[WIDTH];
  for (int k = 0; k < WIDTH; k++) w[k] = wait_of(square[k], n->child[k]);
  order(&w[0], &w[1]);
  order(&w[2], &w[3]);
  order(&w[0], &w[2]);
  order(&w[1], &w[3]);
  order(&w[1], &w[2]);
  for (int k = WIDTH; k-- > 0;) {
    stack[depth] = w[k];
    depth += w[k] <= limit;
  }
  return depth;
}

/* Four times the squared distances of a point from the boxes of a node (eq:box-distance); t + |t|
 * is twice the positive part of t, and needs no branch. */
static inline void squares(const node *n, const float point[3], float square[WIDTH])
{
#pragma omp simd
  for (int k = 0; k < WIDTH; k++) {
    float x = n->low[0][k] - point[0], y = n->low[1][k] - point[1], z = n->low[2][k] - point[2];
    float u = point[0] - n->high[0][k], v = point[1] - n->high[1][k], w = point[2] - n->high[2][k];
    float a = (x + fabsf(x)) + (u + fabsf(u)), b = (y + fabsf(y)) + (v + fabsf(v)),
          c = (z + fabsf(z)) + (w + fabsf(w));
    square[k] = (a * a + b * b) + c * c;
  }
}

/* Limit for the stack: four times the known square in the tree's units, with a margin for the
 * roundings of four products; at most 1e37, which no box reaches. */
static inline waiting limit_of(const ct_box_tree *tree, double square)
{
  double limit = 4.0 * square * (tree->scale * tree->scale) * (1.0 + 1e-5);
  return wait_of((float)(limit < 1e37 ? limit : 1e37), -1);
}

/* Four times the square of a lower bound, rounded down. */
static float bound_of(const ct_box_tree *tree, double square)
{
  double bound = 4.0 * square * (tree->scale * tree->scale) * (1.0 - 1e-6);
  return (float)(bound < 1e36 ? bound : 1e36);
}

void ct_box_tree_visit(const ct_box_tree *tree, const double point[3], double square,
                       ct_box_visit *visit, ct_box_visit *bound, void *user)
{
  waiting stack[STACK];
  int depth = 0;
  float p[3], d[WIDTH];
  waiting limit = limit_of(tree, square);
  for (int c = 0; c < 3; c++) p[c] = scaled(tree, point[c], c);
  if (tree->count > 0) stack[depth++] = wait_of(0.0f, 0);
  while (depth > 0) {
    // -- Leave out every box that is farther than the best item (eq:box-distance)
    waiting next = stack[--depth];
    int32_t child = child_of(next);
    if (next > limit) continue;
    if (child < 0) {
      limit = limit_of(tree, visit(user, ~child));
      continue;
    }
    const node *n = &tree->nodes[child];
    squares(n, p, d);
    for (int k = 0; bound != NULL && k < n->count; k++)
      if (n->child[k] < 0 && wait_of(d[k], 0) <= limit)
        d[k] = bound_of(tree, bound(user, ~n->child[k]));
    depth = push(n, d, limit, stack, depth);
  }
}
