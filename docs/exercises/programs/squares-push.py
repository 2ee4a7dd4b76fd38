"""The contact force of a row of squares, from the gaps of its nodes: find the error."""

import numpy as np

GAUSS = 1 / np.sqrt(3)
NEAR, FAR = (1 + GAUSS) / 2, (1 - GAUSS) / 2


def energy(gap, penalty, h):
    """Energy of the penalty: two Gauss points on each edge."""
    points = [one * gap[:-1] + other * gap[1:] for one, other in ((NEAR, FAR), (FAR, NEAR))]
    return sum((penalty / 2 * np.minimum(0, point) ** 2 * h / 2).sum() for point in points)


def push(gap, penalty, h):
    """Nodal forces of the penalty from nodal gaps."""
    forces = np.zeros_like(gap)
    for one, other in ((NEAR, FAR), (FAR, NEAR)):
        pressure = penalty * np.maximum(0, -(one * gap[:-1] + other * gap[1:]))
        forces[:-1] += other * pressure * h / 2
        forces[1:] += one * pressure * h / 2
    return forces


def difference(gap, penalty, h, step=1e-6):
    """Minus the derivative of the energy, by central differences."""
    moved = step * np.eye(len(gap))
    return np.array(
        [(energy(gap - m, penalty, h) - energy(gap + m, penalty, h)) / (2 * step) for m in moved]
    )


if __name__ == "__main__":
    print("uniform overlap:", push(-np.ones(4), 1.0, 1.0), "exact: 0.5 1 1 0.5")
    gap = -np.array([1.0, 3.0, 2.0, 5.0])
    print(
        "sum of the forces:", push(gap, 1.0, 1.0).sum(), "exact:", -(gap[:-1] + gap[1:]).sum() / 2
    )
    exact = difference(gap, 1.0, 1.0)
    print("largest error:", np.abs(push(gap, 1.0, 1.0) / exact - 1).max())
