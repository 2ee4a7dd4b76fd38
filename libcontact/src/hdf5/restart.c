#include "hdf5_internal.h"

#include <stdio.h>
#include <string.h>

/* The record is kept twice, in the groups restart/a and restart/b, written in turn. Both are
 * datasets of fixed size that stand in the file from the start, so that a write changes no byte but
 * their own; the seal tells whether all of them have arrived. */
static const char *const SLOT[2] = {"a", "b"};

typedef struct part {
  const char *name;
  double *values;
  int64_t count;
} part;

/* Says that a record is whole: its number in the file, its place in the run, and the sums of
 * :eq:`restart-seal`. */
typedef struct ct_seal {
  uint64_t sequence;
  int64_t step;
  int64_t row;
  double time;
  double kinetic_start;
  uint64_t sum;
  uint64_t weighted;
} ct_seal;

/* The members before the sums. */
enum { SEALED_WORDS = 5 };

static void restart_parts(const ct_state *state, part parts[CT_PART_COUNT])
{
  int64_t nodes = 3 * (int64_t)state->node_count;
  const part all[CT_PART_COUNT] = {{"displacement", state->displacement, nodes},
                                   {"velocity", state->velocity, nodes},
                                   {"work", state->work, state->work_count},
                                   {"impulse", state->impulse, state->impulse_count},
                                   {"memory", state->memory, state->memory_count}};
  memcpy(parts, all, sizeof all);
}

/* -- The seal -- */

typedef struct sums {
  uint64_t count, sum, weighted;
} sums;

/* Sums of the bits of the values, modulo 2^64 (eq:restart-seal) */
static void add_words(sums *s, const void *values, int64_t count)
{
  const unsigned char *bytes = values;
  for (int64_t i = 0; i < count; i++) {
    uint64_t word;
    memcpy(&word, bytes + 8 * i, 8);
    s->sum += word;
    s->weighted += ++s->count * word;
  }
}

static void fill_seal(ct_seal *seal, const part parts[CT_PART_COUNT])
{
  sums s = {0, 0, 0};
  add_words(&s, seal, SEALED_WORDS);
  for (int i = 0; i < CT_PART_COUNT; i++) add_words(&s, parts[i].values, parts[i].count);
  seal->sum = s.sum;
  seal->weighted = s.weighted;
}

static const ct_field SEAL_FIELD[] = {
    CT_FIELD(ct_seal, sequence, CT_WORD, NULL),      CT_FIELD(ct_seal, step, CT_INT64, NULL),
    CT_FIELD(ct_seal, row, CT_INT64, NULL),          CT_FIELD(ct_seal, time, CT_REAL, NULL),
    CT_FIELD(ct_seal, kinetic_start, CT_REAL, NULL), CT_FIELD(ct_seal, sum, CT_WORD, NULL),
    CT_FIELD(ct_seal, weighted, CT_WORD, NULL)};
static const ct_row_type SEAL = CT_ROW_TYPE(ct_seal, SEAL_FIELD);

/* -- Write -- */

int64_t ct_restart_bytes(const ct_state *state)
{
  return 16 * (6 * (int64_t)state->node_count + state->work_count + state->impulse_count +
               state->memory_count);
}

int ct_restart_fits(const ct_output *output, const ct_state *state)
{
  part parts[CT_PART_COUNT];
  restart_parts(state, parts);
  for (int i = 0; i < CT_PART_COUNT; i++)
    if (output->part_count[i] != parts[i].count) return 0;
  return 1;
}

/* The first two arrays have three columns. */
static int part_shape(int number, int64_t count, hsize_t shape[2])
{
  shape[0] = (hsize_t)(number < 2 ? count / 3 : count);
  shape[1] = 3;
  return number < 2 ? 2 : 1;
}

static void create_slot(ct_task *task, hid_t parent, const char *name, hid_t seal,
                        const part parts[CT_PART_COUNT], hid_t set[CT_PART_COUNT + 1])
{
  hid_t group = ct_hdf5_create_group(task, parent, name);
  for (int i = 0; i < CT_PART_COUNT; i++) {
    hsize_t shape[2];
    int rank = part_shape(i, parts[i].count, shape);
    set[i] = ct_hdf5_create_array(task, group, parts[i].name, H5T_NATIVE_DOUBLE, rank, shape);
  }
  set[CT_PART_COUNT] = ct_hdf5_create_array(task, group, "seal", seal, 0, NULL);
}

void ct_restart_create_slots(ct_task *task, ct_output *output, const ct_state *state)
{
  part parts[CT_PART_COUNT];
  restart_parts(state, parts);
  for (int i = 0; i < CT_PART_COUNT; i++) output->part_count[i] = parts[i].count;
  output->seal_type = ct_hdf5_row_type(&SEAL);
  hid_t group = ct_hdf5_create_group(task, output->file, "libcontact/restart");
  for (int slot = 0; slot < 2; slot++)
    create_slot(task, group, SLOT[slot], output->seal_type, parts, output->slot[slot]);
}

