#ifndef CT_SRC_SOLID_ORDER_H
#define CT_SRC_SOLID_ORDER_H

#include <libcontact/mesh.h>

#include "../base/memory.h"

/* A body's mesh in an order of its own: rows of elements that share faces, sheets of rows, and
 * nodes in the order in which their last elements come (eq:order-rows). Inside the solid effect
 * alone; all others number as the user does. */
typedef struct ct_order {
  ct_pool pool;
  const ct_mesh *given;
  ct_mesh mesh; /* the same body, renumbered */
  /* The user's number of each node inside, and the other way; the number inside of each element. */
  int32_t *user, *inside, *element;
} ct_order;

/* Order a mesh of hex8 whose numbers are good (ct_mesh_check); CT_ERROR_MEMORY. */
ct_status ct_order_create(const ct_mesh *mesh, ct_order **out);

/* Null is allowed. */
void ct_order_free(ct_order *order);

#endif
