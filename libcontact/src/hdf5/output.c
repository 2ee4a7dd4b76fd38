#include "hdf5_internal.h"

#include <libcontact/contact_effect.h>
#include <libcontact/base.h>

#include <stdio.h>
#include <stdlib.h>

/* Bytes that HDF5 itself needs per step. Fields are computed in pieces of rows that fit the cache.
 */
enum { MARGIN = 1 << 18, PAGE = 4096, PIECE = 1 << 14 };

static ct_task task_on(const ct_output *o, ct_error *error)
{
  const ct_task task = {o->disk.path, error, CT_OK, o->file};
  return task;
}

/* -- Create -- */

static ct_status check_problem(const ct_problem *problem, ct_error *error)
{
  int64_t nodes = 0;
  for (int32_t b = 0; b < problem->body_count; b++) {
    const ct_body *body = &problem->bodies[b];
    const ct_place where = {b, -1, -1};
    if (body->mesh == NULL || body->mesh->element_count <= 0 || body->first_node != nodes)
      return ct_fail(error, CT_ERROR_ARGUMENT, where,
                     "body %d must have elements and start at node %ld of the problem", (int)b,
                     (long)nodes);
    nodes += body->mesh->node_count;
  }
  if (nodes == 0 || nodes != problem->node_count)
    return CT_REFUSE(error, "the bodies have %ld nodes, the problem says %d", (long)nodes,
                     (int)problem->node_count);
  return CT_OK;
}

/* Allocate the filtered fields. */
static ct_status create_filtered(ct_output *o, const ct_problem *problem,
                                 const ct_output_options *options, ct_error *error)
{
  ct_record *now = &o->now;
  if (options->filter == 0) return CT_OK;
  ct_status status = ct_filter_create(problem, options->filter, &o->filter, error);
  if (status != CT_OK) return status;
  o->smooth = malloc(3 * (size_t)o->node_count * sizeof *o->smooth);
  if (options->velocity)
    now->velocity_filtered = malloc(3 * (size_t)o->node_count * sizeof *now->velocity_filtered);
  if (options->stress) now->stress_filtered = now->piece;
  if (options->displacement) now->displacement_filtered = o->smooth;
  if (o->smooth == NULL || (options->velocity && now->velocity_filtered == NULL))
    return CT_NO_MEMORY(error, "the output of %ld nodes", (long)o->node_count);
  return CT_OK;
}

static ct_status create_record(ct_output *o, const ct_problem *problem,
                               const ct_output_options *options, ct_error *error)
{
  ct_record *now = &o->now;
  o->node_count = problem->node_count;
  o->body_count = problem->body_count;
  o->effect_count = problem->effect_count;
  for (int32_t b = 0; b < problem->body_count; b++)
    o->cell_count += problem->bodies[b].mesh->element_count;
  now->one = 1;
  if (options->displacement) now->displacement = problem->reference;
  if (options->velocity || options->stress) now->piece = malloc(6 * PIECE * sizeof *now->piece);
  if (options->velocity) now->velocity = now->piece;
  if (options->stress) now->stress = now->piece;
  if (options->contact_pressure)
    now->contact_pressure = malloc((size_t)o->node_count * sizeof *now->contact_pressure);
  now->addends = malloc((size_t)o->body_count * sizeof *now->addends);
  o->own.momentum = calloc((size_t)o->body_count, sizeof *o->own.momentum);
  o->own.effects = calloc((size_t)o->effect_count, sizeof *o->own.effects);
  now->bodies = o->own.momentum;
  now->effects = o->own.effects;
  if ((options->velocity && now->velocity == NULL) || (options->stress && now->stress == NULL) ||
      (options->contact_pressure && now->contact_pressure == NULL) || now->addends == NULL ||
      o->own.momentum == NULL || o->own.effects == NULL)
    return CT_NO_MEMORY(error, "the output of %ld nodes", (long)o->node_count);
  return create_filtered(o, problem, options, error);
}

static void open_file(ct_task *task, ct_output *o)
{
  hid_t access = ct_hdf5_access(), how = H5Pcreate(H5P_FILE_CREATE);
  // -- Closing the file closes what is still open in it; and in pages of the system's size no small
  // piece lies on two of them, so that a kill can't cut one in two
  if (H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) < 0 || H5Pset_obj_track_times(how, 0) < 0 ||
      H5Pset_file_space_strategy(how, H5F_FSPACE_STRATEGY_PAGE, 0, 1) < 0 ||
      H5Pset_file_space_page_size(how, PAGE) < 0 || !ct_driver_use(&o->disk, access))
    ct_hdf5_fail(task, "write the file");
  else o->file = ct_disk_create(task, &o->disk, how, access);
  // -- From here on: datasets that grow without moving (the superblock stays the old one)
  if (task->status == CT_OK && H5Fset_libver_bounds(o->file, H5F_LIBVER_V110, H5F_LIBVER_V110) < 0)
    ct_hdf5_fail(task, "write the file");
  task->file = o->file;
  H5Pclose(how);
  H5Pclose(access);
}

