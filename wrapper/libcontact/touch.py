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
    The first possible touch of one contact or obstacle.

    Attributes
    ----------
    name : str
        ``"contact"`` or ``"obstacle"``.
    contact : int
        Number among those of this name.
    body : str
        The body that comes.
    time : float
        The earliest time at which the surfaces can meet; infinite: never.
    shift : ndarray, shape (3,)
        What brings the surface of ``body`` to the other one.
    normal : ndarray, shape (3,)
        Direction from the first surface to what it meets.
    closing : float
        Speed along ``normal`` with which the two meet; 0: they don't.
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
    Find the first touch of each contact and obstacle.

    Boxes of bodies meet, or a surface meets an obstacle, while bodies move as they began and with their gravity.

    Parameters
    ----------
    problem : Problem
        A built problem.

    Returns
    -------
    list of Touch
        Obstacles first, then contacts, in the order of the scene.
    """
    obstacles = [added.given for added in problem.parts.effects if added.name == "obstacle"]
    return [_obstacle(problem, i, given) for i, given in enumerate(obstacles)] + [
        _pair(problem, i) for i in range(len(problem.parts.contact))
    ]


def surface_box(problem: Problem, contact: int, side: int) -> tuple[Array, Array]:
    """Return the smallest and largest coordinates of a contact's surface, 0 or 1."""
    body, _ = problem.parts.contact[contact].surfaces[side]
    points = problem.bodies[body].mesh.nodes[np.unique(problem.faces[contact][side])]
    return points.min(axis=0), points.max(axis=0)


def gravity_on(problem: Problem, body: str) -> Array:
    """Return the acceleration (3,) of a body that falls freely."""
    total = np.zeros(3)
    for added in problem.parts.effects:
        if added.name == "gravity" and (added.given.bodies is None or body in added.given.bodies):
            total += added.given.acceleration
    return total


def _pair(problem: Problem, number: int) -> Touch:
    """When the boxes of two bodies meet: not before they have met along every axis that they are apart along."""
    (a, _), (b, _) = problem.parts.contact[number].surfaces
    if a == b:
        return Touch("contact", number, b, 0.0, np.zeros(3), np.zeros(3), 0.0)
    (low_a, high_a), (low_b, high_b) = (problem.bodies[name].mesh.bounds for name in (a, b))
    apart = np.maximum(low_b - high_a, low_a - high_b)
    gaps, k = np.maximum(apart, 0.0), int(np.argmax(apart))
    side = np.where(low_b > low_a, 1.0, -1.0)
    (v_a, g_a), (v_b, g_b) = _motion(problem, a), _motion(problem, b)
    meets = [_meet(*axis) for axis in zip(gaps, side * (v_a - v_b), side * (g_a - g_b))]
    normal, time = side * (np.arange(3) == k), max(time for time, _ in meets)
    return Touch("contact", number, b, time, -gaps[k] * normal, normal, meets[k][1])


def _obstacle(problem: Problem, number: int, given: Any) -> Touch:
    """When the nearest node of an obstacle's surface comes to it; one that is moved by a history is touched from the start."""
    body, face = given.surface
    mesh = problem.bodies[body].mesh
    gaps, normals = given.gaps(mesh.nodes[mesh.face_nodes(face)])
    normal, gap = -normals[np.argmin(gaps)], max(float(gaps.min()), 0.0)
    velocity, gravity = _motion(problem, body)
    time, closing = _meet(gap, (velocity - given.velocity) @ normal, gravity @ normal)
    time = 0.0 if given.history else time
    return Touch("obstacle", number, body, time, gap * normal, normal, closing)


def _motion(problem: Problem, body: str) -> tuple[Array, Array]:
    """First velocity and acceleration (3,) of a body."""
    return np.array(problem.parts.bodies[body].velocity), gravity_on(problem, body)


def _meet(gap: float, speed: float, pull: float) -> tuple[float, float]:
    """The first time at which speed t + pull t² / 2 = gap, and the speed then; infinite and 0 where there is none."""
    square = speed * speed + 2.0 * pull * gap
    if gap == 0.0:
        return 0.0, max(float(speed), 0.0)
    if square < 0.0 or (pull <= 0.0 and speed <= 0.0):
        return math.inf, 0.0
    return 2.0 * gap / (speed + math.sqrt(square)), math.sqrt(square)
