#include <libcontact/mesh.h>
#include <libcontact/shape.h>

#include "../base/error.h"
#include "../base/memory.h"
#include "mesh_internal.h"

#include <math.h>
#include <stdlib.h>

/* Bricks about a core: a cube or square of cells, on whose sides blocks of layers stand up to a
 * sphere or circle. All points lie on one lattice of half cells. The core fills its middle, and the
 * block on a side of the core goes straight on to the end of the lattice, as the arms of a cross.
 * Neighbouring arms are glued: their points at the same point of the core's surface and in the same
 * layer are one. */
typedef struct blocks {
  int axes;        /* arms along x and y, or along x, y and z */
  int hollow;      /* there is no core, only its surface */
  int32_t core[3]; /* cells */
  int32_t layers;  /* of an arm */
  double centre[3], radius[2], width;
} blocks;

/* Where a point of the lattice lies. */
typedef struct spot {
  int32_t base[3]; /* nearest point of the core, in half cells from its middle */
  int32_t layer;   /* half layers from there; in a corner between arms the largest of them */
  int axis;        /* of the first arm on which `base` lies; -1: inside the core */
  int side;        /* -1 or 1, which of its ends */
} spot;

static int32_t half_points(const blocks *b, int d)
{
  return b->core[d] + (d < b->axes ? 2 * b->layers : 0);
}

/* Lattice coordinates run from the middle, -half_points to half_points. */
static spot spot_of(const blocks *b, const int32_t at[3])
{
  spot s = {.axis = -1};
  for (int d = 0; d < 3; d++) {
    int32_t n = b->core[d], beyond = abs(at[d]) - n;
    s.base[d] = at[d] > n ? n : at[d] < -n ? -n : at[d];
    if (beyond > s.layer) s.layer = beyond;
    if (s.axis < 0 && d < b->axes && beyond >= 0) s.axis = d, s.side = at[d] < 0 ? -1 : 1;
  }
  return s;
}

/* The point of the first arm that stands for all points glued to it; every node has one. */
static void representative(const blocks *b, const int32_t at[3], int32_t out[3])
{
  spot s = spot_of(b, at);
  for (int d = 0; d < 3; d++) out[d] = s.base[d];
  if (s.axis >= 0) out[s.axis] += s.side * s.layer;
}

static int64_t key_of(const blocks *b, const int32_t at[3])
{
  int64_t key = 0;
  for (int d = 2; d >= 0; d--)
    key = key * (2 * (int64_t)half_points(b, d) + 1) + at[d] + half_points(b, d);
  return key;
}

/* Coordinates of a node relative to the centre. */
static void place(const blocks *b, const int32_t at[3], double x[3])
{
  spot s = spot_of(b, at);
  double u[3] = {0.0, 0.0, 0.0}, others[3];
  for (int d = 0; d < b->axes; d++) {
    double n = b->core[d], q = s.base[d];
    u[d] = 11.0 * q * n / (14.0 * n * n - 3.0 * q * q); // (eq:mesh-spread)
  }
  // Of two squares, whose sum has no order.
  for (int d = 0; d < 3; d++) {
    double v = u[(d + 1) % 3], w = u[(d + 2) % 3];
    others[d] = v * v + w * w;
  }
  double length = s.axis < 0 ? 1.0 : sqrt(1.0 + others[s.axis]), m = 2.0 * b->layers;
  for (int d = 0; d < b->axes; d++) {
    // -- From the core or the inner sphere to the outer one (eq:mesh-blocks)
    double out = u[d] / length, core = b->radius[1] * u[d] * (10.0 - others[d]) / 20.0,
           in = b->hollow ? b->radius[0] * out : core;
    x[d] = ((m - s.layer) * in + s.layer * (b->radius[1] * out)) / m;
  }
  if (b->axes == 2) x[2] = (double)at[2] * b->width / (2.0 * b->core[2]);
}

/* Count the nodes, and write their keys, which ascend, and coordinates; both may be null. `odd` is
 * the largest number of odd coordinates, counted from the end of the lattice: 0 for corners. */
static int64_t list_nodes(const blocks *b, int odd, int64_t *keys, double *nodes)
{
  int32_t h[3], at[3], own[3];
  int64_t count = 0;
  for (int d = 0; d < 3; d++) h[d] = half_points(b, d);
  for (at[2] = -h[2]; at[2] <= h[2]; at[2]++)
    for (at[1] = -h[1]; at[1] <= h[1]; at[1]++)
      for (at[0] = -h[0]; at[0] <= h[0]; at[0]++) {
        if (b->hollow && spot_of(b, at).axis < 0) {
          at[0] = b->core[0] - 1;
          continue;
        }
        representative(b, at, own);
        int is_own = own[0] == at[0] && own[1] == at[1] && own[2] == at[2];
        if (!is_own || (at[0] + h[0]) % 2 + (at[1] + h[1]) % 2 + (at[2] + h[2]) % 2 > odd) continue;
        if (keys != NULL) keys[count] = key_of(b, at);
        if (nodes != NULL) {
          double *x = &nodes[3 * count];
          place(b, at, x);
          for (int d = 0; d < 3; d++) x[d] += b->centre[d];
        }
        count++;
      }
  return count;
}

static int32_t find_node(const int64_t *keys, int64_t count, int64_t key)
{
  int64_t low = 0, high = count - 1;
  while (low < high) {
    int64_t middle = (low + high) / 2;
    if (keys[middle] < key) low = middle + 1;
    else high = middle;
  }
  return (int32_t)low;
}

