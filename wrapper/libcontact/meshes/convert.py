"""From a mesh as its file has it to the bricks of one body: the part that is wanted, splitting, sets, checks."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from .._core import lib
from ..bridge import Floats, Ints
from ..errors import Error, bare
from ..mesh import Mesh, c_mesh
from ..schema import nearest, suggestion
from .bricks import COLLAPSED, Split, extruded
from .raw import KINDS, Block, Numbers, Raw

# Bricks with the shape of other cells, with collapsed sides.
SHAPES = {"hex8": list(range(8)), "wedge6": list(COLLAPSED), "tet4": [0, 1, 2, 2, 3, 3, 3, 3]}


@dataclass(frozen=True)
class Report:
    """
    What was done with the cells of a file.

    Attributes
    ----------
    format : str
        Format and version of the file.
    read : dict of str to int
        The cells that the bricks were made of, by kind.
    dropped : dict of str to int
        What is in the file and not in the mesh, by kind: lines, points, surfaces, nodes that no element has.
    split : bool
        Whether cells were split into bricks.
    step_factor : float
        Estimated factor by which splitting reduces the stable step: the shortest edge after and before; 1 without
        splitting.
    notes : tuple of str
        What else a user should know.
    """

    format: str
    read: dict[str, int]
    dropped: dict[str, int]
    split: bool = False
    step_factor: float = 1.0
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class MeshData:
    """
    The bricks of a mesh file, and its named sets.

    Attributes
    ----------
    nodes : ndarray of float64, shape (n, 3)
        Coordinates [length].
    elements : ndarray of int32, shape (cells, 8 or 20)
        Node numbers in VTK's order.
    node_sets : dict of str to ndarray of int32
        Node numbers, ascending.
    face_sets : dict of str to ndarray of int32, shape (m, 2)
        Element and number of its face, in the order x_min, x_max, y_min, y_max, z_min, z_max of a brick along the
        axes; ascending.
    element_sets : dict of str to ndarray of int32
        Element numbers, ascending.
    report : Report
        What was converted and what was dropped.
    cells : ndarray of int64
        The cells of the file that became bricks, counted through the file.
    outside : frozenset of str
        Names of the file's sets that have no members in the part that was read.
    """

    nodes: Floats
    elements: Ints
    node_sets: dict[str, Ints]
    face_sets: dict[str, Ints]
    element_sets: dict[str, Ints]
    report: Report
    cells: Numbers = field(default_factory=lambda: np.empty(0, np.int64))
    outside: frozenset[str] = frozenset()


@dataclass
class Chosen:
    """The cells that become bricks, and sets of them; nodes still have the numbers of the file."""

    blocks: list[Block]
    # The number of each cell of the file among the chosen ones, or -1.
    number: Numbers
    nodes: Floats
    faces: dict[str, Numbers] = field(default_factory=dict)
    elements: dict[str, Numbers] = field(default_factory=dict)
    sets: dict[str, Numbers] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)


def convert(
    raw: Raw, part: str | None, scale: float, extrude: tuple[float, int] | None
) -> MeshData:
    """The bricks of a mesh, see ``read_mesh``."""
    _check_sets(raw)
    solid = 3 if extrude is None else 2
    mask = _part(raw, part)
    dropped = Counter(raw.dropped)
    chosen = _choose(raw, mask, solid, dropped)
    _collect(raw, chosen, mask, solid, part)
    read = Counter[str]()
    for block in chosen.blocks:
        read[block.kind] += len(block.nodes)
    if extrude is not None:
        _extrude(raw, chosen, *extrude)
    found = _finish(raw, chosen, scale, dict(read), dropped)
    of_file = {_short(raw, name, part) for sets in raw.sets for name in sets}
    kept = {*found.node_sets, *found.face_sets, *found.element_sets}
    cells = np.flatnonzero(chosen.number >= 0)
    return replace(found, cells=cells, outside=frozenset(of_file - kept))


def _check_sets(raw: Raw) -> None:
    """A set without members is a mistake in the file."""
    for what, sets in zip(("node", "face", "element"), raw.sets):
        for name, members in sets.items():
            if not len(members):
                raise raw.reading.wrong(f'the {what} set "{name}" is empty')


def _part(raw: Raw, part: str | None) -> Any:
    """Which cells are wanted."""
    count = sum(len(block.nodes) for block in raw.blocks)
    if part is None:
        return np.ones(count, bool)
    names = {name.upper(): name for name in raw.element_sets}
    name = part if part in raw.element_sets else names.get(part.upper(), "")
    if not name:
        near = suggestion(part, list(raw.element_sets))
        known = ", ".join(f'"{each}"' for each in nearest(part, raw.element_sets)) or "none"
        raise raw.reading.wrong(
            f'no part or set of elements is named "{part}"{near}; it has {known}'
        )
    mask = np.zeros(count, bool)
    mask[raw.element_sets[name]] = True
    return mask


def _choose(raw: Raw, mask: Any, solid: int, dropped: Counter[str]) -> Chosen:
    """Choose the cells that become bricks; count and refuse others."""
    blocks, number = list[Block](), np.full(len(mask), -1, np.int64)
    start = count = 0
    for block in raw.blocks:
        here = mask[start : start + len(block.nodes)]
        kind = KINDS[block.kind]
        rows = np.flatnonzero(here)
        if kind.dimension > solid and rows.size:
            raise raw.reading.wrong(
                f"has {block.kind} elements; only a mesh of surfaces is extruded"
            )
        if kind.dimension == solid and rows.size:
            _check_kind(raw, block, int(rows[0]), solid)
            lines = np.array(block.lines, np.int64)
            lines = lines[rows] if len(lines) else lines
            whole = len(rows) == len(block.nodes)  # needs no copies, which are large
            nodes = block.nodes if whole else block.nodes[rows]
            labels = block.labels if whole else block.labels[rows]
            blocks.append(Block(block.kind, nodes, labels, lines, block.owner))
            number[start + rows] = count + np.arange(len(rows))
            count += len(rows)
        elif kind.dimension < solid and rows.size:
            dropped[block.kind] += len(rows)
        start += len(block.nodes)
    kinds = {block.kind for block in blocks}
    if not blocks:
        there = ", ".join(f"{n} {kind}" for kind, n in dropped.items()) or "nothing"
        cure = "mesh the volume, or extrude surfaces: extrude = { height = ..., layers = ... } in a scene, "
        cure = f"; {cure}--extrude HEIGHT LAYERS of libcontact mesh" if solid == 3 else ""
        raise raw.reading.wrong(f"has no bricks, wedges or tetrahedra, but {there}{cure}")
    if "hex20" in kinds and len(kinds) > 1:
        others = ", ".join(sorted(kinds - {"hex20"}))
        text = f"has hex20 and {others}; one body has elements of one kind, and only hex8 is split"
        raise raw.reading.wrong(f"{text}: read them as parts of their own")
    return Chosen(blocks, number, raw.nodes)


def _check_kind(raw: Raw, block: Block, row: int, solid: int) -> None:
    """Refuse kinds that do not become bricks."""
    if block.kind in (("hex8", "hex20", "wedge6", "tet4") if solid == 3 else ("quad4", "tri3")):
        return
    who, line = block.who(row)
    cure = KINDS[block.kind].cure or "mesh with first-order elements"
    raise raw.reading.wrong(f"{who} is a {block.kind}, which does not become bricks: {cure}", line)


def _collect(raw: Raw, chosen: Chosen, mask: Any, solid: int, part: str | None) -> None:
    """Sets of the chosen cells; what has a lower dimension gives faces or nodes."""
    used = np.zeros(len(raw.nodes), bool)
    for block in chosen.blocks:
        used[block.nodes] = True
    dimension = np.concatenate([np.full(len(b.nodes), KINDS[b.kind].dimension) for b in raw.blocks])
    wanted = dict[str, Numbers]()
    for name, cells in raw.element_sets.items():
        name = _short(raw, name, part)
        here = chosen.number[cells]
        if (here >= 0).any():
            chosen.elements[name] = np.unique(here[here >= 0])
        lower = dimension[cells]
        if (lower == solid - 1).any():
            wanted[name] = _corners(raw, cells[lower == solid - 1])
        if (lower < solid - 1).any():
            nodes = np.unique(_corners(raw, cells[lower < solid - 1]))
            chosen.sets[name] = nodes[(nodes >= 0) & used[nodes]]
    for name, pairs in raw.face_sets.items():
        here = chosen.number[pairs[:, 0]]
        found = np.column_stack([here, pairs[:, 1]])[here >= 0]
        if len(found):
            chosen.faces[_short(raw, name, part)] = np.unique(found, axis=0)
    for name, nodes in raw.node_sets.items():
        name = _short(raw, name, part)
        found = np.unique(nodes[used[nodes]])
        chosen.sets[name] = np.union1d(found, chosen.sets.get(name, found[:0]))
    _find_faces(chosen, wanted, part)
    for name in [name for name, nodes in chosen.sets.items() if not nodes.size]:
        del chosen.sets[name]
        if part is None:
            chosen.notes.append(f'no element has a node of the set "{name}", so it is left out')


def _short(raw: Raw, name: str, part: str | None) -> str:
    """The name of a set, without the instance that is read alone or is the only one."""
    owner, dot, rest = name.partition(".")
    alone = len(raw.parts) == 1 or part is not None and owner.upper() == part.upper()
    return rest if dot and owner in raw.parts and alone else name


def _corners(raw: Raw, cells: Numbers) -> Numbers:
    """Corner nodes of cells of lower dimension, shape (m, 4), filled up with -1."""
    out, start = np.full((len(cells), 4), -1, np.int64), 0
    for block in raw.blocks:
        here = (cells >= start) & (cells < start + len(block.nodes))
        if here.any():
            width = min(4, KINDS[block.kind].corners)
            out[here, :width] = block.nodes[cells[here] - start, :width]
        start += len(block.nodes)
    return out


def _find_faces(chosen: Chosen, wanted: dict[str, Numbers], part: str | None) -> None:
    """Face sets of cells that are given by corner nodes: the lowest cell that has the face."""
    if not wanted:
        return
    marked = np.zeros(len(chosen.nodes) + 1, bool)  # the last one stands for -1
    for corners in wanted.values():
        marked[corners] = True
    rows, owners, start = [np.empty((0, 4), np.int64)], [np.empty((0, 2), np.int64)], 0
    for block in chosen.blocks:
        for number, face in enumerate(KINDS[block.kind].faces):
            corners = block.nodes[:, list(face)]
            here = np.flatnonzero(marked[corners].all(axis=1))
            row = np.full((len(here), 4), -1, np.int64)
            row[:, : len(face)] = corners[here]
            rows.append(row)
            owners.append(np.column_stack([start + here, np.full(len(here), number)]))
        start += len(block.nodes)
    owner = np.concatenate(owners)
    order = np.lexsort((owner[:, 1], owner[:, 0]))
    table, owner = np.sort(np.concatenate(rows), axis=1)[order], owner[order]
    keys = np.concatenate([table, *(np.sort(corners, axis=1) for corners in wanted.values())])
    _, inverse = np.unique(keys, axis=0, return_inverse=True)
    inverse = inverse.ravel()
    first = np.full(len(keys), -1)
    first[inverse[: len(table)][::-1]] = np.arange(len(table))[::-1]
    at = len(table)
    for name, corners in wanted.items():
        found = first[inverse[at : at + len(corners)]]
        at += len(corners)
        lost = int((found < 0).sum())
        if lost and part is None:
            text = f'{lost} of {len(corners)} faces of the set "{name}" are on no element'
            chosen.notes.append(text)
        if lost < len(corners):
            here = np.concatenate([owner[found[found >= 0]], chosen.faces.get(name, owner[:0])])
            chosen.faces[name] = np.unique(here, axis=0)


def _extrude(raw: Raw, chosen: Chosen, height: float, layers: int) -> None:
    """Make bricks and wedges of surfaces in a plane z = const."""
    used = np.unique(np.concatenate([block.nodes.ravel() for block in chosen.blocks]))
    x, n = chosen.nodes[used], len(chosen.nodes)
    size = float(np.ptp(x, axis=0).max())
    if np.ptp(x[:, 2]) > 1e-9 * size:
        text = f"has surfaces from z = {x[:, 2].min():g} to {x[:, 2].max():g}"
        raise raw.reading.wrong(f"{text}; only a mesh in a plane z = const is extruded along z")
    raw.reading.check_size(100.0 * n * (layers + 1.0) / 8.0, "the layers")
    start, edges = 0, dict[str, Numbers]()
    counts = [len(block.nodes) for block in chosen.blocks]
    starts = np.cumsum([0, *counts])
    for name, pairs in chosen.faces.items():
        found = []
        for block, start in zip(chosen.blocks, starts):
            here = pairs[(pairs[:, 0] >= start) & (pairs[:, 0] < start + len(block.nodes))]
            ends = np.array(KINDS[block.kind].faces)[here[:, 1]]
            found.append(np.take_along_axis(block.nodes[here[:, 0] - start], ends, axis=1))
        edges[name] = np.concatenate(found)
    chosen.nodes, chosen.blocks = extruded(chosen.nodes, chosen.blocks, height, layers)
    above = np.arange(layers)
    wanted = {
        name: np.concatenate(
            [np.hstack([ends + k * n, ends[:, ::-1] + (k + 1) * n]) for k in above]
        )
        for name, ends in edges.items()
    }
    chosen.faces = {}
    _find_faces(chosen, wanted, None)
    chosen.sets = {
        name: np.concatenate([nodes + k * n for k in range(layers + 1)])
        for name, nodes in chosen.sets.items()
    }
    blocks = np.repeat(np.arange(len(counts)), counts)
    for name, cells in chosen.elements.items():
        of, row = blocks[cells], cells - starts[blocks[cells]]
        found = [
            layers * starts[of] + row + k * np.array(counts, np.int64)[of] for k in range(layers)
        ]
        chosen.elements[name] = np.sort(np.concatenate(found))


def _finish(
    raw: Raw, chosen: Chosen, scale: float, read: dict[str, int], dropped: Counter[str]
) -> MeshData:
    """Split, renumber, scale and check."""
    factor, split = 1.0, "tet4" in read
    nodes, faces, cells = chosen.nodes, chosen.faces, chosen.elements
    if split or any(block.kind == "wedge6" for block in chosen.blocks):
        shapes = [block.nodes[:, SHAPES[block.kind]] for block in chosen.blocks]
        whole = np.concatenate(shapes).astype(np.int32)
        _check(raw, chosen, nodes, whole, np.arange(len(whole)))
        made = Split(nodes, chosen.blocks)
        elements, parents = made.elements, made.parents
        if split:
            factor = shortest(made.nodes, elements) / shortest(nodes, whole)
        nodes = made.nodes
        faces = {name: made.of_faces(pairs) for name, pairs in faces.items()}
        cells = {name: made.of_cells(found) for name, found in cells.items()}
        _split_nodes(made, chosen)
    else:
        elements = np.concatenate([block.nodes for block in chosen.blocks])
        parents = np.arange(len(elements))
    used = np.zeros(len(nodes), bool)
    used[elements] = True
    number = np.cumsum(used) - 1
    if (~used).any() and len(raw.nodes):
        dropped["nodes without elements"] += int((~used).sum())
    nodes = np.ascontiguousarray(nodes[used] * scale)
    elements = np.ascontiguousarray(number[elements], np.int32)
    _check(raw, chosen, nodes, elements, parents)
    sets = {name: number[found[used[found]]] for name, found in chosen.sets.items()}
    report = Report(raw.format, read, dict(dropped), split, factor, tuple(chosen.notes))
    return MeshData(nodes, elements, _small(sets), _small(faces), _small(cells), report)


def _small(sets: dict[str, Numbers]) -> dict[str, Ints]:
    return {name: np.ascontiguousarray(found, np.int32) for name, found in sets.items()}


def _split_nodes(made: Split, chosen: Chosen) -> None:
    """New nodes belong to a node set if all nodes do whose mean they are, on a face or an edge of a cell."""
    for name, nodes in chosen.sets.items():
        inside = np.zeros(made.count, bool)
        inside[nodes] = True
        chosen.sets[name] = np.union1d(nodes, made.between(inside))


def shortest(nodes: Floats, elements: Any) -> float:
    """The shortest edge of any element [length]."""
    elements = np.ascontiguousarray(elements, np.int32)
    return float(lib.ct_mesh_shortest_edge(c_mesh(np.ascontiguousarray(nodes), elements)))


def _check(raw: Raw, chosen: Chosen, nodes: Floats, elements: Ints, parents: Numbers) -> None:
    """Check the bricks; errors name the cell of the file."""
    starts = np.cumsum([0, *(len(block.nodes) for block in chosen.blocks)])

    def who(element: int) -> tuple[str, int]:
        cell = int(parents[element])
        number = int(np.searchsorted(starts, cell, side="right")) - 1
        return chosen.blocks[number].who(cell - int(starts[number]))

    try:
        Mesh.copy(nodes, np.ascontiguousarray(elements, np.int32))
    except Error as error:
        at = error.element
        line = 0 if at is None else who(at)[1]
        text = re.sub(r" \(node \d+\)", "", bare(str(error)))  # of the mesh, not of the file
        text = re.sub(r"\belement (\d+)", lambda found: who(int(found[1]))[0], text)
        raise raw.reading.wrong(text, line) from None
