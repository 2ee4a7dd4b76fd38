"""
The benchmarks of the book: each function computes the numbers of one page from the scene beside it and returns them
with their references. ``docs/measure.py`` writes them to ``docs/measured.json``; ``tests/python/test_benchmarks.py``
compares them.
"""

from __future__ import annotations

import math
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import libcontact as ct

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "bench"))
import hertz  # noqa: E402 (a rigid sphere on a block)

sys.path.insert(0, str(HERE.parents[1] / "accuracy"))
import defaults  # noqa: E402 (an elastic ball on a plane)

sys.path.insert(0, str(HERE))
import ball  # noqa: E402 (theory of balls that strike each other)

sys.path.insert(0, str(HERE.parent / "figures"))
import rigid  # noqa: E402 (Euler's equations)

Numbers = dict[str, float]


def load(name: str) -> dict[str, Any]:
    """The tables of a scene of this folder or of the tutorials."""
    own = HERE / f"{name}.toml"
    path = own if own.exists() else ct.example(name)
    return tomllib.loads(path.read_text(encoding="utf-8"))


def done(data: dict[str, Any]) -> ct.Run:
    """The run of a scene, without output."""
    return ct.Scene(data).run(progress=False, output=False)


def finer(name: str, factor: float) -> dict[str, Any]:
    """A scene of boxes with one element across, with ``factor`` times as many elements along each one, cubes in the
    first body."""
    data = load(name)
    for body in data["body"]:
        box, first = body["box"], data["body"][0]["box"]
        box["cells"] = [round(box["cells"][0] * factor), 1, 1]
        box["size"] = [box["size"][0], *[first["size"][0] / first["cells"][0]] * 2]
    return data


def updates(run: ct.Run) -> float:
    """What a run costs: millions of element updates."""
    elements = sum(len(run.state[name].elements) for name in run.bodies)
    return 1e-6 * elements * int(run.steps[-1])


def contact_of(run: ct.Run, probe: str, axis: int) -> tuple[float, float, float]:
    """Begin and end of a contact, and the median of its force."""
    rows = run.probes[probe]
    force = np.abs(rows["force"][:, axis])
    plateau = float(np.median(force[force > 0]))
    times = rows["time"][force > 0.05 * plateau]
    return float(times[0]), float(times[-1]), plateau


# -- Rods ------------------------------------------------------------------------------------------


def rods(name: str, cells: int) -> Numbers:
    """Two rods, the left one of ``cells`` elements: pressure, duration of the contact and coefficient of
    restitution."""
    data = finer(name, cells / 100)
    run = done(data)
    begin, end, force = contact_of(run, "contact", 0)
    area, mass, after = data["body"][0]["box"]["size"][1] ** 2, [], []
    for body, material in zip(data["body"], data["material"]):
        mass.append(material["density"] * math.prod(body["box"]["size"]))
        after.append(run.body_momentum(body["name"])["p"][-1, 0] / mass[-1])
    before = [body["velocity"][0] for body in data["body"]]
    restitution = (after[1] - after[0]) / (before[0] - before[1])
    return {
        "pressure": force / area,
        "duration": end - begin,
        "restitution": restitution,
        "updates": updates(run),
    }


def rods_of(name: str, exact: Numbers) -> Numbers:
    """Relative errors on three meshes."""
    found = {}
    for cells in (25, 50, 100):
        computed = rods(name, cells)
        found |= {f"{key}_{cells}": computed[key] / exact[key] - 1 for key in exact}
    return found | {"updates": computed["updates"]}


RODS: dict[str, Numbers] = {
    "rods_equal": {"pressure": 0.1, "duration": 20.0, "restitution": 1.0},
    "rods_unequal": {"pressure": 0.1 * 2 / 3, "duration": 20.0, "restitution": 1.0},
    "rods_saint_venant": {"pressure": 0.05, "duration": 20.0, "restitution": 0.5},
}


# -- Rod and beam at a wall ------------------------------------------------------------------------

ROD_MODULUS, ROD_DENSITY, ROD_SPEED, ROD_LENGTH, ROD_GAP = 3e7, 0.73e-3, 202.2, 10.0, 0.01


def rod_exact() -> Numbers:
    """Begin and end of the contact [µs], force [lbf] and speed of the rebound [in/s]."""
    c = math.sqrt(ROD_MODULUS / ROD_DENSITY)
    begin = ROD_GAP / ROD_SPEED
    force = ROD_DENSITY * c * ROD_SPEED
    end = begin + 2 * ROD_LENGTH / c
    return {"begin": 1e6 * begin, "end": 1e6 * end, "force": force, "rebound": ROD_SPEED}


