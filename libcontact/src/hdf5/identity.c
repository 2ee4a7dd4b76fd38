#include "hdf5_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What a file says about the problem that it was written for, and whether another problem is the
 * same one. */

enum { LAYOUT = 1 };

/* The attributes of /libcontact. */
typedef struct attributes {
  int64_t layout, integrator;
  double integrator_parameter, dt;
} attributes;

static const ct_field ATTRIBUTE[] = {
    CT_FIELD(attributes, layout, CT_INT64, "layout"),
    CT_FIELD(attributes, integrator, CT_INT64, "the integrator"),
    CT_FIELD(attributes, integrator_parameter, CT_REAL, "the parameter of the integrator"),
    CT_FIELD(attributes, dt, CT_REAL, "the time step")};
enum { ATTRIBUTE_COUNT = sizeof ATTRIBUTE / sizeof ATTRIBUTE[0] };

/* One row of /libcontact/body. */
typedef struct body_row {
  char name[CT_NAME_SIZE];
  int32_t kind, first_node, node_count;
  int64_t first_cell, cell_count;
  double young, poisson, density;
  int32_t law; /* 0, small strain, where the file is older than the laws */
} body_row;

static const ct_field BODY_FIELD[] = {
    CT_FIELD(body_row, name, CT_NAME, "name"),
    CT_FIELD(body_row, kind, CT_INT32, "kind of elements"),
    CT_FIELD(body_row, first_node, CT_INT32, "number of nodes"),
    CT_FIELD(body_row, node_count, CT_INT32, "number of nodes"),
    CT_FIELD(body_row, first_cell, CT_INT64, "number of elements"),
    CT_FIELD(body_row, cell_count, CT_INT64, "number of elements"),
    CT_FIELD(body_row, young, CT_REAL, "Young's modulus"),
    CT_FIELD(body_row, poisson, CT_REAL, "Poisson's ratio"),
    CT_FIELD(body_row, density, CT_REAL, "density"),
    CT_FIELD(body_row, law, CT_INT32, "material law")};

/* One row of /libcontact/effects. */
typedef struct effect_row {
  char name[CT_NAME_SIZE];
  int32_t node_count;
  int32_t stores; /* whether the effect has a stored energy */
  int64_t memory_count;
} effect_row;

static const ct_field EFFECT_FIELD[] = {
    CT_FIELD(effect_row, name, CT_NAME, "name"),
    CT_FIELD(effect_row, node_count, CT_INT32, "number of nodes"),
    CT_FIELD(effect_row, stores, CT_INT32, NULL),
    CT_FIELD(effect_row, memory_count, CT_INT64, "number of values of memory")};

/* -- What the problem has -- */

static attributes attributes_of(const ct_problem *problem)
{
  attributes now = {LAYOUT, (int64_t)problem->integrator.scheme, problem->integrator.parameter,
                    problem->dt};
  return now;
}

static void fill_bodies(const ct_problem *problem, void *rows)
{
  body_row *row = rows;
  int64_t cell = 0;
  for (int32_t b = 0; b < problem->body_count; b++, row++) {
    const ct_body *body = &problem->bodies[b];
    snprintf(row->name, sizeof row->name, "%.63s", body->name);
    row->kind = (int32_t)body->mesh->kind;
    row->first_node = body->first_node;
    row->node_count = body->mesh->node_count;
    row->first_cell = cell;
    row->cell_count = body->mesh->element_count;
    row->young = body->material.young;
    row->poisson = body->material.poisson;
    row->density = body->material.density;
    row->law = (int32_t)body->material.law;
    cell += body->mesh->element_count;
  }
}

static void fill_effects(const ct_problem *problem, void *rows)
{
  effect_row *row = rows;
  for (int32_t i = 0; i < problem->effect_count; i++, row++) {
    const ct_effect *effect = problem->effects[i];
    snprintf(row->name, sizeof row->name, "%.63s", effect->label);
    row->node_count = effect->nodes == NULL ? problem->node_count : effect->node_count;
    row->stores = effect->energy != NULL;
    row->memory_count = effect->memory_count;
  }
}

/* -- Tables of a row a body or a row an effect -- */

typedef struct table {
  const char *name, *one, *many;
  ct_row_type row;
  void (*fill)(const ct_problem *problem, void *rows);
} table;

enum { BODIES, EFFECTS, TABLE_COUNT };
static const table TABLE[TABLE_COUNT] = {
    {"body", "body", "bodies", CT_ROW_TYPE(body_row, BODY_FIELD), fill_bodies},
    {"effects", "effect", "effects", CT_ROW_TYPE(effect_row, EFFECT_FIELD), fill_effects}};

