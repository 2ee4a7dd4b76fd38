/* One surface of a contact: its points, their weights and positions. */
#include "side.h"

#include "../base/error.h"
#include "../base/lanes.h"
#include "../base/memory.h"
#include "../base/vector.h"

#include <float.h>
#include <math.h>
#include <string.h>

void ct_side_fixed_clear(ct_side_fixed *fixed)
{
  ct_release(fixed->weight);
  ct_release(fixed->row_faces);
  ct_search_free(fixed->search);
  memset(fixed, 0, sizeof *fixed);
}

/* Weights w J_ref of the points (eq:contact-potential). */
static ct_status weigh(ct_side_fixed *fixed, int body, ct_error *error)
{
  const ct_search *search = fixed->search;
  for (int q = 0; q < fixed->rule.count; q++) {
    ct_segment_shape(search->kind, fixed->rule.xi[q], fixed->N[q]);
    ct_segment_gradient(search->kind, fixed->rule.xi[q], fixed->dN[q]);
    for (int a = 0; a < search->per; a++) fixed->across[a][q] = fixed->N[q][a];
  }
  for (int32_t f = 0; f < search->face_count; f++) {
    ct_face face;
    ct_search_face(search, f, &face);
    const ct_bounds *box = &search->boxes[f];
    double square = 0.0;
    for (int c = 0; c < 3; c++)
      square += (box->high[c] - box->low[c]) * (box->high[c] - box->low[c]);
    for (int q = 0; q < fixed->rule.count; q++) {
      double J = ct_segment_area_element(&face, fixed->rule.xi[q]);
      if (!(J > 1e-14 * square))
        return ct_fail(error, CT_ERROR_GEOMETRY, (ct_place){body, f, q},
                       "face %d of surface %d has no area at point %d", (int)f, body, q);
      // -- w J_ref, constant in time (eq:contact-potential)
      fixed->weight[(int64_t)f * fixed->rule.count + q] = fixed->rule.weight[q] * J;
    }
  }
  return CT_OK;
}

ct_status ct_side_fixed_init(ct_side_fixed *fixed, const ct_surface *surface, int body,
                             int on_edges, ct_error *error)
{
  memset(fixed, 0, sizeof *fixed);
  ct_status status = ct_search_init(surface, body, &fixed->search, error);
  if (status != CT_OK) return status;
  fixed->on_edges = on_edges;
  (void)(on_edges ? ct_rule_lobatto(surface->kind, &fixed->rule)
                  : ct_rule_face(surface->kind, &fixed->rule, NULL));
  fixed->point_count = (int64_t)surface->face_count * fixed->rule.count;
  fixed->weight = ct_allocate((size_t)fixed->point_count, sizeof *fixed->weight);
  status =
      fixed->weight != NULL ? weigh(fixed, body, error) : CT_NO_MEMORY(error, "a contact surface");
  if (status != CT_OK) ct_side_fixed_clear(fixed);
  return status;
}

void ct_side_clear(ct_side *side)
{
  void *blocks[] = {
      side->listed,     side->x_built, side->moved,    side->points, side->candidate_first,
      side->candidates, side->force,   side->near_end, side->met,    side->distant,
      side->runs,       side->creased};
  for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; i++) ct_release(blocks[i]);
  if (side->fixed != NULL && side->fixed->kind == CT_SIDE_SURFACE) ct_search_free(side->search);
  memset(side, 0, sizeof *side);
}

const int32_t *ct_side_row_nodes(const ct_side_fixed *fixed, int64_t face)
{
  const int32_t *faces = fixed->row_faces != NULL ? fixed->row_faces : fixed->search->faces;
  return &faces[face * fixed->search->per];
}

ct_status ct_side_init(ct_side *side, const ct_side_fixed *fixed)
{
  size_t nodes = (size_t)fixed->search->node_count;
  memset(side, 0, sizeof *side);
  side->fixed = fixed;
  side->points = ct_allocate((size_t)fixed->point_count, sizeof *side->points);
  side->force = ct_allocate(3 * nodes + 1, 2 * sizeof *side->force);
  side->moved = ct_allocate(3 * nodes + 1, sizeof *side->moved);
  if (!side->points || !side->force || !side->moved ||
      ct_search_share(fixed->search, &side->search) != CT_OK)
    return CT_ERROR_MEMORY;
  side->force_fine = side->force + 3 * nodes + 1;
  return CT_OK;
}

void ct_side_fill(ct_side *side, const ct_constraint *law)
{
  const ct_side_fixed *fixed = side->fixed;
  for (ct_span run = {0}; ct_side_next(side, &run);)
    for (int64_t i = run.first; i < run.end; i++) {
      ct_point *point = &side->points[i];
      point->other = -1;
      point->known = NAN;
      point->row = *law;
      point->row.own_count = fixed->search->per;
      point->row.own = ct_side_row_nodes(fixed, i / fixed->rule.count);
      point->row.own_shape = fixed->N[i % fixed->rule.count];
      point->row.other_shape = point->N;
      point->row.stiffness = law->stiffness * fixed->weight[i];
      point->row.gap = NAN;
    }
}

