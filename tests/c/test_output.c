/* Results file and restart. Besides the tests: `test_output --write FILE STEPS` writes a file with
 * known numbers for the Python tests. */
#define _XOPEN_SOURCE 700

#include "bodies.h"
#include "counting.h"

#include <libcontact/output.h>

#include <hdf5.h>

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* -- The disk under HDF5: all writes pass through here -- */

static struct {
  long writes;    /* writes so far */
  long fail_from; /* the disk is full from this write on; 0: never */
  int snapshots;  /* copy the file before each write, and again with the write cut at the first page
                     boundary */
  int snapshot_count;
  char folder[256];
} disk;

static void real_write(int file, const void *bytes, size_t size, off_t at)
{
  if (lseek(file, at, SEEK_SET) < 0 || write(file, bytes, size) != (ssize_t)size) abort();
}

static void snapshot(int file, const void *bytes, size_t size, off_t at)
{
  char name[320];
  struct stat found;
  snprintf(name, sizeof name, "%s/snapshot%d", disk.folder, disk.snapshot_count++);
  int copy = open(name, O_RDWR | O_CREAT | O_TRUNC, 0666);
  if (copy < 0 || fstat(file, &found) != 0) abort();
  char *all = malloc((size_t)found.st_size + 1);
  lseek(file, 0, SEEK_SET);
  if (all == NULL || read(file, all, (size_t)found.st_size) != (ssize_t)found.st_size) abort();
  real_write(copy, all, (size_t)found.st_size, 0);
  if (size > 0) real_write(copy, bytes, size, at);
  free(all);
  close(copy);
}

ssize_t pwrite(int file, const void *bytes, size_t size, off_t at);
ssize_t pwrite(int file, const void *bytes, size_t size, off_t at)
{
  disk.writes++;
  if (disk.fail_from > 0 && disk.writes >= disk.fail_from) {
    errno = ENOSPC;
    return -1;
  }
  if (disk.snapshots) {
    size_t page = 4096 - (size_t)at % 4096;
    snapshot(file, bytes, 0, at);
    if (size > page) snapshot(file, bytes, page, at);
  }
  if (lseek(file, at, SEEK_SET) < 0) return -1;
  return write(file, bytes, size);
}

ssize_t pwrite64(int file, const void *bytes, size_t size, off_t at);
ssize_t pwrite64(int file, const void *bytes, size_t size, off_t at)
{
  return pwrite(file, bytes, size, at);
}

/* -- A problem: a hex8 body, a curved hex20 body, and an effect with memory -- */

typedef struct rig {
  ct_scene *scene;
  ct_body body[2];
  ct_effect probe;
  const ct_effect *effects[2];
  ct_problem problem;
} rig;

static const int32_t PROBE_NODES[3] = {1, 5, 7};

/* Springs that harden with the displacement of their nodes. */
static ct_status hardening_force(const ct_effect *effect, const ct_view *view, double *force,
                                 ct_error *error)
{
  (void)error;
  for (int i = 0; i < 9; i++) {
    double u = view->displacement[3 * effect->nodes[i / 3] + i % 3];
    force[i] = -(0.01 + view->memory[i % 3]) * u;
    if (i / 3 == 0) view->next_memory[i] = view->memory[i] + fabs(u);
  }
  return CT_OK;
}

static rig *rig_create(int curved, int with_probe)
{
  static const ct_box BOX[2] = {{.origin = {-1.5, 0, 0}, .size = {1.5, 1, 1}, .cells = {3, 2, 1}},
                                {.size = {2, 1, 1}, .cells = {2, 1, 1}}};
  const ct_material material = {2.5, 0.25, 2, CT_LINEAR};
  rig *r = room(1, sizeof *r);
  r->scene = new_scene();
  for (int b = 0; b < 2; b++) {
    ct_mesh *mesh = mesh_of(b == 0 ? CT_HEX8 : CT_HEX20, BOX[b]);
    double *velocity = numbers(3 * mesh->node_count);
    for (int32_t i = 0; i < mesh->node_count; i++) {
      double *x = mesh->nodes + 3 * i;
      if (b == 1 && curved) x[0] += 0.1 * x[1] * x[1];
      for (int c = 0; c < 3; c++) velocity[3 * i + c] = 0.01 * sin(9 * i + 3 * c + b);
    }
    add_moving_body(r->scene, b == 0 ? "left" : "right", mesh, &material, CT_KERNEL_GENERAL,
                    velocity);
    free_all(velocity);
    free_mesh(mesh);
  }
  r->problem = *build_until(r->scene, 1, 0.5);
  memcpy(r->body, r->problem.bodies, sizeof r->body);
  static const ct_effect_calls calls = {.force = hardening_force};
  r->probe = (ct_effect){
      .label = "probe", .calls = &calls, .nodes = PROBE_NODES, .node_count = 3, .memory_count = 3};
  r->effects[0] = r->problem.effects[0];
  r->effects[1] = &r->probe;
  r->problem.bodies = r->body;
  r->problem.effects = r->effects;
  r->problem.effect_count = with_probe ? 2 : 1;
  r->problem.dt = 0.02;
  return r;
}

static void rig_free(rig *r)
{
  free_scene(r->scene);
  free_all(r);
}

/* Displacement and velocity in closed form: a gradient and a translation that grow with k. */
static double want_displacement(const double *X, int axis, int k)
{
  const double u[3] = {X[0] + 2 * X[1], X[1] - X[2], 3 * X[2]};
  return 1e-3 * (k + 1) * u[axis];
}

