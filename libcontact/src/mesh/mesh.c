#include <libcontact/mesh.h>
#include <libcontact/shape.h>

#include "../base/error.h"
#include "../shape/jacobian.h"
#include "../base/memory.h"
#include "../base/stream.h"
#include "../base/threads.h"
#include "batch.h"
#include "mesh_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

ct_status ct_mesh_allocate(ct_brick_kind kind, int64_t nodes, int64_t elements, ct_mesh **out,
                           ct_error *error)
{
  int per = ct_brick_node_count(kind);
  if (nodes < 1 || elements < 1 || nodes > INT32_MAX || elements > INT32_MAX / 64)
    return CT_REFUSE(
        error,
        "a mesh of %lld nodes and %lld elements is empty or too large; at most %d nodes and "
        "%d elements fit",
        (long long)nodes, (long long)elements, INT32_MAX, INT32_MAX / 64);
  ct_mesh *mesh = ct_allocate(1, sizeof *mesh);
  if (mesh != NULL)
    *mesh = (ct_mesh){.kind = kind,
                      .node_count = (int32_t)nodes,
                      .element_count = (int32_t)elements,
                      .nodes = ct_allocate((size_t)nodes, 3 * sizeof(double)),
                      .elements = ct_allocate((size_t)elements * (size_t)per, sizeof(int32_t))};
  if (mesh == NULL || mesh->nodes == NULL || mesh->elements == NULL) {
    ct_mesh_free(mesh);
    return CT_NO_MEMORY(error, "a mesh of %lld nodes", (long long)nodes);
  }
  *out = mesh;
  return CT_OK;
}

void ct_mesh_free(ct_mesh *mesh)
{
  if (mesh == NULL) return;
  ct_release(mesh->nodes);
  ct_release(mesh->elements);
  ct_release(mesh);
}

/* Nodes of a box lie on a lattice of half cells: point (i, j, k) with 0 <= i <= 2 cells[0] and so
 * on. Corners, `corners` along each axis, have even coordinates; the mid-side nodes of hex20 have
 * exactly one odd coordinate. Numbers come in blocks: corners, then mid-sides along x, y, z; block
 * `odd` + 1 begins at `first` and has `count` nodes along the axes. */
typedef struct lattice {
  int64_t points[3]; /* half cells along an axis, until it closes on itself */
  int64_t first[4], count[4][3];
} lattice;

static lattice lattice_of(const int32_t cells[3], const int64_t corners[3])
{
  lattice l = {.first = {0}};
  for (int d = 0; d < 3; d++) l.points[d] = 2 * (int64_t)cells[d] + (corners[d] > cells[d]);
  for (int block = 0; block < 4; block++) {
    for (int d = 0; d < 3; d++) l.count[block][d] = d == block - 1 ? cells[d] : corners[d];
    const int64_t *before = l.count[block > 0 ? block - 1 : 0];
    if (block > 0) l.first[block] = l.first[block - 1] + before[0] * before[1] * before[2];
  }
  return l;
}

static int32_t lattice_node(const lattice *l, const int32_t at[3])
{
  int block = at[0] % 2 ? 1 : at[1] % 2 ? 2 : at[2] % 2 ? 3 : 0;
  const int64_t *count = l->count[block];
  return (int32_t)(l->first[block] + at[0] / 2 + count[0] * (at[1] / 2 + count[1] * (at[2] / 2)));
}

/* A box, and along each axis the ratio of neighbouring elements, from the smallest on. */
typedef struct graded_box {
  const ct_box *box;
  double ratio[3];
} graded_box;

/* The root of q^m = R >= 1 by Newton's method from above, so that no mathematical library decides
 * about its last bit. */
static double root(double R, int32_t m)
{
  double q = 1.0 + (R - 1.0) / m, next = q, power;
  do {
    q = next, power = 1.0;
    // -- q^(m - 1) by repeated squares, and a step downwards (eq:mesh-root)
    double square = q;
    for (int32_t k = m - 1; k > 0; k /= 2, square *= square)
      if (k % 2) power *= square;
    next = q - (q - R / power) / m;
  } while (next < q);
  return q;
}

