#ifndef CT_SRC_HDF5_INTERNAL_H
#define CT_SRC_HDF5_INTERNAL_H

#include "../base/error.h"

#include <libcontact/output.h>

#include <hdf5.h>

#if !H5_VERSION_GE(1, 10, 2)
#error "libcontact-hdf5 needs HDF5 1.10.2 or newer (H5Fset_libver_bounds)"
#endif

/* What the source files of libcontact-hdf5 share. Functions that return ct_status fill `error` with
 * the path and the reason. */

/* A dataset that grows by `rows` rows of `width` values a step (width 0: the dataset has no second
 * axis). */
typedef struct ct_column {
  hid_t set;
  /* Type of one value in memory; owned by the output, or one of HDF5's own. */
  hid_t type;
  int64_t rows, width, chunk_rows;
  size_t value_size;
  /* A field on the points or cells; if not, a table with a few rows a step. */
  int is_field;
  /* Where the rows of the current step stand. */
  const void *source;
} ct_column;

enum { CT_COLUMN_LIMIT = 48 };

/* One row of /libcontact/effect. */
typedef struct ct_effect_row {
  double work;
  double energy;
} ct_effect_row;

/* What one step writes, gathered before the file is touched. */
typedef struct ct_record {
  int64_t zero, one;
  /* First rows of the step in the point, cell and step tables, and the number of the step. */
  int64_t point_row, cell_row, step_row, step;
  ct_energy energy;
  /* Sums over the bodies. */
  double momentum[3], angular_momentum[3];
  double *velocity;
  double *stress;
  ct_momentum *bodies;
  double *addends;
  ct_effect_row *effects;
} ct_record;

/* Says that a restart record is whole: its number in the file, its place in the run, and the sums
 * of :eq:`restart-seal`. */
typedef struct ct_seal {
  uint64_t sequence;
  int64_t step;
  int64_t row;
  double time;
  double kinetic_start;
  uint64_t sum;
  uint64_t weighted;
} ct_seal;

/* The arrays of a restart record, in the order of the file. */
enum { CT_PART_COUNT = 5 };
typedef struct ct_part {
  const char *name;
  double *values;
  int64_t count;
} ct_part;

/* The file as the system knows it. */
typedef struct ct_disk {
  /* The file of an output with its lock, from before HDF5 opens it until after it has closed it; -1
   * without one. */
  int locked;
  /* What HDF5 has open; -1 when it is closed. */
  int descriptor;
  /* The number of the first error that a write has met, 0 when all is well. */
  int error;
} ct_disk;

struct ct_output {
  char *path;
  /* The name until the first step is written. */
  char *part_path;
  int made, renamed;
  /* A write has failed in the middle of a step: nothing more is written. */
  int broken;
  ct_disk disk;
  hid_t driver, file, step_count, energy_type, momentum_type, effect_type, seal_type;
  int64_t node_count, cell_count;
  int32_t body_count, effect_count;
  int32_t column_count, displacement_column;
  ct_column column[CT_COLUMN_LIMIT];
  /* The two restart records: the arrays in the order of ct_part, then the seal. */
  hid_t slot[2][CT_PART_COUNT + 1];
  int64_t part_count[CT_PART_COUNT];
  ct_record now;
  int64_t row;
};

/* -- handle.c: HDF5 calls with their errors told -- */

/* "path: can't <what>: <reason>", the reason from HDF5's error stack; call it before any other HDF5
 * call clears that. */
ct_status ct_hdf5_fail(ct_error *error, const char *path, const char *what);
/* The library that was loaded is the one that was compiled against (HDF5 itself would end the
 * process). */
ct_status ct_hdf5_check_version(ct_error *error);
ct_status ct_hdf5_create_group(hid_t parent, const char *name, const char *path, hid_t *group,
                               ct_error *error);
/* A dataset of fixed size, shape (dims[0], ... dims[rank - 1]), open; its space in the file is
 * there at once. */
ct_status ct_hdf5_create_array(hid_t parent, const char *name, hid_t type, int rank,
                               const hsize_t *dims, const char *path, hid_t *set, ct_error *error);
/* The same with its data, closed. */
ct_status ct_hdf5_write_array(hid_t parent, const char *name, hid_t type, int rank,
                              const hsize_t *dims, const void *data, const char *path,
                              ct_error *error);
ct_status ct_hdf5_write_text(hid_t parent, const char *name, const char *text, const char *path,
                             ct_error *error);
/* An attribute with `count` values, or one value without an axis when `count` is 0. `attribute` may
 * be null: then it is closed. */
ct_status ct_hdf5_write_attribute(hid_t parent, const char *name, hid_t type, hsize_t count,
                                  const void *data, const char *path, hid_t *attribute,
                                  ct_error *error);
