"""Answers of the exercises of the chapter on obstacles."""

import numpy as np


def test_obstacle_gaps(says):
    point = np.array([3.0, 4.0, 7.0])
    for axis in (2, 0):
        radial = np.delete(point, axis)
        gap = np.linalg.norm(radial) - 2
        says(f"{gap:.4g}", *(f"{n:.3g}" for n in radial / np.linalg.norm(radial)))


def test_obstacle_hertz(says):
    E, nu, R, depth = 210e9, 0.3, 0.01, 10e-6
    stiff = E / (1 - nu**2)
    force, a = 4 / 3 * stiff * np.sqrt(R * depth**3), np.sqrt(R * depth)
    pressure, h = force / (np.pi * a**2), 2 * a / 8
    modulus = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    overlap = pressure * h / (40 * modulus)
    says(f"{stiff / 1e9:.1f}", f"{force:.0f}", f"{a * 1e3:.3f}", f"{h * 1e3:.3f}")
    says(f"{pressure / 1e6:.0f}", f"{modulus / 1e9:.1f}", f"{overlap * 1e6:.4f}")
    says(f"{100 * overlap / depth:.2f}")
    # The force is the work over the depth, and the area that of a cap of the sphere cut at half the depth.
    assert abs(np.pi * a**2 / (2 * np.pi * R * depth / 2) - 1) < 1e-12
