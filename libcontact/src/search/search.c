/* A surface: its topology, its current shape, its tree of boxes. */
#include "search_internal.h"

#include "../base/error.h"
#include "../base/lanes.h"
#include "../base/memory.h"
#include "../base/stream.h"
#include "../base/vector.h"

#include <math.h>
#include <string.h>

void ct_search_free(ct_search *search)
{
  if (search == NULL) return;
  ct_box_tree_free(search->tree);
  ct_pool_free(search);
}

static ct_status check_surface(const ct_surface *surface, int body, ct_error *error)
{
  int per = surface == NULL ? 0 : ct_face_node_count(surface->kind);
  const ct_place where = {body, -1, -1};
  if (surface != NULL && per == 0)
    return ct_fail(error, CT_ERROR_ARGUMENT, where, "surface %d: there is no face of the kind %d",
                   body, (int)surface->kind);
  if (surface == NULL || surface->faces == NULL || surface->reference == NULL ||
      surface->face_count < 1 || surface->node_count < 1)
    return ct_fail(error, CT_ERROR_ARGUMENT, where, "surface %d has no faces or no nodes", body);
  for (int32_t f = 0; f < surface->face_count; f++)
    for (int a = 0; a < per; a++) {
      int32_t node = surface->faces[(int64_t)f * per + a];
      if (node < 0 || node >= surface->node_count)
        return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){body, f, -1},
                       "face %d of surface %d names node %d, there are nodes 0 to %d", (int)f, body,
                       (int)node, (int)surface->node_count - 1);
    }
  return CT_OK;
}

/* Number the surface's own nodes and allocate the rest. */
static ct_status allocate(ct_search *search, const ct_surface *surface)
{
  size_t faces = (size_t)search->face_count, per = (size_t)search->per;
  ct_pool *pool = &search->pool;
  search->faces = ct_pool_take(pool, faces * per, sizeof *search->faces);
  search->neighbour = ct_pool_take(pool, faces * (size_t)search->edges, sizeof *search->neighbour);
  search->boxes = ct_pool_take(pool, faces, sizeof *search->boxes);
  if (pool->failed || ct_incidence_init(&search->incidence, (int64_t)(faces * per), surface->faces,
                                        search->host_count, search->faces, pool) != CT_OK)
    return CT_ERROR_MEMORY;
  search->nodes = search->incidence.nodes;
  search->node_count = search->incidence.count;
  search->x = ct_pool_take(pool, 3 * (size_t)search->node_count + 1, sizeof *search->x);
  return search->x == NULL ? CT_ERROR_MEMORY : CT_OK;
}

/* Find the face across each edge: one that has the same two corners in reverse order. */
static void find_neighbours(ct_search *search)
{
  const ct_incidence *around = &search->incidence;
  for (int32_t f = 0; f < search->face_count; f++)
    for (int e = 0; e < search->edges; e++) {
      const int32_t *mine = &search->faces[(int64_t)f * search->per];
      int32_t a = mine[e], b = mine[(e + 1) % search->edges], found = -1;
      for (int32_t i = around->first[a]; i < around->first[a + 1]; i++) {
        int32_t other = around->place[i] / search->per, k = around->place[i] % search->per;
        const int32_t *theirs = &search->faces[(int64_t)other * search->per];
        if (other != f && k < search->edges && theirs[(k + search->edges - 1) % search->edges] == b)
          found = other;
      }
      search->neighbour[(int64_t)f * search->edges + e] = found;
    }
}

/* The largest distance of two nodes of a face, however the face is turned. */
static double diameter(const ct_face *face, int per)
{
  double most = 0.0;
  for (int a = 0; a < per; a++)
    for (int b = 0; b < a; b++) {
      double d[3];
      for (int c = 0; c < 3; c++) d[c] = face->node[a][c] - face->node[b][c];
      most = fmax(most, ct_vector_dot(d, d));
    }
  return sqrt(most);
}

