"""Balls on a block and on a plane, and two that strike each other obliquely."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import ball
import defaults
import hertz
import numpy as np
from libcontact.mesh import side_nodes

import libcontact as ct

from .runs import Numbers, updates

# -- Hertz -----------------------------------------------------------------------------------------


def pressed_sphere(elements: int) -> Numbers:
    """Relative errors of force, contact radius and approach with so many elements over the radius."""
    row = hertz.solve(elements)
    a, deep = hertz.exact(row["force"])
    modulus, depth = hertz.MODULUS, hertz.CONTACT**2 / hertz.RADIUS
    whole = 4.0 / 3.0 * modulus * math.sqrt(hertz.RADIUS) * depth**1.5
    return {
        "force": row["force"] / whole - 1,
        "radius": row["radius"] / a - 1,
        "approach": row["approach"] / deep - 1,
        "updates": 1e-6 * row["elements"] * row["steps"],
    }


def hertz_pressed() -> Numbers:
    """A rigid sphere on a block, two meshes."""
    return {f"{key}_{n}": value for n in (2, 3) for key, value in pressed_sphere(n).items()}


def quarter_ball(parts: int, layers: int, grading: float) -> tuple[Any, Any]:
    """Nodes and elements of the quarter x, y ≥ 0 of the unit ball, finest at the poles."""
    part = defaults.octant(parts, layers, grading=grading)
    turned = (part * [1, 1, -1])[:, np.roll(np.arange(8), 4)]
    return defaults.joined(np.concatenate([part, turned]))


def ball_on_plane(ratio: float, parts: int, layers: int, grading: float) -> Numbers:
    """The impact of a ball at which the radius of contact reaches ``ratio`` R: relative errors of duration, force and
    speed of the rebound."""
    nodes, elements = quarter_ball(parts, layers, grading)
    stiff, mass, depth = 1 / (1 - 0.3**2), 4 * math.pi / 3, ratio**2
    speed = math.sqrt(16 * stiff * depth**2.5 / (15 * mass))
    duration = defaults.DURATION * depth / speed
    made = ct.Scene(units={"length": "m", "mass": "kg", "time": "s"})
    made.add_material("elastic", young=1.0, poisson=0.3, density=1.0)
    made.add_body(
        "ball", material="elastic", nodes=nodes, elements=elements, velocity=[0, 0, -speed]
    )
    made.add_support("ball.x_min", fix="x").add_support("ball.y_min", fix="y")
    made.add(
        "obstacle", surface="ball.outer", plane={"point": [0, 0, -1], "normal": [0, 0, 1]}
    ).add_probe("wall", resultant="obstacle")
    run = made.set_time(end=1.2 * duration, fraction=0.9).set_output(every=10**9)
    result = run.run(progress=False)
    lasts, peak = defaults.impact(result, 2)
    p = result.momentum["p"][:, 2]
    return {
        "duration": lasts / duration - 1,
        "force": 4 * peak / (4 / 3 * stiff * depth**1.5) - 1,
        "rebound": -p[-1] / p[0] - 1,
        "updates": updates(result),
    }


BALLS = {"020": (0.2, 6, 4, 1.8), "010": (0.1, 6, 4, 1.8), "fine": (0.1, 8, 5, 2.0)}


def hertz_impact() -> Numbers:
    """A ball that strikes a plane, two speeds and two meshes."""
    found = {}
    for name, case in BALLS.items():
        found |= {f"{key}_{name}": value for key, value in ball_on_plane(*case).items()}
    return found


def hertz_small() -> Numbers:
    """The same with a/R = 0.04, minutes."""
    return ball_on_plane(0.04, 12, 6, 2.0)


# -- Oblique impact --------------------------------------------------------------------------------


OBLIQUE_FRICTION, OBLIQUE_POISSON = 0.3, 0.3
KAPPA = ball.stiffness_ratio(OBLIQUE_POISSON)


def nested_octant(parts: int, core: float) -> Any:
    """Corners of the octant x, y, z ≥ 0 of a ball of radius 2: a cube of the edge ``core`` with ``parts`` elements
    along an edge, and shells round it whose thickness grows with their radius."""
    lattice, rounding, blend = defaults.lattice, 1.4, max(parts // 2, 2)
    wide = 2 / (core * rounding)
    layers = max(blend + 1, math.ceil(math.log(wide) / math.log(1 + 0.25 * math.pi / parts * 1.25)))
    found = [core * lattice(parts, parts, parts)]
    for axis in range(3):
        place = np.roll(lattice(layers, parts, parts), axis, axis=2)
        layer = layers * place[..., axis : axis + 1]
        place[..., axis] = 1.0
        angle = np.tan(0.25 * np.pi * place)
        sphere = rounding * angle / np.linalg.norm(angle, axis=2, keepdims=True)
        share = np.minimum(layer / blend, 1.0)
        found.append(core * wide ** (layer / layers) * ((1 - share) * place + share * sphere))
    return np.concatenate(found)


def half_ball(parts: int, core: float) -> tuple[Any, Any, Any]:
    """Nodes, elements and contact faces of the half y ≥ 0 of the unit ball that touches the plane z = 0 at the origin
    from above, with cubes of the edge ``core / parts`` there. The inversion that turns a half-space into a ball keeps
    their angles; the upper half of the ball is a mirror image with a coarse core."""

    def inverted(corners: Any) -> Any:
        place = corners * [1, 1, -1] - [0, 0, 2]
        return [0, 0, 2] + 4 * place / (place**2).sum(-1, keepdims=True)

    upper = inverted(nested_octant(parts, 0.5)) * [1, 1, -1] + [0, 0, 2]
    both = np.concatenate([inverted(nested_octant(parts, core)), upper[:, np.roll(range(8), 4)]])
    both = np.concatenate([both, (both * [-1, 1, 1])[:, [1, 0, 3, 2, 5, 4, 7, 6]]])
    nodes, elements = defaults.joined(both)
    nodes[np.abs(nodes) < 1e-9] = 0.0
    outside = np.abs(np.linalg.norm(nodes - [0, 0, 1], axis=1) - 1) < 1e-9
    near = outside & (np.linalg.norm(nodes, axis=1) < 1.25 * core)
    return nodes, elements, np.argwhere(near[elements[:, side_nodes("hex8")]].all(axis=2))


@cache
def half_spaces(angle: float) -> dict[str, Any]:
    """Maw, Barber and Fawcett's theory."""
    return ball.strike(angle, OBLIQUE_POISSON)


