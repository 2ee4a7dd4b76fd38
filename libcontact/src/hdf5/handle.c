#include "hdf5_internal.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* -- Errors -- */

enum { LONGEST_REASON = 200, LONGEST_SENTENCE = 600, LONGEST_PATH = 400 };

void ct_task_fail(ct_task *task, ct_status status, ct_place where, const char *format, ...)
{
  char sentence[LONGEST_SENTENCE];
  va_list arguments;
  if (task->status != CT_OK) return;
  va_start(arguments, format);
  vsnprintf(sentence, sizeof sentence, format, arguments);
  va_end(arguments);
  size_t length = strlen(task->path), start = length > LONGEST_PATH ? length - LONGEST_PATH : 0;
  task->status = ct_fail(task->error, status, where, "%s: %s", task->path + start, sentence);
}

/* Keep the innermost text of the stack, or preferably one that quotes the system. */
static herr_t keep_reason(unsigned level, const H5E_error2_t *entry, void *data)
{
  char *reason = data;
  static const char QUOTE[] = "error message = '";
  if (entry->desc == NULL) return 0;
  const char *start = strstr(entry->desc, QUOTE);
  if (start != NULL) {
    start += sizeof QUOTE - 1;
    snprintf(reason, LONGEST_REASON, "%.*s", (int)strcspn(start, "'"), start);
    return 1;
  }
  if (level == 0) snprintf(reason, LONGEST_REASON, "%s", entry->desc);
  return 0;
}

void ct_hdf5_fail(ct_task *task, const char *what)
{
  char reason[LONGEST_REASON] = "HDF5 gives no reason";
  if (task->status != CT_OK) return;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_reason, reason);
  ct_task_fail(task, CT_ERROR_FILE, CT_NOWHERE, "can't %s: %s", what, reason);
}

ct_status ct_hdf5_check_version(ct_error *error)
{
#ifdef CT_HDF5_LOADED
  if (!ct_hdf5.is_loaded)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "libcontact was built without HDF5, so it can't write or read a results file");
#else
  unsigned major = 0, minor = 0, release = 0;
  if (H5get_libversion(&major, &minor, &release) < 0 || major != H5_VERS_MAJOR ||
      minor != H5_VERS_MINOR || release != H5_VERS_RELEASE)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "libcontact-hdf5 was compiled with HDF5 %d.%d.%d, but HDF5 %u.%u.%u is loaded",
                   H5_VERS_MAJOR, H5_VERS_MINOR, H5_VERS_RELEASE, major, minor, release);
#endif
  return CT_OK;
}

/* -- Types -- */

/* A failed creation returns a negative id, with which all later calls fail. A type or a list that
 * lacks one of its settings is closed and replaced by such an id: `failed` says whether it does. */
static hid_t type_or_none(hid_t type, int failed)
{
  if (!failed) return type;
  H5Tclose(type);
  return -1;
}

static hid_t list_or_none(hid_t list, int failed)
{
  if (!failed) return list;
  H5Pclose(list);
  return -1;
}

static hid_t text_type(size_t size)
{
  hid_t type = H5Tcopy(H5T_C_S1);
  return type_or_none(type, H5Tset_size(type, size) < 0 || H5Tset_cset(type, H5T_CSET_UTF8) < 0);
}

hid_t ct_hdf5_type(ct_kind kind)
{
  const hsize_t three = 3, six = 6;
  const hid_t number[] = {H5T_NATIVE_DOUBLE, H5T_NATIVE_INT32, H5T_NATIVE_INT64, H5T_NATIVE_UINT64};
  if (kind == CT_NAME) return text_type(CT_NAME_SIZE);
  if (kind == CT_VECTOR) return H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, &three);
  if (kind == CT_TENSOR) return H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, &six);
  return H5Tcopy(number[kind]);
}

hid_t ct_hdf5_row_type(const ct_row_type *row)
{
  hid_t type = H5Tcreate(H5T_COMPOUND, row->size);
  int failed = 0;
  for (const ct_field *f = row->field; f->name != NULL; f++) {
    hid_t value = ct_hdf5_type(f->kind);
    failed = H5Tinsert(type, f->name, f->offset, value) < 0 || failed;
    H5Tclose(value);
  }
  return type_or_none(type, failed);
}

/* -- Groups, arrays, attributes -- */

/* The files have the second superblock, and their growing datasets are of the extensible-array
 * kind: appending a step moves nothing that is already in the file, and no flag in it says that a
 * writer was there (docs/theory/output.rst, "Killed in mid-run"). */
hid_t ct_hdf5_access(void)
{
  hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  int failed = H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V110) < 0;
