"""Answers of the exercises of the chapter on integrators."""

import numpy as np


def largest_root(name, x):
    """Of one step with x = ω²Δt², from the polynomials of the page."""
    if name == "noh_bathe":
        t1, t2 = 0.6, 0.4
        trace, det = 2 - x + t1**2 * t2 * x * x / 2, 1 - (2 * t1 - 1) * t2**2 * x * x / 4
        return np.abs(np.roots([1, -trace, det])).max()
    if name == "chung_lee":
        r = 1.02
        return np.abs(np.roots([1, r * x - 2, 1 - 2 * (r - 1) * x, (r - 1) * x])).max()
    phi = 2 / 1.8 if name == "tchamwa_wielgosz" else 1.0
    return np.abs(np.linalg.eigvals([[1 - phi * x, 1], [-x, 1]])).max()


def test_integrator_limits_of(says):
    limits = []
    for name in ("central", "chung_lee", "tchamwa_wielgosz", "noh_bathe"):
        w = np.arange(1.0, 4.0, 5e-4)
        stable = np.array([largest_root(name, v * v) < 1 + 1e-7 for v in w])
        limits.append(w[stable].max())
    exact = [2, 2 / np.sqrt(4 * 1.02 - 3), 2 / np.sqrt(4 / 1.8 - 1), 2 / np.sqrt(0.4 * 0.8)]
    assert np.allclose(limits, exact, atol=1e-3)
    says("2", *(f"{v:.3f}" for v in exact[1:]), f"{exact[3] / 2:.3f}")
    says(*(f"{100 * (2 / v - 1):.0f} %" for v in (exact[1], exact[2], exact[3] / 2)))


def test_integrator_rounds(says):
    def rounds(n, probability):
        j = 1
        while 1.648 * np.sqrt(n) * np.exp(-(2 * j - 1) * np.sqrt(0.06)) > probability:
            j += 1
        return j

    says(str(rounds(3e6, 1e-12)), str(rounds(3e6, 1e-3)))
    assert rounds(3e7, 1e-12) - rounds(3e6, 1e-12) in (2, 3)
