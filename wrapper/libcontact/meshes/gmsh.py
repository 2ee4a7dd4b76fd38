"""Reading of Gmsh's files, formats 2.2 and 4.1, text and binary.

meshio reads them, too. But it keeps no numbers of elements and no lines for an error, takes the last node for one that
is not defined, and allocates whatever a damaged count says.
"""

from __future__ import annotations

from array import array
from collections import Counter
from typing import Any, BinaryIO

import numpy as np

from .raw import KINDS, Block, Labels, Lines, Numbers, Raw, Reading, text_of

# Gmsh's numbers of the kinds of elements.
TYPES = dict(
    enumerate(
        "line2 tri3 quad4 tet4 hex8 wedge6 pyramid5 line3 tri6 quad9 tet10 hex27 wedge18 pyramid14 point "
        "quad8 hex20 wedge15 pyramid13".split(),
        1,
    )
)
# Where the nodes of VTK's hex20 stand in that of Gmsh, whose edges start at corner 0, then 1, and so on.
HEX20 = [*range(8), 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15]


class Groups:
    """Nodes, elements and physical groups while a file is read."""

    def __init__(self, reading: Reading):
        self.reading = reading
        self.node_labels, self.positions, self.node_lines = array("q"), array("d"), array("q")
        self.names: dict[tuple[int, int], str] = {}
        # By kind: labels, nodes and, in a text file, lines.
        self.elements: dict[str, tuple[array[int], array[int], array[int]]] = {}
        self.physical: dict[tuple[int, int], list[tuple[str, int, int]]] = {}
        self.entities: dict[tuple[int, int], list[int]] = {}

    def add(self, kind: str, labels: Any, nodes: Any, groups: list[int], line: int = 0) -> None:
        """Add elements of one kind and one list of physical groups; negative groups are reversed ones."""
        numbers, of, lines = self.elements.setdefault(kind, (array("q"), array("q"), array("q")))
        first = len(numbers)
        if line:
            lines.append(line)
        numbers.extend(labels)
        of.extend(nodes)
        for group in groups:
            if group:
                spans = self.physical.setdefault((KINDS[kind].dimension, abs(group)), [])
                if spans and spans[-1][0] == kind and spans[-1][2] == first:
                    spans[-1] = (kind, spans[-1][1], len(numbers))
                else:
                    spans.append((kind, first, len(numbers)))

    def raw(self, version: str) -> Raw:
        """The mesh that was read."""
        if not self.node_labels or not self.elements:
            raise self.reading.wrong(f"has no {'elements' if self.node_labels else 'nodes'}")
        numbered = Labels(self.reading, self.node_labels, "node", self.node_lines)
        nodes = np.array(self.positions).reshape(-1, 3)
        blocks, first, count = [], dict[str, int](), 0
        for kind, (numbers, of, lines) in self.elements.items():
            block = Block(kind, np.array(of, np.int64), np.array(numbers, np.int64), lines)
            found = numbered.find(block.nodes.reshape(-1, KINDS[kind].width), block.who)
            block.nodes = found[:, HEX20] if kind == "hex20" else found
            blocks.append(block)
            first[kind], count = count, count + len(numbers)
        rows = np.concatenate([np.array(block.lines, np.int64) for block in blocks])
        labels = np.concatenate([block.labels for block in blocks])
        Labels(self.reading, labels, "element", rows)
        same = np.arange(count)
        if version == "2.2":  # an element in two groups stands there twice, with two numbers
            same = np.concatenate(
                [first[block.kind] + _first_equal(block.nodes) for block in blocks]
            )
        raw = Raw(self.reading, f"Gmsh {version}", nodes, blocks)
        for key in sorted(self.names.keys() | self.physical.keys()):
            name = self.names.get(key, str(key[1]))
            spans = [np.empty(0, np.int64)]
            for kind, a, b in self.physical.get(key, []):
                spans.append(same[first[kind] + a : first[kind] + b])
            members = np.concatenate(spans)
            found, counts = np.unique(members, return_counts=True)
            if (counts > 1).any():
                again = int(found[np.argmax(counts > 1)])
                text = f'element {labels[again]} is listed twice in the group "{name}"'
                raise self.reading.wrong(text, int(rows[again]) if len(rows) else 0)
            raw.element_sets[name] = np.union1d(members, raw.element_sets.get(name, members[:0]))
        _drop(raw, same)
        return raw


