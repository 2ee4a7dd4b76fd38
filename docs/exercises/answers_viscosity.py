"""Answers of the exercises of the chapter on bulk viscosity."""

import numpy as np


def limit(Q):
    """Largest ωΔt/2 of the cube, by the roots of one step; in units of h/c₁ ω = 2, d = 12 Q."""
    courant = np.linspace(0.01, 1.0, 20_000)
    d, x = 12 * Q * courant, 2 * courant
    stable = (np.abs(1 - d) <= 1) & (np.abs(2 - d - x * x) <= 2 - d + 1e-12)
    return courant[stable].max()


def test_viscosity_step(says):
    for Q in (0.1, 1.0):
        assert abs(limit(Q) - 1 / (3 * Q + np.sqrt(9 * Q * Q + 1))) < 1e-4
        says(f"{limit(Q):.3f}")
    says(f"{1 / 6:.3f}")


def test_viscosity_shock(says):
    c1, linear, quadratic = 6020.0, 0.06, 1.2
    for v in (1.0, 100.0):
        x = v / 4
        assert x < 0.06 * c1 / (2 * quadratic**2)
        parts = linear * x / v, quadratic**2 * x**2 / (c1 * v)
        says(
            f"{100 * parts[0]:.1f} %",
            f"{parts[1] * 1e5:.1f}·10⁻⁵" if v == 1 else f"{100 * parts[1]:.2f} %",
        )
