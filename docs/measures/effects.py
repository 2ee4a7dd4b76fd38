"""Energy of a bar, an absorbing end and bulk viscosity."""

from __future__ import annotations

import numpy as np
from shared import scenes

import libcontact as ct

from .shared import Numbers, measurement, scene_of, stable_step

# -- Energy ----------------------------------------------------------------------------------------


@measurement
def energy() -> Numbers:
    """The bar of the first picture: the most that the contact holds, and what the impact loses, over the start."""
    run = scenes.bar_on_wall().set_time(end=2.6, fraction=0.9).run(progress=False, output=False)
    start = run.energy["total"][0]
    return {
        "held": run.energy["reserve"].max() / start,
        "lost": 1 - run.energy["total"][-1] / start,
    }


# -- Absorbing boundary ----------------------------------------------------------------------------


@measurement
def absorb() -> Numbers:
    """Stable Courant number of a column of cubes with ν = 0, closed and with an absorbing end; energy that comes back
    of a P and an S pulse."""
    column = (
        scene_of()
        .add_body(
            "column",
            material="elastic",
            box={"origin": [0, 0, 0], "size": [10, 1, 1], "cells": [10, 1, 1]},
        )
        .set_time(end=1.0, fraction=0.5)
    )
    closed = stable_step(column)
    open_end = stable_step(column.add("absorb", surface="column.x_max"))
    return {"closed": closed, "open": open_end, "p": pulse_left("x"), "s": pulse_left("z")}


def hold_sides(scene: ct.Scene, body: str, fix: str) -> None:
    """Hold components on the four long faces of a column along x, which has one element across: so it is a row of
    masses and springs."""
    for face in ("y_min", "y_max", "z_min", "z_max"):
        scene.add_support(f"{body}.{face}", fix=fix)


def pulse_left(axis: str) -> float:
    """Share of the energy of a smooth pulse, four units long, that an absorbing end of a column of 100 hex8 sends
    back."""
    E, nu, rho = 900.0, 0.25, 2.0
    speed = (
        np.sqrt(E * (1 - nu) / ((1 + nu) * (1 - 2 * nu) * rho))
        if axis == "x"
        else np.sqrt(E / (2 * (1 + nu) * rho))
    )
    scene = scene_of(E, nu, rho).add_body(
        "column",
        material="elastic",
        box={"origin": [0, 0, 0], "size": [10, 0.1, 0.1], "cells": [100, 1, 1]},
    )
    hold_sides(scene, "column", "yz" if axis == "x" else "xy")
    t = np.linspace(0, 4 / speed, 41)
    history = {"time": t.tolist(), "value": (np.sin(np.pi * np.arange(41) / 40) ** 2).tolist()}
    scene.add(
        "load", surface="column.x_min", traction=[float(a == axis) for a in "xyz"], history=history
    )
    scene.add("absorb", surface="column.x_max").set_time(end=16 / speed, fraction=0.9).set_output(
        times=[6 / speed, 16 / speed], fields=[]
    )
    energy = scene.run(progress=False).energy
    held = energy["kinetic"] + energy["strain"]
    return held[-1] / held[np.searchsorted(energy["time"], 5.9 / speed)]


# -- Bulk viscosity --------------------------------------------------------------------------------


SHOCKS = {
    "none": (0, 0, 0.05),
    "soft": (0.06, 0, 0.05),
    "both": (0.06, 1.2, 0.05),
    "middle": (0.2, 0, 0.05),
    "hard": (0.5, 0, 0.05),
    "quadratic": (0, 1.2, 0.05),
    "strong": (0, 2, 0.05),
    "slow": (0, 1.2, 0.0005),
}


def viscous(scene: ct.Scene, linear: float, quadratic: float) -> ct.Scene:
    return (
        scene.add("viscosity", linear=linear, quadratic=quadratic) if linear or quadratic else scene
    )


@measurement
def viscosity() -> Numbers:
    """Stable Courant numbers of a cube with ν = 0 and viscosity; overshoot and width of the front in a rod of 200
    cubes, for SHOCKS."""
    found = {}
    for name, linear, quadratic in (
        ("courant_0", 0.0, 0.0),
        ("courant_006", 0.06, 0.0),
        ("courant_both", 0.06, 1.2),
        ("courant_05", 0.5, 0.0),
    ):
        cube = scene_of().add_body(
            "cube",
            material="elastic",
            box={"origin": [0, 0, 0], "size": [1, 1, 1], "cells": [1, 1, 1]},
        )
        found[name] = stable_step(viscous(cube, linear, quadratic).set_time(end=1.0, fraction=0.5))
    for name, (linear, quadratic, v0) in SHOCKS.items():
        found[f"{name}_overshoot"], found[f"{name}_width"] = shock(linear, quadratic, v0)
    return found


def shock(linear: float, quadratic: float, v0: float) -> tuple[float, float]:
    """A rod of unit cubes, c = ρ = 1, meets a wall with v0; the front has run 120 cubes. Overshoot of the stress -v0,
    and its way from 90 % to 10 % [cubes]."""
    box = {"origin": [0, 0, 0], "size": [200, 1, 1], "cells": [200, 1, 1]}
    scene = (
        scene_of()
        .add_body("rod", material="elastic", velocity=[-v0, 0, 0], box=box)
        .add_support("rod.x_min", fix="x")
    )
    hold_sides(scene, "rod", "yz")
    run = (
        viscous(scene, linear, quadratic)
        .set_time(end=120.0, courant=0.2)
        .set_output(every=10**6)
        .run(progress=False)
    )
    body = run.state["rod"]
    order = np.argsort(body.centres[:, 0])
    x, stress = body.centres[order, 0], -body.stress[order, 0] / v0
    ends = []
    for level in (0.9, 0.1):
        i = np.flatnonzero((stress[:-1] > level) & (stress[1:] <= level))[-1]
        ends.append(x[i] + (stress[i] - level) / (stress[i] - stress[i + 1]))
    return stress.max() - 1, ends[1] - ends[0]
