"""A mesh as its file has it, before it becomes bricks: kinds of cells, nodes, cells, sets, and errors that name the
file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..bridge import Floats
from ..mesh import side_nodes
from ..schema import check_file

Numbers = NDArray[np.int64]
# Arrays may take this many times the size of the file, plus a constant for small files.
TIMES, CONSTANT = 20, 64_000_000


@dataclass(frozen=True)
class Kind:
    """A kind of cell: its dimension, its number of nodes and its corners; corners of its faces, outward, and for
    bricks in the library's order."""

    dimension: int
    width: int
    corners: int
    faces: tuple[tuple[int, ...], ...] = ()
    cure: str = ""


# Faces of the library's bricks: x_min, x_max, y_min, y_max, z_min, z_max.
BRICK = tuple(tuple(face) for face in side_nodes("hex8").tolist())
WEDGE = ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5))
TET = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))
LINEAR = "mesh with first-order elements (Gmsh: Mesh.ElementOrder = 1)"
SERENDIPITY = "mesh with serendipity elements (Gmsh: Mesh.SecondOrderIncomplete = 1)"
KINDS = {
    "point": Kind(0, 1, 1),
    "line2": Kind(1, 2, 2),
    "line3": Kind(1, 3, 2),
    "tri3": Kind(2, 3, 3, ((0, 1), (1, 2), (2, 0))),
    "tri6": Kind(2, 6, 3),
    "quad4": Kind(2, 4, 4, ((0, 1), (1, 2), (2, 3), (3, 0))),
    "quad8": Kind(2, 8, 4),
    "quad9": Kind(2, 9, 4),
    "tet4": Kind(3, 4, 4, TET),
    "tet10": Kind(3, 10, 4, TET, LINEAR),
    "pyramid5": Kind(
        3, 5, 5, cure="mesh without pyramids: bricks and wedges alone, or tetrahedra alone"
    ),
    "pyramid13": Kind(3, 13, 5, cure="mesh without pyramids: bricks alone"),
    "pyramid14": Kind(3, 14, 5, cure="mesh without pyramids: bricks alone"),
    "wedge6": Kind(3, 6, 6, WEDGE),
    "wedge15": Kind(3, 15, 6, WEDGE, LINEAR),
    "wedge18": Kind(3, 18, 6, WEDGE, LINEAR),
    "hex8": Kind(3, 8, 8, BRICK),
    "hex20": Kind(3, 20, 8, BRICK),
    "hex27": Kind(3, 27, 8, BRICK, SERENDIPITY),
}


class Reading:
    """The file that is read and those that it includes: errors, and how much memory the arrays may take. A line is
    a number that has the file in its upper half, see :attr:`Lines.line`."""

    def __init__(self, path: str | Path):
        self.path = Path(path)
        self.files: list[Path] = []
        self.size = 0
        self.add(self.path)

    def add(self, path: Path) -> int:
        """Add a file, and return its number."""
        try:
            check_file(path)
            self.size += path.stat().st_size
        except FileNotFoundError:
            raise ValueError(f'can\'t read "{path}": no such file') from None
        except OSError as error:
            raise ValueError(f'can\'t read "{path}": {error.strerror or error}') from None
        self.files.append(path)
        return len(self.files) - 1

    def wrong(self, reason: str, line: int = 0) -> ValueError:
        """An error about the file, or about one of its lines."""
        place = f", line {line & 0xFFFFFFFF}" if line else ""
        return ValueError(f'"{self.files[line >> 32]}"{place}: {reason}')

    def check_size(self, size: float, what: str) -> None:
        """Refuse arrays that a file of this size can't contain, before they are made."""
        if not 0 <= size <= TIMES * self.size + CONSTANT:
            text = f"{what} need {size / 1e6:.3g} MB, but the file has {self.size / 1e6:.3g} MB"
            raise self.wrong(f"{text}: it is damaged")


