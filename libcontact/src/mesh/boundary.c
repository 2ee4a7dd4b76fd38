/* The outer faces of a mesh: those that belong to one element only. */
#include "../base/error.h"
#include "../base/memory.h"
#include "corners.h"
#include "mesh_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct side {
  int32_t corner[4]; /* ct_corners_of, so that both owners of an inner face agree */
  int32_t element;
  int32_t number; /* of the side of the element; -1: another element also has the face */
} side;

static side side_of(const int32_t node[8], int32_t element, int number)
{
  side s = {{-1, -1, -1, -1}, element, number};
  ct_corners_of(node, 4, s.corner);
  return s;
}

/* Number of nodes of a side. */
static int per_side(const ct_mesh *mesh)
{
  return ct_face_node_count(ct_brick_face_kind(mesh->kind));
}

/* Local numbers of the nodes of all sides. */
static void list_local(const ct_mesh *mesh, int local[6][8])
{
  for (int number = 0; number < 6; number++) ct_brick_face(mesh->kind, number, local[number]);
}

/* Node numbers of a side of an element, shape (4 or 8). */
static void side_nodes(const ct_mesh *mesh, int local[6][8], int32_t element, int number,
                       int32_t node[8])
{
  size_t per = (size_t)ct_brick_node_count(mesh->kind);
  int count = per_side(mesh);
  for (int a = 0; a < count; a++)
    node[a] = mesh->elements[(size_t)element * per + (size_t)local[number][a]];
}

/* Write the sides whose nodes are all `in`, for inner faces both, and no side without area; returns
 * their number. Null `sides`: only count. */
static size_t list_sides(const ct_mesh *mesh, int local[6][8], const unsigned char *in, side *sides)
{
  int per = ct_brick_node_count(mesh->kind), per_face = per_side(mesh);
  const int32_t *n = mesh->elements;
  size_t count = 0;
  for (int32_t e = 0; e < mesh->element_count; e++, n += per) {
    // Each side has one of two opposite corners.
    if (!in[n[0]] && !in[n[6]]) continue;
    for (int number = 0; number < 6; number++) {
      int inside = 1;
      for (int a = 0; inside && a < per_face; a++) inside = in[n[local[number][a]]];
      if (!inside) continue;
      int32_t node[8];
      side_nodes(mesh, local, e, number, node);
      const side found = side_of(node, e, number);
      if (found.corner[1] < 0) continue; // collapsed to an edge, as in a wedge
      if (sides != NULL) sides[count] = found;
      count++;
    }
  }
  return count;
}

/* Mark the sides that occur more than once. */
static ct_status mark_inner(side *sides, size_t count)
{
  ct_corner_list list;
  if (ct_corner_list_open(&list, sides[0].corner, 4, sizeof *sides / sizeof(int32_t), count) !=
      CT_OK)
    return CT_ERROR_MEMORY;
  for (size_t i = 0; i < count; i++) {
    const int32_t k = ct_corner_list_enter(&list, (int32_t)i);
    if (k >= 0) sides[i].number = sides[k].number = -1;
  }
  ct_corner_list_close(&list);
  return CT_OK;
}

static double plane_tolerance(const ct_mesh *mesh)
{
  double low[3], high[3], size = 0.0;
  ct_mesh_bounds(mesh, low, high);
  for (int d = 0; d < 3; d++) size = high[d] - low[d] > size ? high[d] - low[d] : size;
  return 1e-9 * size;
}

/* The sides whose nodes are all `in`, by element and side, the inner ones marked: both sides of an
 * inner face are listed or none. Null: no memory. */
static side *sides_in(const ct_mesh *mesh, int local[6][8], const unsigned char *in, size_t *count)
{
  *count = list_sides(mesh, local, in, NULL);
  side *sides = *count > INT32_MAX ? NULL : ct_allocate(*count, sizeof *sides);
  if (sides != NULL) list_sides(mesh, local, in, sides);
  if (sides != NULL && mark_inner(sides, *count) == CT_OK) return sides;
  ct_release(sides);
  return NULL;
}

/* Copy the outer faces whose nodes are all `in`, by element and side. */
static int32_t collect(const ct_mesh *mesh, const unsigned char *in, int32_t *faces,
                       int32_t *owners)
{
  int local[6][8];
  int32_t kept = 0;
  size_t per_face = (size_t)per_side(mesh), count;
  list_local(mesh, local);
  side *sides = sides_in(mesh, local, in, &count);
  if (sides == NULL) return -CT_ERROR_MEMORY;
  for (size_t i = 0; i < count; i++) {
    int32_t node[8];
    if (sides[i].number < 0) continue;
    side_nodes(mesh, local, sides[i].element, sides[i].number, node);
    if (faces != NULL) memcpy(&faces[(size_t)kept * per_face], node, per_face * sizeof *faces);
    if (owners != NULL) owners[kept] = sides[i].element;
    kept++;
  }
  ct_release(sides);
  return kept;
}

/* The outer faces within a tolerance of x[axis] = value; axis -1: all. */
static int32_t faces_in(const ct_mesh *mesh, int axis, double value, int32_t *faces,
                        int32_t *owners)
{
  if (mesh->nodes == NULL || mesh->elements == NULL || ct_mesh_check_numbers(mesh, NULL) != CT_OK)
    return -CT_ERROR_ARGUMENT;
  unsigned char *in = ct_allocate((size_t)mesh->node_count, 1);
  if (in == NULL) return -CT_ERROR_MEMORY;
  double tolerance = plane_tolerance(mesh);
  for (size_t i = 0; i < (size_t)mesh->node_count; i++)
    in[i] = axis < 0 || fabs(mesh->nodes[3 * i + (size_t)axis] - value) <= tolerance;
  int32_t count = collect(mesh, in, faces, owners);
  ct_release(in);
  return count;
}

