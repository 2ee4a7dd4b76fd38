"""Answers of the exercises of the chapter on the exact solution."""

import cmath

import numpy as np

import libcontact as ct


def test_exact_rayleigh_root(says):
    c2, c_r = ct.exact.speeds(0.3)
    p, kappa = 1 / c_r, 1 / c2
    a = kappa**2 - 2 * p * p
    R = a * a + 4 * p * p * cmath.sqrt(1 - p * p) * cmath.sqrt(kappa**2 - p * p)
    assert abs(R) < 1e-10
    says(f"{p:.3f}")


def test_exact_branch(says):
    x, y = 0.5, 0.3
    kappa = 1 / ct.exact.speeds(0.3).c2
    r = np.hypot(x, y)
    head = np.sqrt(kappa**2 - 1) * y + x  # the path's time at p = -1
    assert abs(head - (0.5 + 0.3 * np.sqrt(2.5))) < 1e-9
    says(f"{r:.3f}", f"{-x / r:.3f}", f"{kappa * r:.3f}", f"{-kappa * x / r:.3f}", f"{head:.3f}")
