/* One hex8 element with one point and hourglass control, in the form of the equations. */
#include <libcontact/shape.h>
#include <libcontact/solid.h>

#include "../base/error.h"
#include "../shape/jacobian.h"
#include "../base/tree.h"
#include "element.h"

#include <math.h>
#include <string.h>

/* Data of the element: volume, mean shape gradients B[a][j], hourglass vectors γ[k][a], and the
 * stiffness of their amplitudes. */
typedef struct reduced_element {
  double V, B[20][3], Gamma[4][20], c;
} reduced_element;

ct_status ct_element_mean_gradients(const double *nodes, double B[20][3], double *volume,
                                    double *g2, ct_error *error)
{
  double x[20][3] = {{0.0}}, dNdx[20][3];
  ct_rule rule;
  memcpy(x, nodes, 8 * sizeof x[0]);
  ct_rule_brick(CT_HEX8, &rule);
  memset(B, 0, 20 * sizeof B[0]);
  *volume = *g2 = 0.0;
  // -- Average the gradients of the shape functions over the element
  for (int p = 0; p < rule.count; p++) {
    double dV = rule.weight[p] * ct_element_gradients(CT_HEX8, x, rule.xi[p], dNdx);
    if (!(dV > 0.0))
      return ct_fail(error, CT_ERROR_GEOMETRY, (ct_place){-1, -1, p},
                     "the element is inverted or collapsed at Gauss point %d", p);
    *volume += dV;
    for (int a = 0; a < 8; a++)
      for (int j = 0; j < 3; j++) B[a][j] += dNdx[a][j] * dV; // (eq:mean-gradient)
  }
  for (int a = 0; a < 8; a++)
    for (int j = 0; j < 3; j++) {
      B[a][j] /= *volume;
      *g2 += B[a][j] * B[a][j];
    }
  return CT_OK;
}

static ct_status open_element(const double *nodes, const ct_material *material, double hourglass,
                              reduced_element *r, ct_error *error)
{
  double x[20][3] = {{0.0}}, xi[3], g2 = 0.0, middle[3];
  if (nodes == NULL) return CT_REFUSE(error, "reduced: nodes is null");
  if (!(hourglass > 0.0) || !isfinite(hourglass))
    return CT_REFUSE(error, "reduced: hourglass must be positive and finite, not %g", hourglass);
  ct_status status = ct_material_check(material, error);
  if (status != CT_OK) return status;
  if (material->law != CT_LINEAR)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "reduced integration is for small strain only; take the law \"linear\"");
  *r = (reduced_element){.V = 0.0};
  status = ct_element_mean_gradients(nodes, r->B, &r->V, &g2, error);
  if (status != CT_OK) return status;
  memcpy(x, nodes, 8 * sizeof x[0]);
  for (int j = 0; j < 3; j++) {
    double t[8];
    for (int a = 0; a < 8; a++) t[a] = x[a][j];
    middle[j] = ct_tree_corners(t, 1) / 8.0;
  }

  // -- Make the hourglass vectors orthogonal to linear displacements
  for (int k = 0; k < 4; k++) {
    double m[8], mx[3] = {0.0};
    for (int a = 0; a < 8; a++) {
      ct_brick_reference(CT_HEX8, a, xi);
      m[a] = k == 0   ? xi[0] * xi[1]
             : k == 1 ? xi[1] * xi[2]
             : k == 2 ? xi[2] * xi[0]
                      : xi[0] * xi[1] * xi[2];
      for (int j = 0; j < 3; j++) mx[j] += m[a] * (x[a][j] - middle[j]);
    }
    for (int a = 0; a < 8; a++)
      // (eq:hourglass-vector)
      r->Gamma[k][a] = m[a] - ((mx[0] * r->B[a][0] + mx[1] * r->B[a][1]) + mx[2] * r->B[a][2]);
  }
  // -- The stiffness with which a cube bends as a beam for Q = 1 (eq:hourglass-stiffness)
  r->c = hourglass * material->young * r->V * g2 / 72.0;
  return CT_OK;
}

ct_status ct_solid_reduced_force(const double *nodes, const double *displacement,
                                 const ct_material *material, double hourglass, double *force,
                                 double energy[2], ct_error *error)
{
  reduced_element r;
  double u[20][3], G[3][3], lambda, mu, W = 0.0, H = 0.0;
  if (displacement == NULL || force == NULL) return CT_REFUSE_NULL(error);
  ct_status status = open_element(nodes, material, hourglass, &r, error);
  if (status != CT_OK) return status;
  memcpy(u, displacement, 8 * sizeof u[0]);
  ct_material_lame(material, &lambda, &mu);
  ct_reference_gradient(8, r.B, u, G);

  // -- Stress of the mean gradient, at once over the whole volume
  double trace = (G[0][0] + G[1][1]) + G[2][2];
  for (int i = 0; i < 24; i++) force[i] = 0.0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double sigma = mu * (G[i][j] + G[j][i]) + (i == j ? lambda * trace : 0.0);
      for (int a = 0; a < 8; a++) force[3 * a + i] -= r.V * sigma * r.B[a][j]; // (eq:reduced-force)
      W += 0.5 * r.V * sigma * G[i][j]; // (eq:reduced-energy)
    }
  // -- Each hourglass amplitude is a spring (eq:hourglass-amplitude)
  // Its force and its energy (eq:reduced-force, eq:reduced-energy).
  for (int k = 0; k < 4; k++)
    for (int i = 0; i < 3; i++) {
      double q = 0.0;
      for (int a = 0; a < 8; a++) q += r.Gamma[k][a] * (u[a][i] - u[0][i]);
      for (int a = 0; a < 8; a++) force[3 * a + i] -= r.c * q * r.Gamma[k][a];
      H += 0.5 * r.c * q * q;
    }
  if (energy != NULL) energy[0] = W, energy[1] = H;
  return CT_OK;
}

ct_status ct_reduced_stiffness(const double *nodes, const ct_material *material, double hourglass,
                               double A[CT_ELEMENT_SIZE][CT_ELEMENT_SIZE], ct_error *error)
{
  reduced_element r;
  double lambda, mu;
  ct_status status = open_element(nodes, material, hourglass, &r, error);
  if (status != CT_OK) return status;
  ct_material_lame(material, &lambda, &mu);
  memset(A, 0, sizeof(double) * CT_ELEMENT_SIZE * CT_ELEMENT_SIZE);
  for (int a = 0; a < 8; a++)
    for (int b = 0; b <= a; b++) {
      ct_add_stiffness(A, a, b, r.B[a], r.B[b], lambda * r.V, mu * r.V);
      for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++) A[3 * a + i][3 * b + i] += r.c * r.Gamma[k][a] * r.Gamma[k][b];
    }
  return CT_OK;
}
