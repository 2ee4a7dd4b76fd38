#include "hdf5_internal.h"

#include <stdlib.h>
#include <string.h>

/* What a file says about the problem that it was written for, and whether another problem is the
 * same one. */

/* One row of /libcontact/body. */
typedef struct body_row {
  char name[64];
  int32_t kind, first_node, node_count;
  int64_t first_cell, cell_count;
  double young, poisson, density;
  int32_t law; /* 0, small strain, where the file is older than the laws */
} body_row;

/* One row of /libcontact/effects. */
typedef struct effect_name_row {
  char name[64];
  int32_t node_count;
  int32_t stores; /* whether the effect has a stored energy */
  int64_t memory_count;
} effect_name_row;

/* -- Write -- */

static hid_t name_type(void)
{
  hid_t type = H5Tcopy(H5T_C_S1);
  if (type >= 0 && (H5Tset_size(type, 64) < 0 || H5Tset_cset(type, H5T_CSET_UTF8) < 0)) {
    H5Tclose(type);
    return -1;
  }
  return type;
}

typedef struct member {
  const char *name;
  size_t offset;
  hid_t type;
} member;

/* The type of the rows in memory, padding included: rows are cleared before they are filled. */
static hid_t row_type(size_t size, const member *members, int count)
{
  hid_t name = name_type(), type = H5Tcreate(H5T_COMPOUND, size);
  int good = name >= 0 && type >= 0 && H5Tinsert(type, "name", 0, name) >= 0;
  for (int i = 0; i < count && good; i++)
    good = H5Tinsert(type, members[i].name, members[i].offset, members[i].type) >= 0;
  if (name >= 0) H5Tclose(name);
  if (good) return type;
  if (type >= 0) H5Tclose(type);
  return -1;
}

static hid_t body_type(void)
{
  const member members[] = {{"kind", HOFFSET(body_row, kind), H5T_NATIVE_INT32},
                            {"first_node", HOFFSET(body_row, first_node), H5T_NATIVE_INT32},
                            {"node_count", HOFFSET(body_row, node_count), H5T_NATIVE_INT32},
                            {"first_cell", HOFFSET(body_row, first_cell), H5T_NATIVE_INT64},
                            {"cell_count", HOFFSET(body_row, cell_count), H5T_NATIVE_INT64},
                            {"young", HOFFSET(body_row, young), H5T_NATIVE_DOUBLE},
                            {"poisson", HOFFSET(body_row, poisson), H5T_NATIVE_DOUBLE},
                            {"density", HOFFSET(body_row, density), H5T_NATIVE_DOUBLE},
                            {"law", HOFFSET(body_row, law), H5T_NATIVE_INT32}};
  return row_type(sizeof(body_row), members, sizeof members / sizeof members[0]);
}

static hid_t effect_name_type(void)
{
  const member members[] = {
      {"node_count", HOFFSET(effect_name_row, node_count), H5T_NATIVE_INT32},
      {"stores", HOFFSET(effect_name_row, stores), H5T_NATIVE_INT32},
      {"memory_count", HOFFSET(effect_name_row, memory_count), H5T_NATIVE_INT64}};
  return row_type(sizeof(effect_name_row), members, sizeof members / sizeof members[0]);
}

static body_row *body_rows(const ct_problem *problem)
{
  body_row *rows = calloc((size_t)problem->body_count + 1, sizeof *rows);
  int64_t cell = 0;
  for (int32_t b = 0; b < problem->body_count && rows != NULL; b++) {
    const ct_body *body = &problem->bodies[b];
    memcpy(rows[b].name, body->name, sizeof rows[b].name - 1);
    for (size_t i = strlen(rows[b].name); i < sizeof rows[b].name; i++) rows[b].name[i] = 0;
    rows[b].kind = (int32_t)body->mesh->kind;
    rows[b].first_node = body->first_node;
    rows[b].node_count = body->mesh->node_count;
    rows[b].first_cell = cell;
    rows[b].cell_count = body->mesh->element_count;
    rows[b].young = body->material.young;
    rows[b].poisson = body->material.poisson;
    rows[b].density = body->material.density;
    rows[b].law = (int32_t)body->material.law;
    cell += body->mesh->element_count;
  }
  return rows;
}

static effect_name_row *effect_rows(const ct_problem *problem)
{
  effect_name_row *rows = calloc((size_t)problem->effect_count + 1, sizeof *rows);
  for (int32_t i = 0; i < problem->effect_count && rows != NULL; i++) {
    const ct_effect *effect = problem->effects[i];
    strncpy(rows[i].name, effect->label, sizeof rows[i].name - 1);
    rows[i].node_count = effect->nodes == NULL ? problem->node_count : effect->node_count;
    rows[i].stores = effect->energy != NULL;
    rows[i].memory_count = effect->memory_count;
  }
  return rows;
}

