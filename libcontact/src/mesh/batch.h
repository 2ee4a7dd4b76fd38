#ifndef CT_SRC_MESH_BATCH_H
#define CT_SRC_MESH_BATCH_H

/* Eight elements of a mesh side by side, and their Jacobians in the order of sums of
 * shape/jacobian.h, so that each lane has the bits of its element alone. */

#include "../base/lanes.h"

#include <libcontact/mesh.h>

#include <math.h>
#include <string.h>

/* Node numbers of the 8 elements of batch `b`, shape (8, per); the last batch repeats its last
 * element, in the memory `buffer`. */
CT_INLINE const int32_t *ct_batch_nodes(const ct_mesh *mesh, int32_t b, int per,
                                        int32_t buffer[8 * 20])
{
  int32_t left = mesh->element_count - 8 * b;
  const int32_t *nodes = &mesh->elements[8 * (int64_t)per * b];
  for (int32_t i = 0; left < 8 && i < 8 * per; i++)
    buffer[i] = nodes[i < per * left ? i : per * (left - 1) + i % per];
  return left < 8 ? buffer : nodes;
}

/* x, y, z of the nodes n[0], n[per], ... of 8 elements. */
CT_INLINE void ct_load_nodes(const double *array, const int32_t *n, int per, ct_lanes *v, int step)
{
#if CT_LANES_WIDE
  const double *p[8];
  for (int l = 0; l < 8; l++) p[l] = array + 3 * (int64_t)n[per * l];
  for (int c = 0; c < 3; c++)
    v[step * c] =
        (ct_lanes){p[0][c], p[1][c], p[2][c], p[3][c], p[4][c], p[5][c], p[6][c], p[7][c]};
#else
  for (int c = 0; c < 3; c++) v[step * c] = array[3 * (int64_t)n[0] + c];
#endif
}

/* Read the `per` nodes (8 or 20) of the elements of a batch from an array (nodes, 3) into lanes
 * v[component][node]. `rows` says for each batch whether node a of its element l is node a of its
 * first one, plus l; or it is null. */
CT_INLINE void ct_load_lanes(const ct_mesh *mesh, const uint8_t *rows, int32_t b, int per,
                             const double *array, int lane, ct_lanes *v)
{
  int32_t buffer[8 * 20];
  const int32_t *nodes = &mesh->elements[8 * (int64_t)per * b];
  if (CT_ROWS && rows != NULL && rows[b]) {
    for (int a = 0; a < per; a++) ct_load_row(array + 3 * (int64_t)nodes[a], &v[a], per);
    return;
  }
  nodes = ct_batch_nodes(mesh, b, per, buffer);
  for (int a = 0; a < per; a++) ct_load_nodes(array, &nodes[per * lane + a], per, &v[a], per);
}

/* Sums over the corners, and over the 8 or 20 nodes, as in ct_tree_corners and ct_tree_nodes. */
CT_INLINE void ct_lanes_corners(const ct_lanes *t, ct_lanes *sum)
{
  *sum = ((t[0] + t[1]) + (t[3] + t[2])) + ((t[4] + t[5]) + (t[7] + t[6]));
}

CT_INLINE void ct_lanes_nodes(int per, const ct_lanes *t, ct_lanes *sum)
{
  ct_lanes_corners(t, sum);
  if (per == 8) return;
  ct_lanes along_xi = (t[8] + t[10]) + (t[12] + t[14]);
  ct_lanes along_eta = (t[11] + t[9]) + (t[15] + t[13]);
  ct_lanes along_zeta = (t[16] + t[17]) + (t[19] + t[18]);
  *sum = ((*sum + along_xi) + along_eta) + along_zeta;
}

/* Whether all elements of a batch of hex8 are boxes along x, y, z that are not inverted, and their
 * volumes. Returns 0 if the square of a volume is not a normal number. */
CT_INLINE int ct_upright_boxes(const ct_lanes *x, double volume[CT_LANES_COUNT])
{
  double v[24][CT_LANES_COUNT], off[CT_LANES_COUNT] = {0.0};
  int boxes = 1;
  memcpy(v, x, sizeof v);
  for (int a = 0; a < 8; a++) {
    int at[3] = {a % 4 == 1 || a % 4 == 2, a % 4 >= 2, a >= 4};
    for (int d = 0; d < 3; d++)
      for (int l = 0; l < CT_LANES_COUNT; l++)
        off[l] += fabs(v[8 * d + a][l] - v[8 * d + (at[d] ? 6 : 0)][l]);
  }
  for (int l = 0; l < CT_LANES_COUNT; l++) {
    double edge[3];
    for (int d = 0; d < 3; d++) edge[d] = v[8 * d + 6][l] - v[8 * d][l];
    volume[l] = edge[0] * edge[1] * edge[2];
    boxes = boxes && off[l] == 0.0 && edge[0] > 0.0 && edge[1] > 0.0 && edge[2] > 0.0 &&
            isnormal(volume[l] * volume[l]);
  }
  return boxes;
}

/* Subtract the mean of the corners from the coordinates x[component][node]: the first half of
 * ct_reference_gradient, which is the same at all points. */
CT_INLINE void ct_lanes_centre(int per, ct_lanes *x)
{
  for (int i = 0; i < 3; i++) {
    ct_lanes middle;
    ct_lanes_corners(&x[per * i], &middle);
    for (int a = 0; a < per; a++) x[per * i + a] = x[per * i + a] - 0.125 * middle;
  }
}

/* The second half, from centred coordinates (eq:jacobian), with the determinant of J. */
CT_INLINE void ct_lanes_jacobian(int per, const double (*dN)[3], const ct_lanes *x,
                                 ct_lanes J[3][3], ct_lanes *det)
{
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      ct_lanes t[20];
      for (int a = 0; a < per; a++) t[a] = dN[a][j] * x[per * i + a];
      ct_lanes_nodes(per, t, &J[i][j]);
    }
  ct_lanes C[3];
  for (int j = 0; j < 3; j++) {
    int r = (j + 1) % 3, s = (j + 2) % 3;
    C[j] = J[1][r] * J[2][s] - J[1][s] * J[2][r];
  }
  *det = (J[0][0] * C[0] + J[0][1] * C[1]) + J[0][2] * C[2];
}

#endif