static double want_velocity(int axis, int k) { return (k + 1) * (axis + 1) * 0.5; }

static void pose(const rig *r, ct_state *state, int k)
{
  ct_state *hand = new_state(&r->problem);
  for (int32_t i = 0; i < 3 * r->problem.node_count; i++) {
    hand->displacement[i] = want_displacement(r->problem.reference + i / 3 * 3, i % 3, k);
    hand->velocity[i] = want_velocity(i % 3, k);
  }
  for (int64_t i = 0; i < hand->memory_count; i++) hand->memory[i] = k + 1;
  hand->step = 10 * k;
  hand->time = 10 * k * r->problem.dt;
  must(ct_state_copy, &r->problem, hand, state);
  free_state(hand);
}

static ct_output_options all_fields(void)
{
  ct_output_options options = ct_output_options_default();
  options.displacement = options.velocity = options.stress = options.contact_pressure = 1;
  options.scene = "title = \"Zwei Platten: \xce\xb1\"\n";
  return options;
}

/* -- Reading with HDF5 itself -- */

static int open_quietly(const char *path, hid_t *file)
{
  H5E_BEGIN_TRY { *file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT); }
  H5E_END_TRY
  return *file >= 0;
}

/* The first `rows` rows of a dataset as doubles, or null. */
static double *read_rows(hid_t file, const char *name, hsize_t rows, hsize_t width)
{
  double *values = NULL;
  H5E_BEGIN_TRY
  {
    hsize_t start[2] = {0, 0}, size[2] = {rows, width};
    int rank = width > 0 ? 2 : 1, good = 0;
    hid_t set = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(set);
    if (H5Sget_simple_extent_ndims(space) == rank &&
        H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, size, NULL) >= 0) {
      hid_t memory = H5Screate_simple(rank, size, NULL);
      values = malloc((size_t)(rows * (width > 0 ? width : 1) + 1) * sizeof *values);
      good = H5Dread(set, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values) >= 0;
      H5Sclose(memory);
    }
    if (!good) free(values), values = NULL;
    H5Sclose(space);
    H5Dclose(set);
  }
  H5E_END_TRY
  return values;
}

static long visible_steps(hid_t file)
{
  long steps = -1;
  H5E_BEGIN_TRY
  {
    hid_t attribute = H5Aopen_by_name(file, "VTKHDF/Steps", "NSteps", H5P_DEFAULT, H5P_DEFAULT);
    if (H5Aread(attribute, H5T_NATIVE_LONG, &steps) < 0) steps = -1;
    H5Aclose(attribute);
  }
  H5E_END_TRY
  return steps;
}

/* Check that each visible step of a file written with `pose` is there and correct. Returns the
 * number of steps, or -1. */
static long check_steps(const rig *r, const char *path)
{
  static const struct {
    const char *name;
    int rows, width;
  } TABLE[] = {
      {"VTKHDF/Steps/Values", 1, 0},       {"VTKHDF/Steps/PointDataOffsets/displacement", 1, 0},
      {"VTKHDF/Steps/CellOffsets", 1, 1},  {"VTKHDF/FieldData/kinetic", 1, 0},
      {"VTKHDF/FieldData/momentum", 1, 3}, {"libcontact/step", 1, 0},
      {"VTKHDF/CellData/stress", 8, 6},    {"VTKHDF/Steps/FieldDataOffsets/total", 1, 0}};
  hid_t file;
  if (!open_quietly(path, &file)) return -1;
  long steps = visible_steps(file), good = steps;
  int64_t n = 3 * (int64_t)r->problem.node_count;
  double *u = steps > 0
                  ? read_rows(file, "VTKHDF/PointData/displacement", (hsize_t)(steps * n / 3), 3)
                  : NULL;
  if (u == NULL) good = -1;
  for (int64_t i = 0; i < steps * n && good >= 0; i++)
    if (u[i] != want_displacement(r->problem.reference + i % n / 3 * 3, (int)(i % 3), (int)(i / n)))
      good = -1;
  for (size_t t = 0; t < sizeof TABLE / sizeof TABLE[0] && good >= 0; t++) {
    double *rows =
        read_rows(file, TABLE[t].name, (hsize_t)(steps * TABLE[t].rows), (hsize_t)TABLE[t].width);
    if (rows == NULL) good = -1;
    for (long k = 0; k < steps && good >= 0 && t == 0; k++)
      if (rows[k] != 10 * (double)k * r->problem.dt) good = -1;
    free(rows);
  }
  free(u);
  H5Fclose(file);
  return good;
}

/* The record of a file written with `pose`: its k, or -1 if there is none or it is incomplete. */
static long check_record(const rig *r, const char *path, ct_error *error)
{
  ct_state *state = new_state(&r->problem);
  long k = -1;
  if (ct_output_restart(path, &r->problem, state, error) == CT_OK) {
    k = (long)(state->step / 10);
    for (int32_t i = 0; i < 3 * r->problem.node_count && k >= 0; i++)
      if (state->displacement[i] !=
              want_displacement(r->problem.reference + i / 3 * 3, i % 3, (int)k) ||
          state->velocity[i] != want_velocity(i % 3, (int)k))
        k = -1;
    for (int64_t i = 0; i < state->memory_count && k >= 0; i++)
      if (state->memory[i] != (double)(k + 1)) k = -1;
  }
  free_state(state);
  return k;
}

static char folder[200];