def _first_equal(nodes: Numbers) -> Numbers:
    """For each row, the first row that equals it."""
    _, first, inverse = np.unique(nodes, axis=0, return_index=True, return_inverse=True)
    found: Numbers = first[inverse.ravel()]
    return found


def _drop(raw: Raw, same: Numbers) -> None:
    """Leave out the cells that stand for another one."""
    kept = same == np.arange(len(same))
    if kept.all():
        return
    number, start = np.cumsum(kept) - 1, 0
    for name, members in raw.element_sets.items():
        raw.element_sets[name] = number[members]
    for block in raw.blocks:
        here = kept[start : start + len(block.nodes)]
        start += len(here)
        block.nodes, block.labels = block.nodes[here], block.labels[here]
        block.lines = np.array(block.lines, np.int64)[here] if len(block.lines) else ()


def read(reading: Reading) -> Raw:
    """Read a file of Gmsh."""
    with open(reading.path, "rb") as file:
        lines = Lines(reading, file)
        version = binary = None
        groups, seen = Groups(reading), Counter[str]()
        for line in lines:
            if not line:
                continue
            if not line.startswith(b"$"):
                raise lines.wrong("a section such as $Nodes must begin here")
            section = text_of(line[1:].strip())
            seen[section] += 1
            if section in ("Nodes", "Elements", "MeshFormat") and seen[section] > 1:
                raise lines.wrong(f"there are two sections ${section}")
            if section == "MeshFormat":
                version, binary = _format(lines, file)
            elif section == "PhysicalNames":
                _names(lines, groups)
            elif section in ("Entities", "Nodes", "Elements") and version is not None:
                form = (Text22, Text41, Binary22, Binary41)[2 * bool(binary) + (version == "4.1")]
                getattr(form(lines, file, groups), section.lower())()
            elif section in ("Nodes", "Elements"):
                raise lines.wrong(f"${section} stands before $MeshFormat")
            else:
                _skip(lines, section)
                continue
            _end(lines, section)
        if version is None:
            raise reading.wrong("has no section $MeshFormat, so it is no file of Gmsh")
        return groups.raw(version)


def _end(lines: Lines, section: str) -> None:
    """Read the line that ends a section."""
    line = b""
    while not line:
        line = lines.next(f"${section}")
    if line != b"$End" + section.encode():
        raise lines.wrong(f"$End{section} must stand here")


def _skip(lines: Lines, section: str) -> None:
    """Skip a section that is not needed."""
    end = b"$End" + section.encode()
    for line in lines:
        if line == end:
            return
    raise lines.wrong(f"the file ends within ${section}")


def _format(lines: Lines, file: BinaryIO) -> tuple[str, bool]:
    """The version, and whether the file is binary."""
    words = lines.next("$MeshFormat").split()
    version = text_of(words[0]) if words else ""
    if len(words) != 3 or version not in ("2.2", "4.1"):
        cure = "save it as version 4.1 or 2.2 (Gmsh: Mesh.MshFileVersion = 4.1)"
        raise lines.wrong(f'version "{version[:20]}" is not read; {cure}')
    kind, size = lines.whole(words[1:], "$MeshFormat")
    if kind not in (0, 1) or size != 8:
        raise lines.wrong("text (0) or binary (1) with numbers of 8 bytes is needed")
    if kind == 1:
        one = file.read(4)
        if one != (1).to_bytes(4, "little"):
            raise lines.wrong("the bytes are in another order; save the file as text")
    return version, kind == 1


def _names(lines: Lines, groups: Groups) -> None:
    """Read the names of the physical groups."""
    (count,) = _counts(lines, "$PhysicalNames", 1)
    for _ in range(count):
        words = lines.next("$PhysicalNames").split(None, 2)
        if len(words) != 3 or len(words[2]) < 2 or words[2][:1] != b'"' or words[2][-1:] != b'"':
            raise lines.wrong('dimension, number and "name" of a physical group must stand here')
        dimension, number = lines.whole(words[:2], "physical group")
        if (dimension, number) in groups.names:
            raise lines.wrong(f"physical group {number} is named twice")
        groups.names[dimension, number] = text_of(words[2][1:-1])


