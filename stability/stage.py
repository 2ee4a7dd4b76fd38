"""A scene of the zoo as data: bodies, obstacles and contacts that can be turned, mirrored, renamed, put in
another order, or replaced by each other before the library sees them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import shapes
from lab import scene
from libcontact.parts import LARGE_FRACTION

import libcontact as ct

# A face of each name and the other one of its axis.
FACES = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max")
# The nodes of a brick after a mirror along its first axis.
MIRRORED = np.array([1, 0, 3, 2, 5, 4, 7, 6])
MIRRORED20 = np.array([1, 0, 3, 2, 5, 4, 7, 6, 8, 11, 10, 9, 12, 15, 14, 13, 17, 16, 19, 18])


@dataclass(frozen=True)
class Stuff:
    """An elastic material."""

    young: float = 1e4
    poisson: float = 0.3
    density: float = 1.0
    law: str = "linear"

    @property
    def speed(self) -> float:
        """The speed of pressure waves."""
        nu = self.poisson
        return float(np.sqrt(self.young * (1 - nu) / ((1 + nu) * (1 - 2 * nu) * self.density)))


@dataclass(frozen=True)
class Part:
    """A body; ``held`` names faces and components ("z_min", "xyz")."""

    bricks: shapes.Bricks
    velocity: tuple[float, ...] = (0.0, 0.0, 0.0)
    stuff: Stuff = Stuff()
    integration: str = "full"
    held: tuple[tuple[str, str], ...] = ()
    drive: tuple[float, ...] | None = None  # velocity of the held faces

    @property
    def h(self) -> float:
        """The shortest edge between corners."""
        nodes, elements = self.bricks
        ends = nodes[elements[:, shapes.EDGES]]
        return float(np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=2).min())


@dataclass(frozen=True)
class Wall:
    """A rigid obstacle: a plane (point, normal), a sphere or a cylinder (point, axis, radius)."""

    body: str
    face: str
    shape: str
    point: tuple[float, ...]
    axis: tuple[float, ...] = (0.0, 0.0, 1.0)
    radius: float = 0.0
    velocity: tuple[float, ...] = (0.0, 0.0, 0.0)

    def keys(self) -> dict[str, Any]:
        own: dict[str, Any] = {"point" if self.shape == "plane" else "centre": list(self.point)}
        if self.shape == "plane":
            own["normal"] = list(self.axis)
        else:
            own["radius"] = self.radius
        if self.shape == "cylinder":
            own["axis"] = list(self.axis)
        moving = {"velocity": list(self.velocity)} if any(self.velocity) else {}
        return {"surface": f"{self.body}.{self.face}", self.shape: own, **moving}

    def depth(self, x: np.ndarray, time: float) -> float:
        """Depth of the deepest of these points."""
        r = x - np.array(self.point) - time * np.array(self.velocity)
        axis = np.array(self.axis) / np.linalg.norm(self.axis)
        if self.shape == "plane":
            return float(-(r @ axis).min())
        if self.shape == "cylinder":
            r = r - np.outer(r @ axis, axis)
        return float(self.radius - np.linalg.norm(r, axis=1).min())


@dataclass(frozen=True)
class Touch:
    """A contact of two faces."""

    one: tuple[str, str]
    two: tuple[str, str]


@dataclass(frozen=True)
class Stage:
    """All parts of a scene. ``law`` has the keys of contacts and obstacles, ``only`` those that contacts
    alone have; ``time`` those of [time]."""

    parts: dict[str, Part]
    walls: tuple[Wall, ...] = ()
    touches: tuple[Touch, ...] = ()
    gravity: tuple[float, ...] | None = None
    law: dict[str, Any] = field(default_factory=dict)
    only: dict[str, Any] = field(default_factory=dict)
    time: dict[str, Any] = field(default_factory=dict)

    @property
    def h(self) -> float:
        return min(part.h for part in self.parts.values())

    @property
    def fraction(self) -> float:
        """The fraction of the stable step, by default that of the library."""
        is_large = any(part.stuff.law != "linear" for part in self.parts.values())
        return float(self.time.get("fraction", LARGE_FRACTION if is_large else 0.9))

    @property
    def layer(self) -> float:
        """The longest period in which a layer of elements vibrates that is held on one side."""
        return max(4 * part.h / part.stuff.speed for part in self.parts.values())

    def scene(self, title: str) -> ct.Scene:
        made = scene(title)
        stuffs = {part.stuff for part in self.parts.values()}
        names = {stuff: f"m{i}" for i, stuff in enumerate(sorted(stuffs, key=repr))}
        for stuff, name in names.items():
            made.add_material(name, **stuff.__dict__)
        for name, part in self.parts.items():
            self.add(made, name, part, names[part.stuff])
        for touch in self.touches:
            made.add_contact(".".join(touch.one), ".".join(touch.two), **self.law, **self.only)
        for wall in self.walls:
            made.add("obstacle", **wall.keys(), **self.law)
        if self.gravity is not None:
            made.add("gravity", acceleration=list(self.gravity))
        return made.set_time(**self.time)

    def add(self, made: ct.Scene, name: str, part: Part, material: str) -> None:
        nodes, elements = part.bricks
        made.add_body(
            name,
            nodes=nodes,
            elements=elements,
            element="hex8" if elements.shape[1] == 8 else "hex20",
            material=material,
            velocity=list(part.velocity),
            **({} if part.integration == "full" else {"integration": part.integration}),
        )
        for face, fix in part.held:
            drive = {} if part.drive is None else {"velocity": list(part.drive)}
            made.add_support(f"{name}.{face}", fix=fix, **drive)


# Symmetries. Each returns another stage with the same physics.


def turned(stage: Stage, R: np.ndarray) -> Stage:
    """Turn by a rotation; faces with a name need one that maps axes to axes."""
    return _mapped(stage, R, lambda bricks: shapes.turned(bricks, R))


def mirrored(stage: Stage) -> Stage:
    """Mirror at x = 0."""
    R = np.diag([-1.0, 1.0, 1.0])

    def mirror(bricks: shapes.Bricks) -> shapes.Bricks:
        nodes, elements = bricks
        order = MIRRORED if elements.shape[1] == 8 else MIRRORED20
        return nodes * np.diag(R), elements[:, order]

    return _mapped(stage, R, mirror)


def renamed(stage: Stage) -> Stage:
    """Other names, which sort the other way."""
    names = {name: f"{'zyxwvutsrq'[i]}_{name}" for i, name in enumerate(sorted(stage.parts))}
    return _named(stage, names, list(stage.parts))


def reordered(stage: Stage) -> Stage:
    """Bodies, contacts and obstacles in the opposite order."""
    back = _named(stage, {name: name for name in stage.parts}, list(stage.parts)[::-1])
    return replace(back, walls=back.walls[::-1], touches=back.touches[::-1])


def swapped(stage: Stage) -> Stage:
    """The surfaces of each contact in the opposite order."""
    return replace(stage, touches=tuple(Touch(t.two, t.one) for t in stage.touches))


def outer(stage: Stage) -> Stage:
    """The whole skin in place of each named face that touches."""
    return replace(
        stage,
        walls=tuple(replace(wall, face="outer") for wall in stage.walls),
        touches=tuple(Touch((t.one[0], "outer"), (t.two[0], "outer")) for t in stage.touches),
    )


def _mapped(stage: Stage, R: np.ndarray, bricks: Any) -> Stage:
    def way(v: Any) -> tuple[float, ...]:
        return tuple(float(x) + 0.0 for x in R @ np.array(v))

    def face(name: str) -> str:
        if name == "outer":
            return name
        axis, side = "xyz".index(name[0]), 1 if name.endswith("max") else -1
        to = side * R[:, axis]
        k = int(np.abs(to).argmax())
        return FACES[2 * k + int(to[k] > 0)]

    def fix(letters: str) -> str:
        return "".join("xyz"[int(np.abs(R[:, "xyz".index(c)]).argmax())] for c in letters)

    return replace(
        stage,
        parts={
            name: replace(
                part,
                bricks=bricks(part.bricks),
                velocity=way(part.velocity),
                held=tuple((face(f), fix(c)) for f, c in part.held),
                drive=None if part.drive is None else way(part.drive),
            )
            for name, part in stage.parts.items()
        },
        walls=tuple(
            replace(
                wall,
                face=face(wall.face),
                point=way(wall.point),
                axis=way(wall.axis),
                velocity=way(wall.velocity),
            )
            for wall in stage.walls
        ),
        touches=tuple(
            Touch((t.one[0], face(t.one[1])), (t.two[0], face(t.two[1]))) for t in stage.touches
        ),
        gravity=None if stage.gravity is None else way(stage.gravity),
    )


def _named(stage: Stage, names: dict[str, str], order: list[str]) -> Stage:
    def called(face: tuple[str, str]) -> tuple[str, str]:
        return names[face[0]], face[1]

    return replace(
        stage,
        parts={names[name]: stage.parts[name] for name in order},
        walls=tuple(replace(wall, body=names[wall.body]) for wall in stage.walls),
        touches=tuple(Touch(called(t.one), called(t.two)) for t in stage.touches),
    )


# An obstacle as a held body.


def held_bodies(stage: Stage) -> Stage:
    """Replace each obstacle by a body of the same shape whose nodes are all held, or that its supports
    move. The body has the edges of the one that it meets."""
    parts, touches = dict(stage.parts), list(stage.touches)
    made: dict[tuple[Any, ...], str] = {}
    for wall in stage.walls:
        key = (wall.shape, wall.point, wall.axis, wall.radius, wall.velocity)
        if key not in made:
            made[key] = f"held{len(made)}"
            own = parts[wall.body]
            parts[made[key]] = Part(
                _shaped(wall, own),
                velocity=wall.velocity,
                stuff=own.stuff,
                held=(("outer", "xyz"),),
                drive=wall.velocity if any(wall.velocity) else None,
            )
        touches.append(Touch((wall.body, wall.face), (made[key], "outer")))
    return replace(stage, parts=parts, walls=(), touches=tuple(touches))


def _shaped(wall: Wall, own: Part) -> shapes.Bricks:
    """The mesh of an obstacle near a body."""
    nodes = own.bricks[0]
    centre, size = nodes.mean(0), float(np.ptp(nodes, axis=0).max())
    axis = np.array(wall.axis) / np.linalg.norm(wall.axis)
    point = np.array(wall.point)
    frame = _frame(axis)
    if wall.shape == "plane":
        count = max(3, round(3 * size / max(own.h, size / 8)))
        bricks = shapes.box((3 * size, 3 * size, 0.5 * size), (count, count, 1))
        middle = centre - ((centre - point) @ axis) * axis - 0.25 * size * axis
    elif wall.shape == "sphere":
        cube = shapes.box((2, 2, 2), (6, 6, 6))
        x = np.tan(cube[0] * np.pi / 4)
        bricks = wall.radius * shapes.rounded(x, 0.97), cube[1]
        middle = point
    else:
        width = 1.5 * size
        around = 32
        thick = 0.5 * wall.radius
        nodes, elements = shapes.ring(wall.radius - 0.5 * thick, thick, (around, 2, 1), width)
        nodes = nodes - [0, 0.5 * width, 0]
        bricks = nodes[:, [0, 2, 1]] * [1, -1, 1], elements  # the axis along z
        middle = point + ((centre - point) @ axis) * axis
    return bricks[0] @ frame.T + middle, bricks[1]


def _frame(axis: np.ndarray) -> np.ndarray:
    """A rotation whose third column is the axis."""
    other = np.eye(3)[int(np.abs(axis).argmin())]
    first = np.cross(other, axis)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(axis, first), axis], 1)
