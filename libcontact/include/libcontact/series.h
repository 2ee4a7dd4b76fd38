/* The modal series of the impact of two plates (GSL), in the add-on library libcontact-gsl.
 * Threads: every call at any time. */
#ifndef LIBCONTACT_SERIES_H
#define LIBCONTACT_SERIES_H

#include <libcontact/base.h>

/* Part of the add-on library libcontact-gsl. Where that was built without GSL, it returns
 * CT_ERROR_UNSUPPORTED. */

CT_BEGIN_DECLS

/**
 * The partial sum of ``branches`` Rayleigh-Lamb branches (:eq:`series-sum`,
 * :eq:`series-dispersion`), 1 to 1000 counted from the lowest, at ``n`` points, in the units and
 * the order of `ct_exact_plates`: sigma_x, sigma_z, tau_xz, v_x, v_z in ``fields``, shape (n, 5).
 * The plate is infinitely long. t may exceed 2, because the series contains all reflections. The
 * modes are tabulated for the largest x + t of the points: 300 branches take about 100 MB up to x +
 * t = 4. Memory and time grow with the square of ``branches`` and, for x + t > 4, in proportion to
 * x + t. Consecutive points with the same x and t share work. At -z the result has the same bits
 * except for signs. The call does not change GSL's error handler.
 *
 * Errors: ``CT_ERROR_MEMORY``; ``CT_ERROR_ARGUMENT`` for x < 0, \|z\| > 1, t < 0, x + t > 100 or a
 * NaN: ``bad`` (may be null) has the index of the first such point and ``fields`` is not written;
 * or for ``nu`` outside (0, 0.49], ``branches`` out of range or a null pointer; ``bad`` is then
 * ``n``.
 */
CT_API ct_status ct_exact_plates_series(size_t n, const double *x, const double *z, const double *t,
                                        double nu, size_t branches, double *fields, size_t *bad,
                                        ct_error *error);

CT_END_DECLS

#endif