def rod(cells: int) -> Numbers:
    """The rod of VM265 with ``cells`` elements, as ``rod_exact``."""
    data = finer("rod_at_wall", cells / 100)
    run = done(data)
    area = data["body"][0]["box"]["size"][1] ** 2
    begin, end, force = contact_of(run, "wall", 0)
    momentum = run.momentum["p"][-1, 0] / (ROD_DENSITY * ROD_LENGTH * area)
    return {"begin": 1e6 * begin, "end": 1e6 * end, "force": force / area, "rebound": momentum}


def beam(across: int) -> Numbers:
    """The quarter of SDNV100's beam with ``across`` elements over half its width: median force, duration and rebound
    over those of a rod."""
    data = load("beam_at_wall")
    data["body"][0]["box"]["cells"] = [across, across, 20 * across]
    run = done(data)
    begin, end, force = contact_of(run, "wall", 2)
    p = run.momentum["p"][:, 2]
    return {
        "force": force / (1e-4 * 8000 * 5000 * 100) - 1,
        "duration": (end - begin) / (2 * 0.2 / 5000) - 1,
        "rebound": -p[-1] / p[0] - 1,
        "updates": updates(run),
    }


def rod_at_wall() -> Numbers:
    """The closed form, the rod on two meshes, and the errors of the beam on two meshes."""
    found = {f"{key}_exact": value for key, value in rod_exact().items()}
    for cells in (20, 100):
        found |= {f"{key}_{cells}": value for key, value in rod(cells).items()}
    for across in (2, 4):
        last = beam(across)
        found |= {f"beam_{key}_{across}": last[key] for key in ("force", "duration", "rebound")}
    return found | {"updates": last["updates"]}


# -- Bouncing bar ----------------------------------------------------------------------------------


def bounces(cells: int) -> Numbers:
    """The bar under gravity with the default contact: begin of the second and of the tenth impact, and the change of
    energy over the energy of the fall."""
    data = load("bouncing_bar")
    wide = 10 / cells
    data["body"][0]["box"] |= {"size": [wide, wide, 10], "cells": [1, 1, cells]}
    del data["obstacle"][0]["beta"]
    data["probe"] = [{"name": "floor", "resultant": "obstacle"}]
    data["time"] = {"end": 25.5, "fraction": 0.9}
    run = done(data)
    rows = run.probes["floor"]
    on = rows["force"][:, 2] > 30 * wide**2  # a tenth of the pressure ρ c v of an impact
    off_before = np.flatnonzero(np.diff(on.astype(int)) == 1)
    begins = rows["time"][off_before + 1]
    # A gap of some steps in a contact begins no impact.
    begins = begins[np.diff(begins, prepend=-1.0) > 1.0]
    total = run.energy["total"]
    return {
        "second": begins[1],
        "tenth": begins[9],
        "energy": (total[-1] - total[0]) / (10 * 10 * wide**2 * 5),
        "updates": updates(run),
    }


def bouncing_bar() -> Numbers:
    """Two meshes."""
    found = {}
    for cells in (50, 100):
        last = bounces(cells)
        found |= {f"{key}_{cells}": last[key] for key in ("second", "tenth", "energy")}
    return found | {"updates": last["updates"]}


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
    points = np.concatenate([part, turned]).reshape(-1, 3)
    _, first, numbers = np.unique(points.round(9), axis=0, return_index=True, return_inverse=True)
    return points[first], numbers.reshape(-1, 8).astype(np.int32)


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
    points = both.reshape(-1, 3)
    _, first, numbers = np.unique(points.round(9), axis=0, return_index=True, return_inverse=True)
    nodes, elements = points[first], numbers.reshape(-1, 8).astype(np.int32)
    nodes[np.abs(nodes) < 1e-9] = 0.0
    outside = np.abs(np.linalg.norm(nodes - [0, 0, 1], axis=1) - 1) < 1e-9
    near = outside & (np.linalg.norm(nodes, axis=1) < 1.25 * core)
    return nodes, elements, np.argwhere(near[elements[:, defaults.SIDES]].all(axis=2))


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
    return oblique_of(sizes | other)


# -- Rotation --------------------------------------------------------------------------------------


