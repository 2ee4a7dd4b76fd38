/* Meshes with arbitrary numbers: rows of elements are found by their shared faces. */
#include "order.h"

#include <math.h>
#include <string.h>

/* Corners of the sides on which ξ, η, ζ are -1, and of the opposite ones. */
static const int LOW[3][4] = {{0, 3, 4, 7}, {0, 1, 4, 5}, {0, 1, 2, 3}},
                 HIGH[3][4] = {{1, 2, 5, 6}, {3, 2, 7, 6}, {4, 5, 6, 7}};

/* A walk over all elements of a mesh. */
typedef struct walk {
  ct_pool pool;
  const ct_mesh *mesh;
  /* The neighbours at the negative and the positive side along each direction, numbered in the same
   * way; -1: none. */
  int32_t *next[3], *previous[3];
  int row, sheet; /* the directions along which a body is longest, and shortest */
  /* Elements of node n, at[begin[n]] ... at[begin[n + 1] - 1]. */
  int32_t *begin, *at;
  /* The elements in their new order so far, and whether each is in it. */
  int32_t *order, count;
  char *taken;
} walk;

static const int32_t *nodes_of(const walk *w, int32_t e)
{
  return &w->mesh->elements[8 * (size_t)e];
}

/* List the elements of each node. */
static void list_elements(walk *w)
{
  int32_t nodes = w->mesh->node_count;
  for (int pass = 0; pass < 2; pass++) {
    for (int32_t e = 0; e < w->mesh->element_count; e++)
      for (int a = 0; a < 8; a++) {
        int32_t n = nodes_of(w, e)[a];
        if (pass == 0) w->begin[n + 2]++;
        else w->at[w->begin[n + 1]++] = e;
      }
    for (int32_t n = 0; pass == 0 && n < nodes; n++) w->begin[n + 2] += w->begin[n + 1];
  }
}

/* The element whose negative side along a direction is the positive side of another one, corner by
 * corner; -1: none. */
static int32_t behind(const walk *w, int32_t e, int d)
{
  const int32_t *own = nodes_of(w, e);
  int32_t n = own[HIGH[d][0]];
  for (int32_t k = w->begin[n]; k < w->begin[n + 1]; k++) {
    const int32_t *other = nodes_of(w, w->at[k]);
    int same = 1;
    for (int i = 0; i < 4; i++) same = same && other[LOW[d][i]] == own[HIGH[d][i]];
    if (same && w->previous[d][w->at[k]] < 0) return w->at[k];
  }
  return -1;
}

/* Find the neighbours along each direction, and the directions along which a body is longest and
 * shortest. If fewer than half of the elements have a neighbour, rows would separate elements that
 * are together now. */
static void find_neighbours(walk *w)
{
  int32_t count = w->mesh->element_count, found[3] = {0, 0, 0};
  for (int d = 0; d < 3; d++) {
    memset(w->previous[d], -1, (size_t)count * sizeof(int32_t));
    for (int32_t e = 0; e < count; e++) {
      int32_t next = w->next[d][e] = behind(w, e, d);
      if (next >= 0) w->previous[d][next] = e;
      found[d] += next >= 0;
    }
    if (2 * found[d] < count) {
      memset(w->next[d], -1, (size_t)count * sizeof(int32_t));
      memset(w->previous[d], -1, (size_t)count * sizeof(int32_t));
    }
    if (found[d] > found[w->row]) w->row = d;
  }
  w->sheet = w->row == 0 ? 1 : 0;
  for (int d = 0; d < 3; d++)
    if (d != w->row && found[d] < found[w->sheet]) w->sheet = d;
}

/* The first element that can be reached backwards from one that is not in the order yet. */
static int32_t go_back(const walk *w, const int32_t *previous, int32_t e)
{
  int32_t at = e;
  while (previous[at] >= 0 && previous[at] != e && !w->taken[previous[at]]) at = previous[at];
  return at;
}

/* Add the row of an element, and the rows beside it in its sheet. */
static void take_sheet(walk *w, int32_t e)
{
  const int32_t *beside = w->next[w->sheet], *along = w->next[w->row];
  for (e = go_back(w, w->previous[w->sheet], e); e >= 0 && !w->taken[e]; e = beside[e])
    for (int32_t i = go_back(w, w->previous[w->row], e); i >= 0 && !w->taken[i]; i = along[i]) {
      w->order[w->count++] = i;
      w->taken[i] = 1;
    }
}