static const char *in_folder(const char *name)
{
  static char path[16][320];
  static int turn;
  turn = (turn + 1) % 16;
  snprintf(path[turn], sizeof path[turn], "%s/%s", folder, name);
  return path[turn];
}

static ct_output *must_create_with(const rig *r, const char *path, const ct_probes *probes)
{
  ct_output *output;
  ct_output_options options = all_fields();
  options.probes = probes;
  must(ct_output_create, path, &r->problem, &options, &output);
  return output;
}

static ct_output *must_create(const rig *r, const char *path)
{
  return must_create_with(r, path, NULL);
}

/* A probe of one node and of a stress. */
static ct_probes *must_probe(const rig *r)
{
  static const int32_t node = 7;
  ct_probes *probes;
  ct_probe_def def = ct_probe_def_default();
  def.name = "node 7 \xce\xb1";
  def.nodes = &node;
  def.node_count = 1;
  def.element = 1;
  def.take[CT_QUANTITY_DISPLACEMENT] = def.take[CT_QUANTITY_STRESS] = 1;
  must(ct_probes_create, &r->problem, &def, 1, &probes);
  return probes;
}

/* Whether a file returns the rows of the poses 0 ... k and no others. */
static int check_history(const rig *r, const char *path, long k)
{
  ct_probes *probes = must_probe(r);
  ct_state *state = new_state(&r->problem);
  ct_probe_history history = {.row_count = -1};
  ct_error error;
  int good = ct_output_restart(path, &r->problem, state, &error) == CT_OK &&
             ct_output_restart_probes(path, state, probes, &error) == CT_OK &&
             ct_probes_history(probes, 0, &history, NULL) == CT_OK && history.row_count == k + 1;
  for (long i = 0; good && i <= k; i++) {
    const double *row = &history.rows[i * history.width];
    good = row[0] == (double)(10 * i) * r->problem.dt;
    for (int c = 0; c < 3; c++)
      good = good && row[1 + c] == want_displacement(r->problem.reference + 21, c, (int)i);
    // Hooke's law for the strain 1e-3 (i + 1) diag(1, 1, 3): σyy = λ tr ε + 2 μ εyy, λ = μ = 1.
    good = good && fabs(row[5] - 7e-3 * (double)(i + 1)) <= 1e-14 * (double)(i + 1);
  }
  ct_probes_free(probes);
  free_state(state);
  return good;
}

/* Write `steps` posed steps to a file. */
static void write_file(const rig *r, const char *path, int steps)
{
  ct_output *output = must_create(r, path);
  ct_state *state = new_state(&r->problem);
  for (int k = 0; k < steps; k++) {
    pose(r, state, k);
    must(ct_output_append, output, &r->problem, state);
  }
  must(ct_output_close, output);
  free_state(state);
}

/* -- Tests -- */

static void refuse_restart(const rig *r, const char *path, ct_status want, const char *reason)
{
  ct_state *state = new_state(&r->problem);
  ct_error error = {0};
  ct_status status = ct_output_restart(path, &r->problem, state, &error);
  tap_ok(status == want && strstr(error.text, reason) != NULL && state->step == 0,
         "restart refused: %s", error.text);
  free_state(state);
}

static void test_restart_continues(void)
{
  rig *r = rig_create(0, 1);
  ct_error error;
  ct_state *straight = new_state(&r->problem), *stopped = new_state(&r->problem),
           *resumed = new_state(&r->problem);
  ct_output *output = must_create(r, in_folder("restart.vtkhdf"));
  int good = ct_run(&r->problem, straight, 25, NULL, 0, &error) == CT_OK;
  const ct_observer writer = ct_output_observer(output, 5);
  good = good && ct_run(&r->problem, stopped, 15, &writer, 1, &error) == CT_OK;
  tap_ok(good && ct_output_close(output, &error) == CT_OK, "15 steps are run, 3 of them written");
  good = ct_output_restart(in_folder("restart.vtkhdf"), &r->problem, resumed, &error) == CT_OK;
  tap_ok(good && resumed->step == 15, "the newest record is read (step %ld)", (long)resumed->step);
  good = ct_run(&r->problem, resumed, 10, NULL, 0, &error) == CT_OK;
  tap_ok(straight->memory_count == 3 && straight->memory[0] > 0, "the effect has memory");
  tap_ok(good && same_state(resumed, straight),
         "stopped, saved and restarted: the same bits as the uninterrupted run");
  ct_energy a, b;
  good = ct_energy_of(&r->problem, straight, &a, &error) == CT_OK &&
         ct_energy_of(&r->problem, resumed, &b, &error) == CT_OK;
  tap_ok(good && a.total == b.total && a.balance == b.balance, "and the same energy balance");
}

/* A run that divides its step: a record has the step with which it was written, and only a problem
 * with that step continues it (eq:record-step). */
