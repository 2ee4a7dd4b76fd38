#include "shape.h"
#include "../base/vector.h"

#include <math.h>

/* Sign of the one reference coordinate that a mid-side has. */
static const double SIDE[4] = {-1, 1, 1, -1};

int ct_face_node_count(ct_face_kind kind)
{
  switch (kind) {
  case CT_Q4:
    return 4;
  case CT_Q8:
    return 8;
  case CT_T3:
    return 3;
  case CT_T6:
    return 6;
  }
  return 0;
}

static void fill(double *values, int count, double value)
{
  for (int i = 0; i < count; i++) values[i] = value;
}

/* Mid-side i (0 to 3) of a Q8 runs along xi_1 when i is even: `r` is the coordinate along it, `s`
 * the one across. */
static void side_axes(int i, const double xi[2], int *along, double *r, double *s)
{
  *along = i % 2;
  *r = xi[*along];
  *s = SIDE[i] * xi[1 - *along];
}

void ct_segment_shape(ct_face_kind kind, const double xi[2], double N[8])
{
  if (xi == NULL || N == NULL) return;
  fill(N, 8, ct_face_node_count(kind) == 0 ? NAN : 0);
  if (kind == CT_Q4 || kind == CT_Q8) {
    ct_shape_quadrilateral(ct_face_node_count(kind), xi[0], xi[1], N, 1);
  } else if (kind == CT_T3 || kind == CT_T6) {
    // -- Area coordinates (eq:segment-triangle)
    double L[3] = {1 - (xi[0] + xi[1]), xi[0], xi[1]};
    for (int i = 0; i < 3; i++) {
      N[i] = kind == CT_T3 ? L[i] : L[i] * (2 * L[i] - 1);
      if (kind == CT_T6) N[3 + i] = 4 * (L[i] * L[(i + 1) % 3]);
    }
  }
}

void ct_segment_gradient(ct_face_kind kind, const double xi[2], double dN[8][2])
{
  fill(dN[0], 16, 0);
  if (kind == CT_Q4) {
    ct_shape_gradient_q4(xi[0], xi[1], dN[0], 1);
  } else if (kind == CT_Q8) {
    for (int i = 0; i < 4; i++) {
      const double *c = CT_SHAPE_CORNER[i];
      double x = c[0] * xi[0], y = c[1] * xi[1];
      dN[i][0] = 0.25 * c[0] * (1 + y) * (2 * x + y);
      dN[i][1] = 0.25 * c[1] * (1 + x) * (x + 2 * y);
      int along;
      double r, s;
      side_axes(i, xi, &along, &r, &s);
      dN[4 + i][along] = -r * (1 + s);
      dN[4 + i][1 - along] = 0.5 * SIDE[i] * ((1 - r) * (1 + r));
    }
  } else if (kind == CT_T3 || kind == CT_T6) {
    static const double dL[3][2] = {{-1, -1}, {1, 0}, {0, 1}};
    double L[3] = {1 - (xi[0] + xi[1]), xi[0], xi[1]};
    for (int i = 0; i < 3; i++) {
      int j = (i + 1) % 3;
      for (int a = 0; a < 2; a++) {
        dN[i][a] = kind == CT_T3 ? dL[i][a] : dL[i][a] * (4 * L[i] - 1);
        if (kind == CT_T6) dN[3 + i][a] = 4 * (dL[i][a] * L[j] + L[i] * dL[j][a]);
      }
    }
  }
}

/* Weight times coordinate k of each node; inlined with a known number of nodes. */
CT_INLINE void weigh(int count, const ct_face *face, int k, const double weight[8], double v[8])
{
  // (eq:segment-point, eq:segment-tangents)
  for (int i = 0; i < count; i++) v[i] = weight[i] * face->node[i][k];
}

/* Sum over the nodes of weight times coordinate, in the tree that a flip of xi_1 or xi_2 (of
 * quadrilaterals) and an exchange of xi_1 and xi_2 (of triangles) maps onto itself, so that a
 * mirrored face gives mirrored bits. */
static void node_sum(const ct_face *face, const double weight[8], double sum[3])
{
  double v[8];
  for (int k = 0; k < 3; k++) switch (face->kind) { // -- Pair the nodes
    case CT_Q4:
      weigh(4, face, k, weight, v);
      sum[k] = (v[0] + v[1]) + (v[2] + v[3]);
      break;
    case CT_Q8:
      weigh(8, face, k, weight, v);
      // (eq:segment-tree)
      sum[k] = ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[6]) + (v[5] + v[7]));
      break;
    case CT_T3:
      weigh(3, face, k, weight, v);
      sum[k] = v[0] + (v[1] + v[2]);
      break;
    case CT_T6:
      weigh(6, face, k, weight, v);
      sum[k] = (v[0] + (v[1] + v[2])) + (v[4] + (v[3] + v[5]));
      break;
    default:
      sum[k] = NAN;
    }
}

void ct_segment_point(const ct_face *face, const double xi[2], double y[3])
{
  if (face == NULL || xi == NULL || y == NULL) return;
  double N[8];
  ct_segment_shape(face->kind, xi, N);
  // -- Sum of weight times node
  node_sum(face, N, y);
}

void ct_segment_tangents(const ct_face *face, const double xi[2], double t1[3], double t2[3])
{
  double dN[8][2], dN1[8], dN2[8];
  ct_segment_gradient(face->kind, xi, dN);
  for (int i = 0; i < 8; i++) dN1[i] = dN[i][0], dN2[i] = dN[i][1];
  // -- Sums of derivative times node
  node_sum(face, dN1, t1);
  node_sum(face, dN2, t2);
}

ct_status ct_segment_normal(const ct_face *face, const double xi[2], double n[3])
{
  fill(n, 3, NAN);
  double t1[3], t2[3], normal[3];
  ct_segment_tangents(face, xi, t1, t2);
  // -- Vector product of the tangents, divided by its length
  if (!ct_vector_unit_normal(t1, t2, normal)) return CT_ERROR_GEOMETRY; // (eq:segment-normal)
  for (int k = 0; k < 3; k++) n[k] = normal[k];
  return CT_OK;
}

double ct_segment_area_element(const ct_face *face, const double xi[2])
{
  double t1[3], t2[3], n[3];
  ct_segment_tangents(face, xi, t1, t2);
  ct_vector_cross(t1, t2, n);
  // -- Length of the vector product (eq:segment-area)
  return sqrt(ct_vector_dot(n, n));
}
