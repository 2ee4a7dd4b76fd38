"""The nearest face of a surface, for many points at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ._core import ffi, lib
from .errors import check, new_error
from .projection import _KINDS, _WHERE, _real

__all__ = ["Nearest", "Surface", "nearest"]


@dataclass(frozen=True)
class Nearest:
    """The nearest places of a surface to m points; every array has a row a point, and NaN where the status is INVALID."""

    #: Number of the face, of equally near ones the first; -1 where the status is INVALID. Shape (m,).
    face: np.ndarray
    #: Reference coordinates of the feet, shape (m, 2).
    xi: np.ndarray
    #: The feet, shape (m, 3).
    point: np.ndarray
    #: Distance of each point from its foot.
    distance: np.ndarray
    #: The distance, negative inside: below the face, or below the mean of the faces that meet in an edge or corner.
    signed_distance: np.ndarray
    #: Unit vectors outwards at the feet, shape (m, 3).
    normal: np.ndarray
    #: Numbers of :class:`~libcontact.projection.Status`.
    status: np.ndarray
    #: "interior", "edge" or "vertex" of the face; "outside" where the status is INVALID.
    where: np.ndarray
    #: Number of the edge or corner, -1 in the interior.
    index: np.ndarray


_FIELDS = {
    "status": (np.int32, ()),
    "face": (np.int32, ()),
    "where": (np.int32, ()),
    "index": (np.int32, ()),
    "xi": (np.float64, (2,)),
    "point": (np.float64, (3,)),
    "distance": (np.float64, ()),
    "signed_distance": (np.float64, ()),
    "normal": (np.float64, (3,)),
}
_ROW = np.dtype(
    {
        "names": list(_FIELDS),
        "formats": list(_FIELDS.values()),
        "offsets": [ffi.offsetof("ct_nearest", name) for name in _FIELDS],
        "itemsize": ffi.sizeof("ct_nearest"),
    }
)


_CHUNK = 16384  # points whose rows stay in the cache until they are sorted into arrays


class Surface:
    """Faces over nodes, with a tree of boxes that finds the nearest face.

    :param kind: ``"Q4"``, ``"Q8"``, ``"T3"`` or ``"T6"``.
    :param nodes: node coordinates, shape (n, 3).
    :param faces: node numbers, shape (f, nodes of a face), corners counter-clockwise from outside and then mid-sides.
    :raises TypeError: numbers that are not real, node numbers that are not whole.
    :raises ValueError: a kind, shape or node number that is impossible; coordinates that are not finite; a face without area.
    """

    def __init__(self, kind: str, nodes: Any, faces: Any):
        if not isinstance(kind, str) or kind not in _KINDS:
            raise ValueError(f"kind must be one of {', '.join(_KINDS)}, not {kind!r}")
        nodes = _rows("nodes", nodes)
        faces = _faces(kind, faces)
        surface = ffi.new(
            "ct_surface *",
            {"kind": _KINDS[kind], "node_count": len(nodes), "face_count": len(faces)},
        )
        surface.faces = ffi.from_buffer("int32_t[]", faces)
        surface.reference = ffi.from_buffer("double[]", nodes)
        made, error = ffi.new("ct_search **"), new_error()
        check(lib.ct_search_create(surface, made, error), error)
        self._search = ffi.gc(made[0], lib.ct_search_free)
        self._count = len(nodes)
        self._faces = len(faces)

    def move(self, nodes: Any) -> None:
        """Move the nodes to new coordinates, shape (n, 3). The tree follows, and is built anew when that has made it poor."""
        nodes = _rows("nodes", nodes)
        if len(nodes) != self._count:
            raise ValueError(f"nodes must have shape ({self._count}, 3), not {nodes.shape}")
        error = new_error()
        check(lib.ct_search_move(self._search, ffi.from_buffer("double[]", nodes), error), error)

    @property
    def builds(self) -> int:
        """How often the tree was built."""
        return int(lib.ct_search_builds(self._search))

    @property
    def cost(self) -> float:
        """Cost of a query in the tree as it is over that when it was built."""
        return float(lib.ct_search_cost(self._search))

    def nearest(
        self, points: Any, start: Any = None, tolerance: float = 1e-10, threads: int = 1
    ) -> Nearest:
        """Find the nearest face to each of m points.

        :param points: the points, shape (m, 3).
        :param start: a face for each point that is probably near, -1 for none, shape (m,). Saves time, changes no bit.
        :param tolerance: bound on the error of xi in half-widths of the face.
        :param threads: changes no bit either.
        """
        points = _rows("points", points)
        if start is not None:
            start = _whole("start", start)
            if start.shape != (len(points),) or ((start < -1) | (start >= self._faces)).any():
                raise ValueError(
                    f"start must be a face, 0 to {self._faces - 1}, or -1 for each of {len(points)} points"
                )
        options = ffi.new(
            "ct_search_options *", {"tolerance": float(tolerance), "threads": int(threads)}
        )
        if not 0 < options.tolerance < float("inf") or options.threads < 1:
            raise ValueError(
                f"tolerance must be positive and finite, threads at least 1, not {tolerance!r} and {threads!r}"
            )
        fields = {
            name: np.empty((len(points), *shape), dtype) for name, (dtype, shape) in _FIELDS.items()
        }
        rows = np.empty(min(len(points), _CHUNK), _ROW)
        out = ffi.cast("ct_nearest *", ffi.from_buffer(rows))
        for i in range(0, len(points), _CHUNK):
            part = points[i : i + _CHUNK]
            begin = (
                ffi.NULL if start is None else ffi.from_buffer("int32_t[]", start[i : i + _CHUNK])
            )
            check(
                lib.ct_search_nearest(
                    self._search, len(part), ffi.from_buffer("double[]", part), begin, options, out
                )
            )
            for name, array in fields.items():
                array[i : i + _CHUNK] = rows[name][: len(part)]
        return Nearest(**{**fields, "where": _WHERE[fields["where"]]})


def nearest(
    kind: str, nodes: Any, faces: Any, points: Any, tolerance: float = 1e-10, threads: int = 1
) -> Nearest:
    """Find the nearest face of a surface to each of m points: a :class:`Surface` that is asked once."""
    return Surface(kind, nodes, faces).nearest(points, tolerance=tolerance, threads=threads)


def _rows(name: str, values: Any) -> np.ndarray:
    array = _real(name, values)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} must have shape (n, 3), not {array.shape}")
    return array


def _whole(name: str, values: Any) -> np.ndarray:
    array = np.asarray(values)
    if array.size and array.dtype.kind not in "iu":
        raise TypeError(f"{name} must be whole numbers, not {array.dtype}")
    if array.size and (array.min() < -(2**31) or array.max() >= 2**31):
        raise ValueError(f"{name} must fit 32 bits")
    return np.ascontiguousarray(array, dtype=np.int32)


def _faces(kind: str, faces: Any) -> np.ndarray:
    array = _whole("faces", faces)
    count = lib.ct_face_node_count(_KINDS[kind])
    if array.ndim != 2 or array.shape[1] != count or len(array) == 0:
        raise ValueError(
            f"faces of kind {kind} must have shape (f, {count}), f > 0, not {array.shape}"
        )
    return array
