#ifndef CONTACT_MATERIAL_H
#define CONTACT_MATERIAL_H

#include <contact/status.h>

/** An isotropic linear elastic material, in one consistent set of units. */
typedef struct ct_material {
  /** Young's modulus E [stress], > 0. */
  double young;
  /** Poisson's ratio ν [-], -1 < ν < 1/2. */
  double poisson;
  /** Density ρ [mass / volume], > 0. */
  double density;
} ct_material;

/** Lamé's constants Λ and μ [stress], :eq:`lame`. */
CT_API void ct_material_lame(const ct_material *material, double *lambda, double *mu);

/** Speeds of the dilatation wave c₁ and of the transversal wave c₂ [length / time], :eq:`wave-speeds`. */
CT_API void ct_material_speeds(const ct_material *material, double *c1, double *c2);

/** Refuse impossible constants: ``CT_ERROR_ARGUMENT`` with the constant's name and value in `error`. */
CT_API ct_status ct_material_check(const ct_material *material, ct_error *error);

#endif
