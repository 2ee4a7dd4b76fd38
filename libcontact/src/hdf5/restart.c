#include "hdf5_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The record is stored twice, in the groups restart/a and restart/b, which are written alternately.
 * Both are datasets of fixed size in the file from the start, so that a write changes only their
 * own bytes; the seal shows whether all of them were written. */
static const char *const SLOT[2] = {"libcontact/restart/a", "libcontact/restart/b"};

/* Marks a complete record: its number in the file, its place in the run, and the sums of
 * :eq:`restart-seal`. */
typedef struct ct_seal {
  uint64_t sequence;
  int64_t step, row;
  double time, kinetic_start;
  uint64_t sum, weighted;
} ct_seal;

/* The members before the sums. */
enum { SEALED_WORDS = 5 };

static const ct_row_type SEAL = {
    sizeof(ct_seal),
    {CT_FIELD(ct_seal, sequence, CT_WORD, NULL), CT_FIELD(ct_seal, step, CT_INT64, NULL),
     CT_FIELD(ct_seal, row, CT_INT64, NULL), CT_FIELD(ct_seal, time, CT_REAL, NULL),
     CT_FIELD(ct_seal, kinetic_start, CT_REAL, NULL), CT_FIELD(ct_seal, sum, CT_WORD, NULL),
     CT_FIELD(ct_seal, weighted, CT_WORD, NULL)}};

/* A dataset of a record. With two axes the second one has three columns; the seal has none. */
typedef struct part {
  const char *name;
  void *values;
  int64_t count;
  int rank;
} part;

static void restart_parts(const ct_state *state, ct_seal *seal, part parts[CT_PART_COUNT + 1])
{
  int64_t nodes = 3 * (int64_t)state->node_count;
  const part all[CT_PART_COUNT + 1] = {{"displacement", state->displacement, nodes, 2},
                                       {"velocity", state->velocity, nodes, 2},
                                       {"work", state->work, state->work_count, 1},
                                       {"impulse", state->impulse, state->impulse_count, 1},
                                       {"memory", state->memory, state->memory_count, 1},
                                       {"seal", seal, 1, 0}};
  memcpy(parts, all, sizeof all);
}

typedef enum transfer { MAKE, WRITE, READ } transfer;

static void transfer_slot(ct_task *task, transfer what, int slot,
                          const part parts[CT_PART_COUNT + 1])
{
  hid_t seal = ct_hdf5_row_type(&SEAL);
  for (const part *p = parts; p <= parts + CT_PART_COUNT; p++) {
    char path[64];
    const hsize_t shape[2] = {(hsize_t)(p->rank == 2 ? p->count / 3 : p->count), 3};
    hid_t type = p->rank == 0 ? seal : H5T_NATIVE_DOUBLE;
    snprintf(path, sizeof path, "%s/%s", SLOT[slot], p->name);
    if (what == READ) ct_hdf5_read_array(task, path, type, p->rank, shape, p->values);
    else ct_hdf5_write_array(task, path, type, p->rank, shape, what == WRITE ? p->values : NULL);
  }
  H5Tclose(seal);
}

/* -- The seal -- */

/* Sums of the bits of the values, modulo 2^64, after the first `before` words (eq:restart-seal). We
 * use eight columns, without a product for each word: the sum of a column's partial sums contains
 * each word as often as there are rows from its own to the last. */
