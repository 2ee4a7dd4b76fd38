#ifndef CT_SRC_SOLID_ELEMENT_H
#define CT_SRC_SOLID_ELEMENT_H

#include <contact/brick.h>

/* Derivatives ∂N_a/∂x_j of the shape functions at ξ, shape (8 or 20, 3); returns det J, 0 when the element is inverted or
 * collapsed there (eq:jacobian). */
double ct_element_gradients(ct_brick_kind kind, double x[20][3], const double xi[3], double dNdx[20][3]);

#endif
