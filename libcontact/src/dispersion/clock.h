#ifndef CT_SRC_DISPERSION_CLOCK_H
#define CT_SRC_DISPERSION_CLOCK_H

#include <libcontact/problem.h>

/* The response of an integrator's steps to an oscillator of the frequency ω_h, with Ω = ω_h Δt: the
 * angle ω Δt, the damping δ Δt, and the slope ∂ω/∂ω_h (eq:dispersion-root, eq:dispersion-slope). */
typedef struct ct_clock {
  double angle, damping, slope;
} ct_clock;

ct_clock ct_clock_of(const ct_integrator *integrator, double Omega);

/* Displacement after a number of steps from u = 0 and Δt v = 1 (eq:front-time). */
double ct_clock_advance(const ct_integrator *integrator, double Omega, int64_t steps);

#endif
