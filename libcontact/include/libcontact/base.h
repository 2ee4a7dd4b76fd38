/* Statuses, errors, the version, the host's allocator, a factor in time, and sums that do not
 * depend on the order.
 * Threads: ct_set_allocator only while no other thread is inside the library; all other calls at
 * any time. */
#ifndef LIBCONTACT_BASE_H
#define LIBCONTACT_BASE_H

#include <stddef.h>
#include <stdint.h>

/* Marks what a shared library exports; cffi and the documentation remove this word. */
#ifndef CT_API
#if defined(__GNUC__) && !defined(__wasm__)
#define CT_API __attribute__((visibility("default")))
#else
#define CT_API
#endif
#endif

/* These two enclose every public header, so that a C++ program links with any of them. */
#ifdef __cplusplus
#define CT_BEGIN_DECLS extern "C" {
#define CT_END_DECLS }
#else
#define CT_BEGIN_DECLS
#define CT_END_DECLS
#endif

CT_BEGIN_DECLS

/**
 * How a call ended. Zero is success. 1 to 4 also describe the result of one projection. The rest
 * are errors. The numbers are those of ``libcontact.Status`` in Python.
 */
typedef enum ct_status {
  /** success; the result meets the tolerance */
  CT_OK = 0,
  /** a result whose error may exceed the tolerance */
  CT_NOT_CERTIFIED = 1,
  /** the iteration limit was reached first */
  CT_ITERATION_LIMIT = 2,
  /** the method stopped at a point that is no stationary point */
  CT_NO_CONVERGENCE = 3,
  /** invalid input (NaN, infinite, degenerate); outputs are NaN */
  CT_INVALID = 4,
  /** an invalid argument: null, out of range, unknown */
  CT_ERROR_ARGUMENT = 5,
  /** out of memory */
  CT_ERROR_MEMORY = 6,
  /** an inverted or collapsed element or face */
  CT_ERROR_GEOMETRY = 7,
  /** the time step exceeds the largest stable one */
  CT_ERROR_STEP = 8,
  /** not supported in this build or for this case */
  CT_ERROR_UNSUPPORTED = 9,
  /** a file can't be opened, written or read */
  CT_ERROR_FILE = 10,
  /** the state became NaN or infinite during the run */
  CT_ERROR_BLOWUP = 11,
  /** spurious energy growth was detected during the run */
  CT_ERROR_ENERGY = 12
} ct_status;

/** The part of a scene that an error is about, for calls that create several parts. */
typedef enum ct_scene_part {
  /** the call concerns one part only */
  CT_PART_NONE = 0,
  /** a contact */
  CT_PART_CONTACT = 1,
  /** a support */
  CT_PART_SUPPORT = 2,
  /** the time and its step */
  CT_PART_TIME = 3
} ct_scene_part;

/**
 * Details of an error. The caller owns it, and may pass a null pointer if the status is enough. A
 * call that succeeds does not change it.
 */
typedef struct ct_error {
  /** The same code that the call returns. */
  ct_status code;
  /** Body that the error is about, counted from 0; -1: none. */
  int64_t body;
  /** Element or face, likewise. */
  int64_t element;
  /** Node, Gauss point or row, likewise. */
  int64_t point;
  /** One sentence in UTF-8 that explains the error, ended by a zero byte. A text that was too long
   * ends with "...". */
  char text[1024];
  /** The part of the scene that `ct_scene_build` could not make. */
  ct_scene_part part;
  /** Its number among the parts of its kind, counted from 0. */
  int32_t number;
} ct_error;

/** A short name for a status, for example ``"inverted or collapsed element"``; never null. */
CT_API const char *ct_status_name(ct_status status);

/** Memory functions of the host, called from several threads at once if it calls the library so. */
typedef struct ct_allocator {
  /** Return `size` > 0 bytes, aligned for any C type; null if out of memory. */
  void *(*allocate)(size_t size, void *context);
  /** Free memory that `allocate` returned; never called with null. */
  void (*release)(void *memory, void *context);
  /** Passed to both functions. */
  void *context;
  /** Not zero: all bytes that `allocate` returns are 0, as those of ``calloc``. Then the library
   * writes no zeros, and the system need not provide memory that is never used. */
  int zeroes;
} ct_allocator;

/**
 * Allocate all memory of the library with `allocator`, which is copied. Null selects the C library,
 * the default. The setting holds for the whole process. Call it before any object of the library
 * exists, or after all are freed, and while no other thread is inside the library. The add-on
 * libraries (results files and the series) use the C library, as HDF5 and GSL do; OpenMP allocates
 * its own memory. ``CT_ERROR_ARGUMENT``: a function is missing; the setting stays as it was.
 */
CT_API ct_status ct_set_allocator(const ct_allocator *allocator, ct_error *error);

/** Version of the headers; each number is below 10. */
typedef enum ct_version_number {
  /** changes when a host must change its calls */
  CT_VERSION_MAJOR = 0,
  /** changes when something is added */
  CT_VERSION_MINOR = 2,
  /** changes when an error is corrected */
  CT_VERSION_PATCH = 0
} ct_version_number;

/** Version of the library as ``"major.minor.patch"``. If it differs from `ct_version_number`, the
 * program was compiled with the headers of another version. */
CT_API const char *ct_version(void);

/** Not zero if the library was compiled with OpenMP. Without OpenMP the library runs on one thread,
 * whatever number is requested. */
CT_API int ct_has_openmp(void);

/** Settings of a run, which its problem holds. They change how long it takes and none of its
 * results. All bytes zero: one thread, no clock. */
typedef struct ct_run_settings {
  /** Number of threads; 0: one. */
  int threads;
  /** Null, or a clock [seconds] with which the time loop measures the time spent in each effect
   * (`effect_seconds` of the state). */
  double (*clock)(void);
} ct_run_settings;

/** A factor that depends on time, piecewise linear between given points, :eq:`amplitude`, and
 * constant before the first and after the last. */
typedef struct ct_amplitude {
  /** Number of points; 0: the factor is 1 at all times. */
  int32_t count;
  /** Times [time], not descending, shape (count). Two equal times define a jump; at that time the
   * later value applies. */
  const double *time;
  /** Values at these times, shape (count). */
  const double *value;
} ct_amplitude;

/**
 * Sum of `count` numbers. The result has the same bits for any order of the numbers and for any
 * number of threads: every partial sum is exact on a grid that the largest number fixes,
 * :eq:`order-free-sum`. The error is below count³ · 2⁻⁹⁸ of the largest number, before the one
 * rounding of the result. NaN if a number is not finite or the sum overflows.
 */
CT_API double ct_sum(const double *values, int64_t count);

/**
 * How the pieces of a distributed model exchange numbers, for example by ``MPI_Allreduce``. Each
 * function replaces `count` numbers of every piece by their sums, or by the largest of each, over
 * all pieces, and returns 0; another value fails the step in this piece. All pieces make the same
 * calls in the same order. The numbers to be added are multiples of one spacing, so that their sums
 * are exact and do not depend on the order, :eq:`order-free-sum`. The host writes all members.
 */
typedef struct ct_pieces {
  /** Passed to both functions. */
  void *data;
  /** Add the numbers of all pieces. */
  int (*sum)(void *data, double *values, int64_t count);
  /** Take the largest. */
  int (*largest)(void *data, double *values, int64_t count);
} ct_pieces;

CT_END_DECLS

#endif
