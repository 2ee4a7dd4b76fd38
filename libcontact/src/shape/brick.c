#include "shape.h"

#include <math.h>
#include <stddef.h>

/* All kinds: name, nodes, kind of the faces, Gauss points along an axis, number in VTK, nodes per
 * cell of a mesh, whether it is lumped by row sums, whether it is trilinear. */
static const ct_brick_facts KINDS[] = {[CT_HEX8] = {"hex8", 8, CT_Q4, 2, 12, 1, 1, 1},
                                       [CT_HEX20] = {"hex20", 20, CT_Q8, 3, 25, 4, 0, 0}};

/* A value of ct_brick_kind without a row does not compile, if it is the last one. */
typedef char every_kind_has_its_row[sizeof KINDS / sizeof KINDS[0] == CT_BRICK_COUNT ? 1 : -1];

const ct_brick_facts *ct_brick_facts_of(ct_brick_kind kind)
{
  return (int)kind >= 0 && kind < CT_BRICK_COUNT ? &KINDS[kind] : NULL;
}

static const signed char NODE[20][3] = {
    {-1, -1, -1}, {1, -1, -1}, {1, 1, -1},  {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1},
    {-1, 1, 1},   {0, -1, -1}, {1, 0, -1},  {0, 1, -1},  {-1, 0, -1}, {0, -1, 1}, {1, 0, 1},
    {0, 1, 1},    {-1, 0, 1},  {-1, -1, 0}, {1, -1, 0},  {1, 1, 0},   {-1, 1, 0}};

int ct_brick_node_count(ct_brick_kind kind)
{
  const ct_brick_facts *facts = ct_brick_facts_of(kind);
  return facts == NULL ? 0 : facts->node_count;
}

ct_face_kind ct_brick_face_kind(ct_brick_kind kind) { return KINDS[kind].face_kind; }

void ct_brick_reference(ct_brick_kind kind, int node, double xi[3])
{
  int known = node >= 0 && node < ct_brick_node_count(kind);
  for (int a = 0; a < 3; a++) xi[a] = known ? (double)NODE[node][a] : NAN;
}

/* The factors of node i: 1 + xi_a x_a along the axes where the node has a sign, (1 - x_a)(1 + x_a)
 * along the axis of a mid-edge. */
static void factors(int i, const double xi[3], double f[3], double df[3])
{
  for (int a = 0; a < 3; a++) {
    double sign = NODE[i][a], x = xi[a];
    f[a] = sign != 0 ? 1 + sign * x : (1 - x) * (1 + x);
    df[a] = sign != 0 ? sign : -2 * x;
  }
}

void ct_brick_shape(ct_brick_kind kind, const double xi[3], double N[20])
{
  if (xi == NULL || N == NULL) return;
  int count = ct_brick_node_count(kind);
  for (int i = 0; i < 20; i++) N[i] = count == 0 ? NAN : 0;
  for (int i = 0; i < count; i++) {
    double f[3], df[3];
    factors(i, xi, f, df);
    double product = (f[0] * f[1]) * f[2];
    // -- Corner of the trilinear brick, mid-edge of the other (eq:brick-hex8, eq:brick-hex20)
    N[i] = (i < 8 ? 0.125 : 0.25) * product;
    // -- Corner of the serendipity brick (eq:brick-hex20)
    if (kind == CT_HEX20 && i < 8)
      N[i] *= ((NODE[i][0] * xi[0] + NODE[i][1] * xi[1]) + NODE[i][2] * xi[2]) - 2;
  }
}

void ct_brick_gradient(ct_brick_kind kind, const double xi[3], double dN[20][3])
{
  if (xi == NULL || dN == NULL) return;
  int count = ct_brick_node_count(kind);
  for (int i = 0; i < 20; i++)
    for (int a = 0; a < 3; a++) dN[i][a] = count == 0 ? NAN : 0;
  for (int i = 0; i < count; i++) {
    double f[3], df[3];
    factors(i, xi, f, df);
    double others[3] = {f[1] * f[2], f[0] * f[2], f[0] * f[1]};
    double sum = (NODE[i][0] * xi[0] + NODE[i][1] * xi[1]) + NODE[i][2] * xi[2];
    for (int a = 0; a < 3; a++) {
      dN[i][a] = (i < 8 ? 0.125 : 0.25) * (df[a] * others[a]);
      if (kind == CT_HEX20 && i < 8) dN[i][a] *= (sum - 2) + f[a];
    }
  }
}

void ct_brick_face(ct_brick_kind kind, int side, int nodes[8])
{
  // -- Corners and mid-sides of each side, x_min first; corner 0 to 1 is the first axis, corner 0
  // to 3 the second one (eq:brick-sides)
  static const signed char SIDE[6][8] = {
      {3, 0, 4, 7, 11, 16, 15, 19}, {1, 2, 6, 5, 9, 18, 13, 17}, {0, 1, 5, 4, 8, 17, 12, 16},
      {2, 3, 7, 6, 10, 19, 14, 18}, {1, 0, 3, 2, 8, 11, 10, 9},  {4, 5, 6, 7, 12, 13, 14, 15}};
  int count = ct_face_node_count(ct_brick_face_kind(kind));
  for (int i = 0; i < 8; i++) nodes[i] = i < count ? SIDE[side][i] : -1;
}
