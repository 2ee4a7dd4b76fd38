/* Box meshes, their faces and sets, and what the check of a mesh refuses. */
#include "bodies.h"

static const char *KIND[2] = {"hex8", "hex20"};

/* Positions of the nodes of a box (eq:mesh-lattice). */
static void box_counts(ct_brick_kind kind)
{
  // 3 x 4 x 5 cells: 4 * 5 * 6 corners; 3 * 5 * 6 + 4 * 4 * 6 + 4 * 5 * 5 mid-sides.
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 3, 4, 5, 3, 4, 5);
  tap_ok(m->node_count == (kind == CT_HEX8 ? 120 : 120 + 90 + 96 + 100) && m->element_count == 60,
         "%s: 3 x 4 x 5 cells have %d nodes", KIND[kind], m->node_count);
  int per = ct_brick_node_count(kind), off = 0, unused = 0,
      *used = room(m->node_count, sizeof *used);
  for (int e = 0; e < 60; e++)
    for (int a = 0; a < per; a++) {
      int cell[3] = {e % 3, e / 3 % 4, e / 12};
      double xi[3];
      ct_brick_reference(kind, a, xi);
      // Edges are 1 long, so node (xi, eta, zeta) of cell (i, j, k) stands at i + (1 + xi) / 2 and
      // so on.
      for (int c = 0; c < 3; c++)
        off += m->nodes[3 * m->elements[e * per + a] + c] != cell[c] + 0.5 * (1.0 + xi[c]);
      used[m->elements[e * per + a]]++;
    }
  for (int n = 0; n < m->node_count; n++) unused += used[n] == 0;
  tap_ok(off == 0, "%s: each node of each element is at its place in the cell (%d are not)",
         KIND[kind], off);
  tap_ok(unused == 0, "%s: every node is used", KIND[kind]);
  // Node sharing: each corner of the box is used once, an inner lattice point 8 times.
  int eight = 0, one = 0;
  for (int n = 0; n < 120; n++) eight += used[n] == 8, one += used[n] == 1;
  tap_ok(one == 8 && eight == 2 * 3 * 4, "%s: 8 corners of one element, 24 inner corners of eight",
         KIND[kind]);
  tap_ok(ct_mesh_check(m, NULL) == CT_OK, "%s: the mesh passes its own check", KIND[kind]);
  tap_close(ct_mesh_shortest_edge(m), 1.0, 0.0, "%s: shortest edge", KIND[kind]);
  double low[3], high[3];
  ct_mesh_bounds(m, low, high);
  tap_ok(low[0] == 0 && low[1] == 0 && low[2] == 0 && high[0] == 3 && high[1] == 4 && high[2] == 5,
         "%s: bounds", KIND[kind]);
}

/* To the last bit, for any edges (eq:mesh-lattice). */
static void mirrored_boxes(ct_brick_kind kind)
{
  int faults = 0;
  for (int trial = 0; trial < 20; trial++) {
    double a = 0.1 + fabs(uniform(3.0)), b = 0.1 + fabs(uniform(3.0)), c = 0.1 + fabs(uniform(3.0));
    int n = 1 + pick(40);
    ct_mesh *right = box_mesh(kind, 0, 0, 0, a, b, c, n, 2, 3),
            *left = box_mesh(kind, -a, 0, 0, a, b, c, n, 2, 3);
    int per = ct_brick_node_count(kind);
    for (int e = 0; e < right->element_count; e++)
      for (int i = 0; i < per; i++) {
        int image = e - e % n + (n - 1 - e % n);
        double xi[3];
        ct_brick_reference(kind, i, xi);
        xi[0] = xi[0] == 0.0 ? 0.0 : -xi[0];
        const double *x = &right->nodes[3 * right->elements[e * per + i]],
                     *y = &left->nodes[3 * left->elements[image * per + local_node(kind, xi)]];
        faults += !(y[0] == -x[0] && y[1] == x[1] && y[2] == x[2]);
      }
  }
  tap_ok(faults == 0,
         "%s: boxes on [0, a] and [-a, 0] have exactly negated coordinates (%d do not)", KIND[kind],
         faults);
}

static double element_volume(const ct_mesh *m, int e)
{
  // A box: the product of the diagonal between two opposite corners.
  int per = ct_brick_node_count(m->kind);
  const double *p = &m->nodes[3 * m->elements[e * per]],
               *q = &m->nodes[3 * m->elements[e * per + 6]];
  return (q[0] - p[0]) * (q[1] - p[1]) * (q[2] - p[2]);
}

