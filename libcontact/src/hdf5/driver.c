#include "hdf5_internal.h"

#include <errno.h>
#include <stdio.h>

/*
 * HDF5's own driver ("sec2") with writes that never fail. After a failed write in a flush HDF5 can
 * no longer close the file, and crashes when the process ends (seen with 1.10.8). So ct_disk keeps
 * the first failure, nothing is written from then on, and HDF5 sees success. Callers check
 * ct_disk.error after each flush.
 */

/* A driver class of HDF5 has no member for data except its name, which is ours: its address is that
 * of the disk. */
static ct_disk *disk_of(const H5FD_t *file) { return (ct_disk *)(uintptr_t)file->cls->name; }

static void keep_error(ct_disk *disk, herr_t done)
{
  if (done < 0 && disk->error == 0) disk->error = errno != 0 ? errno : EIO;
}

static herr_t driver_write(H5FD_t *file, H5FD_mem_t type, hid_t transfer, haddr_t address,
                           size_t size, const void *bytes)
{
  ct_disk *disk = disk_of(file);
  if (disk->error == 0)
    keep_error(disk, disk->real->write(file, type, transfer, address, size, bytes));
  return 0;
}

static herr_t driver_truncate(H5FD_t *file, hid_t transfer, hbool_t closing)
{
  ct_disk *disk = disk_of(file);
  if (disk->error == 0) keep_error(disk, disk->real->truncate(file, transfer, closing));
  return 0;
}

static herr_t driver_close(H5FD_t *file)
{
  ct_disk *disk = disk_of(file);
  ct_disk_unlock(disk->descriptor);
  disk->descriptor = -1;
  keep_error(disk, disk->real->close(file));
  return 0;
}

int ct_driver_use(ct_disk *disk, hid_t access)
{
  // -- An open file shows the class of its driver
  H5FD_t *file = NULL;
  if (H5Pset_fapl_sec2(access) >= 0)
    file = H5FDopen("/dev/null", H5F_ACC_RDONLY, access, HADDR_UNDEF);
  if (file == NULL) return 0;
  H5FD_class_t own = *file->cls;
  disk->real = file->cls;
  H5FDclose(file);
  snprintf(disk->name, sizeof disk->name, "libcontact");
  own.name = disk->name;
  own.write = driver_write;
  own.truncate = driver_truncate;
  own.close = driver_close;
  // -- The end of our class is not the end of HDF5's; and the lock is ours (disk.c)
  own.terminate = NULL;
  own.lock = NULL;
  own.unlock = NULL;
  disk->driver = H5FDregister(&own);
  return disk->driver >= 0 && H5Pset_driver(access, disk->driver, NULL) >= 0;
}
