#include "assembly.h"

#include "../base/error.h"
#include "../base/memory.h"
#include "mesh_internal.h"

void ct_assembly_free(ct_assembly *assembly) { ct_pool_free(assembly); }

static void add_extra(ct_assembly *assembly, int32_t to, int32_t from)
{
  if (assembly->extra_to != NULL) {
    assembly->extra_to[assembly->extra_count] = to;
    assembly->extra_from[assembly->extra_count] = from;
  }
  assembly->extra_count++;
}

/* Enter each element into its slots. A slot with several elements is moved to a cell; the number of
 * terms of the cells is counted, and they are listed if there is a list. */
static void fill_places(const ct_mesh *mesh, ct_assembly *assembly)
{
  int per = ct_brick_node_count(mesh->kind), slot[20], width = 8 * assembly->components;
  int32_t zero = (int32_t)assembly->element_values, first_cell = zero + width;
  for (int a = 0; a < per; a++) slot[a] = ct_brick_octant(mesh->kind, a);
  for (size_t i = 0; i < 8 * (size_t)mesh->node_count; i++) assembly->place[i] = zero;
  assembly->extra_count = assembly->cell_count = 0;
  // -- Enter each element into its slots; a slot with several elements becomes a cell
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int a = 0; a < per; a++) {
      int32_t place = (e / 8 * per + a) * width + e % 8;
      int32_t node = mesh->elements[(size_t)e * (size_t)per + (size_t)a];
      int32_t *entry = &assembly->place[8 * (size_t)node + (size_t)slot[a]];
      if (*entry == zero) {
        *entry = place;
        continue;
      }
      if (*entry < zero) {
        int32_t cell = first_cell + (int32_t)(assembly->cell_count / 8) * width +
                       (int32_t)(assembly->cell_count % 8);
        assembly->cell_count++;
        add_extra(assembly, cell, *entry);
        *entry = cell;
      }
      add_extra(assembly, *entry, place);
    }
  assembly->value_count = first_cell + (assembly->cell_count + 7) / 8 * width;
}

ct_status ct_assembly_create(const ct_mesh *mesh, int components, ct_assembly **out,
                             ct_error *error)
{
  int per = ct_brick_node_count(mesh->kind);
  ct_status status = ct_mesh_check_numbers(mesh, error);
  if (status != CT_OK) return status;
  int64_t values = ((int64_t)mesh->element_count + 7) / 8 * 8 * per * components;
  if (values > INT32_MAX / 4)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "a mesh of %d elements is too large to assemble; at most about %lld fit",
                   (int)mesh->element_count, (long long)INT32_MAX / 4 / per / components);
  ct_assembly *assembly = ct_allocate(1, sizeof *assembly);
  if (assembly == NULL) return CT_NO_MEMORY(error, "the assembly");
  ct_pool *pool = &assembly->pool;
  assembly->node_count = mesh->node_count;
  assembly->components = components;
  assembly->element_values = values;
  assembly->place = ct_pool_take(pool, 8 * (size_t)mesh->node_count, sizeof(int32_t));
  if (assembly->place != NULL) fill_places(mesh, assembly);
  assembly->extra_to = ct_pool_take(pool, (size_t)assembly->extra_count, sizeof(int32_t));
  assembly->extra_from = ct_pool_take(pool, (size_t)assembly->extra_count, sizeof(int32_t));
  if (pool->failed) {
    ct_assembly_free(assembly);
    return CT_NO_MEMORY(error, "the assembly");
  }
  fill_places(mesh, assembly);
  *out = assembly;
  return CT_OK;
}

void ct_assembly_fold(const ct_assembly *assembly, double *values)
{
  int64_t first_cell = assembly->element_values + 8 * assembly->components;
  for (int64_t i = first_cell; i < assembly->value_count; i++) values[i] = 0.0;
  for (int64_t i = 0; i < assembly->extra_count; i++)
    for (int c = 0; c < assembly->components; c++)
      values[assembly->extra_to[i] + 8 * c] += values[assembly->extra_from[i] + 8 * c];
}

void ct_assembly_gather(const ct_assembly *assembly, const double *values, int32_t first,
                        int32_t last, double *sums)
{
  int components = assembly->components;
  for (int32_t i = first; i < last; i++) {
    const int32_t *p = &assembly->place[8 * (size_t)i];
    // -- Pair the octants along ξ, then η, then ζ
    for (int c = 0; c < components; c++) {
      const double *v = &values[8 * c];
      sums[components * (int64_t)i + c] = // (eq:tree-sum)
          ((v[p[0]] + v[p[1]]) + (v[p[2]] + v[p[3]])) + ((v[p[4]] + v[p[5]]) + (v[p[6]] + v[p[7]]));
    }
  }
}
