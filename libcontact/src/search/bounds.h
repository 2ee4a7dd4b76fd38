#ifndef CT_SRC_SEARCH_BOUNDS_H
#define CT_SRC_SEARCH_BOUNDS_H

#include <libcontact/shape.h>

#include <math.h>

/* Axis-aligned box. */
typedef struct ct_bounds {
  double low[3], high[3];
} ct_bounds;

/* Box along the axes of a face: its middle, three orthogonal unit vectors, half extents along each.
 */
typedef struct ct_oriented {
  double middle[3], axis[3][3], half[3];
} ct_oriented;

/* Square of the distance of a point from a box, 0 inside (eq:box-distance). */
static inline double ct_bounds_square(const ct_bounds *box, const double point[3])
{
  double d[3];
  for (int c = 0; c < 3; c++) {
    // -- Below the box, inside, or above it (eq:box-distance)
    double below = box->low[c] - point[c], above = point[c] - box->high[c],
           out = below > above ? below : above;
    d[c] = out > 0.0 ? out : 0.0;
  }
  return (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
}

/* Distance of a point from a box. */
static inline double ct_bounds_distance(const ct_bounds *box, const double point[3])
{
  return sqrt(ct_bounds_square(box, point));
}

/* Largest distance of a point of one box from one of the other. */
static inline double ct_bounds_farthest(const ct_bounds *a, const ct_bounds *b)
{
  double d[3];
  for (int c = 0; c < 3; c++) d[c] = fmax(a->high[c] - b->low[c], b->high[c] - a->low[c]);
  return sqrt((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]);
}

/* The box of all points within `reach` of a box along each axis. */
static inline ct_bounds ct_bounds_grown(const ct_bounds *box, double reach)
{
  ct_bounds larger = *box;
  for (int c = 0; c < 3; c++) {
    larger.low[c] -= reach;
    larger.high[c] += reach;
  }
  return larger;
}

/* Whether two boxes have no point in common. */
static inline int ct_bounds_apart(const ct_bounds *a, const ct_bounds *b)
{
  int apart = 0;
  for (int c = 0; c < 3; c++) apart |= (a->low[c] > b->high[c]) | (b->low[c] > a->high[c]);
  return apart;
}

/* The box that contains both. */
void ct_bounds_join(ct_bounds *box, const ct_bounds *other);

/* Box that contains the whole curved face: that of its control points (eq:face-bounds). */
ct_bounds ct_face_bounds(const ct_face *face);

/* The same along the tangents and the normal at the middle of the face. */
void ct_oriented_init(ct_oriented *box, const ct_face *face);

/* A lower bound of the squared distance of a point from the contents of the box; rounded down. */
double ct_oriented_square(const ct_oriented *box, const double point[3]);

/* Whether a quadrilateral is certainly farther from a point than `reach` (eq:hull-bound). */
int ct_face_is_beyond(const ct_face *face, const double point[3], double reach);

#endif