/* 1 + q + ... + q^(m - 1). */
static double geometric(double q, int32_t m)
{
  double S = 0.0, power = 1.0;
  int bit = 0;
  while (m >> bit > 1) bit++;
  for (; bit >= 0; bit--) {
    // -- Twice as many terms, and one more (eq:mesh-grading)
    S *= 1.0 + power, power *= power;
    if (m >> bit & 1) S = 1.0 + q * S, power *= q;
  }
  return S;
}

/* Distance of point `i` from the end with the smallest of n elements, or, in a symmetric box, from
 * the middle, over the length up to the other end. */
static double graded(const graded_box *g, int d, int32_t i)
{
  const int32_t n = g->box->cells[d];
  if (!g->box->symmetric[d]) return geometric(g->ratio[d], i) / geometric(g->ratio[d], n);
  const double half = n % 2 ? 0.5 : 0.0; // of the element in the middle
  return (geometric(g->ratio[d], (abs(2 * i - n) + 1) / 2) - half) /
         (geometric(g->ratio[d], (n + 1) / 2) - half);
}

static double corner_coordinate(const graded_box *g, int d, int32_t i)
{
  const ct_box *box = g->box;
  const double a = box->origin[d], b = box->origin[d] + box->size[d], middle = (a + b) / 2.0;
  const int32_t n = box->cells[d];
  double from = a, to = b, s;
  if (box->symmetric[d]) from = middle, to = 2 * i < n ? a : b;
  else if (box->grading[d] < 1.0) from = b, to = a, i = n - i;
  s = graded(g, d, i);
  return (1.0 - s) * from + s * to;
}

static void lattice_coordinates(const void *shape, const int32_t at[3], double x[3])
{
  const graded_box *g = shape;
  for (int d = 0; d < 3; d++) {
    const double a = g->box->origin[d], b = a + g->box->size[d];
    const double n = 2.0 * g->box->cells[d], i = at[d];
    if (g->ratio[d] == 1.0) x[d] = ((n - i) * a + i * b) / n; // (eq:mesh-lattice)
    else
      x[d] = (corner_coordinate(g, d, at[d] / 2) + corner_coordinate(g, d, (at[d] + 1) / 2)) / 2.0;
  }
}

static ct_status box_check(const ct_box *box, ct_error *error)
{
  for (int d = 0; d < 3; d++) {
    if (!(box->size[d] > 0.0))
      return CT_REFUSE(error, "box: the size along %c must be positive, not %g", "xyz"[d],
                       box->size[d]);
    if (!isfinite(2.0 * box->cells[d] * (fabs(box->origin[d]) + box->size[d])))
      return CT_REFUSE(error, "box: origin %g and size %g along %c are not finite, or too large",
                       box->origin[d], box->size[d], "xyz"[d]);
    if (box->cells[d] < 1 || box->cells[d] > 1000000)
      return CT_REFUSE(error, "box: cells along %c must be 1 to 1000000, not %d", "xyz"[d],
                       (int)box->cells[d]);
    if (!(box->grading[d] == 0.0 || (box->grading[d] >= 1e-6 && box->grading[d] <= 1e6)))
      return CT_REFUSE(error, "box: grading along %c must be 1e-6 to 1e6, or 0 for none, not %g",
                       "xyz"[d], box->grading[d]);
  }
  if (box->layers != CT_LAYERS_X && box->layers != CT_LAYERS_Y && box->layers != CT_LAYERS_Z)
    return CT_REFUSE(error, "box: there is no order of numbers %d", (int)box->layers);
  return CT_OK;
}

