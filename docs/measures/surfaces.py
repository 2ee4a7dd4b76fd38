"""A pressed sphere, sliding and creeping blocks, and a joint."""

from __future__ import annotations

import itertools
import warnings
from typing import Any

import hertz
import numpy as np

import libcontact as ct

from .effects import hold_sides
from .shared import Numbers, measurement, scene_of


@measurement
def pressed_sphere() -> Numbers:
    """The finer meshes of bench/hertz.py: errors of force, radius and approach; and the orders of the radius."""
    found: Numbers = {}
    radius = {}
    for n in hertz.MESHES:
        row = hertz.solve(n)
        a, deep = hertz.exact(row["force"])
        whole = 4 / 3 * hertz.MODULUS * np.sqrt(hertz.RADIUS) * (1 / hertz.RADIUS) ** 1.5
        radius[n] = row["radius"] / a - 1
        found |= {
            f"force_{n}": row["force"] / whole - 1,
            f"radius_{n}": radius[n],
            f"approach_{n}": row["approach"] / deep - 1,
        }
    for n, m in (*itertools.pairwise(hertz.MESHES), (hertz.MESHES[0], hertz.MESHES[-1])):
        found[f"order_{n}_{m}"] = np.log(radius[n] / radius[m]) / np.log(m / n)
    return found


PLATES = {
    "soft_09": ({"beta": 1}, 0.9),
    "soft_01": ({"beta": 1}, 0.1),
    "stiff_09": ({"beta": 40}, 0.9),
    "stiff_03": ({"beta": 40}, 0.3),
    "penalty_soft": ({"beta": 1, "enforcement": "penalty"}, 0.2),
    "penalty_stiff": ({"beta": 40, "enforcement": "penalty"}, 0.1),
}


@measurement
def sliding_plate() -> Numbers:
    """Impulse of friction over that of the normal force on a plate that slides down an incline for a second."""
    found = {}
    for name, (keys, fraction) in PLATES.items():
        run = on_incline(0.6, 0.5, fraction, **keys)
        p, c = run.momentum["p"][-1], 9.81 * 100.0 * run.dt * run.steps[-1] / np.hypot(1, 0.6)
        found[name] = (0.6 * c - p[0]) / (c + p[2])
    return found


@measurement
def thrown_block() -> Numbers:
    """Tangential over normal impulse of a block of steel thrown on another one at μ = 0.3, with twice as much
    tangential velocity as normal velocity, at two steps."""
    return {"large": thrown(0.9), "small": thrown(0.05)}


def thrown(fraction: float) -> float:
    scene = scene_of(2.1e11, 0.3, 7800.0)
    for name, z, n, v in (("low", 0.0, 6, [0, 0, 0]), ("high", 0.05, 4, [2.0, 0, -1.0])):
        size, origin = ([0.1, 0.1, 0.05], [0, 0, 0]) if n == 6 else ([0.05] * 3, [0.025, 0.025, z])
        box = {"origin": origin, "size": size, "cells": [n, n, 4]}
        scene.add_body(name, material="elastic", box=box, velocity=v)
    scene.add_contact("high.z_min", "low.z_max", friction=0.3)
    run = scene.set_time(end=1e-4, fraction=fraction).run(progress=False, output=False)
    p = run.body_momentum("high")["p"]
    return float((p[0, 0] - p[-1, 0]) / (p[-1, 2] - p[0, 2]))


@measurement
def thrown_on_plane() -> Numbers:
    """Velocities with which the cube of an exercise leaves a rigid plane with restitution 0."""
    scene = scene_of(1e6, 0.3, 1000.0)
    box = {"origin": [0, 0, 0.001], "size": [1, 1, 1], "cells": [4, 4, 4]}
    scene.add_body("cube", material="elastic", box=box, velocity=[2, 0, -1])
    floor = {"point": [0, 0, 0], "normal": [0, 0, 1]}
    scene.add("obstacle", surface="cube.z_min", plane=floor, friction=0.3, restitution=0.0)
    run = scene.set_time(end=0.09, fraction=0.9).run(progress=False, output=False)
    along, _, up = run.body_momentum("cube")["p"][-1] / 1000.0
    return {"along": along, "up": up}


@measurement
def creeping_block() -> Numbers:
    """How far the block of the example scene moves in a second on a slope where it should stick: the default law at
    two steps, the explicit penalty, the default with damping [m]."""
    block = {"origin": [0, 0, 0], "size": [1, 1, 0.3], "cells": [4, 4, 2]}
    keys = {"beta": 1, "young": 1e5, "box": block}
    runs = {
        "default": on_incline(0.5, 0.6, 0.9, **keys),
        "small": on_incline(0.5, 0.6, 0.1, **keys),
        "penalty": on_incline(0.5, 0.6, 0.2, enforcement="penalty", **keys),
        "damped": on_incline(0.5, 0.6, 0.9, damping=20.0, **keys),
    }
    return {n: run.state["plate"].displacement[:, 0].mean() for n, run in runs.items()}


