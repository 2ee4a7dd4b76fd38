"""Named sets of nodes, faces and elements of a mesh, and the names of its surfaces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .bridge import Ints
from .schema import FACES, listed, nearest, suggestion

KINDS = ("nodes", "faces", "elements")


@dataclass(frozen=True, eq=False)
class Sets:
    """
    Named sets of one mesh.

    Attributes
    ----------
    nodes : dict
        Node numbers of each set, ascending.
    faces : dict
        Element and its side of each face, shape (m, 2), ascending; sides 0 to 5 are ξ = -1, ξ = 1, η = -1, η = 1,
        ζ = -1, ζ = 1.
    elements : dict
        Element numbers of each set, ascending.
    outside : frozenset of str
        Sets of the mesh file that have no members in the body.
    """

    nodes: Mapping[str, Ints] = field(default_factory=dict)
    faces: Mapping[str, Ints] = field(default_factory=dict)
    elements: Mapping[str, Ints] = field(default_factory=dict)
    outside: frozenset[str] = frozenset()

    @classmethod
    def read(cls, given: Mapping[str, Mapping[str, Any]], nodes: int, elements: int) -> Sets:
        """
        Check sets and sort their entries.

        Parameters
        ----------
        given
            Sets by kind ("nodes", "faces" or "elements") and name.
        nodes, elements
            Numbers of nodes and elements of the mesh.

        Returns
        -------
        Sets
            The sets.

        Raises
        ------
        ValueError
            A set has the name of a face of every body, or a number that the mesh does not have.
        """
        for kind in KINDS:
            for name in set(FACES) & given.get(kind, {}).keys():
                reason = "is the name of a face that every body has; give the set another name"
                raise ValueError(f'the set of {kind} "{name}" {reason}')
        return cls.of_file(given, nodes, elements)

    @classmethod
    def of_file(
        cls,
        given: Mapping[str, Mapping[str, Any]],
        nodes: int,
        elements: int,
        outside: frozenset[str] = frozenset(),
    ) -> Sets:
        """Check and sort the sets of a mesh file. They may have names of faces, see ``Problem.on``."""
        ends = {"nodes": (nodes,), "faces": (elements, 6), "elements": (elements,)}
        found: dict[str, dict[str, Ints]] = {}
        for kind in KINDS:
            found[kind] = {
                name: _sorted(name, kind, entries, ends[kind])
                for name, entries in given.get(kind, {}).items()
            }
        return cls(**found, outside=outside)

    def __bool__(self) -> bool:
        return bool(self.nodes or self.faces or self.elements)

    def kinds(self, name: str) -> tuple[str, ...]:
        """The kinds of the sets with this name, in the order of KINDS."""
        return tuple(kind for kind in KINDS if name in getattr(self, kind))

    def unknown(self, name: str) -> str:
        """What a message says of a name that no face or set has, with the names that exist."""
        near = suggestion(name, dict.fromkeys([*self.nodes, *self.faces, *self.elements, *FACES]))
        lead = f"{near} There are" if near.startswith("; did") else "; there are"
        if name in self.outside:
            lead = f"; the part that is read has no members of this set of the file{lead}"
        parts = [*_by_kind(self, name), f"the faces {listed(FACES, 'and')} of every body"]
        return f'has no face or set "{name}"{lead} {", ".join(parts)}'


def _by_kind(sets: Sets, name: str) -> Iterator[str]:
    """The names of the sets in words, kind by kind; of many those that are most like the name."""
    for kind in KINDS:
        names = nearest(name, getattr(sets, kind))
        if names:
            left = len(getattr(sets, kind)) - len(names)
            quoted = ", ".join(f'"{each}"' for each in names)
            text = f"{quoted} and {left} more" if left > 0 else listed(names, "and")
            yield f"sets of {kind} {text}"


def _sorted(name: str, kind: str, entries: Any, ends: tuple[int, ...]) -> Ints:
    """The entries of a set in ascending order, each once."""
    rows = np.unique(np.asarray(entries, np.int64).reshape(-1, len(ends)), axis=0)
    bad = np.flatnonzero(((rows < 0) | (rows >= np.array(ends))).any(axis=1))
    if bad.size:
        what = "element and side" if kind == "faces" else kind[:-1]
        most = " and ".join(f"0 ... {end - 1}" for end in ends)
        found = ", ".join(map(str, rows[bad[0]].tolist()))
        raise ValueError(f'the set of {kind} "{name}" has the {what} {found}, outside {most}')
    return np.ascontiguousarray(rows if kind == "faces" else rows.ravel(), np.int32)
