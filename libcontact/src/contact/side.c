/* One surface of a contact: its topology, its Gauss points, its current shape. */
#include "side.h"

#include "../error.h"
#include "../memory.h"
#include "../vector.h"

#include <math.h>
#include <string.h>

void ct_side_clear(ct_side *side)
{
  void *blocks[] = {side->nodes, side->faces, side->neighbour, side->ring_first, side->ring, side->weight,
                    side->x, side->boxes, side->x_built, side->candidate_first, side->candidates, side->points,
                    side->force, side->force_fine};
  for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; i++) ct_release(blocks[i]);
  ct_search_free(side->search);
  memset(side, 0, sizeof *side);
}

static ct_status check_surface(const ct_surface *surface, int body, ct_error *error)
{
  ct_place where = {body, -1, -1};
  int per = surface == NULL ? 0 : ct_face_node_count(surface->kind);
  if (per == 0 || surface->faces == NULL || surface->reference == NULL || surface->face_count < 1 || surface->node_count < 1)
    return ct_fail(error, CT_ERROR_ARGUMENT, where, "surface %d is empty or of an unknown kind", body);
  for (int32_t f = 0; f < surface->face_count; f++)
    for (int a = 0; a < per; a++) {
      int32_t node = surface->faces[(int64_t)f * per + a];
      where.element = f;
      if (node < 0 || node >= surface->node_count)
        return ct_fail(error, CT_ERROR_ARGUMENT, where, "face %d of surface %d names node %d, there are nodes 0 to %d", (int)f,
                       body, (int)node, (int)surface->node_count - 1);
      for (int c = 0; c < 3; c++)
        if (!isfinite(surface->reference[3 * (int64_t)node + c]))
          return ct_fail(error, CT_INVALID, (ct_place){body, f, node}, "coordinate %c of node %d of surface %d is not finite",
                         "xyz"[c], (int)node, body);
    }
  return CT_OK;
}

static ct_status allocate(ct_side *side)
{
  size_t faces = (size_t)side->face_count, points = faces * (size_t)side->rule.count, hosts = (size_t)side->host_count;
  side->nodes = ct_allocate(hosts, sizeof *side->nodes);
  side->faces = ct_allocate(faces * (size_t)side->per, sizeof *side->faces);
  side->neighbour = ct_allocate(faces * (size_t)side->edges, sizeof *side->neighbour);
  side->ring = ct_allocate(faces * (size_t)side->per, sizeof *side->ring);
  side->weight = ct_allocate(points, sizeof *side->weight);
  side->boxes = ct_allocate(faces, sizeof *side->boxes);
  side->candidate_first = ct_allocate(faces + 1, sizeof *side->candidate_first);
  side->points = ct_allocate(points, sizeof *side->points);
  return side->nodes != NULL && side->faces != NULL && side->neighbour != NULL && side->ring != NULL && side->weight != NULL &&
                 side->boxes != NULL && side->candidate_first != NULL && side->points != NULL
             ? CT_OK
             : CT_ERROR_MEMORY;
}

/* Number the surface's own nodes and list the faces around each. */
static ct_status number_nodes(ct_side *side, const ct_surface *surface)
{
  size_t entries = (size_t)side->face_count * (size_t)side->per;
  int32_t *own = ct_allocate((size_t)side->host_count, sizeof *own);
  if (own == NULL) return CT_ERROR_MEMORY;
  for (size_t i = 0; i < entries; i++) own[surface->faces[i]] = 1;
  for (int32_t n = 0; n < side->host_count; n++)
    if (own[n]) {
      side->nodes[side->node_count] = n;
      own[n] = side->node_count++;
    }
  for (size_t i = 0; i < entries; i++) side->faces[i] = own[surface->faces[i]];
  ct_release(own);

  size_t nodes = (size_t)side->node_count;
  side->ring_first = ct_allocate(nodes + 1, sizeof *side->ring_first);
  side->x = ct_allocate(3 * nodes, sizeof *side->x);
  side->x_built = ct_allocate(3 * nodes, sizeof *side->x_built);
  side->force = ct_allocate(3 * nodes, sizeof *side->force);
  side->force_fine = ct_allocate(3 * nodes, sizeof *side->force_fine);
  if (!side->ring_first || !side->x || !side->x_built || !side->force || !side->force_fine) return CT_ERROR_MEMORY;
  for (size_t i = 0; i < entries; i++) side->ring_first[side->faces[i] + 1]++;
  for (size_t n = 0; n < nodes; n++) side->ring_first[n + 1] += side->ring_first[n];
  for (size_t i = entries; i-- > 0;) side->ring[--side->ring_first[side->faces[i] + 1]] = (int32_t)(i / (size_t)side->per);
  // The filling has moved each end to its beginning: shift the table back by one.
  for (size_t n = 0; n < nodes; n++) side->ring_first[n] = side->ring_first[n + 1];
  side->ring_first[nodes] = (int32_t)entries;
  return CT_OK;
}

