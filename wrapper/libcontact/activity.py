"""
When something can happen in a scene: the first possible touch of each contact, and how much of the elements a force can have
reached.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ._core import ffi
from .problem import Problem

# Elements that are quiet together (the library's batch).
BATCH = 8
# Beyond this the front is not followed element by element; all are taken as active.
MOST_ELEMENTS = 2_000_000


@dataclass(frozen=True, eq=False)
class Touch:
    """
    One contact or obstacle, number ``contact`` of those named ``name``: the earliest ``time`` at which its surfaces can meet
    (infinite: never), and the ``shift`` (3,) of ``body`` that brings them together.
    """

    name: str
    contact: int
    body: str
    time: float
    shift: np.ndarray


def first_touch(problem: Problem) -> list[Touch]:
    """
    For each contact when the boxes of its surfaces meet, and for each obstacle when the surface does, the bodies moving as they
    began and with their gravity.
    """
    obstacles = [added.given for added in problem.parts.effects if added.name == "obstacle"]
    out = [_obstacle(problem, i, given) for i, given in enumerate(obstacles)]
    for i, contact in enumerate(problem.parts.contacts):
        (a, _), (b, _) = contact.surfaces
        if contact.with_itself:
            out.append(Touch("contact", i, b, 0.0, np.zeros(3)))
            continue
        boxes = []
        for body, faces in zip((a, b), problem.faces[i]):
            points = problem.bodies[body].mesh.nodes[np.unique(faces)]
            boxes.append((points.min(axis=0), points.max(axis=0)))
        gaps = np.maximum(boxes[1][0] - boxes[0][1], boxes[0][0] - boxes[1][1])
        axis = int(np.argmax(gaps))
        gap, side = float(gaps[axis]), 1.0 if boxes[1][0][axis] > boxes[0][1][axis] else -1.0
        if gap <= 0.0:
            out.append(Touch("contact", i, b, 0.0, np.zeros(3)))
            continue
        speed = side * (problem.parts.bodies[a].velocity[axis] - problem.parts.bodies[b].velocity[axis])
        pull = side * (_gravity(problem, a)[axis] - _gravity(problem, b)[axis])
        shift = np.zeros(3)
        shift[axis] = -side * gap
        out.append(Touch("contact", i, b, _fall(gap, speed, pull), shift))
    return out


def _obstacle(problem: Problem, number: int, given: Any) -> Touch:
    """
    When the nearest node of an obstacle's surface comes to it; one that is moved by a history is taken as touched from the
    start.
    """
    body, face = given.surface
    mesh = problem.bodies[body].mesh
    points = mesh.nodes[mesh.face_nodes(face)]
    r = points - np.array(given.point)
    if given.shape == "plane":
        normals = np.broadcast_to(np.array(given.axis) / np.linalg.norm(given.axis), r.shape)
        gaps = (r * normals).sum(axis=1)
    else:
        axis = np.array(given.axis) / np.linalg.norm(given.axis)
        away = r if given.shape == "sphere" else r - np.outer(r @ axis, axis)
        distance = np.linalg.norm(away, axis=1)
        gaps, normals = distance - given.radius, away / np.maximum(distance, np.finfo(float).tiny)[:, None]
    nearest = int(np.argmin(gaps))
    gap, normal = float(gaps[nearest]), normals[nearest]
    if gap <= 0.0:
        return Touch("obstacle", number, body, 0.0, np.zeros(3))
    speed = -float((np.array(problem.parts.bodies[body].velocity) - np.array(given.velocity)) @ normal)
    time = 0.0 if given.history[0] else _fall(gap, speed, -float(_gravity(problem, body) @ normal))
    return Touch("obstacle", number, body, time, -gap * normal)


def _gravity(problem: Problem, body: str) -> np.ndarray:
    total = np.zeros(3)
    for added in problem.parts.effects:
        if added.name == "gravity" and (added.given.bodies is None or body in added.given.bodies):
            total += added.given.acceleration
    return total


def _fall(gap: float, speed: float, pull: float) -> float:
    """The first time at which speed t + pull t² / 2 = gap."""
    if pull == 0.0:
        return gap / speed if speed > 0.0 else math.inf
    square = speed * speed + 2.0 * pull * gap
    if square < 0.0 or (pull < 0.0 and speed <= 0.0):
        return math.inf
    return 2.0 * gap / (speed + math.sqrt(square))


def active_share(problem: Problem, touch: list[Touch], count: int, begins: np.ndarray | None = None) -> float:
    """
    The share of the elements' work that is left where those are skipped which no force can have reached, the mean over the
    first ``count`` steps of the run. A force goes one element a step; it begins where a support stops a node, and at the nodes
    of each effect at the step that ``begins`` (effects) says; without it where surfaces can touch, and of other effects at
    once. 1 where nothing is left out, as in a layer in plane strain that is no lattice.
    """
    if "quiet" not in problem.parts.savings or sum(len(body.mesh.elements) for body in problem.bodies.values()) > MOST_ELEMENTS:
        return 1.0
    starts = _starts(problem, touch, begins)
    active = total = 0.0
    for name, body in problem.bodies.items():
        share, work = 1.0, body.flops * len(body.mesh.elements)
        if body.kernel != "plane" or problem.has_rows(problem.parts.bodies[name]):
            steps = _first_steps(body.mesh.elements, starts[body.nodes])
            batches = np.minimum.reduceat(steps, np.arange(0, len(steps), BATCH))
            share = float(np.mean(np.maximum(count - batches, 0.0))) / count
        active += share * work
        total += work
    return active / total


def _starts(problem: Problem, touch: list[Touch], begins: np.ndarray | None) -> np.ndarray:
    """The step at which a force can begin at each node of the problem; infinite where none does."""
    pointer = problem.pointer
    count = pointer.node_count
    starts = np.full(count, np.inf)
    velocity = np.frombuffer(ffi.buffer(pointer.initial_velocity, 24 * count), np.float64).reshape(-1, 3)
    for body in problem.bodies.values():
        own = velocity[body.nodes]
        common = np.median(own, axis=0)
        starts[body.nodes][np.any(own != common, axis=1)] = 0.0
    times = {(move.name, move.contact): move.time for move in touch}
    met = dict.fromkeys(("contact", "obstacle"), 0)
    for k, name in enumerate(problem.effects):
        effect = pointer.effects[k]
        if k == 0 or effect.reaction or effect.node_count == 0:
            continue
        everywhere = effect.nodes == ffi.NULL
        nodes = slice(None) if everywhere else np.frombuffer(ffi.buffer(effect.nodes, 4 * effect.node_count), np.int32)
        begin = 0.0
        if name in met:
            begin = times[name, met[name]] / problem.dt
            met[name] += 1
        starts[nodes] = np.minimum(starts[nodes], begin if begins is None else begins[k])
    return starts


def _first_steps(elements: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """For each element the step at which one of its nodes is reached first, the front going on by an element a step."""
    reached = starts.copy()
    while True:
        steps = reached[elements].min(axis=1)
        after = reached.copy()
        np.minimum.at(after, elements.ravel(), np.repeat(steps + 1.0, elements.shape[1]))
        if np.array_equal(after, reached):
            return steps
        reached = after