/* Ratios of neighbouring elements; 1 where there is nothing to grade. */
static graded_box graded_box_of(const ct_box *box)
{
  graded_box g = {box, {1.0, 1.0, 1.0}};
  for (int d = 0; d < 3; d++) {
    const int32_t n = box->cells[d], steps = box->symmetric[d] ? (n - 1) / 2 : n - 1;
    double R = box->grading[d];
    if (R == 0.0 || R == 1.0 || steps == 0) continue;
    if (box->symmetric[d] && R < 1.0) g.ratio[d] = 1.0 / root(1.0 / R, steps);
    else g.ratio[d] = root(R < 1.0 ? 1.0 / R : R, steps);
  }
  return g;
}

/* Position of a lattice point: `shape` is a graded_box or a ct_ring. */
typedef void place_node(const void *shape, const int32_t at[3], double x[3]);

/* Enter the nodes of a row of `count` cells along the first axis, which never closes on itself, and
 * the coordinates of those that belong to no earlier row; `xi` are the reference coordinates along
 * the axes of the lattice, `cell` is the first of the row. */
static void enter_row(const lattice *l, const int axes[3], int per, int (*xi)[3],
                      const int32_t cell[3], int32_t count, place_node *place, const void *shape,
                      double *nodes, int32_t *elements)
{
  int32_t at[3], along[3];
  for (int a = 0; a < per; a++) {
    int own = 1;
    for (int d = 0; d < 3; d++) {
      at[d] = 2 * cell[d] + 1 + xi[a][d];
      own = own && (at[d] > 2 * cell[d] || cell[d] == 0);
      if (at[d] == l->points[d]) at[d] = 0;
      along[axes[d]] = at[d];
    }
    int32_t first = lattice_node(l, at), begin = at[0];
    for (int32_t i = 0; i < count; i++) elements[per * (int64_t)i + a] = first + i;
    // The low end of a cell is the high end of the previous one.
    for (int32_t i = 0; own && i < (begin == 0 ? 1 : count); i++) {
      along[axes[0]] = begin + 2 * i;
      place(shape, along, &nodes[3 * ((size_t)first + (size_t)i)]);
    }
  }
}

/* Bricks on a lattice; with `corners[d]` equal to `cells[d]` it closes on itself along d. Numbers
 * run along axis axes[0] first, along axes[2] last; `cells` and `corners` are in that order. */
static ct_status create_lattice(ct_brick_kind kind, const int axes[3], const int32_t cells[3],
                                const int64_t corners[3], place_node *place, const void *shape,
                                const ct_run_settings *settings, ct_mesh **out, ct_error *error)
{
  const lattice l = lattice_of(cells, corners);
  int64_t n[3] = {cells[0], cells[1], cells[2]};
  if (n[0] * n[1] > INT32_MAX)
    return CT_REFUSE(error, "a mesh of %lld times %lld cells in a layer is too large",
                     (long long)n[0], (long long)n[1]);
  int64_t nodes = ct_brick_facts_of(kind)->cell_nodes > 1
                      ? l.first[3] + l.count[3][0] * l.count[3][1] * l.count[3][2]
                      : l.first[1];
  ct_status status = ct_mesh_allocate(kind, nodes, n[0] * n[1] * n[2], out, error);
  if (status != CT_OK) return status;
  (*out)->settings = settings;

  int per = ct_brick_node_count(kind), xi[20][3];
  for (int a = 0; a < per; a++) {
    double reference[3];
    ct_brick_reference(kind, a, reference);
    for (int d = 0; d < 3; d++) xi[a][d] = (int)reference[axes[d]];
  }
  int32_t rows = (int32_t)(n[1] * n[2]), *elements = (*out)->elements;
#ifdef _OPENMP
  int threads = ct_threads_for(ct_threads_of(settings), (*out)->element_count, CT_LEAST_OF_MESH);
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
#endif
  for (int32_t row = 0; row < rows; row++) {
    int32_t cell[3] = {0, row % cells[1], row / cells[1]};
    enter_row(&l, axes, per, xi, cell, cells[0], place, shape, (*out)->nodes,
              &elements[per * n[0] * row]);
  }
  return CT_OK;
}

