#include <libcontact/mesh.h>
#include <libcontact/shape.h>

#include "../base/error.h"
#include "../shape/jacobian.h"
#include "../base/memory.h"
#include "mesh_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static ct_status mesh_allocate(ct_brick_kind kind, int64_t nodes, int64_t elements, ct_mesh **out,
                               ct_error *error)
{
  int per = ct_brick_node_count(kind);
  if (nodes < 1 || elements < 1 || nodes > INT32_MAX || elements > INT32_MAX / 64)
    return CT_REFUSE(error, "a mesh of %lld nodes and %lld elements", (long long)nodes,
                     (long long)elements);
  ct_mesh *mesh = ct_allocate(1, sizeof *mesh);
  if (mesh != NULL)
    *mesh = (ct_mesh){kind, (int32_t)nodes, (int32_t)elements,
                      ct_allocate((size_t)nodes, 3 * sizeof(double)),
                      ct_allocate((size_t)elements * (size_t)per, sizeof(int32_t))};
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

/* Nodes of a box stand on a lattice of half cells: point (i, j, k) with 0 <= i <= 2 cells[0] and so
 * on. Corners, of which there are so many along each axis, have even coordinates; the mid-side
 * nodes of hex20 have exactly one odd one. */
static int32_t lattice_node(const int32_t cells[3], const int64_t corners[3], const int32_t at[3])
{
  int odd = -1;
  for (int d = 0; d < 3; d++)
    if (at[d] % 2) odd = d;
  int64_t first = 0;
  int64_t count[3];
  // Blocks of numbers: corners, then mid-sides along x, y, z.
  for (int block = -1; block <= odd; block++) {
    for (int d = 0; d < 3; d++) count[d] = d == block ? cells[d] : corners[d];
    if (block == odd) break;
    first += count[0] * count[1] * count[2];
  }
  return (int32_t)(first + at[0] / 2 + count[0] * (at[1] / 2 + count[1] * (at[2] / 2)));
}

static void lattice_coordinates(const void *shape, const int32_t at[3], double x[3])
{
  const ct_box *box = shape;
  for (int d = 0; d < 3; d++) {
    double a = box->origin[d], b = box->origin[d] + box->size[d];
    double n = 2.0 * box->cells[d], i = at[d];
    x[d] = ((n - i) * a + i * b) / n;
  }
}

static ct_status box_check(const ct_box *box, ct_error *error)
{
  for (int d = 0; d < 3; d++) {
    if (!isfinite(box->origin[d]) ||
        !isfinite(2.0 * box->cells[d] * (fabs(box->origin[d]) + box->size[d])) ||
        !(box->size[d] > 0.0))
      return CT_REFUSE(error, "box: origin %g and size %g along %c", box->origin[d], box->size[d],
                       "xyz"[d]);
    if (box->cells[d] < 1 || box->cells[d] > 1000000)
      return CT_REFUSE(error, "box: %d cells along %c", (int)box->cells[d], "xyz"[d]);
  }
  if (box->layers != CT_LAYERS_X && box->layers != CT_LAYERS_Y && box->layers != CT_LAYERS_Z)
    return CT_REFUSE(error, "box: unknown order of numbers %d", (int)box->layers);
  return CT_OK;
}

/* Where a lattice point lies: `shape` is a ct_box or a ct_ring. */
typedef void place_node(const void *shape, const int32_t at[3], double x[3]);

/* Bricks on a lattice; with `corners[d]` equal to `cells[d]` it closes upon itself along d. Numbers
 * run along axis axes[0] first, along axes[2] last; `cells` and `corners` are in that order. */
static ct_status create_lattice(ct_brick_kind kind, const int axes[3], const int32_t cells[3],
                                const int64_t corners[3], place_node *place, const void *shape,
                                ct_mesh **out, ct_error *error)
{
  int64_t n[3] = {cells[0], cells[1], cells[2]};
  if (n[0] * n[1] > INT32_MAX) return CT_REFUSE(error, "a mesh of too many cells");
  int64_t nodes = corners[0] * corners[1] * corners[2];
  if (kind == CT_HEX20)
    nodes += n[0] * corners[1] * corners[2] + corners[0] * n[1] * corners[2] +
             corners[0] * corners[1] * n[2];
  ct_status status = mesh_allocate(kind, nodes, n[0] * n[1] * n[2], out, error);
  if (status != CT_OK) return status;

  size_t next = 0;
  int per = ct_brick_node_count(kind);
  int32_t cell[3], at[3], along[3];
  for (cell[2] = 0; cell[2] < cells[2]; cell[2]++)
    for (cell[1] = 0; cell[1] < cells[1]; cell[1]++)
      for (cell[0] = 0; cell[0] < cells[0]; cell[0]++)
        for (int a = 0; a < per; a++) {
          double xi[3];
          ct_brick_reference(kind, a, xi);
          for (int d = 0; d < 3; d++) {
            int64_t points = corners[d] == n[d] ? 2 * n[d] : 2 * n[d] + 1;
            at[d] = (int32_t)((2 * cell[d] + 1 + (int32_t)xi[axes[d]]) % points);
            along[axes[d]] = at[d];
          }
          int32_t node = lattice_node(cells, corners, at);
          (*out)->elements[next++] = node;
          place(shape, along, &(*out)->nodes[3 * (size_t)node]);
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
  if (box == NULL || mesh == NULL || ct_brick_node_count(kind) == 0)
    return CT_REFUSE(error, "box: null argument or unknown element");
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
  return create_lattice(kind, axes, cells, corners, lattice_coordinates, box, mesh, error);
}

/* Cosine and sine of the angle 2π i / n, folded to the first eighth of the circle so that they
 * mirror exactly (eq:mesh-ring). */
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
  x[0] = ring->centre[0] + r * c;
  x[1] = ring->centre[1] + r * s;
  x[2] = ring->centre[2] + (double)(at[2] - ring->cells[2]) * ring->width / (2.0 * ring->cells[2]);
}

ct_status ct_mesh_create_ring(ct_brick_kind kind, const ct_ring *ring, ct_mesh **mesh,
                              ct_error *error)
{
  if (ring == NULL || mesh == NULL || ct_brick_node_count(kind) == 0)
    return CT_REFUSE(error, "ring: null argument or unknown element");
  const double *r = ring->radius;
  if (!(r[0] > 0.0 && r[1] > r[0]) || !isfinite(r[1]) || !(ring->width > 0.0) ||
      !isfinite(ring->width))
    return CT_REFUSE(error, "ring: radius %g to %g, width %g", r[0], r[1], ring->width);
  for (int d = 0; d < 3; d++) {
    static const char *const along[3] = {"along the radius", "around", "across"};
    int32_t least = d == 1 ? 3 : 1;
    if (!isfinite(ring->centre[d])) return CT_REFUSE(error, "ring: its centre is not finite");
    if (ring->cells[d] < least || ring->cells[d] > 1000000)
      return CT_REFUSE(error, "ring: %d cells %s, at least %d are needed", (int)ring->cells[d],
                       along[d], (int)least);
  }
  int64_t corners[3] = {ring->cells[0] + 1, ring->cells[1], ring->cells[2] + 1};
  return create_lattice(kind, (const int[3]){0, 1, 2}, ring->cells, corners, ring_coordinates, ring,
                        mesh, error);
}

ct_status ct_mesh_create_copy(const ct_mesh *source, ct_mesh **mesh, ct_error *error)
{
  if (source == NULL || mesh == NULL) return CT_REFUSE(error, "mesh: null argument");
  ct_status status = ct_mesh_check(source, error);
  if (status == CT_OK)
    status = mesh_allocate(source->kind, source->node_count, source->element_count, mesh, error);
  if (status != CT_OK) return status;
  size_t per = (size_t)ct_brick_node_count(source->kind);
  memcpy((*mesh)->nodes, source->nodes, 3 * (size_t)source->node_count * sizeof(double));
  memcpy((*mesh)->elements, source->elements,
         per * (size_t)source->element_count * sizeof(int32_t));
  return CT_OK;
}

ct_status ct_mesh_element_nodes(const ct_mesh *mesh, int32_t element, int32_t *nodes,
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

/* Jacobian of an element at a point, and the squares of its columns: half the edges of the brick
 * that the element looks like from there. Answers its determinant. */
static double jacobian(ct_brick_kind kind, double nodes[20][3], const double xi[3],
                       double square[3])
{
  double dN[20][3], J[3][3], C[3][3];
  ct_brick_gradient(kind, xi, dN);
  ct_reference_gradient(ct_brick_node_count(kind), dN, nodes, J);
  for (int d = 0; d < 3; d++) square[d] = J[0][d] * J[0][d] + J[1][d] * J[1][d] + J[2][d] * J[2][d];
  return ct_cofactors(J, C);
}

/* Whether a hex8 element is a box along x, y, z, the right way round, which needs no other look.
 * Where the square of its volume is no normal number the answer is 0. */
static int is_upright_box(double nodes[20][3])
{
  const double *low = nodes[0], *high = nodes[6];
  for (int a = 0; a < 8; a++) {
    int at[3] = {a % 4 == 1 || a % 4 == 2, a % 4 >= 2, a >= 4};
    for (int d = 0; d < 3; d++)
      if (nodes[a][d] != (at[d] ? high[d] : low[d])) return 0;
  }
  double edge[3] = {high[0] - low[0], high[1] - low[1], high[2] - low[2]};
  double volume = edge[0] * edge[1] * edge[2];
  return edge[0] > 0.0 && edge[1] > 0.0 && edge[2] > 0.0 && isnormal(volume * volume);
}

/* At Gauss points: the determinant over the product of the edges there, which is 1 for a box
 * (eq:jacobian-points). */
static ct_status check_gauss(ct_brick_kind kind, double nodes[20][3], const ct_rule *rule,
                             int32_t element, ct_error *error)
{
  for (int q = 0; q < rule->count; q++) {
    double square[3], det = jacobian(kind, nodes, rule->xi[q], square),
                      scale = sqrt(square[0] * square[1] * square[2]);
    double relative = scale > 0.0 ? det / scale : det;
    if (!(relative > 1e-12))
      return ct_fail(error, CT_ERROR_GEOMETRY, (ct_place){-1, element, q},
                     "element %d is %s: Jacobian determinant %g at Gauss point %d", (int)element,
                     relative < -1e-12 ? "inverted" : "collapsed", det, q);
  }
  return CT_OK;
}

/* At nodes, where nothing is integrated: the determinant over the product of the edges at the
 * centre. It may be zero only where an edge has collapsed to a point, or leaves its node with a
 * tangent of zero (eq:jacobian-nodes). */
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
  ct_status status = ct_mesh_element_nodes(mesh, element, number, error);
  if (status != CT_OK) return status;
  for (int a = 0; a < ct_brick_node_count(mesh->kind); a++)
    memcpy(nodes[a], &mesh->nodes[3 * (size_t)number[a]], sizeof nodes[a]);
  if (mesh->kind == CT_HEX8 && is_upright_box(nodes)) return CT_OK;
  status = check_gauss(mesh->kind, nodes, rule, element, error);
  return status == CT_OK ? check_nodes(mesh->kind, nodes, number, element, error) : status;
}

/* After the first bad element: say how many there are, and the numbers of some. */
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

ct_status ct_mesh_check(const ct_mesh *mesh, ct_error *error)
{
  if (mesh == NULL || mesh->nodes == NULL || mesh->elements == NULL ||
      ct_brick_node_count(mesh->kind) == 0 || mesh->node_count < 1 || mesh->element_count < 1)
    return CT_REFUSE(error, "mesh: empty, or unknown kind of element");
  for (int32_t i = 0; i < mesh->node_count; i++)
    for (int d = 0; d < 3; d++)
      if (!isfinite(mesh->nodes[3 * (size_t)i + (size_t)d]))
        return ct_fail(error, CT_INVALID, (ct_place){-1, -1, i},
                       "coordinate %c of node %d is not finite", "xyz"[d], (int)i);
  ct_rule rule;
  ct_status status = ct_rule_brick(mesh->kind, &rule);
  for (int32_t e = 0; status == CT_OK && e < mesh->element_count; e++) {
    status = element_check(mesh, &rule, e, error);
    if (status == CT_ERROR_GEOMETRY && error != NULL) count_bad(mesh, &rule, e, error);
  }
  return status;
}

double ct_mesh_shortest_edge(const ct_mesh *mesh)
{
  if (mesh == NULL) return NAN;
  static const int edge[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                  {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
  size_t per = (size_t)ct_brick_node_count(mesh->kind);
  double shortest = INFINITY;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    double length[12], longest = 0.0;
    for (int k = 0; k < 12; k++) {
      const double *a =
          &mesh->nodes[3 * (size_t)mesh->elements[(size_t)e * per + (size_t)edge[k][0]]];
      const double *b =
          &mesh->nodes[3 * (size_t)mesh->elements[(size_t)e * per + (size_t)edge[k][1]]];
      double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
      length[k] = sqrt((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]);
      longest = fmax(longest, length[k]);
    }
    for (int k = 0; k < 12; k++)
      if (length[k] > 1e-9 * longest) shortest = fmin(shortest, length[k]);
  }
  return shortest;
}

void ct_mesh_bounds(const ct_mesh *mesh, double low[3], double high[3])
{
  for (int d = 0; d < 3; d++) {
    low[d] = INFINITY;
    high[d] = -INFINITY;
  }
  if (mesh == NULL) return;
  for (int32_t i = 0; i < mesh->node_count; i++)
    for (int d = 0; d < 3; d++) {
      double x = mesh->nodes[3 * (size_t)i + (size_t)d];
      if (x < low[d]) low[d] = x;
      if (x > high[d]) high[d] = x;
    }
}