static void add_words(ct_seal *seal, uint64_t *before, const void *values, int64_t count)
{
  enum { COLUMNS = 8 };
  uint64_t sum[COLUMNS] = {0}, sums[COLUMNS] = {0}, row[COLUMNS];
  int64_t rows = count / COLUMNS;
  for (int64_t r = 0; r < rows; r++) {
    memcpy(row, (const char *)values + r * (int64_t)sizeof row, sizeof row);
    for (int k = 0; k < COLUMNS; k++) sum[k] += row[k], sums[k] += sum[k];
  }
  // -- Word 8 r + k is number 8 r + k + 1 of them: 8 (rows - (rows - r)) + k + 1
  for (int k = 0; k < COLUMNS; k++) {
    seal->sum += sum[k];
    seal->weighted +=
        (*before + COLUMNS * (uint64_t)rows + (uint64_t)k + 1) * sum[k] - COLUMNS * sums[k];
  }
  *before += COLUMNS * (uint64_t)rows;
  for (int64_t i = COLUMNS * rows; i < count; i++) {
    memcpy(row, (const char *)values + 8 * i, 8);
    seal->sum += row[0];
    seal->weighted += ++*before * row[0]; // (eq:restart-seal)
  }
}

static void fill_seal(ct_seal *seal, const part *parts)
{
  uint64_t words = 0;
  seal->sum = seal->weighted = 0;
  add_words(seal, &words, seal, SEALED_WORDS);
  for (int i = 0; i < CT_PART_COUNT; i++) add_words(seal, &words, parts[i].values, parts[i].count);
}

/* -- Write -- */

int64_t ct_restart_bytes(const ct_state *state)
{
  return 16 * (6 * (int64_t)state->node_count + state->work_count + state->impulse_count +
               state->memory_count);
}

int ct_restart_fits(const ct_output *output, const ct_state *state)
{
  part parts[CT_PART_COUNT + 1];
  restart_parts(state, NULL, parts);
  for (int i = 0; i < CT_PART_COUNT; i++)
    if (output->part_count[i] != parts[i].count) return 0;
  return 1;
}

void ct_restart_create_slots(ct_task *task, ct_output *output, const ct_state *state)
{
  part parts[CT_PART_COUNT + 1];
  restart_parts(state, NULL, parts);
  ct_hdf5_create_group(task, "libcontact/restart");
  for (int slot = 0; slot < 2; slot++) {
    ct_hdf5_create_group(task, SLOT[slot]);
    transfer_slot(task, MAKE, slot, parts);
  }
  for (int i = 0; i < CT_PART_COUNT; i++) output->part_count[i] = parts[i].count;
}

void ct_restart_write(ct_task *task, int64_t row, const ct_state *state)
{
  part parts[CT_PART_COUNT + 1];
  ct_seal seal = {(uint64_t)row + 1, state->step, row, state->time, state->kinetic_start, 0, 0};
  restart_parts(state, &seal, parts);
  fill_seal(&seal, parts);
  transfer_slot(task, WRITE, (int)(row % 2), parts);
}

/* -- Read -- */

/* Read one slot; returns its number in the file, or 0 if its seal is wrong. */
static uint64_t read_slot(ct_task *task, int slot, ct_state *into)
{
  part parts[CT_PART_COUNT + 1];
  ct_seal seal = {0};
  restart_parts(into, &seal, parts);
  transfer_slot(task, READ, slot, parts);
  into->step = seal.step;
  into->time = seal.time;
  into->kinetic_start = seal.kinetic_start;
  // -- A record counts when the sums over what was read are those that were written
  const ct_seal read = seal;
  fill_seal(&seal, parts);
  int is_whole = task->status == CT_OK && seal.sum == read.sum && seal.weighted == read.weighted;
  return is_whole ? seal.sequence : 0;
}

/* The number in the file that a slot claims; 0 if it cannot be read. */
static uint64_t number_of(ct_task task, int slot)
{
  ct_seal seal = {0};
  char path[64];
  hid_t type = ct_hdf5_row_type(&SEAL);
  snprintf(path, sizeof path, "%s/seal", SLOT[slot]);
  ct_hdf5_read_array(&task, path, type, 0, NULL, &seal);
  H5Tclose(type);
  return seal.sequence;
}

/* The newer one of the two records that is complete. */
static void read_newest(ct_task *task, ct_state *into)
{
  ct_task first = *task, second = *task;
  if (task->status != CT_OK) return;
  int newer = number_of(*task, 1) > number_of(*task, 0);
  if (read_slot(&first, newer, into) > 0 || read_slot(&second, !newer, into) > 0) return;
  task->status = second.status;
  ct_task_fail(task, CT_ERROR_FILE, CT_NOWHERE, "the file has no complete restart record");
}

