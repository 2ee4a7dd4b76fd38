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

ct_status ct_hdf5_fail(ct_error *error, const char *path, const char *what)
{
  char reason[LONGEST_REASON] = "HDF5 gives no reason";
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_reason, reason);
  return ct_fail(error, CT_ERROR_FILE, CT_NOWHERE, "%s: can't %s: %s", ct_disk_short(path), what,
                 reason);
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

/* -- Groups, arrays, attributes -- */

ct_status ct_hdf5_create_group(hid_t parent, const char *name, const char *path, hid_t *group,
                               ct_error *error)
{
  hid_t how = H5Pcreate(H5P_GROUP_CREATE);
  *group = -1;
  if (how >= 0 && H5Pset_obj_track_times(how, 0) >= 0)
    *group = H5Gcreate2(parent, name, H5P_DEFAULT, how, H5P_DEFAULT);
  ct_status status = *group < 0 ? ct_hdf5_fail(error, path, "make a group") : CT_OK;
  if (how >= 0) H5Pclose(how);
  return status;
}

ct_status ct_hdf5_create_array(hid_t parent, const char *name, hid_t type, int rank,
                               const hsize_t *dims, const char *path, hid_t *set, ct_error *error)
{
  hid_t space = rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, dims, NULL),
        how = H5Pcreate(H5P_DATASET_CREATE);
  int ready = space >= 0 && how >= 0 && H5Pset_obj_track_times(how, 0) >= 0 &&
              H5Pset_alloc_time(how, H5D_ALLOC_TIME_EARLY) >= 0;
  *set = ready ? H5Dcreate2(parent, name, type, space, H5P_DEFAULT, how, H5P_DEFAULT) : -1;
  ct_status status = *set < 0 ? ct_hdf5_fail(error, path, "make a dataset") : CT_OK;
  if (how >= 0) H5Pclose(how);
  if (space >= 0) H5Sclose(space);
  return status;
}

ct_status ct_hdf5_write_array(hid_t parent, const char *name, hid_t type, int rank,
                              const hsize_t *dims, const void *data, const char *path,
                              ct_error *error)
{
  hid_t set;
  ct_status status = ct_hdf5_create_array(parent, name, type, rank, dims, path, &set, error);
  if (status == CT_OK && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0)
    status = ct_hdf5_fail(error, path, "write an array");
  if (set >= 0 && H5Dclose(set) < 0 && status == CT_OK)
    status = ct_hdf5_fail(error, path, "write an array");
  return status;
}

/* A string type that holds `text` and its zero byte. */
static hid_t text_type(const char *text)
{
  hid_t type = H5Tcopy(H5T_C_S1);
  if (type >= 0 &&
      (H5Tset_size(type, strlen(text) + 1) < 0 || H5Tset_cset(type, H5T_CSET_UTF8) < 0)) {
    H5Tclose(type);
    return -1;
  }
  return type;
}

ct_status ct_hdf5_write_text(hid_t parent, const char *name, const char *text, const char *path,
                             ct_error *error)
{
  hid_t type = text_type(text);
  if (type < 0) return ct_hdf5_fail(error, path, "write a text");
  ct_status status = ct_hdf5_write_array(parent, name, type, 0, NULL, text, path, error);
  H5Tclose(type);
  return status;
}

ct_status ct_hdf5_write_attribute(hid_t parent, const char *name, hid_t type, hsize_t count,
                                  const void *data, const char *path, hid_t *attribute,
                                  ct_error *error)
{
  ct_status status = CT_OK;
  hid_t made = -1, space = count == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, NULL);
  if (space >= 0) made = H5Acreate2(parent, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  if (made < 0 || H5Awrite(made, type, data) < 0)
    status = ct_hdf5_fail(error, path, "write an attribute");
  if (space >= 0) H5Sclose(space);
  if (attribute != NULL) *attribute = made;
  else if (made >= 0) H5Aclose(made);
  return status;
}

ct_status ct_hdf5_write_label(hid_t parent, const char *name, const char *text, const char *path,
                              ct_error *error)
{
  // -- VTK wants the plain form: ASCII, and exactly as long as the text
  hid_t type = H5Tcopy(H5T_C_S1);
  ct_status status = CT_OK;
  if (type < 0 || H5Tset_size(type, strlen(text)) < 0 || H5Tset_strpad(type, H5T_STR_NULLPAD) < 0)
    status = ct_hdf5_fail(error, path, "write a label");
  else status = ct_hdf5_write_attribute(parent, name, type, 0, text, path, NULL, error);
  if (type >= 0) H5Tclose(type);
  return status;
}

