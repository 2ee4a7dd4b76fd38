"""Bricks of wedges, tetrahedra and surfaces.

A tetrahedron becomes four bricks, by splitting its edges in the middle and its faces at their centres. An edge that is
split must be split in every cell that has it. So is then the opposite edge of each quadrilateral that has it, and the
other edges of each triangle. A brick is split along those of its three axes whose edges are: into 1, 2, 4 or 8. A wedge
whose triangles are split becomes three bricks, or six if its height is split, too. A wedge whose triangles are not
split stays one: a brick with a collapsed side, which has the shape functions of the wedge.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from functools import cache
from typing import Any

import numpy as np

from ..bridge import Floats
from .raw import BRICK, KINDS, Block, Numbers

# A point of a split cell: the corners whose mean it is.
Point = tuple[int, ...]
# The corner of VTK's brick at each place of a lattice of 2 x 2 x 2.
VTK: dict[tuple[int, ...], int] = {(0, 0, 0): 0, (1, 0, 0): 1, (1, 1, 0): 2, (0, 1, 0): 3}
VTK |= {(*place[:2], 1): corner + 4 for place, corner in list(VTK.items())}
# Edges of the cells, in classes that are split together: those of a brick along its three axes, those along the height
# of a wedge and those of its triangles, each of a tetrahedron.
CLASSES = {
    "hex8": (
        ((0, 1), (3, 2), (4, 5), (7, 6)),
        ((0, 3), (1, 2), (4, 7), (5, 6)),
        ((0, 4), (1, 5), (2, 6), (3, 7)),
    ),
    "wedge6": (((0, 3), (1, 4), (2, 5)), ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3))),
    "tet4": tuple((edge,) for edge in itertools.combinations(range(4), 2)),
}
# A wedge as a brick with a collapsed side.
COLLAPSED = (0, 1, 2, 2, 3, 4, 5, 5)


def _points(cell: Iterable[int]) -> Point:
    return tuple(sorted(set(cell)))


@cache
def children(kind: str, split: tuple[bool, ...]) -> tuple[tuple[Point, ...], ...]:
    """The bricks of a cell whose classes of edges are split or not: the points of each in VTK's order."""
    if kind == "hex8":
        return tuple(
            _brick(split, cell) for cell in itertools.product(*(range(1 + s) for s in split))
        )
    if kind == "wedge6":
        levels = [((0, 0), (0, 1)), ((0, 1), (1, 1))] if split[0] else [((0, 0), (1, 1))]
        if not split[1]:
            return tuple(_whole_wedge(*level) for level in levels)
        return tuple(_corner_of_wedge(a, *level) for level in levels for a in range(3))
    return tuple(_corner_of_tet(a) for a in range(4))


def _brick(split: tuple[bool, ...], cell: tuple[int, ...]) -> tuple[Point, ...]:
    """One of the bricks of a brick. Along an axis it has one end, the middle or the other end of its edges."""

    def ends(axis: int, side: int) -> tuple[int, ...]:
        if not split[axis]:
            return (side,)
        return (0,) if cell[axis] + side == 0 else (1,) if cell[axis] + side == 2 else (0, 1)

    corners = sorted(VTK, key=lambda place: VTK[place])
    return tuple(
        _points(
            VTK[place] for place in itertools.product(*(ends(a, s) for a, s in enumerate(corner)))
        )
        for corner in corners
    )


def _whole_wedge(low: tuple[int, int], high: tuple[int, int]) -> tuple[Point, ...]:
    """A wedge between two of its levels."""
    return tuple(
        _points(corner % 3 + 3 * z for z in (low if i < 4 else high))
        for i, corner in enumerate(COLLAPSED)
    )


def _corner_of_wedge(a: int, low: tuple[int, int], high: tuple[int, int]) -> tuple[Point, ...]:
    """The brick at an edge of a wedge, between two of its levels: bottom (0, 0), middle (0, 1), top (1, 1)."""
    b, c = (a + 1) % 3, (a + 2) % 3
    triangle = ((a,), (a, b), (a, b, c), (a, c))
    return tuple(
        _points(corner + 3 * z for corner in corners for z in level)
        for level in (low, high)
        for corners in triangle
    )


