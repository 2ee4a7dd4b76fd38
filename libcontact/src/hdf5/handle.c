#include "hdf5_internal.h"

#include <stdio.h>
#include <string.h>

/* -- Errors -- */

enum { LONGEST_REASON = 200 };

/* Keeps the innermost text of the stack, and better one that quotes the system. */
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
  task->status = ct_fail(task->error, CT_ERROR_FILE, CT_NOWHERE, "%s: can't %s: %s",
                         ct_disk_short(task->path), what, reason);
}

ct_status ct_hdf5_check_version(ct_error *error)
{
  unsigned major = 0, minor = 0, release = 0;
  if (H5get_libversion(&major, &minor, &release) < 0 || major != H5_VERS_MAJOR ||
      minor != H5_VERS_MINOR || release != H5_VERS_RELEASE)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "libcontact-hdf5 was compiled with HDF5 %d.%d.%d, but HDF5 %u.%u.%u is loaded",
                   H5_VERS_MAJOR, H5_VERS_MINOR, H5_VERS_RELEASE, major, minor, release);
  return CT_OK;
}

/* -- Types -- */

static hid_t text_type(size_t size)
{
  hid_t type = H5Tcopy(H5T_C_S1);
  return H5Tset_size(type, size) < 0 || H5Tset_cset(type, H5T_CSET_UTF8) < 0 ? -1 : type;
}

hid_t ct_hdf5_type(ct_kind kind)
{
  const hsize_t three = 3;
  switch (kind) {
  case CT_REAL:
    return H5Tcopy(H5T_NATIVE_DOUBLE);
  case CT_VECTOR:
    return H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, &three);
  case CT_INT32:
    return H5Tcopy(H5T_NATIVE_INT32);
  case CT_INT64:
    return H5Tcopy(H5T_NATIVE_INT64);
  case CT_WORD:
    return H5Tcopy(H5T_NATIVE_UINT64);
  case CT_NAME:
    return text_type(CT_NAME_SIZE);
  }
  return -1;
}

size_t ct_hdf5_size(ct_kind kind)
{
  return kind == CT_INT32 ? 4 : kind == CT_VECTOR ? 24 : kind == CT_NAME ? CT_NAME_SIZE : 8;
}

hid_t ct_hdf5_row_type(const ct_row_type *row)
{
  hid_t type = H5Tcreate(H5T_COMPOUND, row->size);
  int good = type >= 0;
  for (int i = 0; i < row->field_count; i++) {
    hid_t value = ct_hdf5_type(row->field[i].kind);
    good = good && H5Tinsert(type, row->field[i].name, row->field[i].offset, value) >= 0;
    H5Tclose(value);
  }
  if (good) return type;
  H5Tclose(type);
  return -1;
}

/* -- Groups, arrays, attributes -- */

hid_t ct_hdf5_create_group(ct_task *task, hid_t parent, const char *name)
{
  if (task->status != CT_OK) return -1;
  hid_t how = H5Pcreate(H5P_GROUP_CREATE), group = -1;
  if (H5Pset_obj_track_times(how, 0) >= 0)
    group = H5Gcreate2(parent, name, H5P_DEFAULT, how, H5P_DEFAULT);
  if (group < 0) ct_hdf5_fail(task, "make a group");
  H5Pclose(how);
  return group;
}

/* The dataset; `space` and `how` are closed. */
static hid_t create_dataset(ct_task *task, hid_t parent, const char *name, hid_t type, hid_t space,
                            hid_t how)
{
  hid_t set = -1;
  if (H5Pset_obj_track_times(how, 0) >= 0)
    set = H5Dcreate2(parent, name, type, space, H5P_DEFAULT, how, H5P_DEFAULT);
  if (set < 0) ct_hdf5_fail(task, "make a dataset");
  H5Pclose(how);
  H5Sclose(space);
  return set;
}

hid_t ct_hdf5_create_array(ct_task *task, hid_t parent, const char *name, hid_t type, int rank,
                           const hsize_t *dims)
{
  if (task->status != CT_OK) return -1;
  hid_t space = rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, dims, NULL),
        how = H5Pcreate(H5P_DATASET_CREATE);
  if (H5Pset_alloc_time(how, H5D_ALLOC_TIME_EARLY) < 0) ct_hdf5_fail(task, "make a dataset");
  return create_dataset(task, parent, name, type, space, how);
}

void ct_hdf5_write_array(ct_task *task, hid_t parent, const char *name, hid_t type, int rank,
                         const hsize_t *dims, const void *data)
{
  hid_t set = ct_hdf5_create_array(task, parent, name, type, rank, dims);
  if (task->status != CT_OK) return;
  if (H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0 || H5Dclose(set) < 0)
    ct_hdf5_fail(task, "write an array");
}

void ct_hdf5_write_text(ct_task *task, hid_t parent, const char *name, const char *text)
{
  hid_t type = text_type(strlen(text) + 1);
  ct_hdf5_write_array(task, parent, name, type, 0, NULL, text);
  H5Tclose(type);
}

hid_t ct_hdf5_write_attribute(ct_task *task, hid_t parent, const char *name, hid_t type,
                              hsize_t count, const void *data)
{
  if (task->status != CT_OK) return -1;
  hid_t space = count == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, NULL);
  hid_t attribute = H5Acreate2(parent, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  if (attribute < 0 || H5Awrite(attribute, type, data) < 0)
    ct_hdf5_fail(task, "write an attribute");
  H5Sclose(space);
  return attribute;
}

