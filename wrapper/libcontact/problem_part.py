"""The part of a problem that one process of a run builds: elements and nodes with their own numbers (chapter
"Pieces")."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .bridge import Floats, Ints
from .mesh import Mesh


@dataclass(frozen=True, eq=False)
class PartBody:
    """
    The part of a body: its elements and their nodes, with numbers of their own.

    Attributes
    ----------
    nodes, elements
        Coordinates at the start, and the nodes of each element.
    node_numbers, element_numbers
        Numbers in the body, ascending.
    node_count
        Nodes of the body.
    kernel
        The kernel of the body (``ct_solid_kernel``).
    velocities, displacements
        At the start; displacements may be None.
    material_at
        Number of the material of each element; empty for a body of one material.
    faces
        Faces and their elements, by the name of a surface.
    face_nodes
        Nodes, by the name of a surface.
    """

    nodes: Floats
    elements: Ints
    node_numbers: Ints
    element_numbers: Ints
    node_count: int
    kernel: int
    velocities: Floats
    displacements: Floats | None
    material_at: Ints
    faces: dict[str, tuple[Ints, Ints]]
    face_nodes: dict[str, Ints]


@dataclass(frozen=True, eq=False)
class Part:
    """
    The part of a problem that one process builds, :doc:`/theory/pieces`.

    Attributes
    ----------
    bodies
        The part of each body, in their order.
    node_count
        Nodes of the whole problem.
    numbers, node_owners
        Number of each node in the whole problem, and the piece that it belongs to.
    owners
        The piece of each element.
    probes
        Members, nodes and text of each probe (``Located``), with the part's own numbers.
    """

    bodies: dict[str, PartBody]
    node_count: int
    numbers: Ints
    node_owners: Ints
    owners: Ints
    probes: list[tuple[dict[str, Any], Ints, str]]

    def light(self) -> Part:
        """The part without what a built problem has copied."""

        def emptied(body: PartBody) -> PartBody:
            none, numbers = np.empty((0, 3)), np.empty((0, 8), np.int32)
            body = replace(body, nodes=none, velocities=none, displacements=None, elements=numbers)
            return replace(body, material_at=numbers[:, 0], faces={}, face_nodes={})

        return replace(self, bodies={name: emptied(body) for name, body in self.bodies.items()})

    def told(self, text: str, at: dict[str, Any]) -> tuple[str, dict[str, Any]]:
        """An error's text and place with the numbers of the whole problem."""
        if at["body"] is None:
            return text, at
        body = list(self.bodies.values())[at["body"]]
        numbers = {"element": body.element_numbers, "node": body.node_numbers}
        if at["element"] is not None:
            at = {**at, "element": int(numbers["element"][at["element"]])}

        def whole(found: re.Match[str]) -> str:
            return f"{found[1]} {numbers[found[1]][int(found[2])]}"

        return re.sub(r"\b(element|node) (\d+)", whole, text), at


class PartMesh(Mesh):
    """The mesh of a part of a body, whose surfaces are those of the body."""

    def __init__(self, pointer: Any, owner: Any, body: PartBody):
        super().__init__(pointer, owner)
        self._faces, self._face_nodes = body.faces, body.face_nodes

    def faces(self, face: str) -> tuple[Ints, Ints]:
        return self._faces[face]

    def face_nodes(self, face: str) -> Ints:
        return self._face_nodes[face]