/* A cell with the middle `at` belongs to the core or to one arm. */
static int is_cell(const blocks *b, const int32_t at[3])
{
  int outside = 0;
  for (int d = 0; d < 3; d++) outside += abs(at[d]) > b->core[d];
  return outside == 1 || (outside == 0 && !b->hollow);
}

static void list_elements(const blocks *b, const int64_t *keys, ct_mesh *mesh)
{
  int per = ct_brick_node_count(mesh->kind);
  int32_t h[3], at[3], corner[3], own[3], *next = mesh->elements;
  for (int d = 0; d < 3; d++) h[d] = half_points(b, d) - 1;
  for (at[2] = -h[2]; at[2] <= h[2]; at[2] += 2)
    for (at[1] = -h[1]; at[1] <= h[1]; at[1] += 2)
      for (at[0] = -h[0]; at[0] <= h[0]; at[0] += 2)
        for (int a = 0; a < per && is_cell(b, at); a++) {
          double xi[3];
          ct_brick_reference(mesh->kind, a, xi);
          for (int d = 0; d < 3; d++) corner[d] = at[d] + (int32_t)xi[d];
          representative(b, corner, own);
          *next++ = find_node(keys, mesh->node_count, key_of(b, own));
        }
}

static ct_status create_blocks(ct_brick_kind kind, const blocks *b, ct_mesh **out, ct_error *error)
{
  int64_t n = b->core[0], m = b->core[2], odd = ct_brick_facts_of(kind)->cell_nodes > 1,
          side = b->axes == 3 ? 6 * n * n : 4 * n * m,
          elements = side * b->layers + (b->hollow ? 0 : n * n * m),
          nodes = elements > INT32_MAX / 64 ? elements : list_nodes(b, (int)odd, NULL, NULL);
  ct_status status = ct_mesh_allocate(kind, nodes, elements, out, error);
  if (status != CT_OK) return status;
  int64_t *keys = ct_allocate((size_t)nodes, sizeof *keys);
  if (keys == NULL) {
    ct_mesh_free(*out);
    *out = NULL;
    return CT_NO_MEMORY(error, "a mesh of %lld nodes", (long long)nodes);
  }
  (void)list_nodes(b, (int)odd, keys, (*out)->nodes);
  list_elements(b, keys, *out);
  ct_release(keys);
  return CT_OK;
}

/* Refuse impossible members; `what` names the shape. */
static ct_status check_blocks(const char *what, ct_brick_kind kind, const blocks *b, int32_t around,
                              ct_error *error)
{
  if (ct_brick_node_count(kind) == 0)
    return CT_REFUSE(error, "%s: there is no brick of the kind %d", what, (int)kind);
  if (!(b->radius[0] >= 0.0 && b->radius[1] > b->radius[0]) || !isfinite(1e6 * b->radius[1]))
    return CT_REFUSE(error, "%s: the outer radius must be above the inner one, %g, not %g", what,
                     b->radius[0], b->radius[1]);
  if (b->axes == 2 && (!(b->width > 0.0) || !isfinite(1e6 * b->width)))
    return CT_REFUSE(error, "%s: width must be positive and finite, not %g", what, b->width);
  for (int d = 0; d < 3; d++)
    if (!isfinite(b->centre[d]))
      return CT_REFUSE(error, "%s: centre %c must be finite, not %g", what, "xyz"[d], b->centre[d]);
  if (b->layers < 1 || b->layers > 1000000)
    return CT_REFUSE(error, "%s: cells along the radius must be 1 to 1000000, not %d", what,
                     (int)b->layers);
  if (around < 4 || around > 1000000 || around % 4 != 0)
    return CT_REFUSE(error, "%s: cells around must be a multiple of 4 up to 1000000, not %d", what,
                     (int)around);
  if (b->core[2] < 1 || b->core[2] > 1000000)
    return CT_REFUSE(error, "%s: cells across must be 1 to 1000000, not %d", what, (int)b->core[2]);
  return CT_OK;
}

ct_status ct_mesh_create_cylinder(ct_brick_kind kind, const ct_cylinder *cylinder, ct_mesh **mesh,
                                  ct_error *error)
{
  if (cylinder == NULL || mesh == NULL) return CT_REFUSE_NULL(error);
  const double *c = cylinder->centre;
  const int32_t *cells = cylinder->cells;
  blocks b = {2,
              0,
              {cells[1] / 4, cells[1] / 4, cells[2]},
              cells[0],
              {c[0], c[1], c[2]},
              {0.0, cylinder->radius},
              cylinder->width};
  ct_status status = check_blocks("cylinder", kind, &b, cells[1], error);
  return status == CT_OK ? create_blocks(kind, &b, mesh, error) : status;
}

ct_status ct_mesh_create_ball(ct_brick_kind kind, const ct_ball *ball, ct_mesh **mesh,
                              ct_error *error)
{
  if (ball == NULL || mesh == NULL) return CT_REFUSE_NULL(error);
  const double *c = ball->centre, *r = ball->radius;
  int32_t n = ball->cells[1] / 4;
  blocks b = {3, r[0] > 0.0, {n, n, n}, ball->cells[0], {c[0], c[1], c[2]}, {r[0], r[1]}, 0.0};
  ct_status status = check_blocks("ball", kind, &b, ball->cells[1], error);
  return status == CT_OK ? create_blocks(kind, &b, mesh, error) : status;
}
