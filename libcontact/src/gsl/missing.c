#include "../base/error.h"

#include <libcontact/series.h>

/* libcontact-gsl without GSL: its call refuses. */

ct_status ct_exact_plates_series(size_t n, const double *x, const double *z, const double *t,
                                 double nu, size_t branches, double *fields, size_t *bad,
                                 ct_error *error)
{
  (void)x, (void)z, (void)t, (void)nu, (void)branches, (void)fields;
  if (bad != NULL) *bad = n;
  return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                 "libcontact was built without GSL, so it can't sum the modal series");
}
