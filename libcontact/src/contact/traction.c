/* Tractions at the nodes of a contact surface, recovered from the forces there
 * (eq:recovered-traction). */
#include "contact_internal.h"

#include "../base/error.h"
#include "../base/memory.h"
#include "../base/stream.h"
#include "../base/vector.h"

#include <math.h>
#include <string.h>

/* One surface for the recovery of tractions. */
typedef struct recovery {
  const ct_side *side;
  double *is_loaded; /* 1: a face carries forces, else 0, shape (face_count) */
  double part;       /* of a mid-side's force that each end of its edge takes */
  double chi[27][8]; /* at the points: the weights of the nodes, nowhere negative */
} recovery;

/* Mark the faces with forces of their own points, and those on which points of the other side,
 * unless it is null, act. */
static void mark_faces(const recovery *r, const ct_side *other)
{
  const ct_side *side = r->side;
  for (int64_t i = 0; i < side->fixed->point_count; i++)
    if (ct_point_has_force(&side->points[i])) r->is_loaded[i / side->fixed->rule.count] = 1.0;
  for (int64_t i = 0; other != NULL && i < other->fixed->point_count; i++)
    if (ct_point_has_force(&other->points[i])) r->is_loaded[other->points[i].other] = 1.0;
  ct_pieces_largest(side->pieces, r->is_loaded, side->search->face_count);
}

/* Add a fraction of a node's force to three sums. */
static void add_force(const ct_side *side, int32_t node, double share, ct_stream sum[3])
{
  for (int c = 0; c < 3; c++) {
    const int64_t dof = 3 * (int64_t)node + c;
    const double term = share * (side->force[dof] + side->force_fine[dof]);
    ct_stream_add(&sum[c], &term, 1);
  }
}

/* Weights of the nodes at a point of a face (eq:recovered-weights). */
static void weigh(const recovery *r, const double xi[2], double chi[8])
{
  const int edges = r->side->search->edges, per = r->side->search->per;
  double N[8];
  ct_segment_shape(r->side->search->kind, xi, N);
  for (int a = 0; a < per; a++) chi[a] = a < edges ? N[a] : (1.0 - 2.0 * r->part) * N[a];
  for (int a = 0; a < edges && per > edges; a++)
    chi[a] += r->part * (N[edges + a] + N[edges + (a + edges - 1) % edges]);
}

/* Force of a node (eq:recovered-traction): a mid-side keeps what the ends of its edge do not take.
 * Of the part that a corner takes every face around the mid-side adds an equal share. */
static void force_of(const recovery *r, int32_t node, double force[3])
{
  const ct_search *search = r->side->search;
  const ct_incidence *around = &search->incidence;
  const int edges = search->edges,
            corner = around->place[around->first[node]] % search->per < edges;
  ct_stream sum[3] = {{0}};
  while (ct_stream_again(sum, 3)) {
    add_force(r->side, node, corner ? 1.0 : 1.0 - 2.0 * r->part, sum);
    for (int32_t i = around->first[node]; corner && i < around->first[node + 1]; i++) {
      const int32_t *face = &search->faces[around->place[i] / search->per * search->per];
      int a = around->place[i] % search->per;
      const int beside[2] = {a, (a + edges - 1) % edges};
      for (int k = 0; k < 2 && search->per > edges; k++) {
        int32_t middle = face[edges + beside[k]];
        add_force(r->side, middle, r->part / (around->first[middle + 1] - around->first[middle]),
                  sum);
      }
    }
  }
  for (int c = 0; c < 3; c++) force[c] = ct_stream_sum(&sum[c]);
}

/* Fraction of the area at point `i` that takes a force (eq:recovered-fraction): 1 on a face that
 * carries forces, elsewhere the cosine between force and inward normal, where positive. */
static double fraction_of(const recovery *r, int64_t i, const double force[3])
{
  double n[3], square = ct_vector_dot(force, force);
  if (r->is_loaded[i / r->side->fixed->rule.count] > 0.0) return 1.0;
  if (square == 0.0) return 0.0;
  ct_side_area(r->side, i, n);
  // -- How much the surface faces the force (eq:recovered-fraction)
  return fmax(-ct_vector_dot(n, force) / sqrt(ct_vector_dot(n, n) * square), 0.0);
}

/* Area of a node with a force. */
static double area_of(const recovery *r, int32_t node, const double force[3])
{
  const ct_incidence *around = &r->side->search->incidence;
  const int per = r->side->search->per, points = r->side->fixed->rule.count;
  ct_stream sum = {0};
  while (ct_stream_again(&sum, 1))
    for (int32_t i = around->first[node]; i < around->first[node + 1]; i++) {
      const int64_t first = (int64_t)(around->place[i] / per) * points;
      double term[27];
      // -- Area under the node's weight that takes its force (eq:recovered-traction)
      for (int q = 0; q < points; q++)
        term[q] = r->chi[q][around->place[i] % per] * r->side->fixed->weight[first + q] *
                  fraction_of(r, first + q, force);
      ct_stream_add(&sum, term, points);
    }
  return ct_stream_sum(&sum);
}

/* Area and traction of a node, in sums that do not depend on their order (eq:recovered-traction).
 */
static double recover(const recovery *r, int32_t node, double traction[3])
{
  double force[3];
  force_of(r, node, force);
  // -- Force over area (eq:recovered-traction)
  double area = area_of(r, node, force);
  for (int c = 0; c < 3; c++) traction[c] = area > 0.0 ? force[c] / area : 0.0;
  return area;
}

ct_status ct_side_traction(const ct_side *side, const ct_side *other, double *traction,
                           double *area, ct_error *error)
{
  const ct_side_fixed *fixed = side->fixed;
  recovery r = {.side = side,
                .is_loaded = ct_allocate((size_t)side->search->face_count, sizeof *r.is_loaded)};
  if (r.is_loaded == NULL) return CT_NO_MEMORY(error, "tractions");
  // -- The smallest part for which no weight is negative (eq:recovered-weights)
  r.part = side->search->edges == 4 ? 3.0 / 8.0 : 1.0 / 4.0;
  for (int q = 0; q < fixed->rule.count; q++) weigh(&r, fixed->rule.xi[q], r.chi[q]);
  mark_faces(&r, other);
  for (int32_t n = 0; n < side->search->node_count; n++) {
    const int64_t node = side->search->nodes[n];
    area[node] = recover(&r, n, &traction[3 * node]);
  }
  ct_release(r.is_loaded);
  return CT_OK;
}
