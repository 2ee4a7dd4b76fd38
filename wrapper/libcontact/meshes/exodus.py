"""Reading of Exodus II files, as Cubit, NimbleSM and MOOSE have them: blocks with names, side sets and node sets. An
Exodus file is a netCDF file: netCDF-4, which is HDF5 and is read by h5py, or a classic one, which is read by SciPy.

meshio reads neither side sets nor the names of blocks.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..errors import NotBuiltIn, install
from ..mesh import open_hdf5, text_in
from .hdf5 import dataset
from .raw import Block, Labels, Numbers, Raw, Reading

HDF5, CLASSIC = b"\x89HDF", (b"CDF\x01", b"CDF\x02")
# By the first letters of the type of a block, and the number of its nodes.
FAMILIES = {
    ("HEX",): {8: "hex8", 20: "hex20", 27: "hex27"},
    ("WED",): {6: "wedge6", 15: "wedge15", 18: "wedge18"},
    ("TET",): {4: "tet4", 10: "tet10"},
    ("PYR",): {5: "pyramid5", 13: "pyramid13", 14: "pyramid14"},
    ("QUA", "SHE"): {4: "quad4", 8: "quad8", 9: "quad9", 3: "tri3", 6: "tri6"},
    ("TRI",): {3: "tri3", 6: "tri6"},
    ("BAR", "BEA", "TRU", "EDG", "LIN"): {2: "line2", 3: "line3"},
    ("SPH", "CIR", "NOD"): {1: "point"},
}
# Nodes in VTK's order; Exodus has the vertical edges before those at the top.
HEX20 = [*range(12), *range(16, 20), *range(12, 16)]
# Sides 1, 2, … in the order of KINDS.
SIDES = {
    "hex8": (2, 1, 3, 0, 4, 5),
    "hex20": (2, 1, 3, 0, 4, 5),
    "wedge6": (2, 3, 4, 0, 1),
    "tet4": (1, 2, 3, 0),
    "tri3": (0, 1, 2),
    "quad4": (0, 1, 2, 3),
}

Get = Callable[[str], Any]


def read(reading: Reading) -> Raw:
    """Read an Exodus file."""
    with open(reading.path, "rb") as file:
        magic = file.read(4)
    if magic == HDF5:
        with open_hdf5(reading.path) as opened:
            return _read(reading, *_of_hdf5(reading, opened))
    if magic in CLASSIC:
        return _read(reading, *_of_classic(reading))
    cure = "; convert it with nccopy -k netCDF-4" if magic[:3] == b"CDF" else ""
    raise reading.wrong(f"is no Exodus file: neither netCDF-4 nor classic netCDF{cure}")


def _of_hdf5(reading: Reading, file: Any) -> tuple[Get, Callable[[str], str]]:
    """What gives a variable of a netCDF-4 file or None, and the type of the elements of a block."""

    def get(name: str) -> Any:
        found = dataset(reading, file, name)
        if found is None:
            return None
        reading.check_size(found.nbytes, name)
        return found[()]

    def kind(name: str) -> str:
        found = dataset(reading, file, name)
        return "" if found is None else text_in(found.attrs.get("elem_type", b""))

    return get, kind


def _of_classic(reading: Reading) -> tuple[Get, Callable[[str], str]]:
    """The same of a classic netCDF file."""
    try:
        from scipy.io import netcdf_file
    except ImportError:
        text = f"classic netCDF files need SciPy: {install('mesh')}"
        raise NotBuiltIn(text) from None
    import io

    # In memory, where a damaged length can't make it read more than there is.
    with open(reading.path, "rb") as opened:
        variables = netcdf_file(io.BytesIO(opened.read()), "r", mmap=False).variables

    def get(name: str) -> Any:
        return variables[name].data if name in variables else None

    def kind(name: str) -> str:
        return text_in(getattr(variables.get(name), "elem_type", b""))

    return get, kind


def _whole(reading: Reading, get: Get, name: str, shape: int = 1) -> Numbers | None:
    """A variable of whole numbers, or None."""
    found = get(name)
    if found is None:
        return None
    if not isinstance(found, np.ndarray) or found.dtype.kind not in "iu" or found.ndim != shape:
        raise reading.wrong(f"{name} has no whole numbers of {shape} dimensions")
    if found.size and not -(2**62) < int(found.min()) <= int(found.max()) < 2**62:
        raise reading.wrong(f"{name} has a number out of range")
    return found.astype(np.int64)


def _names(get: Get, name: str, count: int) -> list[str]:
    """Names, as rows of characters; "" for those that are missing."""
    found = get(name)
    names = []
    if isinstance(found, np.ndarray) and found.dtype.kind == "S" and found.ndim == 2:
        for row in found[:count]:
            letters = row.tobytes().partition(b"\0")[0]
            names.append(letters.decode(errors="replace").strip())
    return names + [""] * (count - len(names))


def _nodes(reading: Reading, get: Get) -> Any:
    """Coordinates in one variable, or in one for each axis."""
    whole = get("coord")
    columns = [get(f"coord{axis}") for axis in "xyz"] if whole is None else list(whole)
    given = [column for column in columns if column is not None]
    if not 2 <= len(given) <= 3:
        raise reading.wrong("has no coordinates (coord, or coordx, coordy, coordz)")
    for column in given:
        if not isinstance(column, np.ndarray) or column.dtype.kind != "f" or column.ndim != 1:
            raise reading.wrong("the coordinates are no rows of numbers")
        if len(column) != len(given[0]):
            raise reading.wrong("the coordinates have different lengths")
        if not np.isfinite(column).all():
            raise reading.wrong(f"node {np.argmin(np.isfinite(column)) + 1} is not finite")
    nodes = np.zeros((len(given[0]), 3))
    nodes[:, : len(given)] = np.column_stack(given)
    return nodes


def _ids(reading: Reading, get: Get, name: str, first: str) -> Numbers:
    """The numbers of blocks or sets; without them, 1, 2, … as far as there are any."""
    found = _whole(reading, get, name)
    if found is None:
        count = 0
        while count < 100_000 and get(f"{first}{count + 1}") is not None:
            count += 1
        found = np.arange(1, count + 1)
    return found


def _unique(names: list[str], ids: Numbers, what: str) -> list[str]:
    """Names of blocks or sets, by their number where there is none or it occurs twice."""
    return [
        name if name and names.count(name) == 1 else f"{what}_{number}"
        for name, number in zip(names, ids.tolist())
    ]


def _read(reading: Reading, get: Get, kind_of: Callable[[str], str]) -> Raw:
    raw = Raw(reading, "Exodus", _nodes(reading, get), [])
    ids = _ids(reading, get, "eb_prop1", "connect")
    names = _unique(_names(get, "eb_names", len(ids)), ids, "block")
    labels = _whole(reading, get, "elem_num_map")
    first = 0
    # Where the cells of each block are, among all elements of the file.
    starts, kinds = list[int](), list[str]()
    for i, name in enumerate(names):
        connect = _whole(reading, get, f"connect{i + 1}", 2)
        if connect is None:  # a block without elements
            continue
        word = kind_of(f"connect{i + 1}").strip()
        kind = _kind(word, connect.shape[1])
        count = len(connect)
        starts.append(first)
        kinds.append(kind)
        found = np.arange(first + 1, first + count + 1)
        if labels is not None and len(labels) >= first + count:
            found = labels[first : first + count]
        outside = (connect < 1) | (connect > len(raw.nodes))
        if outside.any():
            row = int(np.argmax(outside.any(axis=1)))
            text = f"element {found[row]} has node {connect[row][outside[row]][0]}"
            raise reading.wrong(f"{text}, but there are {len(raw.nodes)} nodes")
        first += count
        if not kind:
            raw.dropped[f"{word[:20]} of {connect.shape[1]} nodes"] += count
            kind, connect = "point", connect[:, :1]
            found = found[: len(connect)]
        nodes = connect - 1
        raw.blocks.append(Block(kind, nodes[:, HEX20] if kind == "hex20" else nodes, found))
        raw.element_sets[name] = np.arange(first - count, first)
    if not raw.blocks:
        raise reading.wrong("has no blocks of elements (connect1, …)")
    Labels(reading, np.concatenate([block.labels for block in raw.blocks]), "element")
    _sets(reading, get, raw, starts, kinds, first)
    return raw


def _kind(word: str, width: int) -> str:
    """The kind of a block; empty if it is unknown."""
    for words, kinds in FAMILIES.items():
        if word.upper().startswith(words):
            return kinds.get(width, "")
    return ""


def _sets(
    reading: Reading, get: Get, raw: Raw, starts: list[int], kinds: list[str], count: int
) -> None:
    """Read side sets and node sets."""
    ids = _ids(reading, get, "ss_prop1", "elem_ss")
    names = _unique(_names(get, "ss_names", len(ids)), ids, "side_set")
    for i, name in enumerate(names):
        elements = _whole(reading, get, f"elem_ss{i + 1}")
        sides = _whole(reading, get, f"side_ss{i + 1}")
        if elements is None or sides is None:
            elements = sides = np.empty(0, np.int64)
        if len(elements) != len(sides):
            raise reading.wrong(
                f'side set "{name}" has {len(elements)} elements and {len(sides)} sides'
            )
        if elements.size and not 1 <= elements.min() <= elements.max() <= count:
            raise reading.wrong(f'side set "{name}" has an element that is not one of {count}')
        cells = elements - 1
        out = np.column_stack([cells, np.full(len(cells), -1)])
        block = np.searchsorted(starts, cells, side="right") - 1
        for b in np.unique(block):
            here, order = block == b, np.array(SIDES.get(kinds[b], ()), np.int64)
            wrong = here & ((sides < 1) | (sides > len(order)))
            if wrong.any():
                side = f"{kinds[b] or 'an unknown kind'} has no side {sides[wrong][0]}"
                raise reading.wrong(f'side set "{name}": {side}')
            out[here, 1] = order[sides[here] - 1]
        raw.face_sets[name] = out
    ids = _ids(reading, get, "ns_prop1", "node_ns")
    names = _unique(_names(get, "ns_names", len(ids)), ids, "node_set")
    for i, name in enumerate(names):
        nodes = _whole(reading, get, f"node_ns{i + 1}")
        nodes = np.empty(0, np.int64) if nodes is None else nodes
        if nodes.size and not 1 <= nodes.min() <= nodes.max() <= len(raw.nodes):
            raise reading.wrong(f'node set "{name}" has a node that is not one of {len(raw.nodes)}')
        raw.node_sets[name] = nodes - 1
