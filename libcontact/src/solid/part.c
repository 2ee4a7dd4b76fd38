/* One body of the solid effect: which kernel computes it, and what is laid down for that. */
#include "part.h"

#include <libcontact/shape.h>

#include "../base/error.h"
#include "../base/memory.h"
#include "lattice.h"
#include "plane.h"
#include "reduced.h"
#include "sleep.h"

#include <math.h>
#include <string.h>

/* Which function computes a block, and the operations of one element counted in it. The first row
 * that fits is taken. */
static const struct kernel_row {
  ct_solid_kernel kernel;
  ct_brick_kind kind;
  ct_law law;
  ct_solid_batches *batches;
  ct_solid_energies *energies;
  double flops;
} KERNELS[] = {
    {CT_KERNEL_PLANE, CT_HEX8, CT_LINEAR, ct_solid_box_batches, NULL, 75.0},
    {CT_KERNEL_BOX, CT_HEX8, CT_LINEAR, ct_solid_box_batches, NULL, 393.0},
    {CT_KERNEL_BOX, CT_HEX20, CT_LINEAR, ct_solid_box20_batches, NULL, 882.0},
    {CT_KERNEL_REDUCED, CT_HEX8, CT_LINEAR, ct_solid_reduced_batches, NULL, 538.0},
    {CT_KERNEL_GENERAL, CT_HEX8, CT_LINEAR, ct_solid_hex8_batches, NULL, 2154.0},
    {CT_KERNEL_GENERAL, CT_HEX20, CT_LINEAR, ct_solid_hex20_batches, NULL, 37434.0},
    {CT_KERNEL_GENERAL, CT_HEX8, CT_ST_VENANT_KIRCHHOFF, ct_solid_large_hex8_batches,
     ct_solid_large_hex8_energies, 3250.0},
    {CT_KERNEL_GENERAL, CT_HEX8, CT_NEO_HOOKEAN, ct_solid_large_hex8_batches,
     ct_solid_large_hex8_energies, 3594.0},
    {CT_KERNEL_GENERAL, CT_HEX20, CT_ST_VENANT_KIRCHHOFF, ct_solid_large_hex20_batches,
     ct_solid_large_hex20_energies, 41133.0},
    {CT_KERNEL_GENERAL, CT_HEX20, CT_NEO_HOOKEAN, ct_solid_large_hex20_batches,
     ct_solid_large_hex20_energies, 42294.0},
};

void ct_part_release(ct_solid_part *part)
{
  ct_release(part->batch_nodes);
  ct_release(part->gradients);
  ct_release(part->ready);
  ct_release(part->batch_begin);
  ct_release(part->batches_at);
  ct_release(part->mean);
  ct_release(part->box20);
  ct_plane_free(part->plane);
  ct_assembly_free(part->assembly);
}

static ct_status prepare_gradients(ct_solid_part *part)
{
  ct_rule rule;
  part->gradients = ct_allocate(27, sizeof *part->gradients);
  if (part->gradients == NULL) return CT_ERROR_MEMORY;
  ct_rule_brick(part->mesh->kind, &rule);
  for (int q = 0; q < rule.count; q++)
    ct_brick_gradient(part->mesh->kind, rule.xi[q], part->gradients[q]);
  return CT_OK;
}

/* Families of nodes whose numbers each follow the elements: corners, and the mid-sides along ξ, η,
 * ζ where these stand apart, one after another, as ct_mesh_create_box numbers them; else all nodes
 * are one. */
static void find_families(ct_solid_part *part)
{
  const ct_mesh *mesh = part->mesh;
  int32_t high[CT_FAMILIES] = {-1, -1, -1, -1};
  int64_t per = ct_brick_node_count(mesh->kind);
  int apart = mesh->kind == CT_HEX20;
  for (int k = 0; k < CT_FAMILIES; k++) part->family[k] = mesh->node_count;
  for (int64_t i = 0; apart && i < per * mesh->element_count; i++) {
    int32_t n = mesh->elements[i];
    int a = (int)(i % per), k = a < 8 ? 0 : a < 16 ? 1 + a % 2 : 3;
    part->family[k] = n < part->family[k] ? n : part->family[k];
    high[k] = n > high[k] ? n : high[k];
  }
  for (int k = 0; k + 1 < CT_FAMILIES; k++) apart = apart && high[k] < part->family[k + 1];
  part->families = apart ? CT_FAMILIES : 1;
  part->family[0] = 0;
  part->family[part->families] = mesh->node_count;
}

/* What hex20 elements share: the constants of a box, or the gradients at the Gauss points. */
static ct_status prepare_hex20(ct_solid_part *part)
{
  return part->kernel == CT_KERNEL_BOX ? ct_box20_prepare(part) : prepare_gradients(part);
}

/* Find for each block of batches and each family how many of its nodes, from the first on, have all
 * their elements by then. */
static ct_status prepare_ready(ct_solid_part *part)
{
  const ct_mesh *mesh = part->mesh;
  int32_t blocks = (part->batch_count + CT_BLOCK - 1) / CT_BLOCK, node[CT_FAMILIES];
  size_t per = (size_t)ct_brick_node_count(mesh->kind), count = 0;
  find_families(part);
  int32_t *last = ct_allocate((size_t)mesh->node_count, sizeof *last);
  part->ready = ct_allocate((size_t)blocks * (size_t)part->families, sizeof *part->ready);
  if (last == NULL || part->ready == NULL) {
    ct_release(last);
    return CT_ERROR_MEMORY;
  }
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (size_t a = 0; a < per; a++) last[mesh->elements[(size_t)e * per + a]] = e;
  memcpy(node, part->family, sizeof node);
  for (int32_t block = 0; block < blocks; block++)
    for (int k = 0; k < part->families; k++) {
      while (node[k] < part->family[k + 1] && last[node[k]] / (8 * CT_BLOCK) <= block) node[k]++;
      part->ready[count++] = node[k];
    }
  ct_release(last);
  return CT_OK;
}

