#ifndef CONTACT_MATERIAL_H
#define CONTACT_MATERIAL_H

#include <contact/status.h>

CT_BEGIN_DECLS

/** How stress follows from deformation; all three laws agree with Hooke's where strain and rotation
 * are small. */
typedef enum ct_law {
  /** small strain and small rotation, :eq:`hooke` */
  CT_LINEAR = 0,
  /** St. Venant-Kirchhoff, :eq:`st-venant-kirchhoff`: any rotation, moderate strain; it gives way
     under strong compression */
  CT_ST_VENANT_KIRCHHOFF = 1,
  /** compressible neo-Hookean, :eq:`neo-hookean`: any rotation, large strain */
  CT_NEO_HOOKEAN = 2
} ct_law;

/** An isotropic elastic material, in one consistent set of units. */
typedef struct ct_material {
  /** Young's modulus E [stress], > 0. */
  double young;
  /** Poisson's ratio ν [-], -1 < ν < 1/2. */
  double poisson;
  /** Density ρ [mass / volume] of the undeformed body, > 0. */
  double density;
  /** The law; 0 is small strain. */
  ct_law law;
} ct_material;

/** Lamé's constants Λ and μ [stress], :eq:`lame`. */
CT_API void ct_material_lame(const ct_material *material, double *lambda, double *mu);

/** Speeds of the dilatation wave c₁ and of the transversal wave c₂ [length / time],
 * :eq:`wave-speeds`. */
CT_API void ct_material_speeds(const ct_material *material, double *c1, double *c2);

/** Refuse impossible constants: ``CT_ERROR_ARGUMENT`` with the constant's name and value in
 * `error`. */
CT_API ct_status ct_material_check(const ct_material *material, ct_error *error);

CT_END_DECLS

#endif