/* A state of arrays alone, in one block like those of `like`; free its first array. */
static ct_state allocate_like(ct_task *task, const ct_state *like)
{
  ct_state copy = *like;
  double **array[] = {&copy.displacement, &copy.velocity, &copy.work,
                      &copy.impulse,      &copy.memory,   &copy.effect_seconds};
  double *block = calloc((size_t)(like->effect_seconds - like->displacement) + 1, sizeof *block);
  if (block == NULL && task->status == CT_OK)
    ct_task_fail(task, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the state that it holds");
  for (size_t i = 0; block != NULL && i < sizeof array / sizeof array[0]; i++)
    *array[i] = block + (*array[i] - like->displacement);
  copy.displacement = block;
  copy.workspace = NULL;
  return copy;
}

/* The step of a record: the step with which the run began, or a whole fraction of it. */
static double step_of(const ct_state *record, double first)
{
  // -- Δt = Δt₀ / r with t = n Δt (eq:record-step)
  return record->step > 0 ? first / floor(first * (double)record->step / record->time + 0.5)
                          : first;
}

/* Read into separate memory: the state changes only if everything succeeds. If it is null, only
 * the step of the record is wanted. */
static void read_file(ct_task *task, const ct_problem *problem, const ct_state *like,
                      ct_state *state, double *dt)
{
  if (task->status == CT_OK && H5Lexists(task->file, "libcontact", H5P_DEFAULT) <= 0)
    ct_task_fail(task, CT_ERROR_FILE, CT_NOWHERE, "the file was not written by libcontact");
  // -- The coordinates are compared where the displacements will stand
  ct_state read = allocate_like(task, like);
  double first = ct_identity_compare(task, problem, read.displacement);
  read_newest(task, &read);
  if (task->status == CT_OK) *dt = step_of(&read, first);
  if (state != NULL && task->status == CT_OK && *dt != problem->dt)
    ct_task_fail(task, CT_ERROR_FILE, CT_NOWHERE,
                 "the file has the time step %.17g, the problem has %.17g", *dt, problem->dt);
  if (state != NULL && task->status == CT_OK)
    task->status = ct_state_copy(problem, &read, state, task->error);
  free(read.displacement);
}

static ct_status restart(const char *path, const ct_problem *problem, const ct_state *like,
                         ct_state *state, double *dt, ct_error *error)
{
  if (path == NULL || problem == NULL || like == NULL || dt == NULL)
    return CT_REFUSE(error, "ct_output_restart needs a path, a problem and a state");
  if (like->node_count != problem->node_count)
    return CT_REFUSE(error, "ct_output_restart: the state belongs to another problem");
  ct_status status = ct_hdf5_check_version(error);
  if (status != CT_OK) return status;

  hid_t access = ct_hdf5_access(), file = H5Fopen(path, H5F_ACC_RDONLY, access);
  ct_task task = {path, error, CT_OK, file};
  if (file < 0) ct_hdf5_fail(&task, "read the file");
  read_file(&task, problem, like, state, dt);
  H5Fclose(file);
  H5Pclose(access);
  return task.status;
}

ct_status ct_output_restart(const char *path, const ct_problem *problem, ct_state *state,
                            ct_error *error)
{
  double dt;
  ct_status status;
  H5E_BEGIN_TRY { status = restart(path, problem, state, state, &dt, error); }
  H5E_END_TRY
  return status;
}

ct_status ct_output_restart_step(const char *path, const ct_problem *problem, const ct_state *state,
                                 double *dt, ct_error *error)
{
  ct_status status;
  H5E_BEGIN_TRY { status = restart(path, problem, state, NULL, dt, error); }
  H5E_END_TRY
  return status;
}
