#include "hdf5_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Identity of the problem in a file, and comparison with another problem. */

/* What the restart record stores: 0 (no attribute) in files of version 0.1; 1 where contacts kept
 * nothing of an impact. */
enum { LAYOUT = 1, RESTART = 2 };

/* An attribute of /libcontact. */
typedef struct attribute {
  const char *name, *label;
  hid_t type;
  double value;
} attribute;

/* The step is the last one. */
enum { STEP = 4, ATTRIBUTE_COUNT };

/* One row of /libcontact/body. */
typedef struct body_row {
  char name[CT_NAME_SIZE];
  int32_t kind, first_node, node_count, empty;
  int64_t first_cell, cell_count;
  double young, poisson, density;
  int32_t law, rigid; /* 0: small strain, and not rigid, in files older than these */
  /* Hashes of the node numbers of its elements, and of its materials by element; 0 in older files,
   * and with one material. */
  uint64_t elements, materials;
} body_row;

static const ct_row_type BODY_ROW = {
    sizeof(body_row),
    {CT_FIELD(body_row, name, CT_NAME, "name"),
     CT_FIELD(body_row, kind, CT_INT32, "kind of elements"),
     CT_FIELD(body_row, first_node, CT_INT32, "number of nodes"),
     CT_FIELD(body_row, node_count, CT_INT32, "number of nodes"),
     CT_FIELD(body_row, first_cell, CT_INT64, "number of elements"),
     CT_FIELD(body_row, cell_count, CT_INT64, "number of elements"),
     CT_FIELD(body_row, young, CT_REAL, "Young's modulus"),
     CT_FIELD(body_row, poisson, CT_REAL, "Poisson's ratio"),
     CT_FIELD(body_row, density, CT_REAL, "density"),
     CT_FIELD(body_row, law, CT_INT32, "material law"),
     CT_FIELD(body_row, rigid, CT_INT32, "rigidity"),
     CT_FIELD(body_row, elements, CT_WORD, "list of elements"),
     CT_FIELD(body_row, materials, CT_WORD, "set of materials")}};

/* One row of /libcontact/effects. */
typedef struct effect_row {
  char name[CT_NAME_SIZE];
  int32_t node_count, stores; /* whether the effect has a stored energy */
  int64_t memory_count;
  uint64_t nodes; /* hash of its node numbers; 0 if it acts on all, and in older files */
} effect_row;

static const ct_row_type EFFECT_ROW = {
    sizeof(effect_row),
    {CT_FIELD(effect_row, name, CT_NAME, "name"),
     CT_FIELD(effect_row, node_count, CT_INT32, "number of nodes"),
     CT_FIELD(effect_row, stores, CT_INT32, NULL),
     CT_FIELD(effect_row, memory_count, CT_INT64, "number of values of memory"),
     CT_FIELD(effect_row, nodes, CT_WORD, "set of nodes")}};

/* -- What the problem has -- */

static void fill_attributes(const ct_problem *problem, attribute attributes[ATTRIBUTE_COUNT])
{
  const ct_integrator *integrator = &problem->integrator;
  const attribute all[ATTRIBUTE_COUNT] = {
      {"layout", "layout", H5T_NATIVE_INT64, LAYOUT},
      {"restart_layout", "restart records of layout", H5T_NATIVE_INT64, RESTART},
      {"integrator", "the integrator", H5T_NATIVE_INT64, (double)integrator->scheme},
      {"integrator_parameter", "the parameter of the integrator", H5T_NATIVE_DOUBLE,
       integrator->parameter},
      {"dt", "the time step", H5T_NATIVE_DOUBLE, problem->dt}};
  memcpy(attributes, all, sizeof all);
}

/* A hash of numbers in their order (FNV-1a), never 0. */
static uint64_t hash_of(const int32_t *numbers, int64_t count)
{
  uint64_t hash = 0xcbf29ce484222325ULL;
  for (int64_t i = 0; i < count; i++) hash = (hash ^ (uint32_t)numbers[i]) * 0x100000001b3ULL;
  return hash | 1;
}

