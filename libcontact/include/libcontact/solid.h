/* Definition of the bodies of the solid effect, the kernels that compute their elements, and the
 * stress of a mesh.
 * Threads: every call is safe at any time; a call writes only its output arguments. */
#ifndef LIBCONTACT_SOLID_H
#define LIBCONTACT_SOLID_H

#include <libcontact/mesh.h>

CT_BEGIN_DECLS

/** The kernel that computes the elements of a body. */
typedef enum ct_solid_kernel {
  /** the cheapest kernel that can compute the body */
  CT_KERNEL_AUTO = 0,
  /** bricks of any shape: Gauss points, 8 elements at a time */
  CT_KERNEL_GENERAL = 1,
  /**
   * small strain, equal rectangular boxes along x, y, z, hex20 with mid-side nodes at the midpoints
   * of straight edges: integrals in closed form, :eq:`box-force`, :eq:`box20-force`
   */
  CT_KERNEL_BOX = 2,
  /** one layer of hex8 boxes that is fixed along its thickness: plane strain, computed in two
     dimensions, :eq:`plane-force` */
  CT_KERNEL_PLANE = 3,
  /** hex8 of any shape with one Gauss point and hourglass control, :eq:`reduced-force`;
     CT_KERNEL_AUTO does not choose it */
  CT_KERNEL_REDUCED = 4,
  /** no forces: a rigid body, whose shape `ct_rigid_create_effect` keeps; CT_KERNEL_AUTO does not
     choose it */
  CT_KERNEL_RIGID = 5
} ct_solid_kernel;

/**
 * Optimisations: work that the library skips where that changes no value, :doc:`/theory/savings`;
 * each 1 (on) or 0 (off). In a scene all are on by default; turn one off to measure what it saves.
 */
typedef struct ct_optimisations {
  /** Elements that no wave and no force has reached are not computed; their nodes move as a rigid
   * body. */
  int sleep;
  /** One layer of bricks that is fixed along its thickness is computed in two dimensions. */
  int plane_strain;
  /** Elements of equal shape and material share their stored data. */
  int shared_stiffness;
} ct_optimisations;

/** One body of the solid effect; its nodes begin at `first_node` of the problem. */
typedef struct ct_solid_body {
  /** Its nodes and elements. */
  const ct_mesh *mesh;
  /** Its material, or the stiffest of `materials`. */
  ct_material material;
  /** Number of its first node in the problem. */
  int32_t first_node;
  /** The kernel, or CT_KERNEL_AUTO. */
  ct_solid_kernel kernel;
  /** Method of mass lumping, needed for the bound on the time step. */
  ct_lumping lumping;
  /** Optimisations of this body, read when the effect is created; null: all are on. */
  const ct_optimisations *optimisations;
  /** Coefficient Q of the hourglass control for CT_KERNEL_REDUCED [-], :eq:`hourglass-stiffness`;
   * 0: the default. */
  double hourglass;
  /**
   * 1 for each direction in which a support fixes all nodes of the body (velocity 0). One layer of
   * boxes is then in plane strain, and motions in this direction do not limit the step.
   */
  int fixed[3];
  /** Null, or the material of each element, shape (element_count), all with one law. They must live
   * as long as the effect. */
  const ct_material *materials;
} ct_solid_body;

/**
 * Write the stress at all element centres of one mesh, shape (element_count, 6) in the order xx yy
 * zz xy yz zx [stress] (Cauchy stress for large deformation). `displacement` [length] has the shape
 * (node_count, 3). ``CT_ERROR_ARGUMENT``: null argument; ``CT_ERROR_GEOMETRY``: an inverted element
 * (`error` names it).
 */
CT_API ct_status ct_solid_stress(const ct_mesh *mesh, const ct_material *material,
                                 const double *displacement, double *stress, ct_error *error);

CT_END_DECLS

#endif
