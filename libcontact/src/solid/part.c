/* One body of the solid effect: the choice of its kernel, and the kernel's constant data. */
#include "part.h"

#include "../base/error.h"
#include "../base/memory.h"
#include "../base/threads.h"
#include "../mesh/mesh_internal.h"
#include "large.h"
#include "reduced.h"
#include "sleep.h"

#include <math.h>

/* Function that computes a block, and its number of operations per element, for large deformation
 * without those of the law. */
static const struct kernel_row {
  ct_solid_kernel kernel;
  ct_brick_kind kind;
  int large;
  ct_solid_batches *batches;
  ct_solid_energies *energies;
  double flops;
} KERNELS[] = {
    {CT_KERNEL_PLANE, CT_HEX8, 0, ct_solid_box_batches, NULL, 75.0},
    {CT_KERNEL_BOX, CT_HEX8, 0, ct_solid_box_batches, NULL, 393.0},
    {CT_KERNEL_BOX, CT_HEX20, 0, ct_solid_box20_batches, NULL, 882.0},
    {CT_KERNEL_REDUCED, CT_HEX8, 0, ct_solid_reduced_batches, NULL, 839.0},
    {CT_KERNEL_GENERAL, CT_HEX8, 0, ct_solid_hex8_batches, NULL, 1697.0},
    {CT_KERNEL_GENERAL, CT_HEX20, 0, ct_solid_hex20_batches, NULL, 6393.0},
    {CT_KERNEL_GENERAL, CT_HEX8, 1, ct_solid_large_hex8_batches, ct_solid_large_hex8_energies,
     2697.0},
    {CT_KERNEL_GENERAL, CT_HEX20, 1, ct_solid_large_hex20_batches, ct_solid_large_hex20_energies,
     9768.0},
};

void ct_part_release(ct_solid_part *part)
{
  ct_pool_empty(&part->piece);
  if (part->constants_given != part->constants) ct_release(part->constants_given);
  ct_release(part->constants);
  ct_release(part->rows);
  ct_release(part->batch_begin);
  ct_release(part->batches_at);
  if (!part->is_piece) ct_release(part->box20);
  ct_order_free(part->order);
  ct_force_ring_free(part->plane);
  ct_force_ring_free(part->ring);
  ct_assembly_free(part->assembly);
}

/* Use the plane kernel if it is possible: one layer of boxes, fixed along its thickness. */
static ct_status choose_plane(ct_solid_part *part, const ct_solid_body *body)
{
  ct_status status = CT_OK;
  for (int axis = 0; status == CT_OK && part->plane == NULL && axis < 3; axis++)
    if (body->fixed[axis]) status = ct_force_ring_create(part->mesh, axis, &part->plane);
  if (part->plane != NULL) part->kernel = CT_KERNEL_PLANE;
  return status;
}

/* Find the batches that are rows. */
static ct_status prepare_rows(ct_solid_part *part)
{
  int32_t per = ct_brick_node_count(part->mesh->kind);
  part->rows = ct_allocate((size_t)part->batch_count, sizeof *part->rows);
  if (part->rows == NULL) return CT_ERROR_MEMORY;
  int32_t count = part->mesh->element_count;
#ifdef _OPENMP
  int threads = ct_threads_for(ct_threads_of(part->mesh->settings), count, CT_LEAST_OF_MESH);
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
#endif
  for (int32_t b = 0; b < count / 8; b++) {
    const int32_t *node = &part->mesh->elements[8 * (int64_t)per * b];
    int32_t apart = 0;
    for (int32_t i = 0; i < 8 * per; i++) apart |= node[i] - node[i % per] - i / per;
    part->rows[b] = apart == 0;
  }
  return CT_OK;
}

/* A ring for the forces of a body of linear hex8: in the user's order if that has runs of nodes,
 * else in an order of its own. */
static ct_status prepare_ring(ct_solid_part *part)
{
  ct_status status = ct_force_ring_create(part->mesh, -1, &part->ring);
  int fits = part->plane == NULL && part->mesh->element_count <= INT32_MAX / 8;
  if (status != CT_OK || part->ring != NULL || !fits) return status;
  status = ct_order_create(part->mesh, &part->order);
  if (status != CT_OK) return status;
  part->mesh = &part->order->mesh;
  status = ct_force_ring_create(part->mesh, -1, &part->ring);
  if (status == CT_OK && part->ring == NULL)
    status = ct_force_ring_create_listed(part->mesh, part->order->element, &part->ring);
  return status;
}

/* Data that the kernel needs in addition to the mesh. */
static ct_status prepare_kernel(ct_solid_part *part, const ct_solid_body *body)
{
  ct_status status = CT_OK;
  int trilinear = ct_brick_facts_of(part->mesh->kind)->trilinear;
  int plane = body->kernel == CT_KERNEL_PLANE ||
              (body->kernel == CT_KERNEL_AUTO && part->optimisations.plane_strain);
  if (plane && part->box && trilinear) status = choose_plane(part, body);
  if (status == CT_OK && trilinear && part->energies == NULL &&
      part->optimisations.shared_stiffness)
    status = prepare_ring(part);
  if (status == CT_OK) status = prepare_rows(part);
  if (status == CT_OK && part->batches == ct_solid_box20_batches) status = ct_box20_prepare(part);
  if (status == CT_OK && part->optimisations.sleep &&
      (part->ring == NULL || part->ring->list != NULL))
    status = ct_sleep_prepare(part);
  return status;
}

