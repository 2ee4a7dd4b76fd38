"""Reading of input files of Abaqus (also those of CalculiX and Gmsh): nodes, elements, sets, surfaces, parts and
instances. Everything else in such a file is skipped.

meshio 5.3.5 reads them without surfaces, parts and instances, replaces the first block of nodes by the second, and
opens whatever path stands behind ``*INCLUDE``.
"""

from __future__ import annotations

import math
import re
from array import array
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..bridge import Floats
from .raw import KINDS, Block, Labels, Lines, Numbers, Raw, Reading, shown, text_of

SOLIDS = {4: "tet4", 5: "pyramid5", 6: "wedge6", 8: "hex8"}
SOLIDS |= {10: "tet10", 13: "pyramid13", 15: "wedge15", 20: "hex20", 27: "hex27"}
SURFACES = {3: "tri3", 4: "quad4", 6: "tri6", 8: "quad8", 9: "quad9"}
LINES = {2: "line2", 3: "line3"}
# Names of elements of these families begin so, and with the number of nodes.
FAMILIES = (
    (r"(?:C|DC|AC|F)3D(\d+)", SOLIDS),
    (r"SC(\d)", SOLIDS),
    (r"(?:CPS|CPE|CPEG|CAX|CGAX|M3D|SFM3D|R3D|S|STRI|DS|DC2D|AC2D)(\d)", SURFACES),
    (r"(?:B[23]|PIPE[23]|R2D|F2D|[TSM][23]D|RAX|SAX)(\d)", LINES),
)
# Faces S1 … S6 of Abaqus in the order of KINDS.
FACES = {
    "hex8": (4, 5, 2, 1, 3, 0),
    "hex20": (4, 5, 2, 1, 3, 0),
    "wedge6": (0, 1, 2, 3, 4),
    "tet4": (0, 1, 2, 3),
    "tri3": (0, 1, 2),
    "quad4": (0, 1, 2, 3),
}
DEPTH = 20  # of files that include each other


def kind_of(name: str) -> str:
    """The kind of a type of elements; empty for one that is no cell, such as a spring."""
    for pattern, kinds in FAMILIES:
        found = re.match(pattern, name)
        if found:
            return kinds.get(int(found[1]), "")
    return ""


@dataclass
class Listed:
    """A line or more of a set: numbers (first, last, step where they are generated) or the name of another set; the
    face that a surface has of them."""

    key: str
    instance: str
    line: int
    numbers: array[int] = field(default_factory=lambda: array("q"))
    ranges: list[tuple[int, int, int]] = field(default_factory=list)
    other: str = ""
    face: str = ""


@dataclass
class Part:
    """Nodes, elements and sets of a part; the file outside of parts is one, too."""

    name: str
    node_labels: array[int] = field(default_factory=lambda: array("q"))
    node_lines: array[int] = field(default_factory=lambda: array("q"))
    positions: array[float] = field(default_factory=lambda: array("d"))
    # By kind: labels, nodes, lines.
    elements: dict[str, tuple[array[int], array[int], array[int]]] = field(default_factory=dict)
    node_sets: list[Listed] = field(default_factory=list)
    element_sets: list[Listed] = field(default_factory=list)
    surfaces: list[Listed] = field(default_factory=list)
    # Numbers of elements that are no cells, such as springs.
    skipped: array[int] = field(default_factory=lambda: array("q"))


@dataclass
class Instance:
    """A part at its place."""

    name: str
    part: str
    line: int
    turn: Floats = field(default_factory=lambda: np.eye(3))
    shift: Floats = field(default_factory=lambda: np.zeros(3))
    rows: int = 0