def _counts(lines: Lines, what: str, number: int) -> list[int]:
    """A line of whole numbers that are not negative."""
    found = lines.whole(lines.next(what).split(), what)
    if len(found) != number or min(found) < 0:
        raise lines.wrong(f"{what}: {number} whole numbers, none negative, must stand here")
    return found


class Form:
    """How one form of the file has its sections."""

    def __init__(self, lines: Lines, file: BinaryIO, groups: Groups):
        self.lines, self.file, self.groups = lines, file, groups

    def entities(self) -> None:
        """Only version 4.1 has them."""
        raise self.lines.wrong("version 2.2 has no section $Entities")

    def kind(self, number: int) -> str:
        """The kind of elements; those without a name are refused, as their nodes can't be counted."""
        if number not in TYPES:
            raise self.lines.wrong(f"elements of Gmsh's type {number} are not read")
        return TYPES[number]


class Text22(Form):
    """Version 2.2, text: one line per node or element."""

    def nodes(self) -> None:
        (count,) = _counts(self.lines, "$Nodes", 1)
        for _ in range(count):
            words = self.lines.next("$Nodes").split()
            if len(words) != 4:
                raise self.lines.wrong("number and three coordinates of a node must stand here")
            self.groups.node_labels.extend(self.lines.whole(words[:1], "node"))
            self.groups.node_lines.append(self.lines.line)
            self.groups.positions.extend(self.lines.reals(words[1:], "coordinates"))

    def elements(self) -> None:
        (count,) = _counts(self.lines, "$Elements", 1)
        for _ in range(count):
            words = self.lines.whole(self.lines.next("$Elements").split(), "element")
            kind = self.kind(words[1]) if len(words) > 3 else "point"
            tags, width = words[2] if len(words) > 3 else -1, KINDS[kind].width
            if tags < 0 or len(words) != 3 + tags + width:
                text = "number, type, count of tags, tags and nodes of an element must stand here"
                raise self.lines.wrong(f"{text} ({kind} has {width} nodes)")
            self.groups.add(
                kind, words[:1], words[3 + tags :], words[3:4] if tags else [], self.lines.line
            )


class Text41(Form):
    """Version 4.1, text: blocks of nodes and of elements, each of one entity of the geometry."""

    def entities(self) -> None:
        counts = _counts(self.lines, "$Entities", 4)
        for dimension, count in enumerate(counts):
            box = 3 if dimension == 0 else 6
            for _ in range(count):
                words = self.lines.next("$Entities").split()
                if len(words) < 2 + box:
                    raise self.lines.wrong("an entity must stand here")
                (tag, number) = self.lines.whole([words[0], words[1 + box]], "entity")
                if not 0 <= number <= len(words) - 2 - box:
                    raise self.lines.wrong(f"{number} physical groups must stand here")
                groups = self.lines.whole(words[2 + box : 2 + box + number], "entity")
                self.groups.entities[dimension, tag] = groups

    def nodes(self) -> None:
        blocks = _counts(self.lines, "$Nodes", 4)[0]
        for _ in range(blocks):
            _, _, parametric, count = self._block("$Nodes")
            if parametric not in (0, 1):
                raise self.lines.wrong("the third number must be 0 or 1")
            for _ in range(count):
                self.groups.node_labels.extend(_counts(self.lines, "$Nodes", 1))
                self.groups.node_lines.append(self.lines.line)
            for _ in range(count):
                words = self.lines.next("$Nodes").split()
                if not (3 <= len(words) <= 6 if parametric else len(words) == 3):
                    raise self.lines.wrong("three coordinates of a node must stand here")
                self.groups.positions.extend(self.lines.reals(words[:3], "coordinates"))

    def _block(self, section: str) -> list[int]:
        words = self.lines.whole(self.lines.next(section).split(), section)
        if len(words) != 4 or words[3] < 0:
            raise self.lines.wrong(f"{section}: the four numbers of a block must stand here")
        return words

    def elements(self) -> None:
        blocks = _counts(self.lines, "$Elements", 4)[0]
        for _ in range(blocks):
            dimension, entity, number, count = self._block("$Elements")
            kind = self.kind(number)
            width, groups = KINDS[kind].width, self.groups.entities.get((dimension, entity), [])
            for _ in range(count):
                words = self.lines.whole(self.lines.next("$Elements").split(), "element")
                if len(words) != 1 + width:
                    raise self.lines.wrong(f"number and {width} nodes of a {kind} must stand here")
                self.groups.add(kind, words[:1], words[1:], groups, self.lines.line)


