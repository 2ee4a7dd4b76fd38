"""The volumes of a row of bricks: find the error."""

import itertools

import numpy as np

CORNERS = np.array(
    [(x, y, z) for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))], float
)


def brick(x):
    """Nodes of a brick of edge 1 that begins at x, as VTK numbers them."""
    return np.array([(x + i, j, k) for k in (0, 1) for j in (0, 1) for i in (0, 1)], float)


def determinant(nodes, xi):
    """Of the Jacobian at a point of the reference cube."""
    factors = 1 + CORNERS * xi
    gradient = CORNERS * np.stack(
        [factors[:, [1, 2]].prod(1), factors[:, [0, 2]].prod(1), factors[:, [0, 1]].prod(1)], 1
    )
    return np.linalg.det(nodes.T @ gradient / 8)


def volume(nodes):
    points = itertools.product((-1 / np.sqrt(3), 1 / np.sqrt(3)), repeat=3)
    return sum(determinant(nodes, np.array(point)) for point in points)


if __name__ == "__main__":
    print("volumes:", np.round([volume(brick(x)) for x in range(4)], 12) + 0.0)
