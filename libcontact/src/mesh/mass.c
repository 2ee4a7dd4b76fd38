#include <libcontact/mesh.h>

#include "mass.h"
#include "mesh_internal.h"
#include "../base/error.h"
#include "../base/memory.h"
#include "../base/threads.h"

#include <string.h>

ct_status ct_mass_tabulate(ct_brick_kind kind, ct_lumping lumping, ct_mass_shapes *out,
                           ct_error *error)
{
  const ct_brick_facts *facts = ct_brick_facts_of(kind);
  out->per = ct_brick_node_count(kind);
  if (ct_rule_brick(kind, &out->rule) != CT_OK)
    return CT_REFUSE(error, "mass: there is no brick of the kind %d", (int)kind);
  out->hrz = lumping == CT_LUMP_HRZ || (lumping == CT_LUMP_DEFAULT && !facts->row_sum);
  if (!out->hrz && !facts->row_sum)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "row-sum lumping gives nodes of %s a negative mass; use HRZ", facts->name);
  for (int q = 0; q < out->rule.count; q++) {
    ct_brick_shape(kind, out->rule.xi[q], out->N[q]);
    ct_brick_gradient(kind, out->rule.xi[q], out->dN[q]);
  }
  return CT_OK;
}

/* Sum over the n x n x n Gauss points, ξ fastest; on each line first the ends, then the middle. */
CT_INLINE void sum_points(int count, const ct_lanes *t, ct_lanes *sum)
{
  ct_lanes line[9], plane[3];
  int n = count == 8 ? 2 : 3;
  for (int k = 0; k < n * n; k++)
    line[k] = n == 2 ? t[2 * k] + t[2 * k + 1] : (t[3 * k] + t[3 * k + 2]) + t[3 * k + 1];
  for (int k = 0; k < n; k++)
    plane[k] =
        n == 2 ? line[2 * k] + line[2 * k + 1] : (line[3 * k] + line[3 * k + 2]) + line[3 * k + 1];
  *sum = n == 2 ? plane[0] + plane[1] : (plane[0] + plane[2]) + plane[1];
}

/* Integrals over the elements of a batch with the coordinates x[component][node], which are
 * overwritten: `row` of ρ N_a, `diagonal` of ρ N_a² (with scaling), both (nodes), and their masses.
 */
CT_INLINE void integrate(const ct_mass_shapes *at, int per, ct_lanes *x, const ct_lanes *density,
                         ct_lanes *row, ct_lanes *diagonal, ct_lanes *total)
{
  int points = per == 8 ? 8 : 27;
  ct_lanes volume[27], t[27], J[3][3], det;
  ct_lanes_centre(per, x);
  for (int q = 0; q < points; q++) {
    ct_lanes_jacobian(per, at->dN[q], x, J, &det);
    volume[q] = *density * (at->rule.weight[q] * det);
  }
  // -- Integrals of ρ N_a, and of ρ N_a² where the diagonal is scaled
  for (int a = 0; a < per; a++) {
    // Σ_q N_a ρ w det J (eq:row-sum)
    for (int q = 0; q < points; q++) t[q] = at->N[q][a] * volume[q];
    sum_points(points, t, &row[a]);
    for (int q = 0; at->hrz && q < points; q++) t[q] = at->N[q][a] * at->N[q][a] * volume[q];
    if (at->hrz) sum_points(points, t, &diagonal[a]);
  }
  sum_points(points, volume, total);
}

CT_INLINE void lump(const ct_mass_shapes *at, int per, ct_lanes *x, const ct_lanes *density,
                    ct_lanes *mass, ct_lanes *total)
{
  ct_lanes diagonal[20], trace;
  integrate(at, per, x, density, mass, diagonal, total);
  if (!at->hrz) return;
  // -- Scale the diagonal to the element's mass (eq:hrz)
  ct_lanes_nodes(per, diagonal, &trace);
  for (int a = 0; a < per; a++) mass[a] = diagonal[a] * (*total / trace);
}

CT_CLONES_RARE
void ct_mass_lanes(const ct_mass_shapes *at, ct_lanes *x, const ct_lanes *density, ct_lanes *mass,
                   ct_lanes *total)
{
  if (at->per == 8) lump(at, 8, x, density, mass, total);
  else lump(at, 20, x, density, mass, total);
}

static ct_status check_mass(double total, int64_t element, ct_error *error)
{
  if (total > 0.0) return CT_OK;
  return ct_fail(error, CT_ERROR_GEOMETRY, (ct_place){-1, element, -1},
                 "mass: an element has the mass %g, which must be positive", total);
}

ct_status ct_mass_element(ct_brick_kind kind, const double *nodes, double density,
                          ct_lumping lumping, double *mass, ct_error *error)
{
  ct_mass_shapes at;
  ct_lanes x[3 * 20], m[20], total, rho;
  double first;
  if (nodes == NULL || mass == NULL) return CT_REFUSE_NULL(error);
  ct_status status = ct_mass_tabulate(kind, lumping, &at, error);
  if (status != CT_OK) return status;
  for (int i = 0; i < 3 * at.per; i++)
    for (size_t l = 0; l < CT_LANES_COUNT; l++)
      memcpy((double *)(void *)&x[at.per * (i % 3) + i / 3] + l, &nodes[i], sizeof *nodes);
  ct_lanes_fill(density, &rho);
  ct_mass_lanes(&at, x, &rho, m, &total);
  memcpy(&first, &total, sizeof first);
  status = check_mass(first, -1, error);
  for (int a = 0; status == CT_OK && a < at.per; a++) memcpy(&mass[a], &m[a], sizeof *mass);
  return status;
}

