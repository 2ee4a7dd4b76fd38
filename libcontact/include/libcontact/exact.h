/* The exact solution of the impact of two thick plates, a reference for computed results.
 * Threads: every call at any time. */
#ifndef LIBCONTACT_EXACT_H
#define LIBCONTACT_EXACT_H

#include <libcontact/base.h>

CT_BEGIN_DECLS

/**
 * Speeds of the shear wave and of the Rayleigh wave divided by the speed c1 of the dilatational
 * wave (:eq:`exact-kappa`, :eq:`exact-rayleigh-cubic`). Either pointer may be null.
 *
 * ``nu`` is Poisson's ratio in (0, 0.49]. Errors: ``CT_ERROR_ARGUMENT`` for another ``nu``.
 */
CT_API ct_status ct_exact_speeds(double nu, double *c2, double *c_r, ct_error *error);

/**
 * Closed form of the longitudinal impact of two thick plates at ``n`` points (:eq:`exact-sum`):
 * plane strain; the plate 0 < x < ``length``, -1 < z < 1 moves with v_x = -v0 and meets its mirror
 * image on x = 0 at t = 0.
 *
 * ``x``, ``z`` and ``length`` are in half thicknesses d, ``t`` is in d/c1; x, z, t have shape (n,).
 * ``length`` may be ``INFINITY``. ``nu`` is Poisson's ratio in (0, 0.49]. ``fields`` has shape (n,
 * 5), written in the order sigma_x, sigma_z, tau_xz, v_x, v_z and dimensionless as in
 * :eq:`exact-units`: stresses times c1/(Lambda v0), velocities divided by v0. On a wave front the
 * result is the value behind it; v_z is infinite on a free face at x = c_R t.
 *
 * Errors: ``CT_ERROR_ARGUMENT`` for x < 0, \|z\| > 1, t < 0, t >= 2, t + x >= 2 length, x > length,
 * a NaN, another ``nu`` or a null pointer. All points are checked before any is computed, so
 * ``fields`` is not written after an error. ``bad`` (may be null) then has the index of the first
 * invalid point, or ``n`` if ``nu`` or ``length`` is invalid, and ``error`` gives the reason.
 */
CT_API ct_status ct_exact_plates(size_t n, const double *x, const double *z, const double *t,
                                 double nu, double length, double *fields, size_t *bad,
                                 ct_error *error);

CT_END_DECLS

#endif
