"""A square with eight nodes, each on a spring: find the error."""

import numpy as np

CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])


def shape(xi, eta):
    x, y = (CORNERS * (xi, eta)).T
    corners = (1 + x) * (1 + y) * (x + y - 1) / 4
    middles = [(1 - xi**2) * (1 + s * eta) / 2 for s in (-1, 1)]
    return np.array([*corners, *middles, *((1 - eta**2) * (1 + s * xi) / 2 for s in (-1, 1))])


def masses():
    """Of the eight nodes, for the density 1, with 3 x 3 Gauss points."""
    x, w = np.polynomial.legendre.leggauss(3)
    N = np.array([shape(a, b) for a in x for b in x])
    weights = np.outer(w, w).ravel()
    return weights @ N


def largest(u, steps=600, dt=0.1):
    """Largest displacement in a number of steps, from rest; each spring is an integral of u."""
    m, v = masses(), np.zeros(8)
    k = np.array([0.1] * 4 + [0.9] * 4)
    for _ in range(steps):
        v += -dt * k * u / m
        u = u + dt * v
    return np.abs(u).max()


if __name__ == "__main__":
    print("masses:", masses().round(4), "sum:", masses().sum().round(12))
    print(f"corners against mid-sides: {largest(np.array([1.0] * 4 + [-1.0] * 4)):.3g}")