static void faces(ct_brick_kind kind)
{
  ct_mesh *m = box_mesh(kind, -1, 2, 5, 3, 1, 2, 3, 2, 4);
  int per = ct_brick_node_count(kind), per_face = kind == CT_HEX8 ? 4 : 8,
      want[3] = {2 * 4, 3 * 4, 3 * 2};
  double low[3], high[3], inner[3], area = 0.0, volume = 0.0;
  int outwards = 0, owned = 0, total = 0, counted = 1;
  ct_mesh_bounds(m, low, high);
  int32_t *face = integers(8 * 6 * m->element_count), *owner = integers(6 * m->element_count);
  for (int side = 0; side < 6; side++) {
    int axis = side / 2;
    double at = side % 2 ? high[axis] : low[axis];
    int count = ct_mesh_plane_faces(m, axis, at, face, owner);
    counted &= count == want[axis] && count == ct_mesh_plane_faces(m, axis, at, NULL, NULL);
    for (int f = 0; f < count; f++) {
      ct_face shape = {ct_brick_face_kind(kind), {{0}}};
      double centre[2] = {0, 0}, n[3], y[3];
      int found = 0;
      for (int a = 0; a < per_face; a++) {
        memcpy(shape.node[a], &m->nodes[3 * face[f * per_face + a]], sizeof shape.node[a]);
        for (int b = 0; b < per; b++)
          found += m->elements[owner[f] * per + b] == face[f * per_face + a];
      }
      ct_segment_normal(&shape, centre, n);
      ct_segment_point(&shape, centre, y);
      for (int c = 0; c < 3; c++) inner[c] = 0.5 * (low[c] + high[c]);
      outwards += n[axis] * (y[axis] - inner[axis]) > 0.0 && fabs(fabs(n[axis]) - 1.0) < 1e-14;
      owned += found == per_face;
      area += 4.0 * ct_segment_area_element(&shape, centre);
      total++;
    }
  }
  tap_ok(counted, "%s: each side of the box has its faces", KIND[kind]);
  tap_ok(outwards == total, "%s: all %d normals point out of the box", KIND[kind], total);
  tap_ok(owned == total, "%s: each face's nodes are its owner's", KIND[kind]);
  tap_close(area, 2 * (3 * 1 + 3 * 2 + 1 * 2), 1e-12, "%s: area of the box", KIND[kind]);
  tap_ok(ct_mesh_outer_faces(m, face, owner) == total &&
             ct_mesh_outer_faces(m, NULL, NULL) == total,
         "%s: outer faces are those of the six sides", KIND[kind]);
  for (int e = 0; e < m->element_count; e++) volume += element_volume(m, e);
  tap_close(volume, 6.0, 1e-12, "%s: volumes of the elements add up", KIND[kind]);
  tap_ok(ct_mesh_plane_faces(m, 0, 0.0, NULL, NULL) == 0,
         "%s: a plane of inner faces has no outer ones", KIND[kind]);
  tap_ok(ct_mesh_plane_faces(m, 0, 17.0, NULL, NULL) == 0 &&
             ct_mesh_plane_faces(m, 3, 0.0, NULL, NULL) == 0 &&
             ct_mesh_plane_faces(m, -1, 0.0, NULL, NULL) == 0,
         "%s: no faces beyond the box, none on a fourth axis", KIND[kind]);

  int32_t *set = integers(m->node_count);
  int count = ct_mesh_plane_nodes(m, 2, 5.0, set), ascending = 1, right = 0;
  for (int i = 1; i < count; i++) ascending &= set[i] > set[i - 1];
  for (int n = 0; n < m->node_count; n++) right += m->nodes[3 * n + 2] == 5.0;
  tap_ok(count == right && ascending && count == (kind == CT_HEX8 ? 12 : 12 + 9 + 8),
         "%s: %d nodes in a plane, ascending", KIND[kind], count);
}

/* Faces and their outward side survive any turning of the elements' own axes. */
/* The faces in a plane are the outer faces in it, in the same order; inner faces in it do not
 * count. */
static void faces_in_planes(ct_brick_kind kind)
{
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 3, 4, 5, 3, 4, 5);
  int per = kind == CT_HEX8 ? 4 : 8, off = 0;
  int32_t count = ct_mesh_outer_faces(m, NULL, NULL), *all = integers(per * count),
          *owner = integers(count), *some = integers(per * count), *its = integers(count);
  ct_mesh_outer_faces(m, all, owner);
  for (int axis = 0; axis < 3; axis++)
    for (int at = 0; at <= 5; at++) {
      int32_t found = ct_mesh_plane_faces(m, axis, at, some, its), next = 0;
      for (int32_t f = 0; f < count; f++) {
        int inside = 1;
        for (int a = 0; a < per; a++) inside &= m->nodes[3 * all[f * per + a] + axis] == (double)at;
        if (!inside) continue;
        off += next >= found || its[next] != owner[f] ||
               memcmp(&some[next * per], &all[f * per], (size_t)per * sizeof *some) != 0;
        next++;
      }
      off += next != found || found != (at == 0 || at == 3 + axis ? 60 / (3 + axis) : 0);
    }
  tap_ok(off == 0, "%s: faces in each plane of a lattice are the outer ones in it (%d are not)",
         KIND[kind], off);
}