PLATE = {"origin": [0, 0, 0], "size": [1, 1, 0.1], "cells": [10, 10, 1]}


def on_incline(
    slope: float,
    friction: float,
    fraction: float,
    *,
    young: float = 1e6,
    box: dict = PLATE,
    damping: float = 0.0,
    **keys: Any,
) -> ct.Run:
    """A second of a plate of 100 kg, ν = 0.3, or of another box on a rigid incline, in SI units."""
    scene = scene_of(young, 0.3, 1000.0).add_body("plate", material="elastic", box=box)
    g = 9.81 / np.hypot(1, slope)
    scene.add("gravity", acceleration=[slope * g, 0, -g])
    if damping:
        scene.add("damping", rate=damping)
    floor = {"point": [0, 0, 0], "normal": [0, 0, 1]}
    scene.add("obstacle", surface="plate.z_min", plane=floor, friction=friction, **keys)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return scene.set_time(end=1.0, fraction=fraction).run(progress=False, output=False)


@measurement
def joint() -> Numbers:
    """A joint of 8 : 11 cells: stress that is off under tension, for two stiffnesses; energy and stress that a pulse of
    8 or 16 elements leaves behind, also at 8 : 8 cells; energy that unlike velocities lose at the start."""
    found = {f"off_{beta}": off_under_tension(beta) for beta in (40, 400)}
    found["start"] = lost_at_start()
    for name, m, long in (("11", 11, 1.0), ("8", 8, 1.0), ("long", 11, 2.0)):
        found[f"energy_{name}"], found[f"stress_{name}"] = behind_joint(m, long)
    return found


def joined(length: float, cells: int, m: int, beta: float) -> ct.Scene:
    scene = scene_of()
    for name, x, n in (("a", 0.0, 8), ("b", length, m)):
        box = {"origin": [x, 0, 0], "size": [length, 1, 1], "cells": [cells, n, n]}
        scene.add_body(name, material="elastic", box=box)
    return scene.add("tie", surfaces=["a.x_max", "b.x_min"], beta=beta)


def off_under_tension(beta: float) -> float:
    scene = joined(0.5, 4, 11, beta).add_support("a.x_min", fix="x")
    for body in "ab":
        scene.add_support(f"{body}.y_min", fix="y").add_support(f"{body}.z_min", fix="z")
    scene.add("load", surface="b.x_max", traction=[1e-3, 0, 0]).add("damping", relaxation=True)
    scene.set_time(end=1e4, until_static=1e-9, fraction=0.9, force_tolerance=1e-12)
    run = scene.run(progress=False, output=False)
    return max(np.abs(run.state[n].stress / 1e-3 - [1, 0, 0, 0, 0, 0]).max() for n in "ab")


def lost_at_start() -> float:
    """A moving cube of 4³ cells, glued to one of 2 · 3² cells at rest."""
    scene = scene_of()
    for name, x, cells, v in (("a", 0.0, [4, 4, 4], 0.01), ("b", 1.0, [2, 3, 3], 0.0)):
        box = {"origin": [x, 0, 0], "size": [1, 1, 1], "cells": cells}
        scene.add_body(name, material="elastic", box=box, velocity=[v, 0, 0])
    scene.add("tie", surfaces=["a.x_max", "b.x_min"]).set_time(end=0.5, fraction=0.9)
    total = scene.run(progress=False, output=False).energy["total"]
    return 1 - total[-1] / total[0]


def behind_joint(m: int, long: float) -> tuple[float, float]:
    """A P pulse, ``long`` units of 8 elements each, from the end of a column through its joint: energy and largest
    stress in the first half, over those of all."""
    length = 3.0 * long
    scene = joined(length, round(8 * length), m, 40.0)
    for body in "ab":
        hold_sides(scene, body, "yz")
    t = np.linspace(0, long, 81)
    amplitude = {"time": t.tolist(), "value": (1e-3 * np.sin(np.pi * t / long) ** 2).tolist()}
    scene.add("load", surface="a.x_min", traction=[1, 0, 0], history=amplitude)
    run = scene.set_time(end=1.6 * length, fraction=0.9).run(progress=False, output=False)
    energy, stress = {}, {}
    for name in "ab":
        body = run.state[name]
        x = body.nodes
        inner = np.where(np.isclose(x, x.min(axis=0)) | np.isclose(x, x.max(axis=0)), 0.5, 1.0)
        mass = inner.prod(axis=1) / inner.prod(axis=1).sum()  # of a box of equal cells
        energy[name] = (mass[:, None] * body.velocity**2).sum()
        stress[name] = np.abs(body.stress[:, 0]).max()
    return energy["a"] / sum(energy.values()), stress["a"] / stress["b"]
