/* The modal series of the impact of two plates (GSL), in the add-on library libcontact-gsl.
 * Threads: several threads may ask one series; it does not change after it was made. */
#ifndef LIBCONTACT_SERIES_H
#define LIBCONTACT_SERIES_H

#include <libcontact/base.h>

/* Part of the add-on library libcontact-gsl. Where that was built without GSL, every call returns
 * CT_ERROR_UNSUPPORTED. */

CT_BEGIN_DECLS

/**
 * The modes of one Poisson's ratio and number of branches on a grid of wave numbers: what all
 * points share. Opaque; read only once made, so that threads may share it.
 */
typedef struct ct_exact_series ct_exact_series;

/**
 * Find the Rayleigh-Lamb branches (:eq:`series-dispersion`) and the weights of their modes
 * (:eq:`series-sum`).
 *
 * ``nu`` is Poisson's ratio in (0, 0.49], ``branches`` the number of branches, 1 to 1000, counted
 * from the lowest.
 * ``reach`` in (0, 100] bounds x + t of all points that will be asked: the waves in the integrand
 * are sampled for it. The plan belongs to the caller, who gives it to
 * :c:func:`ct_exact_series_free`. 300 branches take about 100 MB up to a reach of 4; memory and
 * time grow with the square of ``branches``, and beyond that reach in proportion to it. GSL's own
 * error handler is left as it is. Errors: ``CT_ERROR_ARGUMENT``, ``CT_ERROR_MEMORY``; then ``out``
 * gets a null pointer.
 */
CT_API ct_status ct_exact_series_create(double nu, size_t branches, double reach,
                                        ct_exact_series **out, ct_error *error);

/**
 * The partial sum at ``n`` points, in the units and the order of :c:func:`ct_exact_plates_array`:
 * sigma_x, sigma_z, tau_xz, v_x, v_z in ``fields``, shape (n, 5). The plate is infinitely long and
 * t may pass 2: the series knows all reflections. Points that follow each other with the same x and
 * t share work. The same bits at -z, signs apart.
 *
 * Errors: ``CT_ERROR_ARGUMENT`` for x < 0, \|z\| > 1, t < 0, x + t above the reach or a NaN:
 * ``bad`` (may be null) has the index of the first such point and ``fields`` is not written.
 */
CT_API ct_status ct_exact_series_fields(const ct_exact_series *series, size_t n, const double *x,
                                        const double *z, const double *t, double *fields,
                                        size_t *bad, ct_error *error);

/** Free a plan; a null pointer is allowed. */
CT_API void ct_exact_series_free(ct_exact_series *series);

/**
 * The partial sum of ``branches`` Rayleigh-Lamb branches (:eq:`series-sum`) at ``n`` points in one
 * call: create, fields, free. Arguments and errors as there; ``bad`` is ``n`` where no point is at
 * fault.
 */
CT_API ct_status ct_exact_plates_series(size_t n, const double *x, const double *z, const double *t,
                                        double nu, size_t branches, double *fields, size_t *bad,
                                        ct_error *error);

CT_END_DECLS

#endif