class Deck:
    """What is read from a file and the files that it includes. Names are kept in capitals, and as they are written
    first in ``written``."""

    def __init__(self, reading: Reading):
        self.reading = reading
        self.parts: dict[str, Part] = {"": Part("")}
        self.instances: dict[str, Instance] = {}
        self.part, self.instance = self.parts[""], ""
        self.dropped = Counter[str]()
        self.written: dict[str, str] = {}
        # The card that data lines belong to: what takes them, and the words of an element so far.
        self.take: Callable[[Lines, bytes], None] = self._skip
        self.words, self.continued, self.sets = list[bytes](), False, list[Listed]()
        self.name = self.kind = self.other = ""
        self.generate = False

    def read(self, number: int, depth: int = 0) -> None:
        """Read one of the files, line by line."""
        with open(self.reading.files[number], "rb") as file:
            lines = Lines(self.reading, file, number)
            for line in lines:
                if line.startswith(b"**") or not line:
                    continue
                if line.startswith(b"*"):
                    self._card(lines, line, depth)
                else:
                    self.take(lines, line)
            if depth == 0:
                self._finish(lines)

    # -- Cards

    def _card(self, lines: Lines, line: bytes, depth: int) -> None:
        """Begin a card. Its parameters may continue in the next line behind a comma; what is included continues the
        card before."""
        while line.endswith(b","):
            line += lines.next("a card")
        first, *words = line[1:].split(b",")
        given = {}
        for word in words:
            key, _, value = word.partition(b"=")
            given[text_of(key).strip().upper()] = text_of(value).strip().strip('"')
        name, source = "_".join(text_of(first).lower().split()), given.get("INPUT", "")
        if name == "include":
            self._include(lines, source, depth)
            return
        self._finish(lines)
        self.take = self._skip
        begin = getattr(self, f"_on_{name}", None)
        if begin is not None:
            begin(lines, given)
            if source:
                self._include(lines, source, depth)

    def _finish(self, lines: Lines) -> None:
        """End a card: no element may be cut short."""
        if self.words:
            raise lines.wrong(f"element {shown(self.words[:1])} above has too few nodes")

    def _skip(self, lines: Lines, line: bytes) -> None:
        """A line that does not describe the mesh."""

    def _include(self, lines: Lines, source: str, depth: int) -> None:
        """Read another file, which must lie in the folder of the first one or below."""
        folder = self.reading.path.resolve().parent
        try:
            path = (folder / source).resolve()
            inside = path.is_relative_to(folder) and path != folder
        except (OSError, ValueError, RuntimeError):
            inside = False
        if not source or not inside:
            raise lines.wrong(f'"{source}" is not in the folder of this file, so it is not opened')
        if depth >= DEPTH or path == self.reading.path.resolve():
            raise lines.wrong(f'"{source}" is included within itself')
        try:
            number = self.reading.add(path)
        except ValueError as error:
            raise lines.wrong(str(error)) from None
        if len(self.reading.files) > 1000:
            raise lines.wrong("more than 1000 files are included")
        self.read(number, depth + 1)

    def _named(self, lines: Lines, given: dict[str, str], key: str) -> str:
        """The name that a card gives."""
        name = given.get(key, "")
        if not name:
            raise lines.wrong(f"{key}=name is missing")
        return self._key(name)

    def _key(self, name: str) -> str:
        self.written.setdefault(name.upper(), name)
        return name.upper()

    def _on_part(self, lines: Lines, given: dict[str, str]) -> None:
        name = self._named(lines, given, "NAME")
        if name in self.parts:
            raise lines.wrong(f'part "{name}" is defined twice')
        self.part = self.parts[name] = Part(name)

    def _on_end_part(self, lines: Lines, given: dict[str, str]) -> None:
        self.part = self.parts[""]

    def _on_instance(self, lines: Lines, given: dict[str, str]) -> None:
        name, part = (self._named(lines, given, key) for key in ("NAME", "PART"))
        if name in self.instances:
            raise lines.wrong(f'instance "{name}" is defined twice')
        if part not in self.parts:
            raise lines.wrong(f'no part "{part}" is defined above')
        self.instances[name] = Instance(name, part, lines.line)
        self.instance, self.take = name, self._place

    def _on_end_instance(self, lines: Lines, given: dict[str, str]) -> None:
        self.instance = ""

    def _on_node(self, lines: Lines, given: dict[str, str]) -> None:
        if given.get("SYSTEM", "R").upper() != "R":
            raise lines.wrong("only coordinates of SYSTEM=R are read")
        if self.instance:
            raise lines.wrong("nodes within *INSTANCE are not read: define them in a *PART")
        self.name = self._key(given.get("NSET", ""))
        if self.name:
            self.part.node_sets.append(Listed(self.name, "", lines.line))
        self.take = self._node

    def _on_element(self, lines: Lines, given: dict[str, str]) -> None:
        kind = given.get("TYPE", "").upper()
        self.kind, self.name = kind_of(kind), self._key(given.get("ELSET", ""))
        self.other = kind or "without TYPE"
        if self.name:
            self.part.element_sets.append(Listed(self.name, "", lines.line))
        self.take, self.continued = self._element if self.kind else self._drop, False

    def _on_nset(self, lines: Lines, given: dict[str, str]) -> None:
        self._begin_set(lines, given, self._named(lines, given, "NSET"), self.part.node_sets)

    def _on_elset(self, lines: Lines, given: dict[str, str]) -> None:
        self._begin_set(lines, given, self._named(lines, given, "ELSET"), self.part.element_sets)

    def _begin_set(
        self, lines: Lines, given: dict[str, str], name: str, sets: list[Listed]
    ) -> None:
        self.name, self.generate = name, "GENERATE" in given
        self.other = given.get("INSTANCE", self.instance).upper()
        sets.append(Listed(name, self.other, lines.line))
        self.sets, self.take = sets, self._member

    def _on_surface(self, lines: Lines, given: dict[str, str]) -> None:
        self.name = self._named(lines, given, "NAME")
        kind = given.get("TYPE", "ELEMENT").upper()
        if kind == "NODE":
            self._begin_set(lines, {}, self.name, self.part.node_sets)
        elif kind == "ELEMENT":
            self.take = self._surface
            self.part.surfaces.append(Listed(self.name, "", lines.line))

    # -- Data lines

    def _node(self, lines: Lines, line: bytes) -> None:
        words = line.split(b",")
        if not 2 <= len(words) <= 7:
            raise lines.wrong("number and coordinates of a node must stand here")
        label = lines.whole(words[:1], "node")
        found = lines.reals([word if word.strip() else b"0" for word in words[1:4]], "coordinates")
        self.part.node_labels.extend(label)
        self.part.node_lines.append(lines.line)
        self.part.positions.extend((found + [0.0, 0.0])[:3])
        if self.name:
            self.part.node_sets[-1].numbers.extend(label)

    def _element(self, lines: Lines, line: bytes) -> None:
        words = line.split(b",")
        self.words += words[:-1] if not words[-1].strip() else words
        width = KINDS[self.kind].width
        if len(self.words) < 1 + width:
            return
        if len(self.words) > 1 + width:
            raise lines.wrong(f"number and {width} nodes of an element must stand here")
        label, *nodes = lines.whole(self.words, "element")
        self.words = []
        empty = (array("q"), array("q"), array("q"))
        labels, of, rows = self.part.elements.setdefault(self.kind, empty)
        labels.append(label)
        of.extend(nodes)
        rows.append(lines.line)
        if self.name:
            self.part.element_sets[-1].numbers.append(label)

    def _drop(self, lines: Lines, line: bytes) -> None:
        """An element that is no cell; its line may continue in the next one behind a comma."""
        if not self.continued:
            self.part.skipped.extend(lines.whole(line.split(b",")[:1], "element"))
            if self.other in self.dropped or len(self.dropped) < 100:
                self.dropped[self.other] += 1
        self.continued = line.endswith(b",")

    def _member(self, lines: Lines, line: bytes) -> None:
        """Numbers or names of sets."""
        words = [word.strip() for word in line.split(b",")]
        while words and not words[-1]:
            words.pop()
        if self.generate:
            found = lines.whole(words, "set")
            if not 2 <= len(found) <= 3 or found[-1] < 1 and len(found) == 3:
                raise lines.wrong("first, last and step of a generated set must stand here")
            first, last, step = (*found, 1)[:3]
            self.sets[-1].ranges.append((first, last, step))
            return
        for word in words:
            if re.fullmatch(rb"[+-]?\d+", word):
                self.sets[-1].numbers.extend(lines.whole([word], "set"))
            else:
                other = text_of(word.strip(b'"')).upper()
                self.sets.append(Listed(self.name, self.other, lines.line, other=other))

    def _surface(self, lines: Lines, line: bytes) -> None:
        """An element or a set, and a face."""
        words = [text_of(word).strip().strip('"').upper() for word in line.split(b",")]
        if len(words) < 2 or not words[1]:
            text = "an element or a set and its face must stand here, as in 12, S3"
            raise lines.wrong(f"{text}; a surface of all free faces is the set x_min … outer")
        listed = Listed(self.name, "", lines.line, face=words[1])
        if re.fullmatch(r"[+-]?\d+", words[0]):
            listed.numbers.extend(lines.whole([words[0].encode()], "surface"))
        else:
            listed.other = words[0]
        self.part.surfaces.append(listed)

    def _place(self, lines: Lines, line: bytes) -> None:
        """The translation of an instance, then its rotation about an axis through two points."""
        here = self.instances[self.instance]
        words = [word for word in line.split(b",") if word.strip()]
        found = np.array(lines.reals(words, "instance"))
        here.rows += 1
        if here.rows == 1 and len(found) <= 3:
            here.shift[: len(found)] = found
        elif here.rows == 2 and len(found) == 7:
            turn = rotation(found[:3], found[3:6], found[6])
            if turn is None:
                raise lines.wrong("the two points of the axis must differ")
            here.turn, here.shift = turn, turn @ (here.shift - found[:3]) + found[:3]
        else:
            text = "translation (3 numbers) or two points and an angle (7 numbers)"
            raise lines.wrong(f"{text} of an instance must stand here")


