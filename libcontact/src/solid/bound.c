/* The largest eigenvalue of one element, undeformed or at its tangent: an upper bound on ω² of the
 * whole mesh. */
#include <libcontact/shape.h>
#include <libcontact/solid.h>

#include "../base/error.h"
#include "../shape/jacobian.h"
#include "../base/tridiagonal.h"
#include "element.h"
#include "large.h"

#include <math.h>
#include <string.h>

enum { SIZE = CT_ELEMENT_SIZE };

void ct_add_stiffness(double A[SIZE][SIZE], int a, int b, const double p[3], const double q[3],
                      double lambda, double mu)
{
  double dot = (p[0] * q[0] + p[1] * q[1]) + p[2] * q[2];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      // ∂N_a/∂x_i and ∂N_b/∂x_j are p_i and q_j (eq:stiffness)
      A[3 * a + i][3 * b + j] +=
          lambda * p[i] * q[j] + mu * p[j] * q[i] + (i == j ? mu * dot : 0.0);
}

/* Add the tangent stiffness of one Gauss point for all pairs of nodes (eq:large-tangent). */
static void add_tangent(double A[SIZE][SIZE], int per, double g[20][3], const ct_large_stiffness *K,
                        double dV)
{
  double v[20][3], s[20][3];
  for (int a = 0; a < per; a++)
    for (int i = 0; i < 3; i++) {
      v[a][i] = (K->V[i][0] * g[a][0] + K->V[i][1] * g[a][1]) + K->V[i][2] * g[a][2];
      s[a][i] = (K->S[i][0] * g[a][0] + K->S[i][1] * g[a][1]) + K->S[i][2] * g[a][2];
    }
  // -- α v_a v_b + β v_b v_a + (g_a · g_b) M + (g_a · S g_b) 1 (eq:large-tangent)
  for (int a = 0; a < per; a++)
    for (int b = 0; b <= a; b++) {
      double dot = ((g[a][0] * g[b][0] + g[a][1] * g[b][1]) + g[a][2] * g[b][2]) * dV;
      double initial = ((g[a][0] * s[b][0] + g[a][1] * s[b][1]) + g[a][2] * s[b][2]) * dV;
      for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
          A[3 * a + i][3 * b + k] += (K->a * v[a][i] * v[b][k] + K->b * v[b][i] * v[a][k]) * dV +
                                     dot * K->M[i][k] + (i == k ? initial : 0.0);
    }
}

ct_status ct_element_stiffness(ct_brick_kind kind, const double *nodes, const double *displacement,
                               const ct_material *material, double A[SIZE][SIZE], ct_error *error)
{
  int per = ct_brick_node_count(kind);
  double x[20][3], u[20][3], G[3][3], lambda, mu;
  ct_large_stiffness K;
  ct_rule rule;
  ct_rule_brick(kind, &rule);
  ct_material_lame(material, &lambda, &mu);
  memcpy(x, nodes, (size_t)per * sizeof x[0]);
  if (displacement != NULL) memcpy(u, displacement, (size_t)per * sizeof u[0]);
  memset(A, 0, sizeof(double) * SIZE * SIZE);
  for (int q = 0; q < rule.count; q++) {
    double dNdx[20][3], det = ct_element_gradients(kind, x, rule.xi[q], dNdx);
    if (det == 0.0)
      return ct_fail(error, CT_ERROR_GEOMETRY, (ct_place){-1, -1, q},
                     "the element is inverted or collapsed at Gauss point %d", q);
    double dV = rule.weight[q] * det;
    if (displacement != NULL) {
      ct_reference_gradient(per, dNdx, u, G);
      if (!(ct_large_tangent(material, G, &K) > 0.0))
        return ct_fail(error, CT_ERROR_GEOMETRY, (ct_place){-1, -1, q},
                       "the deformation inverts the element at Gauss point %d", q);
      add_tangent(A, per, dNdx, &K, dV);
      continue;
    }
    for (int a = 0; a < per; a++)
      for (int b = 0; b <= a; b++)
        ct_add_stiffness(A, a, b, dNdx[a], dNdx[b], lambda * dV, mu * dV);
  }
  return CT_OK;
}

/* Transform the symmetric A by Householder's reflections into the tridiagonal matrix of `diagonal`
 * and `side` with the same eigenvalues. */
static void tridiagonal(int n, double A[SIZE][SIZE], double diagonal[SIZE], double side[SIZE])
{
  for (int k = 0; k < n - 2; k++) {
    // -- Reflect column k onto its first entry below the diagonal
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
    // p = p' - (p'·v / v·v) v, A - v pᵀ - p vᵀ (eq:householder)
    for (int i = k; i < n; i++) p[i] -= pv / vv * v[i];
    for (int i = k; i < n; i++)
      for (int j = k; j < n; j++) A[i][j] -= v[i] * p[j] + p[i] * v[j];
  }
  for (int i = 0; i < n; i++) {
    diagonal[i] = A[i][i];
    side[i] = i + 1 < n ? A[i + 1][i] : 0.0;
  }
}

void ct_spread_mass(int per, const double *mass, const int fixed[3], double spread[SIZE])
{
  for (int i = 0; i < 3 * per; i++)
    spread[i] = fixed != NULL && fixed[i % 3] ? INFINITY : mass[i / 3];
}

ct_status ct_largest_eigenvalue(int n, const double *mass, double A[SIZE][SIZE],
                                double *omega_squared, ct_error *error)
{
  double diagonal[SIZE], side[SIZE];
  for (int i = 0; i < n; i++)
    if (!(mass[i] > 0.0))
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, i / 3},
                     "node %d of the element has the mass %g, which must be positive", i / 3,
                     mass[i]);
  // -- Scale by the masses, A = M^-1/2 K M^-1/2 (eq:element-scaled)
  for (int i = 0; i < n; i++)
    for (int j = 0; j <= i; j++) A[j][i] = A[i][j] = A[i][j] / (sqrt(mass[i]) * sqrt(mass[j]));
  tridiagonal(n, A, diagonal, side);

  // -- Halve the interval of Gershgorin's bound; its upper end stays above all eigenvalues
  // (eq:element-bound)
  double low = 0.0, high = ct_tridiagonal_reach(n, diagonal, side);
  high *= 1.0 + 1e-9;
  for (int k = 0; k < 60 && high - low > 1e-13 * high; k++) {
    double middle = 0.5 * (low + high);
    if (ct_tridiagonal_all_below(n, diagonal, side, middle)) high = middle;
    else low = middle;
  }
  *omega_squared = high * (1.0 + 1e-12);
  return CT_OK;
}

ct_status ct_solid_element_omega2_bound(ct_brick_kind kind, const double *nodes,
                                        const double *displacement, const ct_material *material,
                                        const double *mass, double *omega_squared, ct_error *error)
{
  double A[SIZE][SIZE], m[SIZE];
  int per = ct_brick_node_count(kind);
  if (nodes == NULL || mass == NULL || omega_squared == NULL) return CT_REFUSE_NULL(error);
  if (per == 0) return CT_REFUSE(error, "solid: there is no brick of the kind %d", (int)kind);
  ct_status status = ct_material_check(material, error);
  if (status != CT_OK) return status;
  if (material->law == CT_LINEAR) displacement = NULL;
  ct_spread_mass(per, mass, NULL, m);
  status = ct_element_stiffness(kind, nodes, displacement, material, A, error);
  return status == CT_OK ? ct_largest_eigenvalue(3 * per, m, A, omega_squared, error) : status;
}
