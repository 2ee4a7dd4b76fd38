/* Results files when calls of libc and HDF5 fail: every call that libcontact-hdf5 makes in a run
 * with output, restart and probes fails once. */
#ifdef __linux__
#define _GNU_SOURCE
#else
#define _XOPEN_SOURCE 700
#endif
#define _FILE_OFFSET_BITS 64

#include "../../libcontact/src/hdf5/hdf5_internal.h"
#include "bodies.h"
#include "counting.h"

#include <fcntl.h>
#include <limits.h>
#include <sys/stat.h>
#include <unistd.h>

/* The sources, with calls that fail; two of them use the same name for another thing. */
#include "faults.h"

#include "../../libcontact/src/hdf5/disk.c"
#undef close
#include "../../libcontact/src/hdf5/driver.c"
#include "../../libcontact/src/hdf5/handle.c"
#include "../../libcontact/src/hdf5/output.c"
#include "../../libcontact/src/hdf5/restart.c"
#define BODIES IDENTITY_BODIES
#define EFFECTS IDENTITY_EFFECTS
#include "../../libcontact/src/hdf5/identity.c"
#undef BODIES
#undef EFFECTS
#include "../../libcontact/src/hdf5/layout.c"
#define GROUP PROBE_GROUP
#include "../../libcontact/src/hdf5/probe.c"
#undef GROUP

enum { RECORDS = 2 };

/* A block that flies and vibrates, its states at the records, and one before them. */
typedef struct rig {
  ct_scene *scene;
  const ct_problem *problem;
  ct_state *want[RECORDS], *old;
  char path[320], part[330];
} rig;

static ct_state *later(const ct_problem *problem, const ct_state *from, int64_t steps)
{
  ct_state *state = new_state(problem);
  if (from != NULL) must(ct_state_copy, problem, from, state);
  advance(problem, state, steps);
  return state;
}

static void rig_open(rig *r, const char *folder)
{
  static const ct_material MATERIAL = {2.5, 0.25, 2, CT_LINEAR};
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 1, 1);
  r->scene = new_scene_with("block", mesh, &MATERIAL, CT_KERNEL_GENERAL, 1, 0, 0);
  add_support(r->scene, 0, mesh, 0, 0.0, "y", 0.0);
  ct_mesh_free(mesh);
  r->problem = build_until(r->scene, 1, 0.5);
  for (int k = 0; k < RECORDS; k++)
    r->want[k] = later(r->problem, k > 0 ? r->want[k - 1] : NULL, 2);
  r->old = later(r->problem, NULL, 1);
  snprintf(r->path, sizeof r->path, "%s/run.vtkhdf", folder);
  snprintf(r->part, sizeof r->part, "%s.part", r->path);
}

static void rig_close(rig *r)
{
  for (int k = 0; k < RECORDS; k++) ct_state_free(r->want[k]);
  close_run(r->old, r->scene, NULL);
}

static ct_probes *must_probe(const rig *r)
{
  static const int32_t node = 3;
  ct_probes *probes;
  ct_probe_def def = ct_probe_def_default();
  def.name = "node 3";
  def.nodes = &node;
  def.node_count = 1;
  def.take[CT_QUANTITY_DISPLACEMENT] = 1;
  must(ct_probes_create, r->problem, &def, 1, &probes);
  return probes;
}

/* -- A run with output, restart and probes -- */

typedef struct outcome {
  ct_status status; /* of the first call that failed */
  ct_error error;
  int appended; /* records that were written without an error */
  long written; /* the number of calls until the file was closed */
  int older;    /* the restart returned a record before the last one */
  int whole;    /* the restart returned the last record, and its probe all rows */
  int spoiled;  /* a restart that failed has changed the state */
} outcome;

static int note(outcome *o, ct_status status, const ct_error *error)
{
  if (status == CT_OK || o->status != CT_OK) return status == CT_OK;
  o->status = status;
  o->error = *error;
  return 0;
}

static void write_run(const rig *r, const ct_probes *probes, outcome *o)
{
  ct_output_options options = ct_output_options_default();
  options.displacement = options.stress = options.contact_pressure = options.filter = 1;
  options.scene = "title = \"block\"\n";
  options.probes = probes;
  ct_output *output = NULL;
  ct_error error = {0};
  if (!note(o, ct_output_create(r->path, r->problem, &options, &output, &error), &error)) return;
  for (int k = 0; k < RECORDS && o->status == CT_OK; k++)
    o->appended += note(o, ct_output_append(output, r->problem, r->want[k], &error), &error);
  note(o, ct_output_close(output, &error), &error);
}

