/* Tractions at the nodes of a contact surface, recovered from the forces there
 * (eq:recovered-traction). */
#include "contact_internal.h"

#include "../base/error.h"
#include "../base/memory.h"
#include "../base/stream.h"
#include "../base/vector.h"
#include "../constraint/slip.h"

#include <math.h>
#include <string.h>

/* One surface for the recovery of tractions. */
typedef struct recovery {
  const ct_side *side;
  const double *force, *fine; /* two parts of the force of each node */
  double *is_loaded;          /* 1: a face carries forces, else 0, shape (face_count) */
  double part;                /* of a mid-side's force that each end of its edge takes */
  double chi[27][8];          /* at the points: the weights of the nodes, nowhere negative */
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
static void add_force(const recovery *r, int32_t node, double share, ct_stream sum[3])
{
  for (int c = 0; c < 3; c++) {
    const int64_t dof = 3 * (int64_t)node + c;
    const double term = share * (r->force[dof] + r->fine[dof]);
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
    add_force(r, node, corner ? 1.0 : 1.0 - 2.0 * r->part, sum);
    for (int32_t i = around->first[node]; corner && i < around->first[node + 1]; i++) {
      const int32_t *face = &search->faces[around->place[i] / search->per * search->per];
      int a = around->place[i] % search->per;
      const int beside[2] = {a, (a + edges - 1) % edges};
      for (int k = 0; k < 2 && search->per > edges; k++) {
        int32_t middle = face[edges + beside[k]];
        add_force(r, middle, r->part / (around->first[middle + 1] - around->first[middle]), sum);
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

/* The recovery of the forces without friction. */
static ct_status open_recovery(recovery *r, const ct_side *side, const ct_side *other,
                               ct_error *error)
{
  *r = (recovery){.side = side, .force = side->force, .fine = side->force_fine};
  r->is_loaded = ct_allocate((size_t)side->search->face_count, sizeof *r->is_loaded);
  if (r->is_loaded == NULL) return CT_NO_MEMORY(error, "tractions");
  // -- The smallest part for which no weight is negative (eq:recovered-weights)
  r->part = side->search->edges == 4 ? 3.0 / 8.0 : 1.0 / 4.0;
  for (int q = 0; q < side->fixed->rule.count; q++) weigh(r, side->fixed->rule.xi[q], r->chi[q]);
  mark_faces(r, other);
  return CT_OK;
}

ct_status ct_side_traction(const ct_side *side, const ct_side *other, double *traction,
                           double *area, ct_error *error)
{
  recovery r;
  ct_status status = open_recovery(&r, side, other, error);
  for (int32_t n = 0; status == CT_OK && n < side->search->node_count; n++) {
    const int64_t node = side->search->nodes[n];
    area[node] = recover(&r, n, &traction[3 * node]);
  }
  ct_release(r.is_loaded);
  return status;
}

/* Forces of friction at the nodes of a side, in two sums that do not depend on their order, and for
 * each node whether a point near it sticks, and whether one slips. */
typedef struct friction_sums {
  ct_grid grid;
  double *coarse, *fine, *sticks, *slips;
} friction_sums;

/* Friction of a point, null if it has none. */
static const ct_slip *friction_of(const ct_point *point)
{
  const ct_slip *slip = point->row.slip;
  return slip != NULL && point->row.force > 0.0 ? slip : NULL;
}

/* A bound of the components that a point adds to a node. */
static double bound_of(const ct_slip *slip, int32_t nodes)
{
  double arm = 0.0, w[3], T[3], d[3];
  ct_slip_vector(slip, CT_SLIP_FORCE, T), ct_slip_vector(slip, CT_SLIP_LEVER, d);
  for (int32_t b = 0; b < nodes; b++) {
    ct_slip_vector(slip, CT_SLIP_WEIGHT + 3 * b, w);
    arm = fmax(arm, ct_vector_dot(w, w));
  }
  return 2.0 * sqrt(ct_vector_dot(T, T)) * (1.0 + sqrt(arm * ct_vector_dot(d, d)));
}

/* Note at the nearest node of a face whether a point sticks. */
static void note(const int32_t *node, int per, const double N[8], const ct_slip *slip,
                 const friction_sums *sums)
{
  double nearest = 0.0;
  for (int a = 0; a < per; a++) nearest = fmax(nearest, N[a]);
  const int sticks = *ct_slip_number(slip, CT_SLIP_STUCK) != 0.0;
  for (int a = 0; a < per; a++)
    if (N[a] == nearest) (sticks ? sums->sticks : sums->slips)[node[a]] = 1.0;
}

/* Add N_a T of a side's own points, or of the points that act on it -N_b T - (w_b · T) d
 * (eq:slip-row). */
static void add_friction(const ct_side *side, const ct_side *from, int own, friction_sums *sums)
{
  const ct_search *search = side->search;
  for (int64_t i = 0; i < from->fixed->point_count; i++) {
    const ct_point *point = &from->points[i];
    const ct_slip *slip = friction_of(point);
    const int points = from->fixed->rule.count;
    if (slip == NULL) continue;
    const int32_t face = own ? (int32_t)(i / points) : point->other,
                  *node = &search->faces[(int64_t)face * search->per];
    const double *N = own ? from->fixed->N[i % points] : point->N;
    double T[3], d[3], w[3] = {0.0};
    ct_slip_vector(slip, CT_SLIP_FORCE, T), ct_slip_vector(slip, CT_SLIP_LEVER, d);
    for (int a = 0; a < search->per; a++) {
      if (!own) ct_slip_vector(slip, CT_SLIP_WEIGHT + 3 * a, w);
      const double turn = ct_vector_dot(w, T);
      for (int c = 0; c < 3; c++) {
        const double f = own ? N[a] * T[c] : -N[a] * T[c] - turn * d[c];
        const int64_t dof = 3 * (int64_t)node[a] + c;
        ct_grid_add(&sums->grid, f, &sums->coarse[dof], &sums->fine[dof]);
      }
    }
    note(node, search->per, N, slip, sums);
  }
}

/* The largest bound of the points of two sides, one of them null or both the same. */
static double bound_of_sides(const ct_side *side, const ct_side *other)
{
  const ct_side *both[2] = {side, other};
  double top = 0.0;
  for (int s = 0; s < 2; s++)
    for (int64_t i = 0; both[s] != NULL && i < both[s]->fixed->point_count; i++) {
      const ct_slip *slip = friction_of(&both[s]->points[i]);
      if (slip != NULL) top = fmax(top, bound_of(slip, both[s]->points[i].row.other_count));
    }
  ct_pieces_largest(side->pieces, &top, 1);
  return top;
}

static ct_status sum_friction(const ct_side *side, const ct_side *other, friction_sums *sums,
                              ct_error *error)
{
  const int64_t nodes = side->search->node_count;
  const int64_t points = side->fixed->point_count + (other != NULL ? other->fixed->point_count : 0);
  const double top = bound_of_sides(side, other);
  if (top == 0.0) return CT_OK;
  if (!ct_grid_init(&sums->grid, top, 2 * points))
    return ct_fail(error, CT_ERROR_BLOWUP, CT_NOWHERE, "friction: its largest force is not finite");
  add_friction(side, side, 1, sums);
  if (other != NULL) add_friction(side, other, 0, sums);
  ct_pieces_sum(side->pieces, sums->coarse, 3 * nodes);
  ct_pieces_sum(side->pieces, sums->fine, 3 * nodes);
  ct_pieces_largest(side->pieces, sums->sticks, nodes);
  ct_pieces_largest(side->pieces, sums->slips, nodes);
  return CT_OK;
}

ct_status ct_side_friction(const ct_side *side, const ct_side *other, double *traction,
                           int32_t *slip, ct_error *error)
{
  const size_t nodes = (size_t)side->search->node_count;
  ct_pool pool = {0};
  recovery r;
  friction_sums sums = {.coarse = ct_pool_take(&pool, 3 * nodes, sizeof(double)),
                        .fine = ct_pool_take(&pool, 3 * nodes, sizeof(double)),
                        .sticks = ct_pool_take(&pool, nodes, sizeof(double)),
                        .slips = ct_pool_take(&pool, nodes, sizeof(double))};
  ct_status status = open_recovery(&r, side, other, error);
  if (status == CT_OK && pool.failed) status = CT_NO_MEMORY(error, "friction's tractions");
  if (status == CT_OK) status = sum_friction(side, other, &sums, error);
  for (int32_t n = 0; status == CT_OK && n < side->search->node_count; n++) {
    const int64_t node = side->search->nodes[n];
    double force[3];
    const double area = recover(&r, n, force);
    recovery shear = r;
    shear.force = sums.coarse, shear.fine = sums.fine;
    force_of(&shear, n, force);
    // -- Force of friction over the same area (eq:recovered-friction)
    for (int c = 0; c < 3; c++) traction[3 * node + c] = area > 0.0 ? force[c] / area : 0.0;
    slip[node] = sums.slips[n] > 0.0    ? CT_FRICTION_SLIPS
                 : sums.sticks[n] > 0.0 ? CT_FRICTION_STICKS
                                        : CT_FRICTION_NONE;
  }
  ct_release(r.is_loaded);
  ct_pool_empty(&pool);
  return status;
}
