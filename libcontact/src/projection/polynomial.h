#ifndef CT_SRC_POLYNOMIAL_H
#define CT_SRC_POLYNOMIAL_H

#include "projection_internal.h"

#include "width.h"

/* The polynomial of a face and its derivatives, for as many pairs of face and point as there are
 * lanes, to be inlined into the functions that use them often. */
#if WIDTH == 1
typedef ct_patch patches;
typedef ct_iterate iterates;
#else
typedef struct patches {
  ct_face_kind kind;
  real c[8][3], size;
} patches;
typedef struct iterates {
  real xi[2], f, d[3], g[2], H[3], square[3];
} iterates;
#endif

/* Four times the coefficients of a patch of four nodes v relative to the point p. */
PART void corner_sums(const real v[8][3], const real p[3], real c[4][3])
{
  for (int k = 0; k < 3; k++) {
    // -- Corners (eq:projection-patch-q4)
    c[0][k] = ((v[0][k] - p[k]) + (v[1][k] - p[k])) + ((v[2][k] - p[k]) + (v[3][k] - p[k]));
    c[1][k] = (v[1][k] - v[0][k]) + (v[2][k] - v[3][k]);
    c[2][k] = (v[3][k] - v[0][k]) + (v[2][k] - v[1][k]);
    c[3][k] = (v[0][k] - v[1][k]) + (v[2][k] - v[3][k]);
  }
}

/* Coefficients of the patch from its nodes v and the point p. Only c[0] depends on the point; the
 * others are sums of differences between nodes, so that a far origin or a far point costs no
 * digits. Each is a tree that flips map onto itself up to its sign. */
PART void quadrilateral(const real v[8][3], const real p[3], real c[8][3])
{
  corner_sums(v, p, c);
  for (int k = 0; k < 3; k++) {
    for (int j = 0; j < 4; j++) c[j][k] *= 0.25;
    c[4][k] = c[5][k] = c[6][k] = c[7][k] = every(0);
  }
}

/* Changes of the coefficients by the mid-sides, after the corners. */
PART void mid_sides(const real v[8][3], const real p[3], real c[8][3])
{
  for (int k = 0; k < 3; k++) {
    // -- Mid-sides (eq:projection-patch-q8)
    real right = c[1][k], up = c[2][k];
    c[0][k] =
        0.5 * (((v[4][k] - p[k]) + (v[6][k] - p[k])) + ((v[5][k] - p[k]) + (v[7][k] - p[k]))) -
        c[0][k];
    c[1][k] = 0.5 * (v[5][k] - v[7][k]);
    c[2][k] = 0.5 * (v[6][k] - v[4][k]);
    c[4][k] = 0.25 * (((v[0][k] - v[4][k]) + (v[1][k] - v[4][k])) +
                      ((v[2][k] - v[6][k]) + (v[3][k] - v[6][k])));
    c[5][k] = 0.25 * (((v[0][k] - v[7][k]) + (v[3][k] - v[7][k])) +
                      ((v[1][k] - v[5][k]) + (v[2][k] - v[5][k])));
    c[6][k] = up - c[2][k];
    c[7][k] = right - c[1][k];
  }
}

PART void triangle(const real v[8][3], const real p[3], int quadratic, real c[8][3])
{
  for (int k = 0; k < 3; k++) {
    c[0][k] = v[0][k] - p[k], c[1][k] = v[1][k] - v[0][k], c[2][k] = v[2][k] - v[0][k];
    c[3][k] = c[4][k] = c[5][k] = c[6][k] = c[7][k] = every(0);
    if (!quadratic) continue;
    // -- Mid-sides of the triangle (eq:projection-patch-t6)
    c[3][k] = 2 * (((v[0][k] - v[3][k]) + (v[0][k] - v[5][k])) +
                   ((v[4][k] - v[3][k]) + (v[4][k] - v[5][k])));
    c[4][k] = 2 * ((v[0][k] - v[3][k]) + (v[1][k] - v[3][k]));
    c[5][k] = 2 * ((v[0][k] - v[5][k]) + (v[2][k] - v[5][k]));
    c[1][k] -= c[4][k];
    c[2][k] -= c[5][k];
  }
}

/* Find the sizes of polynomials. Returns the valid lanes: products of four lengths must stay within
 * double precision; and a sum is finite only if all terms are. */
PART mask measure_patch(patches *patch)
{
  real largest[3], far[3], sum[3];
  for (int k = 0; k < 3; k++) {
    far[k] = absolute(patch->c[0][k]), largest[k] = absolute(patch->c[1][k]),
    sum[k] = far[k] + largest[k];
    for (int j = 2; j < (patch->kind == CT_Q4 ? 4 : 8); j++) {
      real c = absolute(patch->c[j][k]);
      largest[k] = most(largest[k], c);
      sum[k] += c;
    }
  }
  real all = (sum[0] + sum[1]) + sum[2], farthest = most(most(far[0], far[1]), far[2]);
  patch->size = most(most(largest[0], largest[1]), largest[2]);
  return (all < 1e72) & (patch->size > 1e-70) & (patch->size < 1e70) & (farthest < 1e70);
}

/* The polynomials of the faces relative to their points, with their sizes; returns the valid lanes.
 */
