"""The closest point of a face, for many points at once."""

from __future__ import annotations

from dataclasses import dataclass, fields
from enum import IntEnum
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ._core import ffi, lib
from .bridge import Floats, Ints, call, chosen, doubles, names, positive, real, table

__all__ = [
    "Projection",
    "RayHits",
    "Status",
    "face_points",
    "project",
    "project_path",
    "project_ray",
]

# The methods of projection by name.
METHODS = names("ct_method")
FACE_KINDS = {name.upper(): kind for name, kind in names("ct_face_kind").items()}
_WHERE = np.array(list(names("ct_where")))
_Columns = TypeVar("_Columns")


class Status(IntEnum):
    """How the search for one closest point ended; the numbers are those of ``ct_status`` in C."""

    #: The result meets the tolerance.
    OK = lib.CT_OK
    #: The error of the result may exceed the tolerance, or the proof of the certified method is
    #: missing.
    NOT_CERTIFIED = lib.CT_NOT_CERTIFIED
    #: The number of iterations reached its limit before the result met the tolerance.
    ITERATION_LIMIT = lib.CT_ITERATION_LIMIT
    #: The method stopped at a point that is not stationary; of a line: it misses the face.
    NO_CONVERGENCE = lib.CT_NO_CONVERGENCE
    #: Invalid input (NaN, infinite, degenerate); outputs are NaN.
    INVALID = lib.CT_INVALID


@dataclass(frozen=True)
class Projection:
    """
    The closest points of m points; every array has one row per point, and NaN where the status is INVALID.
    """

    #: Reference coordinates ξ of the closest points, shape (m, 2).
    xi: Floats
    #: The closest points [length], shape (m, 3).
    point: Floats
    #: Distance of each point from its closest point [length], shape (m,).
    distance: Floats
    #: The distance, negative where the point lies against the normal y,₁ × y,₂ [length], shape (m,).
    signed_distance: Floats
    #: Numbers of :class:`Status`, shape (m,).
    status: Ints
    #: Calls of f, with or without its gradient and Hessian, shape (m,).
    evaluations: Ints
    #: "interior", "edge", "vertex" or "outside", shape (m,).
    where: NDArray[np.str_]
    #: True where a proof says that no point of the face is closer, shape (m,).
    certified: NDArray[np.bool_]


@dataclass(frozen=True)
class RayHits:
    """
    Where m lines meet a face; every array has one row per line. A line that misses has the status NO_CONVERGENCE and
    NaN.
    """

    #: Reference coordinates ξ of the hits, shape (m, 2).
    xi: Floats
    #: The hits [length], shape (m, 3).
    point: Floats
    #: The distance from each point to its hit, negative against the direction [length], shape (m,).
    distance: Floats
    #: Unit normals of the face at the hits, shape (m, 3).
    normal: Floats
    #: Numbers of :class:`Status`, shape (m,).
    status: Ints
    #: Points of the face that were evaluated, shape (m,).
    evaluations: Ints
    #: "interior", "edge", "vertex", or "outside" where there is no hit, shape (m,).
    where: NDArray[np.str_]


def project(
    kind: str,
    nodes: Any,
    points: Any,
    method: str = "robust",
    tolerance: float = 1e-10,
    start: Any = None,
) -> Projection:
    """
    Find the closest point of one face to each of m points.

    Parameters
    ----------
    kind : {"Q4", "Q8", "T3", "T6"}
        Kind of the face: bilinear or quadratic, quadrilateral or triangle.
    nodes : array_like, shape (n, 3)
        Node coordinates [length], corners counter-clockwise and then mid-sides.
    points : array_like, shape (m, 3)
        The points [length].
    method : str
        ``"robust"`` stays on the face, and so does ``"certified"``, which also proves its result.
        Unconstrained are ``"simplex"``, ``"nelder_mead"``, ``"newton"``, ``"simplex_newton"``,
        ``"least_squares"``, ``"sphere"``, ``"torus"``, ``"steepest_descent"``, ``"broyden"`` and
        ``"bfgs"``.
    tolerance : float
        Bound on the error of ξ in half-widths of the face.
    start : array_like, shape (2,) or (m, 2), optional
        The ξ to begin at, one for all points or one per point; by default the method chooses.

    Returns
    -------
    Projection
        One row per point.

    Raises
    ------
    TypeError
        The values are not real numbers.
    ValueError
        The kind, method, shape, tolerance or start is invalid.

    Examples
    --------
    >>> import libcontact as ct
    >>> square = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]]
    >>> found = ct.project("Q4", square, [[1.5, 1, 3], [5, 1, 4]])
    >>> found.xi.round(6).tolist()
    [[0.5, 0.0], [1.0, 0.0]]
    >>> found.distance.round(6).tolist(), found.where.tolist()
    ([3.0, 5.0], ['interior', 'edge'])
    >>> ct.Status(found.status[0]).name
    'OK'
    """
    face, points = _face(kind, nodes), real("points", points, ("m", 3))
    options = _options(method, tolerance)
    first = ffi.NULL if start is None else doubles(_start(start, len(points)))
    rows, out = table("ct_projection", len(points))
    call(lib.ct_project_points, face, len(points), doubles(points), options, first, out)
    return columns(Projection, rows)


