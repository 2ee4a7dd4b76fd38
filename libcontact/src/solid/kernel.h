#ifndef CT_SRC_SOLID_KERNEL_H
#define CT_SRC_SOLID_KERNEL_H

#include <libcontact/solid.h>

#include "../mesh/assembly.h"
#include "../mesh/mesh_internal.h"
#include "../base/lanes.h"

#include <string.h>

struct ct_solid_part;

/* Forces of the batches first ... last - 1; `displacement` (and the mesh's nodes) are those of the
 * body. A kernel takes differences of displacements first, and uses nothing else that changes:
 * where all nodes of a batch have the same displacement, it gives the same bits whatever that is
 * (eq:sleep). A kernel for large deformation also writes the smallest J = det F of batch b
 * (and 1) to `values[assembly->value_count + b]`; room for the energies of its elements begins at
 * `values[energy_value]`. */
typedef void ct_solid_batches(const struct ct_solid_part *part, int32_t first, int32_t last,
                              const double *displacement, double *values);

/* Stored energies of the 8 elements of one batch. */
typedef void ct_solid_energies(const struct ct_solid_part *part, int32_t batch,
                               const double *displacement, double energies[8]);

/* Most families of nodes in a body: corners, and mid-sides along three axes. */
enum { CT_FAMILIES = 4 };

/* One body, prepared for its kernel. Element forces go to `values` in the layout of ct_assembly. */
typedef struct ct_solid_part {
  const ct_mesh *mesh;
  ct_material material;
  ct_lumping lumping;
  ct_optimisations optimisations;
  double lambda, mu;
  int32_t first_node;
  /* Families of nodes that are summed each in the order of their numbers, family[k] ... family[k +
   * 1] - 1. */
  int32_t family[CT_FAMILIES + 1];
  int families;
  ct_solid_kernel kernel;
  ct_solid_batches *batches;
  /* Null where the force is linear: the energy is then half its work. */
  ct_solid_energies *energies;
  /* Floating-point operations of the kernel for one element. */
  double flops;
  /* Largest ω² of the undeformed elements. */
  double omega_squared;
  /* Edge lengths of the elements, when the kernel is CT_KERNEL_BOX. */
  double edge[3];
  /* Cells of a body of boxes in the order of a lattice, along the axis that rows lie along, the
   * next, and that of the layers; cells[0] = 0: it is none. These axes, and how far each corner's
   * node number is from that of the first corner. */
  int32_t cells[3];
  int axes[3];
  int32_t corner[8];
  /* Where such elements share all that is stored, a ring of `ring` elements, a power of two, holds
   * their forces, those of one component of one node `stride` after those of the one before; each
   * of `rings` threads has one, and computes `block` batches at once. There are then no
   * batch_nodes, assembly, ready. 0: there is no ring. */
  int32_t rings, block;
  int64_t ring, stride;
  /* Node numbers in the body, shape (batches, 8 or 20, 8 lanes); the last batch repeats its last
   * element. */
  int32_t batch_count;
  int32_t *batch_nodes;
  /* Coefficient of the hourglass control, and what is laid down for each batch, when the kernel is
   * CT_KERNEL_REDUCED. */
  double hourglass;
  struct ct_reduced_lanes *mean;
  /* What the elements share when the kernel is CT_KERNEL_BOX for hex20. */
  struct ct_box20 *box20;
  /* Shape gradients ∂N_a/∂ξ_j at the Gauss points of hex20, shape (27, 20, 3); null when the kernel
   * needs none. */
  double (*gradients)[20][3];
  ct_assembly *assembly;
  /* After each block of CT_BLOCK batches: the first node of each family that waits for an element,
   * shape (blocks, families). */
  int32_t *ready;
  /* Where this part's values, and its batches, begin in the scratch of the effect, how many values
   * it has, and after how many of them energies are kept. */
  int64_t first_value, first_batch, value_count, energy_value;
  /* Batches of the elements of node n, batches_at[batch_begin[n]] ... batches_at[batch_begin[n + 1]
   * - 1]; null for a lattice, and where no element sleeps. */
  int32_t *batch_begin, *batches_at;
  /* The layer that stands for both, when the kernel is CT_KERNEL_PLANE; its values stand where the
   * effect's begin. */
  struct ct_plane *plane;
} ct_solid_part;

/* Batches that are computed before their nodes are summed, while their forces are still in the
 * cache. */
enum { CT_BLOCK = 32 };

/* Edge lengths when all elements are rectangular along x, y, z, with straight edges and their nodes
 * in the middle, and alike to 1e-12; 0 otherwise. */
int ct_solid_is_box(const ct_mesh *mesh, double edge[3]);

/* Lay down what hex20 boxes of one size share, from the part's edges and its material. */
ct_status ct_box20_prepare(ct_solid_part *part);

ct_solid_batches ct_solid_box_batches, ct_solid_box20_batches, ct_solid_hex8_batches,
    ct_solid_hex20_batches;
ct_solid_batches ct_solid_large_hex8_batches, ct_solid_large_hex20_batches;
ct_solid_energies ct_solid_large_hex8_energies, ct_solid_large_hex20_energies;

/* Refuse a batch whose smallest J is not positive, in the words of the readable form. */
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

/* Node numbers of a mesh, shape (batches, 8 or 20, 8 lanes); the last batch repeats its last
 * element. */
void ct_solid_batch_nodes(const ct_mesh *mesh, int32_t *batch_nodes);

/* Read `per` nodes of 8 elements from an array (nodes, 3) into lanes v[component][node]. */
static inline void ct_load_lanes(const int32_t *nodes, int per, const double *array, int lane,
                                 ct_lanes *v)
{
  for (int a = 0; a < per; a++) {
    const int32_t *n = &nodes[8 * a + lane];
#if CT_LANES_WIDE
    const double *p0 = array + 3 * (int64_t)n[0], *p1 = array + 3 * (int64_t)n[1],
                 *p2 = array + 3 * (int64_t)n[2], *p3 = array + 3 * (int64_t)n[3],
                 *p4 = array + 3 * (int64_t)n[4], *p5 = array + 3 * (int64_t)n[5],
                 *p6 = array + 3 * (int64_t)n[6], *p7 = array + 3 * (int64_t)n[7];
    for (int c = 0; c < 3; c++)
      v[per * c + a] = (ct_lanes){p0[c], p1[c], p2[c], p3[c], p4[c], p5[c], p6[c], p7[c]};
#else
    for (int c = 0; c < 3; c++) v[per * c + a] = array[3 * (int64_t)n[0] + c];
#endif
  }
}

/* Where the forces of batch `b` stand: number (3 a + c) of element l at [(3 a + c) * stride + l].
 */
static inline double *ct_batch_values(const ct_solid_part *part, double *values, int32_t b,
                                      int64_t *stride)
{
  *stride = part->ring > 0 ? part->stride : 8;
  return part->ring > 0 ? values + (8 * (int64_t)b & (part->ring - 1))
                        : values + 24 * (int64_t)ct_brick_node_count(part->mesh->kind) * b;
}

/* Write lanes f[component][node] of 8 elements to their place in `values`. */
static inline void ct_store_lanes(const ct_lanes *f, int per, int lane, double *values)
{
  for (int a = 0; a < per; a++)
    for (int c = 0; c < 3; c++)
      *(ct_lanes *)(void *)&values[8 * (3 * a + c) + lane] = f[per * c + a];
}

#endif
