/* A cut into pieces by coordinates. */
#include "piece.h"

#include "../base/error.h"

#include <math.h>
#include <stdlib.h>

/* The centre of an element, and its number and weight. */
typedef struct item {
  double x[3], weight;
  int64_t element;
} item;

static int compare(const item *a, const item *b, int axis)
{
  if (a->x[axis] != b->x[axis]) return a->x[axis] < b->x[axis] ? -1 : 1;
  return (a->element > b->element) - (a->element < b->element);
}

static int along_x(const void *a, const void *b) { return compare(a, b, 0); }
static int along_y(const void *a, const void *b) { return compare(a, b, 1); }
static int along_z(const void *a, const void *b) { return compare(a, b, 2); }

/* The axis of the longest edge of the box around some centres; of edges that are equal but for
 * rounding the last one, so that a mesh with rows along x keeps them whole. */
static int longest(const item *items, int64_t count)
{
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  int axis = 0;
  for (int64_t i = 0; i < count; i++)
    for (int c = 0; c < 3; c++) {
      low[c] = fmin(low[c], items[i].x[c]);
      high[c] = fmax(high[c], items[i].x[c]);
    }
  for (int c = 1; c < 3; c++)
    if (high[c] - low[c] >= (1.0 - 1e-9) * (high[axis] - low[axis])) axis = c;
  return axis;
}

/* Give some items to the pieces first ... first + count - 1. Unless they are null, write their
 * owners, and the planes behind all pieces but the last one. */
static void bisect(item *items, int64_t item_count, int32_t first, int32_t count, int32_t *owners,
                   ct_piece_plane *planes)
{
  static int (*const ALONG[3])(const void *, const void *) = {along_x, along_y, along_z};
  while (count > 1) {
    const int32_t lower = count / 2;
    const int axis = longest(items, item_count);
    double all = 0.0, some = 0.0;
    int64_t end = 0;
    qsort(items, (size_t)item_count, sizeof *items, ALONG[axis]);
    for (int64_t i = 0; i < item_count; i++) all += items[i].weight;
    // -- The lower pieces get their part of the weight (eq:piece-bisection)
    while (end < item_count && some + 0.5 * items[end].weight < all * lower / count)
      some += items[end++].weight;
    if (planes != NULL)
      planes[first + lower - 1] =
          (ct_piece_plane){end < item_count ? items[end].x[axis] : INFINITY, axis};
    bisect(items, end, first, lower, owners, planes);
    items += end, item_count -= end, first += lower, count -= lower;
  }
  for (int64_t i = 0; owners != NULL && i < item_count; i++) owners[items[i].element] = first;
}

/* The centres of the elements of a body, the first of which has the number `first`. */
static void enter(const ct_mesh *mesh, int64_t first, const double *weights, item *items)
{
  const int32_t per = ct_brick_node_count(mesh->kind);
  for (int32_t e = 0; e < mesh->element_count; e++) {
    item *to = &items[first + e];
    to->element = first + e;
    to->weight = weights == NULL ? 1.0 : weights[first + e];
    for (int c = 0; c < 3; c++) to->x[c] = 0.0;
    for (int a = 0; a < 8; a++)
      for (int c = 0; c < 3; c++)
        to->x[c] += mesh->nodes[3 * (int64_t)mesh->elements[(int64_t)per * e + a] + c];
  }
}

ct_status ct_piece_bisect(const ct_problem *problem, int32_t count, const double *weights,
                          int32_t *owners, ct_error *error)
{
  int64_t all = 0;
  if (problem == NULL || owners == NULL) return CT_REFUSE_NULL(error);
  if (count < 1) return CT_REFUSE(error, "piece: a model has at least 1 piece, not %d", (int)count);
  for (int32_t b = 0; b < problem->body_count; b++) all += problem->bodies[b].mesh->element_count;
  for (int64_t e = 0; weights != NULL && e < all; e++)
    if (!(weights[e] > 0.0) || !isfinite(weights[e]))
      return CT_REFUSE(error, "piece: the weight of element %lld must be positive, not %g",
                       (long long)e, weights[e]);
  item *items = ct_allocate((size_t)all, sizeof *items);
  if (items == NULL) return CT_NO_MEMORY(error, "the pieces");
  all = 0;
  for (int32_t b = 0; b < problem->body_count; b++) {
    enter(problem->bodies[b].mesh, all, weights, items);
    all += problem->bodies[b].mesh->element_count;
  }
  bisect(items, all, 0, count, owners, NULL);
  ct_release(items);
  return CT_OK;
}

ct_status ct_piece_divide(int64_t count, const double *places, int32_t pieces,
                          ct_piece_plane *planes)
{
  item *items = ct_allocate((size_t)count, sizeof *items);
  if (items == NULL) return CT_ERROR_MEMORY;
  for (int64_t i = 0; i < count; i++) {
    items[i].element = i, items[i].weight = 1.0;
    for (int c = 0; c < 3; c++) items[i].x[c] = places[3 * i + c];
  }
  bisect(items, count, 0, pieces, NULL, planes);
  ct_release(items);
  return CT_OK;
}

int32_t ct_piece_of_face(const ct_piece *piece, int32_t count, const int32_t *nodes)
{
  double middle[3] = {0.0};
  for (int32_t a = 0; a < count; a++)
    for (int c = 0; c < 3; c++)
      middle[c] += piece->problem->reference[3 * (int64_t)nodes[a] + c] / count;
  int32_t first = 0;
  for (int32_t left = piece->def.count, lower; left > 1;) {
    lower = left / 2;
    const ct_piece_plane *plane = &piece->planes[first + lower - 1];
    const int below = middle[plane->axis] < plane->at;
    first += below ? 0 : lower;
    left = below ? lower : left - lower;
  }
  return first;
}