/* A hash of the materials of a body's elements; 0 if it has one. */
static uint64_t hash_of_materials(const ct_body *body)
{
  uint64_t hash = 0;
  for (int32_t e = 0; body->materials != NULL && e < body->mesh->element_count; e++) {
    const ct_material *m = &body->materials[e];
    const double constants[4] = {m->young, m->poisson, m->density, (double)m->law};
    int32_t words[8];
    memcpy(words, constants, sizeof words);
    hash = 31 * hash + hash_of(words, 8);
  }
  return hash;
}

static void fill_bodies(const ct_problem *problem, void *rows)
{
  body_row *row = rows;
  int64_t cell = 0;
  for (int32_t b = 0; b < problem->body_count; cell += row++->cell_count, b++) {
    const ct_body *body = &problem->bodies[b];
    const ct_material *material = &body->material;
    *row = (body_row){
        .kind = (int32_t)body->mesh->kind,
        .first_node = body->first_node,
        .node_count = body->mesh->node_count,
        .first_cell = cell,
        .cell_count = body->mesh->element_count,
        .young = material->young,
        .poisson = material->poisson,
        .density = material->density,
        .law = (int32_t)material->law,
        .rigid = ct_problem_is_rigid(problem, b),
        .elements = hash_of(body->mesh->elements, (int64_t)ct_brick_node_count(body->mesh->kind) *
                                                      body->mesh->element_count),
        .materials = hash_of_materials(body)};
    snprintf(row->name, sizeof row->name, "%.63s", body->name);
  }
}

static void fill_effects(const ct_problem *problem, void *rows)
{
  effect_row *row = rows;
  for (int32_t i = 0; i < problem->effect_count; i++, row++) {
    const ct_effect *effect = problem->effects[i];
    snprintf(row->name, sizeof row->name, "%.63s", effect->label);
    row->node_count = effect->nodes == NULL ? problem->node_count : effect->node_count;
    row->stores = effect->calls->energy != NULL;
    row->memory_count = effect->memory_count;
    row->nodes = effect->nodes == NULL ? 0 : hash_of(effect->nodes, effect->node_count);
  }
}

/* -- Tables of a row a body or a row an effect -- */

typedef struct table {
  const char *name, *one;
  const ct_row_type *row;
  void (*fill)(const ct_problem *problem, void *rows);
} table;

enum { BODIES, EFFECTS, TABLE_COUNT };
static const table TABLE[TABLE_COUNT] = {
    {"libcontact/body", "body", &BODY_ROW, fill_bodies},
    {"libcontact/effects", "effect", &EFFECT_ROW, fill_effects}};

