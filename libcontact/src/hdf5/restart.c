#include "hdf5_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The record is kept twice, in the groups restart/a and restart/b, written in turn. Both are
 * datasets of fixed size that stand in the file from the start, so that a write changes no byte but
 * their own; the seal tells whether all of them have arrived. */
static const char *const SLOT[2] = {"a", "b"};

static void restart_parts(const ct_state *state, ct_part parts[CT_PART_COUNT])
{
  int64_t nodes = 3 * (int64_t)state->node_count;
  const ct_part all[CT_PART_COUNT] = {{"displacement", state->displacement, nodes},
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

static void fill_seal(ct_seal *seal, const ct_part parts[CT_PART_COUNT])
{
  sums s = {0, 0, 0};
  add_words(&s, &seal->sequence, 1);
  add_words(&s, &seal->step, 1);
  add_words(&s, &seal->row, 1);
  add_words(&s, &seal->time, 1);
  add_words(&s, &seal->kinetic_start, 1);
  for (int i = 0; i < CT_PART_COUNT; i++) add_words(&s, parts[i].values, parts[i].count);
  seal->sum = s.sum;
  seal->weighted = s.weighted;
}

static hid_t seal_type(void)
{
  enum { COUNT = 7 };
  const char *const name[COUNT] = {"sequence",      "step", "row",     "time",
                                   "kinetic_start", "sum",  "weighted"};
  const size_t offset[COUNT] = {HOFFSET(ct_seal, sequence),      HOFFSET(ct_seal, step),
                                HOFFSET(ct_seal, row),           HOFFSET(ct_seal, time),
                                HOFFSET(ct_seal, kinetic_start), HOFFSET(ct_seal, sum),
                                HOFFSET(ct_seal, weighted)};
  const hid_t unsigned64 = H5T_NATIVE_UINT64, signed64 = H5T_NATIVE_INT64, real = H5T_NATIVE_DOUBLE;
  const hid_t value[COUNT] = {unsigned64, signed64, signed64, real, real, unsigned64, unsigned64};
  hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(ct_seal));
  for (int i = 0; i < COUNT && type >= 0; i++) {
    if (H5Tinsert(type, name[i], offset[i], value[i]) >= 0) continue;
    H5Tclose(type);
    type = -1;
  }
  return type;
}

/* -- Write -- */

int64_t ct_restart_bytes(const ct_state *state)
{
  return 16 * (6 * (int64_t)state->node_count + state->work_count + state->impulse_count +
               state->memory_count);
}

int ct_restart_fits(const ct_output *output, const ct_state *state)
{
  ct_part parts[CT_PART_COUNT];
  restart_parts(state, parts);
  for (int i = 0; i < CT_PART_COUNT; i++)
    if (output->part_count[i] != parts[i].count) return 0;
  return 1;
}

/* The first two arrays have three columns. */
static int part_shape(int part, int64_t count, hsize_t shape[2])
{
  shape[0] = (hsize_t)(part < 2 ? count / 3 : count);
  shape[1] = 3;
  return part < 2 ? 2 : 1;
}

static ct_status create_slot(ct_output *o, hid_t parent, int slot,
                             const ct_part parts[CT_PART_COUNT], ct_error *error)
{
  hid_t group = -1, *set = o->slot[slot];
  ct_status status = ct_hdf5_create_group(parent, SLOT[slot], o->path, &group, error);
  for (int i = 0; i < CT_PART_COUNT && status == CT_OK; i++) {
    hsize_t shape[2];
    int rank = part_shape(i, parts[i].count, shape);
    status = ct_hdf5_create_array(group, parts[i].name, H5T_NATIVE_DOUBLE, rank, shape, o->path,
                                  &set[i], error);
  }
  if (status == CT_OK)
    status = ct_hdf5_create_array(group, "seal", o->seal_type, 0, NULL, o->path,
                                  &set[CT_PART_COUNT], error);
  if (group >= 0) H5Gclose(group);
  return status;
}

ct_status ct_restart_create_slots(ct_output *output, const ct_state *state, ct_error *error)
{
  hid_t group = -1;
  ct_part parts[CT_PART_COUNT];
  restart_parts(state, parts);
  for (int i = 0; i < CT_PART_COUNT; i++) output->part_count[i] = parts[i].count;
  output->seal_type = seal_type();
  ct_status status =
      output->seal_type < 0 ? ct_hdf5_fail(error, output->path, "make a table") : CT_OK;
  if (status == CT_OK)
    status = ct_hdf5_create_group(output->file, "libcontact/restart", output->path, &group, error);
  for (int slot = 0; slot < 2 && status == CT_OK; slot++)
    status = create_slot(output, group, slot, parts, error);
  if (group >= 0) H5Gclose(group);
  return status;
}

ct_status ct_restart_write(const ct_output *output, const ct_state *state, ct_error *error)
{
  ct_part parts[CT_PART_COUNT];
  const hid_t *set = output->slot[output->row % 2];
  restart_parts(state, parts);
  ct_seal seal = {
      (uint64_t)output->row + 1, state->step, output->row, state->time, state->kinetic_start, 0, 0};
  fill_seal(&seal, parts);
  for (int i = 0; i < CT_PART_COUNT; i++)
    if (parts[i].count > 0 &&
        H5Dwrite(set[i], H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, parts[i].values) < 0)
      return ct_hdf5_fail(error, output->path, "write the restart record");
  if (H5Dwrite(set[CT_PART_COUNT], output->seal_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &seal) < 0)
    return ct_hdf5_fail(error, output->path, "write the restart record");
  return CT_OK;
}

/* -- Read -- */

/* A state of the same sizes with room of its own, in one piece of memory. */
static ct_status create_copy(const ct_state *state, ct_state *copy, double **memory,
                             ct_error *error)
{
  size_t nodes = 3 * (size_t)state->node_count, work = (size_t)state->work_count,
         impulse = (size_t)state->impulse_count;
  *memory =
      malloc((2 * nodes + work + impulse + (size_t)state->memory_count + 1) * sizeof **memory);
  if (*memory == NULL)
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a restart record");
  memset(copy, 0, sizeof *copy);
  copy->problem = state->problem;
  copy->node_count = state->node_count;
  copy->work_count = state->work_count;
  copy->impulse_count = state->impulse_count;
  copy->memory_count = state->memory_count;
  copy->displacement = *memory;
  copy->velocity = copy->displacement + nodes;
  copy->work = copy->velocity + nodes;
  copy->impulse = copy->work + work;
  copy->memory = copy->impulse + impulse;
  return CT_OK;
}

static ct_status read_seal(hid_t group, int slot, const char *path, ct_seal *seal, ct_error *error)
{
  char name[32];
  snprintf(name, sizeof name, "restart/%s/seal", SLOT[slot]);
  hid_t type = seal_type();
  ct_status status = type < 0 ? ct_hdf5_fail(error, path, "read the restart record") : CT_OK;
  if (status == CT_OK) status = ct_hdf5_read_array(group, name, type, 0, NULL, seal, path, error);
  if (type >= 0) H5Tclose(type);
  return status;
}

/* Read one slot; *whole says whether its seal fits. */
static ct_status read_slot(hid_t group, int slot, const char *path, ct_state *into, int *whole,
                           ct_error *error)
{
  ct_part parts[CT_PART_COUNT];
  ct_seal seal;
  ct_status status = read_seal(group, slot, path, &seal, error);
  restart_parts(into, parts);
  for (int i = 0; i < CT_PART_COUNT && status == CT_OK; i++) {
    char name[48];
    hsize_t shape[2];
    int rank = part_shape(i, parts[i].count, shape);
    snprintf(name, sizeof name, "restart/%s/%s", SLOT[slot], parts[i].name);
    status = ct_hdf5_read_array(group, name, H5T_NATIVE_DOUBLE, rank, shape, parts[i].values, path,
                                error);
  }
  if (status != CT_OK) return status;
  // -- A record counts when the sums over what was read are those that were written
  // (eq:restart-seal)
  ct_seal sealed = seal;
  fill_seal(&sealed, parts);
  *whole = seal.sequence > 0 && sealed.sum == seal.sum && sealed.weighted == seal.weighted;
  into->step = seal.step;
  into->time = seal.time;
  into->kinetic_start = seal.kinetic_start;
  return CT_OK;
}

/* The newer of the two records that is whole. */
static ct_status read_newest(hid_t group, const char *path, ct_state *into, ct_error *error)
{
  ct_seal seal[2];
  int whole = 0;
  for (int slot = 0; slot < 2; slot++)
    if (read_seal(group, slot, path, &seal[slot], error) != CT_OK) seal[slot].sequence = 0;
  int first = seal[1].sequence > seal[0].sequence ? 1 : 0;
  ct_status status = read_slot(group, first, path, into, &whole, error);
  if (!whole) status = read_slot(group, 1 - first, path, into, &whole, error);
  if (status == CT_OK && !whole)
    status = ct_fail(error, CT_ERROR_FILE, CT_NOWHERE,
                     "%s: the file has no complete restart record", ct_disk_short(path));
  return status;
}

static ct_status read_file(hid_t file, const char *path, const ct_problem *problem, ct_state *into,
                           ct_error *error)
{
  if (H5Lexists(file, "libcontact", H5P_DEFAULT) <= 0)
    return ct_fail(error, CT_ERROR_FILE, CT_NOWHERE, "%s: the file was not written by libcontact",
                   ct_disk_short(path));
  hid_t group = H5Gopen2(file, "libcontact", H5P_DEFAULT);
  ct_status status = group < 0 ? ct_hdf5_fail(error, path, "read the file") : CT_OK;
  if (status == CT_OK) status = ct_identity_compare(group, problem, path, error);
  if (status == CT_OK) status = ct_identity_compare_points(file, problem, path, error);
  if (status == CT_OK) status = read_newest(group, path, into, error);
  if (group >= 0) H5Gclose(group);
  return status;
}

static ct_status restart(const char *path, const ct_problem *problem, ct_state *state,
                         ct_error *error)
{
  ct_state copy;
  double *memory = NULL;
  ct_status status = ct_disk_check_readable(path, error);
  if (status == CT_OK) status = create_copy(state, &copy, &memory, error);
  if (status != CT_OK) return status;
  hid_t access = ct_layout_open_access(), file = -1;
  if (access >= 0) file = H5Fopen(path, H5F_ACC_RDONLY, access);
  if (file < 0) status = ct_hdf5_fail(error, path, "read the file");
  else status = read_file(file, path, problem, &copy, error);
  if (file >= 0) H5Fclose(file);
  if (access >= 0) H5Pclose(access);
  // -- The state changes only when all has gone well
  if (status == CT_OK) status = ct_state_copy(problem, &copy, state, error);
  free(memory);
  return status;
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
