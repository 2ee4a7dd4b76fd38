/* St. Venant-Kirchhoff and neo-Hookean material at one point, in the form of the equations. */
#include "large.h"

#include "../shape/jacobian.h"

#include <math.h>

/* Quantities of both laws: B = 2E = FᵀF - 1 without the loss of digits of FᵀF - 1 at small strain,
 * its cofactors and invariants. */
typedef struct deformation {
  double B[3][3], adjugate[3][3];
  /* tr B; the sum of its principal minors; det B. */
  double one, two, three;
} deformation;

static deformation deform(double G[3][3])
{
  deformation d;
  // -- Twice the Green-Lagrange strain (eq:green-lagrange)
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      d.B[i][j] =
          (G[i][j] + G[j][i]) + ((G[0][i] * G[0][j] + G[1][i] * G[1][j]) + G[2][i] * G[2][j]);
  d.three = ct_cofactors(d.B, d.adjugate);
  d.one = (d.B[0][0] + d.B[1][1]) + d.B[2][2];
  d.two = (d.adjugate[0][0] + d.adjugate[1][1]) + d.adjugate[2][2];
  return d;
}

double ct_large_stress(const ct_material *material, double G[3][3], double S[3][3])
{
  double lambda, mu, minor[3][3];
  ct_material_lame(material, &lambda, &mu);
  deformation d = deform(G);
  // -- J - 1 from the gradient, where 1 has dropped out (eq:volume-change)
  double three = ct_cofactors(G, minor), two = (minor[0][0] + minor[1][1]) + minor[2][2];
  double change = ((G[0][0] + G[1][1]) + G[2][2]) + (two + three), J = 1.0 + change;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double one = i == j ? 1.0 : 0.0;
      if (material->law == CT_ST_VENANT_KIRCHHOFF) {
        // -- S = Λ tr E 1 + 2 μ E (eq:st-venant-kirchhoff)
        S[i][j] = 0.5 * lambda * d.one * one + mu * d.B[i][j];
      } else {
        // -- S = μ (1 - C⁻¹) + Λ (J - 1) J C⁻¹ (eq:neo-hookean-stress, eq:neo-hookean-exact)
        double inverse = ((1.0 + d.one) * one - d.B[i][j] + d.adjugate[i][j]) / (J * J);
        double excess = ((d.two + d.three) * one + d.B[i][j] - d.adjugate[i][j]) / (J * J);
        S[i][j] = mu * excess + lambda * change * J * inverse;
      }
    }
  return J;
}

double ct_large_tangent(const ct_material *material, double G[3][3], ct_large_stiffness *K)
{
  double lambda, mu, F[3][3], cofactor[3][3], J = ct_large_stress(material, G, K->S);
  ct_material_lame(material, &lambda, &mu);
  if (!(J > 0.0)) return J;
  for (int i = 0; i < 9; i++) F[i / 3][i % 3] = G[i / 3][i % 3] + (i % 4 == 0 ? 1.0 : 0.0);
  int svk = material->law == CT_ST_VENANT_KIRCHHOFF;
  (void)ct_cofactors(F, cofactor);
  // -- The table of both laws (eq:large-tangent)
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double one = i == j ? 1.0 : 0.0,
             FF = (F[i][0] * F[j][0] + F[i][1] * F[j][1]) + F[i][2] * F[j][2];
      K->V[i][j] = svk ? F[i][j] : cofactor[i][j] / J;
      K->M[i][j] = mu * (svk ? FF : one);
      if (!svk) K->S[i][j] = 0.0;
    }
  K->a = svk ? lambda : lambda * (2.0 * J - 1.0) * J;
  K->b = svk ? mu : mu - lambda * (J - 1.0) * J;
  return J;
}

/* t - ln(1 + t), which is t²/2 for small t, to the last digits (eq:log-excess). */
static double log_excess(double t)
{
  if (!(fabs(t) < 0.1)) return t - log1p(t);
  double r = t / (2.0 + t), q = r * r, series = 0.0;
  for (int k = 15; k >= 3; k -= 2) series = 1.0 / k + q * series;
  return t * r - 2.0 * r * q * series;
}

double ct_large_volume_energy(double lambda, double mu, double t)
{
  // -- Energy of the volume without a difference of large terms (eq:neo-hookean-exact)
  double change = t / (1.0 + sqrt(1.0 + t));
  return 0.5 * lambda * change * change + 0.5 * mu * log_excess(t);
}

double ct_large_energy(const ct_material *material, double G[3][3])
{
  double lambda, mu, square = 0.0;
  ct_material_lame(material, &lambda, &mu);
  deformation d = deform(G);
  if (material->law == CT_ST_VENANT_KIRCHHOFF) {
    // -- Λ (tr B)² / 8 + μ B : B / 4 (eq:st-venant-kirchhoff)
    for (int i = 0; i < 9; i++) square += d.B[i / 3][i % 3] * d.B[i / 3][i % 3];
    return 0.125 * lambda * d.one * d.one + 0.25 * mu * square;
  }
  // -- The energy of the volume, less ½ μ (I₂ + I₃) (eq:neo-hookean-exact)
  return ct_large_volume_energy(lambda, mu, d.one + (d.two + d.three)) -
         0.5 * mu * (d.two + d.three);
}
