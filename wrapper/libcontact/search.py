"""The nearest face of a surface, for many points at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._core import ffi, lib
from .bridge import Floats, Ints, ask, call, doubles, ints, positive, real, table, whole
from .projection import columns, face_kind

__all__ = ["Nearest", "Surface", "nearest"]


@dataclass(frozen=True)
class Nearest:
    """The closest points of a surface to m points; every array has one row per point, and NaN where the status is
    INVALID."""

    #: Number of the face, the lowest one if several are equally close; -1 where the status is
    #: INVALID. Shape (m,).
    face: Ints
    #: Reference coordinates ξ of the closest points, shape (m, 2).
    xi: Floats
    #: The closest points [length], shape (m, 3).
    point: Floats
    #: Distance of each point from its closest point [length], shape (m,).
    distance: Floats
    #: The distance, negative inside: below the face, or below the mean of the faces that meet in an edge or corner
    #: [length]. Shape (m,).
    signed_distance: Floats
    #: Unit vectors at the closest points that point outwards, shape (m, 3).
    normal: Floats
    #: Numbers of :class:`~libcontact.projection.Status`, shape (m,).
    status: Ints
    #: "interior", "edge" or "vertex" of the face; "outside" where the status is INVALID. Shape (m,).
    where: NDArray[np.str_]
    #: Number of the edge or corner, -1 in the interior. Shape (m,).
    index: Ints


class Surface:
    """A surface of faces, with a tree of bounding boxes that finds the closest face.

    Parameters
    ----------
    kind : {"Q4", "Q8", "T3", "T6"}
        Kind of all faces.
    nodes : array_like, shape (n, 3)
        Node coordinates [length].
    faces : array_like of int, shape (f, nodes of a face)
        Node numbers, corners counter-clockwise from outside and then mid-sides.

    Raises
    ------
    TypeError
        The coordinates are not real numbers, or the node numbers are not integers.
    ValueError
        The kind, a shape or a node number is invalid, coordinates are not finite, or a face has no
        area.

    Examples
    --------
    >>> import libcontact as ct
    >>> strip = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]]
    >>> surface = ct.Surface("Q4", strip, [[0, 1, 4, 3], [1, 2, 5, 4]])
    >>> found = surface.nearest([[1.5, 0.5, -2]])
    >>> found.face.tolist(), found.signed_distance.tolist()
    ([1], [-2.0])
    """

    def __init__(self, kind: str, nodes: Any, faces: Any):
        number = face_kind(kind)
        asked, nodes, faces = nodes, real("nodes", nodes, ("n", 3)), whole("faces", faces)
        count = lib.ct_face_node_count(number)
        if faces.ndim != 2 or faces.shape[1] != count or len(faces) == 0:
            reason = f"must have shape (f, {count}), f > 0, not {faces.shape}"
            raise ValueError(f"faces of kind {kind} {reason}")
        surface = ffi.new("ct_surface *", [number, len(nodes), len(faces)])
        surface.faces, surface.reference = ints(faces), doubles(nodes)
        # The surface as a C struct and the original array of nodes, for a Contact; this object
        # keeps the arrays alive.
        self.given, self.asked, self._arrays = surface, asked, (faces, nodes)
        search = ask("ct_search **", lib.ct_search_create, surface)
        self._search = ffi.gc(search, lib.ct_search_free)
        self._count, self._faces = len(nodes), len(faces)

    def move(self, nodes: Any) -> None:
        """Move the nodes. The tree is refitted, and rebuilt when its queries have become too
        expensive.

        Parameters
        ----------
        nodes : array_like, shape (n, 3)
            The new coordinates [length].

        Raises
        ------
        TypeError, ValueError
            As for the surface itself.
        """
        call(lib.ct_search_move, self._search, doubles(real("nodes", nodes, (self._count, 3))))

    @property
    def inside_out(self) -> int | None:
        """First face of a closed part of the surface whose faces point inwards; None if there is none.

        The part encloses a negative volume and is not the wall of a cavity within another part. In a
        contact such a body lets others through without a force.
        """
        face: int = ask("int32_t *", lib.ct_search_inside_out, self._search)
        return int(face) if face >= 0 else None

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Smallest and largest coordinates of the nodes of the faces, as they were given [length]."""
        faces, nodes = self._arrays
        used = nodes[faces.ravel()]
        return used.min(axis=0), used.max(axis=0)

    @property
    def builds(self) -> int:
        """Number of times that the tree was built."""
        return int(lib.ct_search_builds(self._search))

    @property
    def cost(self) -> float:
        """Estimated cost of a query in the present tree divided by the cost when it was built."""
        return float(lib.ct_search_cost(self._search))

    def nearest(
        self, points: Any, start: Any = None, tolerance: float = 1e-10, threads: int = 1
    ) -> Nearest:
        """
        Find the nearest face to each of m points.

        Parameters
        ----------
        points : array_like, shape (m, 3)
            The points [length].
        start : array_like of int, shape (m,), optional
            For each point a face that is probably close, -1 for none. It saves time; results do not
            depend on it.
        tolerance : float
            Bound on the error of ξ in half-widths of the face.
        threads : int
            Number of threads; results do not depend on it.

        Returns
        -------
        Nearest
            One row per point.

        Raises
        ------
        TypeError
            The coordinates are not real numbers, or the faces of ``start`` are not integers.
        ValueError
            A shape, a face of ``start``, the tolerance or the number of threads is invalid.
        """
        points = real("points", points, ("n", 3))
        if start is not None:
            start = whole("start", start)
            if start.shape != (len(points),) or ((start < -1) | (start >= self._faces)).any():
                faces = f"a face, 0 to {self._faces - 1}, or -1"
                raise ValueError(f"start must be {faces} for each of {len(points)} points")
        if int(threads) < 1:
            raise ValueError(f"threads must be at least 1, not {threads!r}")
        options = ffi.new("ct_search_options *", lib.ct_search_options_default())
        options.tolerance, options.threads = positive("tolerance", tolerance), int(threads)
        rows, out = table("ct_nearest", len(points))
        first = ffi.NULL if start is None else ints(start)
        x = doubles(points)
        call(lib.ct_search_nearest, self._search, len(points), x, first, options, out)
        return columns(Nearest, rows)


def nearest(
    kind: str, nodes: Any, faces: Any, points: Any, tolerance: float = 1e-10, threads: int = 1
) -> Nearest:
    """
    Find the nearest face of a surface to each of m points: a :class:`Surface` that is used once.

    Parameters
    ----------
    kind, nodes, faces
        As for :class:`Surface`.
    points, tolerance, threads
        As for :meth:`Surface.nearest`.

    Returns
    -------
    Nearest
        One row per point.

    Raises
    ------
    TypeError, ValueError
        As for :class:`Surface` and :meth:`Surface.nearest`.
    """
    return Surface(kind, nodes, faces).nearest(points, tolerance=tolerance, threads=threads)
