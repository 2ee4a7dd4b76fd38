#ifndef CT_SRC_TREE_H
#define CT_SRC_TREE_H

/* Sums whose order pairs along ξ, then η, then ζ. A mirrored element only swaps the partners of pairs, and a + b = b + a
 * to the last bit, so a mirrored scene gives mirrored bits (eq:tree-sum). */

/* Over the corners of a brick in VTK's order. */
static inline double ct_tree_corners(const double t[8])
{
  return ((t[0] + t[1]) + (t[3] + t[2])) + ((t[4] + t[5]) + (t[7] + t[6]));
}

/* Over the 8 or 20 nodes of a brick: corners, then the four edges along ξ, along η, along ζ. */
static inline double ct_tree_nodes(int count, const double t[20])
{
  double corners = ct_tree_corners(t);
  if (count == 8) return corners;
  double along_xi = (t[8] + t[10]) + (t[12] + t[14]);
  double along_eta = (t[11] + t[9]) + (t[15] + t[13]);
  double along_zeta = (t[16] + t[17]) + (t[19] + t[18]);
  return ((corners + along_xi) + along_eta) + along_zeta;
}

/* Over a line of 2 or 3 values: ends first, then the middle. */
static inline double ct_tree_line(int n, const double *t, int stride)
{
  return n == 2 ? t[0] + t[stride] : (t[0] + t[2 * stride]) + t[stride];
}

/* Over the n x n x n Gauss points of a brick (n = 2 or 3), ξ fastest. */
static inline double ct_tree_points(int n, const double t[27])
{
  double plane[3], line[3];
  for (int k = 0; k < n; k++) {
    for (int j = 0; j < n; j++) line[j] = ct_tree_line(n, &t[n * (j + n * k)], 1);
    plane[k] = ct_tree_line(n, line, 1);
  }
  return ct_tree_line(n, plane, 1);
}

#endif