def first_flip(t: Any, rate: Any) -> float:
    """When the rate about the middle axis passes zero for the first time."""
    i = int(np.flatnonzero(rate[:-1] * rate[1:] < 0)[0])
    return float(t[i] - rate[i] * (t[i + 1] - t[i]) / (rate[i + 1] - rate[i]))


def flip_of_euler(cells: Any = None) -> float:
    """By Euler's equations, with the inertia of the lumped masses (eq:lumped-inertia) or, without cells, of the solid
    box."""
    t = np.linspace(0, 40, 8001)
    factor = 1.0 if cells is None else 1 + 2 / np.array(cells) ** 2
    return first_flip(t, rigid.euler(rigid.inertia(factor), t))


def flip_of_box(k: int) -> tuple[float, float, float]:
    """First flip of a box of 3k × 2k × k bricks, computed and by Euler's equations with its lumped inertia; cost."""
    data = load("tumbling_box")
    cells = data["body"][0]["box"]["cells"] = [3 * k, 2 * k, k]
    run = done(data)
    t, rates = rigid.rates(run)
    return first_flip(t, rates[:, 1]), flip_of_euler(cells), updates(run)


def tumbling_box() -> Numbers:
    """The box on three meshes."""
    found = {"solid": flip_of_euler()}
    for k in (1, 2, 4):
        found[f"flip_{k}"], found[f"euler_{k}"], found["updates"] = flip_of_box(k)
    return found


# -- Friction --------------------------------------------------------------------------------------


def newmark(friction: float, push: float, gravity: float, time: float) -> float:
    """Displacement of Newmark's block under a rectangular pulse."""
    speed = push * time
    return speed**2 / (2 * friction * gravity) * (1 - friction * gravity / push)


def slide(young: float) -> tuple[float, float]:
    """Displacement of the block with this modulus, of which the ratio of damping is the scene's; cost."""
    data = load("sliding_block")
    data["material"][0]["young"] = young
    data["damping"]["stiffness"] = 1e-3 * math.sqrt(1e4 / young)
    run = done(data)
    return float(run.probes["block"]["displacement"][-1, 0]), updates(run)


def sliding_block() -> Numbers:
    """The closed form and three stiffnesses."""
    found = {"exact": newmark(0.3, 6.0, 10.0, 0.5)}
    for power in (4, 5, 6):
        found[f"e{power}"], found["updates"] = slide(10.0**power)
    return found


# -- A plate bent over a cylinder ------------------------------------------------------------------


def elastica(force: float, bending: float, radius: float, length: float) -> tuple[float, float]:
    """Angle of contact and depth of the end of an inextensible beam whose axis is wrapped round a circle and whose end
    carries a dead weight. Beyond the contact ½ B κ² = F (sin θ_end − sin θ), with κ = 1/radius at its begin."""
    x, weight = np.polynomial.legendre.leggauss(40)

    def beam_of(angle: float) -> tuple[float, float]:
        top = math.sin(angle) + bending / (2 * radius**2 * force)
        if top >= 1:
            return math.inf, math.inf
        last = math.asin(top)
        # θ = θ_end − u² removes the root from the integrand.
        half = 0.5 * math.sqrt(last - angle)
        u = half * (x + 1)
        theta = last - u**2
        ds = 2 * u * half * weight / np.sqrt(2 * force / bending * (top - np.sin(theta)))
        depth = radius * (1 - math.cos(angle)) + float((ds * np.sin(theta)).sum())
        return radius * angle + float(ds.sum()), depth

    low, high = 1e-6, 0.5 * math.pi
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if beam_of(middle)[0] < length else (low, middle)
    return math.degrees(low), beam_of(low)[1]


def plate_exact() -> tuple[float, float]:
    """Angle [degrees] and depth of the end's middle of the scene's plate."""
    thick = 0.1
    return elastica(1920 * thick, 1e6 * thick**3 / 12, 1 + thick / 2, 1.5)


def plate(element: str, along: int, layers: int) -> tuple[float, float, float]:
    """Angle of contact [degrees], of which the sine is horizontal over vertical force on the cylinder, depth of the
    end's middle, and cost."""
    data = load("bent_plate")
    body = data["body"][0]
    body["element"], body["box"]["cells"] = element, [along, 1, layers]
    run = done(data)
    force, state = run.probes["cylinder"]["force"][-1], run.state["plate"]
    end = state.positions[np.isclose(state.nodes[:, 0], 1.5)].mean(axis=0)
    angle = math.degrees(math.asin(abs(force[0] / force[2])))
    return angle, 0.05 - float(end[2]), updates(run)


