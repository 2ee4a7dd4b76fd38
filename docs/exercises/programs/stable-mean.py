"""A bar of unequal elements swings, with c = 1: find the error."""

import numpy as np


def step_of(lengths):
    """The step: 0.95 of what is stable."""
    return 0.95 * lengths.mean()


def largest(lengths, end=200.0):
    """Largest displacement of a free bar in a time, after a blow on its left end."""
    mass = np.convolve(lengths, [0.5, 0.5])
    dt = step_of(lengths)
    u, v = np.zeros(len(mass)), np.zeros(len(mass))
    v[0] = 1.0
    most = 0.0
    for _ in range(round(end / dt)):
        v += dt * np.diff(np.diff(u) / lengths, prepend=0.0, append=0.0) / mass
        u += dt * v
        most = max(most, np.abs(u - mass @ u / mass.sum()).max())
    return most


if __name__ == "__main__":
    lengths = np.ones(10)
    lengths[4] = 0.2
    print(f"step {step_of(lengths):.3f}, largest displacement {largest(lengths):.3g}")
