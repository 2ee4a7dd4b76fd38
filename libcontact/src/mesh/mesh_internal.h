#ifndef CT_SRC_MESH_INTERNAL_H
#define CT_SRC_MESH_INTERNAL_H

#include <libcontact/mesh.h>

/* Node numbers of one element, shape (8 or 20); CT_ERROR_ARGUMENT when one is out of range. */
ct_status ct_mesh_element_nodes(const ct_mesh *mesh, int32_t element, int32_t *nodes,
                                ct_error *error);

/* Whether a hex8 element is a box along x, y, z, the right way round, so that its Jacobian is the
 * same at every point; and its volume. Where the square of the volume is no normal number the
 * answer is 0. */
int ct_mesh_upright_box(double nodes[8][3], double *volume);

#endif
