"""Two bars collide end to end: find the error."""

import numpy as np


def ramp(gap_free, gap_before, W, penalty):
    """Contact force, from the gap without it and the gap one step before."""
    return max(0.0, -gap_free - min(gap_before, 0.0)) / (2.0 / penalty + W)


def impact(elements=100, courant=1.0, travel=3.0, penalty=1e3):
    """Equal bars of length, stiffness, density and speed 1: lowest stress, masses, velocities."""
    h = 1.0 / elements
    dt = courant * h
    last, first = elements, elements + 1  # last node of the left bar, first of the right
    mass = np.full(2 * elements + 2, h)
    u, v = np.zeros_like(mass), np.repeat([1.0, -1.0], elements + 1)
    W = dt**2 * (1.0 / mass[last] + 1.0 / mass[first])
    before, lowest = 0.0, 0.0
    for _ in range(round(travel / dt)):
        stress = np.diff(u) / h
        stress[last] = 0.0  # between the bars there is no element
        lowest = min(lowest, stress.min())
        force = np.diff(stress, prepend=0.0, append=0.0)
        free = u + dt * (v + dt * force / mass)
        gap, gap_free = u[first] - u[last], free[first] - free[last]
        contact = ramp(gap_free, before, W, penalty)
        before = gap
        force[last] -= contact
        force[first] += contact
        v += dt * force / mass
        u += dt * v
    return lowest, mass, v


if __name__ == "__main__":
    lowest, mass, v = impact()
    left, right = np.split(v, 2)
    print(f"lowest stress {lowest:.3f}, mean velocity of the right bar {right.mean():.4f}")
