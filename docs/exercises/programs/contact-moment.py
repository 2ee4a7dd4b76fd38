"""A point pulled to the square from -1 to 1: forces on both, and their moment: find the error."""

import numpy as np

PENALTY = 3.0


def forces(point):
    """Closest point of the square and the force on the point; the square gets the opposite one."""
    closest = np.clip(point, -1, 1)
    d = closest - point
    axis = np.abs(point).argmax()  # of the side that is nearest
    normal = np.zeros(2)
    normal[axis] = np.sign(d[axis])
    F = PENALTY * np.linalg.norm(d) * normal
    return closest, F


def moment(point):
    """Moment of both forces about the origin."""
    closest, F = forces(point)
    return point[0] * F[1] - point[1] * F[0] - (closest[0] * F[1] - closest[1] * F[0])


if __name__ == "__main__":
    for point in np.array([[1.3, 0.2], [0.5, -1.2], [1.3, 1.1583]]):
        print(f"point at {point}: moment {moment(point):.3f}")
