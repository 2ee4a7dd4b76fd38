"""Reading of VTK's unstructured grids: .vtu by meshio, and VTKHDF by h5py. They have no named sets; integers on cells
or points stand for them."""

from __future__ import annotations

import contextlib
import io
from typing import Any

import numpy as np

from ..errors import NotBuiltIn, install
from ..mesh import open_hdf5, physical_memory, text_in
from .hdf5 import dataset
from .raw import KINDS, Block, Numbers, Raw, Reading

# VTK's and meshio's kinds of cells.
TYPES = {1: "point", 3: "line2", 21: "line3", 5: "tri3", 22: "tri6", 9: "quad4", 23: "quad8"}
TYPES |= {28: "quad9", 10: "tet4", 24: "tet10", 14: "pyramid5", 27: "pyramid13", 13: "wedge6"}
TYPES |= {26: "wedge15", 32: "wedge18", 12: "hex8", 25: "hex20", 29: "hex27"}
NAMES = {"vertex": "point", "line": "line2", "line3": "line3", "triangle": "tri3"}
NAMES |= {"triangle6": "tri6", "quad": "quad4", "quad8": "quad8", "quad9": "quad9"}
NAMES |= {"tetra": "tet4", "tetra10": "tet10", "pyramid": "pyramid5", "pyramid13": "pyramid13"}
NAMES |= {"pyramid14": "pyramid14", "wedge": "wedge6", "wedge15": "wedge15", "wedge18": "wedge18"}
NAMES |= {"hexahedron": "hex8", "hexahedron20": "hex20", "hexahedron27": "hex27"}
MOST_VALUES = 100  # of integers on cells or points that stand for sets


def read_vtu(reading: Reading) -> Raw:
    """Read a .vtu file."""
    try:
        from meshio.vtu import read
    except ImportError:
        text = f"reading .vtu files needs meshio: {install('mesh')}"
        raise NotBuiltIn(text) from None
    told = io.StringIO()
    with contextlib.redirect_stderr(told):
        mesh = read(reading.path)
    if "cannot handle" in told.getvalue():  # it leaves such cells out
        raise reading.wrong(" ".join(told.getvalue().split()))
    raw = Raw(reading, "VTU", _points(reading, mesh.points), [])
    order, first = list[Numbers](), 0
    unknown = [block for block in mesh.cells if block.type not in NAMES]
    if unknown:
        raise reading.wrong(f'cells of the kind "{unknown[0].type}" are not read')
    for kind in dict.fromkeys(NAMES[block.type] for block in mesh.cells):
        found, labels = [], []
        start = 0
        for block in mesh.cells:
            if NAMES[block.type] == kind:
                found.append(np.asarray(block.data, np.int64).reshape(-1, KINDS[kind].width))
                labels.append(np.arange(start, start + len(block.data)))
            start += len(block.data)
        _add(raw, kind, np.concatenate(found), np.concatenate(labels))
        order.append(raw.blocks[-1].labels)
        first += len(order[-1])
    cells = np.concatenate(order) if order else np.empty(0, np.int64)
    for name, values in mesh.cell_data.items():
        _sets(raw, raw.element_sets, name, np.concatenate([np.asarray(v) for v in values]), cells)
    for name, values in mesh.point_data.items():
        _sets(raw, raw.node_sets, name, np.asarray(values), np.arange(len(raw.nodes)))
    return raw