#if H5_VERSION_GE(1, 12, 1) || (H5_VERS_MINOR == 10 && H5_VERSION_GE(1, 10, 7))
  failed = H5Pset_file_locking(access, 0, 1) < 0 || failed;
#endif
  return list_or_none(access, failed);
}

void ct_hdf5_create_group(ct_task *task, const char *path)
{
  if (task->status != CT_OK) return;
  hid_t how = H5Pcreate(H5P_GROUP_CREATE);
  how = list_or_none(how, H5Pset_obj_track_times(how, 0) < 0);
  hid_t group = H5Gcreate2(task->file, path, H5P_DEFAULT, how, H5P_DEFAULT);
  if (group < 0) ct_hdf5_fail(task, "make a group");
  H5Gclose(group);
  H5Pclose(how);
}

/* The dataset; `space` and `how` are closed. */
static hid_t create_dataset(ct_task *task, const char *path, hid_t type, hid_t space, hid_t how)
{
  how = list_or_none(how, H5Pset_obj_track_times(how, 0) < 0);
  hid_t set = H5Dcreate2(task->file, path, type, space, H5P_DEFAULT, how, H5P_DEFAULT);
  if (set < 0) ct_hdf5_fail(task, "make a dataset");
  H5Pclose(how);
  H5Sclose(space);
  return set;
}

static H5T_class_t class_of(ct_task *task, hid_t type)
{
  H5T_class_t class = H5Tget_class(type);
  if (class == H5T_NO_CLASS) ct_hdf5_fail(task, "find a type");
  return class;
}

static hid_t create_space(int rank, const hsize_t *dims)
{
  return rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, dims, NULL);
}