void ct_box_axes(const ct_box *box, int axes[3])
{
  int last = box->layers == CT_LAYERS_X ? 0 : box->layers == CT_LAYERS_Y ? 1 : 2;
  int first = last == 0 ? 1 : 0, other = 3 - first - last;
  int swap = last != 2 && box->cells[other] > box->cells[first];
  axes[0] = swap ? other : first;
  axes[1] = swap ? first : other;
  axes[2] = last;
}

ct_status ct_mesh_create_box(ct_brick_kind kind, const ct_box *box, ct_mesh **mesh, ct_error *error)
{
  return ct_mesh_make_box(kind, box, NULL, mesh, error);
}

ct_status ct_mesh_make_box(ct_brick_kind kind, const ct_box *box, const ct_run_settings *settings,
                           ct_mesh **mesh, ct_error *error)
{
  if (box == NULL || mesh == NULL) return CT_REFUSE_NULL(error);
  if (ct_brick_node_count(kind) == 0)
    return CT_REFUSE(error, "box: there is no brick of the kind %d", (int)kind);
  ct_status status = box_check(box, error);
  if (status != CT_OK) return status;
  int axes[3];
  int32_t cells[3];
  int64_t corners[3];
  ct_box_axes(box, axes);
  for (int d = 0; d < 3; d++) {
    cells[d] = box->cells[axes[d]];
    corners[d] = cells[d] + 1;
  }
  const graded_box g = graded_box_of(box);
  return create_lattice(kind, axes, cells, corners, lattice_coordinates, &g, settings, mesh, error);
}

/* Cosine and sine of the angle 2π i / n, reduced to the first eighth of the circle so that they
 * mirror exactly. */
static void circle(int32_t i, int32_t n, double *c, double *s)
{
  const double pi = 3.14159265358979323846;
  int64_t a = 8 * (int64_t)i, turn = n; // eighths of the circle: a / turn of them
  int below = a > 4 * turn, left, swap;
  if (below) a = 8 * turn - a;
  left = a > 2 * turn;
  if (left) a = 4 * turn - a;
  swap = a > turn;
  if (swap) a = 2 * turn - a;
  double angle = 0.25 * pi * (double)a / (double)turn, x = cos(angle),
         y = a == turn ? x : sin(angle);
  *c = (swap ? y : x) * (left ? -1.0 : 1.0);
  *s = (swap ? x : y) * (below ? -1.0 : 1.0);
}

static void ring_coordinates(const void *shape, const int32_t at[3], double x[3])
{
  const ct_ring *ring = shape;
  double c, s, n = 2.0 * ring->cells[0],
               r = ((n - at[0]) * ring->radius[0] + at[0] * ring->radius[1]) / n;
  circle(at[1], 2 * ring->cells[1], &c, &s);
  // -- Around the axis, and in layers along it (eq:mesh-ring)
  x[0] = ring->centre[0] + r * c;
  x[1] = ring->centre[1] + r * s;
  x[2] = ring->centre[2] + (double)(at[2] - ring->cells[2]) * ring->width / (2.0 * ring->cells[2]);
}