static void test_step_of_a_record(void)
{
  rig *r = rig_create(0, 1);
  ct_problem fine = r->problem;
  ct_error error;
  const char *path = in_folder("divided.vtkhdf");
  double dt[4] = {0};
  fine.dt = r->problem.dt / 4;
  ct_state *coarse = new_state(&r->problem), *state = new_state(&fine), *resumed = new_state(&fine);
  ct_output *output = must_create(r, path);
  must(ct_output_append, output, &r->problem, coarse);
  must(ct_output_restart_step, path, &r->problem, coarse, &dt[0]);
  must(ct_run, &r->problem, coarse, 7, NULL, 0);
  must(ct_output_append, output, &r->problem, coarse);
  must(ct_output_restart_step, path, &fine, state, &dt[1]);
  must(ct_state_subdivide_step, &fine, coarse, state);
  must(ct_run, &fine, state, 5, NULL, 0);
  must(ct_output_append, output, &fine, state);
  must(ct_output_restart_step, path, &r->problem, coarse, &dt[2]);
  must(ct_output_close, output);
  tap_ok(dt[0] == r->problem.dt && dt[1] == r->problem.dt && dt[2] == fine.dt && coarse->step == 7,
         "records with the steps %g, %g and %g; reading the step changes no state", dt[0], dt[1],
         dt[2]);
  refuse_restart(r, path, CT_ERROR_FILE, "the time step");
  tap_ok(ct_output_restart(path, &fine, resumed, &error) == CT_OK && resumed->step == 33 &&
             same_state(resumed, state),
         "a problem with the step of the record continues it with the same bits");
  tap_ok(ct_output_restart_step(path, &fine, state, NULL, &error) == CT_ERROR_ARGUMENT &&
             ct_output_restart_step(in_folder("absent.vtkhdf"), &fine, state, &dt[3], &error) ==
                 CT_ERROR_FILE,
         "no step of a file that does not exist: %s", error.text);
  free_state(state); // its problem ends here
  free_state(resumed);
}

/* Until the monitor is created, a restart must need no more memory than a run. */
static void test_restart_makes_no_state(void)
{
  ct_error error;
  need(ct_set_allocator(&COUNTING, NULL), NULL);
  rig *r = rig_create(0, 1);
  write_file(r, in_folder("lean.vtkhdf"), 2);
  ct_state *state = new_state(&r->problem);
  long calls = counted.calls;
  int good = ct_output_restart(in_folder("lean.vtkhdf"), &r->problem, state, &error) == CT_OK;
  tap_ok(good && counted.calls == calls,
         "a restart allocates no library memory besides the state (%ld blocks)",
         counted.calls - calls);
  free_state(state);
  rig_free(r);
  tap_ok(counted.blocks == 0 && ct_set_allocator(NULL, NULL) == CT_OK,
         "and no memory stays allocated");
}

/* tests/python/test_output.py reads the other contents of the file. */
static void test_contents(void)
{
  rig *r = rig_create(1, 0);
  const char *path = in_folder("contents.vtkhdf");
  ct_error error;
  write_file(r, path, 3);
  tap_ok(check_steps(r, path) == 3,
         "3 steps are visible, and every displacement is the one that was set");
  tap_ok(check_record(r, path, &error) == 2, "the restart record is the newest step");
}

static int interesting(int k)
{
  return (k >= 1 && k <= 22) || (k >= 35 && k <= 37) || (k >= 62 && k <= 69) ||
         (k >= 127 && k <= 129) || k == 256 || k == 512 || k == 513;
}

/* A kill leaves the file as it is between two writes of HDF5, or with a write cut at a page
 * boundary. */
static void test_any_moment(void)
{
  rig *r = rig_create(0, 1);
  ct_probes *probes = must_probe(r);
  ct_output *output = must_create_with(r, in_folder("moments.vtkhdf"), probes);
  ct_state *state = new_state(&r->problem);
  ct_error error;
  long moments = 0, bad_steps = 0, bad_records = 0, bad_histories = 0;
  snprintf(disk.folder, sizeof disk.folder, "%s", folder);
  for (int k = 0; k <= 513; k++) {
    pose(r, state, k);
    must(ct_probes_sample, probes, state);
    disk.snapshots = interesting(k);
    disk.snapshot_count = 0;
    if (ct_output_append(output, &r->problem, state, &error)) abort();
    disk.snapshots = 0;
    for (int i = 0; i < disk.snapshot_count; i++) {
      char path[320];
      snprintf(path, sizeof path, "%s/snapshot%d", folder, i);
      long steps = check_steps(r, path), record = check_record(r, path, &error);
      moments++;
      if (steps != k && steps != k + 1)
        bad_steps++, printf("# append %d, write %d: steps %ld\n", k, i, steps);
      if (record != k && record != k - 1)
        bad_records++, printf("# append %d, write %d: record %ld: %s\n", k, i, record, error.text);
      if (record >= 0 && !check_history(r, path, record)) bad_histories++;
      remove(path);
    }
  }
  ct_output_close(output, NULL);
  if (moments == 0)
    tap_skip("this HDF5 does not write through pwrite, so its writes can't be watched");
  else {
    tap_ok(bad_records == 0,
           "a complete restart record at each of %ld times between writes and within them",
           moments);
    tap_ok(bad_steps == 0, "all earlier steps are readable at each of them");
    tap_ok(bad_histories == 0, "and the history of a probe up to the record");
  }
  ct_probes_free(probes);
}

static int descriptor_count(void)
{
  int open_ones = 0;
  for (int i = 0; i < 64; i++) open_ones += fcntl(i, F_GETFD) >= 0;
  return open_ones;
}

/* A child whose disk is full from write number `from` on: 0 if everything was correct, else a
 * number for the fault. */
