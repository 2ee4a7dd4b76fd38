#ifdef __linux__
#define _GNU_SOURCE
#else
#define _XOPEN_SOURCE 700
#endif
#define _FILE_OFFSET_BITS 64

#include "hdf5_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

/*
 * A file that is written is locked, so that no second run writes it too. The lock belongs to the
 * open file, and so goes with the process, however that ends; where the system has no such lock it
 * belongs to the process, and two outputs of one process do not see each other's. It is not
 * flock's, with which HDF5 itself would refuse to read a file that is written.
 */
#ifdef F_OFD_SETLK
enum { SET_LOCK = F_OFD_SETLK };
#else
enum { SET_LOCK = F_SETLK };
#endif

enum { ATTEMPTS = 100 };

/* 0, or EAGAIN when another has the lock. A file system without locks has none to respect. */
static int lock(int descriptor)
{
  struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
  if (fcntl(descriptor, SET_LOCK, &whole) == 0) return 0;
  return errno == EAGAIN || errno == EACCES ? EAGAIN : 0;
}

/* Whether an open file still bears a name. */
static int bears(int descriptor, const char *name)
{
  struct stat one, two;
  return fstat(descriptor, &one) == 0 && lstat(name, &two) == 0 && one.st_dev == two.st_dev &&
         one.st_ino == two.st_ino;
}

/* Remove a file that a run which has ended left behind, or a link. Returns 0, EAGAIN while the run
 * is alive, or the number of the system's error. */
static int clear(const char *part)
{
  int descriptor = open(part, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC), result = errno;
  if (descriptor < 0)
    return result == ELOOP    ? (unlink(part) == 0 || errno == ENOENT ? 0 : errno)
           : result == ENOENT ? 0
                              : result;
  result = lock(descriptor);
  if (result == 0 && bears(descriptor, part) && unlink(part) != 0) result = errno;
  close(descriptor);
  return result;
}

int ct_lock_create(const char *part, int *descriptor)
{
  int result = EAGAIN;
  for (int i = 0; i < ATTEMPTS; i++) {
    *descriptor = open(part, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    result = *descriptor < 0 ? errno : lock(*descriptor);
    if (result == 0 && bears(*descriptor, part)) return 0;
    // -- Somebody took it for a file that was left, between its making and its lock: once more
    if (*descriptor >= 0) close(*descriptor);
    *descriptor = -1;
    if (result == EEXIST) result = clear(part);
    if (result != 0) return result;
  }
  return EAGAIN;
}

int ct_lock_is_free(const char *path)
{
  int descriptor = open(path, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return 1;
  int is_free = lock(descriptor) == 0;
  close(descriptor);
  return is_free;
}

void ct_lock_release(int descriptor)
{
  struct flock whole = {.l_type = F_UNLCK, .l_whence = SEEK_SET};
  if (descriptor < 0) return;
  // -- A forked child may have the file open as well: it must not keep the lock
  (void)fcntl(descriptor, SET_LOCK, &whole);
  close(descriptor);
}
