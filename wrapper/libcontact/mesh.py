"""Meshes of bricks: numpy views of what the C library holds, reading from VTKHDF, and finding points in them."""

from __future__ import annotations

import math
import os
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ._core import ffi, lib
from .errors import NotBuiltIn, check, new_error
from .schema import check_file

KINDS = {"hex8": lib.CT_HEX8, "hex20": lib.CT_HEX20}
WIDTH = {"hex8": 8, "hex20": 20}
VTK_TYPE = {12: "hex8", 25: "hex20"}
LAYERS = {"x": lib.CT_LAYERS_X, "y": lib.CT_LAYERS_Y, "z": lib.CT_LAYERS_Z}


def box_axes(cells: Any, layers: str) -> tuple[int, int, int]:
    """The axes (0, 1, 2 for x, y, z) of a box in the order of its numbers: rows run along the first, layers follow one another along the last."""
    axes = ffi.new("int[3]")
    lib.ct_box_axes(ffi.new("ct_box *", {"cells": list(cells), "layers": LAYERS[layers]}), axes)
    return axes[0], axes[1], axes[2]


def row_length(box: Any, layers: str) -> int:
    """Cells along a row of a box (with ``cells``), numbered in these layers."""
    return box.cells[box_axes(box.cells, layers)[0]]


def view(pointer: Any, shape: tuple[int, ...], dtype: Any, owner: Any) -> np.ndarray:
    """A read-only numpy view of C memory; the view keeps ``owner`` alive, and ``owner`` keeps the memory."""
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    if size == 0:
        return np.empty(shape, dtype)
    held = ffi.gc(ffi.cast("char *", pointer), lambda _, owner=owner: None)
    return np.frombuffer(memoryview(ffi.buffer(held, size)).toreadonly(), dtype).reshape(shape)