static int full_disk_child(const rig *r, const char *path, long from, const char *errors)
{
  const ct_output_options all = all_fields();
  int said = open(errors, O_RDWR | O_CREAT | O_TRUNC, 0666);
  dup2(said, 2);
  int before = descriptor_count(), failed = 0, k = 0;
  ct_output *output = NULL;
  ct_error error = {.body = -1, .element = -1, .point = -1};
  ct_state *state = new_state(&r->problem);
  disk.writes = 0;
  disk.fail_from = from;
  ct_status status = ct_output_create(path, &r->problem, &all, &output, &error);
  for (; k < 6 && status == CT_OK; k++) {
    pose(r, state, k);
    status = ct_output_append(output, &r->problem, state, &error);
  }
  failed = status != CT_OK;
  if (failed && (status != CT_ERROR_FILE || strstr(error.text, "No space left") == NULL ||
                 strstr(error.text, "full.vtkhdf") == NULL))
    return 2;
  if (failed && output != NULL &&
      ct_output_append(output, &r->problem, state, &error) != CT_ERROR_FILE)
    return 3;
  status = ct_output_close(output, &error);
  if (failed && output != NULL && status != CT_ERROR_FILE) return 4;
  // The last bytes are written when the file is closed
  if (!failed && status != CT_OK && status != CT_ERROR_FILE) return 5;
  failed = failed || status != CT_OK;
  if (descriptor_count() != before) return 6;
  disk.fail_from = 0;
  struct stat found;
  // Errors are reported through `error` only
  H5close();
  if (stat(errors, &found) != 0 || found.st_size != 0) return 7;
  // The steps before the failure are there
  if (failed && k > 1 && check_record(r, path, &error) < k - 2) return 8;
  if (failed && k > 1 && check_steps(r, path) < k - 1) return 9;
  return failed ? 0 : 100;
}

static void test_failing_writes(void)
{
  rig *r = rig_create(0, 1);
  int tried = 0, good = 0, finished = 0;
  for (long from = 1; from < 2000 && !finished; from += from < 40 ? 1 : 7) {
    char path[320], errors[320];
    snprintf(path, sizeof path, "%s/full.vtkhdf", folder);
    snprintf(errors, sizeof errors, "%s/stderr.txt", folder);
    remove(path);
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) _exit(full_disk_child(r, path, from, errors));
    int how = 0;
    waitpid(child, &how, 0);
    tried++;
    finished = WIFEXITED(how) && WEXITSTATUS(how) == 100;
    if (finished || (WIFEXITED(how) && WEXITSTATUS(how) == 0)) good++;
    else
      printf("# full from write %ld on: %s %d\n", from, WIFEXITED(how) ? "code" : "signal",
             WIFEXITED(how) ? WEXITSTATUS(how) : how);
  }
  tap_ok(finished && good == tried,
         "disk full at %d of %d writes: reported with the reason, closed, no open handles, nothing "
         "printed",
         good, tried);
}

static void test_full_disk(void)
{
  const ct_output_options all = all_fields();
  rig *r = rig_create(0, 1);
  char mount_point[320], command[800], path[400], ballast[400];
  snprintf(mount_point, sizeof mount_point, "%s/small", folder);
  mkdir(mount_point, 0777);
  snprintf(command, sizeof command, "mount -t tmpfs -o size=1m none '%s' 2>/dev/null", mount_point);
  if (system(command) != 0) {
    tap_skip("a small disk can't be mounted here (not root?)");
    return;
  }
  snprintf(path, sizeof path, "%s/run.vtkhdf", mount_point);
  snprintf(ballast, sizeof ballast, "%s/ballast", mount_point);
  FILE *file = fopen(ballast, "w");
  for (int i = 0; i < 300000 && file != NULL; i++) fputc('x', file);
  fclose(file);
  ct_output *output = must_create(r, path);
  ct_state *state = new_state(&r->problem);
  ct_error error;
  ct_status status = CT_OK;
  int k = 0;
  for (; k < 1000 && status == CT_OK; k++) {
    pose(r, state, k);
    status = ct_output_append(output, &r->problem, state, &error);
  }
  tap_ok(status == CT_ERROR_FILE && strstr(error.text, "run.vtkhdf") != NULL &&
             strstr(error.text, "No space left") != NULL,
         "full disk after %d steps: %s", k - 1, error.text);
  tap_ok(check_steps(r, path) == k - 1 && check_record(r, path, &error) == k - 2,
         "all %d steps before are in the file", k - 1);
  remove(ballast);
  tap_ok(ct_output_append(output, &r->problem, state, &error) == CT_OK &&
             ct_output_close(output, &error) == CT_OK,
         "once there is space again, the run continues");
  tap_ok(check_steps(r, path) == k && check_record(r, path, &error) == k - 1,
         "and no step is missing");
  file = fopen(ballast, "w");
  while (file != NULL && fputc('x', file) != EOF && fflush(file) == 0) continue;
  if (file != NULL) fclose(file);
  ct_output *none = NULL;
  tap_ok(ct_output_create(path, &r->problem, &all, &none, &error) == CT_ERROR_FILE && none == NULL,
         "no space to create: %s", error.text);
  tap_ok(check_steps(r, path) == k, "the old file is unchanged");
  snprintf(command, sizeof command, "umount -l '%s'", mount_point);
  if (system(command) != 0) printf("# %s stays mounted\n", mount_point);
}

static void refuse_create(const rig *r, const char *path, ct_status want, const char *reason)
{
  const ct_output_options all = all_fields();
  ct_output *output = NULL;
  ct_error error = {0};
  ct_status status = ct_output_create(path, &r->problem, &all, &output, &error);
  tap_ok(status == want && output == NULL && error.code == want &&
             strstr(error.text, reason) != NULL,
         "create '%.30s': %s", path == NULL ? "(null)" : path, error.text);
}

