"""The first possible touch of each contact and obstacle of a scene."""

from __future__ import annotations

import math
from collections.abc import Container
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
import numpy.typing as npt

from ..model import Contact
from ..problem import Problem

Array = npt.NDArray[np.float64]
# Corners (3,), (3,) of the bounding box of a body at the start, its velocity and its acceleration.
Way = tuple[Array, Array, Array, Array]


@dataclass(frozen=True, eq=False)
class Touch:
    """
    The first possible touch of one contact or obstacle.

    Attributes
    ----------
    key : str
        Its key in the scene, ``"contact[0]"`` or ``"obstacle[0]"``.
    given : Contact or Obstacle
        Its table.
    surfaces : tuple
        Its surfaces, each a body and a face: two, or that of an obstacle.
    body : str
        The body that is moved by ``shift``.
    time : float
        The earliest time at which the surfaces can meet; infinite: never.
    shift : ndarray, shape (3,)
        Displacement that brings ``body`` into touch [length].
    normal : ndarray, shape (3,)
        Direction from the first surface to the second one or the obstacle.
    closing : float
        Speed along ``normal`` with which the two meet; 0 if they do not.
    """

    key: str
    given: Any
    surfaces: tuple[tuple[str, str], ...]
    body: str
    time: float
    shift: Array
    normal: Array
    closing: float


def first_touch(problem: Problem) -> list[Touch]:
    """The first touch of each contact, then of each obstacle, in the order of the scene. Bodies move with their
    initial velocity and gravity, until their boxes overlap or a surface reaches an obstacle."""
    parts, ways = problem.parts, _ways(problem)
    pairs = [_pair(ways, f"contact[{i}]", given) for i, given in enumerate(parts.contact)]
    obstacles = enumerate(parts.obstacle)
    return pairs + [_obstacle(problem, f"obstacle[{i}]", given) for i, given in obstacles]


def started(problem: Problem, body: str) -> Array:
    """Positions (n, 3) of the nodes of a body at the start."""
    nodes, initial = problem.bodies[body].mesh.nodes, problem.parts.bodies[body].initial
    shift = None if initial is None else initial.at(nodes)
    return nodes if shift is None else nodes + shift


def _ways(problem: Problem, still: Container[str] = ()) -> dict[str, Way]:
    """The way of each body; those that are ``still`` do not move."""
    out, at_rest = {}, (np.zeros(3), np.zeros(3))
    for name, given in problem.parts.bodies.items():
        low, high = problem.bodies[name].mesh.bounds
        if given.initial is not None:
            x = started(problem, name)
            low, high = x.min(axis=0), x.max(axis=0)
        out[name] = (low, high, *(at_rest if name in still else _motion(problem, name)))
    return out


def gravity_on(problem: Problem, body: str) -> Array:
    """Return the acceleration (3,) of a body by gravity."""
    gravity = problem.parts.gravity
    falls = gravity is not None and (gravity.bodies is None or body in gravity.bodies)
    return np.array(gravity.acceleration if falls else (0.0, 0.0, 0.0))


def _pair(ways: dict[str, Way], key: str, given: Contact) -> Touch:
    """Touch of two bodies: the time at which their bounding boxes have met along all axes."""
    (a, _), (b, _) = given.surfaces
    if a == b:
        return Touch(key, given, given.surfaces, b, 0.0, np.zeros(3), np.zeros(3), 0.0)
    time, gap, normal, closing = _approach(ways[a], ways[b])
    return Touch(key, given, given.surfaces, b, time, -max(gap, 0.0) * normal, normal, closing)


def _approach(a: Way, b: Way) -> tuple[float, float, Array, float]:
    """The time at which the bounding boxes of two bodies have met along all axes; their gap, negative if they overlap,
    its direction from a to b, and the speed along it."""
    (low_a, high_a, *motion_a), (low_b, high_b, *motion_b) = a, b
    apart = np.maximum(low_b - high_a, low_a - high_b)
    side, k = np.where(low_b > low_a, 1.0, -1.0), int(np.argmax(apart))
    speed, pull = (side * (own - other) for own, other in zip(motion_a, motion_b))
    meets = [_meet(*axis) for axis in zip(np.maximum(apart, 0.0), speed, pull)]
    normal, time = side * (np.arange(3) == k), max(time for time, _ in meets)
    return time, float(apart[k]), normal, meets[k][1]


def meetings(problem: Problem, still: Container[str]) -> list[tuple[float, str, str, bool]]:
    """In order of time, the pairs of bodies whose bounding boxes meet before the end, and whether they are apart at the
    start. Bodies that are ``still`` do not move, the others as for first_touch."""
    ways, out = _ways(problem, still), []
    for a, b in combinations(ways, 2):
        time, gap, normal, closing = _approach(ways[a], ways[b])
        size = max(float((high - low).max()) for low, high, *_ in (ways[a], ways[b]))
        apart, falls = gap >= -1e-9 * size, float((ways[a][3] - ways[b][3]) @ normal) > 0.0
        if time < problem.end and (closing > 0.0 or falls or not apart):
            out.append((time, a, b, apart))
    return sorted(out)


def _obstacle(problem: Problem, key: str, given: Any) -> Touch:
    """Touch of a surface and an obstacle: the time at which the nearest node reaches it; 0 for an obstacle
    that a history moves."""
    body, face = given.surface
    mesh = problem.bodies[body].mesh
    gaps, normals = given.gaps(started(problem, body)[mesh.face_nodes(face)])
    normal, gap = -normals[np.argmin(gaps)], max(float(gaps.min()), 0.0)
    velocity, gravity = _motion(problem, body)
    time, closing = _meet(gap, (velocity - given.velocity) @ normal, gravity @ normal)
    time = 0.0 if given.history else time
    return Touch(key, given, (given.surface,), body, time, gap * normal, normal, closing)


def _motion(problem: Problem, body: str) -> tuple[Array, Array]:
    """Initial velocity and acceleration (3,) of a body."""
    return np.array(problem.parts.bodies[body].velocity), gravity_on(problem, body)


def _meet(gap: float, speed: float, pull: float) -> tuple[float, float]:
    """The first time at which speed t + pull t² / 2 = gap, and the speed at that time; infinite and 0 if
    there is none."""
    square = speed * speed + 2.0 * pull * gap
    if gap == 0.0:
        return 0.0, max(float(speed), 0.0)
    if square < 0.0 or (pull <= 0.0 and speed <= 0.0):
        return math.inf, 0.0
    return 2.0 * gap / (speed + math.sqrt(square)), math.sqrt(square)
