#ifndef CT_SRC_MESH_INTERNAL_H
#define CT_SRC_MESH_INTERNAL_H

#include <libcontact/mesh.h>

/* Node numbers of one element, shape (8 or 20); CT_ERROR_ARGUMENT when one is out of range. */
ct_status ct_mesh_element_nodes(const ct_mesh *mesh, int32_t element, int32_t *nodes,
                                ct_error *error);

#endif
