/* Outward direction at the closest point of a projection, folds included. */
#include "search_internal.h"

#include "../base/vector.h"

#include <math.h>
#include <string.h>

/* Parameters of the point on edge `e` at s in -1 ... 1 from its first corner to its second. */
static void edge_point(int edges, int e, double s, double xi[2])
{
  static const double square[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}},
                      triangle[3][2] = {{0, 0}, {1, 0}, {0, 1}};
  const double (*corner)[2] = edges == 4 ? square : triangle;
  for (int i = 0; i < 2; i++)
    xi[i] = 0.5 * ((1.0 - s) * corner[e][i] + (1.0 + s) * corner[(e + 1) % edges][i]);
}

/* The neighbour across edge `e` of a face, and its parameters at a point of that edge; -1 at the
 * border. */
static int32_t across(const ct_search *search, int32_t face, int e, const double closest[2],
                      double xi[2])
{
  const int32_t *mine = &search->faces[(int64_t)face * search->per];
  int32_t other = search->neighbour[(int64_t)face * search->edges + e];
  if (other < 0) return -1;
  double first[2], last[2];
  edge_point(search->edges, e, -1.0, first);
  edge_point(search->edges, e, 1.0, last);
  double along[2] = {last[0] - first[0], last[1] - first[1]},
         here[2] = {closest[0] - first[0], closest[1] - first[1]};
  double s = 2.0 * (along[0] * here[0] + along[1] * here[1]) /
                 (along[0] * along[0] + along[1] * along[1]) -
             1.0;
  const int32_t *theirs = &search->faces[(int64_t)other * search->per];
  for (int k = 0; k < search->edges; k++)
    if (theirs[k] == mine[(e + 1) % search->edges] && theirs[(k + 1) % search->edges] == mine[e])
      edge_point(search->edges, k, -s, xi);
  return other;
}

/* On edge `e` of a face: add the neighbour's normal at the same point; returns 0 at the border. */
static int edge_normal(const ct_search *search, int32_t face, int e, const double closest[2],
                       double normal[3])
{
  ct_face neighbour;
  double xi[2], theirs[3];
  int32_t other = across(search, face, e, closest, xi);
  if (other < 0) return 0;
  ct_search_face(search, other, &neighbour);
  if (ct_segment_normal(&neighbour, xi, theirs) == CT_OK)
    // -- The sum of both normals (eq:pseudo-normal)
    for (int c = 0; c < 3; c++) normal[c] += theirs[c];
  return 1;
}

/* Direction of an edge at corner k of a face, to the corner after or before it: the tangent there.
 * If the tangent vanishes, as with a mid-side node at the quarter point, a quadratic edge has the
 * direction of its chord (eq:edge-direction). */
static void edge_direction(const ct_search *search, int32_t face, int k, int backwards,
                           double along[3])
{
  const int32_t *nodes = &search->faces[(int64_t)face * search->per];
  int before = (k + search->edges - 1) % search->edges;
  const double *first = &search->x[3 * (int64_t)nodes[k]];
  const double *last = &search->x[3 * (int64_t)nodes[backwards ? before : (k + 1) % search->edges]];
  double chord[3];
  for (int c = 0; c < 3; c++) along[c] = chord[c] = last[c] - first[c];
  if (search->per == search->edges) return;
  const double *middle = &search->x[3 * (int64_t)nodes[search->edges + (backwards ? before : k)]];
  // -- t = 4 (x_m - x_1) - (x_2 - x_1) (eq:edge-direction)
  for (int c = 0; c < 3; c++) along[c] = 4.0 * (middle[c] - first[c]) - chord[c];
  // -- A tangent that is zero to rounding has no direction of its own (eq:edge-direction)
  if (!(ct_vector_dot(along, along) > 1e-18 * ct_vector_dot(chord, chord)))
    memcpy(along, chord, sizeof chord);
}

/* Add to `normal` that of a face at its corner k, weighted by the angle there; returns 0 if an edge
 * at the corner is on the border. A face adds nothing at a corner with a collapsed edge. */
