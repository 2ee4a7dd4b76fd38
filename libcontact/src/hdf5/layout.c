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
  if (access < 0) return -1;
  herr_t done = H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V110);
#if H5_VERSION_GE(1, 12, 1) || (H5_VERS_MINOR == 10 && H5_VERSION_GE(1, 10, 7))
  if (done >= 0) done = H5Pset_file_locking(access, 0, 1);
#endif
  if (done >= 0) return access;
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

static ct_status write_grid(ct_output *o, const ct_problem *problem, hid_t vtk, hid_t cell_data,
                            ct_error *error)
{
  grid g = {NULL, NULL, NULL, NULL};
  hid_t whole = H5T_NATIVE_INT64;
  int64_t ids = connectivity_count(problem);
  const hsize_t one = 1, points[2] = {(hsize_t)o->node_count, 3}, cells = (hsize_t)o->cell_count,
                ends = cells + 1, length = (hsize_t)ids;
  ct_status status = grid_fill(problem, o->cell_count, &g, error);
  if (status == CT_OK)
    status =
        ct_hdf5_write_array(vtk, "NumberOfPoints", whole, 1, &one, &o->node_count, o->path, error);
  if (status == CT_OK)
    status =
        ct_hdf5_write_array(vtk, "NumberOfCells", whole, 1, &one, &o->cell_count, o->path, error);
  if (status == CT_OK)
    status =
        ct_hdf5_write_array(vtk, "NumberOfConnectivityIds", whole, 1, &one, &ids, o->path, error);
  if (status == CT_OK)
    status = ct_hdf5_write_array(vtk, "Points", H5T_NATIVE_DOUBLE, 2, points, problem->reference,
                                 o->path, error);
  if (status == CT_OK)
    status =
        ct_hdf5_write_array(vtk, "Connectivity", whole, 1, &length, g.connectivity, o->path, error);
  if (status == CT_OK)
    status = ct_hdf5_write_array(vtk, "Offsets", whole, 1, &ends, g.offsets, o->path, error);
  if (status == CT_OK)
    status =
        ct_hdf5_write_array(vtk, "Types", H5T_NATIVE_UCHAR, 1, &cells, g.types, o->path, error);
  if (status == CT_OK)
    status =
        ct_hdf5_write_array(cell_data, "body", H5T_NATIVE_INT32, 1, &cells, g.body, o->path, error);
  grid_free(&g);
  return status;
}

/* -- The datasets that grow -- */

static ct_status add_dataset(ct_output *o, int field, hid_t parent, const char *name, hid_t type,
                             int64_t rows, int64_t width, const void *source, ct_error *error)
{
  if (rows == 0) return CT_OK;
  ct_column *column = &o->column[o->column_count++];
  column->set = -1;
  column->type = type;
  column->rows = rows;
  column->width = width;
  column->is_field = field;
  column->source = source;
  return ct_hdf5_create_column(parent, name, o->path, column, error);
}

static ct_status add_column(ct_output *o, hid_t parent, const char *name, hid_t type, int64_t rows,
                            int64_t width, const void *source, ct_error *error)
{
  return add_dataset(o, 0, parent, name, type, rows, width, source, error);
}

static ct_status add_field(ct_output *o, hid_t parent, const char *name, int64_t rows,
                           int64_t width, const double *source, ct_error *error)
{
  return add_dataset(o, 1, parent, name, H5T_NATIVE_DOUBLE, rows, width, source, error);
}

typedef struct table {
  const char *name;
  hid_t type;
  int64_t width;
  const void *source;
} table;

static ct_status add_tables(ct_output *o, hid_t parent, const table *tables, int count,
                            ct_error *error)
{
  ct_status status = CT_OK;
  for (int i = 0; i < count && status == CT_OK; i++)
    status = add_column(o, parent, tables[i].name, tables[i].type, 1, tables[i].width,
                        tables[i].source, error);
  return status;
}

