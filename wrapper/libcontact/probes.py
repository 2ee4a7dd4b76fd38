"""Probes of a scene: their places in the built problem, and their histories."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._core import ffi, lib
from .bridge import call, ints
from .model import AXES, QUANTITIES, Probe
from .parts import resultant_of
from .schema import SceneError, word
from .tables import Table, as_table

if TYPE_CHECKING:
    from .problem import Problem

# Number of components of a quantity; others have 3.
WIDTH = {"time": 1, "stress": 6, "pressure": 1}
KINDS = {
    "contact": (lib.CT_EFFECT_CONTACT,),
    "obstacle": (lib.CT_EFFECT_OBSTACLE,),
    "support": (lib.CT_EFFECT_SUPPORT, lib.CT_EFFECT_MOTION),
}


@dataclass(frozen=True, eq=False)
class Located:
    """A probe in a problem: its members of ``ct_probe_def``, its nodes, and its text for ``explain``."""

    given: Probe
    members: dict[str, Any]
    nodes: NDArray[np.int32]
    words: str

    @property
    def row_bytes(self) -> int:
        """Bytes of a row."""
        return 8 * sum(WIDTH.get(name, 3) for name in ("time", *self.given.taken))


def locate(problem: Problem) -> list[Located]:
    """The probes of a scene in its built problem."""
    find = {"point": _point, "surface": _surface, "resultant": _resultant}
    return [find[probe.where](problem, i, probe) for i, probe in enumerate(problem.parts.probe)]


def _point(problem: Problem, i: int, probe: Probe) -> Located:
    body = problem.bodies[str(probe.body)]
    point = np.array(probe.point, np.float64)
    node = int(np.argmin(((body.mesh.nodes - point) ** 2).sum(axis=1)))
    at = ", ".join(f"{x:g}" for x in body.mesh.nodes[node])
    element = int(body.mesh.locate(point[None])[0][0])
    if element < 0:
        reason = f'{point.tolist()} lies outside body "{body.name}"; its nearest node is at ({at})'
        raise SceneError(reason, f"probe[{i}].point", problem.file)
    number = list(problem.bodies).index(body.name)
    where = f"node {node} of {body.name} at ({at})"
    if {"stress", "pressure"} & {*probe.taken}:
        where += f", element {element}"
    nodes = np.array([body.nodes.start + node], np.int32)
    return Located(probe, {"body": number, "element": element}, nodes, where)


def _surface(problem: Problem, i: int, probe: Probe) -> Located:
    name, face = probe.surface
    nodes = _face_nodes(problem, probe.surface, f"probe[{i}].surface")
    return Located(probe, {}, nodes, f"the {len(nodes)} nodes of {name}.{face}, their mean")


def _resultant(problem: Problem, i: int, probe: Probe) -> Located:
    number, given, bodies = resultant_of(problem.parts, probe)
    table, name = probe.resultant.table, probe.body or bodies[0]
    kinds, nodes, members = KINDS[table], problem.bodies[name].nodes, dict[str, Any]()
    held: NDArray[np.int32] = np.arange(nodes.start, nodes.stop, dtype=np.int32)
    if table == "support":
        # All supports are one effect, except that those with a prescribed displacement are another one.
        kinds, number = kinds[bool(given.history) :][:1], 0
        held = _face_nodes(problem, given.set, f"probe[{i}].resultant")
        members["axes"] = [axis in given.fix for axis in AXES]
    k = [k for k, effect in enumerate(problem.made) if effect.kind in kinds][number]
    after = problem.made[k + 1 : k + 2]
    rubbing = [k + 1 for effect in after if effect.kind == lib.CT_EFFECT_FRICTION]
    words = f"{table}[{probe.resultant.number or 0}] on {name}"
    return Located(probe, {**members, "effects": [k, *rubbing]}, held, words)


def _face_nodes(problem: Problem, surface: tuple[str, str], key: str) -> NDArray[np.int32]:
    """Numbers in the problem of the nodes of a surface."""
    nodes = problem.on(surface, key, nodes=True)
    return np.ascontiguousarray(nodes + problem.bodies[surface[0]].nodes.start, np.int32)


class Histories:
    """The probes of one run, in the memory of C; false if the scene has none."""

    def __init__(self, problem: Problem):
        self.names = [located.given.name for located in problem.probes]
        self.pointer = ffi.NULL
        # The probes refer to the problem, so they keep it alive.
        self.kept = [problem]
        if not self.names:
            return
        kept: list[Any] = []
        definitions = ffi.new("ct_probe_def[]", len(self.names))
        for i, located in enumerate(problem.probes):
            definitions[i] = lib.ct_probe_def_default()
            _fill(definitions[i], located, kept)
        out, count = ffi.new("ct_probes **"), len(self.names)
        call(lib.ct_probes_create, problem.pointer, definitions, count, out)
        free = lib.ct_probes_free
        self.pointer = ffi.gc(out[0], lambda probes, problems=self.kept: free(probes))

    def __bool__(self) -> bool:
        return bool(self.names)

    def divide(self, problem: Problem, parts: int) -> None:
        """Continue with a problem whose step is divided by ``parts``; the times of the rows do not change."""
        call(lib.ct_probes_subdivide_step, self.pointer, problem.pointer, parts)
        self.kept.append(problem)

    def tables(self, last: bool = False) -> dict[str, Table]:
        """Copies of the histories so far, or of their last rows, by name."""
        found, history = dict[str, Table](), ffi.new("ct_probe_history *")
        for i, name in enumerate(self.names):
            call(lib.ct_probes_history, self.pointer, i, history)
            taken = [word(QUANTITIES, q) for q in range(len(QUANTITIES)) if history.column[q] >= 0]
            width = {name: WIDTH.get(name, 3) for name in taken}
            row = np.dtype([(name, "f8", (n,) if n > 1 else ()) for name, n in width.items()])
            first = max(history.row_count - 1, 0) if last else 0
            rows = np.zeros(history.row_count - first, row)
            if len(rows):
                ffi.memmove(rows, history.rows + first * history.width, rows.nbytes)
            found[name] = as_table(rows)
        return found


def _fill(definition: Any, located: Located, kept: list[Any]) -> None:
    """Write the definition of a probe; ``kept`` keeps alive the objects that it points to."""
    name = ffi.new("char[]", located.given.name.encode())
    members = {**located.members, "name": name, "every": located.given.every}
    members |= {"nodes": ints(located.nodes), "node_count": len(located.nodes)}
    if "effects" in members:
        members["effect_count"] = len(members["effects"])
        members["effects"] = ffi.new("int32_t[]", members["effects"])
    for name, value in members.items():
        setattr(definition, name, value)
    for name in located.given.taken:
        definition.take[QUANTITIES[name]] = 1
    kept.append(members)