static ct_status wrong_shape(const char *name, const char *path, ct_error *error)
{
  return ct_fail(error, CT_ERROR_FILE, CT_NOWHERE, "%s: '%s' has another shape than the problem",
                 ct_disk_short(path), name);
}

ct_status ct_hdf5_read_array(hid_t parent, const char *name, hid_t type, int rank,
                             const hsize_t *dims, void *data, const char *path, ct_error *error)
{
  ct_status status = CT_OK;
  hsize_t found[H5S_MAX_RANK];
  hid_t set = H5Dopen2(parent, name, H5P_DEFAULT), space = -1;
  if (set >= 0) space = H5Dget_space(set);
  if (space < 0) status = ct_hdf5_fail(error, path, "read an array");
  else if (H5Sget_simple_extent_ndims(space) != rank ||
           H5Sget_simple_extent_dims(space, found, NULL) < 0)
    status = wrong_shape(name, path, error);
  for (int a = 0; a < rank && status == CT_OK; a++)
    if (found[a] != dims[a]) status = wrong_shape(name, path, error);
  if (status == CT_OK && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0)
    status = ct_hdf5_fail(error, path, "read an array");
  if (space >= 0) H5Sclose(space);
  if (set >= 0) H5Dclose(set);
  return status;
}

ct_status ct_hdf5_read_attribute(hid_t parent, const char *name, hid_t type, void *data,
                                 const char *path, ct_error *error)
{
  ct_status status = CT_OK;
  hid_t attribute = H5Aopen(parent, name, H5P_DEFAULT), space = -1;
  if (attribute >= 0) space = H5Aget_space(attribute);
  if (space < 0) status = ct_hdf5_fail(error, path, "read an attribute");
  else if (H5Sget_simple_extent_npoints(space) != 1) status = wrong_shape(name, path, error);
  else if (H5Aread(attribute, type, data) < 0)
    status = ct_hdf5_fail(error, path, "read an attribute");
  if (space >= 0) H5Sclose(space);
  if (attribute >= 0) H5Aclose(attribute);
  return status;
}

int64_t ct_hdf5_row_count(hid_t parent, const char *name)
{
  hsize_t rows = 0;
  hid_t set = H5Dopen2(parent, name, H5P_DEFAULT), space = -1;
  if (set >= 0) space = H5Dget_space(set);
  int one_axis = space >= 0 && H5Sget_simple_extent_ndims(space) == 1 &&
                 H5Sget_simple_extent_dims(space, &rows, NULL) == 1;
  if (space >= 0) H5Sclose(space);
  if (set >= 0) H5Dclose(set);
  return one_axis ? (int64_t)rows : -1;
}

/* -- Datasets that grow -- */

enum { MANY_STEPS = 128, LARGEST_TABLE_CHUNK = 65536, LARGEST_CHUNK_ROWS = 1 << 20 };

/* Fields: one step a chunk. Tables: many steps a chunk. */
static int64_t chunk_rows(const ct_column *column, int64_t row_bytes)
{
  if (column->is_field)
    return column->rows < LARGEST_CHUNK_ROWS ? column->rows : LARGEST_CHUNK_ROWS;
  int64_t steps = LARGEST_TABLE_CHUNK / (column->rows * row_bytes);
  return column->rows * (steps < 1 ? 1 : steps < MANY_STEPS ? steps : MANY_STEPS);
}