int32_t ct_mesh_plane_faces(const ct_mesh *mesh, int axis, double value, int32_t *faces,
                            int32_t *owners)
{
  if (mesh == NULL || mesh->nodes == NULL) return -CT_ERROR_ARGUMENT;
  return axis < 0 || axis > 2 ? 0 : faces_in(mesh, axis, value, faces, owners);
}

int32_t ct_mesh_outer_faces(const ct_mesh *mesh, int32_t *faces, int32_t *owners)
{
  return mesh == NULL ? -CT_ERROR_ARGUMENT : faces_in(mesh, -1, 0.0, faces, owners);
}

/* Write the faces of listed sides and mark their nodes. */
static ct_status enter_sides(const ct_mesh *mesh, int local[6][8], int32_t count,
                             const int32_t *sides, unsigned char *in, int32_t *faces,
                             ct_error *error)
{
  const int per_face = per_side(mesh);
  for (int32_t i = 0; i < count; i++, faces += per_face) {
    const int32_t element = sides[2 * (int64_t)i], number = sides[2 * (int64_t)i + 1];
    if (element < 0 || element >= mesh->element_count || number < 0 || number > 5)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, i},
                     "face %d is side %d of element %d; sides are 0 to 5, elements 0 to %d", (int)i,
                     (int)number, (int)element, (int)mesh->element_count - 1);
    side_nodes(mesh, local, element, number, faces);
    for (int a = 0; a < per_face; a++) in[faces[a]] = 1;
  }
  return CT_OK;
}

/* Refuse a listed side that another element has, too, and one that is listed twice. `outer`: one
 * byte per side of the mesh, 1 for outer ones. */
static ct_status check_sides(int32_t count, const int32_t *sides, unsigned char *outer,
                             ct_error *error)
{
  for (int32_t i = 0; i < count; i++) {
    const int32_t element = sides[2 * (int64_t)i], number = sides[2 * (int64_t)i + 1];
    unsigned char *is = &outer[6 * (int64_t)element + number];
    if (*is != 1)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, element, i},
                     *is == 0 ? "side %d of element %d is inside the body: another element has it, "
                                "too, so it is no part of a surface"
                              : "side %d of element %d is listed twice",
                     (int)number, (int)element);
    *is = 2;
  }
  return CT_OK;
}

ct_status ct_mesh_side_faces(const ct_mesh *mesh, int32_t count, const int32_t *sides,
                             int32_t *faces, ct_error *error)
{
  if (mesh == NULL || mesh->elements == NULL || sides == NULL || faces == NULL)
    return CT_REFUSE_NULL(error);
  ct_status status = ct_mesh_check_numbers(mesh, error);
  if (status != CT_OK) return status;
  int local[6][8];
  size_t found = 0;
  side *all = NULL;
  unsigned char *in = ct_allocate((size_t)mesh->node_count, 1),
                *outer = ct_allocate((size_t)mesh->element_count, 6);
  if (in == NULL || outer == NULL) status = CT_NO_MEMORY(error, "the sides of a mesh");
  list_local(mesh, local);
  if (status == CT_OK) status = enter_sides(mesh, local, count, sides, in, faces, error);
  if (status == CT_OK) all = sides_in(mesh, local, in, &found);
  if (status == CT_OK && all == NULL) status = CT_NO_MEMORY(error, "the sides of a mesh");
  for (size_t i = 0; status == CT_OK && i < found; i++)
    if (all[i].number >= 0) outer[6 * (int64_t)all[i].element + all[i].number] = 1;
  if (status == CT_OK) status = check_sides(count, sides, outer, error);
  ct_release(all);
  ct_release(outer);
  ct_release(in);
  return status;
}

/* By corners; of one face first the queries, whose elements are negative, then its elements. */
static int compare_sides(const void *a, const void *b)
{
  const side *m = a, *n = b;
  for (int k = 0; k < 4; k++)
    if (m->corner[k] != n->corner[k]) return m->corner[k] < n->corner[k] ? -1 : 1;
  return (m->element > n->element) - (m->element < n->element);
}

/* Write the elements of the queries -1 - element among sorted sides. */
static void find_owners(const side *sides, size_t count, int32_t *owners)
{
  const side *owner = NULL;
  for (const side *s = sides + count; s-- > sides;) {
    if (s->element >= 0) owner = s;
    else
      owners[-1 - s->element] =
          owner != NULL && memcmp(owner->corner, s->corner, sizeof s->corner) == 0 ? owner->element
                                                                                   : -1;
  }
}

ct_status ct_mesh_face_owners(const ct_mesh *mesh, int32_t count, const int32_t *faces,
                              int32_t *owners, ct_error *error)
{
  int local[6][8];
  const int per_face = per_side(mesh);
  unsigned char *in = ct_allocate((size_t)mesh->node_count, 1);
  if (in == NULL) return CT_NO_MEMORY(error, "the sides of a mesh");
  list_local(mesh, local);
  for (int64_t i = 0; i < (int64_t)count * per_face; i++) in[faces[i]] = 1;
  size_t listed = list_sides(mesh, local, in, NULL), all = listed + (size_t)count;
  side *sides = ct_allocate(all, sizeof *sides);
  if (sides != NULL) {
    list_sides(mesh, local, in, sides);
    for (int32_t i = 0; i < count; i++)
      sides[listed + (size_t)i] = side_of(&faces[(int64_t)i * per_face], -1 - i, 0);
    qsort(sides, all, sizeof *sides, compare_sides);
    find_owners(sides, all, owners);
  }
  ct_status status = sides != NULL ? CT_OK : CT_NO_MEMORY(error, "the sides of a mesh");
  ct_release(sides);
  ct_release(in);
  return status;
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
