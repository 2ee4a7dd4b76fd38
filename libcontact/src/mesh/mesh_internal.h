#ifndef CT_SRC_MESH_INTERNAL_H
#define CT_SRC_MESH_INTERNAL_H

#include "../shape/shape.h"

#include <libcontact/mesh.h>

/* Fewest elements or nodes of a thread if there is little work for each. */
enum { CT_LEAST_OF_MESH = 16384 };

/* A mesh with its arrays, zeroed. CT_ERROR_ARGUMENT: none or too many nodes or elements. */
ct_status ct_mesh_allocate(ct_brick_kind kind, int64_t nodes, int64_t elements, ct_mesh **out,
                           ct_error *error);

/* ct_mesh_create_box with the settings of a run. */
ct_status ct_mesh_make_box(ct_brick_kind kind, const ct_box *box, const ct_run_settings *settings,
                           ct_mesh **mesh, ct_error *error);

/* CT_ERROR_ARGUMENT if an element names a node that the mesh does not have, or has an unknown kind.
 */
ct_status ct_mesh_check_numbers(const ct_mesh *mesh, ct_error *error);

/* ct_mesh_check of a mesh of the library, in which no element and no face is listed too often. */
ct_status ct_mesh_check_shapes(const ct_mesh *mesh, ct_error *error);

/* CT_ERROR_ARGUMENT if two elements of a mesh with valid numbers have the same corners. */
ct_status ct_mesh_check_twins(const ct_mesh *mesh, ct_error *error);

/* CT_ERROR_ARGUMENT if a face belongs to more than two of its elements. */
ct_status ct_mesh_check_sides(const ct_mesh *mesh, ct_error *error);

/* The octant around local node `a` of a brick in which the brick lies: bit 0 is set when it lies on
 * the side of positive ξ. */
int ct_brick_octant(ct_brick_kind kind, int a);

/* Lamé's constants Λ and μ [stress], eq:lame. */
void ct_material_lame(const ct_material *material, double *lambda, double *mu);

/* Refuse impossible constants: CT_ERROR_ARGUMENT with the constant's name and value in
 * `error`. */
ct_status ct_material_check(const ct_material *material, ct_error *error);

/* Refuse the materials of a body's elements: impossible constants, or more than one law; `error`
 * names the element. Writes the number of the stiffest, with the largest c₁, to `stiffest`. */
ct_status ct_materials_check(const ct_material *materials, int32_t count, int32_t *stiffest,
                             ct_error *error);

/* Elements of faces of a mesh, given by their nodes, shape (count, 4 or 8), in any order:
 * `owners`, shape (count); -1 if no element has it. Of an inner face either one. */
ct_status ct_mesh_face_owners(const ct_mesh *mesh, int32_t count, const int32_t *faces,
                              int32_t *owners, ct_error *error);

/* Place in `a` of its first face that is also in `b`; -1: none, -2: no memory. Faces have `per` (4
 * or 8) nodes and are equal if their corners are, in any order. */
int32_t ct_mesh_common_face(int per, const int32_t *a, int32_t count_a, const int32_t *b,
                            int32_t count_b);

/* Smallest and largest coordinates of the nodes [length]; infinite and exchanged for a null mesh.
 */
void ct_mesh_bounds(const ct_mesh *mesh, double low[3], double high[3]);

/* ct_mass_lumped with the density of each element's material, or `density` if there are none. */
ct_status ct_mass_of_materials(const ct_mesh *mesh, double density, const ct_material *materials,
                               ct_lumping lumping, double *mass, ct_error *error);

/* Lumped mass of one element at its nodes, `mass` of shape (8 or 20) [mass].
 * Row sum is refused for hex20 (CT_ERROR_UNSUPPORTED): its corners would get negative masses. */
ct_status ct_mass_element(ct_brick_kind kind, const double *nodes, double density,
                          ct_lumping lumping, double *mass, ct_error *error);

#endif