def read_vtkhdf(reading: Reading) -> Raw:
    """Read a VTKHDF file: one part, an unstructured grid; of a transient file the first step."""
    wrong = reading.wrong
    wanted = ("NumberOfPoints", "NumberOfCells", "Points", "Connectivity", "Offsets", "Types")
    with open_hdf5(reading.path) as file:
        group = file.get("VTKHDF")
        if not hasattr(group, "attrs") or not hasattr(group, "keys"):
            raise wrong("has no group VTKHDF")
        kind = text_in(group.attrs.get("Type", b""))
        if kind != "UnstructuredGrid":
            raise wrong(f'contains "{kind}", not an UnstructuredGrid')
        sets = {name: dataset(reading, group, name) for name in wanted}
        for name, found in sets.items():
            if found is None:
                raise wrong(f"lacks VTKHDF/{name}")
        size, memory = sum(found.nbytes for found in sets.values()) / 1e9, physical_memory() / 1e9
        if size > memory:
            text = (
                f"contains a mesh of {size:.3g} GB, and this machine has {memory:.3g} GB of memory"
            )
            raise wrong(text)
        reading.check_size(1e9 * size, "the nodes and cells")
        parts, cells, points, connectivity, offsets, types = (sets[name][()] for name in wanted)
        if "Steps" not in group and len(parts) != 1:
            raise wrong(f"has {len(parts)} parts; one is needed")
        data = {
            (where, name): dataset(reading, group, f"{where}/{name}")[()]
            for where in ("CellData", "PointData")
            for name in _integers(reading, group, where)
        }
    node_count, count = int(parts[0]), int(cells[0])
    if not (0 <= node_count <= len(points) and 0 <= count <= len(types)):
        raise wrong("is cut short")
    types, offsets = types[:count].astype(np.int64), offsets[: count + 1].astype(np.int64)
    unknown = sorted(set(types.tolist()) - TYPES.keys())
    if unknown:
        raise wrong(f"has cells of the VTK types {unknown}; those that are read are {TYPES}")
    widths = np.array([KINDS[TYPES[number]].width for number in types.tolist()], np.int64)
    if not np.array_equal(offsets, np.concatenate([[0], np.cumsum(widths)])):
        raise wrong("VTKHDF/Offsets does not count the nodes of each cell")
    if len(connectivity) < widths.sum():
        raise wrong("is cut short")
    raw, order = Raw(reading, "VTKHDF", _points(reading, points[:node_count]), []), []
    for number in dict.fromkeys(types.tolist()):
        here = np.flatnonzero(types == number)
        width = KINDS[TYPES[number]].width
        found = connectivity[offsets[here][:, None] + np.arange(width)].astype(np.int64)
        _add(raw, TYPES[number], found, here)
        order.append(here)
    positions = np.concatenate(order) if order else np.empty(0, np.int64)
    for (where, name), values in data.items():
        if where == "CellData":
            _sets(raw, raw.element_sets, name, values[:count], positions)
        else:
            _sets(raw, raw.node_sets, name, values[:node_count], np.arange(node_count))
    return raw


def _integers(reading: Reading, group: Any, where: str) -> list[str]:
    """Names of datasets of whole numbers in a group."""
    found = group.get(where)
    out = []
    for name in found.keys() if hasattr(found, "keys") else ():
        each = dataset(reading, group, f"{where}/{name}")
        if each is not None and each.dtype.kind in "iu" and each.ndim == 1:
            reading.check_size(each.nbytes, name)
            out.append(name)
    return out


def _points(reading: Reading, points: Any) -> Any:
    """Coordinates, which must be finite."""
    points = np.asarray(points, np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise reading.wrong(f"has points of the shape {points.shape}, not three coordinates each")
    if not np.isfinite(points).all():
        bad = np.argmin(np.isfinite(points).all(axis=1))
        raise reading.wrong(f"a coordinate of node {bad} is not finite")
    return points


def _add(raw: Raw, kind: str, nodes: Numbers, labels: Numbers) -> None:
    """Add cells of one kind. VTK's wedge has its first triangle outward, but many programs write it inward."""
    outside = (nodes < 0) | (nodes >= len(raw.nodes))
    if outside.any():
        row = int(np.argmax(outside.any(axis=1)))
        text = f"element {labels[row]} has node {nodes[row][outside[row]][0]}"
        raise raw.reading.wrong(f"{text}, but there are {len(raw.nodes)} nodes")
    if kind == "wedge6":
        x = raw.nodes[nodes]
        normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
        rise = x[:, 3:].mean(axis=1) - x[:, :3].mean(axis=1)
        turned = np.einsum("ij,ij->i", normal, rise) < 0.0
        nodes = np.where(turned[:, None], nodes[:, [3, 4, 5, 0, 1, 2]], nodes)
    raw.blocks.append(Block(kind, nodes, labels))


def _sets(raw: Raw, sets: dict[str, Numbers], name: str, values: Any, members: Numbers) -> None:
    """Sets ``name_value`` of whole numbers on cells or points, if they have few values."""
    if values.ndim != 1 or values.dtype.kind not in "iu" or not len(members):
        return
    if len(values) <= members.max():
        raise raw.reading.wrong(f'"{name}" has {len(values)} values for {len(members)} members')
    values = values[members]
    found = np.unique(values)
    if len(found) <= MOST_VALUES:
        positions = np.arange(len(members))
        for value in found.tolist():
            sets[f"{name}_{value}"] = positions[values == value]