static void read_run(const rig *r, outcome *o)
{
  ct_probes *probes = must_probe(r);
  ct_state *state = later(r->problem, r->old, 0);
  ct_probe_history history = {.row_count = 0};
  ct_error error = {0};
  if (note(o, ct_output_restart(r->path, r->problem, state, &error), &error)) {
    note(o, ct_output_restart_probes(r->path, state, probes, &error), &error);
    need(ct_probes_history(probes, 0, &history, NULL), &error);
    o->older = same_state(state, r->want[RECORDS - 2]) && history.row_count == RECORDS - 1;
    o->whole = same_state(state, r->want[RECORDS - 1]) && history.row_count == RECORDS;
  } else o->spoiled = !same_state(state, r->old);
  ct_state_free(state);
  ct_probes_free(probes);
}

/* The whole run; `old`: over an older file, and beside one that a killed run has left. */
static outcome cycle(const rig *r, int old, long fail_at)
{
  outcome o = {.status = CT_OK};
  ct_probes *probes = must_probe(r);
  faults.fail_at = 0;
  remove(r->path);
  remove(r->part);
  if (old) {
    ct_output_options options = ct_output_options_default();
    options.displacement = 1;
    ct_output *output;
    must(ct_output_create, r->path, r->problem, &options, &output);
    must(ct_output_append, output, r->problem, r->old);
    must(ct_output_close, output);
    FILE *left = fopen(r->part, "w");
    if (left != NULL) fclose(left);
  }
  for (int k = 0; k < RECORDS; k++) must(ct_probes_sample, probes, r->want[k]);
  faults.calls = 0;
  faults.fail_at = fail_at;
  faults.failed = NULL;
  write_run(r, probes, &o);
  o.written = faults.calls;
  if (o.status == CT_OK) read_run(r, &o);
  faults.fail_at = 0;
  ct_probes_free(probes);
  return o;
}

/* -- What a failed call leaves -- */

/* Handles of HDF5, memory and descriptors that are in use. */
typedef struct usage {
  long handles, blocks;
  int descriptors;
} usage;

static usage in_use(void)
{
  usage u = {faults.handles, faults.blocks + counted.blocks, 0};
  u.handles += (long)H5Fget_obj_count((hid_t)H5F_OBJ_ALL, H5F_OBJ_ALL);
  for (int d = 0; d < 64; d++) u.descriptors += fcntl(d, F_GETFD) >= 0;
  return u;
}

/* The number of the record that the file continues with; -1: the older file; -2: there is none; -3:
 * there is one that can't be read. */
static int record_of(const rig *r)
{
  struct stat found;
  ct_error error;
  int record = -3;
  if (stat(r->path, &found) != 0) return -2;
  ct_state *state = new_state(r->problem);
  if (ct_output_restart(r->path, r->problem, state, &error) == CT_OK) {
    if (same_state(state, r->old)) record = -1;
    for (int k = 0; k < RECORDS; k++)
      if (same_state(state, r->want[k])) record = k;
  }
  ct_state_free(state);
  return record;
}

/* Calls whose failure takes nothing from the results, with the reason. */
static const struct {
  const char *name, *reason;
} HARMLESS[] = {
    {"H5Aclose", "it is released"},
    {"H5Dclose", "it is released"},
    {"H5FDclose", "it is released"},
    {"H5FDunregister", "it is released"},
    {"H5Gclose", "it is released"},
    {"H5Pclose", "it is released"},
    {"H5Sclose", "it is released"},
    {"H5Tclose", "it is released"},
    {"H5free_memory", "it is released"},
    {"close", "it is released"},
    {"fcntl", "a file system without locks has none to respect"},
    {"ftruncate", "a file that stays too long is valid"},
    {"fstat", "a file that stays too long is valid"},
    {"H5Fget_filesize", "no space is reserved or returned"},
    {"stat", "no file is there yet"},
    {"lstat", "no file is there yet"},
    {"realpath", "no file is there yet"},
    {"open", "no file is there yet"},
    {"H5Dopen2", "no array is there yet"},
    {"H5Fget_vfd_handle", "another attempt succeeds"},
    {"H5Ewalk2", "the message has no reason"},
};

