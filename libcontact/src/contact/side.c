/* One surface of a contact: its Gauss points and their weights. */
#include "side.h"

#include "../base/error.h"
#include "../base/memory.h"
#include "../base/vector.h"

#include <math.h>
#include <string.h>

void ct_side_clear(ct_side *side)
{
  void *blocks[] = {side->weight,          side->listed,     side->x_built, side->moved,
                    side->candidate_first, side->candidates, side->points,  side->reference,
                    side->force,           side->force_fine};
  for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; i++) ct_release(blocks[i]);
  ct_search_free(side->search);
  memset(side, 0, sizeof *side);
}

int64_t ct_side_point_count(const ct_side *side)
{
  return (int64_t)side->search->face_count * side->rule.count;
}

static ct_status allocate(ct_side *side)
{
  size_t faces = (size_t)side->search->face_count, points = (size_t)ct_side_point_count(side),
         nodes = (size_t)side->search->node_count;
  side->weight = ct_allocate(points, sizeof *side->weight);
  side->listed = ct_allocate(faces, sizeof *side->listed);
  side->candidate_first = ct_allocate(faces + 1, sizeof *side->candidate_first);
  side->candidate_room = side->search->face_count;
  side->candidates = ct_allocate(faces, sizeof *side->candidates);
  side->points = ct_allocate(points, sizeof *side->points);
  side->x_built = ct_allocate(3 * nodes, sizeof *side->x_built);
  side->moved = ct_allocate(3 * nodes, sizeof *side->moved);
  side->force = ct_allocate(3 * nodes, sizeof *side->force);
  side->force_fine = ct_allocate(3 * nodes, sizeof *side->force_fine);
  int whole = side->weight && side->listed && side->candidate_first && side->candidates &&
              side->points && side->x_built && side->moved && side->force && side->force_fine;
  return whole ? CT_OK : CT_ERROR_MEMORY;
}

/* Weights w J_ref of the Gauss points (eq:contact-potential). */
static ct_status weigh(ct_side *side, int body, ct_error *error)
{
  for (int q = 0; q < side->rule.count; q++) {
    ct_segment_shape(side->search->kind, side->rule.xi[q], side->N[q]);
    ct_segment_gradient(side->search->kind, side->rule.xi[q], side->dN[q]);
  }
  for (int32_t f = 0; f < side->search->face_count; f++) {
    ct_face face;
    ct_search_face(side->search, f, &face);
    const ct_bounds *box = &side->search->boxes[f];
    double square = 0.0;
    for (int c = 0; c < 3; c++)
      square += (box->high[c] - box->low[c]) * (box->high[c] - box->low[c]);
    for (int q = 0; q < side->rule.count; q++) {
      double J = ct_segment_area_element(&face, side->rule.xi[q]);
      if (!(J > 1e-14 * square))
        return ct_fail(error, CT_ERROR_GEOMETRY, (ct_place){body, f, q},
                       "face %d of surface %d has no area at Gauss point %d", (int)f, body, q);
      side->weight[(int64_t)f * side->rule.count + q] = side->rule.weight[q] * J;
    }
  }
  return CT_OK;
}

ct_status ct_side_init(ct_side *side, const ct_surface *surface, int body, int on_edges,
                       ct_error *error)
{
  memset(side, 0, sizeof *side);
  ct_status status = ct_search_init(surface, body, &side->search, error);
  if (status != CT_OK) return status;
  side->on_edges = on_edges;
  (void)(on_edges ? ct_rule_lobatto(surface->kind, &side->rule)
                  : ct_rule_face(surface->kind, 0, &side->rule));
  status = allocate(side) == CT_OK
               ? weigh(side, body, error)
               : ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a contact surface");
  if (status != CT_OK) {
    ct_side_clear(side);
    return status;
  }
  for (int64_t i = 0; i < ct_side_point_count(side); i++) {
    side->points[i].other = -1;
    side->points[i].gap = side->points[i].known = NAN;
  }
  return CT_OK;
}

/* Σ_a w_a (x_a - origin) over `per` nodes. Written to be compiled for a `per` that is known. */
static inline void sum_nodes(int per, const int32_t *node, const double *x, const double *weight,
                             int stride, const double origin[3], double out[3])
{
  double t[3][8] = {{0.0}};
  for (int a = 0; a < per; a++)
    for (int c = 0; c < 3; c++)
      t[c][a] = weight[stride * a] * (x[3 * (int64_t)node[a] + c] - origin[c]);
  for (int c = 0; c < 3; c++) out[c] = ct_side_sum(per, t[c]);
}

static void interpolate(const ct_search *search, const double *x, int32_t face, const double N[8],
                        const double origin[3], double out[3])
{
  const int32_t *node = &search->faces[(int64_t)face * search->per];
  switch (search->per) {
  case 4:
    sum_nodes(4, node, x, N, 1, origin, out);
    break;
  case 8:
    sum_nodes(8, node, x, N, 1, origin, out);
    break;
  default:
    sum_nodes(search->per, node, x, N, 1, origin, out);
  }
}

void ct_side_interpolate(const ct_side *side, int32_t face, const double N[8],
                         const double origin[3], double out[3])
{
  interpolate(side->search, side->search->x, face, N, origin, out);
}

void ct_side_interpolate_reference(const ct_side *side, int32_t face, const double N[8],
                                   const double origin[3], double out[3])
{
  interpolate(side->search, side->reference, face, N, origin, out);
}

void ct_side_place(ct_side *side, const double *host)
{
  const size_t entries = 3 * (size_t)side->search->node_count;
  memcpy(side->moved, side->search->x, entries * sizeof *side->moved);
  ct_search_place(side->search, host);
  for (size_t i = 0; i < entries; i++) side->moved[i] = side->search->x[i] - side->moved[i];
}

void ct_side_moved(const ct_side *side, int32_t face, const double N[8], double out[3])
{
  static const double zero[3] = {0.0, 0.0, 0.0};
  interpolate(side->search, side->moved, face, N, zero, out);
}

int ct_side_direction(const ct_side *side, const ct_gauss_point *point, double n[3])
{
  double length = sqrt(ct_vector_dot(point->d, point->d)),
         sign = ct_point_distance(point) < 0.0 ? 1.0 : -1.0;
  if (length > 1e-12 * side->search->size) {
    for (int c = 0; c < 3; c++) n[c] = sign * point->d[c] / length;
    return 1;
  }
  memcpy(n, point->normal, sizeof point->normal);
  length = sqrt(ct_vector_dot(n, n));
  for (int c = 0; c < 3; c++) n[c] /= length;
  return length > 0.0;
}

void ct_side_area(const ct_side *side, int32_t face, int q, double normal[3])
{
  static const double zero[3] = {0.0, 0.0, 0.0};
  const ct_search *search = side->search;
  const int32_t *node = &search->faces[(int64_t)face * search->per];
  double tangent[2][3];
  for (int i = 0; i < 2; i++) {
    const double *weight = &side->dN[q][0][i];
    if (search->per == 4) sum_nodes(4, node, search->x, weight, 2, zero, tangent[i]);
    else sum_nodes(search->per, node, search->x, weight, 2, zero, tangent[i]);
  }
  ct_vector_cross(tangent[0], tangent[1], normal);
}
