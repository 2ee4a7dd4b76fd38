"""The waves that one free face of the plate sends out, by Cagniard's path and quadrature: the readable form of the
closed form.

All is in the units of the chapter: c1 = 1, times and lengths in d/c1 and d, slownesses in 1/c1. The fields are s_x,
s_y, s_xy, w_x, w_y.
"""

import numpy as np

GAUSS = np.polynomial.legendre.leggauss(160)


def roots(p, kappa):
    """The two roots with Re > 0; where that is 0, on the real axis, the ones below it."""
    gamma1, gamma2 = np.sqrt(1 - p * p + 0j), np.sqrt(kappa**2 - p * p + 0j)  # (eq:exact-gammas)
    return np.where(gamma1.imag > 0, -gamma1, gamma1), np.where(gamma2.imag > 0, -gamma2, gamma2)


def amplitudes(p, kappa):
    """Amplitudes of the two potentials, times s²."""
    gamma1, gamma2 = roots(p, kappa)
    ell, a = kappa**2 - 2, kappa**2 - 2 * p**2
    load = 2 / (1 - p**2)  # (eq:exact-load)
    R = a**2 + 4 * p**2 * gamma1 * gamma2  # (eq:exact-rayleigh)
    return ell * load * a / R, 2 * ell * load * p * gamma1 / R  # (eq:exact-amplitudes)


def integrands(p, kappa):
    """F_P and F_S of the five fields, shape (2, 5, ...)."""
    gamma1, gamma2 = roots(p, kappa)
    Phi, Psi = amplitudes(p, kappa)
    ell, a = kappa**2 - 2, kappa**2 - 2 * p**2
    # -- Hooke's law and velocity of each wave (eq:exact-integrands)
    dilatation = [
        (ell + 2 * p**2) / ell * Phi,
        a / ell * Phi,
        -2 * p * gamma1 / ell * Phi,
        p * Phi,
        -gamma1 * Phi,
    ]
    shear = [
        -2 * p * gamma2 / ell * Psi,
        2 * p * gamma2 / ell * Psi,
        a / ell * Psi,
        -gamma2 * Psi,
        -p * Psi,
    ]
    return np.array([dilatation, shear])


def path_point(x, y, t, c):
    """Cagniard's point p at the time t of a wave of slowness c."""
    r2 = x * x + y * y
    late = t * t - c * c * r2
    root = 1j * np.sqrt(late) if late >= 0 else -np.sqrt(-late)
    return (x * t + y * root) / r2  # (eq:exact-cagniard)


def primitive(p, wave, kappa):
    """
    J(p), the integral of F from 0 over i to p, away from the branch points; most points near p,
    where a pole may be close.
    """
    v = 0.5 * (1 + GAUSS[0])
    total = 0
    for start, end, power in ((0, 1j, 1), (1j, p, 6)):
        node, slope = end - (end - start) * v**power, power * v ** (power - 1)
        total = total + 0.5 * (end - start) * (integrands(node, kappa)[wave] @ (GAUSS[1] * slope))
    return total


def face(x, y, t, nu=0.3):
    """
    The contributions of the P and the S wave to the five fields at the depth y below the face,
    shape (2, 5).
    """
    kappa = np.sqrt(2 * (1 - nu) / (1 - 2 * nu))
    parts = np.zeros((2, 5))
    for wave, c in enumerate((1.0, kappa)):
        p = path_point(x, y, t, c)
        if p.imag == 0 and p.real < 1:  # not arrived: all roots are real (eq:exact-head)
            continue
        sign = np.array([1, 1, -1, -1, 1])  # even in p, or odd
        parts[wave] = sign * primitive(p, wave, kappa).imag / np.pi  # (eq:exact-face)
    return parts
