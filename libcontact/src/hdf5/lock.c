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

static int set_lock(int descriptor, short type)
{
  struct flock whole = {.l_type = type, .l_whence = SEEK_SET};
  return fcntl(descriptor, SET_LOCK, &whole);
}

int ct_lock_take(int descriptor)
{
  if (set_lock(descriptor, F_WRLCK) == 0) return 0;
  return errno == EAGAIN || errno == EACCES ? EAGAIN : 0;
}

/* A forked child may have the file open as well, and must not keep the lock. */
void ct_lock_release(int descriptor) { (void)set_lock(descriptor, F_UNLCK); }

int ct_lock_bears(int descriptor, const char *name)
{
  struct stat one, two;
  return fstat(descriptor, &one) == 0 && lstat(name, &two) == 0 && one.st_dev == two.st_dev &&
         one.st_ino == two.st_ino;
}

static int open_if_there(const char *path)
{
  return open(path, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
}

int ct_lock_clear(const char *part)
{
  int descriptor = open_if_there(part), result = descriptor < 0 ? errno : ct_lock_take(descriptor);
  if (result == ENOENT) return 0;
  int is_left = result == ELOOP || (result == 0 && ct_lock_bears(descriptor, part));
  if (is_left) result = unlink(part) == 0 || errno == ENOENT ? 0 : errno;
  if (descriptor >= 0) close(descriptor);
  return result;
}

int ct_lock_is_free(const char *path)
{
  int descriptor = open_if_there(path);
  if (descriptor < 0) return 1;
  int is_free = ct_lock_take(descriptor) == 0;
  close(descriptor);
  return is_free;
}
