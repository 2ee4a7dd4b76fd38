/* The exact solution of the impact of two thick plates, to compare results with.
 * Threads: every call at any time. */
#ifndef LIBCONTACT_EXACT_H
#define LIBCONTACT_EXACT_H

#include <libcontact/base.h>

CT_BEGIN_DECLS

/**
 * The fields of the impact of two thick plates at one point, in the numbers of :eq:`exact-units`:
 * stresses times c1/(Lambda v0), velocities over v0.
 */
typedef struct ct_exact_field {
  /** Longitudinal normal stress; -(1 - nu)/nu behind the plane front. */
  double sigma_x;
  /** Transversal normal stress; -1 behind the plane front. */
  double sigma_z;
  /** Shear stress; odd in z. */
  double tau_xz;
  /** Longitudinal velocity; -1 ahead of the plane front. */
  double v_x;
  /** Transversal velocity; odd in z, positive or negative infinity on a free face at x = c_R t. */
  double v_z;
} ct_exact_field;

/**
 * Speeds of the shear wave and of the Rayleigh wave over the speed c1 of the dilatational wave
 * (:eq:`exact-kappa`, :eq:`exact-rayleigh-cubic`). Either pointer may be null.
 *
 * ``nu`` is Poisson's ratio in (0, 0.49]. Errors: ``CT_ERROR_ARGUMENT`` for another ``nu``.
 */
CT_API ct_status ct_exact_speeds(double nu, double *c2, double *c_r);

/**
 * Closed form of the longitudinal impact of two thick plates at one point (:eq:`exact-sum`): plane
 * strain, the plate 0 < x < ``length``, -1 < z < 1, that comes at v_x = -v0 and meets its mirror
 * image on x = 0 at t = 0.
 *
 * ``x``, ``z`` and ``length`` are in half thicknesses d, ``t`` is in d/c1. ``length`` may be
 * ``INFINITY``. ``nu`` is Poisson's ratio in (0, 0.49]. On a front the answer is the value behind
 * it. The call computes the tables of ``nu`` anew; use :c:func:`ct_exact_plates_array` for many
 * points.
 *
 * Errors: ``CT_ERROR_ARGUMENT`` for x < 0, \|z\| > 1, t < 0, t >= 2, t + x >= 2 length, x > length,
 * a NaN, another
 * ``nu`` or a null ``out``; then ``out`` is not written.
 */
CT_API ct_status ct_exact_plates(double x, double z, double t, double nu, double length,
                                 ct_exact_field *out);

/**
 * The closed form at ``n`` points (:eq:`exact-sum`), the same bits as :c:func:`ct_exact_plates` at
 * each.
 *
 * ``x``, ``z``, ``t`` have shape (n,); ``fields`` has shape (n, 5), written in the order sigma_x,
 * sigma_z, tau_xz, v_x, v_z. All points are looked at before any is computed: with
 * ``CT_ERROR_ARGUMENT`` nothing is written to
 * ``fields``, ``bad`` (may be null) has the index of the first refused point, or ``n`` when ``nu``
 * or ``length`` is at fault, and ``error`` names the reason.
 */
CT_API ct_status ct_exact_plates_array(size_t n, const double *x, const double *z, const double *t,
                                       double nu, double length, double *fields, size_t *bad,
                                       ct_error *error);

CT_END_DECLS

#endif
