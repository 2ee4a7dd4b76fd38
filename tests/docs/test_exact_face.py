"""The readable form of the exact solution (docs/theory/face.py) compared with the library and with independent Laplace
transforms."""

import face
import numpy as np
import pytest
from executes import executes

import libcontact as ct


@pytest.mark.parametrize("nu", [0.1, 0.3, 0.4])
@executes(
    "exact-load",
    "exact-gammas",
    "exact-rayleigh",
    "exact-amplitudes",
    "exact-integrands",
    "exact-cagniard",
    "exact-face",
    "exact-head",
    "exact-sum",
)
def test_quadrature_along_the_path_gives_the_closed_form(nu):
    """All five fields of both faces and of the plane wave."""
    random = np.random.default_rng(5)
    ell, seen = 2 * nu / (1 - 2 * nu), set()
    for x, z, t in random.uniform([0.05, -0.9, 0.3], [0.9, 0.9, 1.9], (60, 3)):
        upper, lower = face.face(x, 1 - z, t, nu), face.face(x, 1 + z, t, nu)
        up, low = upper.sum(axis=0), lower.sum(axis=0)
        plane = np.array([-(ell + 2) / ell, -1, 0, 0, 0]) if x < t else [0, 0, 0, -1, 0]
        mirror = np.array([1, 1, -1, 1, -1])
        (sx, sz, txz), (vx, vz) = ct.exact.plates(x, z, t, nu)
        # Gauss's rule is good to 1e-9 where a path ends close to a branch point.
        assert np.allclose(plane + mirror * up + low, [sx, sz, txz, vx, vz], rtol=0, atol=1e-8)
        seen.add((bool(upper[0].any()), bool(upper[1].any())))
    assert seen == {(False, False), (True, False), (True, True)}


def transform(x, y, s, nu):
    """Laplace transform of s_y of one face at a complex s: eq:exact-load, eq:exact-gammas, and a linear system for each
    p."""
    kappa2 = 2 * (1 - nu) / (1 - 2 * nu)
    ell = kappa2 - 2
    # The path is turned so that s p is imaginary; panels of Gauss points, dense near the branch points.
    edges = np.unique(
        np.concatenate([np.linspace(0, 4, 161), np.geomspace(4, 400 / abs(s) + 8, 60)])
    )
    node, weight = np.polynomial.legendre.leggauss(16)
    half = 0.5 * np.diff(edges)[:, None]
    size = (edges[:-1, None] + half * (1 + node)).ravel()
    turn = 1j * np.exp(-1j * np.angle(s))
    p, dp = size * turn, (half * weight).ravel() * turn
    gamma1, gamma2 = np.sqrt(1 - p**2), np.sqrt(kappa2 - p**2)
    # u_x = phi_x + psi_y, u_y = phi_y - psi_x over s, d/dx = p, d/dy = -gamma (times s)
    div = p**2 + gamma1**2
    normal = np.array([div + 2 / ell * gamma1**2, 2 / ell * p * gamma2])
    shear = np.array([-2 * p * gamma1, gamma2**2 - p**2]) / ell
    load = np.stack([2 / (1 - p**2), 0 * p], axis=-1)
    matrix = np.moveaxis(np.array([normal, shear]), -1, 0)
    Phi, Psi = np.linalg.solve(matrix, load[..., None])[..., 0].T
    field = normal[0] * Phi * np.exp(-s * gamma1 * y) + normal[1] * Psi * np.exp(-s * gamma2 * y)
    return np.sum(2 * np.cosh(s * p * x) * field * dp) / (2j * np.pi * s)


@pytest.mark.parametrize("x, y", [(0.4, 0.2), (0.15, 0.3), (0.05, 0.12), (0.3, 0.05)])
@pytest.mark.parametrize("nu", [0.1, 0.3])
def test_transform_of_the_closed_form(x, y, nu):
    """eq:exact-load, eq:exact-rayleigh, eq:exact-amplitudes. The integral of s_y e^(-s t) over the library's values is
    the transform; at s = 20 the time after 2 weighs e^-40."""
    s, c2 = 20.0, ct.exact.speeds(nu).c2
    r = np.hypot(x, y)
    kinks = [0.0, x, r, r / c2, x + y * np.sqrt(1 / c2**2 - 1), x / ct.exact.speeds(nu).c_r, 1.95]
    kinks = np.unique([k for k in kinks if k < 1.99] + list(np.linspace(r, 1.95, 9)))
    node, weight = np.polynomial.legendre.leggauss(60)
    total = 0.0
    for a, b in zip(kinks[:-1], kinks[1:]):
        # Squares at both ends: the field begins and ends with roots of the time from a front.
        u = 0.5 * (1 + node)
        t = a + (b - a) * u**2 * (3 - 2 * u)
        dt = (b - a) * 6 * u * (1 - u) * 0.5 * weight
        own = ct.exact.plates(x, 1 - y, t, nu).stress.sigma_z + (t >= x)
        total += np.sum(own * np.exp(-s * t) * dt)
    # Waves of the other face arrive from t = 2 - y on: e^(-20 · 1.7).
    assert total == pytest.approx(transform(x, y, s, nu).real, rel=0, abs=1e-11)
    assert abs(total) > 1e-7


@pytest.mark.parametrize(
    "x, y, t",
    [(0.4, 0.2, 0.56), (0.1, 0.3, 0.5), (0.1, 0.3, 0.9), (0.3, 0.1, 0.45), (0.3, 0.1, 1.2)],
)
def test_inversion_on_bromwichs_line(x, y, t):
    """Fourier series with Euler's summation, no path of Cagniard: between P and head, behind P, behind S, behind the
    head, behind all."""
    shift, terms = 25.0, 400
    s = (shift + 2j * np.pi * np.arange(terms + 12)) / (2 * t)
    values = np.array([transform(x, y, one, 0.3) for one in s]).real
    values[0] *= 0.5
    partial = np.cumsum(values * (-1.0) ** np.arange(len(s)))[terms:]
    for _ in range(11):
        partial = 0.5 * (partial[1:] + partial[:-1])  # Euler's means of the last partial sums
    found = np.exp(0.5 * shift) / t * partial[0]
    exact = face.face(x, y, t).sum(axis=0)[1]
    library = ct.exact.plates(x, 1 - y, t).stress.sigma_z + (t >= x)
    assert exact == pytest.approx(library, abs=1e-9) or t + y > 2
    # The kinks at the fronts leave terms of the series beyond the last.
    assert found == pytest.approx(exact, abs=1e-3)