/* Memory for two tables, cleared with its padding; the first is filled from the problem. */
static char *create_rows(ct_task *task, const table *t, const ct_problem *problem, hsize_t *count)
{
  *count = (hsize_t)(t == &TABLE[BODIES] ? problem->body_count : problem->effect_count);
  char *rows = calloc(2 * (size_t)*count + 1, t->row->size);
  if (rows != NULL) t->fill(problem, rows);
  else ct_task_fail(task, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the table of %s", t->name);
  return rows;
}

void ct_identity_write(ct_task *task, const ct_problem *problem)
{
  attribute now[ATTRIBUTE_COUNT];
  fill_attributes(problem, now);
  for (const attribute *a = now; a < now + ATTRIBUTE_COUNT; a++)
    ct_hdf5_write_attribute(task, "libcontact", a->name, a->type, 0, &a->value);
  for (const table *t = TABLE; t < TABLE + TABLE_COUNT; t++) {
    hsize_t count;
    char *rows = create_rows(task, t, problem, &count);
    hid_t type = ct_hdf5_row_type(t->row);
    ct_hdf5_write_array(task, t->name, type, 1, &count, rows);
    H5Tclose(type);
    free(rows);
  }
}

/* -- Compare -- */

static void compare_attribute(ct_task *task, const attribute *is, const char *whose)
{
  double was = ct_hdf5_read_number(task, "libcontact", is->name);
  if (was != is->value)
    ct_task_fail(task, CT_ERROR_FILE, CT_NOWHERE, "the file has %s %.17g, %s %.17g", is->label, was,
                 whose, is->value);
}

/* Whether a field differs. A hash that is 0 in the file is unknown. */
static int differs(const ct_field *f, const char *is, const char *was)
{
  static const uint64_t unknown = 0;
  if (f->label == NULL || memcmp(is + f->offset, was + f->offset, f->size) == 0) return 0;
  return f->kind != CT_WORD || memcmp(was + f->offset, &unknown, sizeof unknown) != 0;
}

/* Two rows of a table agree in each field that has a label. */
static void compare_row(ct_task *task, const table *t, int number, const char *is, const char *was)
{
  const ct_field *f = t->row->field;
  const ct_place where = {t == &TABLE[BODIES] ? number : -1, -1, -1};
  while (f->name != NULL && !differs(f, is, was)) f++;
  if (f->name != NULL)
    ct_task_fail(task, CT_ERROR_FILE, where,
                 "the file belongs to another problem: %s %d '%.63s' (in the file '%.63s') has "
                 "another %s",
                 t->one, number, is, was, f->label);
}

static void compare_table(ct_task *task, const table *t, const ct_problem *problem)
{
  hsize_t count;
  size_t size = t->row->size;
  char *is = create_rows(task, t, problem, &count), *was = is == NULL ? NULL : is + count * size;
  hid_t type = ct_hdf5_row_type(t->row);
  ct_hdf5_read_array(task, t->name, type, 1, &count, was);
  for (size_t i = 0; i < count && task->status == CT_OK; i++)
    compare_row(task, t, (int)i, is + i * size, was + i * size);
  H5Tclose(type);
  free(is);
}

static void compare_points(ct_task *task, const ct_problem *problem, double *points)
{
  const hsize_t shape[2] = {(hsize_t)problem->node_count, 3};
  ct_hdf5_read_array(task, "VTKHDF/Points", H5T_NATIVE_DOUBLE, 2, shape, points);
  for (int64_t i = 0; i < 3 * (int64_t)problem->node_count && task->status == CT_OK; i++) {
    int32_t b = problem->body_count - 1;
    while (b > 0 && problem->bodies[b].first_node > i / 3) b--;
    const ct_place where = {b, -1, i / 3};
    if (points[i] != problem->reference[i])
      ct_task_fail(task, CT_ERROR_FILE, where,
                   "the file belongs to another problem: node %ld has another position",
                   (long)(i / 3));
  }
}

/* Refuse restart records of an older library. */
static void compare_restart(ct_task *task, const attribute *is)
{
  static const char *const WHY[RESTART] = {"is of version 0.1",
                                           "is older than the key restitution"};
  const double was = ct_hdf5_read_number(task, "libcontact", is->name);
  for (int layout = 0; layout < RESTART; layout++)
    if (was == layout)
      ct_task_fail(task, CT_ERROR_FILE, CT_NOWHERE,
                   "the file %s: its results can be read, but its run can't be continued; run the "
                   "scene again from its start",
                   WHY[layout]);
  compare_attribute(task, is, "this library continues");
}

/* The layout is compared first, so that no field is compared which this layout lacks. */
double ct_identity_compare(ct_task *task, const ct_problem *problem, double *points)
{
  attribute is[ATTRIBUTE_COUNT];
  fill_attributes(problem, is);
  compare_attribute(task, &is[0], "this library reads");
  compare_restart(task, &is[1]);
  for (const table *t = TABLE; t < TABLE + TABLE_COUNT; t++) compare_table(task, t, problem);
  for (int i = 2; i < STEP; i++) compare_attribute(task, &is[i], "the problem has");
  compare_points(task, problem, points);
  return ct_hdf5_read_number(task, "libcontact", is[STEP].name);
}