/* Choose the matching row of the table; false if there is none. */
static int take_row(ct_solid_part *part)
{
  const double points = pow(ct_brick_facts_of(part->mesh->kind)->points, 3.0);
  for (size_t k = 0; k < sizeof KERNELS / sizeof KERNELS[0]; k++) {
    const struct kernel_row *row = &KERNELS[k];
    if (row->kernel != part->kernel || row->kind != part->mesh->kind ||
        row->large != (part->material.law != CT_LINEAR))
      continue;
    part->batches = row->batches;
    part->energies = row->energies;
    part->flops = row->flops + points * ct_large_flops(part->material.law);
    return 1;
  }
  return 0;
}

/* The requested kernel, or the cheapest possible one. */
static ct_status choose_kernel(ct_solid_part *part, const ct_solid_body *body, ct_error *error)
{
  ct_solid_kernel asked = body->kernel;
  int large = part->material.law != CT_LINEAR;
  part->box = !large && part->materials == NULL && ct_solid_is_box(part->mesh, part->edge);
  if ((asked == CT_KERNEL_BOX || asked == CT_KERNEL_PLANE) && part->materials != NULL)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "a body of several materials has the general or the reduced kernel");
  if (asked == CT_KERNEL_BOX && !large && !part->box)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "the box kernel needs rectangular elements of one size, with nodes in the "
                   "middle of straight edges");
  if (!(part->hourglass > 0.0) || !isfinite(part->hourglass))
    return CT_REFUSE(error, "hourglass must be positive and finite, not %g", part->hourglass);
  part->kernel = asked == CT_KERNEL_AUTO ? (part->box ? CT_KERNEL_BOX : CT_KERNEL_GENERAL) : asked;
  if (!take_row(part))
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "there is no such kernel for %s with %s strain",
                   ct_brick_facts_of(part->mesh->kind)->name, large ? "large" : "small");
  if (prepare_kernel(part, body) != CT_OK) return CT_NO_MEMORY(error, "the elements");
  if (asked == CT_KERNEL_PLANE && part->plane == NULL)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "the plane kernel needs one layer of hex8 boxes whose nodes are all held along "
                   "its thickness");
  if (part->plane != NULL) take_row(part);
  return CT_OK;
}

/* The constants of the elements as the kernels read them; element e has the place at[e], or e. The
 * last batch repeats its last element. */
static double *create_constants(const ct_solid_part *part, const int32_t *at)
{
  const int64_t count = part->mesh->element_count, room = 8 * (int64_t)part->batch_count;
  double *constants = ct_allocate((size_t)(CT_CONSTANT_COUNT * room), sizeof *constants);
  for (int32_t e = 0; constants != NULL && e < count; e++) {
    const ct_material *m = &part->materials[e];
    double *own = &constants[at != NULL ? at[e] : e];
    ct_material_lame(m, &own[CT_LAMBDA * room], &own[CT_MU * room]);
    own[CT_YOUNG * room] = m->young;
    own[CT_DENSITY * room] = m->density;
  }
  for (int64_t i = count; constants != NULL && i < room; i++)
    for (int k = 0; k < CT_CONSTANT_COUNT; k++)
      constants[k * room + i] = constants[k * room + count - 1];
  return constants;
}

static ct_status prepare_constants(ct_solid_part *part, ct_error *error)
{
  if (part->materials == NULL) return CT_OK;
  part->constants = part->constants_given =
      create_constants(part, part->order != NULL ? part->order->element : NULL);
  if (part->order != NULL) part->constants_given = create_constants(part, NULL);
  return part->constants != NULL && part->constants_given != NULL
             ? CT_OK
             : CT_NO_MEMORY(error, "the materials");
}

/* A table for the sums at the nodes, where there is no ring. */
static ct_status prepare_table(ct_solid_part *part, ct_error *error)
{
  ct_status status = ct_assembly_create(part->mesh, 3, &part->assembly, error);
  if (status == CT_OK) part->value_count = part->assembly->value_count;
  return status;
}

/* The constants of the elements, and the table with memory for the energies. */
static ct_status finish(ct_solid_part *part, ct_error *error)
{
  ct_status status = prepare_constants(part, error);
  if (status != CT_OK || part->ring != NULL) return status;
  status = prepare_table(part, error);
  if (status != CT_OK) return status;
  part->energy_value = part->assembly->value_count + (part->batch_count + 7) / 8 * 8;
  if (part->energies != NULL)
    part->value_count = part->energy_value + 8 * (int64_t)part->batch_count;
  return CT_OK;
}