class Lines:
    """The lines of a text file, with their numbers."""

    def __init__(self, reading: Reading, file: Any, number: int = 0):
        self.reading, self.file, self.line = reading, file, number << 32

    def wrong(self, reason: str) -> ValueError:
        """An error about the line that was read last."""
        return self.reading.wrong(reason, self.line)

    def __iter__(self) -> Iterator[bytes]:
        for line in self.file:
            self.line += 1
            yield line.strip()

    def next(self, what: str) -> bytes:
        """The next line; an error if there is none."""
        for line in self:
            return line
        raise self.wrong(f"the file ends within {what}")

    def whole(self, words: list[bytes], what: str) -> list[int]:
        """Whole numbers."""
        try:
            found = [int(word) for word in words]
        except ValueError:
            raise self.wrong(f"{what}: {shown(words)} are no whole numbers") from None
        if any(abs(number) >= 2**62 for number in found):
            raise self.wrong(f"{what}: a number of {shown(words)} is out of range")
        return found

    def reals(self, words: list[bytes], what: str) -> list[float]:
        """Numbers that are finite."""
        try:
            found = [float(word) for word in words]
        except ValueError:
            raise self.wrong(f"{what}: {shown(words)} are no numbers") from None
        if not all(map(np.isfinite, found)):
            raise self.wrong(f"{what}: a number of {shown(words)} is not finite")
        return found


def shown(words: list[bytes]) -> str:
    """Words of a file in an error."""
    text = b" ".join(words)[:60].decode(errors="replace")
    return f'"{text}"'


def text_of(name: bytes) -> str:
    """A name in a text file."""
    return name.decode("utf-8", errors="replace")


class Labels:
    """Numbers that a file gives its nodes or elements, with their lines if it is text, and their positions."""

    def __init__(self, reading: Reading, labels: Any, what: str, lines: Any = ()):
        self.reading, self.what = reading, what
        self.labels: Numbers = np.array(labels, np.int64)
        self.order = np.argsort(self.labels, kind="stable")
        self.sorted = self.labels[self.order]
        twice = np.flatnonzero(self.sorted[1:] == self.sorted[:-1])
        if twice.size:
            line = int(lines[self.order[twice[0] + 1]]) if len(lines) else 0
            raise reading.wrong(f"{what} {self.sorted[twice[0]]} is defined twice", line)

    def __len__(self) -> int:
        return len(self.labels)

    def find(self, wanted: Any, user: Callable[[int], tuple[str, int]]) -> Numbers:
        """Positions of these numbers; ``user(i)`` tells who has the i-th one, and its line, for an error."""
        wanted = np.asarray(wanted, np.int64)
        at = np.searchsorted(self.sorted, wanted)
        found = at < len(self.sorted)
        found[found] = self.sorted[at[found]] == wanted[found]
        if not found.all():
            first = np.unravel_index(np.argmin(found), found.shape)
            who, line = user(int(first[0]))
            text = f"{who} has {self.what} {wanted[first]}, which is not defined"
            raise self.reading.wrong(text, line)
        positions: Numbers = self.order[at]
        return positions


@dataclass
class Block:
    """Cells of one kind: their nodes (m, width) in VTK's order, and the numbers that the file gives them."""

    kind: str
    nodes: Numbers
    labels: Numbers
    lines: Any = ()
    owner: str = ""

    def who(self, i: int) -> tuple[str, int]:
        """What an error calls cell ``i``, and its line."""
        of = f' of "{self.owner}"' if self.owner else ""
        return f"element {self.labels[i]}{of}", int(self.lines[i]) if len(self.lines) else 0


@dataclass
class Raw:
    """A mesh as its file has it. Cells are numbered through all blocks; a set of elements may hold lines and
    surfaces, too. A face is a cell and the number of its face in :data:`KINDS`."""

    reading: Reading
    format: str
    nodes: Floats
    blocks: list[Block]
    node_sets: dict[str, Numbers] = field(default_factory=dict)
    element_sets: dict[str, Numbers] = field(default_factory=dict)
    face_sets: dict[str, Numbers] = field(default_factory=dict)
    dropped: Counter[str] = field(default_factory=Counter)
    # Element sets whose names are prefixes of the names of other sets, as in "part.set".
    parts: tuple[str, ...] = ()

    @property
    def sets(self) -> tuple[dict[str, Numbers], ...]:
        """The sets of nodes, faces and elements."""
        return self.node_sets, self.face_sets, self.element_sets

    def who(self, cell: int) -> str:
        """What an error calls a cell."""
        for block in self.blocks:
            if cell < len(block.nodes):
                break
            cell -= len(block.nodes)
        return block.who(cell)[0]
