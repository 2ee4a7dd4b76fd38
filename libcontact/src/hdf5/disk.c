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

enum { LONGEST_PATH_SHOWN = 400, ATTEMPTS = 100 };

const char *ct_disk_short(const char *path)
{
  size_t length = strlen(path);
  if (length <= LONGEST_PATH_SHOWN) return path;
  const char *end = path + (length - LONGEST_PATH_SHOWN), *folder = strchr(end, '/');
  return folder != NULL ? folder : end;
}

void ct_disk_check(ct_task *task, const char *what, int number)
{
  char reason[200];
  if (number == 0 || task->status != CT_OK) return;
  if (strerror_r(number, reason, sizeof reason) != 0)
    snprintf(reason, sizeof reason, "error %d", number);
  task->status = ct_fail(task->error, CT_ERROR_FILE, CT_NOWHERE, "%s: can't %s: %s",
                         ct_disk_short(task->path), what, reason);
}

ct_status ct_disk_names(const char *path, char **target, char **part, ct_error *error)
{
  struct stat found;
  if (stat(path, &found) == 0 && !S_ISREG(found.st_mode))
    return ct_fail(error, CT_ERROR_FILE, CT_NOWHERE, "%s: can't write the file: %s",
                   ct_disk_short(path),
                   S_ISDIR(found.st_mode) ? "Is a directory" : "it is no ordinary file");
  char *real = realpath(path, NULL);
  const char *name = real != NULL ? real : path;
  size_t room = strlen(name) + sizeof ".part";
  *target = malloc(room);
  *part = malloc(room);
  if (*target != NULL && *part != NULL) {
    snprintf(*target, room, "%s", name);
    snprintf(*part, room, "%s.part", name);
  }
  free(real);
  if (*target == NULL || *part == NULL)
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a path");
  return CT_OK;
}

/* One attempt: a file that nobody else has taken for one that was left, between its making and its
 * lock. Negative without one. */
static hid_t make_locked(ct_disk *disk, const char *part, hid_t how, hid_t access)
{
  void *handle = NULL;
  hid_t file = H5Fcreate(part, H5F_ACC_EXCL, how, access);
  if (file < 0 || H5Fget_vfd_handle(file, access, &handle) < 0) return file;
  int descriptor = *(int *)handle;
  (void)fcntl(descriptor, F_SETFD, FD_CLOEXEC);
  if (ct_lock_take(descriptor) == 0 && ct_lock_bears(descriptor, part))
    disk->descriptor = descriptor;
  return file;
}

hid_t ct_disk_create(ct_task *task, ct_disk *disk, const char *part, hid_t how, hid_t access)
{
  struct stat found;
  hid_t file = -1;
  int result = EAGAIN;
  for (int i = 0; i < ATTEMPTS && disk->descriptor < 0; i++) {
    if (file >= 0) H5Fclose(file);
    file = -1;
    result = ct_lock_clear(part);
    if (result != 0) break;
    file = make_locked(disk, part, how, access);
    if (file < 0 && lstat(part, &found) != 0) {
      ct_hdf5_fail(task, "write the file");
      return -1;
    }
    result = EAGAIN;
  }
  // -- Whoever has the lock of the new file may ask who has that of the old one: a run that has
  // given the file its final name
  if (disk->descriptor >= 0 && ct_lock_is_free(task->path)) return file;
  if (result != EAGAIN) ct_disk_check(task, "write the file", result);
  else
    task->status =
        ct_fail(task->error, CT_ERROR_FILE, CT_NOWHERE,
                "%s: can't write the file: another run is writing it", ct_disk_short(task->path));
  return file;
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

void ct_disk_reserve(ct_task *task, const ct_disk *disk, hid_t file, int64_t bytes)
{
  hsize_t size = 0;
  if (task->status != CT_OK || H5Fget_filesize(file, &size) < 0) return;
  int result = reserve(disk->descriptor, (off_t)size, bytes);
  if (result != 0) ct_disk_trim(disk, file);
  ct_disk_check(task, "write the next step", result);
}

void ct_disk_trim(const ct_disk *disk, hid_t file)
{
  hsize_t size = 0;
  struct stat found;
  if (H5Fget_filesize(file, &size) < 0 || fstat(disk->descriptor, &found) != 0) return;
  // -- A file that stays too long is still right, so a failure here needs no answer
  if (found.st_size > (off_t)size && ftruncate(disk->descriptor, (off_t)size) != 0) return;
}

void ct_disk_flush(ct_task *task, const ct_disk *disk, hid_t file, const char *what)
{
  if (task->status == CT_OK && H5Fflush(file, H5F_SCOPE_LOCAL) < 0) ct_hdf5_fail(task, what);
  ct_disk_check(task, what, disk->error);
}

int ct_disk_rename(const char *from, const char *to) { return rename(from, to) == 0 ? 0 : errno; }

void ct_disk_remove(const char *path) { unlink(path); }
