/* Elements that are listed twice, faces of three elements, and faces of two lists. */
#include "../base/error.h"
#include "../base/memory.h"
#include "corners.h"
#include "mesh_internal.h"

ct_status ct_mesh_check_twins(const ct_mesh *mesh, ct_error *error)
{
  const size_t per = (size_t)ct_brick_node_count(mesh->kind), count = (size_t)mesh->element_count;
  ct_corner_list list = {.rows = NULL};
  int32_t (*corner)[8] = ct_allocate(count, sizeof *corner);
  ct_status status =
      corner == NULL ? CT_ERROR_MEMORY : ct_corner_list_open(&list, corner[0], 8, 8, count);
  if (status != CT_OK) status = CT_NO_MEMORY(error, "a mesh");
  for (size_t e = 0; status == CT_OK && e < count; e++) {
    for (int k = 0; k < 8; k++) corner[e][k] = -1;
    ct_corners_of(&mesh->elements[e * per], 8, corner[e]);
    const int32_t k = ct_corner_list_enter(&list, (int32_t)e);
    if (k >= 0)
      status = ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, (int64_t)e, -1},
                       "element %d has the corners of element %d; each element must be listed once",
                       (int)e, (int)k);
  }
  ct_corner_list_close(&list);
  ct_release(corner);
  return status;
}

/* Enter side `i` % 6 of element `i` / 6, and refuse it if it is the third with its corners. */
static ct_status enter_side(const ct_mesh *mesh, const int *local, ct_corner_list *list,
                            int32_t (*corner)[4], int32_t i, ct_error *error)
{
  const int per = ct_brick_node_count(mesh->kind);
  int32_t node[4];
  for (int k = 0; k < 4; k++) {
    node[k] = mesh->elements[(int64_t)(i / 6) * per + local[k]];
    corner[i][k] = -1;
  }
  ct_corners_of(node, 4, corner[i]);
  if (corner[i][1] < 0) return CT_OK; // collapsed to an edge, as in a wedge
  const int32_t second = ct_corner_list_enter(list, i),
                first = second < 0 ? -1 : ct_corner_list_before(list, second);
  return first < 0 ? CT_OK
                   : ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, i / 6, -1},
                             "element %d shares a face with both element %d and element %d; at "
                             "most two elements have a face in common",
                             (int)i / 6, (int)first / 6, (int)second / 6);
}

ct_status ct_mesh_check_sides(const ct_mesh *mesh, ct_error *error)
{
  const int32_t count = 6 * mesh->element_count;
  int local[6][8];
  ct_corner_list list = {.rows = NULL};
  int32_t (*corner)[4] = ct_allocate((size_t)count, sizeof *corner);
  ct_status status =
      corner == NULL ? CT_ERROR_MEMORY : ct_corner_list_open(&list, corner[0], 4, 4, (size_t)count);
  if (status != CT_OK) status = CT_NO_MEMORY(error, "the sides of a mesh");
  for (int number = 0; number < 6; number++) ct_brick_face(mesh->kind, number, local[number]);
  for (int32_t i = 0; status == CT_OK && i < count; i++)
    status = enter_side(mesh, local[i % 6], &list, corner, i, error);
  ct_corner_list_close(&list);
  ct_release(corner);
  return status;
}

int32_t ct_mesh_common_face(int per, const int32_t *a, int32_t count_a, const int32_t *b,
                            int32_t count_b)
{
  const size_t first = (size_t)count_b, all = first + (size_t)count_a;
  int32_t found = -1, (*corner)[4] = ct_allocate(all, sizeof *corner);
  ct_corner_list list = {.rows = NULL};
  if (corner == NULL || ct_corner_list_open(&list, corner[0], 4, 4, all) != CT_OK) found = -2;
  for (size_t i = 0; found == -1 && i < all; i++) {
    for (int k = 0; k < 4; k++) corner[i][k] = -1;
    ct_corners_of(i < first ? &b[i * (size_t)per] : &a[(i - first) * (size_t)per], 4, corner[i]);
    const int32_t k = ct_corner_list_enter(&list, (int32_t)i);
    if (i >= first && k >= 0 && k < count_b) found = (int32_t)(i - first);
  }
  ct_corner_list_close(&list);
  ct_release(corner);
  return found;
}
