#ifndef CT_SRC_SOLID_ELEMENT_H
#define CT_SRC_SOLID_ELEMENT_H

#include "../mesh/mesh_internal.h"

/* Degrees of freedom of the largest element. */
enum { CT_ELEMENT_SIZE = 60 };

/* Derivatives ∂N_a/∂x_j of the shape functions at ξ, shape (8 or 20, 3); returns det J, 0 if the
 * element is inverted or collapsed there (eq:jacobian). */
double ct_element_gradients(ct_brick_kind kind, double x[20][3], const double xi[3],
                            double dNdx[20][3]);

/* Mean gradients B[a][j] of the shape functions over a hex8, its volume, and the sum g² of their
 * squares (eq:mean-gradient). */
ct_status ct_element_mean_gradients(const double *nodes, double B[20][3], double *volume,
                                    double *g2, ct_error *error);

/* Add the stiffness of one point, (∂σ/∂u) : ∂N/∂x dV, for the nodes a and b with the gradients p
 * and q; λ and μ times dV (eq:stiffness). */
void ct_add_stiffness(double A[CT_ELEMENT_SIZE][CT_ELEMENT_SIZE], int a, int b, const double p[3],
                      const double q[3], double lambda, double mu);

/* Lower half of the stiffness of an element; the tangent's at a displacement unless that is null
 * (eq:stiffness, eq:large-tangent). */
ct_status ct_element_stiffness(ct_brick_kind kind, const double *nodes, const double *displacement,
                               const ct_material *material,
                               double A[CT_ELEMENT_SIZE][CT_ELEMENT_SIZE], ct_error *error);

/* The same of a hex8 with one point and hourglass control (eq:reduced-force,
 * eq:hourglass-stiffness). */
ct_status ct_reduced_stiffness(const double *nodes, const ct_material *material, double hourglass,
                               double A[CT_ELEMENT_SIZE][CT_ELEMENT_SIZE], ct_error *error);

/* Bound on the largest eigenvalue of M⁻¹K from the lower half of K, which is overwritten, and the
 * masses of `count` degrees of freedom (eq:element-bound); fixed ones have infinite mass. */
ct_status ct_largest_eigenvalue(int count, const double *mass,
                                double A[CT_ELEMENT_SIZE][CT_ELEMENT_SIZE], double *omega_squared,
                                ct_error *error);

/* The masses of nodes as those of their degrees of freedom, infinite if `fixed` (null: none is). */
void ct_spread_mass(int per, const double *mass, const int fixed[3],
                    double spread[CT_ELEMENT_SIZE]);

/* Internal force of one element, the readable form: one Gauss point after another,
 * eq:internal-force, and for large deformation eq:large-force. `nodes` (undeformed) and
 * `displacement` and `force` have shape (8 or 20, 3); `force` [force] acts on the nodes. `energy`
 * [energy], eq:large-energy, may be null. CT_ERROR_GEOMETRY if the deformation inverts the element
 * (`error` names the Gauss point). */
ct_status ct_solid_element_force(ct_brick_kind kind, const double *nodes,
                                 const double *displacement, const ct_material *material,
                                 double *force, double *energy, ct_error *error);

/* Stress xx yy zz xy yz zx [stress] of one element at the point ξ, eq:hooke; for large
 * deformation Cauchy's, eq:cauchy. */
ct_status ct_solid_element_stress(ct_brick_kind kind, const double *nodes,
                                  const double *displacement, const ct_material *material,
                                  const double xi[3], double stress[6], ct_error *error);

/* Cauchy's stress xx yy zz xy yz zx [stress] of a displacement gradient, P Fᵀ / J (eq:cauchy);
 * CT_ERROR_GEOMETRY if it inverts the element. */
ct_status ct_element_cauchy(const ct_material *material, double G[3][3], double stress[6],
                            ct_error *error);

/* Force of one hex8 element with one point and hourglass control, the readable form,
 * eq:reduced-force. `nodes`, `displacement` and `force` have shape (8, 3); `hourglass` > 0 is the
 * coefficient Q of eq:hourglass-stiffness. `energy` (may be null) returns the energies of the mean
 * strain and of the hourglass control, eq:reduced-energy. CT_ERROR_UNSUPPORTED for a law of large
 * deformation. */
ct_status ct_solid_reduced_force(const double *nodes, const double *displacement,
                                 const ct_material *material, double hourglass, double *force,
                                 double energy[2], ct_error *error);

/* Upper bound on the largest ω² of one element with its lumped `mass` (8 or 20), the largest
 * eigenvalue of M⁻¹K (eq:element-bound) [1 / time²]; of the tangent stiffness at a `displacement`
 * (8 or 20, 3) unless that is null (eq:large-tangent), 0 if no eigenvalue is positive. With the law
 * CT_LINEAR the displacement has no influence. */
ct_status ct_solid_element_omega2_bound(ct_brick_kind kind, const double *nodes,
                                        const double *displacement, const ct_material *material,
                                        const double *mass, double *omega_squared, ct_error *error);

#endif
