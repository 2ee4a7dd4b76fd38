#include <libcontact/mesh.h>

#include "assembly.h"
#include "mesh_internal.h"
#include "../base/error.h"
#include "../shape/jacobian.h"
#include "../base/memory.h"

#include <string.h>

/* What is the same for all elements: the shape functions and their derivatives at the points of the
 * rule. */
typedef struct shapes {
  int per;
  ct_rule rule;
  double N[27][20], dN[27][20][3];
} shapes;

static ct_status tabulate(ct_brick_kind kind, shapes *out)
{
  out->per = ct_brick_node_count(kind);
  ct_status status = ct_rule_brick(kind, &out->rule);
  for (int q = 0; status == CT_OK && q < out->rule.count; q++) {
    ct_brick_shape(kind, out->rule.xi[q], out->N[q]);
    ct_brick_gradient(kind, out->rule.xi[q], out->dN[q]);
  }
  return status;
}

/* Integrals over one element: `row` of ρ N_a, `diagonal` of ρ N_a² (if not null), both (nodes), and
 * its mass. */
static double integrate(shapes *at, double nodes[20][3], double density, double row[20],
                        double *diagonal)
{
  const ct_rule *rule = &at->rule;
  int per = at->per, n = rule->count == 8 ? 2 : 3;
  double volume[27] = {0.0}, (*N)[20] = at->N, t[27] = {0.0}, J[3][3], C[3][3];
  for (int q = 0; q < rule->count; q++) {
    ct_reference_gradient(per, at->dN[q], nodes, J);
    volume[q] = density * (rule->weight[q] * ct_cofactors(J, C));
  }
  for (int a = 0; a < per; a++) {
    for (int q = 0; q < rule->count; q++) t[q] = N[q][a] * volume[q];
    row[a] = ct_tree_points(n, t);
    if (diagonal == NULL) continue;
    for (int q = 0; q < rule->count; q++) t[q] = N[q][a] * N[q][a] * volume[q];
    diagonal[a] = ct_tree_points(n, t);
  }
  return ct_tree_points(n, volume);
}

static ct_status lump(shapes *at, const double *nodes, double density, ct_lumping lumping,
                      double *mass, ct_error *error)
{
  double x[20][3], row[20], diagonal[20];
  int hrz = lumping == CT_LUMP_HRZ || (lumping == CT_LUMP_DEFAULT && at->per == 20);
  if (!hrz && at->per == 20)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "row-sum lumping gives the corners of hex20 the negative mass -1/8; use HRZ");
  memcpy(x, nodes, (size_t)at->per * sizeof x[0]);
  double total = integrate(at, x, density, row, hrz ? diagonal : NULL);
  if (!(total > 0.0))
    return ct_fail(error, CT_ERROR_GEOMETRY, CT_NOWHERE, "mass: the element has mass %g", total);

  // -- Scale the diagonal to the element's mass (eq:hrz)
  double trace = hrz ? ct_tree_nodes(at->per, diagonal, 1) : 1.0;
  for (int a = 0; a < at->per; a++) mass[a] = hrz ? diagonal[a] * (total / trace) : row[a];
  return CT_OK;
}

ct_status ct_mass_element(ct_brick_kind kind, const double *nodes, double density,
                          ct_lumping lumping, double *mass, ct_error *error)
{
  shapes at;
  if (ct_brick_node_count(kind) == 0 || nodes == NULL || mass == NULL ||
      tabulate(kind, &at) != CT_OK)
    return CT_REFUSE(error, "mass: null argument or unknown element");
  return lump(&at, nodes, density, lumping, mass, error);
}

ct_status ct_mass_lumped(const ct_mesh *mesh, double density, ct_lumping lumping, double *mass,
                         ct_error *error)
{
  ct_assembly *assembly = NULL;
  if (mesh == NULL || mass == NULL) return CT_REFUSE(error, "mass: null argument");
  ct_status status = ct_assembly_create(mesh, 1, &assembly, error);
  if (status != CT_OK) return status;
  double *values = ct_allocate((size_t)assembly->value_count, sizeof *values);
  if (values == NULL) status = CT_NO_MEMORY(error, "the masses");
  shapes at;
  if (status == CT_OK) status = tabulate(mesh->kind, &at);

  int per = ct_brick_node_count(mesh->kind);
  for (int32_t e = 0; status == CT_OK && e < mesh->element_count; e++) {
    double x[20][3], m[20];
    for (int a = 0; a < per; a++)
      memcpy(x[a], &mesh->nodes[3 * (size_t)mesh->elements[(size_t)e * (size_t)per + (size_t)a]],
             sizeof x[a]);
    status = lump(&at, &x[0][0], density, lumping, m, error);
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
