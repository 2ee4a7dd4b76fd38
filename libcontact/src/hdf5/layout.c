#include "hdf5_internal.h"

#include <libcontact/solid.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The groups of the file, in the order in which they are made. */
enum { POINT_DATA = 1, CELL_DATA, FIELD_DATA, STEPS, TO_OFFSETS = 4, OWN_GROUP = 8 };
static const char *const GROUP[] = {"VTKHDF",
                                    "VTKHDF/PointData",
                                    "VTKHDF/CellData",
                                    "VTKHDF/FieldData",
                                    "VTKHDF/Steps",
                                    "VTKHDF/Steps/PointDataOffsets",
                                    "VTKHDF/Steps/CellDataOffsets",
                                    "VTKHDF/Steps/FieldDataOffsets",
                                    "libcontact"};

/* -- The mesh of all bodies as one grid -- */

enum { OFFSET, TYPE, BODY };

/* One number per cell, and after them the end of the last one. */
static void fill_cells(const ct_problem *problem, int what, int64_t *values)
{
  int64_t at = 0;
  for (int32_t b = 0; b < problem->body_count; b++) {
    const ct_mesh *mesh = problem->bodies[b].mesh;
    int64_t type = ct_brick_facts_of(mesh->kind)->vtk;
    for (int32_t e = 0; e < mesh->element_count; e++, at += ct_brick_node_count(mesh->kind))
      *values++ = what == OFFSET ? at : what == TYPE ? type : b;
  }
  *values = at;
}

static void fill_connectivity(const ct_problem *problem, int64_t *values)
{
  for (int32_t b = 0; b < problem->body_count; b++) {
    const ct_body *body = &problem->bodies[b];
    int64_t count = (int64_t)body->mesh->element_count * ct_brick_node_count(body->mesh->kind);
    for (int64_t i = 0; i < count; i++)
      *values++ = (int64_t)body->first_node + body->mesh->elements[i];
  }
}

