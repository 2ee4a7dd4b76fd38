#ifndef CONTACT_MASS_H
#define CONTACT_MASS_H

#include <contact/mesh.h>

CT_BEGIN_DECLS

/** How the consistent mass matrix is made diagonal. */
typedef enum ct_lumping {
  /** row sum for hex8, HRZ for hex20 */
  CT_LUMP_DEFAULT = 0,
  /** each row's sum goes to the diagonal, :eq:`row-sum` */
  CT_LUMP_ROW_SUM = 1,
  /** the diagonal, scaled to the element's mass, :eq:`hrz` */
  CT_LUMP_HRZ = 2
} ct_lumping;

/**
 * Lumped mass of one element at its nodes, `mass` of shape (8 or 20) [mass].
 * Row sum is refused for hex20 (``CT_ERROR_UNSUPPORTED``): its corners would get negative masses.
 */
CT_API ct_status ct_mass_element(ct_brick_kind kind, const double *nodes, double density,
                                 ct_lumping lumping, double *mass, ct_error *error);

/** Lumped mass of a whole mesh at its nodes, `mass` of shape (node_count) [mass]. */
CT_API ct_status ct_mass_lumped(const ct_mesh *mesh, double density, ct_lumping lumping,
                                double *mass, ct_error *error);

CT_END_DECLS

#endif
