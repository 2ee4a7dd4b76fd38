#ifndef CT_SRC_SOLID_ELEMENT_H
#define CT_SRC_SOLID_ELEMENT_H

#include <contact/brick.h>
#include <contact/status.h>

/* Degrees of freedom of the largest element. */
enum { CT_ELEMENT_SIZE = 60 };

/* Derivatives ∂N_a/∂x_j of the shape functions at ξ, shape (8 or 20, 3); returns det J, 0 when the element is inverted or
 * collapsed there (eq:jacobian). */
double ct_element_gradients(ct_brick_kind kind, double x[20][3], const double xi[3], double dNdx[20][3]);

/* Mean gradients B[a][j] of the shape functions over a hex8, its volume, and the sum g² of their squares (eq:mean-gradient). */
ct_status ct_element_mean_gradients(const double *nodes, double B[20][3], double *volume, double *g2, ct_error *error);

/* Add the stiffness of one point, (∂σ/∂u) : ∂N/∂x dV, for the nodes a and b with the gradients p and q; λ and μ times dV (eq:stiffness). */
void ct_add_stiffness(double A[CT_ELEMENT_SIZE][CT_ELEMENT_SIZE], int a, int b, const double p[3], const double q[3], double lambda, double mu);

/* Bound of the largest eigenvalue of M⁻¹K from the lower half of K, which is lost, and the masses of `per` nodes (eq:element-bound). */
ct_status ct_largest_eigenvalue(int per, const double *mass, double A[CT_ELEMENT_SIZE][CT_ELEMENT_SIZE], double *omega_squared, ct_error *error);

#endif
