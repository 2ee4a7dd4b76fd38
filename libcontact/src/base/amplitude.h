#ifndef CT_SRC_AMPLITUDE_H
#define CT_SRC_AMPLITUDE_H

#include <libcontact/base.h>

#include "memory.h"

/* ``CT_ERROR_ARGUMENT`` if arrays are missing or times descend, ``CT_INVALID`` if a number is not
 * finite; `error` names the point. */
ct_status ct_amplitude_check(const ct_amplitude *amplitude, ct_error *error);

/* The same, then replace its arrays by copies from a pool, which may fail. */
ct_status ct_amplitude_copy(ct_pool *pool, ct_amplitude *amplitude, ct_error *error);
/* The factor at a time, eq:amplitude. */
double ct_amplitude_value(const ct_amplitude *amplitude, double time);

#endif
