#include "history.h"

#include "../base/error.h"

#include <math.h>

ct_status ct_history_check(const ct_history *history, ct_error *error)
{
  if (history == NULL || history->count < 0 ||
      (history->count > 0 && (history->time == NULL || history->value == NULL)))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "history: null argument");
  for (int32_t i = 0; i < history->count; i++) {
    if (!isfinite(history->time[i]) || !isfinite(history->value[i]))
      return ct_fail(error, CT_INVALID, (ct_place){-1, -1, i}, "history: point %d is not finite",
                     (int)i);
    if (i > 0 && history->time[i] < history->time[i - 1])
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, i},
                     "history: time %g of point %d comes after %g", history->time[i], (int)i,
                     history->time[i - 1]);
  }
  return CT_OK;
}

double ct_history_value(const ct_history *history, double time)
{
  int32_t count = history->count, low = 0, high = count;
  if (count == 0) return 1.0;
  // -- Number of points that are not after the time
  while (low < high) {
    int32_t middle = low + (high - low) / 2;
    if (history->time[middle] <= time) low = middle + 1;
    else high = middle;
  }
  if (low == 0) return history->value[0];
  if (low == count) return history->value[count - 1];
  // -- On the line between two points (eq:history)
  double t0 = history->time[low - 1], t1 = history->time[low], share = (time - t0) / (t1 - t0);
  return (1.0 - share) * history->value[low - 1] + share * history->value[low];
}