static void find_neighbours(ct_side *side)
{
  for (int32_t f = 0; f < side->face_count; f++)
    for (int e = 0; e < side->edges; e++) {
      const int32_t *mine = &side->faces[(int64_t)f * side->per];
      int32_t a = mine[e], b = mine[(e + 1) % side->edges], found = -1;
      for (int32_t i = side->ring_first[a]; i < side->ring_first[a + 1]; i++) {
        const int32_t *theirs = &side->faces[(int64_t)side->ring[i] * side->per];
        for (int k = 0; k < side->edges; k++)
          if (side->ring[i] != f && theirs[k] == b && theirs[(k + 1) % side->edges] == a) found = side->ring[i];
      }
      side->neighbour[(int64_t)f * side->edges + e] = found;
    }
}

/* Weights w J_ref of the Gauss points (eq:contact-potential). */
static ct_status weigh(ct_side *side, int body, ct_error *error)
{
  for (int q = 0; q < side->rule.count; q++) ct_segment_shape(side->kind, side->rule.xi[q], side->N[q]);
  for (int32_t f = 0; f < side->face_count; f++) {
    ct_face face;
    ct_side_face(side, f, &face);
    ct_bounds box = ct_face_bounds(&face);
    double edge[3] = {box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]};
    double size = sqrt(ct_vector_dot(edge, edge));
    side->size = fmax(side->size, size);
    for (int q = 0; q < side->rule.count; q++) {
      double J = ct_segment_area_element(&face, side->rule.xi[q]);
      if (!(J > 1e-14 * size * size))
        return ct_fail(error, CT_ERROR_GEOMETRY, (ct_place){body, f, q}, "face %d of surface %d has no area at Gauss point %d", (int)f,
                       body, q);
      side->weight[(int64_t)f * side->rule.count + q] = side->rule.weight[q] * J;
    }
  }
  return CT_OK;
}

ct_status ct_side_init(ct_side *side, const ct_surface *surface, int body, ct_error *error)
{
  memset(side, 0, sizeof *side);
  ct_status status = check_surface(surface, body, error);
  if (status != CT_OK) return status;
  side->kind = surface->kind;
  side->per = ct_face_node_count(surface->kind);
  side->edges = surface->kind == CT_Q4 || surface->kind == CT_Q8 ? 4 : 3;
  side->face_count = surface->face_count;
  side->host_count = surface->node_count;
  ct_rule_face(surface->kind, 0, &side->rule);
  if (allocate(side) != CT_OK || number_nodes(side, surface) != CT_OK ||
      ct_search_create(side->face_count, &side->search, error) != CT_OK) {
    ct_side_clear(side);
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a contact surface");
  }
  find_neighbours(side);
  status = ct_side_move(side, surface->reference, body, error);
  if (status == CT_OK) status = weigh(side, body, error);
  for (int64_t i = 0; i < (int64_t)side->face_count * side->rule.count; i++) {
    side->points[i].other = -1;
    side->points[i].gap = NAN;
  }
  if (status != CT_OK) ct_side_clear(side);
  return status;
}

ct_status ct_side_move(ct_side *side, const double *host, int body, ct_error *error)
{
  for (int32_t n = 0; n < side->node_count; n++)
    for (int c = 0; c < 3; c++)
      if (!isfinite(host[3 * (int64_t)side->nodes[n] + c]))
        return ct_fail(error, CT_INVALID, (ct_place){body, -1, side->nodes[n]}, "coordinate %c of node %d of surface %d is not finite",
                       "xyz"[c], (int)side->nodes[n], body);
  for (int32_t n = 0; n < side->node_count; n++)
    memcpy(&side->x[3 * (int64_t)n], &host[3 * (int64_t)side->nodes[n]], 3 * sizeof *side->x);
  for (int32_t f = 0; f < side->face_count; f++) {
    ct_face face;
    ct_side_face(side, f, &face);
    side->boxes[f] = ct_face_bounds(&face);
  }
  return CT_OK;
}

void ct_side_face(const ct_side *side, int32_t face, ct_face *out)
{
  out->kind = side->kind;
  for (int a = 0; a < side->per; a++)
    memcpy(out->node[a], &side->x[3 * (int64_t)side->faces[(int64_t)face * side->per + a]], sizeof out->node[a]);
}

ct_bounds ct_face_bounds(const ct_face *face)
{
  int per = ct_face_node_count(face->kind), corners = per == 4 || per == 8 ? 4 : 3;
  ct_bounds box;
  for (int c = 0; c < 3; c++) {
    box.low[c] = box.high[c] = face->node[0][c];
    for (int a = 1; a < per; a++) {
      box.low[c] = fmin(box.low[c], face->node[a][c]);
      box.high[c] = fmax(box.high[c], face->node[a][c]);
    }
    // -- Widen the box by how far mid-sides pull the face out of it (eq:face-bounds)
    double pull[4] = {0.0};
    for (int e = 0; per > corners && e < corners; e++)
      pull[e] = fabs(face->node[corners + e][c] - 0.5 * (face->node[e][c] + face->node[(e + 1) % corners][c]));
    double bulge = (pull[0] + pull[2]) + (pull[1] + pull[3]);
    box.low[c] -= bulge;
    box.high[c] += bulge;
  }
  return box;
}