def project_path(
    kind: str,
    nodes: Any,
    point: Any,
    method: str = "robust",
    tolerance: float = 1e-10,
    start: Any = None,
) -> tuple[Floats, Projection]:
    """
    Find the closest point of one face to one point, and return the iterates of the method too.

    Parameters
    ----------
    kind, nodes, method, tolerance, start
        As for :func:`project`.
    point : array_like, shape (3,)
        The point [length].

    Returns
    -------
    iterates : ndarray, shape (n, 2)
        The ξ of the iterates; the last of them is the result.
    found : Projection
        The closest point, with arrays of one row.

    Raises
    ------
    TypeError, ValueError
        As for :func:`project`.
    """
    face, points = _face(kind, nodes), real("point", np.asarray(point)[None], ("m", 3))
    options = _options(method, tolerance)
    iterates: list[tuple[float, float]] = []
    append = lambda xi, f, user: iterates.append((xi[0], xi[1]))
    trace = ffi.callback("void(double *, double, void *)", append)
    options.trace = trace
    if start is not None:
        options.use_start, options.start = 1, list(_start(start, 1)[0])
    rows, out = table("ct_projection", 1)
    lib.ct_project(face, doubles(points), options, out, ffi.NULL)
    found = columns(Projection, rows)
    return np.array([*iterates, tuple(found.xi[0])]), found


def face_points(kind: str, nodes: Any, xi: Any) -> Floats:
    """
    Evaluate the points of one face at reference coordinates.

    Parameters
    ----------
    kind, nodes
        As for :func:`project`.
    xi : array_like, shape (..., 2)
        Reference coordinates ξ.

    Returns
    -------
    ndarray, shape (..., 3)
        The points of the face [length].

    Raises
    ------
    TypeError, ValueError
        As for :func:`project`.

    Examples
    --------
    >>> import libcontact as ct
    >>> ct.face_points("T3", [[0, 0, 0], [3, 0, 0], [0, 3, 0]], [1/3, 1/3]).round(6).tolist()
    [1.0, 1.0, 0.0]
    """
    face, xi = _face(kind, nodes), real("xi", xi)
    if xi.ndim < 1 or xi.shape[-1] != 2:
        raise ValueError(f"xi must have shape (..., 2), not {xi.shape}")
    points = np.empty((*xi.shape[:-1], 3))
    for point, at in zip(points.reshape(-1, 3), xi.reshape(-1, 2)):
        lib.ct_segment_point(face, doubles(at), doubles(point))
    return points


def project_ray(
    kind: str, nodes: Any, points: Any, directions: Any, tolerance: float = 1e-10
) -> RayHits:
    """
    Find where the lines through m points along m directions meet one face, each the hit nearest to its point.

    Parameters
    ----------
    kind, nodes
        As for :func:`project`.
    points : array_like, shape (m, 3)
        The points [length].
    directions : array_like, shape (3,) or (m, 3)
        The directions, one for all points or one per point, of any length.
    tolerance : float
        How far beyond the face a hit may lie, in half-widths of the face; below 1.

    Returns
    -------
    RayHits
        One row per line.

    Raises
    ------
    TypeError
        The values are not real numbers.
    ValueError
        The kind, shape or tolerance is invalid.

    Examples
    --------
    >>> import libcontact as ct
    >>> square = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]]
    >>> hits = ct.project_ray("Q4", square, [[1, 1, 3]], [0, 0, -1])
    >>> hits.point.tolist(), hits.distance.tolist()
    ([[1.0, 1.0, 0.0]], [3.0])
    """
    face, points = _face(kind, nodes), real("points", points, ("m", 3))
    if not 0 < float(tolerance) < 1:
        raise ValueError(f"tolerance must be positive and below 1, not {tolerance!r}")
    rows, out = table("ct_ray_hit", len(points))
    to = doubles(_each("directions", directions, (len(points), 3)))
    call(lib.ct_project_rays, face, len(points), doubles(points), to, float(tolerance), out)
    return columns(RayHits, rows)


def columns(record: type[_Columns], rows: Any) -> _Columns:
    """A dataclass of what C has written, one array per field, from rows."""
    arrays = {field.name: np.ascontiguousarray(rows[field.name]) for field in fields(record)}  # type: ignore[arg-type]
    arrays["where"] = _WHERE[rows["where"]]
    if "certified" in arrays:
        arrays["certified"] = rows["certified"] != 0
    return record(**arrays)


def face_kind(kind: str) -> int:
    """The number in C of a kind of face; a ValueError for an unknown kind."""
    return chosen("kind", kind, FACE_KINDS)


def _each(name: str, values: Any, shape: tuple[int, int]) -> Floats:
    """A row of numbers for each point; one row may serve all."""
    return np.ascontiguousarray(np.broadcast_to(real(name, values, shape[1:], shape), shape))


def _face(kind: str, nodes: Any) -> Any:
    face = ffi.new("ct_face *", {"kind": face_kind(kind)})
    shape = (lib.ct_face_node_count(face.kind), 3)
    nodes = real(f"nodes of a {kind} face", real("nodes", nodes), shape)
    ffi.memmove(face.node, nodes, nodes.nbytes)
    return face


def _options(method: str, tolerance: float) -> Any:
    options = ffi.new("ct_project_options *", lib.ct_project_options_default())
    options.method = chosen("method", method, METHODS)
    options.tolerance = positive("tolerance", tolerance)
    return options


def _start(start: Any, count: int) -> Floats:
    rows = _each("start", start, (count, 2))
    if not np.isfinite(rows).all():
        raise ValueError("start must be finite")
    return rows