class Mesh:
    """The bricks of one body. ``nodes`` (n, 3) and ``elements`` (cells, 8 or 20) are read-only views of C memory."""

    def __init__(self, pointer: Any, owner: Any = None):
        """Wrap a ``ct_mesh *`` that ``owner`` keeps alive; without an owner the mesh frees it."""
        self.pointer = ffi.gc(pointer, lib.ct_mesh_free) if owner is None else pointer
        self._owner = owner
        self.element = next(name for name, kind in KINDS.items() if kind == pointer.kind)
        keep = (self.pointer, owner)
        self.nodes = view(pointer.nodes, (pointer.node_count, 3), np.float64, keep)
        self.elements = view(
            pointer.elements, (pointer.element_count, WIDTH[self.element]), np.int32, keep
        )

    @classmethod
    def box(cls, element: str, origin: Any, size: Any, cells: Any, layers: str = "z") -> Mesh:
        """A rectangular box of bricks, numbered as ``ct_mesh_create_box`` says, in layers along ``"x"``, ``"y"`` or ``"z"``."""
        box = ffi.new(
            "ct_box *",
            {
                "origin": list(origin),
                "size": list(size),
                "cells": list(cells),
                "layers": LAYERS[layers],
            },
        )
        out, error = ffi.new("ct_mesh **"), new_error()
        check(lib.ct_mesh_create_box(KINDS[element], box, out, error), error)
        mesh = cls(out[0])
        check(lib.ct_mesh_check(mesh.pointer, error), error)
        return mesh

    @classmethod
    def ring(cls, element: str, shape: Any) -> Mesh:
        """A ring of bricks, numbered as ``ct_mesh_create_ring`` says; ``shape`` has centre, radius, width and cells."""
        ring = ffi.new(
            "ct_ring *",
            {
                "centre": list(shape.centre),
                "radius": list(shape.radius),
                "width": shape.width,
                "cells": list(shape.cells),
            },
        )
        out, error = ffi.new("ct_mesh **"), new_error()
        check(lib.ct_mesh_create_ring(KINDS[element], ring, out, error), error)
        mesh = cls(out[0])
        check(lib.ct_mesh_check(mesh.pointer, error), error)
        return mesh

    @classmethod
    def copy(cls, nodes: np.ndarray, elements: np.ndarray) -> Mesh:
        """A checked copy of contiguous float64 ``nodes`` (n, 3) and int32 ``elements`` (cells, 8 or 20)."""
        if nodes.dtype != np.float64 or elements.dtype != np.int32:
            raise TypeError(
                f"nodes of {nodes.dtype} and elements of {elements.dtype}; float64 and int32 are needed"
            )
        kind = {8: lib.CT_HEX8, 20: lib.CT_HEX20}[elements.shape[1]]
        source = ffi.new(
            "ct_mesh *", {"kind": kind, "node_count": len(nodes), "element_count": len(elements)}
        )
        source.nodes = ffi.from_buffer("double[]", nodes)
        source.elements = ffi.from_buffer("int32_t[]", elements)
        out, error = ffi.new("ct_mesh **"), new_error()
        check(lib.ct_mesh_create_copy(source, out, error), error)
        return cls(out[0])

    def __reduce__(self) -> tuple[Any, ...]:
        return Mesh.copy, (np.ascontiguousarray(self.nodes), np.ascontiguousarray(self.elements))

    @cached_property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Smallest and largest coordinates of the nodes."""
        return self.nodes.min(axis=0), self.nodes.max(axis=0)

    @cached_property
    def shortest_edge(self) -> float:
        return lib.ct_mesh_shortest_edge(self.pointer)

    def _plane(self, face: str) -> tuple[int, float]:
        """Axis and coordinate of the plane of a face such as ``x_min``."""
        axis, side = "xyz".index(face[0]), 0 if face.endswith("min") else 1
        return axis, float(self.bounds[side][axis])

    def faces(self, face: str) -> tuple[np.ndarray, np.ndarray]:
        """Outer faces (m, 4 or 8), counter-clockwise from outside, of ``x_min`` ... ``z_max`` or ``outer`` (all), and their elements (m,)."""
        if face == "outer":
            ask = lambda faces, owners: lib.ct_mesh_outer_faces(self.pointer, faces, owners)
        else:
            axis, value = self._plane(face)
            ask = lambda faces, owners: lib.ct_mesh_plane_faces(
                self.pointer, axis, value, faces, owners
            )
        count = ask(ffi.NULL, ffi.NULL)
        check(-min(count, 0))
        faces = np.empty((count, 4 if self.element == "hex8" else 8), np.int32)
        owners = np.empty(count, np.int32)
        if count:
            check(
                -min(
                    ask(ffi.from_buffer("int32_t[]", faces), ffi.from_buffer("int32_t[]", owners)),
                    0,
                )
            )
        return faces, owners

    def face_nodes(self, face: str) -> np.ndarray:
        """Nodes of a face, ascending: all nodes in its plane, or those of all outer faces."""
        if face == "outer":
            return np.unique(self.faces(face)[0])
        axis, value = self._plane(face)
        nodes = np.empty(lib.ct_mesh_plane_nodes(self.pointer, axis, value, ffi.NULL), np.int32)
        if nodes.size:
            lib.ct_mesh_plane_nodes(self.pointer, axis, value, ffi.from_buffer("int32_t[]", nodes))
        return nodes

    def centres(self, positions: np.ndarray | None = None) -> np.ndarray:
        """
        The points ξ = 0 of all elements, (cells, 3), with the nodes at ``positions`` (the reference, if None). The sums pair opposite
        nodes, so that mirrored meshes have exactly mirrored centres.
        """
        x = (self.nodes if positions is None else positions)[self.elements]
        eight = lambda i: (x[:, i] + x[:, i + 2]) + (x[:, i + 1] + x[:, i + 3])
        corners = eight(0) + eight(4)
        if self.element == "hex8":
            return corners / 8.0
        return ((eight(8) + eight(12)) + eight(16) - corners) / 4.0

    def locate(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """
        The element that contains each point (m, 3) of the reference configuration, (m,), and the point's ξ in it, (m, 3).
        On a face between elements the one with the lowest number counts; -1 and NaN where no element contains the point.
        """
        x = self.nodes[self.elements]
        low, high = x.min(axis=1), x.max(axis=1)
        # A curved face of hex20 may bulge out of the box of its nodes.
        margin = (1e-9 if self.element == "hex8" else 0.3) * (high - low).max(axis=1, keepdims=True)
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

    def shape(self, xi: np.ndarray) -> np.ndarray:
        """Shape functions (8 or 20,) at one ξ."""
        return _shape(KINDS[self.element], xi)[: WIDTH[self.element]]

    def _inverse(self, x: np.ndarray, point: np.ndarray) -> np.ndarray | None:
        """ξ of a point in the element with the nodes ``x``, by Newton's method from the centre; None where it finds none."""
        kind, d = KINDS[self.element], x - point
        slopes = np.empty((20, 3))
        xi = np.zeros(3)
        for _ in range(30):
            lib.ct_brick_gradient(
                kind,
                ffi.from_buffer("double[]", xi),
                ffi.cast("double(*)[3]", ffi.from_buffer(slopes)),
            )
            try:
                change = np.linalg.solve(d.T @ slopes[: len(x)], _shape(kind, xi)[: len(x)] @ d)
            except np.linalg.LinAlgError:
                return None
            xi = xi - change
            if not np.abs(xi).max() < 10.0:
                return None
            if np.abs(change).max() < 1e-12:
                return xi
        return None


