#ifndef CT_SRC_MESH_INTERNAL_H
#define CT_SRC_MESH_INTERNAL_H

#include "../shape/shape.h"

#include <libcontact/mesh.h>

/* Node numbers of one element, shape (8 or 20); CT_ERROR_ARGUMENT if one is out of range. */
ct_status ct_mesh_element_nodes(const ct_mesh *mesh, int32_t element, int32_t *nodes,
                                ct_error *error);

/* Fewest elements or nodes of a thread if there is little work for each. */
enum { CT_LEAST_OF_MESH = 16384 };

/* ct_mesh_create_box with the settings of a run. */
ct_status ct_mesh_make_box(ct_brick_kind kind, const ct_box *box, const ct_run_settings *settings,
                           ct_mesh **mesh, ct_error *error);

/* CT_ERROR_ARGUMENT if an element names a node that the mesh does not have, or has an unknown kind.
 */
ct_status ct_mesh_check_numbers(const ct_mesh *mesh, ct_error *error);

/* CT_ERROR_ARGUMENT if two elements of a mesh with valid numbers have the same corners. */
ct_status ct_mesh_check_twins(const ct_mesh *mesh, ct_error *error);

/* The octant around local node `a` of a brick in which the brick lies: bit 0 is set when it lies on
 * the side of positive ξ. */
int ct_brick_octant(ct_brick_kind kind, int a);

/* Lamé's constants Λ and μ [stress], eq:lame. */
void ct_material_lame(const ct_material *material, double *lambda, double *mu);

/* Refuse impossible constants: CT_ERROR_ARGUMENT with the constant's name and value in
 * `error`. */
ct_status ct_material_check(const ct_material *material, ct_error *error);

/* Smallest and largest coordinates of the nodes [length]; infinite and exchanged for a null mesh.
 */
void ct_mesh_bounds(const ct_mesh *mesh, double low[3], double high[3]);

/* Lumped mass of one element at its nodes, `mass` of shape (8 or 20) [mass].
 * Row sum is refused for hex20 (CT_ERROR_UNSUPPORTED): its corners would get negative masses. */
ct_status ct_mass_element(ct_brick_kind kind, const double *nodes, double density,
                          ct_lumping lumping, double *mass, ct_error *error);

#endif
