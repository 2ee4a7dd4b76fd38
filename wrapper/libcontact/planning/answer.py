"""The error of a run from a closed form if the scene has one, and functionals, numbers of a run that
the user names."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import exact
from ..bridge import Floats
from ..model import AXES, speeds
from ..run import Run
from ..schema import Place, suggestion
from ..state import STRESS
from ..tables import ENERGY, IN_ENERGY, MOMENTUM

if TYPE_CHECKING:
    from ..problem import Problem

# Fig. 4's line ends at the distance d from the impact, or where it contains the front: this many times as far
# as the front.
BEYOND = 1.25
# Effects that do not change the limit to which a scene converges.
NUMERICAL = ("viscosity",)


@dataclass(frozen=True)
class Plates:
    """
    The impact of two thick plates in plane strain, or of one on a wall, whose stress has a closed form
    (chapter :doc:`/theory/exact`).

    Attributes
    ----------
    bodies : tuple of str
        Names of the plates.
    axes : tuple of int
        The axes of the impact, of the thickness in plane strain, and to the free faces.
    plane, middle : float
        Positions of the contact plane and of the plane of symmetry between the free faces [length].
    d, length : float
        Half the distance of the free faces, and the length of a plate [length].
    speed : float
        Half the speed of approach [length / time].
    """

    bodies: tuple[str, ...]
    axes: tuple[int, int, int]
    plane: float
    middle: float
    d: float
    length: float
    speed: float

    words = "against the closed form: L1 on Fig. 4's line over the plateau"

    def error(self, problem: Problem, run: Run) -> float:
        """The error L1 on Fig. 4's line over the plateau, :eq:`accuracy-errors`, from a run with the stress in
        its last state. It averages over the elements next to the plane of symmetry, up to the distance d from
        the impact or, if that is farther, beyond the front."""
        assert run.state is not None
        material = problem.bodies[self.bodies[0]].material
        nu, c1 = material.poisson, speeds(material)[0]
        unit = material.density * c1 * self.speed * nu / (1.0 - nu)
        t, length = run.state.time * c1 / self.d, self.length / self.d
        extent, found = min(max(1.0, BEYOND * t), length, 2.0 * length - t), []
        for name in self.bodies:
            body = run.state[name]
            x = abs(body.centres[:, self.axes[0]] - self.plane) / self.d
            z = abs(body.centres[:, self.axes[2]] - self.middle) / self.d
            row = (z < 1.5 * z.min() + 1e-9) & (x < extent)
            right = exact.plates(x[row], z[row], t, nu, length).stress.sigma_x
            found.append(np.abs(body.stress[row, self.axes[0]] / unit - right).mean())
        return float(np.mean(found)) * extent * nu / (1.0 - nu)


def plates(problem: Problem) -> Plates | None:
    """The impact of two thick plates, recognised by its geometry; None if the scene is a different one, or
    lasts until the front has left a plate or the closed form is no longer valid."""
    parts, bodies = problem.parts, list(problem.parts.body)
    held = {(str(each.set[0]), each.set[1]) for each in parts.support}
    pure = all(
        list(each.fix) == [each.set[1][0]] and each.history is None and not any(each.velocity)
        for each in parts.support
    )
    other = any(effect.name not in NUMERICAL for effect in parts.effects) or problem.own
    plain = all(body.box and not body.spin and not body.place for body in bodies)
    if other or not pure or not plain:
        return None
    made = [parts.materials[body.material] for body in bodies]
    if len({(each.young, each.poisson, each.density, each.law) for each in made}) > 1:
        return None
    sides = [[_sides(held, body.name, axis) for axis in range(3)] for body in bodies]
    thick = [k for k in range(3) if all(len(side[k]) == 2 for side in sides)]
    met = _impact(parts, held)
    if len(thick) != 1 or met is None or met[0] in thick:
        return None
    impact, plane, speed = met
    free = 3 - impact - thick[0]
    first = bodies[0]
    low, size = first.box.origin[free], first.box.size[free]
    same = all(
        abs(body.box.origin[free] - low) + abs(body.box.size[free] - size) < 1e-9 * size
        for body in bodies
    )
    ends = [side[free] for side in sides]
    if not same or len(ends[0]) == 2 or any(end != ends[0] for end in ends):
        return None
    d = size if ends[0] else 0.5 * size
    middle = low + {"": 0.5, "min": 0.0, "max": 1.0}["".join(ends[0])] * size
    length = min(body.box.size[impact] for body in bodies)
    material = parts.materials[first.material]
    way = speeds(material)[0] * problem.end
    known = material.law == "linear" and 0.0 < material.poisson <= 0.49
    if not (known and speed > 0.0 and way < min(1.99 * d, length)):
        return None
    names = tuple(body.name for body in bodies)
    return Plates(names, (impact, thick[0], free), plane, middle, d, length, speed)


def _sides(held: set[tuple[str, str]], body: str, axis: int) -> tuple[str, ...]:
    """The fixed ones among the two faces normal to an axis."""
    return tuple(end for end in ("min", "max") if (body, f"{AXES[axis]}_{end}") in held)


def _impact(parts: Any, held: set[tuple[str, str]]) -> tuple[int, float, float] | None:
    """The axis of the impact, the contact plane, and half the speed of approach; None unless two
    touching faces collide."""
    bodies = list(parts.body)
    if len(bodies) == 1 and not parts.contact:
        (body,) = bodies
        moving = [k for k in range(3) if body.velocity[k]]
        ends = _sides(held, body.name, moving[0]) if len(moving) == 1 else ()
        if len(ends) != 1:
            return None
        k, v = moving[0], body.velocity[moving[0]]
        high = ends == ("max",)
        return k, body.box.origin[k] + high * body.box.size[k], v if high else -v
    if len(bodies) != 2 or len(parts.contact) != 1 or parts.contact[0].friction:
        return None
    faces = sorted(parts.contact[0].surfaces, key=lambda face: str(face[1]))
    (upper, top), (lower, bottom) = faces  # x_max of one body, x_min of the other
    k = AXES.index(top[0])
    one, two = parts.bodies[upper], parts.bodies[lower]
    plane, other = one.box.origin[k] + one.box.size[k], two.box.origin[k]
    fits = top == f"{AXES[k]}_max" and bottom == f"{AXES[k]}_min" and upper != lower
    along = all(v == 0.0 for b in bodies for i, v in enumerate(b.velocity) if i != k)
    if not (fits and along) or abs(plane - other) > 1e-9 * one.box.size[k]:
        return None
    if any(_sides(held, body.name, k) for body in bodies):
        return None
    return k, plane, 0.5 * (one.velocity[k] - two.velocity[k])


# Functionals.


def _mean(time: Floats, values: Floats) -> float:
    return float((np.diff(time) * 0.5 * (values[1:] + values[:-1])).sum() / (time[-1] - time[0]))


HOW: dict[str, Any] = {
    "end": lambda time, values: values[-1],
    "max": lambda time, values: values.max(),
    "min": lambda time, values: values.min(),
    "mean": _mean,
}


@dataclass(frozen=True)
class Functional:
    """
    A number of a run: ``TABLE.COLUMN.HOW``.

    TABLE is a probe (``"wall.force_x.max"``), a body with its momentum (``"bar.p_x.end"``), or
    ``energy`` (``"energy.kinetic.end"``). HOW is ``end``, ``max``, ``min``, or the ``mean`` over time.
    Probes have a row per step, the other tables a row per record.
    """

    name: str
    table: str
    column: str
    part: int | None
    how: str

    def __str__(self) -> str:
        return self.name

    def value(self, run: Run) -> float:
        """The number of a run, in the units of the scene."""
        if self.table in run.probes:
            rows = run.probes[self.table]
        else:
            rows = run.energy if self.table == "energy" else run.body_momentum(self.table)
        values = rows[self.column] if self.part is None else rows[self.column][:, self.part]
        return float(HOW[self.how](rows["time"], values))


def functional(problem: Problem, text: str) -> Functional:
    """The functional of a name, see :class:`Functional`; a SceneError if the scene has no such probe, body or
    quantity."""
    known = {name: (table, column, part) for name, table, column, part in columns(problem)}
    column, _, how = text.rpartition(".")
    at = Place("functional", problem.file)
    if how not in HOW:
        raise at.error(
            f'"{text}" does not end in .{", .".join(HOW)}, as in "{next(iter(known))}.end"'
        )
    if column not in known:
        raise at.error(f'the scene has no "{column}"{suggestion(column, known)}')
    return Functional(text, *known[column], how)


def columns(problem: Problem) -> Iterator[tuple[str, str, str, int | None]]:
    """The columns from which functionals can be formed: name, such as ``"wall.force_x"``, table, column, and
    component or None."""
    for probe in problem.parts.probe:
        for name in probe.taken:
            words = STRESS if name == "stress" else "" if name == "pressure" else AXES
            for i, word in enumerate(words):
                yield f"{probe.name}.{name}_{word}", probe.name, name, i
            if not words:
                yield f"{probe.name}.{name}", probe.name, name, None
    for body in problem.bodies:
        for name in MOMENTUM.names or ():
            for i, word in enumerate(AXES) if name not in ("time", "body") else ():
                yield f"{body}.{name}_{word}", body, name, i
    effects = [name for name in dict.fromkeys(problem.effects) if name not in IN_ENERGY]
    for name in (*(ENERGY.names or ()), *effects):
        if name != "time":
            yield f"energy.{name}", "energy", name, None
