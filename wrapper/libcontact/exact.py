"""Exact solutions of the impact of two thick plates, to judge the rest by.

Lengths are in half thicknesses d, times in d/c1, stresses come times c1/(Lambda v0), velocities over v0. The plate is
x > 0, -1 < z < 1; it comes at v_x = -v0 and meets its mirror image on x = 0 at t = 0. Theory: the chapter *exact* of the book.
"""

from __future__ import annotations

import operator
from typing import NamedTuple

import numpy as np

from ._core import ffi, lib
from .errors import ArgumentError, check, new_error

__all__ = ["Stress", "Velocity", "Fields", "Speeds", "plates", "plates_series", "speeds", "fronts"]


class Stress(NamedTuple):
    """Stresses times c1/(Lambda v0)."""

    sigma_x: np.ndarray
    sigma_z: np.ndarray
    tau_xz: np.ndarray


class Velocity(NamedTuple):
    """Velocities over v0."""

    v_x: np.ndarray
    v_z: np.ndarray


class Fields(NamedTuple):
    """A pair of the stresses and the velocities: ``(sigma_x, sigma_z, tau_xz), (v_x, v_z) = plates(x, z, t)``."""

    stress: Stress
    velocity: Velocity


class Speeds(NamedTuple):
    """Speeds over c1."""

    c2: float
    c_r: float


def _real(name, values):
    """Values as an array of doubles; what is no real number, or is masked, is refused."""
    if np.ma.is_masked(values):
        raise ValueError(f"{name} has masked values; fill or leave them out")
    array = np.asarray(values)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} must be real numbers, not {array.dtype}")
    return array.astype(np.float64)


def _points(x, z, t):
    """The coordinates broadcast, each flat, contiguous and float64."""
    arrays = np.broadcast_arrays(*map(_real, ("x", "z", "t"), (x, z, t)))
    return arrays[0].shape, [np.ascontiguousarray(a).reshape(-1) for a in arrays]


def _pointer(array):
    return ffi.cast("double *", array.ctypes.data)


def _ask(function, x, z, t, *options):
    """Call ``function(n, x, z, t, *options, fields, bad, error)`` and sort its columns into Fields."""
    shape, points = _points(x, z, t)
    size = points[0].size
    fields = np.empty((size, 5))
    bad, error = ffi.new("size_t *"), new_error()
    status = function(size, *(_pointer(a) for a in points), *options, _pointer(fields), bad, error)
    if status == lib.CT_ERROR_ARGUMENT and bad[0] < size and len(shape) > 1:
        index = tuple(int(i) for i in np.unravel_index(bad[0], shape))
        raise ArgumentError(
            f"{ffi.string(error.text).decode()} [index {index}]", status, point=int(bad[0])
        )
    check(status, error)
    columns = [fields[:, i].copy().reshape(shape)[()] for i in range(5)]
    return Fields(Stress(*columns[:3]), Velocity(*columns[3:]))


def plates(x, z, t, nu=0.3, length=np.inf):
    """Closed form of the impact, exact to about 1e-13.

    x, z, t broadcast against each other. Returns ``(sigma_x, sigma_z, tau_xz), (v_x, v_z)``. On a front the value behind it;
    v_z on a face at x = c_R t is infinite. Raises ValueError, with the index of the first such point, for x < 0, abs(z) > 1,
    t < 0, t >= 2, t + x >= 2 length, x > length, NaN; and for nu outside (0, 0.49].
    """
    return _ask(lib.ct_exact_plates_array, x, z, t, float(nu), float(length))


def plates_series(x, z, t, nu=0.3, branches=300):
    """Partial sum of the Rayleigh-Lamb series over the lowest ``branches`` branches, of an infinitely long plate.

    Arguments and answer as for :func:`plates`; t may pass 2, x + t may be up to 100. Points that follow each other with the
    same x and t share work. Raises NotBuiltIn when the library was built without GSL.
    """
    branches = operator.index(branches)
    if branches < 1:
        raise ArgumentError(f"branches = {branches}, must be 1 to 1000")
    return _ask(lib.ct_exact_plates_series, x, z, t, float(nu), branches)


def speeds(nu=0.3):
    """Speeds ``(c2, c_r)`` of the shear wave and of the Rayleigh wave over c1."""
    c2, c_r = ffi.new("double *"), ffi.new("double *")
    if lib.ct_exact_speeds(float(nu), c2, c_r) != lib.CT_OK:
        raise ArgumentError(f"nu = {nu}, Poisson's ratio must be in (0, 0.49]")
    return Speeds(c2[0], c_r[0])


def fronts(t, nu=0.3, points=91):
    """Curves of the theoretical wave fronts at time t, 0 <= t < 2, to be drawn over a computed field.

    Returns a dict; each value is a list of arrays (n, 2) of x, z: ``plane_p``, ``circular_p``, ``circular_s`` and ``head``
    (one curve for each face, z = 1 first), ``rayleigh`` (one point for each face).
    """
    t = float(t)
    if not 0.0 <= t < 2.0:
        raise ArgumentError(f"t = {t:g}, the fronts are known for 0 <= t < 2")
    c2, c_r = speeds(nu)
    angle = np.linspace(0.0, 0.5 * np.pi, points)
    quarter = np.column_stack([np.cos(angle), np.sin(angle)])
    # the straight head wave leaves the point of the P front on the face and touches the S circle
    touch = np.array([c2, np.sqrt(1.0 - c2 * c2)]) * c2 * t
    by_depth = {
        "circular_p": t * quarter,
        "circular_s": c2 * t * quarter,
        "head": np.array([[t, 0.0], touch]),
        "rayleigh": np.array([[c_r * t, 0.0]]),
    }
    curves = {"plane_p": [np.array([[t, -1.0], [t, 1.0]])]}
    for name, curve in by_depth.items():
        x, depth = curve.T
        curves[name] = [np.column_stack([x, 1.0 - depth]), np.column_stack([x, depth - 1.0])]
    return curves
