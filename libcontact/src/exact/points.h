#ifndef CT_SRC_EXACT_POINTS_H
#define CT_SRC_EXACT_POINTS_H

#include <libcontact/base.h>

#include "../base/error.h"

#include <math.h>

/* The points at which a solution of the impact of two plates is asked for. */

/* Why a point of the plate is not answered at a time t >= 0; null when it is. `bound`: the length
 * of the plate, or how far the solution reaches. */
typedef const char *ct_exact_refusal(double x, double z, double t, double bound);

/* Look at all points; refuses the first one that is outside the plate or before the impact, or for
 * which `refusal` has a reason, with its number in `bad`. */
static inline ct_status ct_exact_check(size_t n, const double *x, const double *z, const double *t,
                                       const double *fields, ct_exact_refusal *refusal,
                                       double bound, size_t *bad, ct_error *error)
{
  if (bad != NULL) *bad = n;
  if (n > 0 && (x == NULL || z == NULL || t == NULL || fields == NULL))
    return CT_REFUSE(error, "x, z, t or fields is a null pointer");
  for (size_t i = 0; i < n; i++) {
    const char *reason = isnan(x[i]) || isnan(z[i]) || isnan(t[i]) ? "a coordinate is not a number"
                         : x[i] < 0.0                              ? "x < 0 lies outside the plate"
                         : fabs(z[i]) > 1.0 ? "|z| > 1 lies outside the plate"
                         : t[i] < 0.0       ? "t < 0 is before the impact"
                                            : refusal(x[i], z[i], t[i], bound);
    if (reason == NULL) continue;
    if (bad != NULL) *bad = i;
    return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, (int64_t)i},
                   "point %zu (x = %g, z = %g, t = %g): %s", i, x[i], z[i], t[i], reason);
  }
  return CT_OK;
}

#endif
