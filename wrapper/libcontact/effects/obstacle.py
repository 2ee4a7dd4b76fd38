"""``[[obstacle]]``: a rigid plane, sphere or cylinder, fixed or moving, against the surface of a body (chapter "Obstacle")."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .._core import ffi, lib
from ..schema import Table
from ..surfaces import DEFAULT_BETA, ENFORCEMENTS, read_enforcement, split_face
from ..units import Units
from . import Known
from .load import c_history, read_history

MANY = True
WITHOUT = "no [[obstacle]]: no rigid walls, spheres or cylinders"
SHAPES = {
    "plane": (lib.CT_OBSTACLE_PLANE, "point", "normal"),
    "sphere": (lib.CT_OBSTACLE_SPHERE, "centre", None),
    "cylinder": (lib.CT_OBSTACLE_CYLINDER, "centre", "axis"),
}


@dataclass(frozen=True, eq=False)
class Obstacle:
    """
    An obstacle; exactly one of ``beta`` and ``epsilon`` is a number. Its way is ``velocity`` times time plus ``travel`` times the line
    through ``history``.
    """

    surface: tuple[str, str]
    shape: str
    point: tuple[float, float, float]
    axis: tuple[float, float, float]
    radius: float
    beta: float | None
    epsilon: float | None
    velocity: tuple[float, float, float]
    travel: tuple[float, float, float]
    history: tuple[tuple[float, ...], tuple[float, ...]]
    friction: float
    tangent: float
    enforcement: str
    dissipation: float

    def gaps(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gaps (n,) of points (n, 3) to the obstacle at the start, negative inside it, and its normals (n, 3) there."""
        r = points - np.array(self.point)
        axis = np.array(self.axis) / np.linalg.norm(self.axis)
        if self.shape == "plane":
            return r @ axis, np.broadcast_to(axis, r.shape)
        away = r if self.shape == "sphere" else r - np.outer(r @ axis, axis)
        distance = np.linalg.norm(away, axis=1)
        return distance - self.radius, away / np.maximum(distance, np.finfo(float).tiny)[:, None]


def read(table: Table, known: Known) -> Obstacle:
    surface = split_face(table, "surface", table.text("surface"), known.bodies)
    shape = table.one_of(*SHAPES)
    point, axis, radius = _shape(table.table(shape), shape)
    given = table.one_of("beta", "epsilon", required=False)
    obstacle = Obstacle(
        surface=surface,
        shape=shape,
        point=point,
        axis=axis,
        radius=radius,
        beta=table.number("beta", None if given else DEFAULT_BETA, above=0.0),
        epsilon=table.number("epsilon", None, above=0.0),
        velocity=table.vector("velocity", (0.0, 0.0, 0.0)),
        travel=table.vector("travel", (0.0, 0.0, 0.0)),
        history=read_history(table),
        friction=table.number("friction", 0.0, least=0.0),
        tangent=table.number("tangent", 0.0, above=0.0),
        **dict(zip(("enforcement", "dissipation"), read_enforcement(table))),
    )
    if any(obstacle.travel) != bool(obstacle.history[0]):
        raise table.error(
            "history", 'and "travel" go together: the way is travel times the history'
        )
    if obstacle.tangent and not obstacle.friction:
        raise table.error("tangent", 'belongs to friction; give "friction" too')
    return obstacle


def _shape(table: Table, shape: str) -> tuple[tuple[float, ...], tuple[float, ...], float]:
    _, place, direction = SHAPES[shape]
    point = table.vector(place)
    axis = (0.0, 0.0, 1.0) if direction is None else table.vector(direction)
    if not any(axis):
        raise table.error(direction, "is zero; it must have a length")
    radius = 0.0 if shape == "plane" else table.number("radius", above=0.0)
    table.done()
    return point, axis, radius


def create(given: Obstacle, maker: Any) -> list[Any]:
    """The obstacle's effect, and after it that of its friction, if it has one."""
    kind, faces = maker.faces(given.surface)
    body = maker.body(given.surface[0])
    epsilon = given.epsilon or lib.ct_contact_penalty(
        given.beta, body.material.young, lib.ct_mesh_shortest_edge(body.mesh)
    )
    options = ffi.new(
        "ct_obstacle *",
        {
            "shape": SHAPES[given.shape][0],
            "point": given.point,
            "axis": given.axis,
            "radius": given.radius,
            "epsilon": epsilon,
            "enforcement": ENFORCEMENTS[given.enforcement],
            "dissipation": given.dissipation,
            "velocity": given.velocity,
            "travel": given.travel,
            "history": c_history(given.history, maker),
            "kind": kind,
            "face_count": len(faces),
            "faces": ffi.from_buffer("int32_t[]", faces),
        },
    )
    made = [maker.make(lib.ct_obstacle_create_effect, options)]
    if given.friction:
        rough = ffi.new(
            "ct_friction *",
            {"on": made[0], "coefficient": given.friction, "tangent": given.tangent},
        )
        made.append(maker.make(lib.ct_friction_create_effect, rough))
    return made


def describe(given: Obstacle, units: Units) -> str:
    size = f" of radius {given.radius:g} {units.length}" if given.radius else ""
    motion = (
        f", moving at {list(given.velocity)} {units.label('velocity')}"
        if any(given.velocity)
        else ""
    )
    motion += (
        f", moving by {list(given.travel)} {units.length} with a history"
        if given.history[0]
        else ""
    )
    penalty = (
        f"beta = {given.beta:g}"
        if given.beta is not None
        else f"epsilon = {given.epsilon:g} {units.label('penalty')}"
    )
    rub = f", friction {given.friction:g}" if given.friction else ", without friction"
    penalty += f", enforced by {given.enforcement}"
    return f"{given.shape}{size} at {list(given.point)} {units.length} against {'.'.join(given.surface)}{motion}; {penalty}{rub}"
