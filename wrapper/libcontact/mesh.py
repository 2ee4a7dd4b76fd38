"""Meshes of bricks: numpy views of arrays of the C library, and location of points."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from functools import cache, cached_property
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._core import ffi, lib
from .bridge import Floats, Ints, Rows, ask, call, doubles, ints, names
from .errors import NotBuiltIn, check, install
from .schema import FACES, check_file
from .sets import Sets

__all__ = ["Mesh"]

KINDS = names("ct_brick_kind")
FACTS = {name: lib.ct_brick_facts_of(kind) for name, kind in KINDS.items()}
WIDTH: dict[str, int] = {name: facts.node_count for name, facts in FACTS.items()}
LAYERS = names("ct_layers")
# The corners at the other ends of the three edges of each corner of a brick, right-handed.
CORNER_ENDS = np.array(
    [(1, 3, 4), (2, 0, 5), (3, 1, 6), (0, 2, 7), (7, 5, 0), (4, 6, 1), (5, 7, 2), (6, 4, 3)]
)
# The corners at the ends of each edge, in the order of the mid-side nodes of hex20.
EDGE_ENDS = np.array(
    [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
)
NO_SETS = Sets()


def c_box(box: Any, layers: str) -> Any:
    """A ``ct_box *`` of the table of a box, numbered in these layers."""
    members = {name: list(getattr(box, name)) for name in ("origin", "size", "cells", "grading")}
    members["symmetric"] = [axis in box.symmetric for axis in "xyz"]
    return ffi.new("ct_box *", members | {"layers": LAYERS[layers]})


def mesh_of(shape: str, table: Any, element: str) -> Mesh:
    """The mesh of a ring, cylinder, ball or shell, whose keys are the members of the C struct."""
    struct = "ball" if shape == "shell" else shape
    radius = [0.0, table.radius] if shape == "ball" else table.radius
    members = {"centre": list(table.centre), "cells": list(table.cells)}
    members["radius"] = radius if shape == "cylinder" else list(radius)
    if struct != "ball":
        members["width"] = table.width
    create = {
        "ring": lib.ct_mesh_create_ring,
        "cylinder": lib.ct_mesh_create_cylinder,
        "ball": lib.ct_mesh_create_ball,
    }[struct]
    return Mesh(ask("ct_mesh **", create, KINDS[element], ffi.new(f"ct_{struct} *", members)))


def c_mesh(nodes: Floats, elements: Ints) -> Any:
    """A ``ct_mesh *`` of contiguous arrays, which must live as long."""
    if nodes.dtype != np.float64 or elements.dtype != np.int32:
        found = f"nodes of {nodes.dtype} and elements of {elements.dtype}"
        raise TypeError(f"{found}; float64 and int32 are needed")
    kind = list(WIDTH.values()).index(elements.shape[1])
    return ffi.new("ct_mesh *", [kind, len(nodes), len(elements), doubles(nodes), ints(elements)])


def row_length(box: Any, layers: str) -> int:
    """Number of cells along a row of a box (with ``cells``) that is numbered in these layers."""
    axes, c = ffi.new("int[3]"), {"cells": list(box.cells), "layers": LAYERS[layers]}
    lib.ct_box_axes(ffi.new("ct_box *", c), axes)
    return int(box.cells[axes[0]])


def view(pointer: Any, shape: tuple[int, ...], dtype: Any, owner: Any) -> Rows:
    """A read-only numpy view of C memory; the view keeps ``owner`` alive, and ``owner`` keeps the memory."""
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    if size == 0:
        return np.empty(shape, dtype)
    held = ffi.gc(ffi.cast("char *", pointer), lambda _, owner=owner: None)
    return np.frombuffer(memoryview(ffi.buffer(held, size)).toreadonly(), dtype).reshape(shape)


class Mesh:
    """
    The bricks of one body.

    Attributes
    ----------
    element : {"hex8", "hex20"}
        Kind of all elements.
    nodes : ndarray, shape (n, 3)
        Reference coordinates [length], a read-only view of C memory.
    elements : ndarray of int32, shape (cells, 8 or 20)
        Node numbers in VTK's order, a read-only view of C memory.
    sets : Sets
        Named sets of nodes, faces and elements.
    """

    def __init__(
        self, pointer: Any, owner: Any = None, sets: Sets = NO_SETS, sides: Mesh | None = None
    ):
        """Wrap a ``ct_mesh *`` that ``owner`` keeps alive; without an owner the mesh frees it. The mesh
        ``sides`` has the same elements in another place, and names the sides."""
        self.sets = sets
        self._sides = sides
        self.pointer = ffi.gc(pointer, lib.ct_mesh_free) if owner is None else pointer
        self._owner = owner
        self.element = list(KINDS)[pointer.kind]
        keep = (self.pointer, owner)
        self.nodes: Floats = view(pointer.nodes, (pointer.node_count, 3), np.float64, keep)
        shape = (pointer.element_count, WIDTH[self.element])
        self.elements: Ints = view(pointer.elements, shape, np.int32, keep)

    @classmethod
    def box(
        cls,
        element: str,
        origin: Any,
        size: Any,
        cells: Any,
        layers: str = "z",
        grading: Any = (1.0, 1.0, 1.0),
        symmetric: Sequence[str] = (),
    ) -> Mesh:
        """
        Mesh a rectangular box, numbered as ``ct_mesh_create_box`` says.

        Parameters
        ----------
        element : {"hex8", "hex20"}
            Kind of the elements.
        origin, size : array_like, shape (3,)
            The corner with the smallest coordinates, and the edge lengths [length].
        cells : sequence of 3 int
            Elements along x, y, z.
        layers : {"x", "y", "z"}
            The axis along which layers of elements follow one another.
        grading : array_like, shape (3,)
            Size of the last element over that of the first along x, y, z, :eq:`mesh-grading`.
        symmetric : sequence of {"x", "y", "z"}
            Axes along which ``grading`` is the size of the elements at both ends over that in the middle.

        Returns
        -------
        Mesh
            The mesh, checked.

        Raises
        ------
        ValueError
            A number is out of range.

        Examples
        --------
        >>> from libcontact.mesh import Mesh
        >>> mesh = Mesh.box("hex8", (0, 0, 0), (2, 1, 1), (2, 1, 1))
        >>> mesh.nodes.shape, mesh.elements[0].tolist(), mesh.face_nodes("x_min").tolist()
        ((12, 3), [0, 1, 4, 3, 6, 7, 10, 9], [0, 3, 6, 9])
        """
        given = {"origin": origin, "size": size, "cells": cells, "grading": grading}
        box = c_box(SimpleNamespace(**given, symmetric=symmetric), layers)
        mesh = cls(ask("ct_mesh **", lib.ct_mesh_create_box, KINDS[element], box))
        call(lib.ct_mesh_check, mesh.pointer)
        return mesh

    @classmethod
    def copy(cls, nodes: Floats, elements: Ints, sets: Sets = NO_SETS) -> Mesh:
        """
        Copy a mesh from contiguous arrays and check it.

        Parameters
        ----------
        nodes : ndarray of float64, shape (n, 3)
            Coordinates [length].
        elements : ndarray of int32, shape (cells, 8 or 20)
            Node numbers in VTK's order.
        sets : Sets, optional
            Its named sets.

        Returns
        -------
        Mesh
            The copy.

        Raises
        ------
        TypeError
            The arrays have other types.
        ValueError
            A node number is out of range, a coordinate not finite or an element inverted.
        """
        made = ask("ct_mesh **", lib.ct_mesh_create_copy, c_mesh(nodes, elements))
        return cls(made, sets=sets)

    def __reduce__(self) -> tuple[Any, ...]:
        arrays = (np.ascontiguousarray(each) for each in (self.nodes, self.elements))
        return Mesh.copy, (*arrays, self.sets)

    @cached_property
    def bounds(self) -> tuple[Floats, Floats]:
        """Smallest and largest coordinates of the nodes [length], shape (3,) each."""
        columns = self.nodes.T  # one by one numpy is much faster
        return np.array([x.min() for x in columns]), np.array([x.max() for x in columns])

    @cached_property
    def shortest_edge(self) -> float:
        """Shortest edge between corner nodes of any element [length]."""
        return float(lib.ct_mesh_shortest_edge(self.pointer))

    def _plane(self, face: str) -> tuple[int, float]:
        """Axis and coordinate of the plane of a face such as ``x_min``."""
        axis, side = "xyz".index(face[0]), 0 if face.endswith("min") else 1
        return axis, float(self.bounds[side][axis])

    def faces(self, face: str) -> tuple[Ints, Ints]:
        """
        List outer faces of the mesh.

        Parameters
        ----------
        face : str
            ``"x_min"``, ``"x_max"``, ``"y_min"``, ``"y_max"``, ``"z_min"`` or ``"z_max"``: the outer faces in the
            plane of the smallest or largest coordinate; ``"outer"``: all outer faces; or the name of a set.

        Returns
        -------
        faces : ndarray of int32, shape (m, 4 or 8)
            Node numbers, counter-clockwise from outside.
        owners : ndarray of int32, shape (m,)
            The elements that the faces belong to.

        Raises
        ------
        ValueError
            No set of faces has this name, or a face of the set is inside the body.
        """
        if face not in FACES:
            return self._set_faces(face)
        if self._sides is not None:
            return self._sides.faces(face)
        plane = () if face == "outer" else self._plane(face)
        function = lib.ct_mesh_plane_faces if plane else lib.ct_mesh_outer_faces
        count = function(self.pointer, *plane, ffi.NULL, ffi.NULL)
        check(-min(count, 0))
        width = lib.ct_face_node_count(FACTS[self.element].face_kind)
        faces, owners = np.empty((count, width), np.int32), np.empty(count, np.int32)
        check(-min(function(self.pointer, *plane, ints(faces), ints(owners)), 0))
        return faces, owners

    def face_nodes(self, face: str) -> Ints:
        """
        List the nodes of a face in ascending order.

        Parameters
        ----------
        face : str
            As for :meth:`faces`.

        Returns
        -------
        ndarray of int32, shape (m,)
            All nodes in the plane of the face; for ``"outer"`` those of all outer faces; the nodes of a set, or
            of the faces or elements of a set.
        """
        if face not in FACES:
            return self._set_nodes(face)
        if face == "outer":
            return np.unique(self.faces(face)[0])
        if self._sides is not None:
            return self._sides.face_nodes(face)
        # Capacity for all faces; the system provides memory only for what is written.
        room = np.empty(self.pointer.node_count, np.int32)
        count = lib.ct_mesh_plane_nodes(self.pointer, *self._plane(face), ints(room))
        return room[:count].copy()

    def _set_faces(self, name: str) -> tuple[Ints, Ints]:
        """The faces of a set, as :meth:`faces` returns them."""
        kinds = self.sets.kinds(name)
        if kinds and "faces" not in kinds:
            raise ValueError(f'has no set of faces "{name}"; this is a set of {kinds[0]}')
        if not kinds:
            raise ValueError(self.sets.unknown(name))
        sides = self.sets.faces[name]
        width = lib.ct_face_node_count(FACTS[self.element].face_kind)
        faces = np.empty((len(sides), width), np.int32)
        if len(sides):
            call(lib.ct_mesh_side_faces, self.pointer, len(sides), ints(sides), ints(faces))
        return faces, np.ascontiguousarray(sides[:, 0])

    def _set_nodes(self, name: str) -> Ints:
        """The nodes of a set, ascending."""
        kinds = self.sets.kinds(name)
        if not kinds:
            raise ValueError(self.sets.unknown(name))
        if "nodes" in kinds:
            return self.sets.nodes[name]
        if "elements" in kinds and "faces" not in kinds:
            return np.unique(self.elements[self.sets.elements[name]])
        elements, sides = self.sets.faces[name].T
        return np.unique(self.elements[elements[:, None], side_nodes(self.element)[sides]])

    def centres(self, positions: Floats | None = None) -> Floats:
        """
        Compute the points ξ = 0 of all elements.

        The sums pair opposite nodes, so that mirrored meshes have exactly mirrored centres.

        Parameters
        ----------
        positions : ndarray, shape (n, 3), optional
            Coordinates of the nodes [length], by default the reference coordinates.

        Returns
        -------
        ndarray, shape (cells, 3)
            The centres [length].
        """
        x = (self.nodes if positions is None else positions)[self.elements]
        # Sums of four nodes: of faces, then of the edges between them.
        bottom, top, *edges = (
            (x[:, i] + x[:, i + 2]) + (x[:, i + 1] + x[:, i + 3]) for i in range(0, x.shape[1], 4)
        )
        corners: Floats = bottom + top
        return (edges[0] + edges[1] + edges[2] - corners) / 4.0 if edges else corners / 8.0

    def locate(self, points: Floats) -> tuple[NDArray[np.int64], Floats]:
        """
        Find the elements that contain points of the reference configuration.

        Parameters
        ----------
        points : ndarray, shape (m, 3)
            The points [length].

        Returns
        -------
        elements : ndarray of int, shape (m,)
            On a face between elements the one with the lowest number; -1 if no element contains the
            point.
        xi : ndarray, shape (m, 3)
            The point's ξ in its element; NaN if there is none.
        """
        x = self.nodes[self.elements]
        low, high = x.min(axis=1), x.max(axis=1)
        # A curved face may bulge out of the box of its nodes.
        margin = (1e-9 if FACTS[self.element].trilinear else 0.3) * (high - low).max(
            axis=1, keepdims=True
        )
        low, high = low - margin, high + margin
        elements = np.full(len(points), -1, np.int64)
        xi = np.full((len(points), 3), np.nan)
        for i, point in enumerate(points):
            for element in np.flatnonzero(((point >= low) & (point <= high)).all(axis=1)):
                found = self._inverse(x[element], point)
                if found is not None and np.abs(found).max() <= 1.0 + 1e-9:
                    elements[i], xi[i] = element, found
                    break
        return elements, xi

    def shape(self, xi: Floats) -> Floats:
        """
        Evaluate the shape functions.

        Parameters
        ----------
        xi : ndarray, shape (3,)
            Reference coordinates ξ.

        Returns
        -------
        ndarray, shape (8 or 20,)
            One value per node of an element.
        """
        out = np.empty(20)
        lib.ct_brick_shape(KINDS[self.element], doubles(np.ascontiguousarray(xi)), doubles(out))
        return out[: WIDTH[self.element]]

    def _inverse(self, x: Floats, point: Floats) -> Floats | None:
        """ξ of a point in the element with the nodes ``x``, by Newton's method from the centre;
        None if it does not converge."""
        d, xi, slopes = x - point, np.zeros(3), np.empty((20, 3))
        for _ in range(30):
            out = ffi.from_buffer("double[][3]", slopes)
            lib.ct_brick_gradient(KINDS[self.element], doubles(xi), out)
            try:
                change = np.linalg.solve(d.T @ slopes[: len(x)], self.shape(xi) @ d)
            except np.linalg.LinAlgError:
                return None
            xi = xi - change
            if not np.abs(xi).max() < 10.0:
                return None
            if np.abs(change).max() < 1e-12:
                return xi
        return None


@cache
def side_nodes(element: str) -> Ints:
    """Local numbers of the nodes of the six sides of a kind of brick, shape (6, 4 or 8)."""
    facts = FACTS[element]
    numbers = np.arange(facts.node_count, dtype=np.int32).reshape(1, -1)
    mesh = c_mesh(np.zeros((facts.node_count, 3)), numbers)
    sides = np.array([(0, side) for side in range(6)], np.int32)
    out = np.empty((6, lib.ct_face_node_count(facts.face_kind)), np.int32)
    call(lib.ct_mesh_side_faces, mesh, len(sides), ints(sides), ints(out))
    return out


def rotation(X: Floats, x: Floats) -> Floats:
    """The rotation (3, 3) that maps X closest to x, both about their means."""
    left, _, right = np.linalg.svd((x - x.mean(axis=0)).T @ (X - X.mean(axis=0)))
    turn: Floats = left @ np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))]) @ right
    return turn


def open_hdf5(path: str | Path, mode: str = "r") -> Any:
    """Open an HDF5 file, for ``with``; a ValueError gives the reason if it can't be read."""
    try:
        import h5py

        check_file(path)
        return h5py.File(path, mode)
    except ImportError:
        raise NotBuiltIn(f"reading files needs h5py: {install('files')}") from None
    except OSError as error:
        text = "no HDF5 file" if "signature not found" in str(error) else str(error)
        reason = text if Path(path).exists() else "no such file"
        raise ValueError(f'can\'t read "{path}": {reason}') from None


def text_in(value: Any) -> str:
    """A text of an HDF5 file."""
    return value.decode(errors="replace").rstrip("\0") if isinstance(value, bytes) else str(value)


def physical_memory() -> float:
    """Bytes of memory of this machine; infinite where the system does not report them."""
    try:
        return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, ValueError, OSError):
        return math.inf
