"""Answers of the exercises of the chapter on rigid bodies."""

import numpy as np


def test_rigid_quarter(says):
    a = np.cos(np.pi / 4)
    b, r = np.array([0, 0, np.sin(np.pi / 4)]), np.array([1.0, 0, 0])
    moved = 2 * a * np.cross(b, r) + 2 * np.cross(b, np.cross(b, r))
    assert np.allclose(r + moved, [0, 1, 0])
    says(f"{a:.4f}", "180")


def test_rigid_percussion(says):
    """A rod of many masses, turned by a small impulse at its end."""
    x = np.linspace(-0.5, 0.5, 200_001)
    m = np.full(len(x), 1 / len(x))
    velocity = 1 / m.sum() + 0.5 / (m @ x**2) * x
    still = x[np.abs(velocity).argmin()]
    says(f"{velocity[-1]:.0f}")
    assert abs(still + 1 / 6) < 1e-4 and abs(0.5 - still - 2 / 3) < 1e-4
    says("two thirds")
