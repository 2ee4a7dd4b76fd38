"""Answers of the exercises of the chapter on prescribed paths."""

import numpy as np


def test_motion_smooth(says):
    t = np.linspace(0, 1e-3, 10_001)
    velocity = np.gradient(1e-3 * (1 - np.cos(np.pi * t / 1e-3)) / 2, t)
    says(f"{40.5 * velocity.max():.1f}", given=("40.5",))


def test_motion_drift(says):
    sums = corrected = 0.0
    for n in range(100_000):
        sums += 0.1 * 1.0
        corrected += 0.1 * (((n + 1) * 0.1 - corrected) / 0.1)
    says(f"{abs(sums - 10_000) * 1e8:.1f}·10⁻⁸", "10⁻¹¹")
    assert abs(corrected - 10_000) < 1e-11
