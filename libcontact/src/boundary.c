/* The outer faces of a mesh: those that belong to one element only. */
#include <contact/mesh.h>

#include "memory.h"

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

static side side_of(const ct_mesh *mesh, int32_t element, int number)
{
  size_t per = (size_t)ct_brick_node_count(mesh->kind);
  int local[8];
  side s = {{0, 0, 0, 0}, element, number};
  ct_brick_face(mesh->kind, number, local);
  for (int i = 0; i < 4; i++) {
    int32_t node = mesh->elements[(size_t)element * per + (size_t)local[i]];
    int j = i;
    for (; j > 0 && s.corner[j - 1] > node; j--) s.corner[j] = s.corner[j - 1];
    s.corner[j] = node;
  }
  return s;
}

/* All sides that occur once, by element and side; `*count` of them, or null without memory. */
static side *outer_sides(const ct_mesh *mesh, int32_t *count)
{
  size_t total = 6 * (size_t)mesh->element_count, kept = 0;
  side *sides = ct_allocate(total, sizeof *sides);
  if (sides == NULL) return NULL;
  for (size_t i = 0; i < total; i++) sides[i] = side_of(mesh, (int32_t)(i / 6), (int)(i % 6));
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

/* Copy the outer faces whose nodes all lie within `tolerance` of x[axis] = value; axis -1 takes all. */
static int32_t collect(const ct_mesh *mesh, int axis, double value, double tolerance, int32_t *faces, int32_t *owners)
{
  int32_t sides_count = 0, count = 0;
  size_t per = (size_t)ct_brick_node_count(mesh->kind);
  size_t per_face = mesh->kind == CT_HEX8 ? 4 : 8;
  if (!is_whole(mesh)) return -CT_ERROR_ARGUMENT;
  side *sides = outer_sides(mesh, &sides_count);
  if (sides == NULL) return -CT_ERROR_MEMORY;
  for (int32_t i = 0; i < sides_count; i++) {
    int local[8], inside = 1;
    int32_t node[8];
    ct_brick_face(mesh->kind, sides[i].side, local);
    for (size_t a = 0; a < per_face; a++) {
      node[a] = mesh->elements[(size_t)sides[i].element * per + (size_t)local[a]];
      if (axis >= 0) inside &= fabs(mesh->nodes[3 * (size_t)node[a] + (size_t)axis] - value) <= tolerance;
    }
    if (!inside) continue;
    if (faces != NULL) memcpy(&faces[(size_t)count * per_face], node, per_face * sizeof *faces);
    if (owners != NULL) owners[count] = sides[i].element;
    count++;
  }
  ct_release(sides);
  return count;
}

int32_t ct_mesh_plane_faces(const ct_mesh *mesh, int axis, double value, int32_t *faces, int32_t *owners)
{
  if (mesh == NULL) return -CT_ERROR_ARGUMENT;
  if (axis < 0 || axis > 2) return 0;
  return collect(mesh, axis, value, plane_tolerance(mesh), faces, owners);
}

int32_t ct_mesh_outer_faces(const ct_mesh *mesh, int32_t *faces, int32_t *owners)
{
  return mesh == NULL ? -CT_ERROR_ARGUMENT : collect(mesh, -1, 0.0, 0.0, faces, owners);
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