void ct_hdf5_write_label(ct_task *task, hid_t parent, const char *name, const char *text)
{
  // -- VTK wants the plain form: ASCII, and exactly as long as the text
  hid_t type = H5Tcopy(H5T_C_S1);
  if (H5Tset_size(type, strlen(text)) < 0 || H5Tset_strpad(type, H5T_STR_NULLPAD) < 0)
    ct_hdf5_fail(task, "write a label");
  ct_hdf5_write_attribute(task, parent, name, type, 0, text);
  H5Tclose(type);
}

static void wrong_shape(ct_task *task, const char *name)
{
  task->status =
      ct_fail(task->error, CT_ERROR_FILE, CT_NOWHERE, "%s: '%s' has another shape than the problem",
              ct_disk_short(task->path), name);
}

void ct_hdf5_read_array(ct_task *task, hid_t parent, const char *name, hid_t type, int rank,
                        const hsize_t *dims, void *data)
{
  if (task->status != CT_OK) return;
  hsize_t found[H5S_MAX_RANK];
  hid_t set = H5Dopen2(parent, name, H5P_DEFAULT), space = set < 0 ? -1 : H5Dget_space(set);
  int fits = space >= 0 && H5Sget_simple_extent_ndims(space) == rank &&
             H5Sget_simple_extent_dims(space, found, NULL) == rank;
  for (int a = 0; a < rank && fits; a++) fits = found[a] == dims[a];
  if (space < 0) ct_hdf5_fail(task, "read an array");
  else if (!fits) wrong_shape(task, name);
  else if (H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0)
    ct_hdf5_fail(task, "read an array");
  H5Sclose(space);
  H5Dclose(set);
}

void ct_hdf5_read_attribute(ct_task *task, hid_t parent, const char *name, hid_t type, void *data)
{
  if (task->status != CT_OK) return;
  hid_t attribute = H5Aopen(parent, name, H5P_DEFAULT),
        space = attribute < 0 ? -1 : H5Aget_space(attribute);
  if (space < 0) ct_hdf5_fail(task, "read an attribute");
  else if (H5Sget_simple_extent_npoints(space) != 1) wrong_shape(task, name);
  else if (H5Aread(attribute, type, data) < 0) ct_hdf5_fail(task, "read an attribute");
  H5Sclose(space);
  H5Aclose(attribute);
}

int64_t ct_hdf5_row_count(hid_t parent, const char *name)
{
  hsize_t rows = 0;
  hid_t set = H5Dopen2(parent, name, H5P_DEFAULT), space = set < 0 ? -1 : H5Dget_space(set);
  int one_axis =
      H5Sget_simple_extent_ndims(space) == 1 && H5Sget_simple_extent_dims(space, &rows, NULL) == 1;
  H5Sclose(space);
  H5Dclose(set);
  return one_axis ? (int64_t)rows : -1;
}

/* -- Datasets that grow -- */

enum { MANY_STEPS = 128, LARGEST_TABLE_CHUNK = 65536, LARGEST_CHUNK_ROWS = 1 << 20 };

/* Fields: one step a chunk. Tables: many steps a chunk. */
static int64_t chunk_rows(const ct_column *column, int is_field)
{
  if (is_field) return column->rows < LARGEST_CHUNK_ROWS ? column->rows : LARGEST_CHUNK_ROWS;
  int64_t steps = LARGEST_TABLE_CHUNK / (column->rows * column->row_bytes);
  return column->rows * (steps < 1 ? 1 : steps < MANY_STEPS ? steps : MANY_STEPS);
}

void ct_hdf5_create_column(ct_task *task, hid_t parent, const char *name, int is_field,
                           ct_column *column)
{
  if (task->status != CT_OK) return;
  int rank = column->width > 0 ? 2 : 1;
  hsize_t width = (hsize_t)column->width, none[2] = {0, width}, limit[2] = {H5S_UNLIMITED, width};
  column->row_bytes = (int64_t)H5Tget_size(column->type) * (rank == 2 ? column->width : 1);
  column->chunk_rows = chunk_rows(column, is_field);
  hsize_t chunk[2] = {(hsize_t)column->chunk_rows, width};
  hid_t space = H5Screate_simple(rank, none, limit), how = H5Pcreate(H5P_DATASET_CREATE),
        type = H5Tcopy(column->type);
  // -- Structs lose their padding in the file
  int ready = H5Tget_class(type) != H5T_COMPOUND || H5Tpack(type) >= 0;
  ready = ready && H5Pset_chunk(how, rank, chunk) >= 0;
  if (column->chunk_rows == column->rows)
    ready = ready && H5Pset_fill_time(how, H5D_FILL_TIME_NEVER) >= 0;
  if (!ready) ct_hdf5_fail(task, "make a dataset");
  column->set = create_dataset(task, parent, name, type, space, how);
  H5Tclose(type);
}

void ct_hdf5_write_column(ct_task *task, const ct_column *column, int64_t row, const void *source)
{
  if (task->status != CT_OK) return;
  int rank = column->width > 0 ? 2 : 1;
  hsize_t rows = (hsize_t)column->rows, width = (hsize_t)column->width;
  hsize_t size[2] = {((hsize_t)row + 1) * rows, width}, start[2] = {(hsize_t)row * rows, 0},
          count[2] = {rows, width};
  hid_t memory = H5Screate_simple(rank, count, NULL), space = -1;
  if (H5Dset_extent(column->set, size) >= 0) space = H5Dget_space(column->set);
  if (H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) < 0 ||
      H5Dwrite(column->set, column->type, memory, space, H5P_DEFAULT, source) < 0)
    ct_hdf5_fail(task, "write a step");
  H5Sclose(space);
  H5Sclose(memory);
}