ct_status ct_mesh_create_ring(ct_brick_kind kind, const ct_ring *ring, ct_mesh **mesh,
                              ct_error *error)
{
  if (ring == NULL || mesh == NULL) return CT_REFUSE_NULL(error);
  if (ct_brick_node_count(kind) == 0)
    return CT_REFUSE(error, "ring: there is no brick of the kind %d", (int)kind);
  const double *r = ring->radius;
  if (!(r[0] > 0.0 && r[1] > r[0]) || !isfinite(r[1]))
    return CT_REFUSE(error,
                     "ring: inner and outer radius must be positive and ascend, not %g and %g",
                     r[0], r[1]);
  if (!(ring->width > 0.0) || !isfinite(ring->width))
    return CT_REFUSE(error, "ring: width must be positive and finite, not %g", ring->width);
  for (int d = 0; d < 3; d++) {
    static const char *const along[3] = {"along the radius", "around", "across"};
    int32_t least = d == 1 ? 3 : 1;
    if (!isfinite(ring->centre[d]))
      return CT_REFUSE(error, "ring: centre %c must be finite, not %g", "xyz"[d], ring->centre[d]);
    if (ring->cells[d] < least || ring->cells[d] > 1000000)
      return CT_REFUSE(error, "ring: cells %s must be %d to 1000000, not %d", along[d], (int)least,
                       (int)ring->cells[d]);
  }
  int64_t corners[3] = {ring->cells[0] + 1, ring->cells[1], ring->cells[2] + 1};
  return create_lattice(kind, (const int[3]){0, 1, 2}, ring->cells, corners, ring_coordinates, ring,
                        NULL, mesh, error);
}

ct_status ct_mesh_create_copy(const ct_mesh *source, ct_mesh **mesh, ct_error *error)
{
  if (source == NULL || mesh == NULL) return CT_REFUSE_NULL(error);
  ct_status status = ct_mesh_check(source, error);
  if (status == CT_OK)
    status = ct_mesh_allocate(source->kind, source->node_count, source->element_count, mesh, error);
  if (status != CT_OK) return status;
  size_t per = (size_t)ct_brick_node_count(source->kind);
  memcpy((*mesh)->nodes, source->nodes, 3 * (size_t)source->node_count * sizeof(double));
  memcpy((*mesh)->elements, source->elements,
         per * (size_t)source->element_count * sizeof(int32_t));
  return CT_OK;
}

/* Node numbers of one element, shape (8 or 20); CT_ERROR_ARGUMENT if one is out of range. */
static ct_status element_nodes(const ct_mesh *mesh, int32_t element, int32_t *nodes,
                               ct_error *error)
{
  int per = ct_brick_node_count(mesh->kind);
  for (int a = 0; a < per; a++) {
    nodes[a] = mesh->elements[(size_t)element * (size_t)per + (size_t)a];
    if (nodes[a] < 0 || nodes[a] >= mesh->node_count)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, element, -1},
                     "element %d names node %d, the mesh has nodes 0 to %d", (int)element,
                     (int)nodes[a], (int)mesh->node_count - 1);
  }
  return CT_OK;
}

ct_status ct_mesh_check_numbers(const ct_mesh *mesh, ct_error *error)
{
  int64_t entries = (int64_t)mesh->element_count * ct_brick_node_count(mesh->kind);
  int32_t number[20];
  int outside = 0;
  if (entries < 1)
    return CT_REFUSE(error, "mesh: it has no elements, or of the unknown kind %d", (int)mesh->kind);
  for (int64_t i = 0; i < entries; i++)
    outside |= (uint32_t)mesh->elements[i] >= (uint32_t)mesh->node_count;
  ct_status status = CT_OK;
  for (int32_t e = 0; outside && status == CT_OK; e++)
    status = element_nodes(mesh, e, number, error);
  return status;
}

/* Jacobian of an element at a point, and the squares of its columns: half the edges of the
 * brick that approximates the element there. Returns its determinant. */
static double jacobian(ct_brick_kind kind, double nodes[20][3], const double xi[3],
                       double square[3])
{
  double dN[20][3], J[3][3], C[3][3];
  ct_brick_gradient(kind, xi, dN);
  ct_reference_gradient(ct_brick_node_count(kind), dN, nodes, J);
  for (int d = 0; d < 3; d++) square[d] = J[0][d] * J[0][d] + J[1][d] * J[1][d] + J[2][d] * J[2][d];
  return ct_cofactors(J, C);
}

