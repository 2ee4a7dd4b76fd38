/* The closest point of a flat triangle in closed form. */
#include "search_internal.h"

#include "../base/vector.h"

#include <math.h>

/* Closest point of the edge from a to b, both relative to the point: keep it if it is nearer than
 * `best`. Parameter t along the edge. */
static double edge(const double a[3], const double b[3], double best, double *t, double d[3],
                   int *kept)
{
  double along[3], closest[3];
  for (int c = 0; c < 3; c++) along[c] = b[c] - a[c];
  // -- Closest point on the line, cut off at its ends (eq:triangle-edge)
  double square = ct_vector_dot(along, along),
         s = square > 0.0 ? -ct_vector_dot(a, along) / square : 0.0;
  s = s > 0.0 ? s < 1.0 ? s : 1.0 : 0.0;
  for (int c = 0; c < 3; c++) closest[c] = s < 1.0 ? a[c] + s * along[c] : b[c];
  double f = ct_vector_dot(closest, closest);
  *kept = f < best;
  if (!*kept) return best;
  *t = s;
  for (int c = 0; c < 3; c++) d[c] = closest[c];
  return f;
}

double ct_search_triangle(const ct_search *search, int32_t face, const double point[3],
                          double xi[2], double d[3])
{
  const int32_t *node = &search->faces[3 * (int64_t)face];
  double v[3][3], e1[3], e2[3], n[3], w[3], t = 0.0, best = HUGE_VAL;
  for (int a = 0; a < 3; a++)
    for (int c = 0; c < 3; c++) v[a][c] = search->x[3 * (int64_t)node[a] + c] - point[c];
  for (int c = 0; c < 3; c++) {
    e1[c] = v[1][c] - v[0][c];
    e2[c] = v[2][c] - v[0][c];
  }
  ct_vector_cross(e1, e2, n);
  // -- Parameters of the closest point in the plane, from areas (eq:triangle-inside)
  double square = ct_vector_dot(n, n), r, s;
  ct_vector_cross(e2, v[0], w);
  r = ct_vector_dot(w, n);
  ct_vector_cross(v[0], e1, w);
  s = ct_vector_dot(w, n);
  if (r >= 0.0 && s >= 0.0 && r + s <= square && square > 0.0) {
    xi[0] = r / square;
    xi[1] = s / square;
    for (int c = 0; c < 3; c++) d[c] = v[0][c] + (xi[0] * e1[c] + xi[1] * e2[c]);
    return ct_vector_dot(d, d);
  }
  // -- Else it lies on an edge that the closest point in the plane is beyond
  int kept, flat = !(square > 0.0);
  if (s < 0.0 || flat) {
    best = edge(v[0], v[1], best, &t, d, &kept);
    if (kept) xi[0] = t, xi[1] = 0.0;
  }
  if (r < 0.0 || flat) {
    best = edge(v[0], v[2], best, &t, d, &kept);
    if (kept) xi[0] = 0.0, xi[1] = t;
  }
  if (r + s > square || flat) {
    best = edge(v[1], v[2], best, &t, d, &kept);
    if (kept) xi[0] = 1.0 - t, xi[1] = t;
  }
  return best;
}