void ct_side_interpolate(const ct_side *side, int32_t face, const double N[8], const double origin[3], double out[3])
{
  const int32_t *node = &side->faces[(int64_t)face * side->per];
  for (int c = 0; c < 3; c++) {
    double t[8] = {0.0};
    for (int a = 0; a < side->per; a++) t[a] = N[a] * (side->x[3 * (int64_t)node[a] + c] - origin[c]);
    out[c] = (t[0] + t[1]) + (t[2] + t[3]);
    if (side->per > 4) out[c] += (t[4] + t[6]) + (t[5] + t[7]);
  }
}

/* Parameters of the point on edge `e` at s in -1 ... 1 from its first corner to its second. */
static void edge_point(int edges, int e, double s, double xi[2])
{
  static const double square[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, triangle[3][2] = {{0, 0}, {1, 0}, {0, 1}};
  const double(*corner)[2] = edges == 4 ? square : triangle;
  for (int i = 0; i < 2; i++) xi[i] = 0.5 * ((1.0 - s) * corner[e][i] + (1.0 + s) * corner[(e + 1) % edges][i]);
}

static void add_normal(const ct_side *side, int32_t face, const double xi[2], double weight, double sum[3])
{
  ct_face f;
  double n[3];
  ct_side_face(side, face, &f);
  if (ct_segment_normal(&f, xi, n) != CT_OK) return;
  for (int c = 0; c < 3; c++) sum[c] += weight * n[c];
}

/* On edge `e` of a face: add the neighbour's normal at the same point; 0 at the border. */
static int edge_normal(const ct_side *side, int32_t face, int e, const double foot[2], double normal[3])
{
  const int32_t *mine = &side->faces[(int64_t)face * side->per];
  int32_t other = side->neighbour[(int64_t)face * side->edges + e];
  if (other < 0) return 0;
  double first[2], last[2], xi[2];
  edge_point(side->edges, e, -1.0, first);
  edge_point(side->edges, e, 1.0, last);
  double along[2] = {last[0] - first[0], last[1] - first[1]}, here[2] = {foot[0] - first[0], foot[1] - first[1]};
  double s = 2.0 * (along[0] * here[0] + along[1] * here[1]) / (along[0] * along[0] + along[1] * along[1]) - 1.0;
  const int32_t *theirs = &side->faces[(int64_t)other * side->per];
  for (int k = 0; k < side->edges; k++)
    if (theirs[k] == mine[(e + 1) % side->edges] && theirs[(k + 1) % side->edges] == mine[e]) {
      edge_point(side->edges, k, -s, xi);
      add_normal(side, other, xi, 1.0, normal);
    }
  return 1;
}

/* At corner `a` of a face: sum the normals of the faces around it, weighted by their angles; 0 at the border. */
static int corner_normal(const ct_side *side, int32_t face, int a, double normal[3])
{
  int32_t node = side->faces[(int64_t)face * side->per + a];
  for (int c = 0; c < 3; c++) normal[c] = 0.0;
  for (int32_t i = side->ring_first[node]; i < side->ring_first[node + 1]; i++) {
    int32_t f = side->ring[i];
    const int32_t *nodes = &side->faces[(int64_t)f * side->per];
    for (int k = 0; k < side->edges; k++) {
      if (nodes[k] != node) continue;
      int before = (k + side->edges - 1) % side->edges;
      if (side->neighbour[(int64_t)f * side->edges + k] < 0 || side->neighbour[(int64_t)f * side->edges + before] < 0) return 0;
      double u[3], v[3], w[3], xi[2];
      for (int c = 0; c < 3; c++) {
        u[c] = side->x[3 * (int64_t)nodes[(k + 1) % side->edges] + c] - side->x[3 * (int64_t)node + c];
        v[c] = side->x[3 * (int64_t)nodes[before] + c] - side->x[3 * (int64_t)node + c];
      }
      ct_vector_cross(u, v, w);
      edge_point(side->edges, k, -1.0, xi);
      add_normal(side, f, xi, atan2(sqrt(ct_vector_dot(w, w)), ct_vector_dot(u, v)), normal);
    }
  }
  return 1;
}

int ct_side_normal(const ct_side *side, int32_t face, const ct_projection *foot, double normal[3])
{
  memcpy(normal, foot->normal, 3 * sizeof *normal);
  if (foot->where == CT_EDGE) return edge_normal(side, face, foot->index, foot->xi, normal);
  if (foot->where == CT_VERTEX) return corner_normal(side, face, foot->index, normal);
  return foot->where == CT_INTERIOR;
}
