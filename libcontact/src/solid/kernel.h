#ifndef CT_SRC_SOLID_KERNEL_H
#define CT_SRC_SOLID_KERNEL_H

#include <libcontact/solid.h>

#include "../mesh/assembly.h"
#include "../mesh/batch.h"
#include "../mesh/mesh_internal.h"
#include "order.h"
#include "ring.h"

#include <string.h>

struct ct_solid_part;

/* A body that is one box of equal hex8 bricks, with its nodes and elements in any order. */
typedef struct ct_solid_box {
  int32_t cells[3];  /* along its three edges; cells[0] = 0: the body is not a box */
  double edge[3];    /* lengths of the bricks' edges */
  double axis[3][3]; /* their directions */
  int aligned;       /* whether these are x, y, z */
  int fixed[3];      /* components that do not move, along the edges */
} ct_solid_box;

/* Forces of the batches first ... last - 1; `displacement` (and the mesh's nodes) are those of the
 * body. A kernel first takes differences of displacements, and depends on nothing else that
 * changes: if all nodes of a batch have the same displacement, the result has the same bits for any
 * such displacement (eq:sleep). A kernel for large deformation also writes the smallest J = det F
 * of batch b (and 1) to `values[assembly->value_count + b]`; memory for the energies of its
 * elements begins at `values[energy_value]`. */
typedef void ct_solid_batches(const struct ct_solid_part *part, int32_t first, int32_t last,
                              const double *displacement, double *values);

/* Stored energies of the 8 elements of one batch. */
typedef void ct_solid_energies(const struct ct_solid_part *part, int32_t batch,
                               const double *displacement, double energies[8]);

/* One body, prepared for its kernel. Element forces go to `values` in the layout of ct_assembly. */
typedef struct ct_solid_part {
  const ct_mesh *mesh;  /* the user's, or that of `order` */
  ct_material material; /* of all elements, or the stiffest of `materials` */
  /* Null, or the material of each element in the order of the user; and the constants of the
   * elements, CT_CONSTANT_COUNT arrays of 8 batch_count numbers: in the order of `mesh`, and in
   * that of the user (the same memory if both orders are one). */
  const ct_material *materials;
  double *constants, *constants_given;
  ct_lumping lumping;
  ct_optimisations optimisations;
  double lambda, mu;
  int32_t first_node;
  ct_solid_kernel kernel;
  ct_solid_batches *batches;
  /* Null if the force is linear: the energy is then half its work. */
  ct_solid_energies *energies;
  /* Floating-point operations of the kernel for one element. */
  double flops;
  /* Largest ω² of the undeformed elements. */
  double omega_squared;
  /* The box whose blocks gave this bound. */
  ct_solid_box blocks;
  /* Whether all elements are boxes of one size (ct_solid_is_box), for the linear law, and the
   * lengths of their edges. */
  int box;
  double edge[3];
  /* Ring for the element forces; null: they have the layout of ct_assembly. */
  ct_force_ring *ring;
  /* The layer that represents both, if the kernel is CT_KERNEL_PLANE. Values in rings begin where
   * the effect's begin. */
  ct_force_ring *plane;
  /* Batches of 8 elements, and whether each is a row: node a of its element l is node a of its
   * first one, plus l. */
  int32_t batch_count;
  uint8_t *rows;
  /* Null, or the order of kernels and sums; displacements are copied into it, forces leave it. */
  ct_order *order;
  /* Coefficient of the hourglass control, if the kernel is CT_KERNEL_REDUCED. */
  double hourglass;
  /* Data shared by the elements, if the kernel is CT_KERNEL_BOX for hex20. */
  struct ct_box20 *box20;
  /* Null, or of a part of the bulk viscosity: its constant data. */
  const struct ct_viscous_body *viscous;
  ct_assembly *assembly;
  /* Begin of this part's values, and of its batches, in the scratch of the effect; number of its
   * values; and number of values before the energies. */
  int64_t first_value, first_batch, value_count, energy_value;
  int64_t first_ordered; /* begin of the displacements in `order` there */
  /* Whether this is the piece of a part, which has its box20; and memory of its mesh. */
  int is_piece;
  ct_pool piece;
  /* Batches of the elements of node n, batches_at[batch_begin[n]] ... batches_at[batch_begin[n + 1]
   * - 1]; null if no element sleeps, or if the ring has them. */
  int32_t *batch_begin, *batches_at;
} ct_solid_part;

