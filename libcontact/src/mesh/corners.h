#ifndef CT_SRC_MESH_CORNERS_H
#define CT_SRC_MESH_CORNERS_H

#include <libcontact/base.h>

#include <stddef.h>

/* Write distinct corners in ascending order, the same for every order of the nodes: shape (count),
 * -1 in front where nodes coincide. `corner` holds -1. */
void ct_corners_of(const int32_t *node, int count, int32_t *corner);

/* Rows of corners, by a hash: which earlier one is equal? */
typedef struct ct_corner_list {
  const int32_t *rows;
  size_t width, stride, capacity;
  int32_t *latest; /* number + 1 of the latest row of a hash */
  int32_t *before; /* of each row: number + 1 of the one before it with its hash */
} ct_corner_list;

/* Room for `count` rows of `width` corners, `stride` numbers apart; CT_ERROR_MEMORY. */
ct_status ct_corner_list_open(ct_corner_list *list, const int32_t *rows, size_t width,
                              size_t stride, size_t count);

/* Enter the next row; returns the latest equal one before it, or -1. */
int32_t ct_corner_list_enter(ct_corner_list *list, int32_t row);

/* The latest row before `row` that is equal, or -1. */
int32_t ct_corner_list_before(const ct_corner_list *list, int32_t row);

void ct_corner_list_close(ct_corner_list *list);

#endif
