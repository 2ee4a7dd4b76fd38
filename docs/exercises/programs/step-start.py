"""An oscillator of frequency 1 from rest at u = 1, to the time 10: find the error."""

import numpy as np


def oscillate(steps, end=10.0):
    """Displacement at the end."""
    dt = end / steps
    u, v = 1.0, 0.0
    for _ in range(steps):
        v -= dt * u
        u += dt * v
    return u


if __name__ == "__main__":
    for steps in (100, 200, 400):
        print(f"{steps} steps: error {abs(oscillate(steps) - np.cos(10.0)):.5f}")
