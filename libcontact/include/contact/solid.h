#ifndef CONTACT_SOLID_H
#define CONTACT_SOLID_H

#include <contact/effect.h>
#include <contact/mass.h>
#include <contact/material.h>
#include <contact/mesh.h>

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
CT_API ct_status ct_solid_element_frequency(ct_brick_kind kind, const double *nodes,
                                            const ct_material *material, const double *mass,
                                            double *omega_squared, ct_error *error);

/**
 * The same for the tangent stiffness at a displacement (8 or 20, 3), :eq:`large-tangent`; 0 when no
 * eigenvalue is positive. With the law CT_LINEAR the displacement changes nothing.
 */
CT_API ct_status ct_solid_element_tangent_frequency(ct_brick_kind kind, const double *nodes,
                                                    const double *displacement,
                                                    const ct_material *material, const double *mass,
                                                    double *omega_squared, ct_error *error);

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
CT_API ct_status ct_solid_reduced_frequency(const double *nodes, const ct_material *material,
                                            double hourglass, const double *mass,
                                            double *omega_squared, ct_error *error);

/** The coefficient κ of the hourglass control when none is given: 1, with which a cube bends as a
 * beam does. */
CT_API double ct_solid_hourglass_default(void);

/** One body as the solid effect sees it: its nodes stand at `first_node` of the problem. */
typedef struct ct_solid_block {
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
   * `ct_savings_default` tells. */
  const ct_savings *savings;
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
} ct_solid_block;

/**
 * The solid effect of all bodies: `blocks` (block_count) in ascending order of `first_node` without
 * gaps. Meshes must outlive the effect. ``CT_ERROR_UNSUPPORTED`` when a kernel is asked for that
 * does not fit its block. Under a law for large deformation its force fails with
 * ``CT_ERROR_GEOMETRY``, body and element, as soon as an element is turned inside out, and its
 * bound on the step is that of the tangent.
 */
CT_API ct_status ct_solid_create_effect(const ct_solid_block *blocks, int32_t block_count,
                                        ct_effect **effect, ct_error *error);

/**
 * The effect "hourglass" of a solid effect with blocks of CT_KERNEL_REDUCED: it has no force of its
 * own (the solid effect's holds it), and its stored energy is that of the hourglass control, which
 * the energy of the solid effect leaves out. Null, with CT_OK, when no block is of that kind. The
 * solid effect must outlive it.
 */
CT_API ct_status ct_solid_create_hourglass(const ct_effect *solid, ct_effect **effect,
                                           ct_error *error);

/** The kernel that the effect chose for a block, and the floating-point operations and bytes of one
 * update of one element. */
CT_API ct_status ct_solid_block_plan(const ct_effect *effect, int32_t block,
                                     ct_solid_kernel *kernel, double *flops, double *bytes);

/**
 * Stress at all element centres of one mesh, shape (element_count, 6) in the order xx yy zz xy yz
 * zx [stress] (Cauchy's for large deformation); `displacement` has shape (node_count, 3).
 */
CT_API ct_status ct_solid_stress(const ct_mesh *mesh, const ct_material *material,
                                 const double *displacement, double *stress, ct_error *error);

CT_END_DECLS

#endif
