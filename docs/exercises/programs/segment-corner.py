"""The shape functions of a face with eight nodes: find the error."""

import numpy as np

CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
MIDDLES = np.array([[0, -1], [1, 0], [0, 1], [-1, 0]])


def shape(xi):
    """The eight functions at a point of the reference square."""
    x, y = (CORNERS * xi).T
    corner = (1 + x) * (1 + y) * (x + y + 1) / 4
    x, y = (MIDDLES * xi).T
    across = np.where(MIDDLES[:, 0] == 0, y, x)
    along = np.where(MIDDLES[:, 0] == 0, xi[0], xi[1])
    return np.concatenate([corner, (1 - along**2) * (1 + across) / 2])


if __name__ == "__main__":
    table = np.array([shape(node) for node in np.concatenate([CORNERS, MIDDLES])])
    print("at its own node:", table.diagonal())
    print("largest at another node:", np.abs(table - np.diag(table.diagonal())).max())
    print("sum at the centre:", shape(np.zeros(2)).sum())