/* Whether the run may go on. Of the two restart records the newest that can be read is taken, so a
 * fault in reading one of them leads to the other; and a file that was only read is closed. */
static int harmless(const outcome *o, long n)
{
  if (n > o->written && (o->older || (o->whole && strncmp(faults.failed, "H5", 2) == 0))) return 1;
  for (size_t k = 0; k < sizeof HARMLESS / sizeof HARMLESS[0]; k++)
    if (strcmp(HARMLESS[k].name, faults.failed) == 0) return o->whole;
  return 0;
}

typedef struct tally {
  long faults, told, older, silent, wordless, leaks, unreadable, lost, spoiled, left;
} tally;

static void check(const rig *r, int old, long n, tally *t)
{
  usage before = in_use();
  outcome o = cycle(r, old, n);
  usage after = in_use();
  struct stat found;
  int record = record_of(r), failed = o.status != CT_OK;
  long wrong = t->silent + t->wordless + t->leaks + t->unreadable + t->lost + t->spoiled + t->left;
  if (faults.failed == NULL) return;
  t->faults++;
  t->told += failed;
  t->silent += !failed && !harmless(&o, n);
  t->older += !failed && o.older;
  t->wordless += failed && (o.error.code != o.status || strlen(o.error.text) == 0);
  t->leaks += after.handles != before.handles || after.blocks != before.blocks ||
              after.descriptors != before.descriptors;
  t->unreadable += record == -3;
  t->lost += record < (o.appended > 0 ? o.appended - 1 : old ? -1 : -2);
  t->spoiled += o.spoiled;
  t->left += !old && stat(r->part, &found) == 0 && strcmp(faults.failed, "remove") != 0;
  if (wrong != t->silent + t->wordless + t->leaks + t->unreadable + t->lost + t->spoiled + t->left)
    printf("# call %ld, %s: %s: %s; %d records appended, the file has %d, handles %+ld, blocks "
           "%+ld, descriptors %+d%s\n",
           n, faults.failed, ct_status_name(o.status), failed ? o.error.text : "", o.appended,
           record, after.handles - before.handles, after.blocks - before.blocks,
           after.descriptors - before.descriptors, o.whole ? "" : ", not whole");
}

static void each_call_fails(const rig *r, int old, int every)
{
  tally t = {0};
  outcome good = cycle(r, old, 0);
  long calls = faults.calls;
  tap_ok(good.status == CT_OK && good.whole && good.appended == RECORDS,
         "a run %s: %ld calls of libc and HDF5: %s", old ? "over an older file" : "with output",
         calls, good.error.text);
  for (long n = 1; n <= calls; n += every) check(r, old, n, &t);
  tap_ok(t.faults == (calls + every - 1) / every, "of every %d one fails: %ld faults, %ld reported",
         every, t.faults, t.told);
  tap_ok(t.silent == 0,
         "a fault is an error, or changes nothing: %ld are silent; %ld restarts took "
         "the older record",
         t.silent, t.older);
  tap_ok(t.wordless == 0, "an error has its code and a text: %ld have not", t.wordless);
  tap_ok(t.leaks == 0, "handles, memory and descriptors are returned: %ld leak", t.leaks);
  tap_ok(t.unreadable == 0, "no file or one that can be read: %ld can't", t.unreadable);
  tap_ok(t.lost == 0, "written records stay: %ld files lost one", t.lost);
  tap_ok(t.spoiled == 0, "a failed restart leaves the state: %ld changed it", t.spoiled);
  tap_ok(t.left == 0, "no unfinished file is left: %ld are", t.left);
}

/* Of how many calls one fails: each one, but under the sanitizers, which are slow, and over an
 * older file, where only the first calls differ, some of them. */
#ifdef CT_SHORT_LOOPS
enum { EVERY = 5, EVERY_OLD = 23 };
#else
enum { EVERY = 1, EVERY_OLD = 7 };
#endif

int main(void)
{
  char folder[] = "/tmp/libcontact_faults_XXXXXX";
  rig r;
  if (mkdtemp(folder) == NULL || ct_set_allocator(&COUNTING, NULL) != CT_OK) return 1;
  rig_open(&r, folder);
  int whole = getenv("TAP_LONG") != NULL;
  each_call_fails(&r, 0, whole ? 1 : EVERY);
  each_call_fails(&r, 1, whole ? 1 : EVERY_OLD);
  remove(r.path);
  remove(r.part);
  rmdir(folder);
  rig_close(&r);
  return tap_done();
}
