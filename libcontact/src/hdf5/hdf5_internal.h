#ifndef CT_SRC_HDF5_INTERNAL_H
#define CT_SRC_HDF5_INTERNAL_H

#include "../base/error.h"

#include <libcontact/effect.h>
#include <libcontact/output.h>

#include <hdf5.h>
#include <stddef.h>
#if H5_VERSION_GE(1, 13, 0) && !defined CT_HDF5_LOADED
#include <H5FDdevelop.h>
#endif

#if !H5_VERSION_GE(1, 10, 2)
#error "libcontact-hdf5 needs HDF5 1.10.2 or newer (H5Fset_libver_bounds)"
#endif

/* Shared by the source files of libcontact-hdf5. */

/* A task on one file. Its first failure stays in `status` and `error`, and functions that get the
 * task afterwards do nothing, so that a sequence of them needs no checks. */
typedef struct ct_task {
  const char *path;
  ct_error *error;
  ct_status status;
  hid_t file;
} ct_task;

/* -- Types of values and of table rows -- */

typedef enum ct_kind {
  CT_REAL,
  CT_INT32,
  CT_INT64,
  CT_WORD,
  CT_VECTOR,
  CT_TENSOR,
  CT_NAME
} ct_kind;

/* Bytes of a CT_NAME, with at least one zero at its end. */
enum { CT_NAME_SIZE = 64 };

/* A member of a struct that is a row of a table. */
typedef struct ct_field {
  const char *name;
  size_t offset, size;
  ct_kind kind;
  /* Name in a message if two problems differ; null: it is not compared. */
  const char *label;
} ct_field;