ct_status ct_part_prepare(ct_solid_part *part, const ct_solid_body *body, ct_error *error)
{
  part->mesh = body->mesh;
  part->material = body->material;
  part->materials = body->materials;
  part->lumping = body->lumping;
  part->optimisations =
      body->optimisations == NULL ? (ct_optimisations){1, 1, 1} : *body->optimisations;
  part->first_node = body->first_node;
  ct_material_lame(&part->material, &part->lambda, &part->mu);
  if (body->kernel == CT_KERNEL_RIGID) {
    // No batches, and no values: its elements have no forces.
    part->kernel = CT_KERNEL_RIGID;
    part->optimisations.sleep = 0;
    return CT_OK;
  }
  part->hourglass = body->hourglass == 0.0 ? CT_HOURGLASS_DEFAULT : body->hourglass;
  part->batch_count = (part->mesh->element_count + 7) / 8;
  ct_status status = choose_kernel(part, body, error);
  return status == CT_OK ? finish(part, error) : status;
}

ct_status ct_part_lay_out(ct_solid_part *part, ct_error *error)
{
  part->batch_count = (part->mesh->element_count + 7) / 8;
  if (prepare_ring(part) != CT_OK || prepare_rows(part) != CT_OK)
    return CT_NO_MEMORY(error, "the elements");
  return part->ring != NULL ? CT_OK : prepare_table(part, error);
}

/* A mesh of some elements with all nodes, and their materials. */
static ct_mesh *take_elements(const ct_solid_part *whole, const uint8_t *mine, ct_solid_part *part)
{
  const ct_solid_part given = ct_part_given(whole);
  const int32_t per = ct_brick_node_count(given.mesh->kind), all = given.mesh->element_count;
  int32_t count = 0;
  for (int32_t e = 0; e < all; e++) count += mine[e] != 0;
  ct_mesh *mesh = ct_pool_take(&part->piece, 1, sizeof *mesh);
  int32_t *elements = ct_pool_take(&part->piece, (size_t)count * (size_t)per, sizeof *elements);
  ct_material *materials =
      ct_pool_take(&part->piece, given.materials == NULL ? 0 : (size_t)count, sizeof *materials);
  if (part->piece.failed) return NULL;
  *mesh = *given.mesh;
  mesh->elements = elements;
  mesh->element_count = count;
  part->materials = given.materials == NULL ? NULL : materials;
  for (int32_t e = 0; e < all; e++) {
    if (mine[e] == 0) continue;
    memcpy(elements, &given.mesh->elements[(int64_t)per * e], (size_t)per * sizeof *elements);
    elements += per;
    if (given.materials != NULL) *materials++ = given.materials[e];
  }
  return mesh;
}

ct_status ct_part_cut(const ct_solid_part *whole, const uint8_t *mine, ct_solid_part *part,
                      ct_error *error)
{
  *part = (ct_solid_part){.material = whole->material,
                          .lumping = whole->lumping,
                          .optimisations = whole->optimisations,
                          .lambda = whole->lambda,
                          .mu = whole->mu,
                          .first_node = whole->first_node,
                          .kernel = whole->kernel,
                          .batches = whole->batches,
                          .energies = whole->energies,
                          .flops = whole->flops,
                          .box = whole->box,
                          .hourglass = whole->hourglass,
                          .box20 = whole->box20,
                          .is_piece = 1};
  memcpy(part->edge, whole->edge, sizeof part->edge);
  part->optimisations.sleep = 0;
  part->mesh = take_elements(whole, mine, part);
  if (part->mesh == NULL) return CT_NO_MEMORY(error, "a piece");
  if (part->mesh->element_count == 0) {
    // No elements, no forces: as a rigid body.
    part->kernel = CT_KERNEL_RIGID;
    part->energies = NULL;
  }
  if (part->kernel == CT_KERNEL_RIGID) return CT_OK;
  part->batch_count = (part->mesh->element_count + 7) / 8;
  ct_status status = CT_OK;
  if (whole->plane != NULL)
    status = ct_force_ring_create(part->mesh, whole->plane->axis, &part->plane);
  if (status == CT_OK && whole->ring != NULL) status = prepare_ring(part);
  if (status == CT_OK) status = prepare_rows(part);
  if (status != CT_OK) return CT_NO_MEMORY(error, "a piece");
  return finish(part, error);
}

int64_t ct_parts_place(ct_solid_part *parts, int32_t count, int64_t *ring_stride)
{
  int rings = 0;
  for (int32_t i = 0; i < count; i++)
    for (int plane = 0; plane < 2; plane++) {
      const ct_force_ring *ring = plane ? parts[i].plane : parts[i].ring;
      if (ring == NULL) continue;
      if (ring->value_count > *ring_stride) *ring_stride = ring->value_count;
      rings = ring->ring_count;
    }
  int64_t values = *ring_stride * rings;
  for (int32_t i = 0; i < count; i++) {
    if (parts[i].ring != NULL) continue;
    parts[i].first_value = values;
    values += parts[i].value_count;
  }
  for (int32_t i = 0; i < count; i++) {
    parts[i].first_ordered = values;
    if (parts[i].order != NULL) values += 3 * (int64_t)parts[i].mesh->node_count;
  }
  return values;
}