PLATES = (("hex20", 8, 1), ("hex20", 15, 1), ("hex8", 30, 2), ("hex8", 60, 4))


def bent_plate() -> Numbers:
    """The elastica, two meshes of hex20 and two of hex8."""
    found = dict(zip(("angle", "depth"), plate_exact()))
    for element, along, layers in PLATES:
        name, values = f"{element}_{along}", plate(element, along, layers)
        found |= {f"{name}_{key}": value for key, value in zip(("angle", "depth", "cost"), values)}
    return found


# -- Other programs, unlike meshes -----------------------------------------------------------------


def settlement() -> Numbers:
    """MOOSE's case: largest strain energy and its time, largest force after the first impact, both at the end."""
    run = done(load("settlement"))
    strain, rows = run.energy["strain"], run.probes["force"]
    first = int(np.argmax(strain))
    return {
        "peak": strain[first],
        "peak_time": run.energy["time"][first],
        "force": rows["force"][rows["time"] > 0.003, 2].max(),
        "late_energy": strain[-1],
        "late_force": rows["force"][-1, 2],
        "updates": updates(run),
    }


def pulse_left(left: int, right: int) -> tuple[float, float]:
    """Largest velocity that a pulse leaves in the column that it came through, over the largest in the other one;
    cost."""
    data = load("unlike_pulse")
    for body, n in zip(data["body"], (left, right)):
        body["box"]["cells"] = [6 * n, n, n]
    run = done(data)
    left_over, through = (np.abs(run.state[name].velocity[:, 0]).max() for name in run.bodies)
    return float(left_over / through), updates(run)


def pulse_in_one(n: int) -> float:
    """The same in one column without a contact: what the mesh leaves behind."""
    data = load("unlike_pulse")
    del data["contact"]
    data["body"] = data["body"][:1]
    data["body"][0]["box"] = {"origin": [-6, 0, 0], "size": [12, 1, 1], "cells": [12 * n, n, n]}
    column = done(data).state["left"]
    moves, x = np.abs(column.velocity[:, 0]), column.nodes[:, 0]
    return float(moves[x < 0].max() / moves[x > 0].max())


PAIRS = ((4, 4), (4, 6), (8, 8), (8, 11))


def unlike_pulse() -> Numbers:
    """One column, like and unlike meshes."""
    found = {f"one_{n}": pulse_in_one(n) for n in (4, 8)}
    for n, m in PAIRS:
        found[f"left_{n}_{m}"], found["updates"] = pulse_left(n, m)
    return found


# -- Rings, shells and discs -----------------------------------------------------------------------


def crushed_exact(height: float) -> float:
    """Force F r²/B on an inextensible ring of radius r = 1 whose axis is ``height`` high between two plates. From the
    top on the slope obeys θ'' = a cos θ with a = F/2B, so θ'² = κ² + 2 a sin θ; the curvature κ at the top is 0 from
    the height on at which the ring begins to lie flat."""
    x, weight = np.polynomial.legendre.leggauss(60)
    u = 0.5 * (x + 1)
    sine, dtheta = np.sin(0.5 * math.pi * u**2), 0.5 * math.pi * u * weight  # θ = π u²/2

    def integrals(m: float) -> tuple[float, float]:
        """Length and height of a quarter times √(2a), for κ² = 2 a m."""
        root = np.sqrt(m + sine)
        return float((dtheta / root).sum()), float((dtheta * sine / root).sum())

    low, high = 0.0, 1e6
    for _ in range(200):  # more curvature at the top, less load, a higher ring
        m = 0.5 * (low + high)
        length, rise = integrals(m)
        low, high = (m, high) if math.pi * rise / length < height else (low, m)
    length, rise = integrals(low)
    return (2 * rise / height) ** 2 if low < 1e-12 else (2 * length / math.pi) ** 2


def crushed(travel: float, around: int) -> tuple[float, float]:
    """Force F r²/B when each plate has moved by ``travel``, and cost."""
    data = load("crushed_ring")
    data["body"][0]["ring"]["cells"][1] = around
    for obstacle in data["obstacle"]:
        obstacle["travel"][1] *= travel / 0.4
    run = done(data)
    return abs(run.probes["plate"]["force"][-1, 1]) * 12 / (1e6 * 0.1**4), updates(run)


