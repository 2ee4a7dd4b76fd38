/* Histories of probes: one table for each in libcontact/probe, with rows at steps of the run. */
#include "hdf5_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS_A_CHUNK = 1024, QUANTITIES = 8, LONGEST = 96 };
static const char GROUP[] = "libcontact/probe";
static const struct {
  const char *name;
  ct_kind kind;
  size_t numbers;
} QUANTITY[QUANTITIES] = {
    [CT_QUANTITY_TIME] = {"time", CT_REAL, 1},
    [CT_QUANTITY_DISPLACEMENT] = {"displacement", CT_VECTOR, 3},
    [CT_QUANTITY_VELOCITY] = {"velocity", CT_VECTOR, 3},
    [CT_QUANTITY_ACCELERATION] = {"acceleration", CT_VECTOR, 3},
    [CT_QUANTITY_STRESS] = {"stress", CT_TENSOR, 6},
    [CT_QUANTITY_PRESSURE] = {"pressure", CT_REAL, 1},
    [CT_QUANTITY_FORCE] = {"force", CT_VECTOR, 3},
    [CT_QUANTITY_MOMENT] = {"moment", CT_VECTOR, 3},
};

/* The type of a row, to be closed by the caller. */
static hid_t row_type(const ct_probe_history *history)
{
  ct_row_type row = {.size = (size_t)history->width * sizeof(double)};
  for (int q = 0, next = 0; q < QUANTITIES; q++)
    if (history->column[q] >= 0)
      row.field[next++] = (ct_field){QUANTITY[q].name, (size_t)history->column[q] * sizeof(double),
                                     QUANTITY[q].numbers * sizeof(double), QUANTITY[q].kind, NULL};
  return ct_hdf5_row_type(&row);
}

static void path_of(const ct_probe_history *history, char path[LONGEST])
{
  snprintf(path, LONGEST, "%s/%s", GROUP, history->name);
}

static int32_t count_of(const ct_probes *probes)
{
  ct_probe_history history;
  int32_t count = 0;
  while (ct_probes_history(probes, count, &history, NULL) == CT_OK) count++;
  return count;
}

/* -- Write -- */

