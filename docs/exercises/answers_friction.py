"""Answers of the exercises of the chapter on friction."""

import numpy as np


def test_friction_slope(says):
    slope, mu = np.radians(20), 0.3
    begins = np.arctan(mu)
    held = 100 * np.sin(begins)
    says(f"{np.tan(slope):.3f}", f"{9.81 * (np.sin(slope) - mu * np.cos(slope)):.3f}")
    says(f"{np.degrees(begins):.1f}", f"{held:.1f}", f"{held / 1e6 * 1e3:.4f}")


def leaves(mu, e, steps=100_000):
    """Tangential velocity after a normal force that acts for a while, with Coulomb's law in each step."""
    tangential, impulse = 2.0, (1 + e) / steps
    for _ in range(steps):
        tangential = max(0.0, tangential - mu * impulse)
    return tangential


def test_friction_throw(says):
    says(f"{leaves(0.3, 1):.1f}", f"{leaves(0.3, 0):.1f}")
    assert leaves(0.999, 1) > 0 and leaves(1.001, 1) == 0
    assert leaves(1.999, 0) > 0 and leaves(2.001, 0) == 0
    says("1", "2")
