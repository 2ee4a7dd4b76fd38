"""Cutting a built problem into the parts that the processes of a run build (chapter "Pieces")."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._core import ffi, lib
from .bridge import Ints
from .mesh import c_mesh
from .model import KERNELS
from .probes import Located
from .problem import Problem
from .problem_part import Part, PartBody

Marks = NDArray[np.bool_]


class Whole:
    """A body of the whole problem, as it is cut: the owner of each node, which nodes all pieces need, and the elements
    that each part has, so that its bounds, its shortest edge and its surfaces, none of which is empty, are known."""

    def __init__(self, problem: Problem, name: str, owners: Ints, count: int, common: Marks):
        self.problem, self.name, self.owners, self.common = problem, name, owners, common
        self.built = problem.bodies[name]
        mesh = self.mesh = self.built.mesh
        self.elements = np.ascontiguousarray(mesh.elements)
        self.node_owners: Ints = np.full(len(mesh.nodes), count - 1, np.int32)
        for column in self.elements.T:
            np.minimum.at(self.node_owners, column, owners)
        self.faces = {face: mesh.faces(face) for face in problem.asked.get((name, False), ())}
        self.face_nodes = {
            face: mesh.face_nodes(face) for face in problem.asked.get((name, True), ())
        }
        behind = [owners[0] for _, owners in self.faces.values()]
        self.always = np.unique(
            [0, self._shortest(), *behind, *map(self._around, self._extremes())]
        )

    def _extremes(self) -> Iterator[int]:
        """The nodes at the bounds of the body, and one of each set of nodes."""
        for column in self.mesh.nodes.T:
            yield int(column.argmin())
            yield int(column.argmax())
        yield from (int(nodes[0]) for nodes in self.face_nodes.values())

    def _around(self, node: int) -> int:
        """An element with this node."""
        return int((self.elements == node).any(axis=1).argmax())

    def _shortest(self) -> int:
        """An element with the shortest edge, found by halving."""
        first, last = 0, len(self.elements)
        while last - first > 1:
            middle = (first + last) // 2
            half = c_mesh(np.ascontiguousarray(self.mesh.nodes), self.elements[first:middle])
            lower = lib.ct_mesh_shortest_edge(half) == self.mesh.shortest_edge
            first, last = (first, middle) if lower else (middle, last)
        return first

    def part(self, number: int) -> tuple[PartBody, Ints]:
        """The part of a piece, and the owners of its nodes."""
        built, problem = self.built, self.problem
        own: Marks = self.node_owners == number
        moved = self.common.copy()
        moved[self.elements[own[self.elements].any(axis=1)]] = True
        there: Marks = np.any(moved[self.elements], axis=1)
        there[self.always] = True
        elements: Ints = np.flatnonzero(there).astype(np.int32)
        has = np.zeros(len(own), np.bool_)
        has[self.elements[elements]] = True
        numbers: Ints = np.flatnonzero(has).astype(np.int32)
        local, place = (np.cumsum(each, dtype=np.int32) - 1 for each in (has, there))
        given, rows = problem.pointer, numbers + np.int32(built.nodes.start)
        shift = given.initial_displacement
        at = problem.material_at.get(self.name, np.empty(0, np.int32))
        faces = {
            name: (local[all_of[there[owners]]], place[owners[there[owners]]])
            for name, (all_of, owners) in self.faces.items()
        }
        nodes = {name: local[all_of[has[all_of]]] for name, all_of in self.face_nodes.items()}
        body = PartBody(
            nodes=problem.rows(given.reference)[rows],
            elements=local[self.elements[elements]],
            node_numbers=numbers,
            element_numbers=elements,
            node_count=len(own),
            kernel=KERNELS[built.kernel],
            velocities=problem.rows(given.initial_velocity)[rows],
            displacements=None if shift == ffi.NULL else problem.rows(shift)[rows],
            material_at=at[elements] if len(at) else at,
            faces=faces,
            face_nodes=nodes,
        )
        return body, self.node_owners[numbers]


def can_be_parted(problem: Problem) -> bool:
    """Whether each process can build its part: not with dynamic relaxation, whose effect has memory at each node."""
    return not problem.parts.relaxed


def parts_of(problem: Problem, owners: Ints, count: int, common: Ints) -> Iterator[Part]:
    """The parts of the processes 1 ... ``count`` - 1; ``common``: the nodes that probes read."""
    needed = np.zeros(problem.pointer.node_count, np.bool_)
    needed[common] = True
    for effect in problem.made[1:]:
        if effect.calls.pieces.common:
            needed[_nodes_of(effect)] = True
    bodies, first = [], 0
    for name, body in problem.bodies.items():
        last = first + len(body.mesh.elements)
        bodies.append(Whole(problem, name, owners[first:last], count, needed[body.nodes]))
        first = last
    for number in range(1, count):
        made = {body.name: body.part(number) for body in bodies}
        starts = [body.built.nodes.start for body in bodies]
        numbers = [each.node_numbers + start for (each, _), start in zip(made.values(), starts)]
        kept = [body.owners[each.element_numbers] for body, (each, _) in zip(bodies, made.values())]
        together = np.concatenate(numbers).astype(np.int32)
        parts = {name: each for name, (each, _) in made.items()}
        probes = [_probe(located, parts, together) for located in problem.probes]
        all_owners = np.concatenate([own for _, own in made.values()])
        total = problem.pointer.node_count
        yield Part(parts, total, together, all_owners, np.concatenate(kept), probes)


def _nodes_of(effect: Any) -> Any:
    """The nodes of an effect in the problem."""
    if effect.nodes == ffi.NULL:
        return slice(None)
    return np.frombuffer(ffi.buffer(effect.nodes, 4 * effect.node_count), np.int32)


def _probe(
    located: Located, bodies: dict[str, PartBody], numbers: Ints
) -> tuple[dict[str, Any], Ints, str]:
    """The members, the nodes and the text of a probe with the numbers of a part, which may lack some nodes."""
    nodes = np.flatnonzero(np.isin(numbers, located.nodes)).astype(np.int32)
    members = dict(located.members)
    if members.get("element", -1) >= 0:
        body = list(bodies.values())[members["body"]]
        members["element"] = int(np.searchsorted(body.element_numbers, members["element"]))
    return members, nodes, located.words