/* Refuse faces without area, and find the size of the largest one. */
static ct_status measure(ct_search *search, int body, ct_error *error)
{
  for (int32_t f = 0; f < search->face_count; f++) {
    ct_face face;
    ct_search_face(search, f, &face);
    double size = diameter(&face, search->per);
    search->size = fmax(search->size, size);
    if (!(ct_segment_area_element(&face, ct_search_middle(search)) > 1e-14 * size * size))
      return ct_fail(error, CT_ERROR_GEOMETRY, (ct_place){body, f, -1},
                     "face %d of surface %d has no area", (int)f, body);
  }
  return CT_OK;
}

ct_status ct_search_check(const ct_search *search, const int32_t *nodes, const double *x, int body,
                          ct_error *error)
{
  if (nodes == NULL && ct_largest(x, 3 * (int64_t)search->node_count) <= CT_LARGEST_LENGTH)
    return CT_OK;
  for (int32_t n = 0; n < search->node_count; n++)
    for (int c = 0; c < 3; c++)
      if (!(fabs(x[3 * (int64_t)(nodes == NULL ? n : nodes[n]) + c]) <= CT_LARGEST_LENGTH))
        return ct_fail(error, CT_INVALID, (ct_place){body, -1, search->nodes[n]},
                       "coordinate %c of node %d of surface %d is %g, not finite or beyond %g",
                       "xyz"[c], (int)search->nodes[n], body,
                       x[3 * (int64_t)(nodes == NULL ? n : nodes[n]) + c], CT_LARGEST_LENGTH);
  return CT_OK;
}

/* Boxes of quadrilaterals of four nodes. The number behind a node has no meaning. */
CT_CLONES
static void box_corners(ct_search *search)
{
  for (int32_t f = 0; f < search->face_count; f++) {
    const int32_t *node = &search->faces[4 * (int64_t)f];
    const double *x[4];
    double low[4], high[4];
    for (int a = 0; a < 4; a++) x[a] = &search->x[3 * (int64_t)node[a]];
#pragma omp simd
    for (int c = 0; c < 4; c++) {
      const double low0 = x[0][c] < x[1][c] ? x[0][c] : x[1][c],
                   low1 = x[2][c] < x[3][c] ? x[2][c] : x[3][c],
                   high0 = x[0][c] > x[1][c] ? x[0][c] : x[1][c],
                   high1 = x[2][c] > x[3][c] ? x[2][c] : x[3][c];
      low[c] = low0 < low1 ? low0 : low1;
      high[c] = high0 > high1 ? high0 : high1;
    }
    ct_bounds *box = &search->boxes[f];
    for (int c = 0; c < 3; c++) box->low[c] = low[c];
    for (int c = 0; c < 3; c++) box->high[c] = high[c];
  }
}

void ct_search_box(ct_search *search)
{
  if (search->kind == CT_Q4) {
    box_corners(search);
    return;
  }
  for (int32_t f = 0; f < search->face_count; f++) {
    ct_face face;
    ct_search_face(search, f, &face);
    search->boxes[f] = ct_face_bounds(&face);
  }
}

/* Check and copy the host's coordinates, and compute the boxes of the faces. */
static ct_status set(ct_search *search, const double *host, int body, ct_error *error)
{
  ct_status status = ct_search_check(search, search->nodes, host, body, error);
  if (status != CT_OK) return status;
  for (int32_t n = 0; n < search->node_count; n++)
    memcpy(&search->x[3 * (int64_t)n], &host[3 * (int64_t)search->nodes[n]], 3 * sizeof *search->x);
  ct_search_box(search);
  return CT_OK;
}

ct_status ct_search_init(const ct_surface *surface, int body, ct_search **out, ct_error *error)
{
  ct_status status = check_surface(surface, body, error);
  if (status != CT_OK) return status;
  ct_search *search = ct_allocate(1, sizeof *search);
  if (search == NULL) return CT_NO_MEMORY(error, "a surface");
  search->kind = surface->kind;
  search->per = ct_face_node_count(surface->kind);
  search->edges = surface->kind == CT_Q4 || surface->kind == CT_Q8 ? 4 : 3;
  search->face_count = surface->face_count;
  search->host_count = surface->node_count;
  if (allocate(search, surface) != CT_OK) {
    status = CT_NO_MEMORY(error, "a surface");
  } else {
    find_neighbours(search);
    status = set(search, surface->reference, body, error);
  }
  if (status == CT_OK) status = measure(search, body, error);
  if (status == CT_OK) *out = search;
  else ct_search_free(search);
  return status;
}