static void test_bad_paths(void)
{
  const ct_output_options all = all_fields();
  rig *r = rig_create(0, 0);
  char blocked[320];
  snprintf(blocked, sizeof blocked, "%s/blocked.vtkhdf", folder);
  mkdir(in_folder("blocked.vtkhdf.part"), 0777);
  refuse_create(r, NULL, CT_ERROR_ARGUMENT, "path");
  refuse_create(r, "", CT_ERROR_ARGUMENT, "path");
  refuse_create(r, folder, CT_ERROR_FILE, "Is a directory");
  refuse_create(r, "/dev/null", CT_ERROR_FILE, "no ordinary file");
  refuse_create(r, "/no such folder/run.vtkhdf", CT_ERROR_FILE, "No such file or directory");
  refuse_create(r, "/proc/run.vtkhdf", CT_ERROR_FILE,
                "/proc/run.vtkhdf: can't write the file: No such file");
  refuse_create(r, blocked, CT_ERROR_FILE, "Is a directory");
  tap_ok(access(in_folder("blocked.vtkhdf.part"), F_OK) == 0,
         "the object in the way is not removed");
  tap_ok(ct_output_create(blocked, NULL, &all, NULL, NULL) == CT_ERROR_ARGUMENT,
         "nulls are refused");
  tap_ok(ct_output_append(NULL, NULL, NULL, NULL) == CT_ERROR_ARGUMENT,
         "append with nulls is refused");
  tap_ok(ct_output_restart(NULL, NULL, NULL, NULL) == CT_ERROR_ARGUMENT,
         "restart with nulls is refused");
  tap_ok(ct_output_close(NULL, NULL) == CT_OK, "closing null is no error");
}

static void test_names(void)
{
  rig *r = rig_create(0, 0);
  const char *path = in_folder("names.vtkhdf"), *part = in_folder("names.vtkhdf.part");
  ct_error error;
  write_file(r, path, 2);
  ct_output *output = must_create(r, path);
  tap_ok(check_steps(r, path) == 2, "a new run does not touch the old file until its first step");
  tap_ok(ct_output_close(output, &error) == CT_OK && check_steps(r, path) == 2 &&
             access(part, F_OK) != 0,
         "and never if it has no step");
  write_file(r, path, 1);
  tap_ok(check_steps(r, path) == 1 && access(part, F_OK) != 0, "a run with a step replaces it");
  char target[320], link[320];
  snprintf(target, sizeof target, "%s", path);
  snprintf(link, sizeof link, "%s/link.vtkhdf", folder);
  if (symlink(target, link) != 0) printf("# no symbolic link\n");
  write_file(r, link, 3);
  tap_ok(check_steps(r, path) == 3, "a symbolic link is followed");
}

/* A process that writes `steps` steps to a file and then waits, until it is killed. */
static pid_t start_writer(const rig *r, const char *path, int steps)
{
  int ready[2];
  char sign = 0;
  if (pipe(ready) != 0) abort();
  pid_t child = fork();
  if (child == 0) {
    ct_output *output = must_create(r, path);
    ct_state *state = new_state(&r->problem);
    ct_error error;
    for (int k = 0; k < steps; k++) {
      pose(r, state, k);
      if (ct_output_append(output, &r->problem, state, &error)) _exit(1);
    }
    if (write(ready[1], &sign, 1) != 1) _exit(1);
    for (;;) pause();
  }
  close(ready[1]);
  if (child < 0 || read(ready[0], &sign, 1) != 1) abort();
  close(ready[0]);
  return child;
}

/* One writer per file, in this process and in others, under the temporary name before its first
 * step and under the final name. */
static void test_one_writer(void)
{
  rig *r = rig_create(0, 0);
  const char *path = in_folder("writer.vtkhdf"), *part = in_folder("writer.vtkhdf.part");
  ct_error error;
  ct_state *state = new_state(&r->problem);
  char reason[400];
  snprintf(reason, sizeof reason, "%s: can't write the file: another run is writing it", path);
  ct_output *first = must_create(r, path);
  refuse_create(r, path, CT_ERROR_FILE, reason);
  for (int k = 0; k < 2; k++) {
    pose(r, state, k);
    tap_ok(ct_output_append(first, &r->problem, state, &error) == CT_OK, "the first run continues");
    refuse_create(r, path, CT_ERROR_FILE, reason);
    tap_ok(check_steps(r, path) == k + 1 && access(part, F_OK) != 0,
           "and its file can be read while it is written");
  }
  tap_ok(ct_output_close(first, &error) == CT_OK && check_steps(r, path) == 2,
         "the first run has all its steps");
  for (int steps = 0; steps < 3; steps += 2) {
    pid_t writer = start_writer(r, path, steps);
    refuse_create(r, path, CT_ERROR_FILE, reason);
    kill(writer, SIGKILL);
    waitpid(writer, NULL, 0);
    tap_ok((access(part, F_OK) == 0) == (steps == 0), "a killed run leaves its steps");
    write_file(r, path, 1);
    tap_ok(check_steps(r, path) == 1 && access(part, F_OK) != 0, "and blocks no other");
  }
}