/* Room for two tables, cleared, padding included; the first is filled from the problem. */
static char *create_rows(ct_task *task, const table *t, const ct_problem *problem, int32_t count)
{
  char *rows = task->status == CT_OK ? calloc(2 * (size_t)count + 1, t->row.size) : NULL;
  if (rows != NULL) t->fill(problem, rows);
  else if (task->status == CT_OK)
    task->status =
        ct_fail(task->error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the table of %s", t->name);
  return rows;
}

void ct_identity_write(ct_task *task, const ct_problem *problem, hid_t group)
{
  const attributes now = attributes_of(problem);
  for (int i = 0; i < ATTRIBUTE_COUNT; i++) {
    hid_t type = ct_hdf5_type(ATTRIBUTE[i].kind);
    ct_hdf5_write_attribute(task, group, ATTRIBUTE[i].name, type, 0,
                            (const char *)&now + ATTRIBUTE[i].offset);
    H5Tclose(type);
  }
  for (int i = 0; i < TABLE_COUNT; i++) {
    int32_t count = i == BODIES ? problem->body_count : problem->effect_count;
    const hsize_t length = (hsize_t)count;
    char *rows = create_rows(task, &TABLE[i], problem, count);
    hid_t type = ct_hdf5_row_type(&TABLE[i].row);
    ct_hdf5_write_array(task, group, TABLE[i].name, type, 1, &length, rows);
    H5Tclose(type);
    free(rows);
  }
}

/* -- Compare -- */

/* The first field in which two structs differ, or null. */
static const ct_field *difference(const ct_field *field, int count, const char *a, const char *b)
{
  for (int i = 0; i < count; i++)
    if (field[i].label != NULL &&
        memcmp(a + field[i].offset, b + field[i].offset, ct_hdf5_size(field[i].kind)) != 0)
      return &field[i];
  return NULL;
}

/* A file without the attributes is older than the choice of integrators. */
static attributes read_attributes(ct_task *task, hid_t group)
{
  attributes was = {0, CT_CENTRAL_DIFFERENCE, 0.0, 0.0};
  for (int i = 0; i < ATTRIBUTE_COUNT; i++) {
    hid_t type = ct_hdf5_type(ATTRIBUTE[i].kind);
    if (H5Aexists(group, ATTRIBUTE[i].name) > 0)
      ct_hdf5_read_attribute(task, group, ATTRIBUTE[i].name, type,
                             (char *)&was + ATTRIBUTE[i].offset);
    H5Tclose(type);
  }
  return was;
}

/* The first `count` attributes. */
static void compare_attributes(ct_task *task, const attributes *was, const attributes *is,
                               int count)
{
  const ct_field *other = difference(ATTRIBUTE, count, (const char *)was, (const char *)is);
  if (task->status != CT_OK || other == NULL) return;
  double value[2] = {0, 0};
  const char *from[2] = {(const char *)was + other->offset, (const char *)is + other->offset};
  for (int i = 0; i < 2; i++) {
    int64_t whole;
    memcpy(&whole, from[i], sizeof whole);
    if (other->kind == CT_REAL) memcpy(&value[i], from[i], sizeof value[i]);
    else value[i] = (double)whole;
  }
  task->status =
      ct_fail(task->error, CT_ERROR_FILE, CT_NOWHERE, "%s: the file has %s %.17g, %s %.17g",
              ct_disk_short(task->path), other->label, value[0],
              count == 1 ? "this library reads" : "the problem has", value[1]);
}

static void compare_rows(ct_task *task, const table *t, int32_t count, const char *is,
                         const char *was)
{
  for (int32_t i = 0; i < count && task->status == CT_OK; i++) {
    const char *a = was + (size_t)i * t->row.size, *b = is + (size_t)i * t->row.size;
    const ct_field *other = difference(t->row.field, t->row.field_count, a, b);
    ct_place where = {t == &TABLE[BODIES] ? i : -1, -1, -1};
    if (other == NULL) continue;
    task->status = ct_fail(
        task->error, CT_ERROR_FILE, where,
        "%s: the file belongs to another problem: %s %d '%.63s' (in the file '%.63s') has another "
        "%s",
        ct_disk_short(task->path), t->one, (int)i, b, a, other->label);
  }
}

static void compare_table(ct_task *task, const table *t, hid_t group, const ct_problem *problem)
{
  int32_t count = t == &TABLE[BODIES] ? problem->body_count : problem->effect_count;
  int64_t found = task->status == CT_OK ? ct_hdf5_row_count(group, t->name) : count;
  if (found != count)
    task->status = ct_fail(task->error, CT_ERROR_FILE, CT_NOWHERE,
                           "%s: the file belongs to another problem: it has %ld %s, the problem "
                           "%d",
                           ct_disk_short(task->path), (long)found, t->many, (int)count);
  const hsize_t length = (hsize_t)count;
  char *is = create_rows(task, t, problem, count);
  char *was = is == NULL ? NULL : is + (size_t)count * t->row.size;
  hid_t type = ct_hdf5_row_type(&t->row);
  ct_hdf5_read_array(task, group, t->name, type, 1, &length, was);
  compare_rows(task, t, count, is, was);
  H5Tclose(type);
  free(is);
}

static void compare_points(ct_task *task, hid_t file, const ct_problem *problem)
{
  const int64_t count = 3 * (int64_t)problem->node_count;
  const hsize_t shape[2] = {(hsize_t)problem->node_count, 3};
  double *points = malloc(((size_t)count + 1) * sizeof *points);
  if (points == NULL && task->status == CT_OK)
    task->status =
        ct_fail(task->error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the points of the file");
  ct_hdf5_read_array(task, file, "VTKHDF/Points", H5T_NATIVE_DOUBLE, 2, shape, points);
  for (int64_t i = 0; i < count && task->status == CT_OK; i++) {
    if (points[i] == problem->reference[i]) continue;
    ct_place where = {-1, -1, i / 3};
    task->status =
        ct_fail(task->error, CT_ERROR_FILE, where,
                "%s: the file belongs to another problem: node %ld stands at another place",
                ct_disk_short(task->path), (long)(i / 3));
  }
  free(points);
}

void ct_identity_compare(ct_task *task, hid_t file, hid_t group, const ct_problem *problem)
{
  const attributes is = attributes_of(problem), was = read_attributes(task, group);
  compare_attributes(task, &was, &is, 1);
  for (int i = 0; i < TABLE_COUNT; i++) compare_table(task, &TABLE[i], group, problem);
  compare_attributes(task, &was, &is, ATTRIBUTE_COUNT);
  compare_points(task, file, problem);
}
