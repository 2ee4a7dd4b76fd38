#define _XOPEN_SOURCE 700
#define _FILE_OFFSET_BITS 64

#include "hdf5_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { LONGEST_PATH_SHOWN = 400 };

const char *ct_disk_short(const char *path)
{
  size_t length = strlen(path);
  if (length <= LONGEST_PATH_SHOWN) return path;
  const char *end = path + (length - LONGEST_PATH_SHOWN), *folder = strchr(end, '/');
  return folder != NULL ? folder : end;
}

static ct_status system_fail(ct_error *error, const char *path, const char *what, int number)
{
  char reason[200];
  if (strerror_r(number, reason, sizeof reason) != 0)
    snprintf(reason, sizeof reason, "error %d", number);
  return ct_fail(error, CT_ERROR_FILE, CT_NOWHERE, "%s: can't %s: %s", ct_disk_short(path), what,
                 reason);
}

ct_status ct_disk_names(const char *path, char **target, char **part, ct_error *error)
{
  struct stat found;
  *target = *part = NULL;
  if (stat(path, &found) == 0 && !S_ISREG(found.st_mode)) {
    if (S_ISDIR(found.st_mode)) return system_fail(error, path, "write the file", EISDIR);
    return ct_fail(error, CT_ERROR_FILE, CT_NOWHERE,
                   "%s: can't write the file: it is no ordinary file", ct_disk_short(path));
  }
  char *real = realpath(path, NULL);
  const char *name = real != NULL ? real : path;
  size_t length = strlen(name) + 1;
  *target = malloc(length);
  *part = malloc(length + sizeof ".part");
  if (*target != NULL && *part != NULL) {
    memcpy(*target, name, length);
    snprintf(*part, length + sizeof ".part", "%s.part", name);
  }
  free(real);
  if (*target == NULL || *part == NULL)
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a path");
  return CT_OK;
}

ct_status ct_disk_check_readable(const char *path, ct_error *error)
{
  struct stat found;
  if (stat(path, &found) != 0) return system_fail(error, path, "read the file", errno);
  if (S_ISDIR(found.st_mode)) return system_fail(error, path, "read the file", EISDIR);
  int descriptor = open(path, O_RDONLY);
  if (descriptor < 0) return system_fail(error, path, "read the file", errno);
  close(descriptor);
  return CT_OK;
}

/* Ask for the bytes from `start` on; 0, or the number of the error when the disk has no room for
 * them. */
static int reserve(int descriptor, off_t start, int64_t bytes)
{
#if defined(_POSIX_ADVISORY_INFO) && _POSIX_ADVISORY_INFO > 0
  int result;
  do result = posix_fallocate(descriptor, start, (off_t)bytes);
  while (result == EINTR);
  // -- Only a full disk counts: a file system that can't reserve is no reason to stop
  if (result == ENOSPC || result == EFBIG || result == EDQUOT || result == EIO) return result;
#else
  (void)descriptor, (void)start, (void)bytes;
#endif
  return 0;
}

ct_status ct_disk_open(ct_disk *disk, const char *part, int64_t bytes, const char *path,
                       ct_error *error)
{
  int result = ct_lock_create(part, &disk->locked);
  // -- Whoever has the lock of the new file may ask who has that of the old one: a run that has
  // given the file its final name
  int busy = result == EAGAIN || (result == 0 && !ct_lock_is_free(path));
  if (result == 0 && !busy) result = reserve(disk->locked, 0, bytes);
  if (result == 0 && !busy) return CT_OK;
  if (disk->locked >= 0) unlink(part);
  ct_lock_release(disk->locked);
  disk->locked = -1;
  if (busy)
    return ct_fail(error, CT_ERROR_FILE, CT_NOWHERE,
                   "%s: can't write the file: another run is writing it", ct_disk_short(path));
  return system_fail(error, path, "write the file", result);
}

ct_status ct_disk_reserve(const ct_disk *disk, hid_t file, int64_t bytes, const char *path,
                          ct_error *error)
{
  hsize_t size = 0;
  if (H5Fget_filesize(file, &size) < 0) return CT_OK;
  int result = reserve(disk->descriptor, (off_t)size, bytes);
  if (result == 0) return CT_OK;
  ct_disk_trim(disk, file);
  return system_fail(error, path, "write the next step", result);
}

void ct_disk_trim(const ct_disk *disk, hid_t file)
{
  hsize_t size = 0;
  struct stat found;
  if (H5Fget_filesize(file, &size) < 0 || fstat(disk->descriptor, &found) != 0) return;
  // -- A file that stays too long is still right, so a failure here needs no answer
  if (found.st_size > (off_t)size && ftruncate(disk->descriptor, (off_t)size) != 0) return;
}

ct_status ct_disk_check(const ct_disk *disk, const char *path, const char *what, ct_error *error)
{
  return disk->error == 0 ? CT_OK : system_fail(error, path, what, disk->error);
}

ct_status ct_disk_rename(const char *from, const char *to, ct_error *error)
{
  if (rename(from, to) != 0) return system_fail(error, to, "write the file", errno);
  return CT_OK;
}

void ct_disk_remove(const char *path) { unlink(path); }
