"""
A rehearsal of a run: the same scene with larger elements, computed to its end before the run, to know what will happen when.

A plan needs to know what a run will meet: how long surfaces press, how many of their points, whether they part and meet again.
That is a matter of bodies and waves, not of small elements, so a scene of larger elements tells it at a small part of the cost.
Its states, laid on the meshes of the true scene, are those in which the plan measures its prices.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from . import parts as scene_parts
from ._core import ffi, lib
from .errors import Error, check, new_error
from .mesh import box_axes, rotation
from .problem import Problem, new_state

# What a rehearsal may cost, in updates of an element: so many, or this share of the run's, but never more than some seconds. A
# face that may press costs as much as some elements.
MOST_UPDATES, MOST_SHARE, MOST_EVER, FACE_UPDATES = 1e6, 0.03, 1e8, 50
FRACTION = 0.9
# How often it is looked at, and how many numbers may be kept of it.
LOOKS, MOST_NUMBERS = 240, 2e7
# The coarsest lattice, across a body and around a ring.
FEWEST_CELLS, FEWEST_AROUND = 2, 12
# How much the time counts when states are compared, beside shares of nodes.
TIME_WEIGHT = 0.3


@dataclass(frozen=True, eq=False)
class Moment:
    """
    A state of the run as the rehearsal foresees it: the ``step`` of the run, ``displacement`` and ``velocity`` (node_count, 3)
    on the run's meshes, and the ``share`` of the steps that it stands for.
    """

    step: int
    share: float
    displacement: np.ndarray
    velocity: np.ndarray


@dataclass(frozen=True, eq=False)
class Rehearsal:
    """
    The ``coarse`` problem's way through the run of ``problem``, looked at after equal parts of its time. ``pressing`` (looks,
    effects): the share of its nodes on which an effect acted since the look before; ``steps``: those that the run will take,
    fewer than it may where it ends at rest.
    """

    problem: Problem
    coarse: Problem
    steps: int
    pressing: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray

    def active(self, effect: int) -> float:
        """The share of the steps in which an effect acts at all."""
        return float(np.mean(self.pressing[:, effect] > 0.0))

    def begins(self) -> np.ndarray:
        """The step of the run at which each effect acts first; infinite for one that never does."""
        acts = self.pressing > 0.0
        return np.where(acts.any(axis=0), acts.argmax(axis=0) / len(acts) * self.steps, math.inf)

    def moments(self, count: int) -> Iterator[Moment]:
        """At most ``count`` states that stand for all of the run."""
        looks = len(self.pressing)
        time = TIME_WEIGHT * (np.arange(looks) + 0.5) / looks
        maps = [_Map(self.problem, self.coarse, name) for name in self.problem.bodies]
        for look, members in _group(np.column_stack([self.pressing, time]), min(count, looks)):
            u, v = np.empty((2, self.problem.pointer.node_count, 3))
            for lay in maps:
                lay(self.displacement[look], self.velocity[look], u, v)
            yield Moment(round((look + 1) / looks * self.steps), members / looks, u, v)


def rehearse(problem: Problem) -> Rehearsal | None:
    """
    Compute the scene with larger elements; None where that can't be done or is not cheap: a body with a mesh of its own can't
    be given larger elements.
    """
    try:
        coarse = _coarse(problem)
        return None if coarse is None else _run(problem, coarse)
    except Error:
        return None


# The coarse scene.


def _coarse(problem: Problem) -> Problem | None:
    """The scene with elements as little larger as is cheap enough."""
    most = min(max(MOST_UPDATES, MOST_SHARE * _updates(problem, problem.parts.bodies)), MOST_EVER)
    return with_larger_elements(problem, lambda bodies: _updates(problem, bodies), most, FRACTION)


def with_larger_elements(
    problem: Problem,
    cost: Callable[[dict[str, scene_parts.Body]], float],
    most: float,
    fraction: float,
) -> Problem | None:
    """
    The scene with elements as little larger as makes the ``cost`` of its bodies no more than ``most``, at a ``fraction`` of its stable step; None where that
    can't be done, as bodies have meshes of their own.
    """
    parts = problem.parts
    if not all(isinstance(own.given, str) for own in problem.own):
        return None
    largest, times = (
        max(
            (n for body in parts.bodies.values() if _lattice(body) for n in _lattice(body).cells),
            default=0,
        ),
        1.0,
    )
    while (
        cost(bodies := {name: _larger(body, times) for name, body in parts.bodies.items()}) > most
    ):
        if times > largest:
            return None
        times *= 1.25
    contacts = tuple(
        replace(given, beta=None, epsilon=built.epsilon)
        for given, built in zip(parts.contacts, problem.contacts)
    )
    effects = tuple(replace(added, given=_as_stiff(problem, added)) for added in parts.effects)
    time = replace(parts.time, end=problem.end, end_over=None, step=("fraction", fraction))
    larger = replace(parts, bodies=bodies, contacts=contacts, effects=effects, time=time)
    return Problem(larger, problem.file, problem.threads, [copy.copy(own) for own in problem.own])


def _as_stiff(problem: Problem, added: Any) -> Any:
    """What an effect was given, an obstacle with its penalty as a number: larger elements would make it softer."""
    given = added.given
    if added.name != "obstacle" or given.epsilon is not None:
        return given
    body = problem.bodies[given.surface[0]]
    return replace(
        given,
        beta=None,
        epsilon=lib.ct_contact_penalty(given.beta, body.material.young, body.mesh.shortest_edge),
    )


def _lattice(body: scene_parts.Body) -> scene_parts.Box | scene_parts.Ring | None:
    return body.box or body.ring


def element_count(problem: Problem, bodies: dict[str, scene_parts.Body]) -> int:
    """The elements of bodies, those with meshes of their own as the problem has them."""
    return sum(
        math.prod(_lattice(body).cells)
        if _lattice(body)
        else len(problem.bodies[name].mesh.elements)
        for name, body in bodies.items()
    )


def _larger(body: scene_parts.Body, times: float) -> scene_parts.Body:
    """A body with elements that are some times larger."""
    lattice = _lattice(body)
    if lattice is None:
        return body
    fewest = [FEWEST_CELLS] * 3 if body.box else [1, FEWEST_AROUND, 1]
    cells = tuple(min(n, max(least, round(n / times))) for n, least in zip(lattice.cells, fewest))
    lattice = replace(lattice, cells=cells)
    return replace(body, box=lattice) if body.box else replace(body, ring=lattice)


def _updates(problem: Problem, bodies: dict[str, scene_parts.Body]) -> float:
    """What a run with these bodies costs, about, in updates of an element."""
    pressed = [surface[0] for contact in problem.parts.contacts for surface in contact.surfaces]
    pressed += [
        added.given.surface[0] for added in problem.parts.effects if added.name == "obstacle"
    ]
    total, shorter = 0.0, 1.0
    for name, body in bodies.items():
        mesh, now, before = (
            problem.bodies[name].mesh,
            _lattice(body),
            _lattice(problem.parts.bodies[name]),
        )
        elements, faces = len(mesh.elements), len(mesh.elements) ** (2 / 3)
        if now is not None:
            x, y, z = now.cells
            elements, faces = x * y * z, max(x * y, y * z, z * x)
            shorter = min([shorter, *(n / m for n, m in zip(now.cells, before.cells) if m > 1)])
        total += elements + FACE_UPDATES * pressed.count(name) * faces
    # The step goes with the size of the elements.
    return total * problem.step_count * shorter


# Its run.


def _run(problem: Problem, coarse: Problem) -> Rehearsal:
    """Run the coarse problem and look at it on the way."""
    state, error = new_state(coarse), new_error()
    nodes, last = coarse.pointer.node_count, coarse.step_count
    looks = max(1, min(LOOKS, last, int(MOST_NUMBERS / (6 * nodes))))
    rows = lambda array: np.frombuffer(ffi.buffer(array, 24 * nodes), np.float64).reshape(-1, 3)
    u, v = rows(state.displacement), rows(state.velocity)
    impulse = np.empty(0)
    if state.impulse_count:
        impulse = np.frombuffer(ffi.buffer(state.impulse, 8 * state.impulse_count), np.float64)
    ends = np.cumsum(
        [0]
        + [3 * coarse.pointer.effects[k].node_count for k in range(1, coarse.pointer.effect_count)]
    )
    pressing, ways, speeds, before = np.zeros((looks, len(coarse.effects))), [], [], impulse.copy()
    for look in range(looks):
        check(
            lib.ct_step_many(
                coarse.pointer, state, round((look + 1) / looks * last) - state.step, error
            ),
            error,
        )
        # An effect has acted on a node when its impulse there is another.
        changed = (impulse != before).reshape(-1, 3).any(axis=1)
        for k, (first, end) in enumerate(zip(ends // 3, ends[1:] // 3), start=1):
            pressing[look, k] = changed[first:end].mean() if end > first else 0.0
        before = impulse.copy()
        ways.append(u.copy())
        speeds.append(v.copy())
        if _at_rest(coarse, state):
            break
    count = len(ways)
    steps = math.ceil(count / looks * problem.step_count)
    return Rehearsal(problem, coarse, steps, pressing[:count], np.array(ways), np.array(speeds))


def _at_rest(problem: Problem, state: Any) -> bool:
    """Whether a run that ends at rest would end here."""
    wanted, unrest = problem.parts.time.until_static, ffi.new("double *")
    if wanted is None or state.time < problem.settled:
        return False
    check(lib.ct_energy_unrest(problem.pointer, state, unrest, new_error()))
    return unrest[0] <= wanted


def _group(points: np.ndarray, count: int) -> list[tuple[int, int]]:
    """
    The rows that stand for groups of like rows, and how many each stands for: Lloyd's iteration from rows far from each other.
    """
    centres = [points.mean(axis=0)]
    for _ in range(count - 1):
        centres.append(points[_squares(points, centres).min(axis=1).argmax()])
    for _ in range(20):
        nearest = _squares(points, centres).argmin(axis=1)
        centres = [
            points[nearest == k].mean(axis=0) for k in range(len(centres)) if np.any(nearest == k)
        ]
    squares = _squares(points, centres)
    nearest = squares.argmin(axis=1)
    return [
        (int(squares[:, k].argmin()), int(np.sum(nearest == k)))
        for k in range(len(centres))
        if np.any(nearest == k)
    ]


def _squares(points: np.ndarray, centres: list[np.ndarray]) -> np.ndarray:
    """Squared distances of all points from all centres."""
    return ((points[:, None, :] - np.array(centres)[None, :, :]) ** 2).sum(axis=2)


# From its meshes to those of the run.


class _Map:
    """Lays what a coarse body does on the body of the run: linear in each coordinate of the lattice between its corners."""

    def __init__(self, problem: Problem, coarse: Problem, name: str):
        self.fine, self.coarse = problem.bodies[name], coarse.bodies[name]
        given, larger = problem.parts.bodies[name], coarse.parts.bodies[name]
        self.turns = (
            given.ring is not None and problem.parts.materials[given.material].law != "linear"
        )
        lattice = _lattice(larger)
        if lattice is None or lattice.cells == _lattice(given).cells:
            self.numbers, self.weights = (
                np.arange(len(self.fine.mesh.nodes))[:, None],
                np.ones((len(self.fine.mesh.nodes), 1)),
            )
            return
        place = (
            _box_places(self.fine.mesh.nodes, lattice)
            if larger.box
            else _ring_places(self.fine.mesh.nodes, lattice)
        )
        cells = np.array(lattice.cells)
        low = np.clip(np.floor(place), 0, cells - 1)
        part = place - low
        corners = cells + 1 if larger.box else cells + [1, 0, 1]
        first, second, third = box_axes(cells, coarse.layers(larger)) if larger.box else (0, 1, 2)
        self.numbers, self.weights = np.empty((len(place), 8), np.int64), np.empty((len(place), 8))
        for k in range(8):
            bits = np.array([k & 1, k >> 1 & 1, k >> 2])
            at = ((low + bits).astype(np.int64) % corners).T
            self.numbers[:, k] = at[first] + corners[first] * (
                at[second] + corners[second] * at[third]
            )
            self.weights[:, k] = np.where(bits == 1, part, 1.0 - part).prod(axis=1)

    def __call__(
        self, displacement: np.ndarray, velocity: np.ndarray, u: np.ndarray, v: np.ndarray
    ) -> None:
        """Write the rows of this body into ``u`` and ``v``."""
        own_u, own_v = displacement[self.coarse.nodes], velocity[self.coarse.nodes]
        if not self.turns:
            u[self.fine.nodes], v[self.fine.nodes] = self._between(own_u), self._between(own_v)
            return
        # What a large rotation does is not linear along an arc; what is left beside it is small.
        X, fine = self.coarse.mesh.nodes, self.fine.mesh.nodes
        x = X + own_u
        turn, centre, now = rotation(X, x), X.mean(axis=0), x.mean(axis=0)
        left = (x - now) @ turn - (X - centre)
        there = (fine - centre + self._between(left)) @ turn.T + now
        u[self.fine.nodes] = there - fine
        rate = np.linalg.lstsq(_crosses(x - now), (own_v - own_v.mean(axis=0)).ravel(), rcond=None)[
            0
        ]
        mean = own_v.mean(axis=0)
        v[self.fine.nodes] = (
            mean
            + np.cross(rate, there - now)
            + self._between(own_v - mean - np.cross(rate, x - now))
        )

    def _between(self, values: np.ndarray) -> np.ndarray:
        return np.einsum("nk,nkc->nc", self.weights, values[self.numbers])


def _box_places(nodes: np.ndarray, box: scene_parts.Box) -> np.ndarray:
    """Coordinates in cells of a box."""
    return (nodes - box.origin) / box.size * box.cells


def _ring_places(nodes: np.ndarray, ring: scene_parts.Ring) -> np.ndarray:
    """Coordinates in cells of a ring: along the radius, around, across."""
    r = nodes - ring.centre
    along = (np.hypot(r[:, 0], r[:, 1]) - ring.radius[0]) / (ring.radius[1] - ring.radius[0])
    around = np.arctan2(r[:, 1], r[:, 0]) / (2.0 * math.pi) % 1.0
    return np.column_stack([along, around, r[:, 2] / ring.width + 0.5]) * ring.cells


def _crosses(r: np.ndarray) -> np.ndarray:
    """The matrix (3 n, 3) that takes a vector ω to ω × r of all rows."""
    out = np.zeros((len(r), 3, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        out[:, i, j], out[:, i, k] = r[:, k], -r[:, j]
    return out.reshape(-1, 3)
