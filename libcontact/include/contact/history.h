#ifndef CONTACT_HISTORY_H
#define CONTACT_HISTORY_H

#include <contact/status.h>

CT_BEGIN_DECLS

/** A factor that changes with time: a line through given points, :eq:`history`; constant before the
 * first and after the last. */
typedef struct ct_history {
  /** Number of points; 0: the factor is 1 at all times. */
  int32_t count;
  /** Times [time], not descending, shape (count). Two equal times make a jump; at the jump the
   * later value holds. */
  const double *time;
  /** Values at these times, shape (count). */
  const double *value;
} ct_history;

/**
 * ``CT_ERROR_ARGUMENT`` when arrays are missing or times descend, ``CT_INVALID`` when a number is
 * not finite; `error` names the point.
 */
CT_API ct_status ct_history_check(const ct_history *history, ct_error *error);

/** The factor at a time, :eq:`history`. */
CT_API double ct_history_value(const ct_history *history, double time);

CT_END_DECLS

#endif