/* Add the sheets next to existing ones, one after another, from that of an element on. */
static void take_all(walk *w, int32_t start)
{
  int32_t done = 0;
  w->count = 0;
  memset(w->taken, 0, (size_t)w->mesh->element_count);
  take_sheet(w, start);
  for (int32_t e = 0; w->count < w->mesh->element_count; e++) {
    for (; done < w->count; done++)
      for (int a = 0; a < 8; a++) {
        int32_t n = nodes_of(w, w->order[done])[a];
        for (int32_t k = w->begin[n]; k < w->begin[n + 1]; k++)
          if (!w->taken[w->at[k]]) take_sheet(w, w->at[k]);
      }
    // A part of the body that touches no other part
    if (!w->taken[e]) take_sheet(w, e);
  }
}

/* Number the nodes from the last one down, line by line along the rows, in the order of their last
 * elements (eq:order-rows). Nodes without elements, as in a piece, have no number. */
static void number_nodes(const walk *w, ct_order *order)
{
  int32_t next = w->mesh->node_count;
  for (int32_t n = 0; n < w->mesh->node_count; n++) order->inside[n] = -1;
  for (int32_t last = w->count, first; last > 0; last = first) {
    for (first = last - 1;
         first > 0 && w->previous[w->row][w->order[first]] == w->order[first - 1];)
      first--;
    for (int k = 0; k < 8; k++)
      for (int32_t i = last; i-- > first;) {
        int corner = k % 2 ? LOW[w->row][k / 2] : HIGH[w->row][k / 2];
        int32_t *number = &order->inside[nodes_of(w, w->order[i])[corner]];
        if (*number < 0) *number = --next;
      }
  }
  for (int32_t n = 0; n < w->mesh->node_count; n++)
    if (order->inside[n] >= 0) order->inside[n] -= next;
  order->mesh.node_count -= next;
}

/* Write the mesh with its new numbers. */
static void write_mesh(const walk *w, ct_order *order)
{
  ct_mesh *mesh = &order->mesh;
  for (int32_t n = 0; n < w->mesh->node_count; n++) {
    int32_t at = order->inside[n];
    if (at < 0) continue;
    order->user[at] = n;
    memcpy(&mesh->nodes[3 * (size_t)at], &w->mesh->nodes[3 * (size_t)n], 3 * sizeof(double));
  }
  for (int32_t e = 0; e < mesh->element_count; e++) {
    const int32_t *own = nodes_of(w, w->order[e]);
    order->element[w->order[e]] = e;
    for (int32_t a = 0; a < 8; a++)
      mesh->elements[8 * (size_t)e + (size_t)a] = order->inside[own[a]];
  }
}

/* The element whose first node is farthest in the direction of negative x, y and z: a corner of a
 * box. */
static int32_t find_corner(const ct_mesh *mesh)
{
  int32_t corner = 0;
  double lowest = INFINITY;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    const double *x = &mesh->nodes[3 * (size_t)mesh->elements[8 * (size_t)e]];
    double at = (x[0] + x[1]) + x[2];
    if (at < lowest) corner = e;
    lowest = at < lowest ? at : lowest;
  }
  return corner;
}

ct_status ct_order_create(const ct_mesh *mesh, ct_order **out)
{
  size_t nodes = (size_t)mesh->node_count, elements = (size_t)mesh->element_count;
  walk w = {.mesh = mesh};
  for (int d = 0; d < 3; d++) {
    w.next[d] = ct_pool_take(&w.pool, elements, sizeof(int32_t));
    w.previous[d] = ct_pool_take(&w.pool, elements, sizeof(int32_t));
  }
  w.begin = ct_pool_take(&w.pool, nodes + 2, sizeof *w.begin);
  w.at = ct_pool_take(&w.pool, 8 * elements, sizeof *w.at);
  w.order = ct_pool_take(&w.pool, elements, sizeof *w.order);
  w.taken = ct_pool_take(&w.pool, elements, sizeof *w.taken);
  ct_order *order = *out = ct_allocate(1, sizeof *order);
  if (order != NULL) {
    ct_pool *pool = &order->pool;
    order->given = mesh;
    order->mesh = *mesh;
    order->mesh.nodes = ct_pool_take(pool, 3 * nodes, sizeof(double));
    order->mesh.elements = ct_pool_take(pool, 8 * elements, sizeof(int32_t));
    order->user = ct_pool_take(pool, nodes, sizeof *order->user);
    order->inside = ct_pool_take(pool, nodes, sizeof *order->inside);
    order->element = ct_pool_take(pool, elements, sizeof *order->element);
  }
  int there = order != NULL && !w.pool.failed && !order->pool.failed;
  if (there) {
    list_elements(&w);
    find_neighbours(&w);
    take_all(&w, find_corner(mesh));
    number_nodes(&w, order);
    write_mesh(&w, order);
  }
  ct_pool_empty(&w.pool);
  return there ? CT_OK : CT_ERROR_MEMORY;
}

void ct_order_free(ct_order *order) { ct_pool_free(order); }