/* An object with the temporary name is replaced; a link there is not followed. */
static void test_part_is_a_link(void)
{
  rig *r = rig_create(0, 0);
  const char *path = in_folder("linked.vtkhdf"), *part = in_folder("linked.vtkhdf.part"),
             *other = in_folder("other.txt");
  struct stat found;
  for (int hard = 0; hard < 3; hard++) {
    FILE *text = fopen(other, "w");
    if (text == NULL || fputs("precious", text) < 0 || fclose(text) != 0) abort();
    if ((hard == 0 && symlink(other, part) != 0) || (hard == 1 && link(other, part) != 0) ||
        (hard == 2 && mkfifo(part, 0666) != 0))
      abort();
    write_file(r, path, 2);
    tap_ok(stat(other, &found) == 0 && found.st_size == 8 && check_steps(r, path) == 2 &&
               lstat(path, &found) == 0 && S_ISREG(found.st_mode),
           "a %s in the way is replaced and not followed",
           hard == 0   ? "symbolic link"
           : hard == 1 ? "link"
                       : "pipe");
  }
}

static void test_wrong_state(void)
{
  rig *r = rig_create(0, 1), *other = rig_create(0, 0);
  const char *path = in_folder("wrong.vtkhdf");
  ct_error error = {0};
  ct_output *output = must_create(r, path);
  ct_state *state = new_state(&r->problem), *foreign = new_state(&other->problem);
  pose(r, state, 0);
  tap_ok(ct_output_append(output, &r->problem, state, &error) == CT_OK, "a good step");
  tap_ok(ct_output_append(output, &other->problem, foreign, &error) == CT_ERROR_ARGUMENT,
         "another problem: %s", error.text);
  tap_ok(ct_output_append(output, &r->problem, foreign, &error) == CT_ERROR_ARGUMENT,
         "another state: %s", error.text);
  int32_t node = r->body[1].first_node + 2;
  state->displacement[3 * node + 1] = NAN;
  tap_ok(ct_output_append(output, &r->problem, state, &error) == CT_ERROR_BLOWUP &&
             error.body == 1 && error.point == 2,
         "not finite: %s", error.text);
  tap_ok(check_record(r, path, &error) == 0,
         "the last good record stays, readable while the file is open for writing");
  // -- The second body inside out, of a law that has no stress there
  pose(r, state, 1);
  for (int32_t i = r->body[1].first_node; i < r->problem.node_count; i++)
    state->displacement[3 * i] = -2.0 * r->problem.reference[3 * i];
  r->body[1].material.law = CT_NEO_HOOKEAN;
  tap_ok(ct_output_append(output, &r->problem, state, &error) == CT_ERROR_GEOMETRY &&
             error.element == 0,
         "a step without stresses: %s", error.text);
  r->body[1].material.law = CT_LINEAR;
  tap_ok(check_record(r, path, &error) == 0 && check_steps(r, path) == 1,
         "leaves steps and record unchanged");
  pose(r, state, 1);
  tap_ok(ct_output_append(output, &r->problem, state, &error) == CT_OK, "and the run may continue");
  ct_output_close(output, NULL);
  tap_ok(check_steps(r, path) == 2, "with consecutive steps");
}

static void test_other_problem(void)
{
  rig *r = rig_create(0, 1), *curved = rig_create(1, 1), *bare = rig_create(0, 0);
  const char *path = in_folder("other.vtkhdf");
  write_file(r, path, 2);
  refuse_restart(curved, path, CT_ERROR_FILE, "has another position");
  refuse_restart(bare, path, CT_ERROR_FILE, "'libcontact/effects' has 2 rows, the problem 1");
  r->probe.label = "gravity";
  refuse_restart(r, path, CT_ERROR_FILE,
                 "effect 1 'gravity' (in the file 'probe') has another name");
  r->probe.label = "probe";
  r->probe.memory_count = 4;
  refuse_restart(r, path, CT_ERROR_FILE, "another number of values of memory");
  r->probe.memory_count = 3;
  r->problem.dt = 0.03;
  refuse_restart(r, path, CT_ERROR_FILE, "the time step");
  r->problem.dt = 0.02;
  r->problem.integrator = (ct_integrator){CT_TCHAMWA_WIELGOSZ, 0.9};
  refuse_restart(r, path, CT_ERROR_FILE, "the integrator");
  r->problem.integrator = (ct_integrator){CT_CENTRAL_DIFFERENCE, 0.0};
  r->body[1].material.density = 3;
  refuse_restart(r, path, CT_ERROR_FILE,
                 "body 1 'right' (in the file 'right') has another density");
  r->body[1].material.density = 2;
  strcpy(r->body[0].name, "anvil");
  refuse_restart(r, path, CT_ERROR_FILE, "has another name");
  strcpy(r->body[0].name, "left");
  ct_error error;
  tap_ok(check_record(r, path, &error) == 1, "and the right problem is still accepted");
}

/* Change the file's bytes at `needle`, which must be there. */
static int spoil(const char *path, const double *needle)
{
  FILE *file = fopen(path, "r+b");
  fseek(file, 0, SEEK_END);
  long size = ftell(file);
  unsigned char *all = malloc((size_t)size);
  rewind(file);
  int hits = 0, good = fread(all, 1, (size_t)size, file) == (size_t)size;
  for (long i = 0; i + 8 <= size && good; i++)
    if (memcmp(all + i, needle, 8) == 0) {
      fseek(file, i, SEEK_SET);
      fputc(all[i] ^ 1, file);
      hits++;
    }
  fclose(file);
  free(all);
  return hits;
}