def _corner_of_tet(a: int) -> tuple[Point, ...]:
    """The brick at a corner of a tetrahedron."""
    b, c, d = {0: (1, 2, 3), 1: (2, 0, 3), 2: (0, 1, 3), 3: (0, 2, 1)}[a]
    points = ((a,), (a, b), (a, b, c), (a, c), (a, d), (a, b, d), (a, b, c, d), (a, c, d))
    return tuple(_points(point) for point in points)


@cache
def faces(kind: str, split: tuple[bool, ...]) -> tuple[tuple[tuple[int, int], ...], ...]:
    """For each face of the cell: the children on it, and their faces there."""
    found = []
    for corners in KINDS[kind].faces:
        inside = set(corners)
        found.append(
            tuple(
                (number, side)
                for number, child in enumerate(children(kind, split))
                for side, four in enumerate(BRICK)
                if all(set(child[i]) <= inside for i in four) and len({child[i] for i in four}) > 2
            )
        )
    return tuple(found)


def components(count: int, a: Numbers, b: Numbers) -> Numbers:
    """The smallest number that each of ``count`` numbers is joined with, through pairs."""
    label = np.arange(count)
    while True:
        least = np.minimum(label[a], label[b])
        before = label.copy()
        for end in (a, b):
            np.minimum.at(label, before[end], least)
            np.minimum.at(label, end, least)
        label = label[label]
        if np.array_equal(label, before):
            return label


