/* Which way is out at the foot of a projection, folds included. */
#include "search_internal.h"

#include "../vector.h"

#include <math.h>
#include <string.h>

/* Parameters of the point on edge `e` at s in -1 ... 1 from its first corner to its second. */
static void edge_point(int edges, int e, double s, double xi[2])
{
  static const double square[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, triangle[3][2] = {{0, 0}, {1, 0}, {0, 1}};
  const double(*corner)[2] = edges == 4 ? square : triangle;
  for (int i = 0; i < 2; i++) xi[i] = 0.5 * ((1.0 - s) * corner[e][i] + (1.0 + s) * corner[(e + 1) % edges][i]);
}

static void add_normal(const ct_search *search, int32_t face, const double xi[2], double weight, double sum[3])
{
  ct_face f;
  double n[3];
  ct_search_face(search, face, &f);
  if (ct_segment_normal(&f, xi, n) != CT_OK) return;
  for (int c = 0; c < 3; c++) sum[c] += weight * n[c];
}

/* The neighbour across edge `e` of a face, and its parameters at a point of that edge; -1 at the border. */
static int32_t across(const ct_search *search, int32_t face, int e, const double foot[2], double xi[2])
{
  const int32_t *mine = &search->faces[(int64_t)face * search->per];
  int32_t other = search->neighbour[(int64_t)face * search->edges + e];
  if (other < 0) return -1;
  double first[2], last[2];
  edge_point(search->edges, e, -1.0, first);
  edge_point(search->edges, e, 1.0, last);
  double along[2] = {last[0] - first[0], last[1] - first[1]}, here[2] = {foot[0] - first[0], foot[1] - first[1]};
  double s = 2.0 * (along[0] * here[0] + along[1] * here[1]) / (along[0] * along[0] + along[1] * along[1]) - 1.0;
  const int32_t *theirs = &search->faces[(int64_t)other * search->per];
  for (int k = 0; k < search->edges; k++)
    if (theirs[k] == mine[(e + 1) % search->edges] && theirs[(k + 1) % search->edges] == mine[e]) edge_point(search->edges, k, -s, xi);
  return other;
}

/* On edge `e` of a face: add the neighbour's normal at the same point; 0 at the border. */
static int edge_normal(const ct_search *search, int32_t face, int e, const double foot[2], double normal[3])
{
  double xi[2];
  int32_t other = across(search, face, e, foot, xi);
  if (other < 0) return 0;
  add_normal(search, other, xi, 1.0, normal);
  return 1;
}

/* Add to `normal` that of a face at its corner k, weighted by the angle there; 0 when an edge at the corner is on the border. */
static int add_corner(const ct_search *search, int32_t face, int k, double normal[3])
{
  const int32_t *nodes = &search->faces[(int64_t)face * search->per];
  int before = (k + search->edges - 1) % search->edges;
  double u[3], v[3], w[3], xi[2];
  for (int c = 0; c < 3; c++) {
    u[c] = search->x[3 * (int64_t)nodes[(k + 1) % search->edges] + c] - search->x[3 * (int64_t)nodes[k] + c];
    v[c] = search->x[3 * (int64_t)nodes[before] + c] - search->x[3 * (int64_t)nodes[k] + c];
  }
  ct_vector_cross(u, v, w);
  edge_point(search->edges, k, -1.0, xi);
  // -- Weigh the normal by the angle of the face at the corner (eq:pseudo-normal)
  add_normal(search, face, xi, atan2(sqrt(ct_vector_dot(w, w)), ct_vector_dot(u, v)), normal);
  return search->neighbour[(int64_t)face * search->edges + k] >= 0 && search->neighbour[(int64_t)face * search->edges + before] >= 0;
}

/* At corner `a` of a face: sum the normals of the faces around it; 0 at the border. */
static int corner_normal(const ct_search *search, int32_t face, int a, double normal[3])
{
  int32_t node = search->faces[(int64_t)face * search->per + a];
  int inside = 1;
  for (int c = 0; c < 3; c++) normal[c] = 0.0;
  for (int32_t i = search->ring_first[node]; i < search->ring_first[node + 1]; i++) {
    int32_t f = search->ring[i];
    for (int k = 0; k < search->edges; k++)
      if (search->faces[(int64_t)f * search->per + k] == node && !add_corner(search, f, k, normal)) inside = 0;
  }
  return inside;
}

int ct_search_normal(const ct_search *search, int32_t face, ct_where where, int index, const double xi[2], const double own[3], double normal[3])
{
  memcpy(normal, own, 3 * sizeof *normal);
  if (where == CT_EDGE) return edge_normal(search, face, index, xi, normal);
  if (where == CT_VERTEX) return corner_normal(search, face, index, normal);
  return where == CT_INTERIOR;
}

/* Whether the distance grows, to rounding, from the place xi of a face towards its place `to`. */
static int grows(const ct_search *search, int32_t face, const double xi[2], const double to[2], const double d[3])
{
  ct_face f;
  double t1[3], t2[3], v[3];
  ct_search_face(search, face, &f);
  ct_segment_tangents(&f, xi, t1, t2);
  for (int c = 0; c < 3; c++) v[c] = (to[0] - xi[0]) * t1[c] + (to[1] - xi[1]) * t2[c];
  // -- Slope of the squared distance (eq:local-minimum)
  return ct_vector_dot(d, v) >= -1e-6 * sqrt(ct_vector_dot(d, d) * ct_vector_dot(v, v));
}

int ct_search_is_minimum(const ct_search *search, int32_t face, ct_where where, int index, const double xi[2], const double d[3])
{
  double at[2], to[2], centre = search->edges == 4 ? 0.0 : 1.0 / 3.0;
  const double middle[2] = {centre, centre};
  if (where == CT_EDGE) {
    int32_t other = across(search, face, index, xi, at);
    return other < 0 || grows(search, other, at, middle, d);
  }
  if (where != CT_VERTEX) return 1;
  int32_t node = search->faces[(int64_t)face * search->per + index];
  for (int32_t i = search->ring_first[node]; i < search->ring_first[node + 1]; i++)
    for (int k = 0; k < search->edges; k++) {
      if (search->faces[(int64_t)search->ring[i] * search->per + k] != node) continue;
      edge_point(search->edges, k, -1.0, at);
      for (int way = 1; way < search->edges; way += search->edges - 2) {
        edge_point(search->edges, (k + way) % search->edges, -1.0, to);
        if (!grows(search, search->ring[i], at, to, d)) return 0;
      }
    }
  return 1;
}