static void refused_sides(const ct_mesh *m, int count, const int32_t *sides, int64_t element,
                          int64_t point, const char *word)
{
  int32_t face[16];
  ct_error e = {0};
  ct_status status = ct_mesh_side_faces(m, count, sides, face, &e);
  tap_ok(status == CT_ERROR_ARGUMENT && e.element == element && e.point == point &&
             strstr(e.text, word) != NULL,
         "%s: sides are refused: %s", KIND[m->kind], e.text);
}

/* A set of elements and sides has the faces that lie in the planes of these sides. */
static void faces_of_sides(ct_brick_kind kind)
{
  const double size[3] = {3, 4, 5};
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 3, 4, 5, 3, 4, 5);
  int per = kind == CT_HEX8 ? 4 : 8, off = 0;
  int32_t want[8 * 20], got[8 * 20], owner[20], sides[40];
  for (int side = 0; side < 6; side++) {
    int count = ct_mesh_plane_faces(m, side / 2, side % 2 ? size[side / 2] : 0.0, want, owner);
    for (int i = 0; i < count; i++) sides[2 * i] = owner[i], sides[2 * i + 1] = side;
    off += ct_mesh_side_faces(m, count, sides, got, NULL) != CT_OK ||
           memcmp(got, want, (size_t)(per * count) * sizeof *got) != 0;
  }
  tap_ok(off == 0, "%s: faces by element and side are those in the plane (%d sides are not)",
         KIND[kind], off);
  // Elements 0 and 1 have the side 1 of the first in common.
  refused_sides(m, 2, (const int32_t[]){0, 0, 0, 1}, 0, 1, "inside");
  refused_sides(m, 2, (const int32_t[]){0, 0, 0, 0}, 0, 1, "twice");
  refused_sides(m, 1, (const int32_t[]){0, 6}, -1, 0, "sides are 0 to 5");
  refused_sides(m, 1, (const int32_t[]){60, 0}, -1, 0, "elements 0 to 59");
  refused_sides(m, 1, (const int32_t[]){-1, 0}, -1, 0, "elements 0 to 59");
}

static void turned_faces(void)
{
  ct_mesh *m = box_mesh(CT_HEX20, 0, 0, 0, 1, 1, 1, 3, 3, 3);
  turn_elements(m);
  int32_t *face = integers(8 * 6 * m->element_count);
  int count = ct_mesh_plane_faces(m, 0, 1.0, face, NULL), good = 0;
  for (int f = 0; f < count; f++) {
    ct_face shape = {CT_Q8, {{0}}};
    double centre[2] = {0, 0}, n[3];
    for (int a = 0; a < 8; a++)
      memcpy(shape.node[a], &m->nodes[3 * face[f * 8 + a]], sizeof shape.node[a]);
    ct_segment_normal(&shape, centre, n);
    good += n[0] > 0.999999;
  }
  tap_ok(ct_mesh_check(m, NULL) == CT_OK && count == 9 && good == 9,
         "rotated elements: nine faces at x = 1, all outwards");
}

static void refused(ct_mesh *m, ct_status want, int64_t element, int64_t point, const char *word,
                    const char *what)
{
  ct_error e = {0};
  ct_mesh *copy = NULL;
  ct_status status = ct_mesh_check(m, &e);
  tap_ok(status == want && e.code == want && e.element == element &&
             (point < 0 || e.point == point) && strstr(e.text, word) != NULL,
         "%s is refused: %s", what, e.text);
  tap_ok(ct_mesh_create_copy(m, &copy, NULL) == want && copy == NULL, "%s is not copied", what);
}

