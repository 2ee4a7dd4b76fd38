/* Forces and energies of elements, formula by formula, and the kernels that compute blocks of
 * them.
 * Threads: every call at any time; they write only what they are given. */
#ifndef LIBCONTACT_SOLID_H
#define LIBCONTACT_SOLID_H

#include <libcontact/mesh.h>

CT_BEGIN_DECLS

/** The kernel that computes a block of elements. */
typedef enum ct_solid_kernel {
  /** the cheapest one that fits */
  CT_KERNEL_AUTO = 0,
  /** bricks of any shape: Gauss points, 8 elements at a time */
  CT_KERNEL_GENERAL = 1,
  /**
   * small strain, all rectangular along x, y, z and of one size, hex20 with nodes in the middle of
   * straight edges: the integrals in closed form, :eq:`box-force`, :eq:`box20-force`
   */
  CT_KERNEL_BOX = 2,
  /** one layer of hex8 boxes that is held along its thickness: plane strain, computed in two
     dimensions, :eq:`plane-force` */
  CT_KERNEL_PLANE = 3,
  /** hex8 of any shape with one point and hourglass control, :eq:`reduced-force`; never chosen
     unasked */
  CT_KERNEL_REDUCED = 4
} ct_solid_kernel;

/**
 * Work that the library leaves out where that changes no value, :doc:`/theory/savings`; each 1 or
 * 0. A scene begins with all of them; turn one off to measure what it saves.
 */
typedef struct ct_optimisations {
  /** Elements that nothing has reached are not computed, and their nodes drift as a whole. */
  int sleep;
  /** One layer of bricks held along its thickness is computed in two dimensions. */
  int plane_strain;
  /** Elements of one shape and material share what is stored for them. */
  int shared_stiffness;
  /** Contact surfaces that are too far from each other to touch are not searched. */
  int separated;
} ct_optimisations;

/** One body as the solid effect sees it: its nodes stand at `first_node` of the problem. */
typedef struct ct_solid_body {
  /** Its nodes and elements. */
  const ct_mesh *mesh;
  /** What it is made of. */
  ct_material material;
  /** Number of its first node in the problem. */
  int32_t first_node;
  /** The kernel, or CT_KERNEL_AUTO. */
  ct_solid_kernel kernel;
  /** How the masses were lumped, for the bound on the time step. */
  ct_lumping lumping;
  /** What may be left out in this body, read when the effect is made; null: all. */
  const ct_optimisations *optimisations;
  /** Threads for which room is kept; 0: one. With more threads than that the forces are the same.
   */
  int threads;
  /** Coefficient κ of the hourglass control for CT_KERNEL_REDUCED, :eq:`hourglass-stiffness`; 0:
   * the default. */
  double hourglass;
  /**
   * 1 where a support holds all nodes of the body in this direction at velocity 0: one layer of
   * boxes is then in plane strain, and such motions do not bound the step.
   */
  int held[3];
} ct_solid_body;

/**
 * Stress at all element centres of one mesh, shape (element_count, 6) in the order xx yy zz xy yz
 * zx [stress] (Cauchy's for large deformation); `displacement` has shape (node_count, 3).
 */
CT_API ct_status ct_solid_stress(const ct_mesh *mesh, const ct_material *material,
                                 const double *displacement, double *stress, ct_error *error);

CT_END_DECLS

#endif
