/* Shape functions of the faces against interpolation conditions, closed-form surfaces and mirrored
 * faces. */
#include "../../libcontact/src/shape/shape.h"

#include "faces.h"
#include "tap.h"

static const double PROBE[5][2] = {
    {0.125, 0.25}, {-0.625, 0.75}, {0.875, -0.375}, {-1, 1}, {0.3, 0.1}};

/* Conditions that determine the shape functions, and so eq:segment-q4, eq:segment-q8 and
 * eq:segment-triangle. */
static void interpolation_conditions(ct_face_kind kind)
{
  double delta = 0, unity = 0, slope = 0, padding = 0;
  int n = ct_face_node_count(kind);
  for (int j = 0; j < n; j++) {
    double N[8];
    ct_segment_shape(kind, reference(kind, j), N);
    for (int i = 0; i < n; i++) delta = worst(delta, N[i] - (i == j));
  }
  for (int p = 0; p < 5; p++) {
    double N[8], dN[8][2], sum = 0, dsum[2] = {0, 0};
    ct_segment_shape(kind, PROBE[p], N);
    ct_segment_gradient(kind, PROBE[p], dN);
    for (int i = 0; i < 8; i++) {
      sum += N[i];
      for (int a = 0; a < 2; a++) dsum[a] += dN[i][a];
      if (i >= n) padding += fabs(N[i]) + fabs(dN[i][0]) + fabs(dN[i][1]);
    }
    unity = worst(unity, sum - 1);
    slope = worst(worst(slope, dsum[0]), dsum[1]);
  }
  tap_close(delta, 0, 0, "%s: N_i is 1 at node i and 0 at the others", FACE_NAME[kind]);
  tap_close(unity, 0, 1e-15, "%s: the N_i add up to 1", FACE_NAME[kind]);
  tap_close(slope, 0, 1e-15, "%s: their slopes add up to 0", FACE_NAME[kind]);
  tap_ok(padding == 0, "%s: entries beyond the nodes are 0", FACE_NAME[kind]);
}

/* A surface that the kind can represent, z = polynomial over a sheared base, with its tangents by
 * hand. */
static void surface(ct_face_kind kind, const double xi[2], double y[3], double t1[3], double t2[3])
{
  double r = xi[0], s = xi[1], twist = kind == CT_T3 ? 0 : 1,
         bend = kind == CT_Q8 || kind == CT_T6 ? 1 : 0;
  double q = kind == CT_T3 || kind == CT_Q4 ? 0 : 1, k = kind == CT_Q8 ? 1 : 0;
  if (kind == CT_T6) twist = 1;
  y[0] = 3 + 2 * r + 0.5 * s, y[1] = -1 + 0.25 * r + s;
  y[2] = 0.5 * r - s + 0.3 * twist * r * s + 0.2 * bend * r * r - 0.4 * q * s * s +
         k * (0.1 * r * r * s - 0.7 * r * s * s);
  t1[0] = 2, t1[1] = 0.25,
  t1[2] = 0.5 + 0.3 * twist * s + 0.4 * bend * r + k * (0.2 * r * s - 0.7 * s * s);
  t2[0] = 0.5, t2[1] = 1,
  t2[2] = -1 + 0.3 * twist * r - 0.8 * q * s + k * (0.1 * r * r - 1.4 * r * s);
}

/* Points (eq:segment-point), tangents (eq:segment-tangents), normals (eq:segment-normal) and area
 * elements (eq:segment-area) of that surface. */