/* Faults of a mesh, among them elements that are inverted or flat (eq:jacobian-points). */
static void refusals(ct_brick_kind kind)
{
  int per = ct_brick_node_count(kind);
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 4, 1, 1, 4, 1, 1);
  int32_t *three = &m->elements[3 * per], keep[20];
  double old;

  memcpy(keep, three, sizeof(int32_t) * (size_t)per);
  for (int a = 0; a < 4; a++) three[a] = keep[a + 4], three[a + 4] = keep[a];
  for (int a = 8; kind == CT_HEX20 && a < 12; a++) three[a] = keep[a + 4], three[a + 4] = keep[a];
  refused(m, CT_ERROR_GEOMETRY, 3, 0, "inverted", "an inverted element");
  memcpy(three, keep, sizeof(int32_t) * (size_t)per);

  for (int a = 0; a < 4; a++) three[a + 4] = keep[a];
  for (int a = 8; kind == CT_HEX20 && a < 12; a++)
    three[a + 4] = keep[a], three[a + 8] = keep[a - 8];
  refused(m, CT_ERROR_GEOMETRY, 3, 0, "collapsed", "an element without height");
  memcpy(three, keep, sizeof(int32_t) * (size_t)per);

  three[2] = m->node_count;
  refused(m, CT_ERROR_ARGUMENT, 3, -1, "names node", "a node number too large");
  three[2] = -1;
  refused(m, CT_ERROR_ARGUMENT, 3, -1, "names node", "a negative node number");
  memcpy(three, keep, sizeof(int32_t) * (size_t)per);

  // The second element again, with its axes turned.
  const int32_t *one = &m->elements[per];
  for (int a = 0; a < 4; a++) three[a] = one[(a + 1) % 4], three[4 + a] = one[4 + (a + 1) % 4];
  for (int a = 0; kind == CT_HEX20 && a < 4; a++)
    for (int b = 8; b < 20; b += 4) three[b + a] = one[b + (a + 1) % 4];
  refused(m, CT_ERROR_ARGUMENT, 3, -1, "corners of element 1", "an element that is listed twice");
  memcpy(three, keep, sizeof(int32_t) * (size_t)per);

  // The last element reaches over the one before it to that one's first side.
  const int32_t *two = &m->elements[2 * per];
  static const int first[8] = {0, 3, 4, 7, 11, 15, 16, 19};
  for (int a = 0; a < (kind == CT_HEX20 ? 8 : 4); a++) three[first[a]] = two[first[a]];
  refused(m, CT_ERROR_ARGUMENT, 3, -1, "both element 1 and element 2", "a face of three elements");
  memcpy(three, keep, sizeof(int32_t) * (size_t)per);

  old = m->nodes[3 * 5 + 1];
  m->nodes[3 * 5 + 1] = NAN;
  refused(m, CT_INVALID, -1, 5, "node 5", "a coordinate that is NaN");
  m->nodes[3 * 5 + 1] = INFINITY;
  refused(m, CT_INVALID, -1, 5, "coordinate y", "an infinite coordinate");
  m->nodes[3 * 5 + 1] = old;
  tap_ok(ct_mesh_check(m, NULL) == CT_OK, "%s: without these faults it passes", KIND[kind]);

  m->kind = (ct_brick_kind)7;
  tap_ok(ct_mesh_check(m, NULL) == CT_ERROR_ARGUMENT, "an unknown kind of element is refused");
  m->kind = kind;
  m->element_count = 0;
  tap_ok(ct_mesh_check(m, NULL) == CT_ERROR_ARGUMENT &&
             ct_mesh_check(NULL, NULL) == CT_ERROR_ARGUMENT,
         "an empty mesh is refused");
}

/* Put nodes `from` in the place of node `to`. */
static void join(ct_mesh *m, int to, int count, const int *from)
{
  for (int i = 0; i < count; i++)
    memcpy(&m->nodes[3 * m->elements[from[i]]], &m->nodes[3 * m->elements[to]],
           3 * sizeof *m->nodes);
}

static void accepted(ct_mesh *m, const char *what)
{
  ct_error e = {0};
  tap_ok(ct_mesh_check(m, &e) == CT_OK, "%s %s is accepted%s%s", KIND[m->kind], what,
         e.code == CT_OK ? "" : ": ", e.text);
}

/* Bricks that are degenerate at a corner: wedges, pyramids and quarter points are used, flat and
 * reversed corners are faults
 * (eq:jacobian-nodes). */
static void corners(ct_brick_kind kind)
{
  static const int WEDGE[2][3] = {{2, 9, 9}, {6, 13, 13}}, PYRAMID[7] = {5, 6, 7, 12, 13, 14, 15};
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  double *keep = numbers(3 * m->node_count), *six = &m->nodes[3 * m->elements[6]];
  size_t size = 3 * (size_t)m->node_count * sizeof *keep;
  memcpy(keep, m->nodes, size);

  join(m, 1, kind == CT_HEX20 ? 3 : 1, WEDGE[0]);
  join(m, 5, kind == CT_HEX20 ? 3 : 1, WEDGE[1]);
  if (kind == CT_HEX20) join(m, 17, 1, (const int[1]){18});
  accepted(m, "with two collapsed edges, a wedge,");
  memcpy(m->nodes, keep, size);

  join(m, 4, kind == CT_HEX20 ? 7 : 3, PYRAMID);
  accepted(m, "with a collapsed side, a pyramid,");
  memcpy(m->nodes, keep, size);

  // Corner 6 at (1, 1, 1) in the plane of its three neighbours, and beyond it. Mid-side nodes
  // follow.
  for (int beyond = 0; beyond < 2; beyond++) {
    double at = beyond ? 0.6 : 2.0 / 3.0;
    for (int c = 0; c < 3; c++) six[c] = at;
    for (int i = 0; kind == CT_HEX20 && i < 3; i++) {
      static const int MIDDLE[3] = {13, 14, 18}, END[3] = {5, 7, 2};
      for (int c = 0; c < 3; c++)
        m->nodes[3 * m->elements[MIDDLE[i]] + c] =
            0.5 * (at + m->nodes[3 * m->elements[END[i]] + c]);
    }
    refused(m, CT_ERROR_GEOMETRY, 0, -1,
            beyond ? "inverted at its corner 6" : "collapsed at its corner 6",
            beyond ? "an inverted corner" : "a flat corner");
  }
  memcpy(m->nodes, keep, size);

  // A mid-side node at the quarter point, and beyond it.
  double *middle = kind == CT_HEX20 ? &m->nodes[3 * m->elements[18]] : NULL;
  if (middle != NULL) {
    middle[2] = 0.75;
    accepted(m, "with a mid-side node at the quarter point");
    middle[2] = 0.8;
    refused(m, CT_ERROR_GEOMETRY, 0, -1, "inverted at its corner 6",
            "a mid-side node beyond the quarter point");
  }
}