/* Take the kernel of the plane where it fits: one layer of boxes held along its thickness. */
static ct_status choose_plane(ct_solid_part *part, const ct_solid_body *block, int box,
                              ct_error *error)
{
  int wanted = block->kernel == CT_KERNEL_PLANE ||
               (block->kernel == CT_KERNEL_AUTO && part->optimisations.plane_strain);
  for (int axis = 0;
       wanted && box && part->mesh->kind == CT_HEX8 && part->plane == NULL && axis < 3; axis++)
    if (block->held[axis] && ct_plane_create(part, axis, part->rings, &part->plane) != CT_OK)
      return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the elements");
  if (part->plane != NULL) part->kernel = CT_KERNEL_PLANE;
  if (block->kernel == CT_KERNEL_PLANE && part->plane == NULL)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "the plane kernel needs one layer of hex8 boxes whose nodes are all held along "
                   "its thickness");
  return CT_OK;
}

/* The kernel that is asked for, or the cheapest that fits. */
static ct_status choose_kernel(ct_solid_part *part, const ct_solid_body *block, ct_error *error)
{
  ct_solid_kernel asked = block->kernel;
  int large = part->material.law != CT_LINEAR,
      box = !large && ct_solid_is_box(part->mesh, part->edge);
  if (asked == CT_KERNEL_BOX && large)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "the box kernel is for small strain; large deformation has the general one");
  if (asked == CT_KERNEL_BOX && !box)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "the box kernel needs rectangular elements of one size, with nodes in the "
                   "middle of straight edges");
  if (asked == CT_KERNEL_REDUCED && (large || part->mesh->kind != CT_HEX8))
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "reduced integration with hourglass control is for hex8 and small strain");
  if (!(part->hourglass > 0.0) || !isfinite(part->hourglass))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "the hourglass coefficient must be positive, not %g", part->hourglass);
  part->kernel = asked == CT_KERNEL_AUTO ? (box ? CT_KERNEL_BOX : CT_KERNEL_GENERAL) : asked;
  int boxes = part->kernel == CT_KERNEL_BOX || part->kernel == CT_KERNEL_PLANE;
  if (boxes && (part->optimisations.shared_stiffness || part->optimisations.sleep))
    ct_lattice_find(part->mesh, part);
  ct_status status = choose_plane(part, block, box, error);
  for (size_t k = 0; part->batches == NULL && k < sizeof KERNELS / sizeof KERNELS[0]; k++) {
    const struct kernel_row *row = &KERNELS[k];
    if (row->kernel != part->kernel || row->kind != part->mesh->kind ||
        row->law != part->material.law)
      continue;
    part->batches = row->batches;
    part->energies = row->energies;
    part->flops = row->flops;
  }
  return status;
}

void ct_solid_batch_nodes(const ct_mesh *mesh, int32_t *batch_nodes)
{
  int32_t per = ct_brick_node_count(mesh->kind);
  for (int32_t b = 0; b < (mesh->element_count + 7) / 8; b++)
    for (int32_t a = 0; a < per; a++)
      for (int32_t l = 0; l < 8; l++) {
        int32_t e = 8 * b + l < mesh->element_count ? 8 * b + l : mesh->element_count - 1;
        batch_nodes[(b * per + a) * 8 + l] = mesh->elements[e * per + a];
      }
}

ct_status ct_part_prepare(ct_solid_part *part, const ct_solid_body *block, ct_error *error)
{
  int32_t per = ct_brick_node_count(block->mesh->kind);
  part->mesh = block->mesh;
  part->material = block->material;
  part->lumping = block->lumping;
  part->optimisations =
      block->optimisations == NULL ? (ct_optimisations){1, 1, 1, 1} : *block->optimisations;
  part->first_node = block->first_node;
  ct_material_lame(&part->material, &part->lambda, &part->mu);
  part->hourglass = block->hourglass == 0.0 ? CT_HOURGLASS_DEFAULT : block->hourglass;
  part->batch_count = (part->mesh->element_count + 7) / 8;
  part->rings = block->threads < 1               ? 1
                : block->threads < CT_MOST_RINGS ? block->threads
                                                 : CT_MOST_RINGS;
  ct_status status = choose_kernel(part, block, error);
  if (status == CT_OK && part->optimisations.sleep && ct_sleep_prepare(part) != CT_OK)
    status = ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the elements");
  if (status != CT_OK) return status;
  if (part->cells[0] > 0 && part->optimisations.shared_stiffness) {
    part->value_count = ct_lattice_prepare(part);
    return CT_OK;
  }
  part->batch_nodes =
      ct_allocate((size_t)part->batch_count * 8 * (size_t)per, sizeof *part->batch_nodes);
  if (part->batch_nodes == NULL || prepare_ready(part) != CT_OK ||
      (part->mesh->kind == CT_HEX20 && prepare_hex20(part) != CT_OK))
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the elements");
  ct_solid_batch_nodes(part->mesh, part->batch_nodes);
  if (part->kernel == CT_KERNEL_REDUCED && ct_reduced_prepare(part) != CT_OK)
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the elements");
  status = ct_assembly_create(part->mesh, 3, &part->assembly, error);
  if (status != CT_OK) return status;
  part->energy_value = part->assembly->value_count + (part->batch_count + 7) / 8 * 8;
  part->value_count = part->energies != NULL ? part->energy_value + 8 * (int64_t)part->batch_count
                                             : part->assembly->value_count;
  return status;
}
