#include "hdf5_internal.h"

#include <stdlib.h>
#include <string.h>

enum { VTK_HEXAHEDRON = 12, VTK_QUADRATIC_HEXAHEDRON = 25 };

/* The files are of the second superblock and their growing datasets of the extensible-array kind:
 * nothing that is already in the file moves when a step is appended, and no flag in it says that a
 * writer was there (docs/theory/output.rst, "Killed in mid-run"). */
hid_t ct_layout_open_access(void)
{
  hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  int done = H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V110) >= 0;
#if H5_VERSION_GE(1, 12, 1) || (H5_VERS_MINOR == 10 && H5_VERSION_GE(1, 10, 7))
  done = done && H5Pset_file_locking(access, 0, 1) >= 0;
#endif
  if (done) return access;
  H5Pclose(access);
  return -1;
}

/* -- The mesh of all bodies as one grid -- */

static int64_t connectivity_count(const ct_problem *problem)
{
  int64_t count = 0;
  for (int32_t b = 0; b < problem->body_count; b++) {
    const ct_mesh *mesh = problem->bodies[b].mesh;
    count += (int64_t)mesh->element_count * ct_brick_node_count(mesh->kind);
  }
  return count;
}

typedef struct grid {
  int64_t *connectivity, *offsets;
  int32_t *body;
  unsigned char *types;
} grid;

static void grid_free(grid *g)
{
  free(g->connectivity);
  free(g->offsets);
  free(g->body);
  free(g->types);
}

static ct_status grid_fill(const ct_problem *problem, int64_t cells, grid *g, ct_error *error)
{
  g->connectivity = malloc((size_t)(connectivity_count(problem) + 1) * sizeof *g->connectivity);
  g->offsets = malloc((size_t)(cells + 1) * sizeof *g->offsets);
  g->body = malloc((size_t)(cells + 1) * sizeof *g->body);
  g->types = malloc((size_t)(cells + 1) * sizeof *g->types);
  if (g->connectivity == NULL || g->offsets == NULL || g->body == NULL || g->types == NULL)
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE,
                   "no memory for the grid of the results file");
  int64_t cell = 0, at = 0;
  for (int32_t b = 0; b < problem->body_count; b++) {
    const ct_body *body = &problem->bodies[b];
    int nodes = ct_brick_node_count(body->mesh->kind);
    for (int32_t e = 0; e < body->mesh->element_count; e++, cell++) {
      g->offsets[cell] = at;
      g->body[cell] = b;
      g->types[cell] = body->mesh->kind == CT_HEX20 ? VTK_QUADRATIC_HEXAHEDRON : VTK_HEXAHEDRON;
      for (int i = 0; i < nodes; i++, at++)
        g->connectivity[at] =
            (int64_t)body->first_node + body->mesh->elements[(int64_t)e * nodes + i];
    }
  }
  g->offsets[cell] = at;
  return CT_OK;
}

enum {
  VTK_GROUP,
  POINT_DATA,
  CELL_DATA,
  FIELD_DATA,
  STEPS,
  POINT_OFFSETS,
  CELL_OFFSETS,
  FIELD_OFFSETS,
  OWN_GROUP,
  GROUP_COUNT
};

static void create_groups(ct_task *task, hid_t file, hid_t group[GROUP_COUNT])
{
  static const struct {
    const char *name;
    int parent;
  } PLAN[GROUP_COUNT] = {{"VTKHDF", -1},
                         {"PointData", VTK_GROUP},
                         {"CellData", VTK_GROUP},
                         {"FieldData", VTK_GROUP},
                         {"Steps", VTK_GROUP},
                         {"PointDataOffsets", STEPS},
                         {"CellDataOffsets", STEPS},
                         {"FieldDataOffsets", STEPS},
                         {"libcontact", -1}};
  for (int i = 0; i < GROUP_COUNT; i++)
    group[i] =
        ct_hdf5_create_group(task, PLAN[i].parent < 0 ? file : group[PLAN[i].parent], PLAN[i].name);
}