/* Smallest determinant of a brick on a lattice of n³ points. */
static double least_determinant(const ct_mesh *m, int n)
{
  double least = INFINITY, x[20][3], J[3][3];
  for (int a = 0; a < ct_brick_node_count(m->kind); a++)
    memcpy(x[a], &m->nodes[3 * m->elements[a]], sizeof x[a]);
  for (int i = 0; i < n * n * n; i++) {
    double xi[3] = {2.0 * (i % n) / (n - 1) - 1.0, 2.0 * (i / n % n) / (n - 1) - 1.0,
                    2.0 * (i / n / n) / (n - 1) - 1.0};
    least = fmin(least, brick_determinant(m->kind, x, xi, J));
  }
  return least;
}

/* Bricks with all nodes moved at random by up to 0.15 edges: all regular ones pass, and nearly no
 * others. */
static void random_bricks(ct_brick_kind kind)
{
  enum { COUNT = 400 };
  int regular = 0, passed = 0, lost = 0, missed = 0;
  for (int k = 0; k < COUNT; k++) {
    ct_mesh *m = box_mesh(kind, 0, 0, 0, 1, 1, 1, 1, 1, 1);
    shake(m, kind == CT_HEX20 ? 0.15 : 0.3, 0);
    int good = least_determinant(m, 9) > 0.0, pass = ct_mesh_check(m, NULL) == CT_OK;
    regular += good, passed += pass, lost += good && !pass, missed += pass && !good;
  }
  tap_ok(
      lost == 0 && missed < 0.03 * passed,
      "%s: of %d random bricks %d are regular, %d pass; %d of them are inverted between the nodes",
      KIND[kind], COUNT, regular, passed, missed);
}

/* Number of the node that stands exactly at (x, y, z), or -1. */
static int node_at(const ct_mesh *m, double x, double y, double z)
{
  for (int n = 0; n < m->node_count; n++)
    if (m->nodes[3 * n] == x && m->nodes[3 * n + 1] == y && m->nodes[3 * n + 2] == z) return n;
  return -1;
}

/* A ring closes on itself: counts, the volume of a polygon's prism, radii, and exact mirror images
 * of its nodes (eq:mesh-ring). */
static void rings(ct_brick_kind kind)
{
  static const int around[3] = {3, 8, 12};
  for (int k = 0; k < 3; k++) {
    int n[3] = {2, around[k], 3}, faults = 0, corners = (n[0] + 1) * n[1] * (n[2] + 1);
    int edges = n[0] * n[1] * (n[2] + 1) + corners + (n[0] + 1) * n[1] * n[2];
    ct_ring ring = {{0, 0, 0}, {1.5, 2.25}, 0.7, {n[0], n[1], n[2]}};
    ct_mesh *m = NULL;
    must(ct_mesh_create_ring, kind, &ring, &m);
    must(ct_mesh_check, m);
    tap_ok(m->element_count == n[0] * n[1] * n[2] &&
               m->node_count == corners + (kind == CT_HEX20 ? edges : 0) &&
               ct_mesh_outer_faces(m, NULL, NULL) == 2 * n[1] * (n[0] + n[2]),
           "ring of %d, kind %d: nodes, elements, outer faces", n[1], (int)kind);
    double *mass = numbers(m->node_count), volume = 0.0, pi = acos(-1.0),
           polygon = 0.5 * n[1] * sin(2 * pi / n[1]) * (2.25 * 2.25 - 1.5 * 1.5) * 0.7, off = 0.0;
    must(ct_mass_lumped, m, 1.0, CT_LUMP_DEFAULT, mass);
    for (int i = 0; i < m->node_count; i++) volume += mass[i];
    // Quadratic edges are parabolas, each with two thirds of chord times height beyond the polygon.
    double segment = kind == CT_HEX8 ? 0.0
                                     : n[1] * 4.0 / 3.0 * sin(pi / n[1]) * (1.0 - cos(pi / n[1])) *
                                           (2.25 * 2.25 - 1.5 * 1.5) * 0.7;
    tap_close(volume, polygon + segment, 1e-13, "ring of %d, kind %d: volume", n[1], (int)kind);
    for (int i = 0; i < m->node_count; i++) {
      double *x = &m->nodes[3 * i], r = hypot(x[0], x[1]), layer = (r - 1.5) / 0.75 * 2 * n[0];
      off = worst(off, layer - floor(layer + 0.5));
      faults += node_at(m, x[0], -x[1], x[2]) < 0;
      faults += node_at(m, x[0], x[1], -x[2]) < 0;
      if (n[1] % 2 == 0) faults += node_at(m, -x[0], x[1], x[2]) < 0;
      if (n[1] % 4 == 0) faults += node_at(m, x[1], x[0], x[2]) < 0;
    }
    tap_ok(off < 1e-13, "ring of %d, kind %d: nodes stand on circles, off by %.2g", n[1], (int)kind,
           off);
    tap_ok(faults == 0, "ring of %d, kind %d: nodes have exact mirror images", n[1], (int)kind);
    free_mesh(m);
  }
}

