"""Two bars collide end to end: finite elements, lumped masses, the leapfrog, and contact, with numpy alone."""

import numpy as np
from wall import ramp


def impact(elements=100, courant=1.0, travel=3.0, penalty=1e3, controlled=True):
    """Bars of length, stiffness, density and speed 1: times, stresses, forces, last velocities."""
    h = 1.0 / elements
    dt = courant * h  # (eq:week-courant)
    last, first = elements, elements + 1  # last node of the left bar, first of the right
    mass = np.full(2 * elements + 2, h)
    mass[[0, last, first, -1]] = h / 2.0
    u, v = np.zeros_like(mass), np.repeat([1.0, -1.0], elements + 1)
    W = dt**2 * (1.0 / mass[last] + 1.0 / mass[first])  # (eq:week-two)
    before, times, stresses, forces = 0.0, [], [], []
    for n in range(round(travel / dt)):
        stress = np.diff(u) / h
        stress[last] = 0.0  # between the bars there is no element
        force = np.diff(stress, prepend=0.0, append=0.0)  # (eq:week-element)
        free = u + dt * (v + dt * force / mass)
        gap, gap_free = u[first] - u[last], free[first] - free[last]
        if controlled:
            contact = ramp(gap_free, before, W, penalty)
        else:
            contact = penalty * max(0.0, -gap)
        before = gap
        times.append(n * dt), stresses.append(stress), forces.append(contact)
        force[last] -= contact
        force[first] += contact
        v += dt * force / mass
        u += dt * v
    return np.array(times), np.array(stresses), np.array(forces), v


if __name__ == "__main__":
    for courant in (1.0, 0.5):
        times, stresses, forces, v = impact(courant=courant)
        print(f"Courant number {courant}:")
        print(f"  contact force {forces[times < 1.9].mean():.4f}, by hand 1")
        print(f"  contact lasts {times[forces > 0].max():.3f}, by hand 2")
        print(f"  lowest stress {stresses.min():.4f}, by hand -1")
        left, right = np.split(v, 2)
        print(
            f"  mean velocities afterwards {left.mean():.4f} and {right.mean():.4f}, by hand -1 and 1"
        )