void ct_probe_create_tables(ct_task *task, ct_output *o)
{
  int32_t count = count_of(o->probes);
  ct_probe_history history;
  char path[LONGEST];
  if (count == 0 || task->status != CT_OK) return;
  o->probe = calloc((size_t)count, sizeof *o->probe);
  if (o->probe == NULL) {
    ct_task_fail(task, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the tables of probes");
    return;
  }
  ct_hdf5_create_group(task, GROUP);
  for (; o->probe_count < count; o->probe_count++) {
    ct_column *column = &o->probe[o->probe_count].column;
    ct_probes_history(o->probes, o->probe_count, &history, NULL);
    path_of(&history, path);
    column->rows = ROWS_A_CHUNK;
    column->type = row_type(&history);
    if (column->type < 0) ct_hdf5_fail(task, "make a table");
    ct_hdf5_create_column(task, path, 1, column);
  }
}

/* Rows up to a time. */
static int64_t rows_until(const ct_probe_history *history, double time)
{
  int64_t count = history->row_count;
  while (count > 0 && history->rows[(count - 1) * history->width] > time) count--;
  return count;
}

int64_t ct_probe_bytes(const ct_output *o, double time)
{
  int64_t bytes = 0;
  ct_probe_history history;
  for (int32_t i = 0; i < o->probe_count; i++) {
    ct_probes_history(o->probes, i, &history, NULL);
    int64_t more = rows_until(&history, time) - o->probe[i].written;
    // The rows, and the rest of a chunk before and after them.
    if (more > 0) bytes += (more + 2 * ROWS_A_CHUNK) * o->probe[i].column.row_bytes;
  }
  return bytes;
}

void ct_probe_write(ct_task *task, ct_output *o, double time)
{
  ct_probe_history history;
  for (int32_t i = 0; i < o->probe_count; i++) {
    ct_probe_table *table = &o->probe[i];
    ct_probes_history(o->probes, i, &history, NULL);
    int64_t count = rows_until(&history, time);
    if (count <= table->written) continue;
    ct_hdf5_extend(task, &table->column, count);
    ct_hdf5_write_rows(task, &table->column, table->written, count - table->written,
                       history.rows + table->written * history.width);
    table->written = count;
  }
}

/* -- Read -- */

/* Whether a table has the quantities of a probe and no others. */
static int fits(ct_task *task, hid_t set, hid_t wanted)
{
  hid_t type = H5Dget_type(set);
  int count = H5Tget_nmembers(wanted), found = H5Tget_nmembers(type), same = found == count;
  if (count < 0 || found < 0) ct_hdf5_fail(task, "read the history of a probe");
  for (int i = 0; same && i < count; i++) {
    char *one = H5Tget_member_name(wanted, (unsigned)i),
         *two = H5Tget_member_name(type, (unsigned)i);
    if (one == NULL || two == NULL) ct_hdf5_fail(task, "read the history of a probe");
    same = one != NULL && two != NULL && strcmp(one, two) == 0;
    H5free_memory(one);
    H5free_memory(two);
  }
  H5Tclose(type);
  return same;
}

/* Whether the file has an object, whose groups are there. */
static int exists(ct_task *task, const char *path)
{
  htri_t found = task->status == CT_OK ? H5Lexists(task->file, path, H5P_DEFAULT) : 0;
  if (found < 0) ct_hdf5_fail(task, "read the file");
  return found > 0;
}

static void read_table(ct_task *task, const ct_state *state, ct_probes *probes, int32_t i)
{
  ct_probe_history history;
  char path[LONGEST];
  ct_probes_history(probes, i, &history, NULL);
  path_of(&history, path);
  if (!exists(task, path)) return;
  hid_t set = H5Dopen2(task->file, path, H5P_DEFAULT), type = row_type(&history),
        space = H5Dget_space(set);
  hssize_t count = H5Sget_simple_extent_npoints(space);
  double *rows = NULL;
  if (count < 0 || type < 0) ct_hdf5_fail(task, "read the history of a probe");
  if (count > 0 && type >= 0 && fits(task, set, type)) {
    rows = malloc((size_t)count * (size_t)history.width * sizeof *rows);
    if (rows == NULL)
      ct_task_fail(task, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the history of a probe");
    else if (H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows) < 0)
      ct_hdf5_fail(task, "read the history of a probe");
  }
  history.rows = rows;
  history.row_count = count;
  if (rows != NULL && task->status == CT_OK)
    task->status =
        ct_probes_restore(probes, i, rows, rows_until(&history, state->time), task->error);
  free(rows);
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(set);
}

static ct_status restart_probes(const char *path, const ct_state *state, ct_probes *probes,
                                ct_error *error)
{
  hid_t access = ct_hdf5_access(), file = H5Fopen(path, H5F_ACC_RDONLY, access);
  ct_task task = {path, error, CT_OK, file};
  int32_t count = count_of(probes);
  if (file < 0) ct_hdf5_fail(&task, "read the file");
  int some = exists(&task, "libcontact") && exists(&task, GROUP);
  for (int32_t i = 0; some && i < count; i++) read_table(&task, state, probes, i);
  H5Fclose(file);
  H5Pclose(access);
  return task.status;
}

ct_status ct_output_restart_probes(const char *path, const ct_state *state, ct_probes *probes,
                                   ct_error *error)
{
  if (path == NULL || state == NULL || probes == NULL)
    return CT_REFUSE(error, "ct_output_restart_probes needs a path, a state and probes");
  ct_status status = ct_hdf5_check_version(error);
  if (status != CT_OK) return status;
  H5E_BEGIN_TRY { status = restart_probes(path, state, probes, error); }
  H5E_END_TRY
  return status;
}
