/* Stresses at the centres of all elements, eight elements at a time. */
#include <libcontact/shape.h>
#include <libcontact/solid.h>

#include "../base/error.h"
#include "element.h"
#include "kernel.h"
#include "point.h"

/* Determinants and displacement gradients at the point where the shape functions have the
 * derivatives dN, from coordinates and displacements v[component][node], in the order of sums of
 * ct_solid_element_stress. */
CT_INLINE void gradients(int per, const double (*dN)[3], ct_lanes *x, ct_lanes *u, ct_lanes *det,
                         ct_lanes G[3][3])
{
  ct_lanes J[3][3], C[3][3], H[3][3], unused;
  ct_lanes_centre(per, x);
  ct_lanes_centre(per, u);
  ct_lanes_jacobian(per, dN, x, J, &unused);
  ct_lanes_jacobian(per, dN, u, H, &unused);
  ct_lanes_cofactors(J, C, det);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      G[i][j] = ((H[i][0] * C[j][0] + H[i][1] * C[j][1]) + H[i][2] * C[j][2]) / *det;
}

/* The elements of a batch from `lane` on: their gradients and determinants, and Hooke's stress
 * (eq:hooke). */
CT_CLONES_RARE
static void stress_lanes(const ct_mesh *mesh, int32_t batch, int lane, const double (*dN)[3],
                         const double lame[2], const double *displacement, ct_lanes *det,
                         ct_lanes G[3][3], ct_lanes stress[6])
{
  ct_lanes x[3 * 20], u[3 * 20];
  int per = ct_brick_node_count(mesh->kind);
  ct_load_lanes(mesh, NULL, batch, per, mesh->nodes, lane, x);
  ct_load_lanes(mesh, NULL, batch, per, displacement, lane, u);
  if (per == 8) gradients(8, dN, x, u, det, G);
  else gradients(20, dN, x, u, det, G);
  ct_lanes trace = (G[0][0] + G[1][1]) + G[2][2];
  for (int k = 0; k < 6; k++) {
    int i = k % 3, j = k < 3 ? i : (i + 1) % 3;
    stress[k] = lame[1] * (G[i][j] + G[j][i]);
    if (k < 3) stress[k] = stress[k] + lame[0] * trace;
  }
}

/* The stress of one lane; laws of large deformation are computed element by element. */
static ct_status take_lane(const ct_material *material, int lane, const ct_lanes *det,
                           ct_lanes (*G)[3], const ct_lanes *s, double stress[6], ct_error *error)
{
  double own[3][3];
  if (!(((const double *)(const void *)det)[lane] > 0.0))
    return ct_fail(error, CT_ERROR_GEOMETRY, CT_NOWHERE, "the element is inverted or collapsed");
  if (material->law == CT_LINEAR) {
    for (int k = 0; k < 6; k++) stress[k] = ((const double *)(const void *)&s[k])[lane];
    return CT_OK;
  }
  for (int i = 0; i < 9; i++)
    own[i / 3][i % 3] = ((const double *)(const void *)&G[i / 3][i % 3])[lane];
  return ct_element_cauchy(material, own, stress, error);
}

ct_status ct_solid_stress(const ct_mesh *mesh, const ct_material *material,
                          const double *displacement, double *stress, ct_error *error)
{
  static const double centre[3] = {0.0, 0.0, 0.0};
  if (mesh == NULL || displacement == NULL || stress == NULL) return CT_REFUSE_NULL(error);
  double dN[20][3], lame[2];
  ct_status status = ct_material_check(material, error);
  if (status == CT_OK) status = ct_mesh_check_numbers(mesh, error);
  if (status != CT_OK) return status;
  ct_brick_gradient(mesh->kind, centre, dN);
  ct_material_lame(material, &lame[0], &lame[1]);
  for (int32_t e = 0; e < mesh->element_count; e += CT_LANES_COUNT) {
    ct_lanes det, G[3][3], s[6];
    stress_lanes(mesh, e / 8, e % 8, (const double (*)[3])dN, lame, displacement, &det, G, s);
    for (int32_t l = 0; l < CT_LANES_COUNT && e + l < mesh->element_count; l++) {
      status = take_lane(material, l, &det, G, s, &stress[6 * (int64_t)(e + l)], error);
      if (status != CT_OK && error != NULL) error->element = e + l;
      if (status != CT_OK) return status;
    }
  }
  return CT_OK;
}
