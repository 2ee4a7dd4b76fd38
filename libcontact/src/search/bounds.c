/* Boxes around points and curved faces. */
#include "bounds.h"

#include "../base/vector.h"

#include <float.h>
#include <math.h>

void ct_bounds_join(ct_bounds *box, const ct_bounds *other)
{
  for (int c = 0; c < 3; c++) {
    if (other->low[c] < box->low[c]) box->low[c] = other->low[c];
    if (other->high[c] > box->high[c]) box->high[c] = other->high[c];
  }
}

/* Coordinate `c` of the Bernstein control points of a face: corners, one on each mid-side, one in
 * the middle of a Q8. Returns their number. */
static int control_points(const ct_face *face, int c, double b[9])
{
  int per = ct_face_node_count(face->kind), corners = per == 4 || per == 8 ? 4 : 3;
  for (int a = 0; a < corners; a++) b[a] = face->node[a][c];
  if (per == corners) return corners;
  // -- Pull the control point of a mid-side beyond its node (eq:control-points)
  const double (*x)[3] = face->node;
  for (int e = 0; e < corners; e++)
    b[corners + e] = 2.0 * x[corners + e][c] - 0.5 * (x[e][c] + x[(e + 1) % corners][c]);
  if (corners == 3) return 6;
  double middles = (x[4][c] + x[6][c]) + (x[5][c] + x[7][c]),
         ends = (x[0][c] + x[1][c]) + (x[2][c] + x[3][c]);
  b[8] = middles - 0.75 * ends;
  return 9;
}

/* The box of the corners of a face. Inlined with a known number. */
static inline ct_bounds corner_box(int corners, const ct_face *face)
{
  ct_bounds box;
  for (int c = 0; c < 3; c++) box.low[c] = box.high[c] = face->node[0][c];
  for (int a = 1; a < corners; a++)
    for (int c = 0; c < 3; c++) {
      const double x = face->node[a][c];
      box.low[c] = x < box.low[c] ? x : box.low[c];
      box.high[c] = x > box.high[c] ? x : box.high[c];
    }
  return box;
}

ct_bounds ct_face_bounds(const ct_face *face)
{
  if (face->kind == CT_Q4) return corner_box(4, face);
  if (face->kind == CT_T3) return corner_box(3, face);
  ct_bounds box;
  for (int c = 0; c < 3; c++) {
    double b[9];
    int count = control_points(face, c, b);
    // -- The box of the control points contains the face (eq:face-bounds)
    box.low[c] = box.high[c] = b[0];
    for (int i = 1; i < count; i++) {
      if (b[i] < box.low[c]) box.low[c] = b[i];
      if (b[i] > box.high[c]) box.high[c] = b[i];
    }
    // Computed control points have errors of a few roundings; corners are exact.
    double slack = 16.0 * DBL_EPSILON * (fabs(box.low[c]) + fabs(box.high[c]));
    box.low[c] -= slack;
    box.high[c] += slack;
  }
  return box;
}

/* Three orthogonal unit vectors, the last along the normal of a face at its middle; the coordinate
 * axes if it has none. */
static void frame(const ct_face *face, double axis[3][3])
{
  int corners = face->kind == CT_Q4 || face->kind == CT_Q8 ? 4 : 3;
  double u[3], v[3];
  for (int i = 0; i < 3; i++)
    for (int c = 0; c < 3; c++) axis[i][c] = i == c;
  for (int c = 0; c < 3; c++) {
    const double (*x)[3] = face->node;
    u[c] = corners == 3 ? x[1][c] - x[0][c] : (x[1][c] - x[0][c]) + (x[2][c] - x[3][c]);
    v[c] = corners == 3 ? x[2][c] - x[0][c] : (x[3][c] - x[0][c]) + (x[2][c] - x[1][c]);
  }
  double length = sqrt(ct_vector_dot(u, u)), normal[3];
  if (!ct_vector_unit_normal(u, v, normal)) return;
  for (int c = 0; c < 3; c++) {
    axis[0][c] = u[c] / length;
    axis[2][c] = normal[c];
  }
  ct_vector_cross(axis[2], axis[0], axis[1]);
}