static void ring_refused(ct_ring ring, const char *word, const char *what)
{
  ct_mesh *m = NULL;
  ct_error e = {0};
  tap_ok(ct_mesh_create_ring(CT_HEX8, &ring, &m, &e) == CT_ERROR_ARGUMENT && m == NULL &&
             strstr(e.text, word) != NULL,
         "%s is refused: %s", what, e.text);
}

static void box_refused(double size, int cells, double origin, const char *what)
{
  ct_box box = {.origin = {0, origin, 0}, .size = {1, size, 1}, .cells = {1, cells, 1}};
  ct_mesh *m = NULL;
  ct_error e = {0};
  ct_status status = ct_mesh_create_box(CT_HEX8, &box, &m, &e);
  tap_ok(status == CT_ERROR_ARGUMENT && m == NULL && strstr(e.text, "along y") != NULL,
         "a box with %s is refused: %s", what, e.text);
}

/* Elements are checked in groups: each of 27 is found if its far corner is exchanged with its near
 * one, for any size of the mesh. */
static void each_is_checked(ct_brick_kind kind, double scale)
{
  ct_mesh *m = box_mesh(kind, 0, 0, 0, scale, scale, scale, 3, 3, 3);
  int per = ct_brick_node_count(kind), found = 0;
  for (int32_t el = 0; el < m->element_count; el++) {
    int32_t *element = &m->elements[(size_t)per * (size_t)el], first = element[0];
    ct_error e = {0};
    // Node 1 takes the place of node 0, and node 0 that of node 1: the corners 0 and 6 that a box
    // is known by are no sign of it.
    element[0] = element[1], element[1] = first;
    found += ct_mesh_check(m, &e) == CT_ERROR_GEOMETRY && e.element == el;
    element[1] = element[0], element[0] = first;
    double *x = &m->nodes[3 * (size_t)element[3]], keep = x[2];
    x[2] += 2.0 * scale;
    found += ct_mesh_check(m, &e) == CT_ERROR_GEOMETRY && e.element <= el;
    x[2] = keep;
  }
  tap_ok(found == 2 * m->element_count && ct_mesh_check(m, NULL) == CT_OK,
         "%s of size %g: each of 27 elements is found if it is inverted, %d of %d", KIND[kind],
         scale, found, 2 * (int)m->element_count);
}

/* The shortest of different edges, in a group and in the rest of one; an edge of zero length does
 * not count. */
static void unlike_edges(ct_brick_kind kind)
{
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 11, 0.25, 3, 11, 1, 1);
  tap_close(ct_mesh_shortest_edge(m), 0.25, 0.0, "%s: the shortest of unlike edges", KIND[kind]);
  int per = ct_brick_node_count(kind);
  for (int32_t el = 0; el < 11; el++) {
    double *a = &m->nodes[3 * (size_t)m->elements[per * el]],
           *b = &m->nodes[3 * (size_t)m->elements[per * el + 1]], keep = b[0];
    b[0] = a[0] + 0.125;
    tap_ok(ct_mesh_shortest_edge(m) == 0.125, "%s: that of element %d", KIND[kind], (int)el);
    b[0] = a[0];
    tap_ok(ct_mesh_shortest_edge(m) == 0.25, "%s: a wedge has no edge there", KIND[kind]);
    b[0] = keep;
  }
}

/* Two wedges, one on the other, whose bricks are collapsed at different corners: the triangle
 * between them is inside, and a side that is collapsed to an edge is no face. */
