"""Answers of the exercises of the chapter on gravity."""

import numpy as np


def test_gravity_laid(says):
    """The lowest mode of a bar on a floor, by its elements, against the triangular wave."""
    c, L, n = 3500.0, 1.0, 400
    K = 2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    K[-1, -1] = 1
    mass = np.r_[np.ones(n - 1), 0.5]
    lowest = np.sqrt(np.linalg.eigvalsh(K / np.sqrt(np.outer(mass, mass)))[0]) * c * n / L
    assert abs(2 * np.pi / lowest / (4 * L / c) - 1) < 1e-4
    says(f"{4 * L / c * 1e3:.2f}", "2", f"{L / (0.01 * c) * 1e3:.1f}", f"{0.25 / 0.01:.0f}")


def test_gravity_fall(says):
    g, dt = 9.81, 1e-3
    y, v, euler, w = 0.0, -dt / 2 * g, 0.0, 0.0
    for _ in range(1000):
        v += dt * g
        y += dt * v
        euler += dt * w
        w += dt * g
    total = v * (v + dt * g) / 2 - g * y
    says(f"{y:.3f}", f"{total * 1e5:.2f}·10⁻⁵", f"{euler:.4f}")
