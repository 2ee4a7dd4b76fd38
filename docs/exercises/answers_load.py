"""Answers of the exercises of the chapter on loads."""

import numpy as np
from scipy.integrate import solve_ivp


def test_load_ramp(says):
    for T in (1e-6, 0.5, 1.0):
        run = solve_ivp(
            lambda t, y: [y[1], (2 * np.pi) ** 2 * (min(t / T, 1) - y[0])],
            (0, 3),
            [0, 0],
            max_step=2e-3,
            rtol=1e-8,
        )
        says(f"{run.y[0].max():.4g}" if T == 0.5 else f"{run.y[0].max():.0f}")


def test_load_shell(says):
    """Flat triangles of a coarse and a fine hemisphere with the same border."""
    for rings in (2, 9):
        n = 24
        a = 2 * np.pi * np.arange(n + 1) / n
        total = np.zeros(3)
        for i in range(rings):
            lower, upper = (
                10
                * np.column_stack([np.cos(b) * np.cos(a), np.cos(b) * np.sin(a), np.sin(b) + 0 * a])
                for b in np.pi / 2 * np.array([i, i + 1]) / rings
            )
            for p, q, r, s in zip(lower, lower[1:], upper[1:], upper):
                total += np.cross(r - p, s - q) / 2
        polygon = n / 2 * 100 * np.sin(2 * np.pi / n)
        assert np.allclose(total, [0, 0, polygon])
    says(f"{np.pi * 100:.0f}")
