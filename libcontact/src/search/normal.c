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

/* On edge `e` of a face: add the neighbour's normal at the same point; 0 at the border. */
static int edge_normal(const ct_search *search, int32_t face, int e, const double foot[2], double normal[3])
{
  const int32_t *mine = &search->faces[(int64_t)face * search->per];
  int32_t other = search->neighbour[(int64_t)face * search->edges + e];
  if (other < 0) return 0;
  double first[2], last[2], xi[2];
  edge_point(search->edges, e, -1.0, first);
  edge_point(search->edges, e, 1.0, last);
  double along[2] = {last[0] - first[0], last[1] - first[1]}, here[2] = {foot[0] - first[0], foot[1] - first[1]};
  double s = 2.0 * (along[0] * here[0] + along[1] * here[1]) / (along[0] * along[0] + along[1] * along[1]) - 1.0;
  const int32_t *theirs = &search->faces[(int64_t)other * search->per];
  for (int k = 0; k < search->edges; k++)
    if (theirs[k] == mine[(e + 1) % search->edges] && theirs[(k + 1) % search->edges] == mine[e]) {
      edge_point(search->edges, k, -s, xi);
      add_normal(search, other, xi, 1.0, normal);
    }
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