static void write_grid(ct_task *task, const ct_output *o, const ct_problem *problem,
                       const hid_t group[GROUP_COUNT])
{
  grid g = {NULL, NULL, NULL, NULL};
  hid_t whole = H5T_NATIVE_INT64, vtk = group[VTK_GROUP];
  int64_t ids = connectivity_count(problem);
  const hsize_t one = 1, points[2] = {(hsize_t)o->node_count, 3}, cells = (hsize_t)o->cell_count,
                ends = cells + 1, length = (hsize_t)ids;
  if (task->status == CT_OK) task->status = grid_fill(problem, o->cell_count, &g, task->error);
  ct_hdf5_write_array(task, vtk, "NumberOfPoints", whole, 1, &one, &o->node_count);
  ct_hdf5_write_array(task, vtk, "NumberOfCells", whole, 1, &one, &o->cell_count);
  ct_hdf5_write_array(task, vtk, "NumberOfConnectivityIds", whole, 1, &one, &ids);
  ct_hdf5_write_array(task, vtk, "Points", H5T_NATIVE_DOUBLE, 2, points, problem->reference);
  ct_hdf5_write_array(task, vtk, "Connectivity", whole, 1, &length, g.connectivity);
  ct_hdf5_write_array(task, vtk, "Offsets", whole, 1, &ends, g.offsets);
  ct_hdf5_write_array(task, vtk, "Types", H5T_NATIVE_UCHAR, 1, &cells, g.types);
  ct_hdf5_write_array(task, group[CELL_DATA], "body", H5T_NATIVE_INT32, 1, &cells, g.body);
  grid_free(&g);
}

/* -- The datasets that grow -- */

static const ct_field ENERGY_FIELD[] = {
    CT_FIELD(ct_energy, time, CT_REAL, NULL),     CT_FIELD(ct_energy, kinetic, CT_REAL, NULL),
    CT_FIELD(ct_energy, strain, CT_REAL, NULL),   CT_FIELD(ct_energy, contact, CT_REAL, NULL),
    CT_FIELD(ct_energy, external, CT_REAL, NULL), CT_FIELD(ct_energy, total, CT_REAL, NULL),
    CT_FIELD(ct_energy, balance, CT_REAL, NULL)};
static const ct_row_type ENERGY = CT_ROW_TYPE(ct_energy, ENERGY_FIELD);

static const ct_field MOMENTUM_FIELD[] = {CT_FIELD(ct_momentum, time, CT_REAL, NULL),
                                          CT_FIELD(ct_momentum, body, CT_INT32, NULL),
                                          CT_FIELD(ct_momentum, p, CT_VECTOR, NULL),
                                          CT_FIELD(ct_momentum, L, CT_VECTOR, NULL),
                                          CT_FIELD(ct_momentum, contact_impulse, CT_VECTOR, NULL),
                                          CT_FIELD(ct_momentum, support_impulse, CT_VECTOR, NULL)};
static const ct_row_type MOMENTUM = CT_ROW_TYPE(ct_momentum, MOMENTUM_FIELD);

static const ct_field EFFECT_FIELD[] = {CT_FIELD(ct_effect_row, work, CT_REAL, NULL),
                                        CT_FIELD(ct_effect_row, energy, CT_REAL, NULL)};
static const ct_row_type EFFECT = CT_ROW_TYPE(ct_effect_row, EFFECT_FIELD);

typedef struct plan {
  int group;
  const char *name;
  ct_kind kind;
  const ct_row_type *row; /* for rows that are structs, instead of the kind */
  enum { ONE, NODES, CELLS, BODIES, EFFECTS } per;
  int64_t width;
  size_t source;
  int is_pointer; /* at `source`; where it is null, the dataset is left out */
} plan;