class Binary(Form):
    """What the binary forms share."""

    def take(self, dtype: Any, count: int) -> Any:
        """The next numbers."""
        size = np.dtype(dtype).itemsize * count
        if not 0 <= size <= self.groups.reading.size - self.file.tell():
            raise self.lines.wrong(f"after this line the file has no room for {count} numbers")
        return np.frombuffer(self.file.read(size), dtype)

    def positions(self, found: Any) -> None:
        """Add coordinates that must be finite."""
        if not np.isfinite(found).all():
            raise self.groups.reading.wrong("a coordinate is not finite")
        self.groups.positions.frombytes(np.ascontiguousarray(found, "f8").tobytes())

    def labels(self, found: Any) -> list[int]:
        """Numbers of nodes or elements."""
        if found.size and (found.max() >= 2**62 or found.min() < 0):
            raise self.groups.reading.wrong("a number is out of range")
        return list(found.tolist())


class Binary22(Binary):
    """Version 2.2, binary."""

    def nodes(self) -> None:
        (count,) = _counts(self.lines, "$Nodes", 1)
        found = self.take(np.dtype([("label", "<i4"), ("x", "<f8", 3)]), count)
        self.groups.node_labels.extend(self.labels(found["label"]))
        self.positions(found["x"])

    def elements(self) -> None:
        (count,) = _counts(self.lines, "$Elements", 1)
        done = 0
        while done < count:
            number, here, tags = self.take("<i4", 3).tolist()
            kind = self.kind(number)
            width = 1 + tags + KINDS[kind].width
            if here < 1 or tags < 0:
                raise self.lines.wrong("after this line a block of elements has no elements")
            found = self.take("<i4", here * width).reshape(here, width)
            labels = self.labels(found[:, 0])
            nodes = self.labels(found[:, 1 + tags :].ravel())
            group = found[:, 1] if tags else np.zeros(here, np.int32)
            ends = [0, *(np.flatnonzero(np.diff(group)) + 1).tolist(), here]
            for a, b in zip(ends, ends[1:]):
                part = nodes[a * KINDS[kind].width : b * KINDS[kind].width]
                self.groups.add(kind, labels[a:b], part, [int(group[a])])
            done += here


class Binary41(Binary):
    """Version 4.1, binary."""

    def entities(self) -> None:
        for dimension, count in enumerate(self.take("<u8", 4).tolist()):
            for _ in range(count):
                (tag,) = self.take("<i4", 1).tolist()
                self.take("<f8", 3 if dimension == 0 else 6)
                groups = self.take("<i4", int(self.take("<u8", 1)[0])).tolist()
                if dimension > 0:
                    self.take("<i4", int(self.take("<u8", 1)[0]))
                self.groups.entities[dimension, tag] = groups

    def nodes(self) -> None:
        for _ in range(int(self.take("<u8", 4)[0])):
            dimension, _, parametric = self.take("<i4", 3).tolist()
            (count,) = self.take("<u8", 1).tolist()
            if parametric not in (0, 1) or not 0 <= dimension <= 3:
                raise self.lines.wrong("after this line a block of nodes is damaged")
            self.groups.node_labels.extend(self.labels(self.take("<u8", count)))
            width = 3 + dimension * parametric
            self.positions(self.take("<f8", count * width).reshape(count, width)[:, :3])

    def elements(self) -> None:
        for _ in range(int(self.take("<u8", 4)[0])):
            dimension, entity, number = self.take("<i4", 3).tolist()
            (count,) = self.take("<u8", 1).tolist()
            kind = self.kind(number)
            width = 1 + KINDS[kind].width
            found = self.take("<u8", count * width).reshape(count, width)
            groups = self.groups.entities.get((dimension, entity), [])
            labels, nodes = self.labels(found[:, 0]), self.labels(found[:, 1:].ravel())
            self.groups.add(kind, labels, nodes, groups)