/* At Gauss points: the determinant over the product of the edges there, which is 1 for a box. */
static ct_status check_gauss(ct_brick_kind kind, double nodes[20][3], const ct_rule *rule,
                             int32_t element, ct_error *error)
{
  for (int q = 0; q < rule->count; q++) {
    double square[3], det = jacobian(kind, nodes, rule->xi[q], square),
                      scale = sqrt(square[0] * square[1] * square[2]);
    double relative = scale > 0.0 ? det / scale : det;
    // det J > 10⁻¹² |J_1| |J_2| |J_3| (eq:jacobian-points)
    if (!(relative > 1e-12))
      return ct_fail(error, CT_ERROR_GEOMETRY, (ct_place){-1, element, q},
                     "element %d is %s: Jacobian determinant %g at Gauss point %d", (int)element,
                     relative < -1e-12 ? "inverted" : "collapsed", det, q);
  }
  return CT_OK;
}

/* At nodes, where nothing is integrated: the determinant over the product of the edges at the
 * centre. It may be zero only if an edge has collapsed to a point, or if the tangent of an edge
 * vanishes at the node. */
static ct_status check_nodes(ct_brick_kind kind, double nodes[20][3], const int32_t *number,
                             int32_t element, ct_error *error)
{
  static const double centre[3] = {0.0, 0.0, 0.0};
  double size[3], square[3], xi[3];
  (void)jacobian(kind, nodes, centre, size);
  double small = 1e-9 * sqrt(size[0] * size[1] * size[2]);
  for (int a = 0; a < ct_brick_node_count(kind); a++) {
    ct_brick_reference(kind, a, xi);
    double det = jacobian(kind, nodes, xi, square);
    int vanishes = 0;
    for (int d = 0; d < 3; d++) vanishes |= square[d] <= 1e-18 * size[d];
    // det J > 10⁻⁹ j_0, or zero at a node where a tangent vanishes (eq:jacobian-nodes)
    if (det > small || (vanishes && det >= -small)) continue;
    return ct_fail(error, CT_ERROR_GEOMETRY, (ct_place){-1, element, -1},
                   "element %d is %s at its %s %d (node %d): Jacobian determinant %g, where it "
                   "must be positive",
                   (int)element, det < -small ? "inverted" : "collapsed",
                   a < 8 ? "corner" : "mid-side node", a, (int)number[a], det);
  }
  return CT_OK;
}

static ct_status element_check(const ct_mesh *mesh, const ct_rule *rule, int32_t element,
                               ct_error *error)
{
  int32_t number[20];
  double nodes[20][3];
  ct_status status = element_nodes(mesh, element, number, error);
  if (status != CT_OK) return status;
  for (int a = 0; a < ct_brick_node_count(mesh->kind); a++)
    memcpy(nodes[a], &mesh->nodes[3 * (size_t)number[a]], sizeof nodes[a]);
  status = check_gauss(mesh->kind, nodes, rule, element, error);
  return status == CT_OK ? check_nodes(mesh->kind, nodes, number, element, error) : status;
}

/* Gradients of the shape functions at the points of the checks: the centre, the Gauss points, the
 * nodes. */
typedef struct checks {
  int per, gauss, count;
  double dN[48][20][3];
} checks;

static void tabulate(ct_brick_kind kind, const ct_rule *rule, checks *at)
{
  static const double centre[3] = {0.0, 0.0, 0.0};
  at->per = ct_brick_node_count(kind), at->gauss = rule->count;
  at->count = 1 + at->gauss + at->per;
  ct_brick_gradient(kind, centre, at->dN[0]);
  for (int q = 0; q < at->gauss; q++) ct_brick_gradient(kind, rule->xi[q], at->dN[1 + q]);
  for (int a = 0; a < at->per; a++) {
    double xi[3];
    ct_brick_reference(kind, a, xi);
    ct_brick_gradient(kind, xi, at->dN[1 + at->gauss + a]);
  }
}

/* Whether an element of a batch may fail `check_gauss` or `check_nodes`: the same numbers squared,
 * with a factor of 2 for round-off. The coordinates x[component][node] are overwritten. */
