"""A mass meets a wall, with the energy-controlled penalty k = 1: find the error."""

import numpy as np


def rebound(step, start):
    """Speed after the impact of a unit mass of speed 1."""
    gaps, velocity = [start + step, start], -1.0
    while velocity < 0.0 or gaps[-1] < 0.0:
        gap_free = gaps[-1] + step * velocity
        force = max(0.0, -gap_free - min(gaps[-1], 0.0)) / (2.0 + step**2)
        velocity += step * force
        gaps.append(gaps[-1] + step * velocity)
    return velocity


if __name__ == "__main__":
    for step in (0.05, 0.1, 0.2):
        kept = [rebound(step, 1.0 + step * part) for part in np.linspace(0, 1, 200)]
        print(f"steps of {step} / ω: the mass keeps {min(kept):.3f} ... {max(kept):.3f}")