/* The same as a text of plain ASCII. */
ct_status ct_hdf5_write_label(hid_t parent, const char *name, const char *text, const char *path,
                              ct_error *error);
/* Refuses when the dataset has another shape. */
ct_status ct_hdf5_read_array(hid_t parent, const char *name, hid_t type, int rank,
                             const hsize_t *dims, void *data, const char *path, ct_error *error);
ct_status ct_hdf5_read_attribute(hid_t parent, const char *name, hid_t type, void *data,
                                 const char *path, ct_error *error);
/* Number of rows of a dataset with one axis, -1 if there is none. */
int64_t ct_hdf5_row_count(hid_t parent, const char *name);
ct_status ct_hdf5_create_column(hid_t parent, const char *name, const char *path, ct_column *column,
                                ct_error *error);
/* Append the rows of one step at `row`. */
ct_status ct_hdf5_write_column(const ct_column *column, int64_t row, const char *path,
                               ct_error *error);
hid_t ct_hdf5_energy_type(void);
hid_t ct_hdf5_momentum_type(void);
hid_t ct_hdf5_effect_type(void);

/* -- disk.c: what HDF5 has no call for -- */

/* Resolve symbolic links, refuse what is no ordinary file, and give the two names that the output
 * uses. */
ct_status ct_disk_names(const char *path, char **target, char **part, ct_error *error);
/* Refuse what can't be read, with the system's reason. */
ct_status ct_disk_check_readable(const char *path, ct_error *error);
/* Make the file `part`, lock it, and see whether the disk has room for `bytes` bytes. */
ct_status ct_disk_open(ct_disk *disk, const char *part, int64_t bytes, const char *path,
                       ct_error *error);
/* Ask the system for `bytes` bytes beyond the end of the file, so that a full disk is met before
 * anything is written. */
ct_status ct_disk_reserve(const ct_disk *disk, hid_t file, int64_t bytes, const char *path,
                          ct_error *error);
/* Give back what was reserved and not used. */
void ct_disk_trim(const ct_disk *disk, hid_t file);
/* ``CT_ERROR_FILE`` with the system's reason once a write has failed. */
ct_status ct_disk_check(const ct_disk *disk, const char *path, const char *what, ct_error *error);
ct_status ct_disk_rename(const char *from, const char *to, ct_error *error);
void ct_disk_remove(const char *path);
/* A path, or the end of one that is too long for a message, from the beginning of a folder on. */
const char *ct_disk_short(const char *path);

/* -- lock.c: one writer for a file -- */

/* Make the file `part` anew and lock it, in place of one that nobody writes any more. 0, EAGAIN
 * when somebody writes it, or the number of the system's error. */
int ct_lock_create(const char *part, int *descriptor);
/* Whether nobody writes a file that may be there. */
int ct_lock_is_free(const char *path);
void ct_lock_release(int descriptor);

/* -- driver.c: a way for HDF5 to the disk on which writes never fail -- */

hid_t ct_driver_register(void);
/* A file that is opened with `access` goes through the driver, where it is the locked one of
 * `disk`, whatever its name; `disk` must live until it is closed. */
herr_t ct_driver_use(hid_t access, hid_t driver, ct_disk *disk);

/* -- layout.c: the file without its steps -- */

hid_t ct_layout_open_access(void);
ct_status ct_layout_create(ct_output *output, const ct_problem *problem,
                           const ct_output_options *options, ct_error *error);
/* Bytes that the fixed part of the file needs. */
int64_t ct_layout_bytes(const ct_output *output, const ct_problem *problem,
                        const ct_output_options *options);

/* -- identity.c: what a file says about its problem -- */

enum { CT_LAYOUT = 1 };
ct_status ct_identity_write_integrator(const ct_integrator *integrator, hid_t group,
                                       const char *path, ct_error *error);
ct_status ct_identity_write(const ct_output *output, const ct_problem *problem, hid_t group,
                            ct_error *error);
/* ``CT_ERROR_FILE`` that names the first difference. `group` is /libcontact. */
ct_status ct_identity_compare(hid_t group, const ct_problem *problem, const char *path,
                              ct_error *error);
ct_status ct_identity_compare_points(hid_t file, const ct_problem *problem, const char *path,
                                     ct_error *error);

/* -- restart.c -- */

/* Bytes of the two records. */
int64_t ct_restart_bytes(const ct_state *state);
/* Make room for the two records in the group /libcontact. */
ct_status ct_restart_create_slots(ct_output *output, const ct_state *state, ct_error *error);
/* The state has the sizes that the records were made for. */
int ct_restart_fits(const ct_output *output, const ct_state *state);
ct_status ct_restart_write(const ct_output *output, const ct_state *state, ct_error *error);

#endif
