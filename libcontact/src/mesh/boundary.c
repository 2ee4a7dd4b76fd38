/* The outer faces of a mesh: those that belong to one element only. */
#include "../base/memory.h"
#include "mesh_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct side {
  int32_t corner[4]; /* ascending, so that both owners of an inner face agree */
  int32_t element;
  int32_t side;
} side;

static int compare_corners(const void *a, const void *b)
{
  const side *p = a, *q = b;
  for (int i = 0; i < 4; i++)
    if (p->corner[i] != q->corner[i]) return p->corner[i] < q->corner[i] ? -1 : 1;
  return 0;
}

static int compare_places(const void *a, const void *b)
{
  const side *p = a, *q = b;
  if (p->element != q->element) return p->element < q->element ? -1 : 1;
  return (p->side > q->side) - (p->side < q->side);
}

static side side_of(const int32_t node[8], int32_t element, int number)
{
  side s = {{0, 0, 0, 0}, element, number};
  for (int i = 0; i < 4; i++) {
    int j = i;
    for (; j > 0 && s.corner[j - 1] > node[i]; j--) s.corner[j] = s.corner[j - 1];
    s.corner[j] = node[i];
  }
  return s;
}

/* The faces that are asked for: those within `tolerance` of x[axis] = value; axis -1: all. */
typedef struct plane {
  int axis;
  double value, tolerance;
} plane;

/* Whether all nodes of a side lie in the plane; writes their numbers, shape (4 or 8). */
static int is_in(const ct_mesh *mesh, int32_t element, int number, const plane *in, int32_t node[8])
{
  int local[8], inside = 1, per_face = mesh->kind == CT_HEX8 ? 4 : 8;
  size_t per = (size_t)ct_brick_node_count(mesh->kind);
  ct_brick_face(mesh->kind, number, local);
  for (int a = 0; a < per_face; a++) {
    node[a] = mesh->elements[(size_t)element * per + (size_t)local[a]];
    if (in->axis >= 0)
      inside &=
          fabs(mesh->nodes[3 * (size_t)node[a] + (size_t)in->axis] - in->value) <= in->tolerance;
  }
  return inside;
}

/* Write the sides in the plane, of inner faces both; answers how many. Null `sides`: only count. */
static size_t list_sides(const ct_mesh *mesh, const plane *in, side *sides)
{
  size_t count = 0;
  int32_t node[8];
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int number = 0; number < 6; number++) {
      if (!is_in(mesh, e, number, in, node)) continue;
      if (sides != NULL) sides[count] = side_of(node, e, number);
      count++;
    }
  return count;
}

/* The sides in the plane that occur once, by element and side; `*count` of them, or null without
 * memory. Both sides of an inner face are in a plane, or none is. */
static side *outer_sides(const ct_mesh *mesh, const plane *in, int32_t *count)
{
  size_t total = list_sides(mesh, in, NULL), kept = 0;
  side *sides = ct_allocate(total + 1, sizeof *sides);
  if (sides == NULL) return NULL;
  list_sides(mesh, in, sides);
  qsort(sides, total, sizeof *sides, compare_corners);
  for (size_t i = 0; i < total;) {
    size_t next = i + 1;
    while (next < total && compare_corners(&sides[i], &sides[next]) == 0) next++;
    if (next == i + 1) sides[kept++] = sides[i];
    i = next;
  }
  qsort(sides, kept, sizeof *sides, compare_places);
  *count = (int32_t)kept;
  return sides;
}

static double plane_tolerance(const ct_mesh *mesh)
{
  double low[3], high[3], size = 0.0;
  ct_mesh_bounds(mesh, low, high);
  for (int d = 0; d < 3; d++) size = high[d] - low[d] > size ? high[d] - low[d] : size;
  return 1e-9 * size;
}

/* Whether there is a mesh and its elements have nodes. */
static int is_whole(const ct_mesh *mesh)
{
  int64_t entries = (int64_t)mesh->element_count * ct_brick_node_count(mesh->kind);
  if (entries < 1 || mesh->nodes == NULL || mesh->elements == NULL) return 0;
  for (int64_t i = 0; i < entries; i++)
    if (mesh->elements[i] < 0 || mesh->elements[i] >= mesh->node_count) return 0;
  return 1;
}

/* Copy the outer faces in the plane. */
static int32_t collect(const ct_mesh *mesh, plane in, int32_t *faces, int32_t *owners)
{
  int32_t count = 0;
  size_t per_face = mesh->kind == CT_HEX8 ? 4 : 8;
  if (!is_whole(mesh)) return -CT_ERROR_ARGUMENT;
  side *sides = outer_sides(mesh, &in, &count);
  if (sides == NULL) return -CT_ERROR_MEMORY;
  for (int32_t i = 0; i < count; i++) {
    int32_t node[8];
    is_in(mesh, sides[i].element, sides[i].side, &in, node);
    if (faces != NULL) memcpy(&faces[(size_t)i * per_face], node, per_face * sizeof *faces);
    if (owners != NULL) owners[i] = sides[i].element;
  }
  ct_release(sides);
  return count;
}

int32_t ct_mesh_plane_faces(const ct_mesh *mesh, int axis, double value, int32_t *faces,
                            int32_t *owners)
{
  if (mesh == NULL || mesh->nodes == NULL) return -CT_ERROR_ARGUMENT;
  if (axis < 0 || axis > 2) return 0;
  return collect(mesh, (plane){axis, value, plane_tolerance(mesh)}, faces, owners);
}

int32_t ct_mesh_outer_faces(const ct_mesh *mesh, int32_t *faces, int32_t *owners)
{
  return mesh == NULL ? -CT_ERROR_ARGUMENT : collect(mesh, (plane){-1, 0.0, 0.0}, faces, owners);
}

int32_t ct_mesh_plane_nodes(const ct_mesh *mesh, int axis, double value, int32_t *nodes)
{
  if (mesh == NULL || axis < 0 || axis > 2) return 0;
  double tolerance = plane_tolerance(mesh);
  int32_t count = 0;
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (fabs(mesh->nodes[3 * (size_t)i + (size_t)axis] - value) <= tolerance) {
      if (nodes != NULL) nodes[count] = i;
      count++;
    }
  return count;
}