static void test_bad_files(void)
{
  rig *r = rig_create(0, 1);
  char path[320];
  snprintf(path, sizeof path, "%s", in_folder("bad.vtkhdf"));
  ct_error error;
  refuse_restart(r, in_folder("absent.vtkhdf"), CT_ERROR_FILE, "No such file or directory");
  refuse_restart(r, folder, CT_ERROR_FILE, "Is a directory");
  FILE *text = fopen(in_folder("text.vtkhdf"), "w");
  fputs("x,y\n1,2\n", text);
  fclose(text);
  refuse_restart(r, in_folder("text.vtkhdf"), CT_ERROR_FILE, "text.vtkhdf: can't read the file");
  hid_t foreign = H5Fcreate(in_folder("foreign.h5"), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(foreign);
  refuse_restart(r, in_folder("foreign.h5"), CT_ERROR_FILE, "not written by libcontact");
  write_file(r, path, 3);
  // The memory of step 2 (three times 3.0) and the velocities 4.5 stand in one slot only, but 3.0
  // and 4.5 in the fields as well
  double value = want_velocity(2, 2);
  tap_ok(spoil(path, &value) > 0 && check_record(r, path, &error) == 1,
         "a damaged record: the one before it is used");
  value = want_velocity(2, 1);
  tap_ok(spoil(path, &value) > 0, "both records damaged");
  refuse_restart(r, path, CT_ERROR_FILE, "no complete restart record");
  write_file(r, path, 3);
  struct stat found;
  stat(path, &found);
  int refused = 0, tried = 0;
  for (off_t size = found.st_size - 1; size > 0;
       size -= size > 2000 ? found.st_size / 61 : 97, tried++)
    if (truncate(path, size) == 0 && check_record(r, path, &error) < 0 &&
        error.code == CT_ERROR_FILE)
      refused++;
  tap_ok(refused == tried, "cut short at %d of %d lengths: refused (%s)", refused, tried,
         error.text);
}

static herr_t count_calls(hid_t stack, void *data)
{
  (void)stack;
  ++*(int *)data;
  return 0;
}

/* The host's HDF5 error handler is unchanged after our calls, and gets none of our errors. */
static void test_error_handler(void)
{
  rig *r = rig_create(0, 0);
  int calls = 0;
  void *data = NULL;
  H5E_auto2_t before, after;
  void *before_data;
  H5Eget_auto2(H5E_DEFAULT, &before, &before_data);
  H5Eset_auto2(H5E_DEFAULT, count_calls, &calls);
  refuse_create(r, "/no such folder/run.vtkhdf", CT_ERROR_FILE, "No such file");
  refuse_restart(r, in_folder("text.vtkhdf"), CT_ERROR_FILE, "can't read the file");
  H5Eget_auto2(H5E_DEFAULT, &after, &data);
  tap_ok(calls == 0 && after == count_calls && data == &calls,
         "the host's error handler is unchanged and not called");
  H5Eset_auto2(H5E_DEFAULT, before, before_data);
  tap_ok(H5Fget_obj_count((hid_t)H5F_OBJ_ALL, H5F_OBJ_ALL) == 0, "no HDF5 object is left open");
}

/* Two runs write the same bytes; only HDF5 writes a date into its root group (four times 4 bytes
 * and a checksum). */
static void test_same_bytes(void)
{
  rig *r = rig_create(1, 1);
  write_file(r, in_folder("one.vtkhdf"), 5);
  sleep(1);
  write_file(r, in_folder("two.vtkhdf"), 5);
  FILE *one = fopen(in_folder("one.vtkhdf"), "rb"), *two = fopen(in_folder("two.vtkhdf"), "rb");
  int differences = 0, beyond = 0, a = 0, b = 0;
  for (long i = 0; a != EOF || b != EOF; i++) {
    a = fgetc(one), b = fgetc(two);
    differences += a != b;
    beyond += a != b && i >= 128;
  }
  fclose(one);
  fclose(two);
  tap_ok(differences <= 20 && beyond == 0, "two runs write the same bytes (%d of the date differ)",
         differences);
}

/* A folder for the files of the test: in TMPDIR if that is set, else beside the program, in the
 * build folder. */
static int make_folder(char *program)
{
  char *slash = strrchr(program, '/'), *parent = getenv("TMPDIR"), full[PATH_MAX];
  if (slash != NULL) *slash = 0;
  if (parent == NULL) parent = slash != NULL ? program : ".";
  // The full path, as links to files must hold it.
  if (realpath(parent, full) != NULL &&
      snprintf(folder, sizeof folder, "%s/libcontact-output-XXXXXX", full) < (int)sizeof folder &&
      mkdtemp(folder) != NULL)
    return 1;
  printf("Bail out! no folder in %s for the files of the test: %s\n", parent,
         errno != 0 ? strerror(errno) : "its name is too long");
  return 0;
}

int main(int argc, char **argv)
{
  free_at_end();
  if (argc == 4 && strcmp(argv[1], "--write") == 0) {
    write_file(rig_create(1, 0), argv[2], atoi(argv[3]));
    return 0;
  }
  if (!make_folder(argv[0])) return 1;
  test_step_of_a_record();
  test_restart_makes_no_state();
  test_contents();
  test_restart_continues();
  test_names();
  test_one_writer();
  test_part_is_a_link();
  test_bad_paths();
  test_wrong_state();
  test_other_problem();
  test_bad_files();
  test_error_handler();
  test_same_bytes();
  test_any_moment();
  test_failing_writes();
  test_full_disk();
  char command[400];
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  if (system(command) != 0) printf("# %s stays\n", folder);
  return tap_done();
}
