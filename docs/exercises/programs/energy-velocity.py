"""The total energy of an oscillator in each step: find the error."""

import numpy as np


def energies(steps=24, dt=1.0):
    """Total energy of a unit mass on a unit spring, from rest at u = 1."""
    u, before, found = 1.0, dt / 2, []
    for _ in range(steps):
        after = before - dt * u
        kinetic = ((before + after) / 2) ** 2 / 2
        found.append(kinetic + u**2 / 2)
        before, u = after, u + dt * after
    return np.array(found)


if __name__ == "__main__":
    print("total energy:", energies(6).round(4))