static ct_status write_rows(hid_t parent, const char *name, hid_t type, int32_t count,
                            const void *rows, const char *path, ct_error *error)
{
  const hsize_t length = (hsize_t)count;
  if (rows == NULL)
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the table of %s", name);
  if (type < 0) return ct_hdf5_fail(error, path, "make a table");
  return ct_hdf5_write_array(parent, name, type, 1, &length, rows, path, error);
}

ct_status ct_identity_write(const ct_output *o, const ct_problem *problem, hid_t group,
                            ct_error *error)
{
  hid_t body = body_type(), effect = effect_name_type();
  body_row *bodies = body_rows(problem);
  effect_name_row *effects = effect_rows(problem);
  ct_status status = write_rows(group, "body", body, o->body_count, bodies, o->path, error);
  if (status == CT_OK)
    status = write_rows(group, "effects", effect, o->effect_count, effects, o->path, error);
  free(effects);
  free(bodies);
  if (effect >= 0) H5Tclose(effect);
  if (body >= 0) H5Tclose(body);
  return status;
}

ct_status ct_identity_write_integrator(const ct_integrator *integrator, hid_t group,
                                       const char *path, ct_error *error)
{
  const int64_t scheme = (int64_t)integrator->scheme;
  ct_status status =
      ct_hdf5_write_attribute(group, "integrator", H5T_NATIVE_INT64, 0, &scheme, path, NULL, error);
  if (status == CT_OK)
    status = ct_hdf5_write_attribute(group, "integrator_parameter", H5T_NATIVE_DOUBLE, 0,
                                     &integrator->parameter, path, NULL, error);
  return status;
}

/* -- Compare -- */

/* A file without the attributes is older than the choice of integrators. */
static ct_status compare_integrator(hid_t group, const ct_integrator *is, const char *path,
                                    ct_error *error)
{
  int64_t scheme = CT_CENTRAL_DIFFERENCE;
  double parameter = 0.0;
  ct_status status = CT_OK;
  if (H5Aexists(group, "integrator") > 0) {
    status = ct_hdf5_read_attribute(group, "integrator", H5T_NATIVE_INT64, &scheme, path, error);
    if (status == CT_OK)
      status = ct_hdf5_read_attribute(group, "integrator_parameter", H5T_NATIVE_DOUBLE, &parameter,
                                      path, error);
  }
  if (status != CT_OK || (scheme == (int64_t)is->scheme && parameter == is->parameter))
    return status;
  return ct_fail(error, CT_ERROR_FILE, CT_NOWHERE,
                 "%s: the file was written with the integrator %ld and parameter %.17g, the "
                 "problem has %s with %.17g",
                 ct_disk_short(path), (long)scheme, parameter, ct_scheme_name(is->scheme),
                 is->parameter);
}

static ct_status other_body(const body_row *was, const body_row *is, int32_t b, const char *path,
                            ct_error *error)
{
  const char *what = NULL;
  if (strcmp(was->name, is->name) != 0) what = "name";
  else if (was->kind != is->kind) what = "kind of elements";
  else if (was->first_node != is->first_node || was->node_count != is->node_count)
    what = "number of nodes";
  else if (was->first_cell != is->first_cell || was->cell_count != is->cell_count)
    what = "number of elements";
  else if (was->young != is->young) what = "Young's modulus";
  else if (was->poisson != is->poisson) what = "Poisson's ratio";
  else if (was->density != is->density) what = "density";
  else if (was->law != is->law) what = "material law";
  if (what == NULL) return CT_OK;
  ct_place where = {b, -1, -1};
  return ct_fail(
      error, CT_ERROR_FILE, where,
      "%s: the file belongs to another problem: body %d '%s' (in the file '%s') has another %s",
      ct_disk_short(path), (int)b, is->name, was->name, what);
}