static ct_status create_step_tables(ct_output *o, hid_t steps, ct_error *error)
{
  const ct_record *now = &o->now;
  hid_t whole = H5T_NATIVE_INT64;
  const table tables[] = {{"Values", H5T_NATIVE_DOUBLE, 0, &now->energy.time},
                          {"PartOffsets", whole, 0, &now->zero},
                          {"NumberOfParts", whole, 0, &now->one},
                          {"PointOffsets", whole, 0, &now->zero},
                          {"CellOffsets", whole, 1, &now->zero},
                          {"ConnectivityIdOffsets", whole, 1, &now->zero}};
  return add_tables(o, steps, tables, sizeof tables / sizeof tables[0], error);
}

static ct_status create_point_fields(ct_output *o, hid_t data, hid_t offsets,
                                     const ct_output_options *options, ct_error *error)
{
  ct_status status = CT_OK;
  hid_t whole = H5T_NATIVE_INT64;
  o->displacement_column = -1;
  if (options->displacement) {
    o->displacement_column = o->column_count;
    status = add_field(o, data, "displacement", o->node_count, 3, NULL, error);
    if (status == CT_OK)
      status = add_column(o, offsets, "displacement", whole, 1, 0, &o->now.point_row, error);
  }
  if (options->velocity && status == CT_OK) {
    status = add_field(o, data, "velocity", o->node_count, 3, o->now.velocity, error);
    if (status == CT_OK)
      status = add_column(o, offsets, "velocity", whole, 1, 0, &o->now.point_row, error);
  }
  return status;
}

static ct_status create_cell_fields(ct_output *o, hid_t data, hid_t offsets,
                                    const ct_output_options *options, ct_error *error)
{
  ct_status status = add_column(o, offsets, "body", H5T_NATIVE_INT64, 1, 0, &o->now.zero, error);
  if (options->stress && status == CT_OK) {
    status = add_field(o, data, "stress", o->cell_count, 6, o->now.stress, error);
    if (status == CT_OK)
      status = add_column(o, offsets, "stress", H5T_NATIVE_INT64, 1, 0, &o->now.cell_row, error);
  }
  return status;
}

static ct_status create_ledger_fields(ct_output *o, hid_t data, hid_t offsets, ct_error *error)
{
  const ct_energy *energy = &o->now.energy;
  hid_t real = H5T_NATIVE_DOUBLE;
  const table tables[] = {{"kinetic", real, 0, &energy->kinetic},
                          {"strain", real, 0, &energy->strain},
                          {"contact", real, 0, &energy->contact},
                          {"external", real, 0, &energy->external},
                          {"total", real, 0, &energy->total},
                          {"balance", real, 0, &energy->balance},
                          {"momentum", real, 3, &o->now.momentum},
                          {"angular_momentum", real, 3, &o->now.angular_momentum}};
  ct_status status = add_tables(o, data, tables, sizeof tables / sizeof tables[0], error);
  for (size_t i = 0; i < sizeof tables / sizeof tables[0] && status == CT_OK; i++)
    status =
        add_column(o, offsets, tables[i].name, H5T_NATIVE_INT64, 1, 0, &o->now.step_row, error);
  return status;
}

/* -- The group VTKHDF -- */

enum {
  VTK_GROUP,
  POINT_DATA,
  CELL_DATA,
  FIELD_DATA,
  STEPS,
  POINT_OFFSETS,
  CELL_OFFSETS,
  FIELD_OFFSETS,
  GROUP_COUNT
};

static ct_status open_groups(ct_output *o, hid_t group[GROUP_COUNT], ct_error *error)
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
                         {"FieldDataOffsets", STEPS}};
  ct_status status = CT_OK;
  for (int i = 0; i < GROUP_COUNT && status == CT_OK; i++)
    status = ct_hdf5_create_group(i == 0 ? o->file : group[PLAN[i].parent], PLAN[i].name, o->path,
                                  &group[i], error);
  return status;
}

