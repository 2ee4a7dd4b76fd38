#include "polynomial.h"

#include "../base/lanes.h"
#include "../base/vector.h"

#include <float.h>
#include <math.h>

/* As fmax, for numbers, without a call. */
static inline double most(double a, double b) { return b > a ? b : a; }

/* Coefficients of the patch from its nodes v and the point p, coordinate by coordinate. Only c[0]
 * knows the point; the others are made of differences between nodes, so that neither a far origin
 * nor a far point costs them digits. Each is a tree that flips map onto itself up to its sign. */
static inline void quadrilateral(const double v[8][4], const double p[4], double c[8][4])
{
  for (int k = 0; k < 4; k++) {
    // -- Corners (eq:projection-patch-q4)
    double all = ((v[0][k] - p[k]) + (v[1][k] - p[k])) + ((v[2][k] - p[k]) + (v[3][k] - p[k]));
    double right = (v[1][k] - v[0][k]) + (v[2][k] - v[3][k]),
           up = (v[3][k] - v[0][k]) + (v[2][k] - v[1][k]);
    double twist = (v[0][k] - v[1][k]) + (v[2][k] - v[3][k]);
    c[0][k] = 0.25 * all, c[1][k] = 0.25 * right, c[2][k] = 0.25 * up, c[3][k] = 0.25 * twist;
    c[4][k] = c[5][k] = c[6][k] = c[7][k] = 0;
  }
}

