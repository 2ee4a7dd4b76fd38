"""Answers of the exercises of the chapter on ties."""

import numpy as np


def test_tie_books(says):
    old, now, new = -0.2, -0.1, 0.05
    force = -(new + old) / 2
    work = force * (new - old) / 2
    before, after = (old**2 + now**2) / 4, (now**2 + new**2) / 4
    assert abs(work - (before - after)) < 1e-15
    says(f"{force:.3f}", f"{work:.6f}", f"{before:.4f}", f"{after:.6f}", f"{new**2 / 4:.6f}")


def test_tie_layer(says):
    """The two conditions, solved as linear equations."""
    for spring, length in ((40.0, 8.0), (3.0, 8.0)):
        k = 2 * np.pi / length
        R, T = np.linalg.solve([[1, 1], [-spring, spring - 1j * k]], [1, spring])
        assert abs(abs(R) - 1 / np.sqrt(1 + (2 * spring / k) ** 2)) < 1e-12
        if spring == 40:
            says(f"{abs(R):.4f}", f"{abs(R) ** 2 * 1e5:.1f}·10⁻⁵")