/* The masses of boxes along the axes, an eighth of the element's mass at each node for any lumping;
 * returns 0 if there are other elements. */
CT_CLONES_RARE
static int box_masses(const ct_lanes *x, const double density[CT_LANES_COUNT],
                      double mass[20][CT_LANES_COUNT], double total[CT_LANES_COUNT])
{
  if (!ct_upright_boxes(x, total)) return 0;
  for (int l = 0; l < CT_LANES_COUNT; l++) {
    total[l] *= density[l];
    for (int a = 0; a < 8; a++) mass[a][l] = 0.125 * total[l];
  }
  return 1;
}

/* Whether elements have a node among first ... last - 1. */
static int have_nodes(const int32_t *nodes, int64_t count, int32_t first, int32_t last)
{
  int some = 0;
  for (int64_t i = 0; i < count; i++) some |= (nodes[i] >= first) & (nodes[i] < last);
  return some;
}

/* The densities of `count` elements from `e` on, one per lane; the last ones repeat the last. */
static void take_densities(double density, const ct_material *materials, int32_t e, int32_t count,
                           double rho[CT_LANES_COUNT])
{
  for (int32_t l = 0; l < CT_LANES_COUNT; l++)
    rho[l] = materials != NULL ? materials[e + (l < count ? l : count - 1)].density : density;
}

/* Add the masses of the nodes first ... last - 1 by octant, from all elements with some of these
 * nodes. */
static ct_status fill_octants(const ct_mesh *mesh, const ct_mass_shapes *at, double density,
                              const ct_material *materials, int32_t first, int32_t last,
                              double (*octant)[8], ct_error *error)
{
  int slot[20], per = at->per;
  for (int a = 0; a < per; a++) slot[a] = ct_brick_octant(mesh->kind, a);
  for (int32_t e = 0; e < mesh->element_count; e += CT_LANES_COUNT) {
    ct_lanes x[3 * 20], m[20], total, lanes;
    int32_t left = mesh->element_count - e, count = left < CT_LANES_COUNT ? left : CT_LANES_COUNT;
    if (!have_nodes(&mesh->elements[(int64_t)per * e], (int64_t)per * count, first, last)) continue;
    double mass[20][CT_LANES_COUNT], sum[CT_LANES_COUNT], rho[CT_LANES_COUNT];
    take_densities(density, materials, e, count, rho);
    ct_load_lanes(mesh, NULL, e / 8, per, mesh->nodes, e % 8, x);
    if (per != 8 || !box_masses(x, rho, mass, sum)) {
      memcpy(&lanes, rho, sizeof lanes);
      ct_mass_lanes(at, x, &lanes, m, &total);
      memcpy(mass, m, (size_t)per * sizeof *m);
      memcpy(sum, &total, sizeof sum);
    }
    for (int32_t l = 0; l < count; l++) {
      const int32_t *node = &mesh->elements[(size_t)per * (size_t)(e + l)];
      ct_status status = check_mass(sum[l], e + l, error);
      if (status != CT_OK) return status;
      for (int a = 0; a < per; a++)
        if (node[a] >= first && node[a] < last) octant[node[a]][slot[a]] += mass[a][l];
    }
  }
  return CT_OK;
}

ct_status ct_mass_lumped(const ct_mesh *mesh, double density, ct_lumping lumping, double *mass,
                         ct_error *error)
{
  return ct_mass_of_materials(mesh, density, NULL, lumping, mass, error);
}

ct_status ct_mass_of_materials(const ct_mesh *mesh, double density, const ct_material *materials,
                               ct_lumping lumping, double *mass, ct_error *error)
{
  ct_mass_shapes at;
  if (mesh == NULL || mass == NULL) return CT_REFUSE_NULL(error);
  ct_status status = ct_mesh_check_numbers(mesh, error);
  if (status == CT_OK) status = ct_mass_tabulate(mesh->kind, lumping, &at, error);
  if (status != CT_OK) return status;
  double (*octant)[8] = ct_allocate((size_t)mesh->node_count, sizeof *octant);
  if (octant == NULL) return CT_NO_MEMORY(error, "the masses");
  // Each thread has a part of the nodes; elements between two parts are lumped twice.
  int failed = 0,
      threads = ct_threads_for(ct_threads_of(mesh->settings), mesh->node_count, CT_LEAST_OF_MESH);
#ifdef _OPENMP
#pragma omp parallel for num_threads(threads) schedule(static, 1) \
    reduction(| : failed) if (threads > 1)
#endif
  for (int share = 0; share < threads; share++)
    failed |=
        fill_octants(mesh, &at, density, materials, ct_share(mesh->node_count, share, threads),
                     ct_share(mesh->node_count, share + 1, threads), octant, NULL) != CT_OK;
  if (failed)
    status = fill_octants(mesh, &at, density, materials, 0, mesh->node_count, octant, error);
  // -- Pair the octants along ξ, then η, then ζ (eq:tree-sum)
  for (int32_t n = 0; status == CT_OK && n < mesh->node_count; n++) {
    const double *m = octant[n];
    mass[n] = ((m[0] + m[1]) + (m[2] + m[3])) + ((m[4] + m[5]) + (m[6] + m[7]));
  }
  ct_release(octant);
  return status;
}