ct_status ct_side_equip(ct_side *side)
{
  size_t faces = (size_t)side->search->face_count, nodes = (size_t)side->search->node_count;
  const size_t lanes = (size_t)side->fixed->point_count + 7; // eight are read at a time
  side->candidate_capacity = side->search->face_count;
  side->listed = ct_allocate(faces, sizeof *side->listed);
  side->candidate_first = ct_allocate(faces + 1, sizeof *side->candidate_first);
  side->candidates = ct_allocate(faces, sizeof *side->candidates);
  side->x_built = ct_allocate(nodes, 3 * sizeof *side->x_built);
  side->near_end = ct_allocate(faces, sizeof *side->near_end);
  side->met = ct_allocate(lanes, sizeof *side->met);
  side->distant = ct_allocate(lanes, sizeof *side->distant);
  int whole = side->listed && side->candidate_first && side->candidates && side->near_end &&
              side->met && side->distant && side->x_built;
  return whole ? ct_search_equip(side->search) : CT_ERROR_MEMORY;
}

/* The runs of the faces or stations of this piece, as points; returns their number. Null: only
 * counted. */
static int32_t list_runs(int64_t count, int per, const uint8_t *owned, ct_span *runs)
{
  int32_t some = 0;
  for (int64_t i = 0, end; i < count; i = end + 1) {
    while (i < count && !owned[i]) i++;
    for (end = i; end < count && owned[end]; end++) {
    }
    if (i < end && runs != NULL) runs[some] = (ct_span){i * per, end * per, some + 1};
    some += i < end;
  }
  return some;
}

ct_status ct_side_divide(ct_side *side, const uint8_t *owned)
{
  const int stations = side->fixed->kind == CT_SIDE_STATIONS;
  const int64_t count = stations ? 1 : side->search->face_count;
  const int per = stations ? (int)side->fixed->point_count : side->fixed->rule.count;
  const int32_t some = list_runs(count, per, owned, NULL);
  ct_span *runs = ct_allocate((size_t)some + 1, sizeof *runs);
  if (runs == NULL) return CT_ERROR_MEMORY;
  list_runs(count, per, owned, runs);
  ct_release(side->runs);
  side->runs = runs;
  side->run_count = some;
  return CT_OK;
}

/* Σ_a w_a (x_a - origin) over `per` nodes, written to be inlined with a known `per`. */
static inline void sum_nodes(int per, const int32_t *node, const double *x, const double *weight,
                             int stride, const double origin[3], double out[3])
{
  double t[3][8] = {{0.0}};
  for (int a = 0; a < per; a++)
    for (int c = 0; c < 3; c++)
      t[c][a] = weight[stride * a] * (x[3 * (int64_t)node[a] + c] - origin[c]);
  for (int c = 0; c < 3; c++) out[c] = ct_side_sum(per, t[c]);
}

void ct_side_interpolate(const ct_search *search, const double *x, int32_t face, const double N[8],
                         const double *origin, double out[3])
{
  static const double zero[3] = {0.0, 0.0, 0.0};
  if (origin == NULL) origin = zero;
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

void ct_side_position(const ct_side *side, int64_t i, const double *origin, double y[3])
{
  int32_t points = side->fixed->rule.count;
  ct_side_interpolate(side->search, side->search->x, (int32_t)(i / points),
                      side->fixed->N[i % points], origin, y);
}

double ct_side_rounding(const ct_side *sides, int count)
{
  double far = 0.0;
  for (int s = 0; s < count; s++) {
    const ct_search *search = sides[s].search;
    for (int64_t i = 0; i < 3 * (int64_t)search->node_count; i++)
      far = fmax(far, fabs(search->x[i]));
  }
  return 64.0 * DBL_EPSILON * far;
}

CT_CLONES_NODES
static void place(int64_t count, double *restrict moved, double *restrict x)
{
#pragma omp simd
  for (int64_t d = 0; d < count; d++) {
    const double now = moved[d];
    moved[d] = now - x[d];
    x[d] = now;
  }
}

void ct_side_place(ct_side *side)
{
  place(3 * (int64_t)side->search->node_count, side->moved, side->search->x);
}

void ct_side_direct(const ct_side *side, ct_point *point)
{
  const double gap = point->row.gap, *outward = point->outward;
  if (fabs(gap) > ct_side_coincident(side)) {
    for (int c = 0; c < 3; c++) point->row.normal[c] = point->d[c] / -gap;
    return;
  }
  const double length = sqrt(ct_vector_dot(outward, outward));
  for (int c = 0; c < 3; c++) point->row.normal[c] = outward[c] / length;
  point->row.gap = length > 0.0 ? ct_side_gap(side, gap) : NAN;
}

/* Normal of the surface at the place of a station. */
static void area_at(const ct_side *side, const ct_point *point, double normal[3])
{
  double tangent[2][3];
  ct_face face;
  ct_search_face(side->search, point->other, &face);
  ct_segment_tangents(&face, point->xi, tangent[0], tangent[1]);
  ct_vector_cross(tangent[0], tangent[1], normal);
}

void ct_side_area(const ct_side *side, int64_t i, double normal[3])
{
  if (side->fixed->kind == CT_SIDE_STATIONS) {
    area_at(side, &side->points[i], normal);
    return;
  }
  const int32_t points = side->fixed->rule.count;
  static const double zero[3] = {0.0, 0.0, 0.0};
  const ct_search *search = side->search;
  const int32_t *node = &search->faces[i / points * search->per];
  double tangent[2][3];
  for (int k = 0; k < 2; k++) {
    const double *weight = &side->fixed->dN[i % points][0][k];
    if (search->per == 4) sum_nodes(4, node, search->x, weight, 2, zero, tangent[k]);
    else sum_nodes(search->per, node, search->x, weight, 2, zero, tangent[k]);
  }
  ct_vector_cross(tangent[0], tangent[1], normal);
}
