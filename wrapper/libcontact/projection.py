"""The closest point of a face, for many points at once."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np

from ._core import ffi, lib

__all__ = [
    "Projection",
    "RayHits",
    "Status",
    "face_points",
    "project",
    "project_path",
    "project_ray",
]


class Status(IntEnum):
    """How the search for one closest point ended; the same numbers as ``ct_status`` in C."""

    OK = 0
    NOT_CERTIFIED = 1
    ITERATION_LIMIT = 2
    NO_CONVERGENCE = 3
    INVALID = 4


@dataclass(frozen=True)
class Projection:
    """The closest points of m points; every array has a row a point, and NaN where the status is INVALID."""

    #: Reference coordinates of the feet, shape (m, 2).
    xi: np.ndarray
    #: The feet, shape (m, 3).
    point: np.ndarray
    #: Distance of each point from its foot.
    distance: np.ndarray
    #: The distance, negative where the point lies against the normal y,1 x y,2.
    signed_distance: np.ndarray
    #: Numbers of :class:`Status`.
    status: np.ndarray
    #: Calls of f, with or without its gradient and Hessian.
    evaluations: np.ndarray
    #: "interior", "edge", "vertex" or "outside".
    where: np.ndarray
    #: True where a proof says that no point of the face is closer.
    certified: np.ndarray


@dataclass(frozen=True)
class RayHits:
    """Where m lines meet a face; every array has a row a line. A line that misses has the status NO_CONVERGENCE and NaN."""

    #: Reference coordinates of the hits, shape (m, 2).
    xi: np.ndarray
    #: The hits, shape (m, 3).
    point: np.ndarray
    #: The way from each point to its hit, negative against the direction.
    distance: np.ndarray
    #: Unit normals of the face at the hits, shape (m, 3).
    normal: np.ndarray
    #: Numbers of :class:`Status`.
    status: np.ndarray
    #: Points of the face that were looked at.
    evaluations: np.ndarray
    #: "interior", "edge", "vertex", or "outside" where there is no hit.
    where: np.ndarray


#: Numbers of the search methods by name.
METHODS = {ffi.string(lib.ct_method_name(i)).decode(): i for i in range(lib.CT_TORUS + 1)}
_KINDS = {"Q4": lib.CT_Q4, "Q8": lib.CT_Q8, "T3": lib.CT_T3, "T6": lib.CT_T6}
_WHERE = np.array(["interior", "edge", "vertex", "outside"])
_FIELDS = {
    "status": (np.int32, ()),
    "where": (np.int32, ()),
    "evaluations": (np.int32, ()),
    "certified": (np.int32, ()),
    "xi": (np.float64, (2,)),
    "point": (np.float64, (3,)),
    "distance": (np.float64, ()),
    "signed_distance": (np.float64, ()),
}
_HIT_FIELDS = {
    name: _FIELDS[name] for name in ("status", "where", "evaluations", "xi", "point", "distance")
}
_HIT_FIELDS["normal"] = (np.float64, (3,))


def _row(struct: str, fields: dict) -> np.dtype:
    """The fields of a C structure, as numpy sees an array of it."""
    return np.dtype(
        {
            "names": list(fields),
            "formats": list(fields.values()),
            "offsets": [ffi.offsetof(struct, name) for name in fields],
            "itemsize": ffi.sizeof(struct),
        }
    )


_ROW = _row("ct_projection", _FIELDS)
_HIT_ROW = _row("ct_ray_hit", _HIT_FIELDS)


def project(
    kind: str,
    nodes: Any,
    points: Any,
    method: str = "robust",
    tolerance: float = 1e-10,
    start: Any = None,
) -> Projection:
    """Find the closest point of one face to each of m points.

    :param kind: ``"Q4"``, ``"Q8"``, ``"T3"`` or ``"T6"``.
    :param nodes: node coordinates, shape (n, 3), corners counter-clockwise and then mid-sides.
    :param points: the points, shape (m, 3).
    :param method: ``"robust"`` stays on the face, and so does ``"certified"``, which also proves its answer. Unconstrained are ``"simplex"``,
        ``"nelder_mead"``, ``"newton"``, ``"simplex_newton"``, ``"least_squares"``, ``"sphere"``, ``"torus"``, ``"steepest_descent"``, ``"broyden"``
        and ``"bfgs"``.
    :param tolerance: bound on the error of xi in half-widths of the face.
    :param start: where to begin, shape (2,) for all points or (m, 2); the method's own choice by default.
    :raises TypeError: numbers that are not real.
    :raises ValueError: a kind, method, shape, tolerance or start that is impossible.
    """
    face = _face(kind, nodes)
    points = _triples("points", points)
    options = _options(method, tolerance)
    first = ffi.NULL if start is None else ffi.from_buffer("double[]", _start(start, len(points)))
    rows = np.zeros(len(points), _ROW)
    code = lib.ct_project_points(
        face,
        len(points),
        ffi.from_buffer("double[]", points),
        options,
        first,
        ffi.cast("ct_projection *", ffi.from_buffer(rows)),
    )
    if code != lib.CT_OK:
        raise ValueError(f"projection refused: {ffi.string(lib.ct_status_name(code)).decode()}")
    return _result(rows)


def project_path(
    kind: str,
    nodes: Any,
    point: Any,
    method: str = "robust",
    tolerance: float = 1e-10,
    start: Any = None,
) -> tuple[np.ndarray, Projection]:
    """Find the closest point of one face to one point, and tell the way there.

    The arguments are those of :func:`project`, for one point of shape (3,).

    :returns: the iterates of the method, shape (n, 2), the last of them the foot, and the projection, with arrays of one row.
    """
    face = _face(kind, nodes)
    points = _triples("point", np.asarray(point)[None])
    options = _options(method, tolerance)
    iterates: list[tuple[float, float]] = []

    @ffi.callback("void(double *, double, void *)")
    def trace(xi: Any, f: float, user: Any) -> None:
        iterates.append((xi[0], xi[1]))

    options.trace = trace
    if start is not None:
        options.use_start, options.start = 1, list(_start(start, 1)[0])
    rows = np.zeros(1, _ROW)
    lib.ct_project(
        face,
        ffi.from_buffer("double[]", points),
        options,
        ffi.cast("ct_projection *", ffi.from_buffer(rows)),
    )
    found = _result(rows)
    return np.array([*iterates, tuple(found.xi[0])]), found


def face_points(kind: str, nodes: Any, xi: Any) -> np.ndarray:
    """The points of one face at reference coordinates ``xi`` of shape (..., 2); of shape (..., 3)."""
    _face(kind, nodes)
    nodes, xi = _real("nodes", nodes), _real("xi", xi)
    if xi.ndim < 1 or xi.shape[-1] != 2:
        raise ValueError(f"xi must have shape (..., 2), not {xi.shape}")
    N = np.empty((xi.size // 2, 8))
    for row, at in zip(N, xi.reshape(-1, 2)):
        lib.ct_segment_shape(
            _KINDS[kind], ffi.from_buffer("double[]", at), ffi.from_buffer("double[]", row)
        )
    return (N[:, : len(nodes)] @ nodes).reshape(*xi.shape[:-1], 3)


def project_ray(
    kind: str, nodes: Any, points: Any, directions: Any, tolerance: float = 1e-10
) -> RayHits:
    """Find where the lines through m points along m directions meet one face, each nearest to its point.

    :param kind: ``"Q4"``, ``"Q8"``, ``"T3"`` or ``"T6"``.
    :param nodes: node coordinates, shape (n, 3), as for :func:`project`.
    :param points: the points, shape (m, 3).
    :param directions: the directions, shape (3,) for all points or (m, 3), of any length.
    :param tolerance: how far beyond the face a hit may lie, in half-widths of the face; below 1.
    :raises TypeError: numbers that are not real.
    :raises ValueError: a kind, shape or tolerance that is impossible.
    """
    face = _face(kind, nodes)
    points = _triples("points", points)
    directions = _real("directions", directions)
    if directions.shape not in ((3,), points.shape):
        raise ValueError(
            f"directions must have shape (3,) or {points.shape}, not {directions.shape}"
        )
    directions = np.ascontiguousarray(np.broadcast_to(directions, points.shape))
    if not 0 < float(tolerance) < 1:
        raise ValueError(f"tolerance must be positive and below 1, not {tolerance!r}")
    rows = np.zeros(len(points), _HIT_ROW)
    arrays = [ffi.from_buffer("double[]", points), ffi.from_buffer("double[]", directions)]
    lib.ct_project_rays(
        face,
        len(points),
        *arrays,
        float(tolerance),
        ffi.cast("ct_ray_hit *", ffi.from_buffer(rows)),
    )
    fields = {name: rows[name].copy() for name in _HIT_FIELDS}
    fields["where"] = _WHERE[rows["where"]]
    return RayHits(**fields)


def _triples(name: str, values: Any) -> np.ndarray:
    array = _real(name, values)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} must have shape (m, 3), not {array.shape}")
    return array


def _result(rows: np.ndarray) -> Projection:
    """Copy the rows that C has written into one array a field."""
    fields = {name: rows[name].copy() for name in _FIELDS}
    fields["where"] = _WHERE[rows["where"]]
    fields["certified"] = rows["certified"] != 0
    return Projection(**fields)


def _real(name: str, values: Any) -> np.ndarray:
    """Values as a contiguous array of doubles, if no digit is lost on the way."""
    if np.ma.is_masked(values):
        raise ValueError(f"{name} has masked values; fill or leave them out")
    array = np.asarray(values)
    if array.size == 0:
        return np.zeros(array.shape)
    if array.dtype.kind not in "fiu" or not np.can_cast(array.dtype, np.float64, "safe"):
        raise TypeError(f"{name} must be real numbers that fit double precision, not {array.dtype}")
    return np.ascontiguousarray(array, dtype=np.float64)


def _face(kind: str, nodes: Any) -> Any:
    if not isinstance(kind, str) or kind not in _KINDS:
        raise ValueError(f"kind must be one of {', '.join(_KINDS)}, not {kind!r}")
    nodes = _real("nodes", nodes)
    count = lib.ct_face_node_count(_KINDS[kind])
    if nodes.shape != (count, 3):
        raise ValueError(f"nodes of a {kind} face must have shape ({count}, 3), not {nodes.shape}")
    face = ffi.new("ct_face *")
    face.kind = _KINDS[kind]
    ffi.memmove(face.node, nodes, nodes.nbytes)
    return face


def _options(method: str, tolerance: float) -> Any:
    options = ffi.new("ct_project_options *", lib.ct_project_options_default())
    chosen = ffi.new("ct_method *")
    if not isinstance(method, str) or lib.ct_method_from_name(method.encode(), chosen) != lib.CT_OK:
        raise ValueError(f"method must be one of {', '.join(METHODS)}, not {method!r}")
    options.method = chosen[0]
    options.tolerance = float(tolerance)
    if not 0 < options.tolerance < float("inf"):
        raise ValueError(f"tolerance must be positive and finite, not {tolerance!r}")
    return options


def _start(start: Any, count: int) -> np.ndarray:
    start = _real("start", start)
    if start.shape not in ((2,), (count, 2)):
        raise ValueError(f"start must have shape (2,) or ({count}, 2), not {start.shape}")
    if not np.isfinite(start).all():
        raise ValueError("start must be finite")
    return np.ascontiguousarray(np.broadcast_to(start, (count, 2)))