void ct_search_refit(ct_search *search)
{
  for (int32_t f = 0; search->oriented != NULL && f < search->face_count; f++) {
    ct_face face;
    ct_search_face(search, f, &face);
    ct_oriented_init(&search->oriented[f], &face);
  }
  ct_box_tree_refit(search->tree, search->boxes);
}

ct_status ct_search_equip(ct_search *search)
{
  size_t faces = (size_t)search->face_count;
  ct_pool *pool = &search->pool;
  if (search->boxes == NULL) search->boxes = ct_pool_take(pool, faces, sizeof *search->boxes);
  if (pool->failed || ct_box_tree_create(search->face_count, &search->tree, NULL) != CT_OK)
    return CT_ERROR_MEMORY;
  ct_search_box(search);
  return CT_OK;
}

/* The same with boxes along the faces, for many points, and the tree. */
static ct_status equip_fully(ct_search *search)
{
  if (search->kind != CT_T3)
    search->oriented =
        ct_pool_take(&search->pool, (size_t)search->face_count, sizeof *search->oriented);
  if (ct_search_equip(search) != CT_OK) return CT_ERROR_MEMORY;
  ct_search_refit(search);
  return CT_OK;
}

ct_status ct_search_share(const ct_search *search, ct_search **out)
{
  ct_search *own = ct_allocate(1, sizeof *own);
  if (own == NULL) return CT_ERROR_MEMORY;
  *own = *search;
  own->pool = (ct_pool){NULL, 0};
  own->boxes = NULL;
  own->oriented = NULL;
  own->tree = NULL;
  own->x = ct_pool_copy(&own->pool, search->x, (3 * (size_t)own->node_count + 1) * sizeof *own->x);
  if (own->pool.failed) {
    ct_search_free(own);
    return CT_ERROR_MEMORY;
  }
  *out = own;
  return CT_OK;
}

ct_status ct_search_snapshot(const ct_search *search, ct_search **out)
{
  ct_status status = ct_search_share(search, out);
  return status == CT_OK ? equip_fully(*out) : status;
}

void ct_search_face(const ct_search *search, int32_t face, ct_face *out)
{
  out->kind = search->kind;
  for (int a = 0; a < search->per; a++)
    memcpy(out->node[a], &search->x[3 * (int64_t)search->faces[(int64_t)face * search->per + a]],
           sizeof out->node[a]);
}

int ct_search_adjacent(const ct_search *search, int32_t face, int32_t other)
{
  const int32_t *mine = &search->faces[(int64_t)face * search->per],
                *theirs = &search->faces[(int64_t)other * search->per];
  for (int a = 0; a < search->per; a++)
    for (int b = 0; b < search->per; b++)
      if (mine[a] == theirs[b]) return 1;
  return 0;
}

ct_status ct_search_create(const ct_surface *surface, ct_search **out, ct_error *error)
{
  if (surface == NULL || out == NULL) return CT_REFUSE_NULL(error);
  ct_search *search = NULL;
  ct_status status = ct_search_init(surface, 0, &search, error);
  if (status != CT_OK) return status;
  if (equip_fully(search) != CT_OK) {
    ct_search_free(search);
    return CT_NO_MEMORY(error, "a surface");
  }
  *out = search;
  return CT_OK;
}

ct_status ct_search_move(ct_search *search, const double *x, ct_error *error)
{
  if (search == NULL || x == NULL) return CT_REFUSE_NULL(error);
  ct_status status = set(search, x, 0, error);
  if (status == CT_OK) ct_search_refit(search);
  return status;
}

int64_t ct_search_builds(const ct_search *search)
{
  return search == NULL ? 0 : ct_box_tree_builds(search->tree);
}

double ct_search_cost(const ct_search *search)
{
  return search == NULL ? NAN : ct_box_tree_cost(search->tree);
}
