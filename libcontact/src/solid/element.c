/* One element at a time, in the form of the equations. The batch kernels beside this file compute
 * the same numbers faster. */
#include <libcontact/shape.h>
#include <libcontact/solid.h>

#include "../base/error.h"
#include "../shape/jacobian.h"
#include "../mesh/mesh_internal.h"
#include "element.h"
#include "large.h"

#include <math.h>
#include <string.h>

double ct_element_gradients(ct_brick_kind kind, double x[20][3], const double xi[3],
                            double dNdx[20][3])
{
  int per = ct_brick_node_count(kind);
  double dN[20][3], J[3][3], C[3][3];
  // -- Map the derivatives of the shape functions to the body
  ct_brick_gradient(kind, xi, dN);
  ct_reference_gradient(per, dN, x, J);
  double det = ct_cofactors(J, C);
  if (!(det > 0.0)) return 0.0;
  for (int a = 0; a < per; a++)
    for (int j = 0; j < 3; j++)
      // Σ_k ∂N_a/∂ξ_k (J⁻¹)_kj (eq:jacobian-gradient)
      dNdx[a][j] = ((dN[a][0] * C[j][0] + dN[a][1] * C[j][1]) + dN[a][2] * C[j][2]) / det;
  return det;
}

/* Hooke's law for small strains, σ = Λ tr(ε) I + 2 μ ε, as a full 3 x 3 matrix. */
static void hooke(const ct_material *material, double G[3][3], double sigma[3][3])
{
  double lambda, mu;
  ct_material_lame(material, &lambda, &mu);
  double trace = (G[0][0] + G[1][1]) + G[2][2];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      // 2 μ ε_ij + Λ tr(ε) δ_ij (eq:hooke)
      sigma[i][j] = mu * (G[i][j] + G[j][i]) + (i == j ? lambda * trace : 0.0);
}

/* The stress conjugate to ∂N/∂X: Hooke's, or for large deformation the first Piola-Kirchhoff stress
 * F S. Returns J = det F, 1 for small strain. */
static double working_stress(const ct_material *material, double G[3][3], double P[3][3])
{
  if (material->law == CT_LINEAR) {
    hooke(material, G, P);
    return 1.0;
  }
  double S[3][3], J = ct_large_stress(material, G, S);
  // -- P = F S with F = 1 + G
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      // (eq:piola)
      P[i][j] = S[i][j] + ((G[i][0] * S[0][j] + G[i][1] * S[1][j]) + G[i][2] * S[2][j]);
  return J;
}

/* Stored energy per unit volume, from the gradient and its stress. */
static double energy_density(const ct_material *material, double G[3][3], double P[3][3])
{
  double W = 0.0;
  if (material->law != CT_LINEAR) return ct_large_energy(material, G);
  // ½ σ_ij ∂u_i/∂x_j = ½ σ_ij ε_ij, since σ is symmetric (eq:solid-energy)
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) W += 0.5 * P[i][j] * G[i][j];
  return W;
}

static ct_status check_inside_out(double J, int64_t point, ct_error *error)
{
  if (J > 0.0) return CT_OK;
  if (isnan(J))
    return ct_fail(error, CT_INVALID, (ct_place){-1, -1, point},
                   "the displacement of the element is not finite");
  return ct_fail(error, CT_ERROR_GEOMETRY, (ct_place){-1, -1, point},
                 "the deformation inverts the element: J = det F = %.3g", J);
}

static ct_status element_arguments(ct_brick_kind kind, const double *nodes,
                                   const double *displacement, const ct_material *material,
                                   double x[20][3], double u[20][3], ct_error *error)
{
  size_t per = (size_t)ct_brick_node_count(kind);
  if (nodes == NULL || displacement == NULL)
    return CT_REFUSE(error, "solid: a required argument is null");
  if (per == 0) return CT_REFUSE(error, "solid: there is no brick of the kind %d", (int)kind);
  memcpy(x, nodes, per * sizeof x[0]);
  memcpy(u, displacement, per * sizeof u[0]);
  return ct_material_check(material, error);
}

ct_status ct_solid_element_force(ct_brick_kind kind, const double *nodes,
                                 const double *displacement, const ct_material *material,
                                 double *force, double *energy, ct_error *error)
{
  double x[20][3], u[20][3];
  ct_status status = element_arguments(kind, nodes, displacement, material, x, u, error);
  if (status != CT_OK) return status;
  int per = ct_brick_node_count(kind);
  ct_rule rule;
  ct_rule_brick(kind, &rule);
  double W = 0.0;
  for (int i = 0; i < 3 * per; i++) force[i] = 0.0;

  // -- Sum f = -∫ σ ∂N/∂x dV over the Gauss points
  for (int q = 0; q < rule.count; q++) {
    double dNdx[20][3], G[3][3], P[3][3];
    double det = ct_element_gradients(kind, x, rule.xi[q], dNdx);
    if (det == 0.0)
      return ct_fail(error, CT_ERROR_GEOMETRY, (ct_place){-1, -1, q},
                     "the element is inverted or collapsed at Gauss point %d", q);
    ct_reference_gradient(per, dNdx, u, G);
    status = check_inside_out(working_stress(material, G, P), q, error);
    if (status != CT_OK) return status;
    double dV = rule.weight[q] * det;
    for (int a = 0; a < per; a++)
      for (int i = 0; i < 3; i++)
        // -σ_ij ∂N_a/∂x_j w det J (eq:internal-force, eq:large-force)
        for (int j = 0; j < 3; j++) force[3 * a + i] -= P[i][j] * dNdx[a][j] * dV;
    if (energy != NULL) W += energy_density(material, G, P) * dV; // (eq:large-energy)
  }
  if (energy != NULL) *energy = W;
  return CT_OK;
}

ct_status ct_element_cauchy(const ct_material *material, double G[3][3], double stress[6],
                            ct_error *error)
{
  double P[3][3], s[3][3], J = working_stress(material, G, P);
  ct_status status = check_inside_out(J, -1, error);
  if (status != CT_OK) return status;
  // -- Force per present area: P Fᵀ / J (eq:cauchy)
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      s[i][j] = material->law == CT_LINEAR
                    ? P[i][j]
                    : (P[i][j] + ((P[i][0] * G[j][0] + P[i][1] * G[j][1]) + P[i][2] * G[j][2])) / J;
  double voigt[6] = {s[0][0], s[1][1], s[2][2], s[0][1], s[1][2], s[2][0]};
  memcpy(stress, voigt, sizeof voigt);
  return CT_OK;
}

ct_status ct_solid_element_stress(ct_brick_kind kind, const double *nodes,
                                  const double *displacement, const ct_material *material,
                                  const double xi[3], double stress[6], ct_error *error)
{
  double x[20][3], u[20][3], dN[20][3], J[3][3], C[3][3], H[3][3], G[3][3];
  ct_status status = element_arguments(kind, nodes, displacement, material, x, u, error);
  if (status != CT_OK) return status;
  ct_brick_gradient(kind, xi, dN);
  ct_reference_gradient(ct_brick_node_count(kind), dN, x, J);
  double det = ct_cofactors(J, C);
  if (!(det > 0.0))
    return ct_fail(error, CT_ERROR_GEOMETRY, CT_NOWHERE, "the element is inverted or collapsed");
  // -- The gradient in the reference directions, then in those of the body (eq:jacobian)
  ct_reference_gradient(ct_brick_node_count(kind), dN, u, H);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      G[i][j] = ((H[i][0] * C[j][0] + H[i][1] * C[j][1]) + H[i][2] * C[j][2]) / det;
  return ct_element_cauchy(material, G, stress, error);
}
