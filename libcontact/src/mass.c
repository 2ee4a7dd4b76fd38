#include <contact/mass.h>
#include <contact/quadrature.h>

#include "assembly.h"
#include "error.h"
#include "jacobian.h"
#include "memory.h"

#include <string.h>

/* Integrals over one element: `row` of ρ N_a, `diagonal` of ρ N_a², both (nodes), and its mass. */
static double integrate(ct_brick_kind kind, double nodes[20][3], double density, const ct_rule *rule, double row[20],
                        double diagonal[20])
{
  int per = ct_brick_node_count(kind), n = rule->count == 8 ? 2 : 3;
  double volume[27] = {0.0}, N[27][20], t[27] = {0.0};
  for (int q = 0; q < rule->count; q++) {
    double dN[20][3], J[3][3], C[3][3];
    ct_brick_shape(kind, rule->xi[q], N[q]);
    ct_brick_gradient(kind, rule->xi[q], dN);
    ct_reference_gradient(per, dN, nodes, J);
    volume[q] = density * (rule->weight[q] * ct_cofactors(J, C));
  }
  for (int a = 0; a < per; a++) {
    for (int q = 0; q < rule->count; q++) t[q] = N[q][a] * volume[q];
    row[a] = ct_tree_points(n, t);
    for (int q = 0; q < rule->count; q++) t[q] = N[q][a] * N[q][a] * volume[q];
    diagonal[a] = ct_tree_points(n, t);
  }
  return ct_tree_points(n, volume);
}

ct_status ct_mass_element(ct_brick_kind kind, const double *nodes, double density, ct_lumping lumping, double *mass,
                          ct_error *error)
{
  int per = ct_brick_node_count(kind);
  ct_rule rule;
  double x[20][3], row[20], diagonal[20];
  if (per == 0 || nodes == NULL || mass == NULL || ct_rule_brick(kind, &rule) != CT_OK)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "mass: null argument or unknown element");
  if (lumping == CT_LUMP_DEFAULT) lumping = kind == CT_HEX8 ? CT_LUMP_ROW_SUM : CT_LUMP_HRZ;
  if (lumping == CT_LUMP_ROW_SUM && kind == CT_HEX20)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "row-sum lumping gives the corners of hex20 the negative mass -1/8; use HRZ");
  memcpy(x, nodes, (size_t)per * sizeof x[0]);
  double total = integrate(kind, x, density, &rule, row, diagonal);
  if (!(total > 0.0)) return ct_fail(error, CT_ERROR_GEOMETRY, CT_NOWHERE, "mass: the element has mass %g", total);

  // -- Scale the diagonal to the element's mass (eq:hrz)
  double trace = ct_tree_nodes(per, diagonal, 1);
  for (int a = 0; a < per; a++) mass[a] = lumping == CT_LUMP_ROW_SUM ? row[a] : diagonal[a] * (total / trace);
  return CT_OK;
}

ct_status ct_mass_lumped(const ct_mesh *mesh, double density, ct_lumping lumping, double *mass, ct_error *error)
{
  ct_assembly *assembly = NULL;
  if (mesh == NULL || mass == NULL) return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "mass: null argument");
  ct_status status = ct_assembly_create(mesh, 1, &assembly, error);
  if (status != CT_OK) return status;
  double *values = ct_allocate((size_t)assembly->value_count, sizeof *values);
  if (values == NULL) status = ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the masses");

  int per = ct_brick_node_count(mesh->kind);
  for (int32_t e = 0; status == CT_OK && e < mesh->element_count; e++) {
    double x[20][3], m[20];
    for (int a = 0; a < per; a++)
      memcpy(x[a], &mesh->nodes[3 * (size_t)mesh->elements[(size_t)e * (size_t)per + (size_t)a]], sizeof x[a]);
    status = ct_mass_element(mesh->kind, &x[0][0], density, lumping, m, error);
    if (status != CT_OK && error != NULL) error->element = e;
    for (int a = 0; status == CT_OK && a < per; a++) values[(e / 8 * per + a) * 8 + e % 8] = m[a];
  }
  if (status == CT_OK) {
    ct_assembly_fold(assembly, values);
    ct_assembly_gather(assembly, values, 0, mesh->node_count, mass);
  }
  ct_release(values);
  ct_assembly_free(assembly);
  return status;
}