static void write_grid(ct_task *task, const ct_output *o, const ct_problem *problem)
{
  const hid_t whole = H5T_NATIVE_INT64;
  int64_t ids = 0;
  for (int32_t b = 0; b < problem->body_count; b++) {
    const ct_mesh *mesh = problem->bodies[b].mesh;
    ids += (int64_t)mesh->element_count * ct_brick_node_count(mesh->kind);
  }
  const hsize_t one = 1, points[2] = {(hsize_t)o->node_count, 3}, cells = (hsize_t)o->cell_count,
                ends = cells + 1, length = (hsize_t)ids;
  // -- Of all arrays the connectivity is the longest
  int64_t *values = malloc((size_t)ids * sizeof *values);
  if (values == NULL) {
    ct_task_fail(task, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the grid of the results file");
    return;
  }
  ct_hdf5_write_array(task, "VTKHDF/NumberOfPoints", whole, 1, &one, &o->node_count);
  ct_hdf5_write_array(task, "VTKHDF/NumberOfCells", whole, 1, &one, &o->cell_count);
  ct_hdf5_write_array(task, "VTKHDF/NumberOfConnectivityIds", whole, 1, &one, &ids);
  ct_hdf5_write_array(task, "VTKHDF/Points", H5T_NATIVE_DOUBLE, 2, points, problem->reference);
  fill_connectivity(problem, values);
  ct_hdf5_write_array(task, "VTKHDF/Connectivity", whole, 1, &length, values);
  fill_cells(problem, OFFSET, values);
  ct_hdf5_write_array(task, "VTKHDF/Offsets", whole, 1, &ends, values);
  fill_cells(problem, TYPE, values);
  ct_hdf5_write_array(task, "VTKHDF/Types", H5T_NATIVE_UCHAR, 1, &cells, values);
  fill_cells(problem, BODY, values);
  ct_hdf5_write_array(task, "VTKHDF/CellData/body", H5T_NATIVE_INT32, 1, &cells, values);
  free(values);
}

/* -- Fields that are computed while they are written -- */

static ct_status fill_velocity(const ct_output *o, const ct_problem *problem, ct_state *state,
                               int64_t first, int64_t count, ct_error *error)
{
  return ct_state_velocity_at(problem, state, (int32_t)first, (int32_t)count, o->now.piece, error);
}

/* ct_solid_stress of the elements from `from` on of a body, of which `part` has the list. */
static ct_status body_stress(const ct_body *body, const ct_mesh *part, int32_t from,
                             const double *displacement, double *values, ct_error *error)
{
  const int per = ct_brick_node_count(part->kind);
  ct_status status = CT_OK;
  for (int32_t e = 0, end; status == CT_OK && e < part->element_count; e = end) {
    const ct_material *material = ct_body_material(body, from + e);
    ct_mesh alike = *part;
    // -- The next elements of the same material
    for (end = body->materials == NULL ? part->element_count : e + 1;
         end < part->element_count &&
         memcmp(ct_body_material(body, from + end), material, sizeof *material) == 0;)
      end++;
    alike.elements += (int64_t)e * per;
    alike.element_count = end - e;
    status = ct_solid_stress(&alike, material, displacement, values + 6 * (int64_t)e, error);
    if (status != CT_OK && error != NULL && error->element >= 0) error->element += from + e;
  }
  return status;
}

/* Stresses of some cells, counted over all bodies, from the displacements of all nodes. */
static ct_status stress_rows(const ct_problem *problem, const double *displacement, int64_t first,
                             int64_t count, double *values, ct_error *error)
{
  ct_status status = CT_OK;
  int64_t start = 0;
  for (int32_t b = 0; b < problem->body_count && status == CT_OK; b++) {
    const ct_body *body = &problem->bodies[b];
    ct_mesh part = *body->mesh;
    // -- The elements of the body that are among them
    int64_t from = first > start ? first - start : 0, end = first + count - start;
    if (end > part.element_count) end = part.element_count;
    start += part.element_count;
    if (from >= end) continue;
    part.elements += from * ct_brick_node_count(part.kind);
    part.element_count = (int32_t)(end - from);
    if (ct_problem_is_rigid(problem, b))
      memset(values, 0, 6 * (size_t)(end - from) * sizeof *values);
    else
      status = body_stress(body, &part, (int32_t)from, displacement + 3 * (int64_t)body->first_node,
                           values, error);
    // -- The initial stress comes on top (eq:initial-stress)
    for (int64_t k = 0; k < 6 * (end - from); k++) *values++ += body->initial_stress[k % 6];
  }
  return status;
}

static ct_status fill_stress(const ct_output *o, const ct_problem *problem, ct_state *state,
                             int64_t first, int64_t count, ct_error *error)
{
  return stress_rows(problem, state->displacement, first, count, o->now.piece, error);
}

static ct_status fill_stress_filtered(const ct_output *o, const ct_problem *problem,
                                      ct_state *state, int64_t first, int64_t count,
                                      ct_error *error)
{
  (void)state;
  return stress_rows(problem, o->smooth, first, count, o->now.piece, error);
}

/* -- The datasets that grow -- */

static const ct_row_type ENERGY = {
    sizeof(ct_energy),
    {CT_FIELD(ct_energy, time, CT_REAL, NULL), CT_FIELD(ct_energy, kinetic, CT_REAL, NULL),
     CT_FIELD(ct_energy, strain, CT_REAL, NULL), CT_FIELD(ct_energy, contact, CT_REAL, NULL),
     CT_FIELD(ct_energy, reserve, CT_REAL, NULL), CT_FIELD(ct_energy, external, CT_REAL, NULL),
     CT_FIELD(ct_energy, total, CT_REAL, NULL), CT_FIELD(ct_energy, balance, CT_REAL, NULL)}};

static const ct_row_type MOMENTUM = {
    sizeof(ct_momentum),
    {CT_FIELD(ct_momentum, time, CT_REAL, NULL), CT_FIELD(ct_momentum, body, CT_INT32, NULL),
     CT_FIELD(ct_momentum, p, CT_VECTOR, NULL), CT_FIELD(ct_momentum, L, CT_VECTOR, NULL),
     CT_FIELD(ct_momentum, contact_impulse, CT_VECTOR, NULL),
     CT_FIELD(ct_momentum, obstacle_impulse, CT_VECTOR, NULL),
     CT_FIELD(ct_momentum, support_impulse, CT_VECTOR, NULL)}};

static const ct_row_type EFFECT = {
    sizeof(ct_effect_energy),
    {CT_FIELD(ct_effect_energy, work, CT_REAL, NULL),
     {"energy", offsetof(ct_effect_energy, stored), sizeof(double), CT_REAL, NULL}}};

typedef struct plan {
  int group;
  const char *name;
  ct_kind kind;
  const ct_row_type *row; /* for rows that are structs, in place of the kind */
  enum { ONE, NODES, CELLS, BODIES, EFFECTS } per;
  int64_t width;
  size_t
      source; /* except for ONE that of a pointer; if the pointer is null, the dataset is omitted */
} plan;

#define NOW(member) offsetof(ct_record, member)
#define NOW_ENERGY(member) (offsetof(ct_record, energy) + offsetof(ct_energy, member))
static const plan COLUMN[] = {
    {STEPS, "Values", CT_REAL, NULL, ONE, 0, NOW_ENERGY(time)},
    {STEPS, "PartOffsets", CT_INT64, NULL, ONE, 0, NOW(zero)},
    {STEPS, "NumberOfParts", CT_INT64, NULL, ONE, 0, NOW(one)},
    {STEPS, "PointOffsets", CT_INT64, NULL, ONE, 0, NOW(zero)},
    {STEPS, "CellOffsets", CT_INT64, NULL, ONE, 1, NOW(zero)},
    {STEPS, "ConnectivityIdOffsets", CT_INT64, NULL, ONE, 1, NOW(zero)},
    {POINT_DATA, "displacement", CT_REAL, NULL, NODES, 3, NOW(displacement)},
    {POINT_DATA, "velocity", CT_REAL, NULL, NODES, 3, NOW(velocity)},
    {POINT_DATA, "contact_pressure", CT_REAL, NULL, NODES, 0, NOW(contact_pressure)},
    {CELL_DATA, "stress", CT_REAL, NULL, CELLS, 6, NOW(stress)},
    {POINT_DATA, "displacement_filtered", CT_REAL, NULL, NODES, 3, NOW(displacement_filtered)},
    {POINT_DATA, "velocity_filtered", CT_REAL, NULL, NODES, 3, NOW(velocity_filtered)},
    {CELL_DATA, "stress_filtered", CT_REAL, NULL, CELLS, 6, NOW(stress_filtered)},
    {CELL_DATA + TO_OFFSETS, "body", CT_INT64, NULL, ONE, 0, NOW(zero)},
    {FIELD_DATA, "kinetic", CT_REAL, NULL, ONE, 0, NOW_ENERGY(kinetic)},
    {FIELD_DATA, "strain", CT_REAL, NULL, ONE, 0, NOW_ENERGY(strain)},
    {FIELD_DATA, "contact", CT_REAL, NULL, ONE, 0, NOW_ENERGY(contact)},
    {FIELD_DATA, "reserve", CT_REAL, NULL, ONE, 0, NOW_ENERGY(reserve)},
    {FIELD_DATA, "external", CT_REAL, NULL, ONE, 0, NOW_ENERGY(external)},
    {FIELD_DATA, "total", CT_REAL, NULL, ONE, 0, NOW_ENERGY(total)},
    {FIELD_DATA, "balance", CT_REAL, NULL, ONE, 0, NOW_ENERGY(balance)},
    {FIELD_DATA, "momentum", CT_REAL, NULL, ONE, 3, NOW(momentum)},
    {FIELD_DATA, "angular_momentum", CT_REAL, NULL, ONE, 3, NOW(angular_momentum)},
    {OWN_GROUP, "step", CT_INT64, NULL, ONE, 0, NOW(step)},
    {OWN_GROUP, "energy", CT_REAL, &ENERGY, ONE, 0, NOW(energy)},
    {OWN_GROUP, "momentum", CT_REAL, &MOMENTUM, BODIES, 0, NOW(bodies)},
    {OWN_GROUP, "effect", CT_REAL, &EFFECT, EFFECTS, 0, NOW(effects)}};

const void *ct_record_at(const ct_record *now, const ct_column *column)
{
  const void *at = (const char *)now + column->source;
  if (column->is_pointer) memcpy(&at, at, sizeof at);
  return at;
}

/* Returns whether there is such a dataset. */
static int create_column(ct_task *task, ct_output *o, const plan *p)
{
  const int64_t rows[] = {1, o->node_count, o->cell_count, o->body_count, o->effect_count};
  ct_column *column = &o->column[o->column_count];
  char path[64];
  column->rows = rows[p->per];
  column->width = p->width;
  column->source = p->source;
  column->is_pointer = p->per != ONE;
  column->fill = p->source == NOW(velocity)          ? fill_velocity
                 : p->source == NOW(stress)          ? fill_stress
                 : p->source == NOW(stress_filtered) ? fill_stress_filtered
                                                     : NULL;
  if (column->rows == 0 || ct_record_at(&o->now, column) == NULL) return 0;
  column->type = p->row != NULL ? ct_hdf5_row_type(p->row) : ct_hdf5_type(p->kind);
  if (column->type < 0) ct_hdf5_fail(task, "make a table");
  o->column_count++;
  snprintf(path, sizeof path, "%s/%s", GROUP[p->group], p->name);
  ct_hdf5_create_column(task, path, p->per == NODES || p->per == CELLS, column);
  return 1;
}

/* Create each dataset, and beside VTK's data the dataset of each step's first row. */
static void create_columns(ct_task *task, ct_output *o)
{
  static const size_t FIRST_ROW[] = {
      [POINT_DATA] = NOW(point_row), [CELL_DATA] = NOW(cell_row), [FIELD_DATA] = NOW(step_row)};
  for (size_t i = 0; i < sizeof COLUMN / sizeof COLUMN[0]; i++) {
    plan p = COLUMN[i];
    if (!create_column(task, o, &p) || p.group < POINT_DATA || p.group > FIELD_DATA) continue;
    const plan first = {p.group + TO_OFFSETS, p.name, CT_INT64, NULL, ONE, 0, FIRST_ROW[p.group]};
    create_column(task, o, &first);
  }
}

void ct_layout_create(ct_task *task, ct_output *o, const ct_problem *problem,
                      const ct_output_options *options)
{
  const double version[2] = {2, 2}, none = 0, passes = options->filter;
  for (size_t i = 0; i < sizeof GROUP / sizeof GROUP[0]; i++) ct_hdf5_create_group(task, GROUP[i]);
  ct_hdf5_write_attribute(task, "VTKHDF", "Version", H5T_NATIVE_INT64, 2, version);
  ct_hdf5_write_label(task, "VTKHDF", "Type", "UnstructuredGrid");
  write_grid(task, o, problem);
  ct_hdf5_write_label(task, "libcontact", "version", ct_version());
  if (options->filter > 0)
    H5Aclose(ct_hdf5_write_attribute(task, "libcontact", "filter", H5T_NATIVE_INT64, 0, &passes));
  if (options->scene != NULL) ct_hdf5_write_text(task, "libcontact/scene", options->scene);
  ct_identity_write(task, problem);
  create_columns(task, o);
  o->step_count =
      ct_hdf5_write_attribute(task, "VTKHDF/Steps", "NSteps", H5T_NATIVE_INT64, 0, &none);
}
