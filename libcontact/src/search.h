#ifndef CT_SRC_SEARCH_H
#define CT_SRC_SEARCH_H

#include <contact/status.h>

/* Axis-aligned box. */
typedef struct ct_bounds {
  double low[3], high[3];
} ct_bounds;

/* Distance of a point from a box, 0 inside (eq:box-distance). */
double ct_bounds_distance(const ct_bounds *box, const double point[3]);

/* A binary tree of boxes over `count` items, median split along the longest axis (eq:bounding-tree). */
typedef struct ct_search ct_search;

ct_status ct_search_create(int32_t count, ct_search **out, ct_error *error);
void ct_search_free(ct_search *search);

/* Build the tree anew over the items' boxes, which are copied. */
void ct_search_build(ct_search *search, const ct_bounds *boxes);

/* Write the items whose boxes overlap `box`, ascending, to `items` (room for `room`); returns how many overlap. */
int32_t ct_search_overlaps(const ct_search *search, const ct_bounds *box, int32_t *items, int32_t room);

/* Item nearest to the point: `distance(user, item)` is the true distance of an item, at least that of its box.
 * Of equally near ones the first is taken. Returns -1 when the tree is empty; `*nearest` gets the distance. */
int32_t ct_search_nearest(const ct_search *search, const double point[3], double (*distance)(void *user, int32_t item), void *user,
                          double *nearest);

#endif
