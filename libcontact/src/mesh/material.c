#include "../base/error.h"
#include "mesh_internal.h"

#include <math.h>
#include <string.h>

void ct_material_lame(const ct_material *material, double *lambda, double *mu)
{
  double E = material->young, nu = material->poisson;
  // -- Lamé's constants (eq:lame)
  *lambda = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
  *mu = E / (2.0 * (1.0 + nu));
}

void ct_material_speeds(const ct_material *material, double *c1, double *c2)
{
  double lambda, mu;
  ct_material_lame(material, &lambda, &mu);
  // -- Wave speeds (eq:wave-speeds)
  *c1 = sqrt((lambda + 2.0 * mu) / material->density);
  *c2 = sqrt(mu / material->density);
}

ct_status ct_material_check(const ct_material *material, ct_error *error)
{
  if (material == NULL) return CT_REFUSE(error, "no material");
  // -- Range of the constants of a solid (eq:material-range)
  if (!(material->young > 0.0) || !isfinite(material->young))
    return CT_REFUSE(error, "Young's modulus must be positive, not %g", material->young);
  if (!(material->poisson > -1.0 && material->poisson < 0.5))
    return CT_REFUSE(error, "Poisson's ratio must lie in -1 < nu < 1/2, not %g", material->poisson);
  if (!(material->density > 0.0) || !isfinite(material->density))
    return CT_REFUSE(error, "density must be positive, not %g", material->density);
  if ((int)material->law < CT_LINEAR || material->law >= CT_LAW_COUNT)
    return CT_REFUSE(error, "there is no material law %d", (int)material->law);
  return CT_OK;
}

ct_status ct_materials_check(const ct_material *materials, int32_t count, int32_t *stiffest,
                             ct_error *error)
{
  double largest = 0.0;
  *stiffest = 0;
  for (int32_t e = 0; e < count; e++) {
    double c1, c2;
    // Most elements have the material of the one before.
    if (e > 0 && memcmp(&materials[e], &materials[e - 1], sizeof *materials) == 0) continue;
    ct_status status = ct_material_check(&materials[e], error);
    if (status == CT_OK && materials[e].law != materials[0].law)
      status =
          CT_REFUSE(error, "element %d has another law than element 0; a body has one law", (int)e);
    if (status != CT_OK) {
      if (error != NULL) error->element = e;
      return status;
    }
    ct_material_speeds(&materials[e], &c1, &c2);
    if (c1 > largest) largest = c1, *stiffest = e;
  }
  return CT_OK;
}