void ct_oriented_init(ct_oriented *box, const ct_face *face)
{
  double b[3][9], size = 0.0;
  int count = 0;
  frame(face, box->axis);
  for (int c = 0; c < 3; c++) {
    count = control_points(face, c, b[c]);
    double low = b[c][0], high = b[c][0];
    for (int i = 1; i < count; i++) {
      low = fmin(low, b[c][i]);
      high = fmax(high, b[c][i]);
    }
    box->middle[c] = 0.5 * (low + high);
    size = fmax(size, (high - low) + 16.0 * DBL_EPSILON * (fabs(low) + fabs(high)));
  }
  for (int k = 0; k < 3; k++) {
    // -- Half extents that contain the control points, with a margin for rounding
    box->half[k] = 0.0;
    for (int i = 0; i < count; i++) {
      double d[3] = {b[0][i] - box->middle[0], b[1][i] - box->middle[1], b[2][i] - box->middle[2]};
      box->half[k] = fmax(box->half[k], fabs(ct_vector_dot(box->axis[k], d)));
    }
    box->half[k] += 1e-9 * size;
  }
}

double ct_oriented_square(const ct_oriented *box, const double point[3])
{
  double d[3], sum = 0.0;
  for (int c = 0; c < 3; c++) d[c] = point[c] - box->middle[c];
  for (int k = 0; k < 3; k++) {
    // -- Distance beyond the box along each of its axes (eq:oriented-box)
    double beyond = fabs(ct_vector_dot(box->axis[k], d)) - box->half[k];
    sum += beyond > 0.0 ? beyond * beyond : 0.0;
  }
  return (1.0 - 1e-9) * sum;
}

/* From the origin to the nearest place of the parallelogram with the mean edges of a quadrilateral,
 * if that is a rectangle; else to a place of it. `b`: its control points, corners first. */
static void to_parallelogram(double b[3][9], double v[3])
{
  double t1[3], t2[3];
  for (int c = 0; c < 3; c++) {
    const double *x = b[c];
    t1[c] = 0.25 * ((x[1] - x[0]) + (x[2] - x[3]));
    t2[c] = 0.25 * ((x[3] - x[0]) + (x[2] - x[1]));
    v[c] = 0.25 * ((x[0] + x[1]) + (x[2] + x[3]));
  }
  const double g1 = ct_vector_dot(t1, v), g2 = ct_vector_dot(t2, v), H1 = ct_vector_dot(t1, t1),
               H2 = ct_vector_dot(t2, t2), H12 = ct_vector_dot(t1, t2),
               determinant = H1 * H2 - H12 * H12;
  const double xi = fmax(-1.0, fmin((H12 * g2 - H2 * g1) / determinant, 1.0)),
               eta = fmax(-1.0, fmin((H12 * g1 - H1 * g2) / determinant, 1.0));
  for (int c = 0; c < 3; c++) v[c] += xi * t1[c] + eta * t2[c];
}

/* The first of some control points in a direction; returns how far along the direction it is. */
static double first_along(int count, double b[3][9], const double v[3], int *first)
{
  double low = HUGE_VAL;
  for (int i = 0; i < count; i++) {
    const double along = (v[0] * b[0][i] + v[1] * b[1][i]) + v[2] * b[2][i];
    if (along < low) low = along, *first = i;
  }
  return low;
}

int ct_face_is_beyond(const ct_face *face, const double point[3], double reach)
{
  enum { DIRECTIONS = 3 };
  double b[3][9], v[3], far = 0.0;
  int count = 0, first = 0;
  for (int c = 0; c < 3; c++) {
    count = control_points(face, c, b[c]);
    for (int i = 0; i < count; i++) b[c][i] -= point[c], far = fmax(far, fabs(b[c][i]));
  }
  const double most = reach + 1e-12 * far; // with a margin for rounding
  to_parallelogram(b, v);
  for (int k = 0; k < DIRECTIONS; k++) {
    const double square = ct_vector_dot(v, v), low = first_along(count, b, v, &first);
    // -- All control points are beyond a plane (eq:hull-bound)
    if (low > 0.0 && low * low > most * most * square) return 1;
    // -- The nearest place between the last one and that control point (eq:hull-step)
    const double d[3] = {b[0][first] - v[0], b[1][first] - v[1], b[2][first] - v[2]},
                 part = fmin((square - low) / ct_vector_dot(d, d), 1.0);
    for (int c = 0; c < 3; c++) v[c] += part * d[c];
  }
  return 0;
}