CT_INLINE int may_fail(const checks *at, int per, ct_lanes *x)
{
  ct_lanes J[3][3], det, product, centre = {0};
  double d[CT_LANES_COUNT], p[CT_LANES_COUNT];
  int bad = 0;
  ct_lanes_centre(per, x);
  for (int q = 0; q < at->count; q++) {
    ct_lanes_jacobian(per, at->dN[q], x, J, &det);
    product = (J[0][0] * J[0][0] + J[1][0] * J[1][0]) + J[2][0] * J[2][0];
    for (int k = 1; k < 3; k++)
      product *= (J[0][k] * J[0][k] + J[1][k] * J[1][k]) + J[2][k] * J[2][k];
    if (q == 0) centre = product;
    memcpy(d, &det, sizeof d);
    memcpy(p, q <= at->gauss ? &product : &centre, sizeof p);
    double limit = q <= at->gauss ? 2e-24 : 2e-18;
    for (int l = 0; l < CT_LANES_COUNT; l++) bad |= !((d[l] > 0.0) & (d[l] * d[l] > limit * p[l]));
  }
  return bad;
}

/* Whether the elements from `e` on, one per lane, are certainly good. */
CT_CLONES_RARE
static int are_good(const ct_mesh *mesh, const checks *at, int32_t e)
{
  ct_lanes x[3 * 20];
  ct_load_lanes(mesh, NULL, e / 8, at->per, mesh->nodes, e % 8, x);
  if (at->per == 20) return !may_fail(at, 20, x);
  double volume[CT_LANES_COUNT];
  return ct_upright_boxes(x, volume) || !may_fail(at, 8, x);
}

/* After the first bad element: report the number of bad elements, and some of their numbers. */
static void count_bad(const ct_mesh *mesh, const ct_rule *rule, int32_t first, ct_error *error)
{
  char list[80] = "";
  int32_t count = 1;
  for (int32_t e = first + 1; e < mesh->element_count; e++) {
    if (element_check(mesh, rule, e, NULL) != CT_ERROR_GEOMETRY) continue;
    size_t used = strlen(list);
    if (++count <= 8) snprintf(list + used, sizeof list - used, " %d", (int)e);
  }
  if (count > 1)
    ct_error_add(error, "; %d elements are bad, also%s%s", (int)count, list,
                 count > 8 ? " ..." : "");
}

/* The first element of a group that may be bad, or the number of elements. */
static int32_t first_doubtful(const ct_mesh *mesh, const checks *at)
{
  int32_t count = mesh->element_count, first = count;
#ifdef _OPENMP
  int threads = ct_threads_for(ct_threads_of(mesh->settings), count, CT_LEAST_OF_MESH);
#pragma omp parallel for num_threads(threads) schedule(static) \
    reduction(min : first) if (threads > 1)
#endif
  for (int32_t e = 0; e < count; e += CT_LANES_COUNT)
    if (e < first && !are_good(mesh, at, e)) first = e;
  return first;
}

ct_status ct_mesh_check_shapes(const ct_mesh *mesh, ct_error *error)
{
  if (mesh == NULL || mesh->nodes == NULL || mesh->elements == NULL) return CT_REFUSE_NULL(error);
  if (ct_brick_node_count(mesh->kind) == 0)
    return CT_REFUSE(error, "mesh: there is no brick of the kind %d", (int)mesh->kind);
  if (mesh->node_count < 1 || mesh->element_count < 1)
    return CT_REFUSE(error, "mesh: %d nodes and %d elements; there must be some of each",
                     (int)mesh->node_count, (int)mesh->element_count);
  for (int32_t i = 0; i < mesh->node_count; i++)
    for (int d = 0; d < 3; d++)
      if (!isfinite(mesh->nodes[3 * (size_t)i + (size_t)d]))
        return ct_fail(error, CT_INVALID, (ct_place){-1, -1, i},
                       "coordinate %c of node %d is not finite", "xyz"[d], (int)i);
  ct_rule rule;
  checks at;
  ct_rule_brick(mesh->kind, &rule);
  tabulate(mesh->kind, &rule, &at);
  ct_status status = ct_mesh_check_numbers(mesh, error);
  int32_t first = status == CT_OK ? first_doubtful(mesh, &at) : 0;
  for (int32_t e = first; status == CT_OK && e < mesh->element_count; e++) {
    if (e % CT_LANES_COUNT == 0 && are_good(mesh, &at, e)) {
      e += CT_LANES_COUNT - 1;
      continue;
    }
    status = element_check(mesh, &rule, e, error);
    if (status == CT_ERROR_GEOMETRY && error != NULL) count_bad(mesh, &rule, e, error);
  }
  return status;
}