void ct_hdf5_write_array(ct_task *task, const char *path, hid_t type, int rank, const hsize_t *dims,
                         const void *data)
{
  if (task->status != CT_OK) return;
  H5T_class_t class = class_of(task, type);
  hid_t memory = class == H5T_INTEGER ? H5T_NATIVE_INT64 : type,
        set = H5Dopen2(task->file, path, H5P_DEFAULT);
  if (set < 0) {
    hid_t how = H5Pcreate(H5P_DATASET_CREATE);
    how = list_or_none(how, H5Pset_alloc_time(how, H5D_ALLOC_TIME_EARLY) < 0);
    set = create_dataset(task, path, type, create_space(rank, dims), how);
  }
  if (data != NULL && H5Dwrite(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0)
    ct_hdf5_fail(task, "write an array");
  H5Dclose(set);
}

void ct_hdf5_write_text(ct_task *task, const char *path, const char *text)
{
  hid_t type = text_type(strlen(text) + 1);
  ct_hdf5_write_array(task, path, type, 0, NULL, text);
  H5Tclose(type);
}

hid_t ct_hdf5_write_attribute(ct_task *task, const char *path, const char *name, hid_t type,
                              hsize_t count, const void *data)
{
  if (task->status != CT_OK) return -1;
  hid_t memory = class_of(task, type) == H5T_STRING ? type : H5T_NATIVE_DOUBLE,
        space = create_space(count > 0, &count),
        attribute = H5Acreate_by_name(task->file, path, name, type, space, H5P_DEFAULT, H5P_DEFAULT,
                                      H5P_DEFAULT);
  if (attribute < 0 || H5Awrite(attribute, memory, data) < 0)
    ct_hdf5_fail(task, "write an attribute");
  H5Sclose(space);
  return attribute;
}

void ct_hdf5_write_label(ct_task *task, const char *path, const char *name, const char *text)
{
  // -- VTK wants the plain form: ASCII, and exactly as long as the text
  hid_t type = H5Tcopy(H5T_C_S1);
  type = type_or_none(type, H5Tset_size(type, strlen(text)) < 0 ||
                                H5Tset_strpad(type, H5T_STR_NULLPAD) < 0);
  ct_hdf5_write_attribute(task, path, name, type, 0, text);
  H5Tclose(type);
}

void ct_hdf5_read_array(ct_task *task, const char *path, hid_t type, int rank, const hsize_t *dims,
                        void *data)
{
  if (task->status != CT_OK) return;
  hsize_t found[H5S_MAX_RANK] = {0};
  hid_t set = H5Dopen2(task->file, path, H5P_DEFAULT), space = set < 0 ? -1 : H5Dget_space(set);
  int fits = space >= 0 && H5Sget_simple_extent_dims(space, found, NULL) == rank;
  for (int a = 0; a < rank; a++) fits = fits && found[a] == dims[a];
  if (space >= 0 && !fits)
    ct_task_fail(task, CT_ERROR_FILE, CT_NOWHERE,
                 "the file belongs to another problem: '%s' has %ld rows, the problem %ld", path,
                 (long)found[0], rank > 0 ? (long)dims[0] : 1);
  else if (space < 0 || H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0)
    ct_hdf5_fail(task, "read an array");
  H5Sclose(space);
  H5Dclose(set);
}

double ct_hdf5_read_number(ct_task *task, const char *path, const char *name)
{
  double value = 0;
  htri_t found = task->status == CT_OK ? H5Aexists_by_name(task->file, path, name, H5P_DEFAULT) : 0;
  if (found < 0) ct_hdf5_fail(task, "read an attribute");
  if (found <= 0) return 0;
  hid_t attribute = H5Aopen_by_name(task->file, path, name, H5P_DEFAULT, H5P_DEFAULT),
        space = attribute < 0 ? -1 : H5Aget_space(attribute);
  if (space < 0 || H5Sget_simple_extent_npoints(space) != 1 ||
      H5Aread(attribute, H5T_NATIVE_DOUBLE, &value) < 0)
    ct_hdf5_fail(task, "read an attribute");
  H5Sclose(space);
  H5Aclose(attribute);
  return value;
}

/* -- Datasets that grow -- */

enum { MANY_STEPS = 128, LARGEST_TABLE_CHUNK = 65536, LARGEST_CHUNK_ROWS = 1 << 20 };

/* Memory in which structs lose their padding, many rows of a table. HDF5 clears it at each write,
 * and has 1 MB by default. */
enum { CONVERTED_BYTES = 16384 };

/* Fields: one step per chunk. Tables: many steps per chunk. */
static int64_t chunk_rows(const ct_column *column, int is_field)
{
  if (is_field) return column->rows < LARGEST_CHUNK_ROWS ? column->rows : LARGEST_CHUNK_ROWS;
  int64_t steps = LARGEST_TABLE_CHUNK / (column->rows * column->row_bytes);
  return column->rows * (steps < 1 ? 1 : steps < MANY_STEPS ? steps : MANY_STEPS);
}

void ct_hdf5_create_column(ct_task *task, const char *path, int is_field, ct_column *column)
{
  if (task->status != CT_OK) return;
  int rank = column->width > 0 ? 2 : 1;
  hsize_t width = (hsize_t)column->width, none[2] = {0, width}, limit[2] = {H5S_UNLIMITED, width};
  column->row_bytes = (int64_t)H5Tget_size(column->type) * (rank == 2 ? column->width : 1);
  if (column->row_bytes == 0) {
    ct_hdf5_fail(task, "find a type");
    return;
  }
  column->chunk_rows = chunk_rows(column, is_field);
  hsize_t chunk[2] = {(hsize_t)column->chunk_rows, width};
  hid_t how = H5Pcreate(H5P_DATASET_CREATE), type = H5Tcopy(column->type);
  // -- Structs lose their padding in the file
  if (class_of(task, type) == H5T_COMPOUND) type = type_or_none(type, H5Tpack(type) < 0);
  // -- Rows are read only where they were written. HDF5 would fill a large chunk in memory first.
  how = list_or_none(how, H5Pset_chunk(how, rank, chunk) < 0 ||
                              (is_field && H5Pset_fill_time(how, H5D_FILL_TIME_NEVER) < 0));
  column->set = create_dataset(task, path, type, H5Screate_simple(rank, none, limit), how);
  H5Tclose(type);
}

void ct_hdf5_extend(ct_task *task, const ct_column *column, int64_t rows)
{
  hsize_t size[2] = {(hsize_t)rows, (hsize_t)column->width};
  if (task->status == CT_OK && H5Dset_extent(column->set, size) < 0)
    ct_hdf5_fail(task, "write a step");
}

void ct_hdf5_write_rows(ct_task *task, const ct_column *column, int64_t first, int64_t rows,
                        const void *source)
{
  if (task->status != CT_OK || rows == 0) return;
  int rank = column->width > 0 ? 2 : 1;
  const hsize_t start[2] = {(hsize_t)first, 0}, count[2] = {(hsize_t)rows, (hsize_t)column->width};
  hid_t memory = H5Screate_simple(rank, count, NULL), space = H5Dget_space(column->set),
        how = H5Pcreate(H5P_DATASET_XFER);
  how = list_or_none(how, H5Pset_buffer(how, CONVERTED_BYTES, NULL, NULL) < 0);
  if (H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) < 0 ||
      H5Dwrite(column->set, column->type, memory, space, how, source) < 0)
    ct_hdf5_fail(task, "write a step");
  H5Pclose(how);
  H5Sclose(space);
  H5Sclose(memory);
}
