/* Factors that change with time. */
#include "../../libcontact/src/base/amplitude.h"
#include "bodies.h"

/* Before, on and after its points, and at a jump (eq:amplitude). */
int main(void)
{
  static const double time[5] = {0.0, 1.0, 1.0, 3.0, 4.0}, value[5] = {0.0, 2.0, 5.0, 5.0, -1.0};
  static const double at[][2] = {{-1.0, 0.0}, {0.0, 0.0}, {0.25, 0.5}, {1.0, 5.0},
                                 {2.0, 5.0},  {3.5, 2.0}, {4.0, -1.0}, {100.0, -1.0}};
  ct_amplitude amplitude = {5, time, value}, none = {0, NULL, NULL}, bad = {5, value, time};
  ct_error e = {0};
  tap_ok(ct_amplitude_check(&amplitude, &e) == CT_OK && ct_amplitude_check(&none, &e) == CT_OK,
         "an amplitude with a jump, and none, are accepted");
  for (size_t i = 0; i < sizeof at / sizeof at[0]; i++)
    tap_close(ct_amplitude_value(&amplitude, at[i][0]), at[i][1], 1e-15, "at t = %g", at[i][0]);
  tap_close(nextafter(ct_amplitude_value(&amplitude, nextafter(1.0, 0.0)), 3.0), 2.0, 1e-14,
            "just before the jump the value is on the line");
  tap_ok(ct_amplitude_value(&none, 7.0) == 1.0, "without points the factor is 1");
  tap_ok(ct_amplitude_check(&bad, &e) == CT_ERROR_ARGUMENT && e.point == 4,
         "times that descend: %s", e.text);
  static const double nan_time[2] = {0.0, NAN};
  bad = (ct_amplitude){2, nan_time, value};
  tap_ok(ct_amplitude_check(&bad, &e) == CT_INVALID && e.point == 1, "NaN: %s", e.text);
  bad = (ct_amplitude){2, NULL, value};
  tap_ok(ct_amplitude_check(&bad, &e) == CT_ERROR_ARGUMENT &&
             ct_amplitude_check(NULL, &e) == CT_ERROR_ARGUMENT,
         "missing: %s", e.text);
  return tap_done();
}
