/* Calls of libc and HDF5 that fail on request: each is counted, and the call number `fail_at` fails
 * without being made. What closes or releases is made, and then reports a failure. To be included
 * between the headers of the system and the sources whose calls shall fail. The names of all calls
 * stand here; tests/python/test_output.py compares them with those of the sources. */
#ifndef FAULTS_H
#define FAULTS_H

#include <errno.h>
#include <stddef.h>
#include <stdlib.h>

static struct {
  long calls;         /* so far */
  long fail_at;       /* the number of the call that fails; 0: none */
  const char *failed; /* its name, or null */
  long blocks;        /* memory that was not freed */
  long handles;       /* types, spaces, lists and drivers of HDF5 that were not closed */
} faults;

static int fails(const char *name)
{
  if (++faults.calls != faults.fail_at) return 0;
  faults.failed = name;
  errno = EIO;
  return 1;
}

/* A release that has happened. */
static int released(const char *name, int result) { return fails(name) ? -1 : result; }

/* A handle that a file does not close with itself. */
static hid_t made(hid_t handle)
{
  faults.handles += handle >= 0;
  return handle;
}

static int closed(const char *name, int result)
{
  faults.handles -= result >= 0;
  return released(name, result);
}

static void *held(void *block)
{
  faults.blocks += block != NULL;
  return block;
}

static void drop(void *block)
{
  faults.blocks -= block != NULL;
  free(block);
}

/* The three calls of HDF5's own driver that ours forwards, in a copy of its class. */
static const H5FD_class_t *own_class;
static H5FD_class_t faulty_class;

static herr_t faulty_write(H5FD_t *file, H5FD_mem_t type, hid_t transfer, haddr_t address,
                           size_t size, const void *bytes)
{
  return fails("write") ? -1 : own_class->write(file, type, transfer, address, size, bytes);
}

static herr_t faulty_truncate(H5FD_t *file, hid_t transfer, hbool_t closing)
{
  return fails("truncate") ? -1 : own_class->truncate(file, transfer, closing);
}

static herr_t faulty_close(H5FD_t *file) { return released("close", own_class->close(file)); }

static H5FD_t *show_driver(H5FD_t *file)
{
  if (file == NULL) return NULL;
  own_class = file->cls;
  faulty_class = *own_class;
  faulty_class.write = faulty_write;
  faulty_class.truncate = faulty_truncate;
  faulty_class.close = faulty_close;
  file->cls = &faulty_class;
  return file;
}

static herr_t hide_driver(H5FD_t *file)
{
  file->cls = own_class;
  return H5FDclose(file);
}

/* -- libc -- */
#define malloc(n) held(fails("malloc") ? NULL : malloc(n))
#define calloc(n, size) held(fails("calloc") ? NULL : calloc(n, size))
#define strdup(text) held(fails("strdup") ? NULL : strdup(text))
#define realpath(path, into) held(fails("realpath") ? NULL : realpath(path, into))
#define free(block) drop(block)
#define open(...) (fails("open") ? -1 : open(__VA_ARGS__))
#define fcntl(...) (fails("fcntl") ? -1 : fcntl(__VA_ARGS__))
#define close(file) released("close", close(file))
#define stat(...) (fails("stat") ? -1 : stat(__VA_ARGS__))
#define lstat(...) (fails("lstat") ? -1 : lstat(__VA_ARGS__))
#define fstat(...) (fails("fstat") ? -1 : fstat(__VA_ARGS__))
#define ftruncate(...) (fails("ftruncate") ? -1 : ftruncate(__VA_ARGS__))
#define posix_fallocate(...) (fails("posix_fallocate") ? ENOSPC : posix_fallocate(__VA_ARGS__))
#define rename(...) (fails("rename") ? -1 : rename(__VA_ARGS__))
#define remove(...) (fails("remove") ? -1 : remove(__VA_ARGS__))
#define unlink(...) (fails("unlink") ? -1 : unlink(__VA_ARGS__))

/* -- HDF5: what releases -- */
#define H5Aclose(id) released("H5Aclose", H5Aclose(id))
#define H5Dclose(id) released("H5Dclose", H5Dclose(id))
#define H5FDclose(file) released("H5FDclose", hide_driver(file))
#define H5FDunregister(id) closed("H5FDunregister", H5FDunregister(id))
#define H5Fclose(id) released("H5Fclose", H5Fclose(id))
#define H5Gclose(id) released("H5Gclose", H5Gclose(id))
#define H5Pclose(id) closed("H5Pclose", H5Pclose(id))
#define H5Sclose(id) closed("H5Sclose", H5Sclose(id))
#define H5Tclose(id) closed("H5Tclose", H5Tclose(id))
#define H5free_memory(block) \
  released("H5free_memory", (faults.blocks -= (block) != NULL, H5free_memory(block)))