#define NOW(member) offsetof(ct_record, member)
#define NOW_ENERGY(member) (offsetof(ct_record, energy) + offsetof(ct_energy, member))
static const plan COLUMN[] = {
    {STEPS, "Values", CT_REAL, NULL, ONE, 0, NOW_ENERGY(time), 0},
    {STEPS, "PartOffsets", CT_INT64, NULL, ONE, 0, NOW(zero), 0},
    {STEPS, "NumberOfParts", CT_INT64, NULL, ONE, 0, NOW(one), 0},
    {STEPS, "PointOffsets", CT_INT64, NULL, ONE, 0, NOW(zero), 0},
    {STEPS, "CellOffsets", CT_INT64, NULL, ONE, 1, NOW(zero), 0},
    {STEPS, "ConnectivityIdOffsets", CT_INT64, NULL, ONE, 1, NOW(zero), 0},
    {POINT_DATA, "displacement", CT_REAL, NULL, NODES, 3, NOW(displacement), 1},
    {POINT_DATA, "velocity", CT_REAL, NULL, NODES, 3, NOW(velocity), 1},
    {CELL_DATA, "stress", CT_REAL, NULL, CELLS, 6, NOW(stress), 1},
    {CELL_OFFSETS, "body", CT_INT64, NULL, ONE, 0, NOW(zero), 0},
    {FIELD_DATA, "kinetic", CT_REAL, NULL, ONE, 0, NOW_ENERGY(kinetic), 0},
    {FIELD_DATA, "strain", CT_REAL, NULL, ONE, 0, NOW_ENERGY(strain), 0},
    {FIELD_DATA, "contact", CT_REAL, NULL, ONE, 0, NOW_ENERGY(contact), 0},
    {FIELD_DATA, "external", CT_REAL, NULL, ONE, 0, NOW_ENERGY(external), 0},
    {FIELD_DATA, "total", CT_REAL, NULL, ONE, 0, NOW_ENERGY(total), 0},
    {FIELD_DATA, "balance", CT_REAL, NULL, ONE, 0, NOW_ENERGY(balance), 0},
    {FIELD_DATA, "momentum", CT_REAL, NULL, ONE, 3, NOW(momentum), 0},
    {FIELD_DATA, "angular_momentum", CT_REAL, NULL, ONE, 3, NOW(angular_momentum), 0},
    {OWN_GROUP, "step", CT_INT64, NULL, ONE, 0, NOW(step), 0},
    {OWN_GROUP, "energy", CT_REAL, &ENERGY, ONE, 0, NOW(energy), 0},
    {OWN_GROUP, "momentum", CT_REAL, &MOMENTUM, BODIES, 0, NOW(bodies), 1},
    {OWN_GROUP, "effect", CT_REAL, &EFFECT, EFFECTS, 0, NOW(effects), 1}};

static void create_column(ct_task *task, ct_output *o, hid_t parent, const plan *p)
{
  const int64_t rows[] = {1, o->node_count, o->cell_count, o->body_count, o->effect_count};
  const void *array = NULL;
  if (p->is_pointer) memcpy(&array, (const char *)&o->now + p->source, sizeof array);
  if (rows[p->per] == 0 || (p->is_pointer && array == NULL)) return;
  ct_column *column = &o->column[o->column_count++];
  column->type = p->row != NULL ? ct_hdf5_row_type(p->row) : ct_hdf5_type(p->kind);
  if (column->type < 0) ct_hdf5_fail(task, "make a table");
  column->rows = rows[p->per];
  column->width = p->width;
  column->source = p->source;
  column->is_pointer = p->is_pointer;
  ct_hdf5_create_column(task, parent, p->name, p->per == NODES || p->per == CELLS, column);
}

/* Each dataset, and for VTK's data beside it the one with the first row of every step. */
static void create_columns(ct_task *task, ct_output *o, const hid_t group[GROUP_COUNT])
{
  static const size_t FIRST_ROW[] = {
      [POINT_DATA] = NOW(point_row), [CELL_DATA] = NOW(cell_row), [FIELD_DATA] = NOW(step_row)};
  for (size_t i = 0; i < sizeof COLUMN / sizeof COLUMN[0]; i++) {
    const plan *p = &COLUMN[i];
    int32_t before = o->column_count;
    create_column(task, o, group[p->group], p);
    if (o->column_count == before || p->group < POINT_DATA || p->group > FIELD_DATA) continue;
    const int offsets = p->group + POINT_OFFSETS - POINT_DATA;
    const plan first = {offsets, p->name, CT_INT64, NULL, ONE, 0, FIRST_ROW[p->group], 0};
    create_column(task, o, group[offsets], &first);
  }
}

void ct_layout_create(ct_task *task, ct_output *o, const ct_problem *problem, const char *scene)
{
  hid_t group[GROUP_COUNT];
  const int64_t version[2] = {2, 2}, none = 0;
  create_groups(task, o->file, group);
  ct_hdf5_write_attribute(task, group[VTK_GROUP], "Version", H5T_NATIVE_INT64, 2, version);
  ct_hdf5_write_label(task, group[VTK_GROUP], "Type", "UnstructuredGrid");
  write_grid(task, o, problem, group);
  ct_hdf5_write_label(task, group[OWN_GROUP], "version", ct_version());
  if (scene != NULL) ct_hdf5_write_text(task, group[OWN_GROUP], "scene", scene);
  ct_identity_write(task, problem, group[OWN_GROUP]);
  create_columns(task, o, group);
  o->step_count = ct_hdf5_write_attribute(task, group[STEPS], "NSteps", H5T_NATIVE_INT64, 0, &none);
}