def crushed_ring() -> Numbers:
    """Two depths in closed form; relative errors of the force on three meshes."""
    found = {"exact_2": crushed_exact(1.6), "exact_4": crushed_exact(1.2)}
    for around in (24, 40, 48):
        for name, travel in (("2", 0.2), ("4", 0.4)):
            force, cost = crushed(travel, around)
            found[f"force_{name}_{around}"] = force / found[f"exact_{name}"] - 1
        found[f"cost_{around}"] = cost
    return found


# -- Rings in impact -------------------------------------------------------------------------------

RING_THICKNESS = 0.1  # over the radius of its axis


def ring_modes(count: int, shear: float) -> tuple[Any, Any]:
    """Frequencies and radial amplitudes at the point of contact, of unit modal mass, of the plane vibrations of a
    Timoshenko ring (E = ρ = r = 1, ν = 0, width 1) with up to ``count`` waves around."""
    h, found = RING_THICKNESS, []
    for n in range(count + 1):
        # Of the radial, tangential and angular amplitudes: stretch of the axis, shear and change of curvature.
        rows = np.array([[1, n, 0], [-n, -1, 1], [0, 0, n]]) * [[1], [n > 0], [1]]
        stiffness = rows.T @ np.diag([h, 0.5 * shear * h, h**3 / 12]) @ rows
        root = np.sqrt((math.pi if n else 2 * math.pi) * np.array([h, h, h**3 / 12]))
        square, modes = np.linalg.eigh(
            stiffness * (math.pi if n else 2 * math.pi) / np.outer(root, root)
        )
        omega = np.sqrt(np.maximum(square, 0.0))
        omega[0] *= n != 1  # the ring moves as a rigid body
        found += [(w, a) for w, a in zip(omega, modes[0] / root[0]) if n or abs(a) * root[0] > 0.5]
    return tuple(np.array(found).T)


def rings_exact(count: int, dt: float, shear: float = 5 / 6) -> tuple[Any, Any]:
    """Time and velocity of the centre of a ring that comes with 1 and meets a rigid plane at one point. In each step
    the force is constant; it is 0 or such that the point ends the step at the plane."""
    omega, a = ring_modes(count, shear)
    rigid, some = omega == 0, np.where(omega == 0, 1.0, omega)
    cosine, sine = np.cos(omega * dt), np.where(rigid, dt, np.sin(omega * dt) / some)
    shift = np.where(rigid, 0.5 * dt**2, (1 - cosine) / some**2) * a
    q, v = np.zeros_like(a), rigid / a
    time = dt * np.arange(int(RINGS_END / dt))
    speed = np.empty(len(time))
    for i in range(len(time)):
        speed[i] = v[rigid][0] * a[rigid][0]
        q, v = cosine * q + sine * v, cosine * v - omega**2 * sine * q
        force = max(0.0, a @ q / (a @ shift))
        q, v = q - shift * force, v - sine * a * force
    return time, speed


RINGS_END = 80.0


def rings(element: str, layers: int, around: int) -> tuple[Any, Any, float]:
    """Two rings: time and velocity of the centre of the left one over that of the impact, and the cost."""
    data = load("rings")
    for body in data["body"]:
        body |= {"element": element}
        body["ring"] |= {"cells": [layers, around, 1], "width": 2 * math.pi / around}
    run = done(data)
    p = run.body_momentum("left")
    return p["time"], p["p"][:, 0] / p["p"][0, 0], updates(run)


RINGS = {"48": ("hex20", 1, 48), "96": ("hex20", 1, 96), "hex8": ("hex8", 4, 192)}


def rings_in_impact() -> Numbers:
    """Restitution by modes and by three meshes, and the mean difference of the velocity from that of the modes."""
    found = {}
    for count in (40, 80, 160):
        time, speed = rings_exact(count, 0.005)
        found[f"modes_{count}"] = -speed[-1]
    for name, shear in (("stiffer", 1.0), ("softer", 0.7)):
        found[name] = -rings_exact(160, 0.005, shear)[1][-1]
    for name, case in RINGS.items():
        t, v, cost = rings(*case)
        found[f"restitution_{name}"] = -v[-1]
        found[f"apart_{name}"] = float(np.abs(v - np.interp(t, time, speed)).mean())
        found[f"cost_{name}"] = cost
    return found