static void wedge_faces(void)
{
  double nodes[9][3];
  int32_t elements[2][8] = {{0, 1, 2, 2, 3, 4, 5, 5}, {4, 5, 3, 3, 7, 8, 6, 6}}, faces[12][4],
          owners[12];
  for (int n = 0; n < 9; n++)
    nodes[n][0] = n % 3 == 1, nodes[n][1] = n % 3 == 2, nodes[n][2] = n / 3;
  ct_mesh m = {CT_HEX8, 9, 2, nodes[0], elements[0], NULL};
  accepted(&m, "two wedges as bricks with a collapsed side");
  int32_t count = ct_mesh_outer_faces(&m, faces[0], owners);
  double sum[3] = {0, 0, 0}, area = 0;
  for (int i = 0; i < count; i++) {
    double u[3], v[3], square = 0;
    for (int d = 0; d < 3; d++) {
      u[d] = nodes[faces[i][2]][d] - nodes[faces[i][0]][d];
      v[d] = nodes[faces[i][3]][d] - nodes[faces[i][1]][d];
    }
    for (int d = 0; d < 3; d++) {
      double n = (u[(d + 1) % 3] * v[(d + 2) % 3] - u[(d + 2) % 3] * v[(d + 1) % 3]) / 2;
      sum[d] += n, square += n * n;
    }
    area += sqrt(square);
  }
  tap_ok(count == 8, "two triangles and six rectangles are outside (%d faces)", count);
  tap_close(area, 1.0 + 4.0 + 2.0 * sqrt(2.0), 1e-15, "they have the area of the prism");
  tap_ok(fabs(sum[0]) + fabs(sum[1]) + fabs(sum[2]) < 1e-15, "and close it");
  tap_ok(ct_mesh_plane_faces(&m, 2, 1.0, NULL, NULL) == 0 &&
             ct_mesh_plane_faces(&m, 2, 2.0, NULL, NULL) == 1,
         "no face is between the wedges, and one on top");
}

/* Corners of a box from -1 to 3 along y; `x`, shape (n + 1). */
static void graded_points(ct_brick_kind kind, int32_t n, double R, int symmetric, double begin,
                          double *x)
{
  ct_box box = {.origin = {0, begin, 0}, .size = {1, 4, 1}, .cells = {1, n, 1}};
  box.grading[1] = R, box.symmetric[1] = symmetric;
  ct_mesh *m = mesh_of(kind, box);
  for (int i = 0; i <= n; i++) x[i] = m->nodes[3 * (2 * i) + 1];
  // Middles of edges along y, which follow the corners and the middles along x.
  for (int i = 0; kind == CT_HEX20 && i < n; i++)
    if (fabs(m->nodes[3 * (6 * (n + 1) + 2 * i) + 1] - (x[i] + x[i + 1]) / 2.0) > 1e-15) x[i] = NAN;
}

/* Where (q^i - 1) / (q^n - 1) puts point i of n, in long double (eq:mesh-grading). */
static long double geometric_series(long double R, int32_t n, int32_t i)
{
  long double l = n > 1 ? logl(R) / (n - 1) : 0.0L;
  return l == 0.0L ? (long double)i / n : expm1l(i * l) / expm1l(n * l);
}

/* Graded boxes: the closed form, both ways, mirrored, and symmetric (eq:mesh-root). */
static void graded_boxes(ct_brick_kind kind)
{
  static const double R[] = {1e-6, 0.25, 0.5, 1.0, 1.0 + 1e-12, 1.1, 3.0, 64.0, 1e6};
  static const int32_t count[] = {1, 2, 3, 7, 40, 1000};
  double x[1001], y[1001], off = 0.0, middle = 0.0;
  int unlike = 0;
  for (int k = 0; k < 9; k++)
    for (int c = 0; c < 6; c++) {
      const int32_t n = count[c], half = n / 2, odd = n % 2;
      graded_points(kind, n, R[k], 0, -1.0, x);
      for (int i = 0; i <= n; i++)
        off = worst(off, (x[i] + 1.0 - 4.0 * (double)geometric_series(R[k], n, i)) / n);
      graded_points(kind, n, 1.0 / R[k], 0, -3.0, y);
      for (int i = 0; i <= n; i++) unlike += 1.0 / (1.0 / R[k]) == R[k] && x[i] != -y[n - i];
      graded_points(kind, n, R[k], 1, -1.0, x);
      graded_points(kind, n, R[k], 1, -2.0, y);
      for (int i = 0; i <= n; i++) unlike += y[i] != -y[n - i];
      // Of an odd number of elements the one in the middle belongs to both sides: 2 S - 1.
      for (int i = 0; i <= half; i++) {
        long double q = half + odd > 1 ? powl(R[k], 1.0L / (half + odd - 1)) : 1.0L, S = 0.0L,
                    all = 0.0L;
        for (int m = 0; m < half + odd; m++) {
          long double h = powl(q, m) / (odd && m == 0 ? 2.0L : 1.0L);
          all += h, S += m < half + odd - i ? h : 0.0L;
        }
        middle = worst(middle, (x[i] - 1.0 + 2.0 * (double)(S / all)) / n);
      }
    }
  // Round-off of sums of positive terms: some of 1e-16 of the length for each factor of the
  // product.
  tap_close(off, 0.0, 8e-16, "%s: graded boxes have the points of the geometric series",
            KIND[kind]);
  tap_close(middle, 0.0, 8e-16, "%s: and on both sides of the middle", KIND[kind]);
  tap_ok(unlike == 0, "%s: with 1/R and about the middle they are mirror images (%d points)",
         KIND[kind], unlike);
}

/* Twice the edge from element to element, exactly; the neighbours' ratio of any series is constant.
 */
