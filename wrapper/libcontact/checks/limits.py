"""Warnings of limits that make a run slow or its result useless: a run with very many steps or too few, and a
penalty that is too soft for its load (chapter "Warnings")."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from .._core import lib
from ..errors import SceneWarning
from ..mesh import EDGE_ENDS, Mesh
from ..model import ENFORCEMENTS, modulus, speeds
from ..observers import Observer, spread
from ..problem import Problem, penetrations
from ..surfaces import contact_tables, split_name

# Steps and time [s] of a long run, and operations per second of a slow core (eq:long-run).
MANY_STEPS, LONG, OPERATIONS = 1e7, 3600.0, 1e9
# Steps of a run that is too short, if no wave has crossed a body by then (eq:short-run).
FEW_STEPS = 20
# Depth as a fraction of an element that is warned of, and that of the advised penalty (eq:too-soft).
DEEP, FINE = 0.5, 0.1
# Depths are checked this many times in a run, but not more often than every LEAST_STEPS steps.
CHECKS, LEAST_STEPS = 50, 64


def long_run(problem: Problem) -> Iterator[SceneWarning]:
    """Warn of a run that takes ten million steps or more, or about an hour or more."""
    bodies = problem.bodies.values()
    work = sum(len(body.mesh.elements) * body.flops for body in bodies)
    work += sum(effect.cost.flops for effect in problem.made) + 18.0 * problem.pointer.node_count
    # (eq:long-run)
    seconds = problem.step_count * work / OPERATIONS
    if problem.step_count < MANY_STEPS and seconds < LONG:
        return
    cross = max(
        np.ptp(body.mesh.bounds, axis=0).max() / speeds(body.material)[0] for body in bodies
    )
    time, unit = problem.parts.time, problem.parts.units.time
    yield SceneWarning(
        "long_run",
        f"the run to t = {problem.end:g} {unit} takes {problem.step_count:.2g} steps of "
        f"{problem.dt:.2g} {unit}, about {_told(seconds)}; a wave crosses the largest "
        f"body in {cross:.2g} {unit}. Choose an earlier end, larger elements (the "
        "smallest one sets the step), or check the units",
        "time.end" if time.end is not None else "time.end_c1t_over",
    )


def short_run(problem: Problem) -> Iterator[SceneWarning]:
    """Warn of a run of a few steps in which no wave crosses a body, even along its shortest side."""
    bodies = [body for body in problem.bodies.values() if body.kernel != "rigid"]
    sides = [np.ptp(body.mesh.bounds, axis=0) for body in bodies]
    crossings = [side.min() / speeds(body.material)[0] for side, body in zip(sides, bodies)]
    # (eq:short-run)
    if not crossings or problem.step_count >= FEW_STEPS or problem.end >= min(crossings):
        return
    first, time, unit = int(np.argmin(crossings)), problem.parts.time, problem.parts.units.time
    size = " x ".join(f"{side:.3g}" for side in sides[first])
    yield SceneWarning(
        "short_run",
        f"the run ends at t = {problem.end:.3g} {unit}, after {problem.step_count} step{'s' * (problem.step_count > 1)} of {problem.dt:.2g} {unit}, "
        f'and no wave crosses a body by then: across "{bodies[first].name}" of {size} '
        f"{problem.parts.units.length} it takes {crossings[first]:.2g} {unit}. Choose a later end, or check that the "
        "mesh, young and density are in [units]",
        "time.end" if time.end is not None else "time.end_c1t_over",
    )


def _told(seconds: float) -> str:
    """A time in words."""
    for unit, size in (("days", 86400.0), ("hours", 3600.0), ("minutes", 60.0)):
        if seconds >= 2.0 * size:
            return f"{seconds / size:.2g} {unit}"
    return f"{seconds:.2g} seconds"


class Depths(Observer):
    """Finds contacts and obstacles whose surfaces overlap by more than half an element."""

    at_records = True

    def __init__(self, problem: Problem):
        self._open = {key: (who, given) for key, who, given in contact_tables(problem.parts)}
        super().__init__(problem, spread(problem, CHECKS, LEAST_STEPS) if self._open else 0)
        self._start: dict[str, float] = {}

    def warnings(self, state: Any) -> Iterator[SceneWarning]:
        """Yield a warning for each contact and obstacle that is too deep in a state (``ct_state *``), once
        for each. The first call gives the depths at the start, which do not count."""
        if not self._open:
            return
        keys = [key for key, _, _ in contact_tables(self._problem.parts)]
        for i, (key, found) in enumerate(zip(keys, penetrations(self._problem, state, ["points"]))):
            points = found["points"]
            grown = points["deepest"] - self._start.setdefault(key, points["deepest"])
            if key not in self._open or not points["surface"]:
                continue
            body, face = split_name(points["surface"], self._problem.bodies)
            mesh = self._problem.bodies[body].mesh
            if not grown > DEEP * mesh.shortest_edge:
                continue
            size = _element_size(mesh, face, points["face"])
            # (eq:too-soft)
            if grown > DEEP * size:
                (who, given), units = self._open.pop(key), self._problem.parts.units
                epsilon = self._epsilon(i, given)
                where = ", ".join(f"{x:.4g}" for x in points["position"])
                text = f"{who}: the surfaces overlap by {grown:.3g} {units.length} "
                text += f"at t = {state.time:.4g} {units.time}, deepest at ({where}) on {points['surface']}, "
                text += f"where an element is {size:.3g} {units.length} thick; the penalty "
                text += f"epsilon = {epsilon:.3g} is too soft for the load, and the bodies "
                text += "may pass through each other; "
                enough, usual = epsilon * grown / (FINE * size), self._usual(given)
                if usual > enough:
                    text += f"leave epsilon and beta out: the default is {usual:.2g}"
                else:
                    text += f"choose epsilon = {enough:.2g} or more, or beta in proportion"
                yield SceneWarning("penetration", text, key)

    def _usual(self, given: Any) -> float:
        """The default penalty of a contact or an obstacle, :eq:`penalty-default`."""
        surfaces = getattr(given, "surfaces", None) or [given.surface]
        bodies = [self._problem.bodies[name] for name, _ in surfaces]
        materials = [m for each in surfaces for m in self._problem.materials_behind(each)]
        least = min(map(modulus, materials))
        edge = min(body.mesh.shortest_edge for body in bodies)
        law = ENFORCEMENTS[given.enforcement]
        return float(lib.ct_contact_penalty_default(law, least, edge))

    def _epsilon(self, i: int, given: Any) -> float:
        """The penalty of contact or obstacle number ``i``."""
        problem = self._problem
        if i < len(problem.contacts):
            return problem.contacts[i].epsilon
        number = list(problem.parts.bodies).index(given.surface[0])
        materials = problem.materials_behind(given.surface)
        return float(given.penalties(problem.joined.bodies[number], materials)[0])


def _element_size(mesh: Mesh, face: str, number: int) -> float:
    """Shortest edge of the element behind a face of a surface, or of the mesh if the face is unknown."""
    owners = mesh.faces(face)[1]
    if not 0 <= number < len(owners):
        return float(mesh.shortest_edge)
    x = mesh.nodes[mesh.elements[owners[number]][:8]]
    return float(np.linalg.norm(x[EDGE_ENDS[:, 1]] - x[EDGE_ENDS[:, 0]], axis=1).min())
