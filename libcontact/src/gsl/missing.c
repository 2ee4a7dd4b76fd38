#include "../base/error.h"

#include <libcontact/series.h>

/* libcontact-gsl as it is built without GSL: every call refuses. */

static ct_status refuse(ct_error *error)
{
  return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                 "libcontact was built without GSL, so it can't sum the modal series");
}

ct_status ct_exact_series_create(double nu, size_t branches, double reach, ct_exact_series **out,
                                 ct_error *error)
{
  (void)nu, (void)branches, (void)reach;
  if (out != NULL) *out = NULL;
  return refuse(error);
}

ct_status ct_exact_series_fields(const ct_exact_series *series, size_t n, const double *x,
                                 const double *z, const double *t, double *fields, size_t *bad,
                                 ct_error *error)
{
  (void)series, (void)x, (void)z, (void)t, (void)fields;
  if (bad != NULL) *bad = n;
  return refuse(error);
}

void ct_exact_series_free(ct_exact_series *series) { (void)series; }

ct_status ct_exact_plates_series(size_t n, const double *x, const double *z, const double *t,
                                 double nu, size_t branches, double *fields, size_t *bad,
                                 ct_error *error)
{
  (void)x, (void)z, (void)t, (void)nu, (void)branches, (void)fields;
  if (bad != NULL) *bad = n;
  return refuse(error);
}
