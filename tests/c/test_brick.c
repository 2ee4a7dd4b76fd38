/* Bricks compared with interpolation conditions and the geometry of the cube; with VTK's node
 * numbers by tests/python/test_projection.py, and gradients by test_equations_faces.py. */
#include "../../libcontact/src/shape/shape.h"

#include "uniform.h"
#include "tap.h"

static const char *NAME[CT_BRICK_COUNT];
static const double PROBE[4][3] = {
    {0.125, 0.25, -0.5}, {-0.625, 0.75, 0.375}, {1, -1, 1}, {0.3, -0.1, 0.7}};

/* Conditions that determine the shape functions, and so eq:brick-hex8 and eq:brick-hex20. */
static void interpolation_conditions(ct_brick_kind kind)
{
  double delta = 0, unity = 0, linear = 0;
  int n = ct_brick_node_count(kind);
  for (int j = 0; j < n; j++) {
    double xi[3], N[20];
    ct_brick_reference(kind, j, xi);
    ct_brick_shape(kind, xi, N);
    for (int i = 0; i < 20; i++) delta = worst(delta, N[i] - (i == j));
  }
  for (int p = 0; p < 4; p++) {
    double N[20], sum = 0, place[3] = {0, 0, 0};
    ct_brick_shape(kind, PROBE[p], N);
    for (int i = 0; i < n; i++) {
      double xi[3];
      ct_brick_reference(kind, i, xi);
      sum += N[i];
      for (int a = 0; a < 3; a++) place[a] += N[i] * xi[a];
    }
    unity = worst(unity, sum - 1);
    for (int a = 0; a < 3; a++) linear = worst(linear, place[a] - PROBE[p][a]);
  }
  tap_close(delta, 0, 0, "%s: N_i is 1 at node i and 0 at the others", NAME[kind]);
  tap_close(unity, 0, 2e-15, "%s: the N_i add up to 1", NAME[kind]);
  tap_close(linear, 0, 2e-15, "%s: the N_i reproduce the coordinates", NAME[kind]);
}

/* The face's own interpolation of the brick's nodes runs over the right side, with its normal
 * outwards and the second axis of eq:brick-sides. */
static void sides(ct_brick_kind kind)
{
  for (int side = 0; side < 6; side++) {
    int axis = side / 2, nodes[8], count = ct_face_node_count(ct_brick_face_kind(kind));
    double sign = side % 2 ? 1 : -1, xi[2] = {0.25, -0.5}, y[3], n[3];
    ct_face face = {ct_brick_face_kind(kind), {{0}}};
    ct_brick_face(kind, side, nodes);
    for (int i = 0; i < count; i++) ct_brick_reference(kind, nodes[i], face.node[i]);
    ct_segment_point(&face, xi, y);
    ct_segment_normal(&face, xi, n);
    tap_ok(y[axis] == sign && n[axis] == sign,
           "%s: side %d lies at the place of its name, normal outwards", NAME[kind], side);
    double unit = ct_segment_area_element(&face, xi);
    tap_close(unit, 1, 1e-15, "%s: side %d has its mid-sides between its corners", NAME[kind],
              side);
    tap_ok(y[axis == 2 ? 1 : 2] == -0.5, "%s: side %d has the second axis that all have",
           NAME[kind], side);
    tap_ok(count == 8 || nodes[4] == -1, "%s: side %d has no further nodes", NAME[kind], side);
  }
}

/* Mirroring the brick in an axis maps each side to a side whose nodes are those of the mirrored
 * brick, with xi_1 (or xi_2) flipped. */
