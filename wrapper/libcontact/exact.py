"""Exact solutions of the impact of two thick plates, a reference for computed results.

All quantities are dimensionless: lengths in half thicknesses d, times in d/c₁, stresses times c₁/(Λ
v₀), velocities divided by v₀. The plate x > 0, -1 < z < 1 moves with v_x = -v₀ and meets its mirror
image on x = 0 at t = 0. Theory: the chapter *exact* of the book.
"""

from __future__ import annotations

import operator
from typing import Any, NamedTuple

import numpy as np

from ._core import ffi, lib
from .bridge import Floats, call, doubles, real
from .errors import ArgumentError, check, new_error, text_of

__all__ = ["Stress", "Velocity", "Fields", "Speeds", "plates", "plates_series", "speeds", "fronts"]


class Stress(NamedTuple):
    """Stresses times c₁/(Λ v₀), in the shape of the coordinates."""

    sigma_x: Floats
    sigma_z: Floats
    tau_xz: Floats


class Velocity(NamedTuple):
    """Velocities over v₀, in the shape of the coordinates."""

    v_x: Floats
    v_z: Floats


class Fields(NamedTuple):
    """A pair of the stresses and the velocities: ``(sigma_x, sigma_z, tau_xz), (v_x, v_z) = plates(x, z, t)``."""

    stress: Stress
    velocity: Velocity


class Speeds(NamedTuple):
    """Wave speeds over c₁."""

    c2: float
    c_r: float


def _ask(function: Any, x: Any, z: Any, t: Any, *options: Any) -> Fields:
    """Call ``function(n, x, z, t, *options, fields, bad, error)`` and sort its columns into Fields."""
    points = np.broadcast_arrays(*map(real, "xzt", (x, z, t)))
    shape, size = points[0].shape, points[0].size
    fields, bad, error = np.empty((size, 5)), ffi.new("size_t *"), new_error()
    given = [doubles(np.ascontiguousarray(values).reshape(-1)) for values in points]
    status = function(size, *given, *options, doubles(fields), bad, error)
    if status == lib.CT_ERROR_ARGUMENT and bad[0] < size and len(shape) > 1:
        index = tuple(int(i) for i in np.unravel_index(bad[0], shape))
        raise ArgumentError(f"{text_of(status, error)} [index {index}]", status, point=int(bad[0]))
    check(status, error)
    columns = [fields[:, i].copy().reshape(shape)[()] for i in range(5)]
    return Fields(Stress(*columns[:3]), Velocity(*columns[3:]))


def plates(x: Any, z: Any, t: Any, nu: float = 0.3, length: float = np.inf) -> Fields:
    """
    Evaluate the closed form of the impact, exact to about 1e-13.

    Parameters
    ----------
    x, z, t : array_like
        Coordinates [d] and times [d/c₁], which broadcast against each other: 0 <= x <= length, \\|z\\| <= 1, 0 <= t <
        2, t + x < 2 length.
    nu : float
        Poisson's ratio, in (0, 0.49].
    length : float
        Length of the plate [d].

    Returns
    -------
    Fields
        ``(sigma_x, sigma_z, tau_xz), (v_x, v_z)``. On a wave front the value behind it; v_z on a
        free face is infinite at x = c_R t.

    Raises
    ------
    ValueError
        A point is out of range or NaN, with the index of the first such point, or ``nu`` is out of range.

    Examples
    --------
    Behind the plane wave and before the waves of the free faces arrive, σ_x = -(1 - ν)/ν:

    >>> import libcontact as ct
    >>> (sigma_x, sigma_z, tau_xz), (v_x, v_z) = ct.exact.plates(0.1, 0.0, 0.5, nu=0.25)
    >>> float(sigma_x), float(sigma_z), float(v_x)
    (-3.0, -1.0, 0.0)
    """
    return _ask(lib.ct_exact_plates, x, z, t, float(nu), float(length))


def plates_series(x: Any, z: Any, t: Any, nu: float = 0.3, branches: int = 300) -> Fields:
    """
    Sum the lowest branches of the Rayleigh-Lamb series of an infinitely long plate.

    Consecutive points with the same x and t share work.

    Parameters
    ----------
    x, z, t : array_like
        As for :func:`plates`, but t may exceed 2, and x + t may be up to 100.
    nu : float
        Poisson's ratio, in (0, 0.49].
    branches : int
        Number of branches, 1 to 1000.

    Returns
    -------
    Fields
        As for :func:`plates`.

    Raises
    ------
    ValueError
        As for :func:`plates`, or the number of branches is out of range.
    NotBuiltIn
        The library was built without GSL.
    """
    branches = operator.index(branches)
    if branches < 1:
        raise ArgumentError(f"branches = {branches}, must be 1 to 1000")
    return _ask(lib.ct_exact_plates_series, x, z, t, float(nu), branches)


def speeds(nu: float = 0.3) -> Speeds:
    """
    Compute the speeds of the shear wave and of the Rayleigh wave over c₁.

    Parameters
    ----------
    nu : float
        Poisson's ratio, in (0, 0.49].

    Returns
    -------
    Speeds
        ``(c2, c_r)``.

    Raises
    ------
    ValueError
        ``nu`` is out of range.

    Examples
    --------
    >>> import libcontact as ct
    >>> c2, c_r = ct.exact.speeds(0.3)
    >>> round(1 / c2**2, 9), round(c_r, 6)
    (3.5, 0.495723)
    """
    c = ffi.new("double[2]")
    call(lib.ct_exact_speeds, float(nu), c, c + 1)
    return Speeds(*c)


def fronts(t: float, nu: float = 0.3, points: int = 91) -> dict[str, list[Floats]]:
    """Compute the wave fronts at one time, for plots over a computed field.

    Parameters
    ----------
    t : float
        Time [d/c₁], 0 <= t < 2.
    nu : float
        Poisson's ratio, in (0, 0.49].
    points : int
        Points of each quarter circle.

    Returns
    -------
    dict of str to list of ndarray, shape (n, 2)
        Curves of x, z by name: ``plane_p``; ``circular_p``, ``circular_s`` and ``head`` (one curve for each face, z = 1
        first); ``rayleigh`` (one point for each face).

    Raises
    ------
    ValueError
        ``t`` or ``nu`` is out of range.
    """
    t = float(t)
    if not 0.0 <= t < 2.0:
        raise ArgumentError(f"t = {t:g}, the fronts are known for 0 <= t < 2")
    c2, c_r = speeds(nu)
    angle = np.linspace(0.0, 0.5 * np.pi, points)
    quarter = np.column_stack([np.cos(angle), np.sin(angle)])
    # The straight head wave starts at the point of the P front on the face and touches the S circle.
    touch = np.array([c2, np.sqrt(1.0 - c2 * c2)]) * c2 * t  # (eq:plates-head)
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
