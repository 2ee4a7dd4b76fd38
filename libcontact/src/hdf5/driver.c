#define _XOPEN_SOURCE 700
#define _FILE_OFFSET_BITS 64

#include "hdf5_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#if H5_VERSION_GE(1, 13, 0)
#include <H5FDdevelop.h>
#endif

/*
 * A file driver for HDF5 whose writes never fail. HDF5 can't close a file any more once one of its
 * writes has failed: it keeps what it could not write, and crashes when the process ends (seen
 * with 1.10.8). So the first failure is kept in ct_disk, from then on nothing is written, and HDF5
 * is told that all is well. Whoever writes looks at ct_disk.error after each flush.
 */

typedef struct driver_file {
  H5FD_t base; /* HDF5's own part, which must come first */
  ct_disk *disk;
  int descriptor;
  haddr_t end_of_space; /* what HDF5 has given out */
  haddr_t end_of_file;  /* what the system has */
} driver_file;

/* What the access property list carries. */
typedef struct driver_info {
  ct_disk *disk;
} driver_info;

static H5FD_t *driver_open(const char *name, unsigned flags, hid_t access, haddr_t limit)
{
  const driver_info *info = H5Pget_driver_info(access);
  struct stat found;
  (void)name, (void)limit;
  if (info == NULL) return NULL;
  int descriptor = dup(info->disk->locked);
  if (descriptor >= 0 && (flags & H5F_ACC_TRUNC) && ftruncate(descriptor, 0) != 0 &&
      info->disk->error == 0)
    info->disk->error = errno;
  if (descriptor < 0 && info->disk->error == 0) info->disk->error = errno;
  driver_file *file = descriptor >= 0 ? calloc(1, sizeof *file) : NULL;
  if (file == NULL || fstat(descriptor, &found) != 0) {
    if (descriptor >= 0) close(descriptor);
    free(file);
    return NULL;
  }
  file->disk = info->disk;
  file->descriptor = info->disk->descriptor = descriptor;
  file->end_of_file = (haddr_t)found.st_size;
  return &file->base;
}

static herr_t driver_close(H5FD_t *base)
{
  driver_file *file = (driver_file *)base;
  if (close(file->descriptor) != 0 && file->disk->error == 0) file->disk->error = errno;
  file->disk->descriptor = -1;
  free(file);
  return 0;
}

static int driver_compare(const H5FD_t *a, const H5FD_t *b)
{
  struct stat one, two;
  if (fstat(((const driver_file *)a)->descriptor, &one) != 0 ||
      fstat(((const driver_file *)b)->descriptor, &two) != 0)
    return -1;
  if (one.st_dev != two.st_dev) return one.st_dev < two.st_dev ? -1 : 1;
  if (one.st_ino != two.st_ino) return one.st_ino < two.st_ino ? -1 : 1;
  return 0;
}

static herr_t driver_query(const H5FD_t *base, unsigned long *flags)
{
  (void)base;
  if (flags != NULL)
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
             H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

static haddr_t driver_get_eoa(const H5FD_t *base, H5FD_mem_t type)
{
  (void)type;
  return ((const driver_file *)base)->end_of_space;
}

static herr_t driver_set_eoa(H5FD_t *base, H5FD_mem_t type, haddr_t address)
{
  (void)type;
  ((driver_file *)base)->end_of_space = address;
  return 0;
}

static haddr_t driver_get_eof(const H5FD_t *base, H5FD_mem_t type)
{
  (void)type;
  return ((const driver_file *)base)->end_of_file;
}

static herr_t driver_read(H5FD_t *base, H5FD_mem_t type, hid_t transfer, haddr_t address,
                          size_t size, void *buffer)
{
  driver_file *file = (driver_file *)base;
  unsigned char *to = buffer;
  (void)type, (void)transfer;
  while (size > 0) {
    ssize_t got = pread(file->descriptor, to, size, (off_t)address);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return -1;
    // -- Beyond the end of the file stand zeros
    if (got == 0) {
      memset(to, 0, size);
      return 0;
    }
    to += got;
    address += (haddr_t)got;
    size -= (size_t)got;
  }
  return 0;
}

static herr_t driver_write(H5FD_t *base, H5FD_mem_t type, hid_t transfer, haddr_t address,
                           size_t size, const void *buffer)
{
  driver_file *file = (driver_file *)base;
  const unsigned char *from = buffer;
  (void)type, (void)transfer;
  if (address + size > file->end_of_file) file->end_of_file = address + size;
  while (size > 0 && file->disk->error == 0) {
    ssize_t put = pwrite(file->descriptor, from, size, (off_t)address);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) {
      file->disk->error = put < 0 ? errno : ENOSPC;
      break;
    }
    from += put;
    address += (haddr_t)put;
    size -= (size_t)put;
  }
  return 0;
}

static herr_t driver_truncate(H5FD_t *base, hid_t transfer, hbool_t closing)
{
  driver_file *file = (driver_file *)base;
  (void)transfer, (void)closing;
  if (file->end_of_space == file->end_of_file) return 0;
  if (file->disk->error == 0 && ftruncate(file->descriptor, (off_t)file->end_of_space) != 0)
    file->disk->error = errno;
  file->end_of_file = file->end_of_space;
  return 0;
}

/* More than any number of the system's files can be, as HDF5 asks for. */
#define LARGEST_ADDRESS (((haddr_t)1 << 62) - 1)

static const H5FD_class_t DRIVER = {
#if H5_VERSION_GE(1, 13, 0)
    .version = H5FD_CLASS_VERSION,
    .value = 40211,
#endif
    .name = "libcontact",
    .maxaddr = LARGEST_ADDRESS,
    .fc_degree = H5F_CLOSE_WEAK,
    .fapl_size = sizeof(driver_info),
    .open = driver_open,
    .close = driver_close,
    .cmp = driver_compare,
    .query = driver_query,
    .get_eoa = driver_get_eoa,
    .set_eoa = driver_set_eoa,
    .get_eof = driver_get_eof,
    .read = driver_read,
    .write = driver_write,
    .truncate = driver_truncate,
    .fl_map = H5FD_FLMAP_DICHOTOMY};

hid_t ct_driver_register(void) { return H5FDregister(&DRIVER); }

herr_t ct_driver_use(hid_t access, hid_t driver, ct_disk *disk)
{
  const driver_info info = {disk};
  return H5Pset_driver(access, driver, &info);
}