def shells_exact(young: float, nu: float, stress: float) -> tuple[float, float]:
    """Pressure and radial displacement at the interface of the scene's shells, by Lamé's solution. The inner one would
    expand by the strain stress/3K."""
    a, b, c = 0.6, 0.8, 1.0

    def soft(near: float, far: float) -> float:
        """Displacement of the face at ``near`` for a pressure 1 on it."""
        stiff = young * abs(far**3 - near**3)
        return near * ((1 - 2 * nu) * near**3 + 0.5 * (1 + nu) * far**3) / stiff

    pressure = b * stress * (1 - 2 * nu) / young / (soft(b, a) + soft(b, c))
    return pressure, pressure * soft(b, c)


def shells_displacement(young: float, nu: float, stress: float, r: Any, inner: bool) -> Any:
    """Lamé's radial displacement u = A r + C/r² of the inner or the outer shell at ``r``, for the pressure at the
    interface on one of its faces and none on the other."""
    pressure, _ = shells_exact(young, nu, stress)
    near, far, sign = (0.8, 0.6, -1) if inner else (0.8, 1.0, 1)
    scale = sign * pressure * near**3 / (young * abs(far**3 - near**3))
    free = stress * (1 - 2 * nu) / young * r if inner else 0.0
    return free + scale * ((1 - 2 * nu) * r + 0.5 * (1 + nu) * far**3 / r**2)


def nested(element: str, inner: list[int], outer: list[int]) -> tuple[float, float, float]:
    """Relative errors of the mean pressure on the outer shell and of its mean displacement, and cost."""
    data = load("nested_shells")
    for body, cells in zip(data["body"], (inner, outer)):
        body["element"], body["shell"]["cells"] = element, cells
    run, exact = done(data), shells_exact(1.0, 0.25, 1e-3)
    rows = run.pressure["contact"][0]
    rows = rows[(rows["side"] == 1) & (rows["pressure"] > 0)]
    shell = run.state["outer"]
    radius = np.linalg.norm(shell.nodes, axis=1)
    within = radius < 0.8 + 1e-9
    moved = (shell.displacement * shell.nodes).sum(axis=1)[within] / radius[within]
    pressure = np.average(rows["pressure"], weights=rows["area"])
    return pressure / exact[0] - 1, float(moved.mean()) / exact[1] - 1, updates(run)


SHELLS = (("hex8", 16, 16), ("hex8", 32, 32), ("hex20", 16, 12))


def nested_shells() -> Numbers:
    """Like meshes of hex8, and unlike ones of hex20."""
    found = dict(zip(("pressure", "displacement"), shells_exact(1.0, 0.25, 1e-3)))
    for element, inner, outer in SHELLS:
        layers = 4 if inner == 32 else 2
        values = nested(element, [layers, inner], [layers, outer])
        names = ("pressure", "displacement", "cost")
        found |= {f"{element}_{inner}_{key}": value for key, value in zip(names, values)}
    return found


def discs() -> Numbers:
    """NimbleSM's thin_plate_contact: mean velocities of both discs after the impact, on three meshes."""
    found = {}
    for n in (2, 3, 4):
        data = load("discs")
        for body in data["body"]:
            body["cylinder"]["cells"] = [2 * n, 16 * n, n]
        run = done(data)
        small = run.body_momentum("small")["p"][0, 2] / -100
        for name, mass in (("small", small), ("large", small / 0.9**2)):
            found[f"{name}_{n}"] = run.body_momentum(name)["p"][-1, 2] / mass
        found[f"kinetic_{n}"] = run.energy["kinetic"][-1] / run.energy["kinetic"][0]
        found[f"updates_{n}"] = updates(run)
    return found


CASES: dict[str, Callable[[], Numbers]] = {
    "rod_at_wall": rod_at_wall,
    "bouncing_bar": bouncing_bar,
    "hertz_pressed": hertz_pressed,
    "hertz_impact": hertz_impact,
    "hertz_small": hertz_small,
    "oblique_impact": oblique_impact,
    "oblique_small": oblique_small,
    "balls_theory": balls_theory,
    "tumbling_box": tumbling_box,
    "sliding_block": sliding_block,
    "bent_plate": bent_plate,
    "settlement": settlement,
    "unlike_pulse": unlike_pulse,
    "crushed_ring": crushed_ring,
    "nested_shells": nested_shells,
    "discs": discs,
    "rings_in_impact": rings_in_impact,
}
CASES |= {name: lambda n=name, e=exact: rods_of(n, e) for name, exact in RODS.items()}
# Computed by ``make measured`` alone.
SLOW = {"hertz_small", "oblique_small", "rings_in_impact"}
