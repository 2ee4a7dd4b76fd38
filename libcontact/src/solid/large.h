#ifndef CT_SRC_SOLID_LARGE_H
#define CT_SRC_SOLID_LARGE_H

#include "../mesh/mesh_internal.h"

/* The laws for large deformation at one point, from the displacement gradient G = ∂u/∂X = F - 1. */

/* Floating-point operations of the stress of a law in `point.h`; 0 for CT_LINEAR. */
double ct_large_flops(ct_law law);

/* Second Piola-Kirchhoff stress S (symmetric); returns J = det F, which is not positive if the body
 * is inverted. */
double ct_large_stress(const ct_material *material, double G[3][3], double S[3][3]);

/* Stored energy W per unit of undeformed volume. */
double ct_large_energy(const ct_material *material, double G[3][3]);

/* The tangent stiffness of a point for two nodes with the gradients g_a, g_b: a v_a v_bᵀ + b v_b
 * v_aᵀ + (g_a · g_b) M
 * + (g_a · S g_b) 1 with v = V g (eq:large-tangent). */
typedef struct ct_large_stiffness {
  double V[3][3], M[3][3], S[3][3], a, b;
} ct_large_stiffness;

/* Returns J = det F; if it is not positive the stiffness is not set. */
double ct_large_tangent(const ct_material *material, double G[3][3], ct_large_stiffness *K);

/* The part of the neo-Hookean energy that depends on the volume alone, ½ Λ (J - 1)² + ½ μ (t - ln(1
 * + t)) with t = J² - 1 (eq:neo-hookean-exact). */
double ct_large_volume_energy(double lambda, double mu, double t);

#endif
