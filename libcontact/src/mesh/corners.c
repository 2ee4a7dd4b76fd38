/* Rows of corners that are equal. */
#include "corners.h"
#include "../base/memory.h"

#include <string.h>

void ct_corners_of(const int32_t *node, int count, int32_t *corner)
{
  for (int i = 0; i < count; i++) {
    int j = 0;
    for (int k = 0; k < count; k++) j |= corner[k] == node[i];
    if (j) continue;
    for (j = 0; j < count - 1 && corner[j + 1] < node[i]; j++) corner[j] = corner[j + 1];
    corner[j] = node[i];
  }
}

ct_status ct_corner_list_open(ct_corner_list *list, const int32_t *rows, size_t width,
                              size_t stride, size_t count)
{
  *list = (ct_corner_list){.rows = rows, .width = width, .stride = stride, .capacity = 1};
  while (list->capacity < count) list->capacity *= 2;
  list->latest = ct_allocate(list->capacity, sizeof *list->latest);
  list->before = ct_allocate(count, sizeof *list->before);
  if (list->latest != NULL && list->before != NULL) return CT_OK;
  ct_corner_list_close(list);
  return CT_ERROR_MEMORY;
}

int32_t ct_corner_list_enter(ct_corner_list *list, int32_t row)
{
  const int32_t *corner = &list->rows[(size_t)row * list->stride];
  uint64_t hash = 0;
  for (size_t k = 0; k < list->width; k++)
    hash = (hash + (uint64_t)corner[k]) * UINT64_C(0x9e3779b97f4a7c15);
  int32_t *head = &list->latest[(hash >> 32) & (list->capacity - 1)];
  list->before[row] = *head;
  *head = row + 1;
  return ct_corner_list_before(list, row);
}

int32_t ct_corner_list_before(const ct_corner_list *list, int32_t row)
{
  const int32_t *rows = list->rows, *corner = &rows[(size_t)row * list->stride];
  int32_t k = list->before[row] - 1;
  while (k >= 0 &&
         memcmp(&rows[(size_t)k * list->stride], corner, list->width * sizeof *corner) != 0)
    k = list->before[k] - 1;
  return k;
}

void ct_corner_list_close(ct_corner_list *list)
{
  ct_release(list->latest);
  ct_release(list->before);
  list->latest = list->before = NULL;
}