static ct_status compare_bodies(hid_t group, const ct_problem *problem, const char *path,
                                ct_error *error)
{
  int64_t found = ct_hdf5_row_count(group, "body");
  if (found != problem->body_count)
    return ct_fail(error, CT_ERROR_FILE, CT_NOWHERE,
                   "%s: the file belongs to another problem: it has %ld bodies, the problem %d",
                   ct_disk_short(path), (long)found, (int)problem->body_count);
  const hsize_t count = (hsize_t)found;
  hid_t type = body_type();
  body_row *now = body_rows(problem), *was = calloc((size_t)found + 1, sizeof *was);
  ct_status status = CT_OK;
  if (now == NULL || was == NULL)
    status = ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the table of bodies");
  else if (type < 0) status = ct_hdf5_fail(error, path, "read the bodies");
  else status = ct_hdf5_read_array(group, "body", type, 1, &count, was, path, error);
  for (int32_t b = 0; b < problem->body_count && status == CT_OK; b++) {
    was[b].name[63] = 0;
    status = other_body(&was[b], &now[b], b, path, error);
  }
  free(was);
  free(now);
  if (type >= 0) H5Tclose(type);
  return status;
}

static ct_status compare_effects(hid_t group, const ct_problem *problem, const char *path,
                                 ct_error *error)
{
  int64_t found = ct_hdf5_row_count(group, "effects");
  if (found != problem->effect_count)
    return ct_fail(error, CT_ERROR_FILE, CT_NOWHERE,
                   "%s: the file belongs to another problem: it has %ld effects, the problem %d",
                   ct_disk_short(path), (long)found, (int)problem->effect_count);
  const hsize_t count = (hsize_t)found;
  hid_t type = effect_name_type();
  effect_name_row *now = effect_rows(problem), *was = calloc((size_t)found + 1, sizeof *was);
  ct_status status = CT_OK;
  if (now == NULL || was == NULL)
    status = ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the table of effects");
  else if (type < 0) status = ct_hdf5_fail(error, path, "read the effects");
  else status = ct_hdf5_read_array(group, "effects", type, 1, &count, was, path, error);
  for (int32_t i = 0; i < problem->effect_count && status == CT_OK; i++) {
    was[i].name[63] = 0;
    if (strcmp(was[i].name, now[i].name) == 0 && was[i].node_count == now[i].node_count &&
        was[i].memory_count == now[i].memory_count)
      continue;
    status = ct_fail(error, CT_ERROR_FILE, CT_NOWHERE,
                     "%s: the file belongs to another problem: effect %d is '%s' on %d nodes with "
                     "%ld values of memory, "
                     "in the file '%s' on %d nodes with %ld",
                     ct_disk_short(path), (int)i, now[i].name, (int)now[i].node_count,
                     (long)now[i].memory_count, was[i].name, (int)was[i].node_count,
                     (long)was[i].memory_count);
  }
  free(was);
  free(now);
  if (type >= 0) H5Tclose(type);
  return status;
}

ct_status ct_identity_compare(hid_t group, const ct_problem *problem, const char *path,
                              ct_error *error)
{
  int64_t layout = 0;
  double dt = 0;
  ct_status status =
      ct_hdf5_read_attribute(group, "layout", H5T_NATIVE_INT64, &layout, path, error);
  if (status == CT_OK && layout != CT_LAYOUT)
    status = ct_fail(error, CT_ERROR_FILE, CT_NOWHERE,
                     "%s: the file has layout %ld, this library reads layout %d",
                     ct_disk_short(path), (long)layout, CT_LAYOUT);
  if (status == CT_OK) status = compare_bodies(group, problem, path, error);
  if (status == CT_OK) status = compare_effects(group, problem, path, error);
  if (status == CT_OK) status = compare_integrator(group, &problem->integrator, path, error);
  if (status == CT_OK)
    status = ct_hdf5_read_attribute(group, "dt", H5T_NATIVE_DOUBLE, &dt, path, error);
  if (status == CT_OK && dt != problem->dt)
    status = ct_fail(error, CT_ERROR_FILE, CT_NOWHERE,
                     "%s: the file was written with the time step %.17g, the problem has %.17g",
                     ct_disk_short(path), dt, problem->dt);
  return status;
}

ct_status ct_identity_compare_points(hid_t file, const ct_problem *problem, const char *path,
                                     ct_error *error)
{
  const hsize_t shape[2] = {(hsize_t)problem->node_count, 3};
  double *points = malloc((3 * (size_t)problem->node_count + 1) * sizeof *points);
  if (points == NULL)
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the points of the file");
  ct_status status =
      ct_hdf5_read_array(file, "VTKHDF/Points", H5T_NATIVE_DOUBLE, 2, shape, points, path, error);
  for (int64_t i = 0; i < 3 * (int64_t)problem->node_count && status == CT_OK; i++) {
    if (points[i] == problem->reference[i]) continue;
    ct_place where = {-1, -1, i / 3};
    status = ct_fail(error, CT_ERROR_FILE, where,
                     "%s: the file belongs to another problem: node %ld stands at another place",
                     ct_disk_short(path), (long)(i / 3));
  }
  free(points);
  return status;
}