void ct_restart_write(ct_task *task, const ct_output *output, const ct_state *state)
{
  part parts[CT_PART_COUNT];
  const hid_t *set = output->slot[output->row % 2];
  restart_parts(state, parts);
  ct_seal seal = {
      (uint64_t)output->row + 1, state->step, output->row, state->time, state->kinetic_start, 0, 0};
  fill_seal(&seal, parts);
  int good = task->status == CT_OK;
  for (int i = 0; i < CT_PART_COUNT && good; i++)
    good = parts[i].count == 0 ||
           H5Dwrite(set[i], H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, parts[i].values) >= 0;
  if (!good ||
      H5Dwrite(set[CT_PART_COUNT], output->seal_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &seal) < 0)
    ct_hdf5_fail(task, "write the restart record");
}

/* -- Read -- */

static void read_seal(ct_task *task, hid_t group, int slot, ct_seal *seal)
{
  char name[32];
  snprintf(name, sizeof name, "restart/%s/seal", SLOT[slot]);
  hid_t type = ct_hdf5_row_type(&SEAL);
  ct_hdf5_read_array(task, group, name, type, 0, NULL, seal);
  H5Tclose(type);
}

/* Read one slot; returns whether its seal fits. */
static int read_slot(ct_task *task, hid_t group, int slot, ct_state *into)
{
  part parts[CT_PART_COUNT];
  ct_seal seal;
  read_seal(task, group, slot, &seal);
  restart_parts(into, parts);
  for (int i = 0; i < CT_PART_COUNT; i++) {
    char name[48];
    hsize_t shape[2];
    int rank = part_shape(i, parts[i].count, shape);
    snprintf(name, sizeof name, "restart/%s/%s", SLOT[slot], parts[i].name);
    ct_hdf5_read_array(task, group, name, H5T_NATIVE_DOUBLE, rank, shape, parts[i].values);
  }
  if (task->status != CT_OK) return 0;
  into->step = seal.step;
  into->time = seal.time;
  into->kinetic_start = seal.kinetic_start;
  // -- A record counts when the sums over what was read are those that were written
  // (eq:restart-seal)
  ct_seal sealed = seal;
  fill_seal(&sealed, parts);
  return seal.sequence > 0 && sealed.sum == seal.sum && sealed.weighted == seal.weighted;
}

/* The newer of the two records that is whole. */
static void read_newest(ct_task *task, hid_t group, ct_state *into)
{
  uint64_t sequence[2];
  for (int slot = 0; slot < 2; slot++) {
    ct_task attempt = *task;
    ct_seal seal;
    read_seal(&attempt, group, slot, &seal);
    sequence[slot] = attempt.status == CT_OK ? seal.sequence : 0;
  }
  if (task->status != CT_OK) return;
  int first = sequence[1] > sequence[0] ? 1 : 0;
  ct_task attempt = *task;
  if (read_slot(&attempt, group, first, into) || read_slot(task, group, 1 - first, into)) return;
  if (task->status == CT_OK)
    task->status =
        ct_fail(task->error, CT_ERROR_FILE, CT_NOWHERE,
                "%s: the file has no complete restart record", ct_disk_short(task->path));
}

static void read_file(ct_task *task, hid_t file, const ct_problem *problem, ct_state *into)
{
  if (H5Lexists(file, "libcontact", H5P_DEFAULT) <= 0) {
    task->status = ct_fail(task->error, CT_ERROR_FILE, CT_NOWHERE,
                           "%s: the file was not written by libcontact", ct_disk_short(task->path));
    return;
  }
  hid_t group = H5Gopen2(file, "libcontact", H5P_DEFAULT);
  if (group < 0) ct_hdf5_fail(task, "read the file");
  ct_identity_compare(task, file, group, problem);
  read_newest(task, group, into);
  H5Gclose(group);
}

static ct_status restart(const char *path, const ct_problem *problem, ct_state *state,
                         ct_error *error)
{
  ct_task task = {path, error, CT_OK};
  ct_state *copy = NULL;
  hid_t access = ct_layout_open_access(), file = H5Fopen(path, H5F_ACC_RDONLY, access);
  if (file < 0) ct_hdf5_fail(&task, "read the file");
  else task.status = ct_state_create(problem, &copy, error);
  if (task.status == CT_OK) read_file(&task, file, problem, copy);
  H5Fclose(file);
  H5Pclose(access);
  // -- The state changes only when all has gone well
  if (task.status == CT_OK) task.status = ct_state_copy(problem, copy, state, error);
  ct_state_free(copy);
  return task.status;
}

ct_status ct_output_restart(const char *path, const ct_problem *problem, ct_state *state,
                            ct_error *error)
{
  if (path == NULL || problem == NULL || state == NULL)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "ct_output_restart needs a path, a problem and a state");
  ct_status status = ct_hdf5_check_version(error);
  if (status != CT_OK) return status;
  H5E_BEGIN_TRY { status = restart(path, problem, state, error); }
  H5E_END_TRY
  return status;
}
