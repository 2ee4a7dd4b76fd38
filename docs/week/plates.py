"""The paper's two plates with numpy alone: bilinear elements in plane strain, contact at Gauss points, the leapfrog."""

import numpy as np

D, YOUNG, NU, DENSITY, SPEED = 2.5, 2.1e5, 0.3, 7.8e-9, 1000.0  # mm, MPa, t/mm³, mm/s
MU = YOUNG / (2 * (1 + NU))
LAMBDA = 2 * MU * NU / (1 - 2 * NU)
C1 = np.sqrt((LAMBDA + 2 * MU) / DENSITY)
GAUSS = 1 / np.sqrt(3)
CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])


def strain_matrix(xi, eta, h):
    """B of a square of edge h: strains (xx, zz, 2xz) = B u, u = (ux, uz) of each corner."""
    slope = CORNERS * (1 + CORNERS[:, ::-1] * (eta, xi)) / (2 * h)  # (eq:week-b)
    B = np.zeros((3, 8))
    B[0, 0::2] = B[2, 1::2] = slope[:, 0]
    B[1, 1::2] = B[2, 0::2] = slope[:, 1]
    return B


# Hooke's law (eq:week-hooke)
ELASTIC = np.array([[LAMBDA + 2 * MU, LAMBDA, 0], [LAMBDA, LAMBDA + 2 * MU, 0], [0, 0, MU]])


def stiffness(h):
    """K of a square of edge h, for a unit of thickness: the sum over four Gauss points of BᵀCB h²/4."""
    points = [strain_matrix(*point, h) for point in CORNERS * GAUSS]
    return sum(B.T @ ELASTIC @ B for B in points) * h**2 / 4


def corners(cells):
    """Node numbers of all elements (cells², 4), in a grid of nodes with x slow and z fast."""
    node = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    sides = node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]
    return np.stack(sides, -1).reshape(-1, 4)


def internal(u, elements, K):
    """Forces -K u of all elements, summed at the nodes."""
    f = u[elements].reshape(-1, 8) @ -K
    places, n = elements.ravel(), len(u)
    return np.stack([np.bincount(places, f[:, i::2].ravel(), n) for i in (0, 1)], -1)


def push(gap, penalty, h):
    """Nodal forces of the penalty from nodal gaps: two Gauss points on each edge."""
    near, far = (1 + GAUSS) / 2, (1 - GAUSS) / 2
    forces = np.zeros_like(gap)
    for one, other in ((near, far), (far, near)):
        pressure = penalty * np.maximum(0, -(one * gap[:-1] + other * gap[1:]))
        forces[:-1] += one * pressure * h / 2
        forces[1:] += other * pressure * h / 2
    return forces


def impact(cells=100, courant=0.125, beta=4.0, end=0.56, wall=False):
    """Displacements (2, nodes, 2) of both plates at c1 t / d = end."""
    h = D / cells
    steps = round(end * cells / courant)
    dt = end * D / C1 / steps
    elements, K = corners(cells), stiffness(h)
    mass = np.bincount(elements.ravel()) * DENSITY * h**2 / 4
    face, axis = np.arange(cells + 1), np.arange(0, (cells + 1) ** 2, cells + 1)
    u, v = np.zeros((2, len(mass), 2)), np.zeros((2, len(mass), 2))
    v[:, :, 0] = -SPEED  # each plate has its own x axis, away from the other plate
    for n in range(steps):
        f = np.array([internal(plate, elements, K) for plate in u])
        # Both faces search on the other one, and each search brings half of the force.
        f[:, face, 0] += push(u[0, face, 0] + u[1, face, 0], beta * YOUNG / h, h)
        a = f / mass[:, None]
        v += dt * a if n else dt / 2 * a
        v[:, axis, 1] = 0  # symmetry: z = 0 stays where it is
        if wall:
            v[:, face, 0] = 0
        u += dt * v
    return u


def centre_stress(u, cells):
    """σxx, σzz, σxz at the centres of the elements, (cells, cells, 3), over Λ v0 / c1."""
    B = strain_matrix(0.0, 0.0, D / cells)
    stress = u[corners(cells)].reshape(-1, 8) @ (ELASTIC @ B).T
    return stress.reshape(cells, cells, 3) * C1 / (LAMBDA * SPEED)


if __name__ == "__main__":
    left, right = impact(cells=50)
    print("both plates have the same motion:", np.array_equal(left, right))
    row = centre_stress(right, 50)[:, 0, 0]
    print(f"plateau {row[10:20].mean():.3f}, by hand {-(1 - NU) / NU:.3f}")