/* What the mid-sides change, after the corners. */
static inline void mid_sides(const double v[8][4], const double p[4], double c[8][4])
{
  for (int k = 0; k < 4; k++) {
    // -- Mid-sides (eq:projection-patch-q8)
    double right = c[1][k], up = c[2][k];
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

static inline void triangle(const double v[8][4], const double p[4], int quadratic, double c[8][4])
{
  for (int k = 0; k < 4; k++) {
    c[0][k] = v[0][k] - p[k], c[1][k] = v[1][k] - v[0][k], c[2][k] = v[2][k] - v[0][k];
    c[3][k] = c[4][k] = c[5][k] = c[6][k] = c[7][k] = 0;
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

/* The size of the patch. Products of four lengths must stay within double precision; and a sum is
 * finite only if all is. */
static inline ct_status measure(ct_patch *patch)
{
  double size[4], far[4], sum[4];
  for (int k = 0; k < 4; k++) {
    far[k] = fabs(patch->c[0][k]), size[k] = fabs(patch->c[1][k]), sum[k] = far[k] + size[k];
    for (int j = 2; j < 8; j++) {
      double c = fabs(patch->c[j][k]);
      size[k] = most(size[k], c);
      sum[k] += c;
    }
  }
  double all = (sum[0] + sum[1]) + sum[2], farthest = most(most(far[0], far[1]), far[2]);
  patch->size = most(most(size[0], size[1]), size[2]);
  return all < 1e72 && patch->size > 1e-70 && patch->size < 1e70 && farthest < 1e70 ? CT_OK
                                                                                    : CT_INVALID;
}

CT_CLONES
ct_status ct_patch_init(ct_patch *patch, ct_face_kind kind, const double node[8][3],
                        const double point[3])
{
  double v[8][4], p[4] = {point[0], point[1], point[2], 0};
  int count = ct_face_node_count(kind);
  if (count == 0) return CT_INVALID;
  for (int i = 0; i < count; i++)
    v[i][0] = node[i][0], v[i][1] = node[i][1], v[i][2] = node[i][2], v[i][3] = 0;
  patch->kind = kind;
  // -- Subtract the point first (eq:projection-shift)
  if (kind == CT_Q4 || kind == CT_Q8) quadrilateral((const double (*)[4])v, p, patch->c);
  else triangle((const double (*)[4])v, p, kind == CT_T6, patch->c);
  if (kind == CT_Q8) mid_sides((const double (*)[4])v, p, patch->c);
  return measure(patch);
}

double ct_patch_value(const ct_patch *patch, const double xi[2], double d[3])
{
  double e[4], f = ct_polynomial_value(patch, xi, e);
  for (int k = 0; k < 3; k++) d[k] = e[k];
  return f;
}

void ct_patch_tangents(const ct_patch *patch, const double xi[2], double t1[4], double t2[4])
{
  ct_polynomial_tangents(patch, xi, t1, t2);
}

void ct_patch_curves(const ct_patch *patch, const double xi[2], double t11[4], double t22[4],
                     double t12[4])
{
  const double (*c)[4] = patch->c;
  for (int k = 0; k < 4; k++) {
    // -- Second derivatives of the patch (eq:projection-patch-derivatives)
    t11[k] = 2 * (c[4][k] + c[6][k] * xi[1]);
    t22[k] = 2 * (c[5][k] + c[7][k] * xi[0]);
    t12[k] = c[3][k] + 2 * (c[6][k] * xi[0] + c[7][k] * xi[1]);
  }
}

double ct_patch_noise(const ct_patch *patch, double f)
{
  // -- Rounding of f (eq:robust-noise)
  return 8 * DBL_EPSILON * (f + patch->size * sqrt(f));
}

double ct_patch_derivatives(const ct_patch *patch, const double xi[2], double d[3], double g[2],
                            double H[3])
{
  ct_iterate at = {{xi[0], xi[1]}, 0, {0, 0, 0}, {0, 0}, {0, 0, 0}, {0, 0}};
  ct_polynomial_look(patch, &at);
  for (int k = 0; k < 3; k++) d[k] = at.d[k], H[k] = at.H[k];
  g[0] = at.g[0], g[1] = at.g[1];
  return at.f;
}

/* Unit normal exactly at xi; answers 0 where the tangents vanish or are parallel to rounding. */
static inline int normal_at(const ct_patch *patch, const double xi[2], double n[3])
{
  double t1[4], t2[4];
  ct_polynomial_tangents(patch, xi, t1, t2);
  // -- Unit normal (eq:segment-normal)
  ct_vector_cross(t1, t2, n);
  double square = ct_vector_dot(n, n), length = sqrt(square);
  if (!(square > 1e-28 * (ct_vector_dot(t1, t1) * ct_vector_dot(t2, t2)))) return 0;
  for (int k = 0; k < 3; k++) n[k] /= length;
  return 1;
}

int ct_patch_normal(const ct_patch *patch, const double xi[2], double n[3])
{
  if (normal_at(patch, xi, n)) return 1;
  // -- At a collapsed corner, take the normal just inside of it
  double centre = ct_patch_centre(patch->kind), inside[2];
  for (int a = 0; a < 2; a++) inside[a] = xi[a] + (centre - xi[a]) / 1048576;
  if (normal_at(patch, inside, n)) return 1;
  for (int k = 0; k < 3; k++) n[k] = NAN;
  return 0;
}

ct_where ct_patch_where(ct_face_kind kind, const double xi[2], double slack, int *index)
{
  *index = -1;
  int triangular = kind == CT_T3 || kind == CT_T6, touched[4] = {0}, edges = triangular ? 3 : 4;
  if (!triangular && fabs(xi[0]) < 1 - slack && fabs(xi[1]) < 1 - slack) return CT_INTERIOR;
  // -- Distance to each edge, positive inside
  double inside[4] = {xi[1], 1 - (xi[0] + xi[1]), xi[0], 1};
  if (!triangular)
    inside[0] = 1 + xi[1], inside[1] = 1 - xi[0], inside[2] = 1 - xi[1], inside[3] = 1 + xi[0];
  for (int i = 0; i < edges; i++) {
    if (!(inside[i] >= -slack)) return CT_OUTSIDE;
    touched[i] = inside[i] <= slack;
    if (touched[i]) *index = i;
  }
  if (*index < 0) return CT_INTERIOR;
  // -- Corner i lies between edges i - 1 and i
  for (int i = 0; i < edges; i++)
    if (touched[i] && touched[(i + edges - 1) % edges]) {
      *index = i;
      return CT_VERTEX;
    }
  return CT_EDGE;
}
