"""A mass meets a wall, with a force that should not add energy: find the error."""

import numpy as np


def ramp(gap_free, gap_before, W, penalty):
    """Contact force, from the gap without it and the gap one step before."""
    return max(0.0, -gap_free - gap_before) / (2.0 / penalty + W)


def rebound(step, start):
    """Speed after the impact of a unit mass of speed 1, for k = 1 and steps of `step`."""
    before, gap, velocity = start + step, start, -1.0
    while velocity < 0.0 or gap < 0.0:
        velocity += step * ramp(gap + step * velocity, before, step * step, 1.0)
        before, gap = gap, gap + step * velocity
    return velocity


if __name__ == "__main__":
    for step in (0.5, 1.0):
        fastest = max(rebound(step, 1.0 + step * part) for part in np.linspace(0, 1, 400))
        print(f"steps of {step} / ω: the fastest mass leaves with {fastest:.3f} of its speed")