/* Constants of the materials of single elements. */
enum { CT_LAMBDA, CT_MU, CT_YOUNG, CT_DENSITY, CT_CONSTANT_COUNT };

/* A constant of 8 elements of a batch, or of all elements, of the value `all`. */
CT_INLINE void ct_part_constant(const ct_solid_part *part, int which, double all, int32_t b,
                                int lane, ct_lanes *value)
{
  if (part->constants == NULL) ct_lanes_fill(all, value);
  else
    memcpy(value, &part->constants[8 * ((int64_t)which * part->batch_count + b) + lane],
           sizeof *value);
}

/* The material of an element, numbered as by the user. */
static inline const ct_material *ct_part_material(const ct_solid_part *part, int32_t element)
{
  return part->materials != NULL ? &part->materials[element] : &part->material;
}

/* The part in the user's order, for single elements. */
static inline ct_solid_part ct_part_given(const ct_solid_part *part)
{
  ct_solid_part given = *part;
  if (part->order == NULL) return given;
  given.mesh = part->order->given;
  given.order = NULL;
  given.rows = NULL;
  given.constants = part->constants_given;
  return given;
}

/* Number of batches that are computed before their nodes are summed, while their forces are still
 * in the cache. */
enum { CT_BLOCK = 32 };

/* Edge lengths if all elements are rectangular along x, y, z, with straight edges and mid-side
 * nodes in the middle, and equal to 1e-12; 0 otherwise. */
int ct_solid_is_box(const ct_mesh *mesh, double edge[3]);

/* Compute the data shared by hex20 boxes of one size, from the part's edges and its material. */
ct_status ct_box20_prepare(ct_solid_part *part);

ct_solid_batches ct_solid_box_batches, ct_solid_box20_batches, ct_solid_hex8_batches,
    ct_solid_hex20_batches;
ct_solid_batches ct_solid_large_hex8_batches, ct_solid_large_hex20_batches;
ct_solid_energies ct_solid_large_hex8_energies, ct_solid_large_hex20_energies;

/* Refuse a batch whose smallest J is not positive, with the message of the readable form. */
ct_status ct_solid_check_volume(const ct_solid_part *part, int32_t body, const double *u,
                                const double *values, ct_error *error);

/* Largest eigenvalue of the tangents of the elements of one part at the displacement u
 * (eq:tangent-bound). */
ct_status ct_solid_tangent_omega2_bound(const ct_solid_part *part, const double *u,
                                        double *omega_squared, ct_error *error);

/* Values of one element's nodes from an array (nodes, 3). */
static inline void ct_solid_load_element(const ct_mesh *mesh, int32_t e, const double *from,
                                         double to[20][3])
{
  size_t per = (size_t)ct_brick_node_count(mesh->kind);
  for (size_t a = 0; a < per; a++)
    memcpy(to[a], &from[3 * (size_t)mesh->elements[(size_t)e * per + a]], sizeof to[a]);
}

/* Place of the forces of batch `b`: number (3 a + c) of element l is at [(3 a + c) * stride + l].
 */
static inline double *ct_batch_values(const ct_force_ring *ring, int per, double *values, int32_t b,
                                      int64_t *stride)
{
  *stride = ring != NULL ? ring->stride : 8;
  return values +
         (ring != NULL ? ring->step * (8 * (int64_t)b & (ring->size - 1)) : 24 * (int64_t)per * b);
}

/* Write component c of the forces of the `per` nodes of 8 elements to this place. */
CT_INLINE void ct_store_lanes(const ct_lanes *f, int per, int c, int lane, int64_t stride,
                              double *values)
{
  for (int a = 0; a < per; a++) *(ct_lanes *)(void *)&values[stride * (3 * a + c) + lane] = f[a];
}

#endif
