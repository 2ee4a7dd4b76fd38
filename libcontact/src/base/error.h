#ifndef CT_SRC_ERROR_H
#define CT_SRC_ERROR_H

#include <libcontact/base.h>

/* The largest number of threads: some runtimes end the program if they cannot start more. */
enum { CT_MOST_THREADS = 1024 };

/* Place of an error; -1 where it names none. */
typedef struct ct_place {
  int64_t body, element, point;
} ct_place;

static const ct_place CT_NOWHERE = {-1, -1, -1};

/* Fill `error` (if any) with a printf-style sentence and return `code`, so that callers write
 * `return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "...")`. */
#if defined(__GNUC__)
__attribute__((format(printf, 4, 5)))
#endif
ct_status ct_fail(ct_error *error, ct_status code, ct_place where, const char *format, ...);

/* Refuse an invalid argument without a place in a mesh, and report missing memory. */
#define CT_REFUSE(error, ...) ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, __VA_ARGS__)
/* Refuse a null argument of the public call in whose body this stands. */
#define CT_REFUSE_NULL(error) CT_REFUSE(error, "%s: a required argument is null", __func__)
#define CT_NO_MEMORY(error, ...) \
  ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for " __VA_ARGS__)

/* The first member of every definition and of all options, set by their default. */
enum { CT_DEF_COOKIE = 0x63745f64 };

/* Refuse options whose cookie shows that they do not start from `standard`, their default. */
ct_status ct_check_options(int32_t cookie, const char *standard, ct_error *error);

/** Name the part of a scene to which a status other than CT_OK belongs; returns the status. */
ct_status ct_blame(ct_error *error, ct_status status, ct_scene_part part, int32_t number);

/* Append to an error's text. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void ct_error_add(ct_error *error, const char *format, ...);

#endif