/* Close all handles and free the memory. */
static void destroy(ct_task *task, ct_output *o)
{
  for (int32_t i = 0; i < o->column_count; i++) H5Tclose(o->column[i].type);
  for (int32_t i = 0; i < o->probe_count; i++) H5Tclose(o->probe[i].column.type);
  if (!o->disk.renamed && o->disk.descriptor >= 0) remove(o->disk.part);
  if (o->file >= 0 && H5Fclose(o->file) < 0) ct_hdf5_fail(task, "close the file");
  if (o->disk.driver >= 0) H5FDunregister(o->disk.driver);
  ct_disk_check(task, "close the file", o->disk.error);
  free(o->now.piece);
  free(o->now.contact_pressure);
  free(o->now.velocity_filtered);
  free(o->smooth);
  ct_filter_free(o->filter);
  free(o->now.addends);
  free(o->probe);
  free(o->own.momentum);
  free(o->own.effects);
  free(o->disk.part);
  free(o->disk.path);
  free(o);
}

static ct_status create(const char *path, const ct_problem *problem,
                        const ct_output_options *options, ct_output **output, ct_error *error)
{
  ct_output *o = calloc(1, sizeof *o);
  if (o == NULL) return CT_NO_MEMORY(error, "an output");
  o->disk.descriptor = -1;
  o->disk.driver = o->file = -1;
  o->probes = options->probes;
  ct_task task = {path, error, create_record(o, problem, options, error), -1};
  ct_disk_names(&task, &o->disk, path);
  if (task.status == CT_OK) {
    task.path = o->disk.path;
    open_file(&task, o);
    ct_layout_create(&task, o, problem, options);
    ct_probe_create_tables(&task, o);
    ct_disk_flush(&task, &o->disk, "write the file");
  }
  if (task.status == CT_OK) *output = o;
  else destroy(&task, o);
  return task.status;
}

ct_output_options ct_output_options_default(void)
{
  return (ct_output_options){.cookie = CT_DEF_COOKIE};
}

ct_status ct_output_create(const char *path, const ct_problem *problem,
                           const ct_output_options *options, ct_output **output, ct_error *error)
{
  if (output != NULL) *output = NULL;
  if (path == NULL || *path == 0 || problem == NULL || options == NULL || output == NULL)
    return CT_REFUSE(error, "ct_output_create needs a path, a problem, options and an output");
  ct_status status = ct_check_options(options->cookie, "ct_output_options_default", error);
  if (status == CT_OK) status = check_problem(problem, error);
  if (status == CT_OK) status = ct_hdf5_check_version(error);
  if (status != CT_OK) return status;
  H5E_BEGIN_TRY { status = create(path, problem, options, output, error); }
  H5E_END_TRY
  return status;
}

/* -- Append -- */

static void check_state(ct_task *task, const ct_output *o, const ct_problem *problem,
                        const ct_state *state)
{
  if (problem->node_count != o->node_count || problem->body_count != o->body_count ||
      problem->effect_count != o->effect_count)
    ct_task_fail(task, CT_ERROR_ARGUMENT, CT_NOWHERE, "it was created for another problem");
  if (state->node_count != o->node_count || (o->row > 0 && !ct_restart_fits(o, state)))
    ct_task_fail(task, CT_ERROR_ARGUMENT, CT_NOWHERE, "the state belongs to another problem");
  if (o->broken)
    ct_task_fail(task, CT_ERROR_FILE, CT_NOWHERE, "an earlier step could not be written");
}

static void gather_ledger(ct_record *now, const ct_ledger *row, int32_t body_count)
{
  now->energy = row->energy;
  now->bodies = row->momentum;
  now->effects = row->effects;
  for (int c = 0; c < 6; c++) {
    for (int32_t b = 0; b < body_count; b++)
      now->addends[b] = (c < 3 ? row->momentum[b].p : row->momentum[b].L)[c % 3];
    (c < 3 ? now->momentum : now->angular_momentum)[c % 3] = ct_sum(now->addends, body_count);
  }
}

/* A state that is not finite has no row, and so does not replace the last good restart record. */
static ct_status gather(ct_output *o, const ct_problem *problem, ct_state *state,
                        const ct_ledger *row, ct_error *error)
{
  ct_record *now = &o->now;
  ct_status status = row != NULL ? CT_OK : ct_ledger_of(problem, state, &o->own, error);
  if (status == CT_OK) gather_ledger(now, row != NULL ? row : &o->own, problem->body_count);
  if (status == CT_OK && now->contact_pressure != NULL)
    status = ct_state_pressure(problem, state, now->contact_pressure, error);
  if (status == CT_OK && o->filter != NULL)
    status = ct_filter_apply(o->filter, state, o->smooth, now->velocity_filtered, error);
  now->step = state->step;
  now->energy.time = state->time;
  now->step_row = o->row;
  now->point_row = o->row * o->node_count;
  now->cell_row = o->row * o->cell_count;
  if (now->displacement != NULL) now->displacement = state->displacement;
  return status;
}

