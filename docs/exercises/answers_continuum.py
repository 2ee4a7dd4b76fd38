"""Answers of the exercises of the chapter on contact before any mesh."""

import numpy as np
from scipy.optimize import brentq


def test_continuum_pairs(says):
    pairs = [(0.1, 0), (0, 5), (-0.1, 5), (0.1, 5), (0, -1)]
    right = [g >= 0 and p >= 0 and g * p == 0 for g, p in pairs]
    values = [max(p - 10 * g, 0) for g, p in pairs]
    assert right == [v == p for v, (_, p) in zip(values, pairs)] == [True] * 2 + [False] * 3
    says(*(f"{v:.0f}" for v in values[2:]), "50")


def test_continuum_series(says):
    """Two springs, by their matrix: the unknowns are the gap and the far end, which is at 1."""
    gaps = [brentq(lambda g: (1 + g) + k * min(g, 0), -1, 1) for k in (9, 99)]
    says(f"{gaps[0]:.1f}", f"{1 + gaps[0]:.1f}", "99")
    assert abs(1 + gaps[1] - 0.99) < 1e-12


def test_continuum_barrier_stiffness(says):
    G = 0.1

    def energy(g, k):
        return (1 + g) ** 2 / 2 - k * (g - G) ** 2 * np.log(g / G)

    g = np.linspace(1e-4, G, 200_001)
    says(*(f"{g[energy(g, k).argmin()]:.4f}" for k in (10, 100, 1000)))


def test_continuum_pressures(says):
    x, w = np.polynomial.legendre.leggauss(3)
    pattern = np.linalg.svd(np.array([w * (1 - x) / 2, w * (1 + x) / 2]))[2][-1]
    assert np.allclose(pattern / pattern[0], [1, -5 / 4, 1])
    says("4, -5, 4")


def test_continuum_nitsche_limit(says):
    n = 10
    K = n * (2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1))
    K[0, 0] = n
    p, g = n * (np.eye(n)[0] - np.eye(n)[1]), np.eye(n)[0]

    def lowest(k, touching):
        active = np.outer(p - k * g, p - k * g) / k if touching else 0
        return np.linalg.eigvalsh(K + active - np.outer(p, p) / k)[0]

    limits = [brentq(lowest, 9, 11, args=(touching,)) for touching in (True, False)]
    assert np.allclose(limits, n)
    assert lowest(9.9, True) < 0 < lowest(10.1, True)
    says(f"{limits[0]:.0f}", "9.9", "10.1")