def rotation(a: Floats, b: Floats, degrees: float) -> Floats | None:
    """The rotation about the axis from a to b; quarter turns are exact."""
    axis = b - a
    length = float(np.linalg.norm(axis))
    if not (length > 0.0 and math.isfinite(length)):
        return None
    n = axis / length
    quarter = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}
    radians = math.radians(degrees)
    c, s = quarter.get(degrees % 360.0, (math.cos(radians), math.sin(radians)))
    cross = np.array([[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]])
    turn: Floats = c * np.eye(3) + s * cross + (1.0 - c) * np.outer(n, n)
    return turn


# -- Nodes, elements and sets of all instances


@dataclass
class Placed:
    """An instance in the mesh: where its nodes are, and where each of its elements is."""

    part: Part
    prefix: str
    first_node: int
    nodes: Labels
    elements: Labels
    cells: Numbers
    node_sets: dict[str, Numbers] = field(default_factory=dict)
    element_sets: dict[str, Numbers] = field(default_factory=dict)


class Assembly:
    """Puts the instances of a deck into one mesh."""

    def __init__(self, deck: Deck):
        self.deck, self.reading = deck, deck.reading
        self.raw = Raw(self.reading, "Abaqus", np.empty((0, 3)), [], dropped=deck.dropped)
        self.positions: list[Floats] = []
        self.node_count = self.cell_count = 0
        self.placed: dict[str, Placed] = {}
        # The kind and the face table of each cell, to check the faces of surfaces.
        self.kinds: list[tuple[int, str]] = []

    def build(self) -> Raw:
        """The mesh of all instances, or of a file without any."""
        deck = self.deck
        for instance in deck.instances.values():
            self._place(deck.parts[instance.part], instance)
        if not deck.instances:
            for name, part in deck.parts.items():
                if name and part.elements:
                    self._place(part, Instance(name, name, 0))
        self._place(deck.parts[""], Instance("", "", 0))
        self.raw.nodes = np.concatenate(self.positions)
        if not self.raw.blocks:
            found = f" ({', '.join(sorted(deck.dropped)[:10])})" if deck.dropped else ""
            raise self.reading.wrong(f"has no elements that are read{found}")
        for placed in self.placed.values():
            self._sets(placed)
        self._parts()
        return self.raw

    def _place(self, part: Part, instance: Instance) -> None:
        """Add the nodes and elements of an instance."""
        reading, raw = self.reading, self.raw
        owner = self.deck.written.get(instance.name, "")
        numbered = Labels(reading, part.node_labels, "node", part.node_lines)
        X = np.array(part.positions).reshape(-1, 3)
        self.node_count += len(X)
        reading.check_size(100.0 * self.node_count, "the instances")
        X = X if np.array_equal(instance.turn, np.eye(3)) else X @ instance.turn.T
        self.positions.append(X + instance.shift)
        first_node, first_cell = self.node_count - len(X), self.cell_count
        labels, lines = [np.empty(0, np.int64)], [np.empty(0, np.int64)]
        for kind, (numbers, of, rows) in part.elements.items():
            block = Block(kind, np.array(of, np.int64), np.array(numbers, np.int64), rows, owner)
            nodes = block.nodes.reshape(-1, KINDS[kind].width)
            block.nodes = numbered.find(nodes, block.who) + first_node
            raw.blocks.append(block)
            labels.append(block.labels)
            lines.append(np.array(rows, np.int64))
            self.kinds.append((self.cell_count, kind))
            self.cell_count += len(numbers)
        reading.check_size(100.0 * self.cell_count, "the instances")
        elements = Labels(reading, np.concatenate(labels), "element", np.concatenate(lines))
        cells = np.arange(first_cell, self.cell_count)
        placed = Placed(part, owner, first_node, numbered, elements, cells)
        self.placed[instance.name] = placed

    def _sets(self, placed: Placed) -> None:
        """Add the sets of an instance."""
        prefix = f"{placed.prefix}." if placed.prefix else ""
        raw, written = self.raw, self.deck.written
        for listed in placed.part.node_sets:
            old = placed.node_sets.get(listed.key, np.empty(0, np.int64))
            placed.node_sets[listed.key] = np.concatenate([old, self._nodes(placed, listed)])
        for listed in placed.part.element_sets:
            old = placed.element_sets.get(listed.key, np.empty(0, np.int64))
            placed.element_sets[listed.key] = np.concatenate([old, self._elements(placed, listed)])
        faces = dict[str, Numbers]()
        for listed in placed.part.surfaces:
            old = faces.get(listed.key, np.empty((0, 2), np.int64))
            faces[listed.key] = np.concatenate([old, self._faces(placed, listed)])
        for found, target in (
            (placed.node_sets, raw.node_sets),
            (placed.element_sets, raw.element_sets),
            (faces, raw.face_sets),
        ):
            for key, members in found.items():
                if len(members) or not placed.part.skipped:
                    target[prefix + written[key]] = members
        self.reading.check_size(self._bytes(), "the sets")

    def _bytes(self) -> float:
        raw = self.raw
        groups = (raw.node_sets, raw.element_sets, raw.face_sets)
        return float(sum(found.nbytes for sets in groups for found in sets.values()))

    def _numbers(self, listed: Listed, labels: Labels, skipped: Any = ()) -> Numbers:
        """Positions of the numbers that a set lists, without those that are skipped."""
        skipped = np.array(skipped, np.int64)
        who = lambda i: (f'the set "{self.deck.written[listed.key]}"', listed.line)  # noqa: E731
        given = np.array(listed.numbers, np.int64)
        found = [labels.find(given[~np.isin(given, skipped)], who)]
        for first, last, step in listed.ranges:
            count = (last - first) // step + 1
            if not 0 <= count <= len(labels) + len(skipped):
                text = f"{first} to {last} by {step} are {max(count, 0)} {labels.what}s"
                raise self.reading.wrong(f"{text}, but {len(labels)} are defined", listed.line)
            given = first + step * np.arange(count)
            found.append(labels.find(given[~np.isin(given, skipped)], who))
        return np.concatenate(found)

    def _of(self, placed: Placed, listed: Listed) -> Placed:
        """The instance that a set names, or its own."""
        if not listed.instance:
            return placed
        if listed.instance not in self.placed:
            raise self.reading.wrong(f'no instance "{listed.instance}" is defined', listed.line)
        return self.placed[listed.instance]

    def _other(self, sets: dict[str, Numbers], listed: Listed) -> Numbers:
        """The members of another set, which must be defined above."""
        if listed.other not in sets:
            text = f'no set "{listed.other}" is defined above'
            raise self.reading.wrong(text, listed.line)
        return sets[listed.other]

    def _nodes(self, placed: Placed, listed: Listed) -> Numbers:
        there = self._of(placed, listed)
        if listed.other:
            return self._other(there.node_sets, listed)
        return self._numbers(listed, there.nodes) + there.first_node

    def _elements(self, placed: Placed, listed: Listed) -> Numbers:
        there = self._of(placed, listed)
        if listed.other:
            return self._other(there.element_sets, listed)
        return there.cells[self._numbers(listed, there.elements, there.part.skipped)]

    def _faces(self, placed: Placed, listed: Listed) -> Numbers:
        """Cells and faces of a line of a surface."""
        instance, dot, name = listed.other.partition(".")
        if dot and instance in self.placed:
            cells = self._elements(self.placed[instance], Listed("", "", listed.line, other=name))
        else:
            cells = self._elements(placed, listed)
        out = np.empty((len(cells), 2), np.int64)
        starts = [start for start, _ in self.kinds]
        at = np.searchsorted(starts, cells, side="right") - 1
        for i in np.unique(at):
            kind = self.kinds[i][1]
            faces, found = FACES.get(kind, ()), re.fullmatch(r"[SE](\d)", listed.face)
            number = int(found[1]) if found else 0
            if not 1 <= number <= len(faces):
                text = f"{kind} has no face {listed.face}"
                raise self.reading.wrong(text, listed.line)
            here = at == i
            out[here] = np.column_stack([cells[here], np.full(here.sum(), faces[number - 1])])
        return out

    def _parts(self) -> None:
        """Sets of the elements of each instance, and of each part that has several."""
        raw, written = self.raw, self.deck.written
        of = dict[str, list[Numbers]]()
        for name, placed in self.placed.items():
            if name and len(placed.cells):
                raw.element_sets.setdefault(written[name], placed.cells)
                raw.parts = (*raw.parts, written[name])
                of.setdefault(placed.part.name, []).append(placed.cells)
        for name, cells in of.items():
            raw.element_sets.setdefault(written[name], np.concatenate(cells))


def read(reading: Reading) -> Raw:
    """Read an input file of Abaqus."""
    deck = Deck(reading)
    deck.read(0)
    return Assembly(deck).build()