ct_status ct_hdf5_create_column(hid_t parent, const char *name, const char *path, ct_column *column,
                                ct_error *error)
{
  ct_status status = CT_OK;
  int rank = column->width > 0 ? 2 : 1;
  hsize_t width = (hsize_t)column->width, none[2] = {0, width}, limit[2] = {H5S_UNLIMITED, width};
  column->value_size = H5Tget_size(column->type);
  column->chunk_rows =
      chunk_rows(column, (int64_t)(column->value_size * (rank == 2 ? (size_t)width : 1)));
  hsize_t chunk[2] = {(hsize_t)column->chunk_rows, width};
  hid_t space = H5Screate_simple(rank, none, limit), how = H5Pcreate(H5P_DATASET_CREATE),
        type = H5Tcopy(column->type);
  // -- Structs lose their padding in the file
  int packed = type >= 0 && (H5Tget_class(type) != H5T_COMPOUND || H5Tpack(type) >= 0);
  int ready = packed && space >= 0 && how >= 0 && H5Pset_chunk(how, rank, chunk) >= 0 &&
              H5Pset_obj_track_times(how, 0) >= 0;
  if (ready && column->chunk_rows == column->rows)
    ready = H5Pset_fill_time(how, H5D_FILL_TIME_NEVER) >= 0;
  if (ready) column->set = H5Dcreate2(parent, name, type, space, H5P_DEFAULT, how, H5P_DEFAULT);
  if (!ready || column->set < 0) status = ct_hdf5_fail(error, path, "make a dataset");
  if (type >= 0) H5Tclose(type);
  if (how >= 0) H5Pclose(how);
  if (space >= 0) H5Sclose(space);
  return status;
}

ct_status ct_hdf5_write_column(const ct_column *column, int64_t row, const char *path,
                               ct_error *error)
{
  ct_status status = CT_OK;
  int rank = column->width > 0 ? 2 : 1;
  hsize_t rows = (hsize_t)column->rows, width = (hsize_t)column->width;
  hsize_t size[2] = {((hsize_t)row + 1) * rows, width}, start[2] = {(hsize_t)row * rows, 0},
          count[2] = {rows, width};
  hid_t memory = -1, space = -1;
  if (H5Dset_extent(column->set, size) >= 0) space = H5Dget_space(column->set);
  if (space >= 0 && H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) >= 0)
    memory = H5Screate_simple(rank, count, NULL);
  if (memory < 0 ||
      H5Dwrite(column->set, column->type, memory, space, H5P_DEFAULT, column->source) < 0)
    status = ct_hdf5_fail(error, path, "write a step");
  if (memory >= 0) H5Sclose(memory);
  if (space >= 0) H5Sclose(space);
  return status;
}

/* -- Types of table rows -- */

typedef struct member {
  const char *name;
  size_t offset;
  hid_t type;
} member;

static hid_t compound(size_t size, const member *members, int count)
{
  hid_t type = H5Tcreate(H5T_COMPOUND, size);
  for (int i = 0; i < count && type >= 0; i++) {
    if (H5Tinsert(type, members[i].name, members[i].offset, members[i].type) >= 0) continue;
    H5Tclose(type);
    type = -1;
  }
  return type;
}

hid_t ct_hdf5_energy_type(void)
{
  hid_t real = H5T_NATIVE_DOUBLE;
  const member members[] = {{"time", HOFFSET(ct_energy, time), real},
                            {"kinetic", HOFFSET(ct_energy, kinetic), real},
                            {"strain", HOFFSET(ct_energy, strain), real},
                            {"contact", HOFFSET(ct_energy, contact), real},
                            {"external", HOFFSET(ct_energy, external), real},
                            {"total", HOFFSET(ct_energy, total), real},
                            {"balance", HOFFSET(ct_energy, balance), real}};
  return compound(sizeof(ct_energy), members, sizeof members / sizeof members[0]);
}

hid_t ct_hdf5_momentum_type(void)
{
  const hsize_t three = 3;
  hid_t vector = H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, &three);
  if (vector < 0) return -1;
  const member members[] = {{"time", HOFFSET(ct_momentum, time), H5T_NATIVE_DOUBLE},
                            {"body", HOFFSET(ct_momentum, body), H5T_NATIVE_INT32},
                            {"p", HOFFSET(ct_momentum, p), vector},
                            {"L", HOFFSET(ct_momentum, L), vector},
                            {"contact_impulse", HOFFSET(ct_momentum, contact_impulse), vector},
                            {"support_impulse", HOFFSET(ct_momentum, support_impulse), vector}};
  hid_t type = compound(sizeof(ct_momentum), members, sizeof members / sizeof members[0]);
  H5Tclose(vector);
  return type;
}

hid_t ct_hdf5_effect_type(void)
{
  const member members[] = {{"work", HOFFSET(ct_effect_row, work), H5T_NATIVE_DOUBLE},
                            {"energy", HOFFSET(ct_effect_row, energy), H5T_NATIVE_DOUBLE}};
  return compound(sizeof(ct_effect_row), members, sizeof members / sizeof members[0]);
}