class Split:
    """
    Bricks of cells that are bricks, wedges and tetrahedra; ``wedges``: split all wedges, too, into three.

    Attributes
    ----------
    nodes : ndarray, shape (n, 3)
        Coordinates; those of the cells come first.
    elements : ndarray, shape (m, 8)
        Node numbers of the bricks.
    parents : ndarray, shape (m,)
        The cell of each brick.
    """

    def __init__(self, nodes: Floats, blocks: list[Block], wedges: bool = False):
        self.blocks, self.wedges = blocks, wedges
        self.old, self.count = nodes, len(nodes)
        self.classes = self._classes()
        self.starts = np.cumsum([0, *(len(block.nodes) for block in blocks)])
        self.new: dict[Point, int] = {}
        # For each group of cells with one way to be split: block, cells of the block, way, first child.
        self.groups: list[tuple[int, Numbers, tuple[bool, ...], int]] = []
        self._make()

    def _classes(self) -> list[Any]:
        """For each block, which classes of edges of each cell are split, shape (cells, classes)."""
        ends, shapes = [], []
        for block in self.blocks:
            for group in CLASSES[block.kind]:
                pairs = block.nodes[:, np.array(group)]
                ends.append(np.sort(pairs, axis=2).reshape(-1, 2))
                shapes.append(pairs.shape[:2])
        pairs = np.concatenate(ends)
        _, edges = np.unique(pairs[:, 0] * self.count + pairs[:, 1], return_inverse=True)
        count, at = int(edges.max()) + 1, 0
        found, a, b = [], [], []
        for rows, width in shapes:
            here = edges[at : at + rows * width].reshape(rows, width)
            at += rows * width
            found.append(here[:, 0])
            for i in range(1, width):
                a.append(here[:, 0])
                b.append(here[:, i])
        label = components(
            count, *(np.concatenate([np.empty(0, np.int64), *ends]) for ends in (a, b))
        )
        split, k = np.zeros(count, bool), 0
        for block in self.blocks:
            for i in range(len(CLASSES[block.kind])):
                if block.kind == "tet4" or (self.wedges and block.kind == "wedge6" and i == 1):
                    split[label[found[k]]] = True
                k += 1
        out, k = [], 0
        for block in self.blocks:
            width = len(CLASSES[block.kind])
            out.append(np.column_stack([split[label[found[k + i]]] for i in range(width)]))
            k += width
        return out

    def _make(self) -> None:
        """Make the points and bricks."""
        parts, parents, keys = [], [], []
        first = 0
        for number, block in enumerate(self.blocks):
            ways = self.classes[number]
            for way in np.unique(ways, axis=0) if len(ways) else []:
                cells = np.flatnonzero((ways == way).all(axis=1))
                made = children(block.kind, tuple(bool(s) for s in way))
                self.groups.append((number, cells, tuple(bool(s) for s in way), first))
                first += len(cells) * len(made)
                for child in made:
                    for point in child:
                        row = np.full((len(cells), 8), -1, np.int64)
                        row[:, : len(point)] = np.sort(block.nodes[cells][:, list(point)], axis=1)
                        keys.append(row)
                    parts.append(len(cells))
                    parents.append(self.starts[number] + cells)
        table = np.concatenate(keys)
        single = table[:, 1] < 0
        index = np.where(single, table[:, 0], -1)
        rows, inverse = np.unique(table[~single], axis=0, return_inverse=True)
        index[~single] = self.count + inverse.ravel()
        self.nodes = np.concatenate([self.old, self._means(rows)])
        self._rows = rows
        out, at = [], 0
        for count in parts:
            out.append(index[at : at + 8 * count].reshape(8, count).T)
            at += 8 * count
        order = np.argsort(np.concatenate(parents), kind="stable")
        self.elements = np.concatenate(out)[order]
        self.parents = np.concatenate(parents)[order]
        self._position = np.empty(len(order), np.int64)
        self._position[order] = np.arange(len(order))

    def _means(self, rows: Numbers) -> Floats:
        """Means of nodes that do not depend on their order, nor on a mirror."""
        x, out = self.old, np.empty((len(rows), 3))
        two = rows[:, 2] < 0
        pair = x[rows[two][:, :2]]
        out[two] = (pair[:, 0] + pair[:, 1]) / 2.0
        for i in np.flatnonzero(~two).tolist():
            row = rows[i][rows[i] >= 0]
            out[i] = [math.fsum(column) / len(row) for column in x[row].T.tolist()]
        return out

    def between(self, inside: Any) -> Numbers:
        """The new nodes that are means of nodes ``inside`` alone."""
        return self.count + np.flatnonzero((inside[self._rows] | (self._rows < 0)).all(axis=1))

    def of_cells(self, cells: Numbers) -> Numbers:
        """The bricks of these cells, in ascending order."""
        wanted = np.zeros(self.starts[-1], bool)
        wanted[cells] = True
        return np.flatnonzero(wanted[self.parents])

    def of_faces(self, pairs: Numbers) -> Numbers:
        """The faces of bricks that lie on faces of cells, as pairs (element, face) in ascending order."""
        found = [np.empty((0, 2), np.int64)]
        for number, cells, way, first in self.groups:
            block = self.blocks[number]
            for face, parts in enumerate(faces(block.kind, way)):
                here = pairs[pairs[:, 1] == face, 0] - self.starts[number]
                here = here[(here >= 0) & (here < len(block.nodes))]
                at = np.searchsorted(cells, here)
                at = at[(at < len(cells)) & (cells[np.minimum(at, len(cells) - 1)] == here)]
                for child, side in parts:
                    position = self._position[first + child * len(cells) + at]
                    found.append(np.column_stack([position, np.full(len(at), side)]))
        return np.unique(np.concatenate(found), axis=0)


def extruded(
    nodes: Floats, blocks: list[Block], height: float, layers: int
) -> tuple[Floats, list[Block]]:
    """Nodes and bricks or wedges of surfaces in the plane z = const, extruded along z. Node i of layer k has the
    number i + k n; the cells of a block follow layer by layer."""
    n = len(nodes)
    lifted = [nodes + [0.0, 0.0, height * k / layers] for k in range(layers + 1)]
    out = []
    for block in blocks:
        flat = block.nodes[:, : KINDS[block.kind].corners]
        kind = {"quad4": "hex8", "tri3": "wedge6"}[block.kind]
        x = nodes[flat]
        first, last = x[:, 1] - x[:, 0], x[:, -1] - x[:, 0]
        turned = first[:, 0] * last[:, 1] - first[:, 1] * last[:, 0] < 0.0
        flat = np.where(turned[:, None], flat[:, ::-1], flat)
        cells = [np.hstack([flat + k * n, flat + (k + 1) * n]) for k in range(layers)]
        lines = np.tile(np.array(block.lines, np.int64), layers)
        labels = np.tile(block.labels, layers)
        out.append(Block(kind, np.concatenate(cells), labels, lines, block.owner))
    return np.concatenate(lifted), out
