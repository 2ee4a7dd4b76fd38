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
 * Internal force of one element, the readable form: Gauss points one after another,
 * :eq:`internal-force`, and for large deformation :eq:`large-force`. `nodes` (undeformed) and
 * `displacement` and `force` have shape (8 or 20, 3); `force` [force] is what the element does to
 * its nodes. `energy` [energy], :eq:`large-energy`, may be null. ``CT_ERROR_GEOMETRY`` when the
 * deformation turns the element inside out (`error` names the Gauss point).
 */
CT_API ct_status ct_solid_element_force(ct_brick_kind kind, const double *nodes,
                                        const double *displacement, const ct_material *material,
                                        double *force, double *energy, ct_error *error);

/** Stress xx yy zz xy yz zx [stress] of one element at the point ξ, :eq:`hooke`; for large
 * deformation Cauchy's, :eq:`cauchy`. */
CT_API ct_status ct_solid_element_stress(ct_brick_kind kind, const double *nodes,
                                         const double *displacement, const ct_material *material,
                                         const double xi[3], double stress[6], ct_error *error);

/**
 * Upper bound of the largest ω² of one element with its lumped `mass` (8 or 20), the largest
 * eigenvalue of M⁻¹K, :eq:`element-bound` [1 / time²].
 */
CT_API ct_status ct_solid_element_omega2_bound(ct_brick_kind kind, const double *nodes,
                                               const ct_material *material, const double *mass,
                                               double *omega_squared, ct_error *error);

/**
 * The same for the tangent stiffness at a displacement (8 or 20, 3), :eq:`large-tangent`; 0 when no
 * eigenvalue is positive. With the law CT_LINEAR the displacement changes nothing.
 */
CT_API ct_status ct_solid_element_tangent_omega2_bound(ct_brick_kind kind, const double *nodes,
                                                       const double *displacement,
                                                       const ct_material *material,
                                                       const double *mass, double *omega_squared,
                                                       ct_error *error);

/**
 * Force of one hex8 element with one point and hourglass control, the readable form,
 * :eq:`reduced-force`. `nodes`, `displacement` and `force` have shape (8, 3); `hourglass` > 0 is
 * the coefficient κ of :eq:`hourglass-stiffness`. `energy` (may be null) gets the energies of the
 * mean strain and of the hourglass control, :eq:`reduced-energy`. ``CT_ERROR_UNSUPPORTED`` for a
 * law of large deformation.
 */
CT_API ct_status ct_solid_reduced_force(const double *nodes, const double *displacement,
                                        const ct_material *material, double hourglass,
                                        double *force, double energy[2], ct_error *error);

/** Upper bound of the largest ω² of that element with its lumped `mass` (8), :eq:`element-bound` [1
 * / time²]. */
CT_API ct_status ct_solid_reduced_omega2_bound(const double *nodes, const ct_material *material,
                                               double hourglass, const double *mass,
                                               double *omega_squared, ct_error *error);

/** The coefficient κ of the hourglass control when none is given: 1, with which a cube bends as a
 * beam does. */
CT_API double ct_solid_hourglass_default(void);

/**
 * Work that the library leaves out where that changes no value, :doc:`/theory/savings`; each 1 or
 * 0. A scene begins with `ct_optimisations_default`; turn one off to measure what it saves.
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

/** All optimisations on. */
CT_API ct_optimisations ct_optimisations_default(void);

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
  /** What may be left out in this body, read when the effect is made; null: all that
   * `ct_optimisations_default` tells. */
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
