#ifndef CT_SRC_SEARCH_BOUNDS_H
#define CT_SRC_SEARCH_BOUNDS_H

#include <libcontact/shape.h>

/* Axis-aligned box. */
typedef struct ct_bounds {
  double low[3], high[3];
} ct_bounds;

/* Square of the distance of a point from a box, 0 inside (eq:box-distance). */
static inline double ct_bounds_square(const ct_bounds *box, const double point[3])
{
  double d[3];
  for (int c = 0; c < 3; c++) {
    double below = box->low[c] - point[c], above = point[c] - box->high[c],
           out = below > above ? below : above;
    d[c] = out > 0.0 ? out : 0.0;
  }
  return (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
}

/* Distance of a point from a box. */
double ct_bounds_distance(const ct_bounds *box, const double point[3]);

/* The box that holds both. */
void ct_bounds_join(ct_bounds *box, const ct_bounds *other);

/* Box that holds the whole curved face: that of its control points (eq:face-bounds). */
ct_bounds ct_face_bounds(const ct_face *face);

#endif
