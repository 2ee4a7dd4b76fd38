/* The largest eigenvalue of one element: an upper bound of ω² of the whole mesh. */
#include <contact/quadrature.h>
#include <contact/solid.h>

#include "../error.h"
#include "element.h"

#include <math.h>
#include <string.h>

enum { SIZE = 60 };

/* Add the stiffness of one Gauss point, (∂σ/∂u) : ∂N/∂x dV, for the nodes a and b (eq:stiffness). */
static void add_stiffness(double A[SIZE][SIZE], int a, int b, const double p[3], const double q[3], double lambda, double mu)
{
  double dot = (p[0] * q[0] + p[1] * q[1]) + p[2] * q[2];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) A[3 * a + i][3 * b + j] += lambda * p[i] * q[j] + mu * p[j] * q[i] + (i == j ? mu * dot : 0.0);
}

/* Stiffness scaled by the masses, A = M^-1/2 K M^-1/2. */
static ct_status scaled_stiffness(ct_brick_kind kind, const double *nodes, const ct_material *material, const double *mass,
                                  double A[SIZE][SIZE], ct_error *error)
{
  int per = ct_brick_node_count(kind);
  double x[20][3], lambda, mu;
  ct_rule rule;
  ct_rule_brick(kind, &rule);
  ct_material_lame(material, &lambda, &mu);
  memcpy(x, nodes, (size_t)per * sizeof x[0]);
  memset(A, 0, sizeof(double) * SIZE * SIZE);
  for (int a = 0; a < per; a++)
    if (!(mass[a] > 0.0))
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, a}, "node %d of the element has mass %g", a, mass[a]);
  for (int q = 0; q < rule.count; q++) {
    double dNdx[20][3], det = ct_element_gradients(kind, x, rule.xi[q], dNdx);
    if (det == 0.0)
      return ct_fail(error, CT_ERROR_GEOMETRY, (ct_place){-1, -1, q}, "the element is inverted or collapsed at Gauss point %d", q);
    double dV = rule.weight[q] * det;
    for (int a = 0; a < per; a++)
      for (int b = 0; b <= a; b++) add_stiffness(A, a, b, dNdx[a], dNdx[b], lambda * dV, mu * dV);
  }
  for (int i = 0; i < 3 * per; i++)
    for (int j = 0; j <= i; j++) A[j][i] = A[i][j] = A[i][j] / (sqrt(mass[i / 3]) * sqrt(mass[j / 3]));
  return CT_OK;
}

/* Householder's reflections turn the symmetric A into the tridiagonal matrix of `diagonal` and `side` with the same eigenvalues. */
static void tridiagonal(int n, double A[SIZE][SIZE], double diagonal[SIZE], double side[SIZE])
{
  for (int k = 0; k < n - 2; k++) {
    // -- Reflect column k onto its first entry below the diagonal (eq:householder)
    double v[SIZE] = {0.0}, p[SIZE], norm = 0.0, vv = 0.0, pv = 0.0;
    for (int i = k + 1; i < n; i++) norm += A[i][k] * A[i][k];
    norm = sqrt(norm);
    for (int i = k + 1; i < n; i++) v[i] = A[i][k];
    v[k + 1] += A[k + 1][k] < 0.0 ? -norm : norm;
    for (int i = k + 1; i < n; i++) vv += v[i] * v[i];
    if (vv == 0.0) continue;
    for (int i = k; i < n; i++) {
      p[i] = 0.0;
      for (int j = k + 1; j < n; j++) p[i] += A[i][j] * v[j];
      p[i] *= 2.0 / vv;
      pv += p[i] * v[i];
    }
    for (int i = k; i < n; i++) p[i] -= pv / vv * v[i];
    for (int i = k; i < n; i++)
      for (int j = k; j < n; j++) A[i][j] -= v[i] * p[j] + p[i] * v[j];
  }
  for (int i = 0; i < n; i++) {
    diagonal[i] = A[i][i];
    side[i] = i + 1 < n ? A[i + 1][i] : 0.0;
  }
}

/* Whether all eigenvalues of the tridiagonal matrix lie below x: all pivots of T - x are negative (Sturm, eq:sturm). */
static int all_below(int n, const double *diagonal, const double *side, double x)
{
  double pivot = diagonal[0] - x;
  for (int i = 1; i < n; i++) {
    if (!(pivot < 0.0)) return 0;
    pivot = diagonal[i] - x - side[i - 1] * side[i - 1] / pivot;
  }
  return pivot < 0.0;
}

ct_status ct_solid_element_frequency(ct_brick_kind kind, const double *nodes, const ct_material *material,
                                     const double *mass, double *omega_squared, ct_error *error)
{
  double A[SIZE][SIZE], diagonal[SIZE], side[SIZE];
  if (ct_brick_node_count(kind) == 0 || nodes == NULL || mass == NULL || omega_squared == NULL)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "solid: null argument or unknown element");
  ct_status status = ct_material_check(material, error);
  if (status == CT_OK) status = scaled_stiffness(kind, nodes, material, mass, A, error);
  if (status != CT_OK) return status;
  int n = 3 * ct_brick_node_count(kind);
  tridiagonal(n, A, diagonal, side);

  // -- Halve the interval of Gershgorin's bound; its upper end stays above all eigenvalues (eq:element-bound)
  double low = 0.0, high = 0.0;
  for (int i = 0; i < n; i++) {
    double row = fabs(diagonal[i]) + fabs(side[i]) + (i > 0 ? fabs(side[i - 1]) : 0.0);
    high = row > high ? row : high;
  }
  high *= 1.0 + 1e-9;
  for (int k = 0; k < 60 && high - low > 1e-13 * high; k++) {
    double middle = 0.5 * (low + high);
    if (all_below(n, diagonal, side, middle))
      high = middle;
    else
      low = middle;
  }
  *omega_squared = high * (1.0 + 1e-12);
  return CT_OK;
}
