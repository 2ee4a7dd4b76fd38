/* The laws for large deformation at one point, in the form of the equations. Each law has a block
 * of functions and a row in LAWS; nothing else in this file depends on the law. */
#include "large.h"

#include "../shape/jacobian.h"

#include <math.h>
#include <string.h>

/* What a law may read: B = 2E = FᵀF - 1 without the loss of digits of FᵀF - 1 at small strain, its
 * cofactors and invariants, and the change of volume J - 1. */
typedef struct deformation {
  double lambda, mu;
  double F[3][3], cofactor[3][3];
  double B[3][3], adjugate[3][3];
  /* tr B; the sum of its principal minors; det B. */
  double one, two, three;
  double change, J;
} deformation;

static deformation deform(const ct_material *material, double G[3][3])
{
  deformation d;
  double minor[3][3];
  ct_material_lame(material, &d.lambda, &d.mu);
  for (int i = 0; i < 9; i++) d.F[i / 3][i % 3] = G[i / 3][i % 3] + (i % 4 == 0 ? 1.0 : 0.0);
  (void)ct_cofactors(d.F, d.cofactor);
  // -- Twice the Green-Lagrange strain (eq:green-lagrange)
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      d.B[i][j] =
          (G[i][j] + G[j][i]) + ((G[0][i] * G[0][j] + G[1][i] * G[1][j]) + G[2][i] * G[2][j]);
  d.three = ct_cofactors(d.B, d.adjugate);
  d.one = (d.B[0][0] + d.B[1][1]) + d.B[2][2];
  d.two = (d.adjugate[0][0] + d.adjugate[1][1]) + d.adjugate[2][2];
  // -- J - 1 from the gradient, where 1 has dropped out (eq:volume-change)
  double three = ct_cofactors(G, minor), two = (minor[0][0] + minor[1][1]) + minor[2][2];
  d.change = ((G[0][0] + G[1][1]) + G[2][2]) + (two + three);
  d.J = 1.0 + d.change;
  return d;
}

/* St. Venant-Kirchhoff. */

static void svk_stress(const deformation *d, double S[3][3])
{
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      // -- S = Λ tr E 1 + 2 μ E (eq:st-venant-kirchhoff)
      S[i][j] = 0.5 * d->lambda * d->one * (i == j ? 1.0 : 0.0) + d->mu * d->B[i][j];
}

static double svk_energy(const deformation *d)
{
  double square = 0.0;
  // -- Λ (tr B)² / 8 + μ B : B / 4 (eq:st-venant-kirchhoff)
  for (int i = 0; i < 9; i++) square += d->B[i / 3][i % 3] * d->B[i / 3][i % 3];
  return 0.125 * d->lambda * d->one * d->one + 0.25 * d->mu * square;
}

static void svk_tangent(const deformation *d, ct_large_stiffness *K)
{
  // -- v = F ∇N, M = μ F Fᵀ, S₀ = S (eq:large-tangent)
  svk_stress(d, K->S);
  memcpy(K->V, d->F, sizeof K->V);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      K->M[i][j] =
          d->mu * ((d->F[i][0] * d->F[j][0] + d->F[i][1] * d->F[j][1]) + d->F[i][2] * d->F[j][2]);
  K->a = d->lambda;
  K->b = d->mu;
}

/* Compressible neo-Hookean. */

static void neo_hookean_stress(const deformation *d, double S[3][3])
{
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      // -- S = μ (1 - C⁻¹) + Λ (J - 1) J C⁻¹ (eq:neo-hookean-stress, eq:neo-hookean-exact)
      double one = i == j ? 1.0 : 0.0, JJ = d->J * d->J,
             inverse = ((1.0 + d->one) * one - d->B[i][j] + d->adjugate[i][j]) / JJ,
             excess = ((d->two + d->three) * one + d->B[i][j] - d->adjugate[i][j]) / JJ;
      S[i][j] = d->mu * excess + d->lambda * d->change * d->J * inverse;
    }
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

static double neo_hookean_energy(const deformation *d)
{
  // -- The energy of the volume, less ½ μ (I₂ + I₃) (eq:neo-hookean-exact)
  return ct_large_volume_energy(d->lambda, d->mu, d->one + (d->two + d->three)) -
         0.5 * d->mu * (d->two + d->three);
}

static void neo_hookean_tangent(const deformation *d, ct_large_stiffness *K)
{
  // -- v = F⁻ᵀ ∇N, M = μ 1, S₀ = 0 (eq:large-tangent)
  *K = (ct_large_stiffness){.a = d->lambda * (2.0 * d->J - 1.0) * d->J,
                            .b = d->mu - d->lambda * (d->J - 1.0) * d->J};
  for (int i = 0; i < 9; i++) K->V[i / 3][i % 3] = d->cofactor[i / 3][i % 3] / d->J;
  for (int i = 0; i < 3; i++) K->M[i][i] = d->mu;
}

/* All laws. `point.h` has their stress and energy for eight elements. */

static const struct law {
  void (*stress)(const deformation *d, double S[3][3]);
  double (*energy)(const deformation *d);
  void (*tangent)(const deformation *d, ct_large_stiffness *K);
  /* Floating-point operations of the stress in `point.h`. */
  double flops;
} LAWS[] = {
    [CT_LINEAR] = {0}, // has kernels of its own
    [CT_ST_VENANT_KIRCHHOFF] = {svk_stress, svk_energy, svk_tangent, 12.0},
    [CT_NEO_HOOKEAN] = {neo_hookean_stress, neo_hookean_energy, neo_hookean_tangent, 55.0},
};

/* A value of ct_law without a row does not compile. */
typedef char every_law_has_its_row[sizeof LAWS / sizeof LAWS[0] == CT_LAW_COUNT ? 1 : -1];

double ct_large_flops(ct_law law) { return LAWS[law].flops; }

double ct_large_stress(const ct_material *material, double G[3][3], double S[3][3])
{
  const deformation d = deform(material, G);
  LAWS[material->law].stress(&d, S);
  return d.J;
}

double ct_large_tangent(const ct_material *material, double G[3][3], ct_large_stiffness *K)
{
  const deformation d = deform(material, G);
  if (d.J > 0.0) LAWS[material->law].tangent(&d, K);
  return d.J;
}

double ct_large_energy(const ct_material *material, double G[3][3])
{
  const deformation d = deform(material, G);
  return LAWS[material->law].energy(&d);
}
