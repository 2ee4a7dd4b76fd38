#ifndef CT_SRC_SOLID_ORDER_H
#define CT_SRC_SOLID_ORDER_H

#include <libcontact/mesh.h>

#include "../base/memory.h"

/* A body's mesh in its own order: rows of elements with shared faces, sheets of rows, and nodes in
 * the order of their last elements (eq:order-rows). Used inside the solid effect only; all other
 * code has the user's numbers. */
typedef struct ct_order {
  ct_pool pool;
  const ct_mesh *given;
  ct_mesh mesh; /* the same body, renumbered */
  /* The user's number of each node, and the inverse; the new number of each element. */
  int32_t *user, *inside, *element;
} ct_order;

/* Order a mesh of hex8 with valid numbers (ct_mesh_check); CT_ERROR_MEMORY. */
ct_status ct_order_create(const ct_mesh *mesh, ct_order **out);

/* Null is allowed. */
void ct_order_free(ct_order *order);

#endif
