"""``[[obstacle]]``: a rigid plane, sphere or cylinder, fixed or moving, in contact with the surface of
a body (chapter "Obstacle")."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import lib
from ..bridge import names
from ..model import (
    ENFORCEMENTS,
    FEEDS,
    ORIGIN,
    POSITIVE,
    ContactLaw,
    History,
    Vector,
    modulus,
    speeds,
)
from ..schema import VECTOR, Nested, Reference, Table, key
from ..units import Units
from . import OnSurface

SHAPES = names("ct_obstacle_shape")
NO_DIRECTION = "is zero, and must be a direction"


class Plane(Table):
    """
    A plane.

    Attributes
    ----------
    point
        A point of the plane.
    normal
        Its normal, which points out of the obstacle.
    """

    radius = 0.0

    point: Vector = key(VECTOR, unit="length")
    normal: Vector = key(VECTOR)

    @property
    def axis(self) -> Vector:
        """The direction of the shape."""
        return self.normal

    def refusals(self) -> Iterator[tuple[str, str]]:
        if not any(self.normal):
            yield "normal", NO_DIRECTION


class Sphere(Table):
    """
    A sphere.

    Attributes
    ----------
    centre
        Its centre.
    radius
        Its radius.
    """

    axis = (0.0, 0.0, 1.0)

    centre: Vector = key(VECTOR, unit="length")
    radius: float = key(POSITIVE, unit="length")

    @property
    def point(self) -> Vector:
        """The position of the shape."""
        return self.centre


class Cylinder(Sphere):
    """
    A cylinder of any length.

    Attributes
    ----------
    axis
        Its direction.
    """

    axis: Vector = key(VECTOR)  # type: ignore[assignment]

    def refusals(self) -> Iterator[tuple[str, str]]:
        if not any(self.axis):
            yield "axis", NO_DIRECTION


class Obstacle(ContactLaw, OnSurface):
    """A rigid obstacle. Its displacement is ``velocity`` times time plus ``travel`` times
    ``history``.

    Attributes
    ----------
    surface
        A face in contact with the rigid obstacle (:doc:`/theory/obstacle`).
    plane
        A plane.
    sphere
        A sphere.
    cylinder
        A cylinder.
    velocity
        Velocity of the obstacle.
    travel
        The obstacle moves by the travel times the history, in addition to its velocity.
    history
        A piecewise linear factor in time (:eq:`amplitude`).
    carrier
        Name of a rigid body that carries the obstacle, which then has mass: it moves and turns with the
        body, by the forces on both (:doc:`/theory/rigid`).
    """

    without = "no [[obstacle]]: no rigid walls, spheres or cylinders"
    one = (tuple(SHAPES),)

    plane: Any = key(Nested(Plane), default=None, says="one of three")
    sphere: Any = key(Nested(Sphere), default=None, says="one of three")
    cylinder: Any = key(Nested(Cylinder), default=None, says="one of three")
    velocity: Vector = key(VECTOR, unit="length / time", default=ORIGIN)
    travel: Vector = key(VECTOR, unit="length", default=ORIGIN, says="none")
    history: Any = key(Nested(History), default=None, says="none")
    carrier: str | None = key(Reference("body"), default=None, says="none")

    @property
    def shape(self) -> str:
        """The key of the shape."""
        return next(name for name in SHAPES if getattr(self, name) is not None)

    def refusals(self) -> Iterator[tuple[str, str]]:
        if any(self.travel) != bool(self.history):
            yield (
                "history",
                'and "travel" go together: the displacement is travel times the history',
            )
        if self.carrier and (self.history or any(self.velocity)):
            given = "velocity" if any(self.velocity) else "history"
            yield given, "is that of a prescribed motion; with a carrier, give it to that body"
        if self.carrier and FEEDS[self.enforcement]:
            yield "enforcement", "can't be the explicit penalty with a carrier"
        if self.carrier == self.surface[0]:
            yield "carrier", f'"{self.carrier}" carries the obstacle and can\'t touch it, too'
        yield from super().refusals()

    def gaps(self, points: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
        """Gaps (n,) of points (n, 3) to the obstacle at the start, negative inside it, and its normals
        (n, 3) at the closest points."""
        shape = getattr(self, self.shape)
        r = points - np.array(shape.point)
        axis = np.array(shape.axis) / np.linalg.norm(shape.axis)
        if self.plane:
            return r @ axis, np.broadcast_to(axis, r.shape)
        away = r if self.sphere else r - np.outer(r @ axis, axis)
        distance = np.linalg.norm(away, axis=1)
        return distance - shape.radius, away / np.maximum(distance, np.finfo(float).tiny)[:, None]

    def penalties(self, body: Any, materials: Sequence[Any]) -> tuple[float, float]:
        """The penalty ε for contact with a body of the C scene, whose surface has these materials, and the ratio
        of the tangential penalty to it."""
        edge, law = lib.ct_mesh_shortest_edge(body.mesh), ENFORCEMENTS[self.enforcement]
        least = min(map(modulus, materials))
        epsilon = self.epsilon or lib.ct_contact_penalty_default(law, least, edge)
        if self.beta:
            young = min(each.young for each in materials)
            epsilon = lib.ct_contact_penalty(self.beta, young, edge)
        most = lib.ct_contact_penalty_default(lib.CT_ENFORCE_PENALTY, least, edge)
        return epsilon, self.tangent or min(1.0, most / epsilon)

    def members(self, maker: Any) -> dict[str, Any]:
        body, shape = maker.body(self.surface[0]), getattr(self, self.shape)
        materials = maker.materials(self.surface)
        softest = min(materials, key=modulus)
        return {
            **super().members(maker),
            "shape": SHAPES[self.shape],
            "point": shape.point,
            "axis": shape.axis,
            "radius": shape.radius,
            "epsilon": self.penalties(body, materials)[0],
            "travel_time": lib.ct_mesh_shortest_edge(body.mesh) / speeds(softest)[0],
            "amplitude": maker.history(self.history),
            "carrier": maker.bodies(self.carrier and [self.carrier])["bodies"],
        }

    def create(self, maker: Any) -> Any:
        """Create the effect of the obstacle, and after it that of its friction, if it has any."""
        made = super().create(maker)
        if not self.friction:
            return made
        body, materials = self.surface[0], maker.materials(self.surface)
        ratio = self.penalties(maker.body(body), materials)[1]
        if body in maker.parts.rigid_names:
            ratio = self.tangent or 1.0
        keys = {"on": made, "coefficient": self.friction, "tangent": ratio}
        return [made, maker.make("friction", self, **keys)]

    def describe(self, units: Units) -> str:
        shape = getattr(self, self.shape)
        text = self.shape + (f" of radius {shape.radius:g} {units.length}" if shape.radius else "")
        text += f" at {list(shape.point)} {units.length} against {'.'.join(self.surface)}"
        if self.carrier:
            text += f", carried by {self.carrier}"
        if any(self.velocity):
            text += f", moving at {list(self.velocity)} {units.label('velocity')}"
        if self.history:
            text += f", moving by {list(self.travel)} {units.length} with a history"
        if self.beta:
            text += f"; beta = {self.beta:g}"
        elif self.epsilon:
            text += f"; epsilon = {self.epsilon:g} {units.label('penalty')}"
        else:
            text += "; the default penalty"
        rub = f"friction {self.friction:g}" if self.friction else "without friction"
        text += f", {self.points} points, enforced by {self.enforcement}"
        if not FEEDS[self.enforcement]:
            text += f" with restitution {self.restitution:g}"
        text += f", {rub}, initial penetration {self.initial_penetration}"
        if self.removal_time:
            text += f" in {self.removal_time:g} {units.time}"
        return text + (f", adjust {self.adjust:g} {units.length}" if self.adjust else "")