/* -- HDF5: the rest -- */
#define FAULT(name, ...) (fails(#name) ? -1 : name(__VA_ARGS__))
#define H5Acreate_by_name(...) FAULT(H5Acreate_by_name, __VA_ARGS__)
#define H5Aexists_by_name(...) FAULT(H5Aexists_by_name, __VA_ARGS__)
#define H5Aget_space(...) made(FAULT(H5Aget_space, __VA_ARGS__))
#define H5Aopen_by_name(...) FAULT(H5Aopen_by_name, __VA_ARGS__)
#define H5Aread(...) FAULT(H5Aread, __VA_ARGS__)
#define H5Awrite(...) FAULT(H5Awrite, __VA_ARGS__)
#define H5Dcreate2(...) FAULT(H5Dcreate2, __VA_ARGS__)
#define H5Dget_space(...) made(FAULT(H5Dget_space, __VA_ARGS__))
#define H5Dget_type(...) made(FAULT(H5Dget_type, __VA_ARGS__))
#define H5Dopen2(...) FAULT(H5Dopen2, __VA_ARGS__)
#define H5Dread(...) FAULT(H5Dread, __VA_ARGS__)
#define H5Dset_extent(...) FAULT(H5Dset_extent, __VA_ARGS__)
#define H5Dwrite(...) FAULT(H5Dwrite, __VA_ARGS__)
#define H5Ewalk2(...) FAULT(H5Ewalk2, __VA_ARGS__)
#define H5FDopen(...) show_driver(fails("H5FDopen") ? NULL : H5FDopen(__VA_ARGS__))
#define H5FDregister(...) made(FAULT(H5FDregister, __VA_ARGS__))
#define H5Fcreate(...) FAULT(H5Fcreate, __VA_ARGS__)
#define H5Fflush(...) FAULT(H5Fflush, __VA_ARGS__)
#define H5Fget_filesize(...) FAULT(H5Fget_filesize, __VA_ARGS__)
#define H5Fget_vfd_handle(...) FAULT(H5Fget_vfd_handle, __VA_ARGS__)
#define H5Fopen(...) FAULT(H5Fopen, __VA_ARGS__)
#define H5Fset_libver_bounds(...) FAULT(H5Fset_libver_bounds, __VA_ARGS__)
#define H5Gcreate2(...) FAULT(H5Gcreate2, __VA_ARGS__)
#define H5Lexists(...) FAULT(H5Lexists, __VA_ARGS__)
#define H5Pcreate(...) made(FAULT(H5Pcreate, __VA_ARGS__))
#define H5Pset_alloc_time(...) FAULT(H5Pset_alloc_time, __VA_ARGS__)
#define H5Pset_buffer(...) FAULT(H5Pset_buffer, __VA_ARGS__)
#define H5Pset_chunk(...) FAULT(H5Pset_chunk, __VA_ARGS__)
#define H5Pset_driver(...) FAULT(H5Pset_driver, __VA_ARGS__)
#define H5Pset_fapl_sec2(...) FAULT(H5Pset_fapl_sec2, __VA_ARGS__)
#define H5Pset_fclose_degree(...) FAULT(H5Pset_fclose_degree, __VA_ARGS__)
#define H5Pset_file_locking(...) FAULT(H5Pset_file_locking, __VA_ARGS__)
#define H5Pset_file_space_page_size(...) FAULT(H5Pset_file_space_page_size, __VA_ARGS__)
#define H5Pset_file_space_strategy(...) FAULT(H5Pset_file_space_strategy, __VA_ARGS__)
#define H5Pset_fill_time(...) FAULT(H5Pset_fill_time, __VA_ARGS__)
#define H5Pset_libver_bounds(...) FAULT(H5Pset_libver_bounds, __VA_ARGS__)
#define H5Pset_obj_track_times(...) FAULT(H5Pset_obj_track_times, __VA_ARGS__)
#define H5Screate(...) made(FAULT(H5Screate, __VA_ARGS__))
#define H5Screate_simple(...) made(FAULT(H5Screate_simple, __VA_ARGS__))
#define H5Sget_simple_extent_dims(...) FAULT(H5Sget_simple_extent_dims, __VA_ARGS__)
#define H5Sget_simple_extent_npoints(...) FAULT(H5Sget_simple_extent_npoints, __VA_ARGS__)
#define H5Sselect_hyperslab(...) FAULT(H5Sselect_hyperslab, __VA_ARGS__)
#define H5Tarray_create2(...) made(FAULT(H5Tarray_create2, __VA_ARGS__))
#define H5Tcopy(...) made(FAULT(H5Tcopy, __VA_ARGS__))
#define H5Tcreate(...) made(FAULT(H5Tcreate, __VA_ARGS__))
#define H5Tget_class(...) (fails("H5Tget_class") ? H5T_NO_CLASS : H5Tget_class(__VA_ARGS__))
#define H5Tget_member_name(...) \
  held(fails("H5Tget_member_name") ? NULL : H5Tget_member_name(__VA_ARGS__))
#define H5Tget_nmembers(...) FAULT(H5Tget_nmembers, __VA_ARGS__)
#define H5Tget_size(...) (fails("H5Tget_size") ? 0 : H5Tget_size(__VA_ARGS__))
#define H5Tinsert(...) FAULT(H5Tinsert, __VA_ARGS__)
#define H5Tpack(...) FAULT(H5Tpack, __VA_ARGS__)
#define H5Tset_cset(...) FAULT(H5Tset_cset, __VA_ARGS__)
#define H5Tset_size(...) FAULT(H5Tset_size, __VA_ARGS__)
#define H5Tset_strpad(...) FAULT(H5Tset_strpad, __VA_ARGS__)
#define H5get_libversion(...) FAULT(H5get_libversion, __VA_ARGS__)

#endif