ct_status ct_mesh_check(const ct_mesh *mesh, ct_error *error)
{
  ct_status status = ct_mesh_check_shapes(mesh, error);
  if (status == CT_OK) status = ct_mesh_check_twins(mesh, error);
  return status == CT_OK ? ct_mesh_check_sides(mesh, error) : status;
}

/* Square of the shortest edge of the elements from `e` on, one per lane; edges of zero length do
 * not count. */
CT_CLONES_RARE
static double shortest_square(const ct_mesh *mesh, int32_t e)
{
  static const int edge[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                  {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
  int per = ct_brick_node_count(mesh->kind);
  ct_lanes x[3 * 20];
  double square[12][CT_LANES_COUNT], longest[CT_LANES_COUNT] = {0.0}, least[CT_LANES_COUNT],
                                     shortest = INFINITY;
  ct_load_lanes(mesh, NULL, e / 8, per, mesh->nodes, e % 8, x);
  for (int k = 0; k < 12; k++) {
    ct_lanes d[3], sum;
    for (int c = 0; c < 3; c++) d[c] = x[per * c + edge[k][1]] - x[per * c + edge[k][0]];
    sum = (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
    memcpy(square[k], &sum, sizeof sum);
#pragma omp simd
    for (int l = 0; l < CT_LANES_COUNT; l++)
      longest[l] = square[k][l] > longest[l] ? square[k][l] : longest[l];
  }
  for (int l = 0; l < CT_LANES_COUNT; l++) least[l] = INFINITY;
  for (int k = 0; k < 12; k++)
#pragma omp simd
    for (int l = 0; l < CT_LANES_COUNT; l++) {
      double counts = square[k][l] > 1e-18 * longest[l] ? square[k][l] : INFINITY;
      least[l] = counts < least[l] ? counts : least[l];
    }
  for (int l = 0; l < CT_LANES_COUNT; l++) shortest = least[l] < shortest ? least[l] : shortest;
  return shortest;
}

double ct_mesh_shortest_edge(const ct_mesh *mesh)
{
  double shortest = INFINITY;
  if (mesh == NULL) return NAN;
#ifdef _OPENMP
  int threads =
      ct_threads_for(ct_threads_of(mesh->settings), mesh->element_count, CT_LEAST_OF_MESH);
#pragma omp parallel for num_threads(threads) reduction(min : shortest) if (threads > 1)
#endif
  for (int32_t e = 0; e < mesh->element_count; e += CT_LANES_COUNT)
    shortest = fmin(shortest, shortest_square(mesh, e));
  return sqrt(shortest);
}

void ct_mesh_bounds(const ct_mesh *mesh, double low[3], double high[3])
{
  ct_extent(mesh == NULL ? 0 : mesh->node_count, mesh == NULL ? NULL : mesh->nodes, NULL, low,
            high);
}

int ct_brick_octant(ct_brick_kind kind, int a)
{
  double xi[3];
  ct_brick_reference(kind, a, xi);
  return (xi[0] < 0.0) + 2 * (xi[1] < 0.0) + 4 * (xi[2] < 0.0);
}