static void closed_form_surface(ct_face_kind kind)
{
  ct_face face = {kind, {{0}}};
  double t1[3], t2[3], y[3], place = 0, tangent = 0, normal = 0, area = 0;
  for (int i = 0; i < ct_face_node_count(kind); i++)
    surface(kind, reference(kind, i), face.node[i], t1, t2);
  for (int p = 0; p < 5; p++) {
    double want[3], got1[3], got2[3], n[3];
    surface(kind, PROBE[p], want, t1, t2);
    ct_segment_point(&face, PROBE[p], y);
    ct_segment_tangents(&face, PROBE[p], got1, got2);
    double c[3] = {t1[1] * t2[2] - t1[2] * t2[1], t1[2] * t2[0] - t1[0] * t2[2],
                   t1[0] * t2[1] - t1[1] * t2[0]};
    double J = sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
    tap_ok(ct_segment_normal(&face, PROBE[p], n) == CT_OK, "%s: there is a normal",
           FACE_NAME[kind]);
    for (int k = 0; k < 3; k++) {
      place = worst(place, y[k] - want[k]);
      tangent = worst(worst(tangent, got1[k] - t1[k]), got2[k] - t2[k]);
      normal = worst(normal, n[k] - c[k] / J);
    }
    area = worst(area, ct_segment_area_element(&face, PROBE[p]) / J - 1);
  }
  tap_close(place, 0, 1e-14, "%s: reproduces a surface of its own degree", FACE_NAME[kind]);
  tap_close(tangent, 0, 1e-14, "%s: tangents of that surface", FACE_NAME[kind]);
  tap_close(normal, 0, 1e-14, "%s: unit normal of that surface", FACE_NAME[kind]);
  tap_close(area, 0, 1e-14, "%s: area element of that surface", FACE_NAME[kind]);
}

/* Nodes of the face seen in a mirror: flip of xi_1, flip of xi_2, or (triangles) exchange of xi_1
 * and xi_2. The sum over the nodes keeps its bits (eq:segment-tree). */
static void mirrored_bits(ct_face_kind kind)
{
  static const int FLIP1[8] = {1, 0, 3, 2, 4, 7, 6, 5}, FLIP2[8] = {3, 2, 1, 0, 6, 5, 4, 7},
                   SWAP[8] = {0, 2, 1, 5, 4, 3, 6, 7};
  int triangular = kind >= CT_T3, same = 1;
  unsigned seed = 7;
  for (int trial = 0; trial < 200; trial++) {
    ct_face face = {kind, {{0}}}, mirror = {kind, {{0}}};
    double noise[26];
    for (int i = 0; i < 26; i++)
      noise[i] = (double)(seed = seed * 1664525u + 1013904223u) / 4294967296.0 - 0.5;
    int axis = trial % 3, second = (trial / 3) % 2;
    const int *map = triangular ? SWAP : second ? FLIP2 : FLIP1;
    for (int i = 0; i < 8; i++)
      for (int k = 0; k < 3; k++) face.node[i][k] = noise[3 * i + k];
    for (int i = 0; i < 8; i++)
      for (int k = 0; k < 3; k++) mirror.node[i][k] = face.node[map[i]][k] * (k == axis ? -1 : 1);
    double xi[2] = {noise[24], noise[25]}, other[2] = {xi[0], xi[1]}, y[3], z[3], n[3], m[3];
    if (triangular) other[0] = xi[1], other[1] = xi[0];
    else other[second] = -xi[second];
    ct_segment_point(&face, xi, y);
    ct_segment_point(&mirror, other, z);
    ct_segment_normal(&face, xi, n);
    ct_segment_normal(&mirror, other, m);
    for (int k = 0; k < 3; k++) {
      double sign = k == axis ? -1 : 1;
      if (y[k] != sign * z[k] || n[k] != sign * m[k]) same = 0;
    }
    if (ct_segment_area_element(&face, xi) != ct_segment_area_element(&mirror, other)) same = 0;
  }
  tap_ok(same, "%s: a mirrored face gives the mirrored bits", FACE_NAME[kind]);
}

static void bad_input(void)
{
  ct_face_kind none = (ct_face_kind)9;
  double N[8], n[3] = {0, 0, 0}, xi[2] = {0, 0};
  ct_face point = {CT_Q4, {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}};
  tap_ok(ct_face_node_count(none) == 0, "an unknown kind has no nodes");
  ct_segment_shape(none, xi, N);
  tap_ok(isnan(N[0]) && isnan(N[7]), "shape functions of an unknown kind are NaN");
  ct_segment_shape(CT_Q4, NULL, N);
  ct_segment_point(NULL, xi, n);
  tap_ok(n[0] == 0, "null pointers write nothing");
  tap_ok(ct_segment_normal(&point, xi, n) == CT_ERROR_GEOMETRY && isnan(n[0]),
         "a face shrunk to a point has no normal");
}

int main(void)
{
  for (int kind = 0; kind < 4; kind++) {
    interpolation_conditions((ct_face_kind)kind);
    closed_form_surface((ct_face_kind)kind);
    mirrored_bits((ct_face_kind)kind);
  }
  bad_input();
  return tap_done();
}
