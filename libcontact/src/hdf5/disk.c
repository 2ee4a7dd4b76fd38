#ifdef __linux__
#define _GNU_SOURCE
#else
#undef _POSIX_C_SOURCE
#define _XOPEN_SOURCE 700
#define _DARWIN_C_SOURCE
#endif
#define _FILE_OFFSET_BITS 64

#include "hdf5_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* -- Names and errors -- */

void ct_disk_check(ct_task *task, const char *what, int number)
{
  if (number != 0)
    ct_task_fail(task, CT_ERROR_FILE, CT_NOWHERE, "can't %s: %s", what,
                 number == EAGAIN ? "another run is writing it" : strerror(number));
}

void ct_disk_names(ct_task *task, ct_disk *disk, const char *path)
{
  struct stat found;
  if (stat(path, &found) == 0 && !S_ISREG(found.st_mode))
    ct_task_fail(task, CT_ERROR_FILE, CT_NOWHERE, "can't write the file: %s",
                 S_ISDIR(found.st_mode) ? "Is a directory" : "it is no ordinary file");
  disk->path = realpath(path, NULL);
  if (disk->path == NULL) disk->path = strdup(path);
  if (disk->path != NULL) disk->part = malloc(strlen(disk->path) + sizeof ".part");
  if (disk->part != NULL) sprintf(disk->part, "%s.part", disk->path);
  else ct_task_fail(task, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a path");
}

void ct_disk_rename(ct_task *task, ct_disk *disk)
{
  if (disk->renamed) return;
  ct_disk_check(task, "write the file", rename(disk->part, disk->path) == 0 ? 0 : errno);
  disk->renamed = task->status == CT_OK;
}

/* -- One writer -- */

/*
 * A file is locked while it is written, so that no second run writes it. The lock belongs to the
 * open file, and ends with the process in any case. On systems without such locks it belongs to the
 * process, and two outputs of one process do not see each other's locks. It is not flock's, because
 * with that HDF5 itself would refuse to read the file.
 */
#ifdef F_OFD_SETLK
enum { SET_LOCK = F_OFD_SETLK };
#else
enum { SET_LOCK = F_SETLK };
#endif

static int set_lock(int descriptor, short type)
{
  struct flock whole = {.l_type = type, .l_whence = SEEK_SET};
  return fcntl(descriptor, SET_LOCK, &whole);
}

/* 0, or EAGAIN if another run has the lock. A file system without locks has none to respect. */
static int take_lock(int descriptor)
{
  if (set_lock(descriptor, F_WRLCK) == 0) return 0;
  return errno == EAGAIN || errno == EACCES ? EAGAIN : 0;
}

/* A forked child may also have the file open, and must not keep the lock. */
void ct_disk_unlock(int descriptor) { (void)set_lock(descriptor, F_UNLCK); }

/* Whether an open file still has a name. */
static int bears(int descriptor, const char *name)
{
  struct stat one, two;
  return fstat(descriptor, &one) == 0 && lstat(name, &two) == 0 && one.st_dev == two.st_dev &&
         one.st_ino == two.st_ino;
}

static int open_if_there(const char *path)
{
  return open(path, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
}

/* Remove a file that an ended run has left, or a link. Returns 0, EAGAIN while the run is alive, or
 * the system's error number. */
static int clear(const char *part)
{
  int descriptor = open_if_there(part), result = descriptor < 0 ? errno : take_lock(descriptor);
  if (result == ENOENT) return 0;
  int is_left = result == ELOOP || (result == 0 && bears(descriptor, part));
  if (is_left) result = unlink(part) == 0 || errno == ENOENT ? 0 : errno;
  if (descriptor >= 0) close(descriptor);
  return result;
}

/* Whether no run writes a file, which need not exist. */
static int is_free(const char *path)
{
  int descriptor = open_if_there(path);
  if (descriptor < 0) return 1;
  int result = take_lock(descriptor);
  close(descriptor);
  return result == 0;
}

/* One attempt to create and lock a file before another run takes it for one that was left. Negative
 * on failure. */
static hid_t make_locked(ct_disk *disk, hid_t how, hid_t access)
{
  void *handle = NULL;
  hid_t file = H5Fcreate(disk->part, H5F_ACC_EXCL, how, access);
  if (file < 0 || H5Fget_vfd_handle(file, access, &handle) < 0) return file;
  int descriptor = *(int *)handle;
  (void)fcntl(descriptor, F_SETFD, FD_CLOEXEC);
  if (take_lock(descriptor) == 0 && bears(descriptor, disk->part)) disk->descriptor = descriptor;
  return file;
}

enum { ATTEMPTS = 100 };

hid_t ct_disk_create(ct_task *task, ct_disk *disk, hid_t how, hid_t access)
{
  struct stat found;
  hid_t file = -1;
  int result = 0;
  for (int i = 0; i < ATTEMPTS && disk->descriptor < 0 && result == 0; i++) {
    if (file >= 0) H5Fclose(file);
    file = -1;
    result = clear(disk->part);
    if (result == 0) file = make_locked(disk, how, access);
    if (result == 0 && file < 0 && lstat(disk->part, &found) != 0) {
      ct_hdf5_fail(task, "write the file");
      return -1;
    }
  }
  // -- The owner of the new file's lock also checks the lock of the old file: its run may have
  // given it the final name
  if (result == 0 && (disk->descriptor < 0 || !is_free(disk->path))) result = EAGAIN;
  ct_disk_check(task, "write the file", result);
  return file;
}

/* -- A full disk -- */

/* Allocate the bytes from `start` on; returns 0, or the error number if the disk is full. */
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

void ct_disk_reserve(ct_task *task, const ct_disk *disk, int64_t bytes)
{
  hsize_t size = 0;
  if (task->status != CT_OK || H5Fget_filesize(task->file, &size) < 0) return;
  int result = reserve(disk->descriptor, (off_t)size, bytes);
  if (result != 0) ct_disk_trim(disk, task->file);
  ct_disk_check(task, "write the next step", result);
}

void ct_disk_trim(const ct_disk *disk, hid_t file)
{
  hsize_t size = 0;
  struct stat found;
  if (H5Fget_filesize(file, &size) < 0 || fstat(disk->descriptor, &found) != 0) return;
  // -- A file that stays too long is still valid, so a failure here is ignored
  if (found.st_size > (off_t)size && ftruncate(disk->descriptor, (off_t)size) != 0) return;
}

void ct_disk_flush(ct_task *task, const ct_disk *disk, const char *what)
{
  if (task->status == CT_OK && H5Fflush(task->file, H5F_SCOPE_LOCAL) < 0) ct_hdf5_fail(task, what);
  ct_disk_check(task, what, disk->error);
}