#define CT_FIELD(row, member, kind, label) \
  {#member, offsetof(row, member), sizeof(((row *)0)->member), kind, label}

/* The struct; behind its fields there is one without a name. */
typedef struct ct_row_type {
  size_t size;
  ct_field field[14];
} ct_row_type;

/* -- What an output holds -- */

/* Compute `count` rows of a field from `first` on, into the piece of the output's record. */
typedef ct_status ct_fill(const ct_output *output, const ct_problem *problem, ct_state *state,
                          int64_t first, int64_t count, ct_error *error);

/* A dataset that grows by `rows` rows of `width` values per step (width 0: the dataset has no
 * second axis). */
typedef struct ct_column {
  hid_t set;
  /* Type of one value in memory. */
  hid_t type;
  int64_t rows, width, chunk_rows, row_bytes;
  /* Offset in ct_record of the rows of the current step, or of a pointer to them. */
  size_t source;
  int is_pointer;
  /* Null, or the function that computes the rows piece by piece, into the memory at that pointer.
   */
  ct_fill *fill;
} ct_column;

enum { CT_COLUMN_LIMIT = 48 };

/* Data of one step, gathered before the file is written. */
typedef struct ct_record {
  int64_t zero, one;
  /* First rows of the step in the point, cell and step tables, and the number of the step. */
  int64_t point_row, cell_row, step_row, step;
  ct_energy energy;
  /* Sums over the bodies. */
  double momentum[3], angular_momentum[3];
  /* Fields; null if they are not requested. The displacement belongs to the state, and
   * `displacement_filtered` is `smooth` of the output; velocity and stresses share memory for one
   * piece. */
  const double *displacement, *velocity, *stress, *displacement_filtered, *stress_filtered;
  double *contact_pressure, *velocity_filtered;
  double *piece;
  /* Of the row that is written. */
  const ct_momentum *bodies;
  const ct_effect_energy *effects;
  double *addends;
} ct_record;

/* The table of a probe, which grows by any number of rows per step. */
typedef struct ct_probe_table {
  ct_column column;
  int64_t written;
} ct_probe_table;

/* The arrays of a restart record, in the order of the file. */
enum { CT_PART_COUNT = 5 };

/* The file in the system. HDF5 knows it by the name, which is the first member (driver.c). */
typedef struct ct_disk {
  char name[16];
  hid_t driver;
  /* HDF5's own driver, with which ours reads and writes. */
  const H5FD_class_t *real;
  /* Handles of HDF5 and of our lock; -1 without a file. */
  int descriptor;
  /* The number of the first error of a write, or 0. */
  int error;
  /* Its name, and its temporary name until the first step is written. */
  char *path, *part;
  int renamed;
} ct_disk;

struct ct_output {
  ct_disk disk;
  /* A write has failed within a step: nothing more is written. */
  int broken;
  hid_t file, step_count;
  int64_t node_count, cell_count;
  int32_t body_count, effect_count, column_count;
  ct_column column[CT_COLUMN_LIMIT];
  int64_t part_count[CT_PART_COUNT];
  ct_record now;
  ct_filter *filter; /* null without one; `smooth` is the displacement that it computes */
  double *smooth;
  ct_ledger own; /* the row of a state that was passed without one */
  int64_t row;
  /* Null without probes. */
  const ct_probes *probes;
  ct_probe_table *probe;
  int32_t probe_count;
};

/* -- handle.c: HDF5 calls with their errors told; `path` is that of an object in the file -- */

/* The task has failed: "path: <sentence>", with the end of a path that is too long for a message.
 */
void ct_task_fail(ct_task *task, ct_status status, ct_place where, const char *format, ...);
/* "path: can't <what>: <reason>", with the reason from HDF5's error stack; call it before any other
 * call of HDF5, which would clear the stack. */
void ct_hdf5_fail(ct_task *task, const char *what);
/* Check that the loaded library is the one of compilation (HDF5 itself would end the process), or
 * that there is one. */
ct_status ct_hdf5_check_version(ct_error *error);
/* Options for opening files. */
hid_t ct_hdf5_access(void);
/* A new type, which the caller closes; negative on failure. */
hid_t ct_hdf5_type(ct_kind kind);
hid_t ct_hdf5_row_type(const ct_row_type *row);
void ct_hdf5_create_group(ct_task *task, const char *path);
/* Write a dataset of fixed size, shape (dims[0], ... dims[rank - 1]); integers are passed as
 * int64_t. A missing dataset is created with its space in the file allocated at once. Null data: it
 * is only created. */
void ct_hdf5_write_array(ct_task *task, const char *path, hid_t type, int rank, const hsize_t *dims,
                         const void *data);
void ct_hdf5_write_text(ct_task *task, const char *path, const char *text);
/* An attribute of a group with `count` values, or one value without an axis if `count` is 0; open.
 * Numbers are passed as doubles. */
hid_t ct_hdf5_write_attribute(ct_task *task, const char *path, const char *name, hid_t type,
                              hsize_t count, const void *data);
/* The same for a text in plain ASCII. */
void ct_hdf5_write_label(ct_task *task, const char *path, const char *name, const char *text);
/* Read an array; refused if the dataset has another shape. */
void ct_hdf5_read_array(ct_task *task, const char *path, hid_t type, int rank, const hsize_t *dims,
                        void *data);
/* Read a single number; 0 if there is no such attribute. */
double ct_hdf5_read_number(ct_task *task, const char *path, const char *name);
/* A dataset for the column; fields have one chunk a step, tables one for many steps. */
void ct_hdf5_create_column(ct_task *task, const char *path, int is_field, ct_column *column);
/* Set the number of rows of a dataset. */
void ct_hdf5_extend(ct_task *task, const ct_column *column, int64_t rows);
/* Write some rows, from `first` on. */
void ct_hdf5_write_rows(ct_task *task, const ct_column *column, int64_t first, int64_t rows,
                        const void *source);

/* -- load.c: HDF5 of the host -- */

/* The address of a name in the HDF5 that the host has loaded, or null. */
typedef void *ct_hdf5_find(const char *name);
/* Without HDF5 all calls refuse until this has found HDF5 1.14 or newer; with it there is nothing
 * to do. Returns whether there is an HDF5. For the Python package, which has no header of it. */
int ct_hdf5_load(ct_hdf5_find *find);

/* -- disk.c: what HDF5 has no call for, and one writer for a file -- */

/* Resolve symbolic links, refuse other than ordinary files, and set the two names of the file. */
void ct_disk_names(ct_task *task, ct_disk *disk, const char *path);
/* Create and lock the file with its temporary name, in place of one that no run writes any more. */
hid_t ct_disk_create(ct_task *task, ct_disk *disk, hid_t how, hid_t access);
/* Allocate `bytes` bytes beyond the end of the file, so that a full disk is detected before
 * anything is written. */
void ct_disk_reserve(ct_task *task, const ct_disk *disk, int64_t bytes);
/* Free allocated bytes that were not used. */
void ct_disk_trim(const ct_disk *disk, hid_t file);
/* Flush HDF5; reports a write that has failed since the file was created. */
void ct_disk_flush(ct_task *task, const ct_disk *disk, const char *what);
/* ``CT_ERROR_FILE`` with the system's reason, unless `number` is 0. */
void ct_disk_check(ct_task *task, const char *what, int number);
/* Give the file its final name, unless it has it. */
void ct_disk_rename(ct_task *task, ct_disk *disk);
void ct_disk_unlock(int descriptor);

/* -- driver.c: HDF5's own way to the disk, on which writes never fail -- */

/* Open files with `access` through `disk`, which must live until they are closed and its driver is
 * released (H5FDunregister). Returns whether that succeeded. */
int ct_driver_use(ct_disk *disk, hid_t access);

/* -- layout.c: the file without its steps -- */

/* The rows of the current step. */
const void *ct_record_at(const ct_record *now, const ct_column *column);
void ct_layout_create(ct_task *task, ct_output *output, const ct_problem *problem,
                      const ct_output_options *options);

/* -- probe.c: histories of probes -- */

void ct_probe_create_tables(ct_task *task, ct_output *output);
/* Largest number of bytes by which the rows up to a time extend the file. */
int64_t ct_probe_bytes(const ct_output *output, double time);
/* Append the rows up to a time. */
void ct_probe_write(ct_task *task, ct_output *output, double time);

/* -- identity.c: what a file says about its problem -- */

void ct_identity_write(ct_task *task, const ct_problem *problem);
/* ``CT_ERROR_FILE`` that names the first difference except in the step, which is returned; `points`
 * is memory for the file's coordinates. */
double ct_identity_compare(ct_task *task, const ct_problem *problem, double *points);

/* -- restart.c -- */

/* Bytes of the two records. */
int64_t ct_restart_bytes(const ct_state *state);
/* Allocate the two records, with the size of this state. */
void ct_restart_create_slots(ct_task *task, ct_output *output, const ct_state *state);
/* Check that the state has the sizes of the records. */
int ct_restart_fits(const ct_output *output, const ct_state *state);
void ct_restart_write(ct_task *task, int64_t row, const ct_state *state);

#endif