static void mirrored_sides(ct_brick_kind kind)
{
  static const int FLIP1[8] = {1, 0, 3, 2, 4, 7, 6, 5}, FLIP2[8] = {3, 2, 1, 0, 6, 5, 4, 7};
  int good = 1, count = ct_face_node_count(ct_brick_face_kind(kind));
  for (int mirror = 0; mirror < 3; mirror++)
    for (int side = 0; side < 6; side++) {
      int image = side / 2 == mirror ? side ^ 1 : side, nodes[8], others[8], flip1 = 1, flip2 = 1;
      ct_brick_face(kind, side, nodes);
      ct_brick_face(kind, image, others);
      for (int i = 0; i < count; i++) {
        double a[3], b1[3], b2[3];
        ct_brick_reference(kind, nodes[i], a);
        ct_brick_reference(kind, others[FLIP1[i]], b1);
        ct_brick_reference(kind, others[FLIP2[i]], b2);
        a[mirror] = -a[mirror];
        for (int k = 0; k < 3; k++) flip1 &= a[k] == b1[k], flip2 &= a[k] == b2[k];
      }
      if (!flip1 && !flip2) good = 0;
    }
  tap_ok(good, "%s: mirrored bricks have mirrored sides", NAME[kind]);
}

/* The row of a kind, compared with its nodes, its faces, its rule and the integrals of its shape
 * functions over the cube. */
static void row(ct_brick_kind kind)
{
  const ct_brick_facts *f = ct_brick_facts_of(kind);
  int low = 0, corners = 0, positive = 1;
  double cell = 0, size = 0, sum[20] = {0};
  ct_rule rule;
  for (int i = 0; i < f->node_count; i++) {
    double xi[3], share = 1;
    ct_brick_reference(kind, i, xi);
    for (int a = 0; a < 3; a++) share *= xi[a] == 0 ? 1 : 0.5;
    cell += share, low += xi[0] == -1, corners += i < 8 && share == 0.125;
  }
  tap_ok(corners == 8 && ct_brick_node_count(kind) == f->node_count && cell == f->cell_nodes,
         "%s: %d nodes, corners first, %d per brick of a mesh", f->name, f->node_count,
         f->cell_nodes);
  tap_ok(low == ct_face_node_count(f->face_kind) && ct_brick_face_kind(kind) == f->face_kind,
         "%s: a face has %d nodes", f->name, low);
  tap_ok(ct_rule_brick(kind, &rule) == CT_OK && rule.count == f->points * f->points * f->points,
         "%s: its rule has %d points along each axis", f->name, f->points);
  for (int q = 0; q < rule.count; q++) {
    double N[20];
    ct_brick_shape(kind, rule.xi[q], N);
    size += rule.weight[q];
    for (int i = 0; i < f->node_count; i++) sum[i] += rule.weight[q] * N[i];
  }
  for (int i = 0; i < f->node_count; i++) positive &= sum[i] > 0;
  tap_close(size, 8, 1e-14, "%s: the weights add up to the cube", f->name);
  tap_ok(f->row_sum == positive, "%s: lumped by row sums if they are positive", f->name);
  tap_ok(f->trilinear == (f->node_count == 8), "%s: trilinear with 8 nodes", f->name);
}

static void bad_input(void)
{
  tap_ok(ct_brick_facts_of((ct_brick_kind)-1) == NULL && ct_brick_facts_of(CT_BRICK_COUNT) == NULL,
         "no other kind has a row");
  double N[20], xi[3] = {0, 0, 0};
  ct_brick_shape((ct_brick_kind)5, xi, N);
  tap_ok(ct_brick_node_count((ct_brick_kind)5) == 0 && isnan(N[19]),
         "an unknown kind has no nodes and no numbers");
  ct_brick_reference(CT_HEX8, 8, xi);
  tap_ok(isnan(xi[0]), "hex8 has no node 8");
  double dN[20][3];
  N[0] = dN[0][0] = 7.0;
  ct_brick_shape(CT_HEX8, NULL, N);
  ct_brick_gradient(CT_HEX8, NULL, dN);
  ct_brick_gradient(CT_HEX8, xi, NULL);
  tap_ok(N[0] == 7.0 && dN[0][0] == 7.0, "null pointers write nothing");
}

int main(void)
{
  for (int kind = 0; kind < CT_BRICK_COUNT; kind++) {
    NAME[kind] = ct_brick_facts_of((ct_brick_kind)kind)->name;
    if (NAME[kind] == NULL) {
      tap_ok(0, "kind %d has a row", kind);
      continue;
    }
    row((ct_brick_kind)kind);
    interpolation_conditions((ct_brick_kind)kind);
    sides((ct_brick_kind)kind);
    mirrored_sides((ct_brick_kind)kind);
  }
  bad_input();
  return tap_done();
}
