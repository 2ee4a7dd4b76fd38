#include "amplitude.h"

#include "error.h"

#include <math.h>

ct_status ct_amplitude_check(const ct_amplitude *amplitude, ct_error *error)
{
  if (amplitude == NULL || amplitude->count < 0 ||
      (amplitude->count > 0 && (amplitude->time == NULL || amplitude->value == NULL)))
    return CT_REFUSE_NULL(error);
  for (int32_t i = 0; i < amplitude->count; i++) {
    if (!isfinite(amplitude->time[i]) || !isfinite(amplitude->value[i]))
      return ct_fail(error, CT_INVALID, (ct_place){-1, -1, i}, "amplitude: point %d is not finite",
                     (int)i);
    if (i > 0 && amplitude->time[i] < amplitude->time[i - 1])
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, i},
                     "amplitude: time %g of point %d comes after %g", amplitude->time[i], (int)i,
                     amplitude->time[i - 1]);
  }
  return CT_OK;
}

ct_status ct_amplitude_copy(ct_pool *pool, ct_amplitude *amplitude, ct_error *error)
{
  ct_status status = ct_amplitude_check(amplitude, error);
  if (status != CT_OK) return status;
  size_t bytes = (size_t)amplitude->count * sizeof(double);
  amplitude->time = ct_pool_copy(pool, amplitude->time, bytes);
  amplitude->value = ct_pool_copy(pool, amplitude->value, bytes);
  return CT_OK;
}

double ct_amplitude_value(const ct_amplitude *amplitude, double time)
{
  int32_t count = amplitude->count, low = 0, high = count;
  if (count == 0) return 1.0;
  // -- Number of points that are not after the time
  while (low < high) {
    int32_t middle = low + (high - low) / 2;
    if (amplitude->time[middle] <= time) low = middle + 1;
    else high = middle;
  }
  if (low == 0) return amplitude->value[0];
  if (low == count) return amplitude->value[count - 1];
  // -- On the line between two points (eq:amplitude)
  double t0 = amplitude->time[low - 1], t1 = amplitude->time[low], share = (time - t0) / (t1 - t0);
  return (1.0 - share) * amplitude->value[low - 1] + share * amplitude->value[low];
}
