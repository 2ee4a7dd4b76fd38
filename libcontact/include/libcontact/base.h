/* Statuses, errors, the version, the host's allocator, and sums that do not depend on the order.
 * Threads: ct_set_allocator only while no other thread is inside the library; all other calls at
 * any time. */
#ifndef LIBCONTACT_BASE_H
#define LIBCONTACT_BASE_H

#include <stddef.h>
#include <stdint.h>

/* What a shared library shows of itself; cffi and the documentation drop the word. */
#ifndef CT_API
#if defined(__GNUC__) && !defined(__wasm__)
#define CT_API __attribute__((visibility("default")))
#else
#define CT_API
#endif
#endif

/* Every public header stands between these two, so that a C++ program links whichever headers it
 * includes. */
#ifdef __cplusplus
#define CT_BEGIN_DECLS extern "C" {
#define CT_END_DECLS }
#else
#define CT_BEGIN_DECLS
#define CT_END_DECLS
#endif

CT_BEGIN_DECLS

/**
 * How a call ended. Zero is success; 1 to 4 are also the verdicts on one projection
 * (the same numbers as ``libcontact.Status`` in Python); the rest are errors.
 */
typedef enum ct_status {
  /** done, and the answer meets the tolerance */
  CT_OK = 0,
  /** an answer that no proof stands behind */
  CT_NOT_CERTIFIED = 1,
  /** the budget of iterations was used up first */
  CT_ITERATION_LIMIT = 2,
  /** the method stopped at a point that is no stationary point */
  CT_NO_CONVERGENCE = 3,
  /** NaN, infinite or degenerate numbers came in; no number comes out */
  CT_INVALID = 4,
  /** an argument is impossible: null, out of range, unknown */
  CT_ERROR_ARGUMENT = 5,
  /** the system gave no memory */
  CT_ERROR_MEMORY = 6,
  /** an inverted or collapsed element or face */
  CT_ERROR_GEOMETRY = 7,
  /** the time step is above the stable one */
  CT_ERROR_STEP = 8,
  /** known, but not in this build or not for this case */
  CT_ERROR_UNSUPPORTED = 9,
  /** a file can't be opened, written or read */
  CT_ERROR_FILE = 10,
  /** the state has stopped being finite in mid-run */
  CT_ERROR_BLOWUP = 11,
  /** energy has appeared from nothing in mid-run */
  CT_ERROR_ENERGY = 12
} ct_status;

/** What of a scene an error is about, where a call makes several of them. */
typedef enum ct_scene_part {
  /** it is clear from the call */
  CT_PART_NONE = 0,
  /** a contact */
  CT_PART_CONTACT = 1,
  /** a support */
  CT_PART_SUPPORT = 2,
  /** the time and its step */
  CT_PART_TIME = 3
} ct_scene_part;

/**
 * The detail of an error, owned by the caller, who may pass a null pointer when the code is enough.
 * Calls that succeed leave it alone.
 */
typedef struct ct_error {
  /** The same code that the call returns. */
  ct_status code;
  /** Body that the error is about, counted from 0; -1 where it names none. */
  int64_t body;
  /** Element or face, likewise. */
  int64_t element;
  /** Node, Gauss point or row, likewise. */
  int64_t point;
  /** One sentence for a person in UTF-8, ended by a zero byte; "..." at its end stands for what was
   * longer still. */
  char text[1024];
  /** The part of the scene that `ct_scene_build` could not make. */
  ct_scene_part part;
  /** Its number among the parts of its kind, counted from 0. */
  int32_t number;
} ct_error;

/** A short name for a status, for example ``"inverted or collapsed element"``; never null. */
CT_API const char *ct_status_name(ct_status status);

/**
 * Where the memory of the library comes from: two functions of the host and what they need. Both
 * may be called from several threads at once if the host calls the library from several threads.
 */
typedef struct ct_allocator {
  /** `size` > 0 bytes, aligned for any C type, with any content; null when there are none. */
  void *(*allocate)(size_t size, void *context);
  /** Take back what `allocate` gave; never null. */
  void (*release)(void *memory, void *context);
  /** Passed to both functions. */
  void *context;
} ct_allocator;

/**
 * Take all memory of the library from `allocator`, which is copied; null: from the C library, as
 * without this call. It holds for the whole process, so call it before anything of the library is
 * made, or after all is freed, and while no other thread is inside the library. Results files and
 * the series (the add-on libraries) keep to the C library, as HDF5 and GSL do; OpenMP has memory of
 * its own. ``CT_ERROR_ARGUMENT``: a function is missing; nothing is changed.
 */
CT_API ct_status ct_set_allocator(const ct_allocator *allocator);

/** Version of the headers; each number is below 10. */
typedef enum ct_version_number {
  /** changes when a host must change its calls */
  CT_VERSION_MAJOR = 0,
  /** changes when something is added */
  CT_VERSION_MINOR = 1,
  /** changes when something is mended */
  CT_VERSION_PATCH = 0
} ct_version_number;

/** Version of the library as ``"major.minor.patch"``; other numbers than those of
 * `ct_version_number` mean that a program was compiled with the headers of another version. */
CT_API const char *ct_version(void);

/** Not zero when the library was compiled with OpenMP; without it, any number of threads means one.
 */
CT_API int ct_has_openmp(void);

/**
 * Sum of `count` numbers, the same bits for any order of them and for any number of threads: every
 * partial sum is exact on a grid that the largest number fixes, :eq:`order-free-sum`. The error is
 * below count³ · 2⁻⁹⁸ of the largest number, before the one rounding of the result. NaN if one of
 * them is not finite or the sum would overflow.
 */
CT_API double ct_sum(const double *values, int64_t count);

CT_END_DECLS

#endif