/* Largest number of bytes by which the next step extends the file. */
static int64_t step_bytes(const ct_output *o, const ct_state *state)
{
  int64_t bytes = MARGIN + (o->row == 0 ? ct_restart_bytes(state) : 0);
  for (int32_t i = 0; i < o->column_count; i++) {
    const ct_column *c = &o->column[i];
    int64_t before = (o->row * c->rows + c->chunk_rows - 1) / c->chunk_rows;
    int64_t after = ((o->row + 1) * c->rows + c->chunk_rows - 1) / c->chunk_rows;
    bytes += (after - before) * c->chunk_rows * c->row_bytes;
  }
  return bytes + ct_probe_bytes(o, state->time);
}

/* Append the rows of the step. */
static void write_column(ct_task *task, const ct_output *o, const ct_problem *problem,
                         ct_state *state, const ct_column *c)
{
  int64_t first = o->row * c->rows, piece = c->fill == NULL ? c->rows : PIECE;
  ct_hdf5_extend(task, c, first + c->rows);
  for (int64_t at = 0; at < c->rows && task->status == CT_OK; at += piece) {
    int64_t count = c->rows - at < piece ? c->rows - at : piece;
    if (c->fill != NULL) task->status = c->fill(o, problem, state, at, count, task->error);
    ct_hdf5_write_rows(task, c, first + at, count, ct_record_at(&o->now, c));
  }
}

static void write_step(ct_task *task, ct_output *o, const ct_problem *problem, ct_state *state)
{
  // -- Histories come first: the restart record marks their end, and may be complete before the
  // step
  if (o->probe_count > 0) {
    ct_probe_write(task, o, state->time);
    ct_disk_flush(task, &o->disk, "write a step");
  }
  // -- The data of the step, which readers ignore so far; the restart record comes last, so that
  // a state without stresses does not replace a good one
  for (const ct_column *c = o->column; c < o->column + o->column_count; c++)
    write_column(task, o, problem, state, c);
  if (o->row == 0) ct_restart_create_slots(task, o, state);
  ct_restart_write(task, o->row, state);
  ct_disk_flush(task, &o->disk, "write a step");
  // -- The number of steps, which makes it visible
  int64_t steps = o->row + 1;
  if (task->status == CT_OK && H5Awrite(o->step_count, H5T_NATIVE_INT64, &steps) < 0)
    ct_hdf5_fail(task, "write a step");
  ct_disk_flush(task, &o->disk, "write a step");
}

static void append(ct_task *task, ct_output *o, const ct_problem *problem, ct_state *state,
                   const ct_ledger *row)
{
  check_state(task, o, problem, state);
  if (task->status == CT_OK) task->status = gather(o, problem, state, row, task->error);
  if (task->status == CT_OK) ct_disk_reserve(task, &o->disk, step_bytes(o, state));
  if (task->status != CT_OK) return;
  write_step(task, o, problem, state);
  // -- A failed step leaves rows beyond the count, which the next step overwrites
  o->broken = task->status == CT_ERROR_FILE;
  if (o->broken) return;
  ct_disk_trim(&o->disk, o->file);
  if (task->status != CT_OK) return;
  o->row++;
  ct_disk_rename(task, &o->disk);
}

ct_status ct_output_append_row(ct_output *output, const ct_problem *problem, ct_state *state,
                               const ct_ledger *row, ct_error *error)
{
  if (output == NULL || problem == NULL || state == NULL)
    return CT_REFUSE(error, "ct_output_append needs an output, a problem and a state");
  if (row != NULL &&
      (row->momentum == NULL || row->effects == NULL || row->energy.time != state->time))
    return CT_REFUSE(error, "ct_output_append_row needs the whole row of the state's time");
  ct_task task = task_on(output, error);
  H5E_BEGIN_TRY { append(&task, output, problem, state, row); }
  H5E_END_TRY
  return task.status;
}

ct_status ct_output_append(ct_output *output, const ct_problem *problem, ct_state *state,
                           ct_error *error)
{
  return ct_output_append_row(output, problem, state, NULL, error);
}

static ct_status append_state(void *output, ct_state *state, ct_error *error)
{
  return ct_output_append(output, state->problem, state, error);
}

static ct_status prepare(void *output, const ct_problem *problem, ct_state *state, int64_t count,
                         ct_error *error)
{
  (void)output, (void)problem, (void)state, (void)count;
  return ct_hdf5_check_version(error);
}

ct_observer ct_output_observer(ct_output *output, int64_t every)
{
  static const ct_observer_calls CALLS = {.prepare = prepare, .check = append_state};
  return (ct_observer){.calls = &CALLS, .data = output, .every = every};
}

/* -- Close -- */

ct_status ct_output_close(ct_output *output, ct_error *error)
{
  if (output == NULL) return ct_hdf5_check_version(error);
  ct_task task = task_on(output, error);
  if (output->broken)
    ct_task_fail(&task, CT_ERROR_FILE, CT_NOWHERE,
                 "a step could not be written; the steps before it are in the file");
  H5E_BEGIN_TRY { destroy(&task, output); }
  H5E_END_TRY
  return task.status;
}