static ct_status create_vtk(ct_output *o, const ct_problem *problem,
                            const ct_output_options *options, ct_error *error)
{
  hid_t group[GROUP_COUNT];
  for (int i = 0; i < GROUP_COUNT; i++) group[i] = -1;
  const int64_t version[2] = {2, 2}, none = 0;
  ct_status status = open_groups(o, group, error);
  if (status == CT_OK)
    status = ct_hdf5_write_attribute(group[VTK_GROUP], "Version", H5T_NATIVE_INT64, 2, version,
                                     o->path, NULL, error);
  if (status == CT_OK)
    status = ct_hdf5_write_label(group[VTK_GROUP], "Type", "UnstructuredGrid", o->path, error);
  if (status == CT_OK) status = write_grid(o, problem, group[VTK_GROUP], group[CELL_DATA], error);
  if (status == CT_OK) status = create_step_tables(o, group[STEPS], error);
  if (status == CT_OK)
    status = create_point_fields(o, group[POINT_DATA], group[POINT_OFFSETS], options, error);
  if (status == CT_OK)
    status = create_cell_fields(o, group[CELL_DATA], group[CELL_OFFSETS], options, error);
  if (status == CT_OK)
    status = create_ledger_fields(o, group[FIELD_DATA], group[FIELD_OFFSETS], error);
  if (status == CT_OK)
    status = ct_hdf5_write_attribute(group[STEPS], "NSteps", H5T_NATIVE_INT64, 0, &none, o->path,
                                     &o->step_count, error);
  for (int i = GROUP_COUNT - 1; i >= 0; i--)
    if (group[i] >= 0) H5Gclose(group[i]);
  return status;
}

/* -- The group libcontact -- */

static ct_status create_own(ct_output *o, const ct_problem *problem,
                            const ct_output_options *options, ct_error *error)
{
  hid_t group = -1;
  const int64_t layout = CT_LAYOUT;
  ct_record *now = &o->now;
  ct_status status = ct_hdf5_create_group(o->file, "libcontact", o->path, &group, error);
  if (status == CT_OK)
    status = ct_hdf5_write_attribute(group, "layout", H5T_NATIVE_INT64, 0, &layout, o->path, NULL,
                                     error);
  if (status == CT_OK)
    status = ct_hdf5_write_attribute(group, "dt", H5T_NATIVE_DOUBLE, 0, &problem->dt, o->path, NULL,
                                     error);
  if (status == CT_OK)
    status = ct_identity_write_integrator(&problem->integrator, group, o->path, error);
  if (status == CT_OK) status = ct_hdf5_write_label(group, "version", ct_version(), o->path, error);
  if (status == CT_OK && options->scene != NULL)
    status = ct_hdf5_write_text(group, "scene", options->scene, o->path, error);
  if (status == CT_OK) status = ct_identity_write(o, problem, group, error);
  if (status == CT_OK)
    status = add_column(o, group, "step", H5T_NATIVE_INT64, 1, 0, &now->step, error);
  if (status == CT_OK)
    status = add_column(o, group, "energy", o->energy_type, 1, 0, &now->energy, error);
  if (status == CT_OK)
    status =
        add_column(o, group, "momentum", o->momentum_type, o->body_count, 0, now->bodies, error);
  if (status == CT_OK)
    status =
        add_column(o, group, "effect", o->effect_type, o->effect_count, 0, now->effects, error);
  if (group >= 0) H5Gclose(group);
  return status;
}

ct_status ct_layout_create(ct_output *output, const ct_problem *problem,
                           const ct_output_options *options, ct_error *error)
{
  ct_status status = create_vtk(output, problem, options, error);
  return status == CT_OK ? create_own(output, problem, options, error) : status;
}

int64_t ct_layout_bytes(const ct_output *o, const ct_problem *problem,
                        const ct_output_options *options)
{
  int64_t text = options->scene == NULL ? 0 : (int64_t)strlen(options->scene);
  int64_t mesh = 24 * o->node_count + 8 * connectivity_count(problem) + 13 * (o->cell_count + 1);
  int64_t rows = 128 * ((int64_t)o->body_count + o->effect_count);
  return text + mesh + rows;
}