static void graded_ratio(void)
{
  double x[41], off = 0.0;
  graded_points(CT_HEX8, 4, 8.0, 0, 0.0, x);
  for (int i = 0; i <= 4; i++) off = worst(off, x[i] - 4.0 * ((1 << i) - 1) / 15.0);
  tap_close(off, 0.0, 2e-15, "elements of 1, 2, 4, 8 fifteenths");
  graded_points(CT_HEX8, 12, 3.0, 0, 0.0, x);
  for (int i = 1; i < 12; i++)
    off = worst(off, (x[i + 1] - x[i]) / (x[i] - x[i - 1]) - pow(3.0, 1.0 / 11.0));
  // Two differences of coordinates up to 4, rounded to 4e-16, over lengths of .2.
  tap_close(off, 0.0, 1e-14, "the ratio of neighbours is the eleventh root of 3");
}

int main(void)
{
  free_at_end();
  for (int kind = 0; kind < CT_BRICK_COUNT; kind++) {
    box_counts((ct_brick_kind)kind);
    mirrored_boxes((ct_brick_kind)kind);
    faces((ct_brick_kind)kind);
    faces_in_planes((ct_brick_kind)kind);
    faces_of_sides((ct_brick_kind)kind);
    refusals((ct_brick_kind)kind);
    corners((ct_brick_kind)kind);
    random_bricks((ct_brick_kind)kind);
    each_is_checked((ct_brick_kind)kind, 1.0);
    each_is_checked((ct_brick_kind)kind, 1e-5);
    unlike_edges((ct_brick_kind)kind);
    graded_boxes((ct_brick_kind)kind);
  }
  graded_ratio();
  turned_faces();
  wedge_faces();
  box_refused(0.0, 1, 0.0, "no height");
  box_refused(-1.0, 1, 0.0, "a negative height");
  box_refused(NAN, 1, 0.0, "a height that is NaN");
  box_refused(1.0, 0, 0.0, "no cells");
  box_refused(1.0, 1, INFINITY, "an origin at infinity");
  ct_box big = {.size = {1, 1, 1}, .cells = {1000000, 1000000, 1000000}},
         some = {.size = {1, 1, 1}, .cells = {2000, 2000, 2000}, .layers = CT_LAYERS_X};
  ct_mesh *m = NULL;
  tap_ok(ct_mesh_create_box(CT_HEX8, &big, &m, NULL) == CT_ERROR_ARGUMENT &&
             ct_mesh_create_box(CT_HEX20, &some, &m, NULL) == CT_ERROR_ARGUMENT,
         "more cells than 32 bits can count are refused");
  tap_ok(ct_mesh_create_box(CT_HEX8, NULL, &m, NULL) == CT_ERROR_ARGUMENT &&
             ct_mesh_create_box((ct_brick_kind)5, &some, &m, NULL) == CT_ERROR_ARGUMENT,
         "no box and an unknown element are refused");
  for (int kind = 0; kind < CT_BRICK_COUNT; kind++) rings((ct_brick_kind)kind);
  ring_refused((ct_ring){{0, 0, 0}, {0, 1}, 1, {1, 8, 1}}, "radius", "a ring without a hole");
  ring_refused((ct_ring){{0, 0, 0}, {1, 1}, 1, {1, 8, 1}}, "radius", "a ring without thickness");
  ring_refused((ct_ring){{0, 0, 0}, {1, 2}, NAN, {1, 8, 1}}, "width", "a width that is NaN");
  ring_refused((ct_ring){{0, 0, INFINITY}, {1, 2}, 1, {1, 8, 1}}, "centre", "a centre at infinity");
  ring_refused((ct_ring){{0, 0, 0}, {1, 2}, 1, {1, 2, 1}}, "around", "a ring of two cells");
  ring_refused((ct_ring){{0, 0, 0}, {1, 2}, 1, {1, 8, 0}}, "across", "a ring without cells");
  tap_ok(ct_mesh_create_ring(CT_HEX8, NULL, &m, NULL) == CT_ERROR_ARGUMENT,
         "a null ring is refused");
  ct_mesh_free(NULL);
  double low[3], high[3];
  ct_mesh_bounds(NULL, low, high);
  tap_ok(isnan(ct_mesh_shortest_edge(NULL)) && low[0] > high[0],
         "a null mesh has no edge and no bounds");
  double corner[3] = {0, 0, 0}, out[8];
  int32_t beyond[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  ct_mesh wrong = {CT_HEX8, 1, 1, corner, beyond, 0};
  ct_material steel = {2.1e11, 0.3, 7800.0, CT_LINEAR};
  ct_error e = {0};
  tap_ok(ct_mass_lumped(&wrong, 1.0, CT_LUMP_DEFAULT, out, &e) == CT_ERROR_ARGUMENT &&
             e.element == 0,
         "masses: a node out of range is refused: %s", e.text);
  tap_ok(ct_solid_stress(&wrong, &steel, corner, out, &e) == CT_ERROR_ARGUMENT && e.element == 0,
         "stresses: a node out of range is refused: %s", e.text);
  return tap_done();
}
