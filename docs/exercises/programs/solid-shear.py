"""The stiffness of a square in plane strain: find the error."""

import numpy as np

YOUNG, NU = 1.0, 0.3
MU = YOUNG / (2 * (1 + NU))
LAMBDA = 2 * MU * NU / (1 - 2 * NU)
CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
ELASTIC = np.array([[LAMBDA + 2 * MU, LAMBDA, 0], [LAMBDA, LAMBDA + 2 * MU, 0], [0, 0, 2 * MU]])


def strain_matrix(xi, eta, h):
    """Strains (u_x,x  u_z,z  u_x,z + u_z,x) from (u_x, u_z) of each corner."""
    slope = CORNERS * (1 + CORNERS[:, ::-1] * (eta, xi)) / (2 * h)
    B = np.zeros((3, 8))
    B[0, 0::2] = B[2, 1::2] = slope[:, 0]
    B[1, 1::2] = B[2, 0::2] = slope[:, 1]
    return B


def stiffness(h):
    points = [strain_matrix(*point, h) for point in CORNERS / np.sqrt(3)]
    return sum(B.T @ ELASTIC @ B for B in points) * h**2 / 4


if __name__ == "__main__":
    K = stiffness(1.0)
    print("symmetric:", np.abs(K - K.T).max() < 1e-14)
    print("eigenvalues:", np.linalg.eigvalsh(K).round(3) + 0.0)
