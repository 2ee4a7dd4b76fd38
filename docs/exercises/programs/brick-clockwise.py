"""Area and volume of a cube from its sides: find the error."""

import numpy as np

NODES = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float
)
SIDES = (
    (3, 2, 1, 0),  # z = 0
    (4, 7, 6, 5),  # z = 1
    (0, 1, 5, 4),  # y = 0
    (2, 3, 7, 6),  # y = 1
    (3, 0, 4, 7),  # x = 0
    (1, 2, 6, 5),  # x = 1
)


def area_vector(side):
    """Normal times area of a plane side: half the product of its diagonals."""
    a, b, c, d = NODES[list(side)]
    return np.cross(c - a, d - b) / 2


if __name__ == "__main__":
    vectors = np.array([area_vector(side) for side in SIDES])
    middles = np.array([NODES[list(side)].mean(axis=0) for side in SIDES])
    print("area", np.linalg.norm(vectors, axis=1).sum())
    print("volume", (vectors * middles).sum() / 3)