static int add_corner(const ct_search *search, int32_t face, int k, double normal[3])
{
  int before = (k + search->edges - 1) % search->edges;
  double u[3], v[3], w[3], n[3];
  edge_direction(search, face, k, 0, u);
  edge_direction(search, face, k, 1, v);
  ct_vector_cross(u, v, w);
  // -- Weigh the normal by the angle of the face at the corner (eq:pseudo-normal)
  double angle = atan2(sqrt(ct_vector_dot(w, w)), ct_vector_dot(u, v));
  if (ct_vector_unit_normal(u, v, n))
    for (int c = 0; c < 3; c++) normal[c] += angle * n[c];
  return search->neighbour[(int64_t)face * search->edges + k] >= 0 &&
         search->neighbour[(int64_t)face * search->edges + before] >= 0;
}

/* At corner `a` of a face: sum the normals of the faces around it; returns 0 at the border. */
static int corner_normal(const ct_search *search, int32_t face, int a, double normal[3])
{
  const ct_incidence *around = &search->incidence;
  int32_t node = search->faces[(int64_t)face * search->per + a];
  int inside = 1;
  for (int c = 0; c < 3; c++) normal[c] = 0.0;
  for (int32_t i = around->first[node]; i < around->first[node + 1]; i++) {
    int32_t f = around->place[i] / search->per, k = around->place[i] % search->per;
    if (k < search->edges && !add_corner(search, f, k, normal)) inside = 0;
  }
  return inside;
}

int ct_search_middle_normal(const ct_search *search, int32_t face, double normal[3])
{
  ct_face nodes;
  ct_search_face(search, face, &nodes);
  return ct_segment_normal(&nodes, ct_search_middle(search), normal) == CT_OK;
}

int ct_search_normal(const ct_search *search, int32_t face, ct_where where, int index,
                     const double xi[2], const double own[3], double normal[3])
{
  memcpy(normal, own, 3 * sizeof *normal);
  if (where == CT_EDGE) return edge_normal(search, face, index, xi, normal);
  if (where == CT_VERTEX) return corner_normal(search, face, index, normal);
  return where == CT_INTERIOR;
}

/* Whether the distance increases, to rounding, along `v` from a closest point to which `d` points.
 */
static int grows(const double d[3], const double v[3])
{
  const double slack = 1e-6 * sqrt(ct_vector_dot(d, d) * ct_vector_dot(v, v));
  // -- Slope of the squared distance (eq:local-minimum)
  return ct_vector_dot(d, v) + slack >= 0.0;
}

/* Direction from the place xi on an edge of a face to its middle. */
static void inwards(const ct_search *search, int32_t face, const double xi[2], double v[3])
{
  double t1[3], t2[3], centre = search->edges == 4 ? 0.0 : 1.0 / 3.0;
  ct_face f;
  ct_search_face(search, face, &f);
  ct_segment_tangents(&f, xi, t1, t2);
  for (int c = 0; c < 3; c++) v[c] = (centre - xi[0]) * t1[c] + (centre - xi[1]) * t2[c];
}

int ct_search_is_minimum(const ct_search *search, int32_t face, ct_where where, int index,
                         const double xi[2], const double d[3])
{
  double at[2], v[3];
  if (where == CT_EDGE) {
    int32_t other = across(search, face, index, xi, at);
    if (other < 0) return 1;
    inwards(search, other, at, v);
    return grows(d, v);
  }
  if (where != CT_VERTEX) return 1;
  const ct_incidence *around = &search->incidence;
  int32_t node = search->faces[(int64_t)face * search->per + index];
  for (int32_t i = around->first[node]; i < around->first[node + 1]; i++) {
    int32_t f = around->place[i] / search->per, k = around->place[i] % search->per;
    for (int backwards = 0; k < search->edges && backwards < 2; backwards++) {
      edge_direction(search, f, k, backwards, v);
      if (!grows(d, v)) return 0;
    }
  }
  return 1;
}
