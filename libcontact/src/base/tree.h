#ifndef CT_SRC_TREE_H
#define CT_SRC_TREE_H

/* Sums whose order pairs along ξ, then η, then ζ. A mirrored element only swaps the partners of
 * pairs, and a + b = b + a to the last bit, so a mirrored scene gives mirrored bits (eq:tree-sum).
 */

/* Over the corners of a brick in VTK's order, with the stride `s`. */
static inline double ct_tree_corners(const double *t, int s)
{
  return ((t[0] + t[s]) + (t[3 * s] + t[2 * s])) + ((t[4 * s] + t[5 * s]) + (t[7 * s] + t[6 * s]));
}

/* Over the 8 or 20 nodes of a brick: corners, then the four edges along ξ, along η, along ζ; with
 * the stride `s`. */
static inline double ct_tree_nodes(int count, const double *t, int s)
{
  double corners = ct_tree_corners(t, s);
  if (count == 8) return corners;
  double along_xi = (t[8 * s] + t[10 * s]) + (t[12 * s] + t[14 * s]);
  double along_eta = (t[11 * s] + t[9 * s]) + (t[15 * s] + t[13 * s]);
  double along_zeta = (t[16 * s] + t[17 * s]) + (t[19 * s] + t[18 * s]);
  return ((corners + along_xi) + along_eta) + along_zeta;
}

#endif