def oblique(
    ratio: float, angle: float = 1.0, over: int = 3, tangent: float | None = 1.0
) -> Numbers:
    """Two equal balls that strike each other at ψ₁ = ``angle`` so fast that the radius of contact reaches ``ratio`` R,
    over which there are ``over`` elements: tangential impulse over that of the theory."""
    parts = round(1.4 * over)
    nodes, elements, faces = half_ball(parts, parts / over * ratio)
    mass, depth = 4 * math.pi / 3, ratio**2
    speed = math.sqrt(16 * depth**2.5 / (15 * mass * (1 - OBLIQUE_POISSON**2)))
    along, gap = angle * OBLIQUE_FRICTION * speed / KAPPA, [0, 0, 0.002 * depth]
    made = ct.Scene(units={"length": "m", "mass": "kg", "time": "s"})
    made.add_material("elastic", young=1.0, poisson=OBLIQUE_POISSON, density=1.0)
    for name, side in (("above", 1), ("below", -1)):
        made.add_body(
            name,
            material="elastic",
            nodes=(nodes + gap) * [side, 1, side],
            elements=elements,
            sets={"patch": {"faces": faces}},
            velocity=[side * along, 0, -side * speed],
        ).add_support(f"{name}.y_min", fix="y")
    keys = {} if tangent is None else {"tangent": tangent}
    made.add_contact("above.patch", "below.patch", friction=OBLIQUE_FRICTION, **keys)
    made.set_time(end=1.15 * defaults.DURATION * depth / speed, fraction=0.9)
    run = made.set_output(every=10**9).run(progress=False)
    p = run.body_momentum("above")["p"]
    impulse = p[-1] - p[0]
    return {
        "impulse": -impulse[0] / (OBLIQUE_FRICTION * impulse[2]) / half_spaces(angle)["impulse"],
        "rebound": -p[-1, 2] / p[0, 2] - 1,
        "updates": updates(run),
    }


def oblique_of(cases: dict[str, tuple[Any, ...]]) -> Numbers:
    """The numbers of some impacts, by name."""
    found = {}
    for name, case in cases.items():
        found |= {f"{key}_{name}": value for key, value in oblique(*case).items()}
    return found


def oblique_impact() -> Numbers:
    """Maw, Barber and Fawcett's curve at three angles, and two balls at a/R = 0.1."""
    curve = {f"exact_{10 * a:.0f}": half_spaces(a)["impulse"] for a in (1.0, 2.5, 6.0)}
    return curve | oblique_of({"100": (0.1,)})


OBLIQUE_CASES = {f"{1000 * ratio:.0f}": (1.0, ratio) for ratio in (0.1, 0.065, 0.04, 0.026, 0.013)}
OBLIQUE_CASES["angle"] = (2.5, 0.026)


def balls_theory() -> Numbers:
    """The theory of balls of finite size over that of half-spaces: tangential impulses; duration and largest force less
    one; and what a ball yields more under a pressure and a shear."""
    found = {}
    for name, (angle, ratio) in OBLIQUE_CASES.items():
        of = ball.strike(angle, OBLIQUE_POISSON, ratio)
        found[f"impulse_{name}"] = of["impulse"] / half_spaces(angle)["impulse"]
        if name in ("100", "40"):
            found |= {f"{key}_{name}": of[key] - 1 for key in ("duration", "force")}
    found["normal"], found["shear"] = ball.excess(0.026, OBLIQUE_POISSON)
    return found


def oblique_small() -> Numbers:
    """Smaller contacts, another angle, a finer mesh and the default spring, minutes."""
    sizes = {f"{1000 * ratio:.0f}": (ratio,) for ratio in (0.065, 0.04, 0.026, 0.013)}
    other = {"angle": (0.026, 2.5), "fine": (0.026, 1.0, 4), "soft": (0.026, 1.0, 3, None)}
    other["100_fine"] = (0.1, 1.0, 5)
    return oblique_of(sizes | other)