def rotation(X: np.ndarray, x: np.ndarray) -> np.ndarray:
    """The rotation (3, 3) that takes X nearest to x, both about their means."""
    left, _, right = np.linalg.svd((x - x.mean(axis=0)).T @ (X - X.mean(axis=0)))
    return left @ np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))]) @ right


def _shape(kind: int, xi: np.ndarray) -> np.ndarray:
    out = np.empty(20)
    lib.ct_brick_shape(
        kind,
        ffi.from_buffer("double[]", np.ascontiguousarray(xi, np.float64)),
        ffi.from_buffer("double[]", out),
    )
    return out


def need_h5py() -> Any:
    """The module h5py, or an error that says how to get it."""
    try:
        import h5py
    except ImportError:
        raise NotBuiltIn("reading files needs h5py: pip install libcontact[files]") from None
    return h5py


def read_vtkhdf(path: str | Path) -> tuple[np.ndarray, np.ndarray]:
    """
    Nodes (n, 3) and elements (cells, 8 or 20) of an unstructured grid in a VTKHDF file of one part, all cells of type
    12 (hex8) or all of type 25 (hex20). Of a transient file it is the mesh of the first step. A ValueError says what doesn't fit.
    """
    h5py = need_h5py()
    try:
        check_file(path)
        file = h5py.File(path, "r")
    except OSError as error:
        reason = "no such file" if not Path(path).exists() else str(error)
        raise ValueError(f'can\'t read "{path}": {reason}') from None
    with file:
        group = file.get("VTKHDF")
        if not isinstance(group, h5py.Group):
            raise ValueError(f'"{path}" has no group VTKHDF')
        kind = group.attrs.get("Type", b"")
        kind = kind.decode() if isinstance(kind, bytes) else str(kind)
        if kind != "UnstructuredGrid":
            raise ValueError(f'"{path}" holds "{kind}", not an UnstructuredGrid')
        wanted = ("NumberOfPoints", "NumberOfCells", "Points", "Connectivity", "Offsets", "Types")
        gone = [name for name in wanted if not isinstance(group.get(name), h5py.Dataset)]
        if gone:
            raise ValueError(f'"{path}" lacks VTKHDF/{gone[0]}')
        size = sum(group[name].nbytes for name in wanted)
        if size > physical_memory():
            raise ValueError(
                f'"{path}" holds a mesh of {size / 1e9:.3g} GB, and this machine has {physical_memory() / 1e9:.3g} GB'
            )
        return _grid(path, {name: group[name][()] for name in wanted}, "Steps" in group)


def _grid(
    path: str | Path, grid: dict[str, np.ndarray], transient: bool
) -> tuple[np.ndarray, np.ndarray]:
    if not transient and len(grid["NumberOfPoints"]) != 1:
        raise ValueError(f'"{path}" has {len(grid["NumberOfPoints"])} parts; one is needed')
    points, cells = int(grid["NumberOfPoints"][0]), int(grid["NumberOfCells"][0])
    kinds = sorted(set(grid["Types"][:cells].tolist()))
    if len(kinds) != 1 or kinds[0] not in VTK_TYPE:
        raise ValueError(
            f'"{path}" has cells of the VTK types {kinds}; all must be 12 (hex8) or all 25 (hex20)'
        )
    width = WIDTH[VTK_TYPE[kinds[0]]]
    if not np.array_equal(grid["Offsets"][: cells + 1], width * np.arange(cells + 1)):
        raise ValueError(f'"{path}": VTKHDF/Offsets does not count {width} nodes a cell')
    if len(grid["Connectivity"]) < cells * width or len(grid["Points"]) < points:
        raise ValueError(f'"{path}" is cut short')
    return grid["Points"][:points], grid["Connectivity"][: cells * width].reshape(cells, width)


def physical_memory() -> float:
    """Bytes of memory of this machine; infinite where the system does not report them."""
    try:
        return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, ValueError, OSError):
        return math.inf
