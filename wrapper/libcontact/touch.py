"""The first possible touch of each contact and obstacle of a scene."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from .problem import Problem

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Touch:
    """
    One contact or obstacle, number ``contact`` of those named ``name``: the earliest ``time`` at which its surfaces can meet
    (infinite: never), and the ``shift`` (3,) of ``body`` that brings them together. ``normal`` (3,) points from the first surface to what it
    meets. Along ``normal`` the two close with the speed ``closing`` when they meet (0: they don't).
    """

    name: str
    contact: int
    body: str
    time: float
    shift: Array
    normal: Array
    closing: float


def first_touch(problem: Problem) -> list[Touch]:
    """
    For each contact when the boxes of its bodies meet, and for each obstacle when the surface does, the bodies moving as they
    began and with their gravity.
    """
    obstacles = [added.given for added in problem.parts.effects if added.name == "obstacle"]
    out = [_obstacle(problem, i, given) for i, given in enumerate(obstacles)]
    for i, contact in enumerate(problem.parts.contacts):
        if contact.with_itself:
            out.append(
                Touch("contact", i, contact.surfaces[1][0], 0.0, np.zeros(3), np.zeros(3), 0.0)
            )
        else:
            out.append(_pair(problem, i))
    return out


def surface_box(problem: Problem, contact: int, side: int) -> tuple[Array, Array]:
    """Smallest and largest coordinates of a contact's surface, 0 or 1."""
    body, _ = problem.parts.contacts[contact].surfaces[side]
    points = problem.bodies[body].mesh.nodes[np.unique(problem.faces[contact][side])]
    return points.min(axis=0), points.max(axis=0)


def _pair(problem: Problem, number: int) -> Touch:
    """When the boxes of two bodies meet: not before they have met along every axis that they are apart along."""
    (a, _), (b, _) = problem.parts.contacts[number].surfaces
    (low_a, high_a), (low_b, high_b) = (problem.bodies[name].mesh.bounds for name in (a, b))
    gaps = np.maximum(low_b - high_a, low_a - high_b)
    side = np.where(low_b > low_a, 1.0, -1.0)
    speed = side * (np.array(problem.parts.bodies[a].velocity) - problem.parts.bodies[b].velocity)
    pull = side * (gravity_on(problem, a) - gravity_on(problem, b))
    axis = int(np.argmax(gaps))
    normal = side * (np.arange(3) == axis)
    gap = max(float(gaps[axis]), 0.0)
    time = max(
        [_fall(float(gaps[k]), float(speed[k]), float(pull[k])) for k in range(3) if gaps[k] > 0.0],
        default=0.0,
    )
    return Touch(
        "contact", number, b, time, -gap * normal, normal, _closing(gap, speed[axis], pull[axis])
    )


def _obstacle(problem: Problem, number: int, given: Any) -> Touch:
    """
    When the nearest node of an obstacle's surface comes to it; one that is moved by a history is taken as touched from the
    start.
    """
    body, face = given.surface
    mesh = problem.bodies[body].mesh
    gaps, normals = given.gaps(mesh.nodes[mesh.face_nodes(face)])
    nearest = int(np.argmin(gaps))
    gap, normal = max(float(gaps[nearest]), 0.0), normals[nearest]
    speed = -float(
        (np.array(problem.parts.bodies[body].velocity) - np.array(given.velocity)) @ normal
    )
    pull = -float(gravity_on(problem, body) @ normal)
    time = 0.0 if given.history[0] or gap == 0.0 else _fall(gap, speed, pull)
    return Touch("obstacle", number, body, time, -gap * normal, -normal, _closing(gap, speed, pull))


def gravity_on(problem: Problem, body: str) -> Array:
    """The acceleration (3,) of a body that falls freely."""
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


def _closing(gap: float, speed: float, pull: float) -> float:
    """The speed with which a gap closes when it has closed; 0 if it never does."""
    if gap == 0.0:
        return max(float(speed), 0.0)
    return (
        math.sqrt(speed * speed + 2.0 * pull * gap)
        if math.isfinite(_fall(gap, speed, pull))
        else 0.0
    )