PART mask patch_from(const real v[8][3], const real p[3], patches *patch)
{
  // -- Subtract the point first
  if (ct_is_triangular(patch->kind)) triangle(v, p, patch->kind == CT_T6, patch->c);
  else quadrilateral(v, p, patch->c);
  if (patch->kind == CT_Q8) mid_sides(v, p, patch->c);
  return measure_patch(patch);
}

/* d at xi; returns f = d.d. */
PART real value(const patches *patch, const real xi[2], real d[3])
{
  const real(*c)[3] = patch->c;
  real x = xi[0], y = xi[1], xx = x * x, yy = y * y, xy = x * y;
  for (int k = 0; k < 3; k++) {
    // -- Point of the patch (eq:projection-patch)
    d[k] = (c[0][k] + c[3][k] * xy) + (c[1][k] * x + c[2][k] * y);
    if (patch->kind == CT_Q4) continue; // the other terms are 0
    real a = c[4][k] + c[6][k] * y, b = c[5][k] + c[7][k] * x;
    d[k] += a * xx + b * yy;
  }
  // -- Square of the distance (eq:projection-f)
  return dot(d, d);
}

PART void tangents(const patches *patch, const real xi[2], real t1[3], real t2[3])
{
  const real(*c)[3] = patch->c;
  real x = xi[0], y = xi[1], xx = x * x, yy = y * y, two_x = 2 * x, two_y = 2 * y;
  for (int k = 0; k < 3; k++) {
    // -- Tangents of the patch (eq:projection-patch-derivatives)
    t1[k] = c[1][k] + c[3][k] * y;
    t2[k] = c[2][k] + c[3][k] * x;
    if (patch->kind == CT_Q4) continue;
    real a = c[4][k] + c[6][k] * y, b = c[5][k] + c[7][k] * x;
    t1[k] += a * two_x + c[7][k] * yy;
    t2[k] += b * two_y + c[6][k] * xx;
  }
}

/* Second derivatives t11, t22, t12. */
PART void curves(const patches *patch, const real xi[2], real t11[3], real t22[3], real t12[3])
{
  const real(*c)[3] = patch->c;
  for (int k = 0; k < 3; k++) {
    // -- Second derivatives of the patch (eq:projection-patch-derivatives)
    t11[k] = 2 * (c[4][k] + c[6][k] * xi[1]);
    t22[k] = 2 * (c[5][k] + c[7][k] * xi[0]);
    t12[k] = c[3][k] + 2 * (c[6][k] * xi[0] + c[7][k] * xi[1]);
  }
}

/* f and its derivatives at at->xi. */
PART void evaluate(const patches *patch, iterates *at)
{
  real *d = at->d, t1[3], t2[3], t11[3], t22[3], t12[3];
  at->f = value(patch, at->xi, d);
  tangents(patch, at->xi, t1, t2);
  // -- Gradient, zero at a minimum (eq:projection-gradient, eq:projection-stationary)
  at->g[0] = 2 * dot(d, t1);
  at->g[1] = 2 * dot(d, t2);
  // -- Hessian (eq:projection-hessian)
  at->square[0] = dot(t1, t1);
  at->square[1] = dot(t2, t2);
  at->square[2] = dot(t1, t2);
  if (patch->kind == CT_Q4) { // whose only second derivative is t12
    at->H[0] = 2 * at->square[0];
    at->H[1] = 2 * at->square[1];
    at->H[2] = 2 * (at->square[2] + dot(d, patch->c[3]));
    return;
  }
  curves(patch, at->xi, t11, t22, t12);
  at->H[0] = 2 * (at->square[0] + dot(d, t11));
  at->H[1] = 2 * (at->square[1] + dot(d, t22));
  at->H[2] = 2 * (at->square[2] + dot(d, t12));
}

/* Bound on the change of a value f by rounding: d has the rounding error of the largest length in
 * it. */
PART real noise(const patches *patch, real f)
{
  // -- Rounding of f (eq:robust-noise)
  return 8 * DBL_EPSILON * (f + patch->size * root(f));
}

/* Unit normal along y,1 x y,2 exactly at xi; returns the lanes in which the tangents neither vanish
 * nor are parallel to rounding. */
PART mask normal_at(const patches *patch, const real xi[2], real n[3])
{
  real t1[3], t2[3];
  tangents(patch, xi, t1, t2);
  // -- Unit normal (eq:segment-normal)
  for (int k = 0; k < 3; k++)
    n[k] = t1[(k + 1) % 3] * t2[(k + 2) % 3] - t1[(k + 2) % 3] * t2[(k + 1) % 3];
  real square = dot(n, n), length = root(square);
  for (int k = 0; k < 3; k++) n[k] /= length;
  return square > 1e-28 * (dot(t1, t1) * dot(t2, t2));
}

/* The same, at a collapsed corner that of the points just inside. Returns the lanes with a normal.
 */
PART mask normal(const patches *patch, const real xi[2], real n[3])
{
  real inside[2], other[3];
  mask found = normal_at(patch, xi, n);
  if (!any(not(found))) return found;
  // -- At a collapsed corner, take the normal just inside of it
  for (int a = 0; a < 2; a++) inside[a] = xi[a] + (ct_patch_centre(patch->kind) - xi[a]) / 1048576;
  mask near = normal_at(patch, inside, other);
  for (int k = 0; k < 3; k++) n[k] = pick(found, n[k], pick(near, other[k], every(NAN)));
  return found | near;
}

#endif
