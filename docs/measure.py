"""
Numbers that the pages quote, computed: ``make measured`` writes them to ``docs/measured.json``, and the role
``:measured:`` reads them from there.

Each function below computes the numbers of one passage and returns them by name. Its docstring says what is computed
and on what. To add a number, add it here, run ``make measured`` and write :measured:`function.name:format` on the page.
``tests/docs/test_measured.py`` computes them anew and compares, all but the SLOW ones.
"""

from __future__ import annotations

import itertools
import json
import re
import sys
import tempfile
import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from libcontact.meshes import gmsh
from libcontact.meshes.bricks import Split
from libcontact.meshes.convert import SHAPES
from libcontact.meshes.raw import Reading

import libcontact as ct

DOCS = Path(__file__).resolve().parent
ROOT = DOCS.parent
FILE = DOCS / "measured.json"
MESHES = ROOT / "tests" / "data" / "meshes.zip"
sys.path.insert(0, str(ROOT / "stability"))
import dissipation  # noqa: E402 (the bar on a wall, of `make stability`)

sys.path.insert(0, str(ROOT / "bench"))
import balls  # noqa: E402 (Hertz's pressure between two balls)

sys.path.insert(0, str(DOCS / "theory"))
import dispersion as waves  # noqa: E402 (the pictures of the chapter)
import face as free_face  # noqa: E402 (the program of the chapter on the exact solution)
import filter as shown  # noqa: E402 (the pictures of the chapter)

sys.path.insert(0, str(ROOT / "accuracy"))
import campaign  # noqa: E402 (the campaign of `make accuracy`)
import defaults  # noqa: E402 (the scenes of the defaults)
import drawings  # noqa: E402
import price  # noqa: E402 (the errors of a run)

sys.path.insert(0, str(DOCS / "figures"))
from shared import scenes  # noqa: E402 (the bar of the chapter on energy)

sys.path.insert(0, str(DOCS / "benchmarks"))
import problems as benchmarks  # noqa: E402

Numbers = dict[str, float]
MEASUREMENTS: dict[str, Callable[[], Numbers]] = dict(benchmarks.CASES)
# Too long for the test: a hundred runs each, and balls of hex20. The benchmarks have a test of their own.
SLOW = {"integrator", "explicit", "recovered_balls", *benchmarks.CASES}


def measurement(function: Callable[[], Numbers]) -> Callable[[], Numbers]:
    """List a function as one whose numbers pages quote."""
    MEASUREMENTS[function.__name__] = function
    return function


def scene_of(young: float = 1.0, poisson: float = 0.0, density: float = 1.0) -> ct.Scene:
    """A scene in m, kg and s with one material, "elastic", and no body yet."""
    return ct.Scene(
        title="measured", units={"length": "m", "mass": "kg", "time": "s"}
    ).add_material("elastic", young=young, poisson=poisson, density=density)


def stable_step(scene: ct.Scene) -> float:
    """The stable step that the library reports."""
    return scene.explain().data["time"]["stable"]


# -- First run -------------------------------------------------------------------------------------


@measurement
def first_run() -> Numbers:
    """The program of the page: the plateau behind the plane wave, its closed form -ρ c₁ v₀, and the lowest stress on
    the line [MPa]."""
    program: dict[str, Any] = {}
    exec(
        compile(
            (DOCS / "start" / "first_run.py")
            .read_text()
            .replace("progress=True", "progress=False, output=False"),
            "first_run.py",
            "exec",
        ),
        {"print": lambda *_: None},
        program,
    )
    E, nu, rho = 2.1e5, 0.3, 7.8e-9
    c1 = np.sqrt(E * (1 - nu) / ((1 + nu) * (1 - 2 * nu) * rho))
    return {
        "plateau": program["plateau"],
        "exact": -rho * c1 * 1000.0,
        "lowest": program["stress"].min(),
    }


@measurement
def ball() -> Numbers:
    """From what ball.py printed (a test runs it anew): how far the pressures of its meshes lie apart, and above
    Hertz's."""
    text = (DOCS / "start" / "ball.out").read_text()
    found = re.findall(r"^(\d+) cells, (beta = 2|default penalty): ([\d.]+) MPa", text, re.M)
    soft, default = (
        [float(value) for _, law, value in found if law == name]
        for name in ("beta = 2", "default penalty")
    )
    hertz = float(re.search(r"Hertz: ([\d.]+)", text)[1])  # type: ignore[index]
    return {
        "soft": soft[-1] / soft[0] - 1,
        "spread": max(default) / min(default) - 1,
        "above": default[-1] / hertz - 1,
    }


@measurement
def wall() -> Numbers:
    """The largest speed of the mass after the impact on a plain penalty, with steps of 1.5/ω, from 200 starts."""
    program: dict[str, Any] = {}
    exec(compile((DOCS / "week" / "wall.py").read_text(), "wall.py", "exec"), program)
    return {"fastest": program["rebound"](1.5).max()}


# -- Laboratory and zoo ----------------------------------------------------------------------------


@measurement
def laboratory() -> Numbers:
    """From the tables of `make stability` and `make zoo`, the default law: growth and loss of linear bodies and of the
    others, and how the runs of the zoo ended."""
    rows = defaults.table.read(DOCS / "stability" / "summary.csv")
    own = [row for row in rows if row["enforcement"] == "energy-controlled" and row["lost"] != ""]
    large = ("folding strip", "rolled strip", "coil", "crushed ring", "pair of bodies")
    found = {"linear_growth": max(r["energy grows by"] for r in own if r["case"] not in large)}
    found["plates_lost"] = max(r["lost"] for r in own if r["case"] == "plates")
    for name in large:
        (row,) = (r for r in own if r["case"] == name)
        key = name.split()[0]
        found[f"{key}_growth"] = row["energy grows by"]
        if key not in ("crushed", "pair"):
            found[f"{key}_lost"] = row["lost"]
    zoo = defaults.table.read(DOCS / "stability" / "zoo.csv")
    found |= {
        f"zoo_{name}": sum(r[name] for r in zoo) for name in ("runs", "ok", "refused", "fail")
    }
    found["zoo_growth"] = max(r["bodies' energy grows by"] for r in zoo)
    return found


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


# -- Integrators and the explicit penalty ----------------------------------------------------------


def explicit_bar(
    beta: float, fraction: float = 0.9, landings: int = 5, **step: Any
) -> list[Numbers]:
    """
    The bar on a wall with the explicit penalty, for landings that divide the step into equal parts: largest and last
    energy over the first, root mean square error of the pressure amid the contact (from the energy of the spring), and
    largest pressure, both over the exact one.
    """
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "chatter:")
        dt = dissipation.thrown("penalty", beta, fraction=fraction, end=0.1, **step).dt
        runs = [
            dissipation.thrown(
                "penalty",
                beta,
                part / landings * dt / (0.9 * dissipation.H / dissipation.C),
                fraction=fraction,
                **step,
            )
            for part in range(landings)
        ]
    found = []
    for part, run in enumerate(runs):
        total = run.energy["total"] / run.energy["total"][0]
        stiffness = beta * dissipation.YOUNG / dissipation.H
        pressure = (
            np.sqrt(2 * stiffness * np.maximum(run.energy["obstacle"], 0))
            / dissipation.H
            / dissipation.PRESSURE
        )
        time = run.time - part / landings * dt
        held = (time > 0.55) & (time < 1.12)
        found.append(
            {
                "most": total.max(),
                "last": total[-1],
                "rms": np.sqrt(np.mean((pressure[held] - 1) ** 2)),
                "peak": pressure.max(),
            }
        )
    return found


def most(found: list[Numbers], name: str) -> float:
    return max(one[name] for one in found)


INTEGRATORS = {
    "leapfrog": {},
    "chung_lee": {"integrator": "chung_lee"},
    "noh_bathe": {"integrator": "noh_bathe"},
    "tchamwa_wielgosz": {"integrator": "tchamwa_wielgosz"},
}


@measurement
def integrator() -> Numbers:
    """The bar on a wall at 0.9 of the reported step: β = 1, error of the force and loss, worst of 5 landings; β = 10,
    growth of the energy over 20 landings."""
    found = {}
    for name, step in INTEGRATORS.items():
        soft, stiff = (
            explicit_bar(1.0, **step),
            [one["most"] for one in explicit_bar(10.0, landings=20, **step)],
        )
        found |= {
            f"{name}_rms": most(soft, "rms"),
            f"{name}_loss": 1 - min(one["last"] for one in soft),
            f"{name}_growth": max(stiff) - 1,
        }
        if name == "leapfrog":
            found |= {"leapfrog_least": min(stiff), "leapfrog_most": max(stiff)}
    return found


@measurement
def explicit() -> Numbers:
    """The bar on a wall with the leapfrog, worst of 5 landings: change of the energy at 0.9 and 0.5 of the reported
    step; largest pressure at 0.1."""
    found = {
        f"peak_{name}": most(explicit_bar(beta, 0.1, landings=1), "peak")
        for name, beta in (("05", 0.5), ("1", 1.0), ("5", 5.0), ("10", 10.0))
    }
    for name, betas in (("soft", (0.5, 1.0)), ("five", (5.0,)), ("ten", (10.0,))):
        found[f"{name}_limit"] = max(most(explicit_bar(beta, 0.9), "last") for beta in betas) - 1
        if name != "soft":
            found[f"{name}_half"] = most(explicit_bar(betas[0], 0.5), "last") - 1
    return found


# -- One point and the explicit penalty ------------------------------------------------------------


def blow(fraction: float, landing: float) -> tuple[float, float, float]:
    """
    A mass m = Δt = 1 meets a spring k = 4 f² with the speed 1, at the gap ``landing`` one step before it is inside. Its
    kinetic energy after the blow, what the ledger loses on entry and what it gains on exit.
    """
    k, before, g, v = 4 * fraction**2, landing, landing - 1, -1.0
    entry = 0.5 * k * -g * before
    while g <= 0:
        v += -k * g
        before, g = g, g + v
    return 0.5 * v * v, entry, 0.5 * k * -before * g


@measurement
def rest() -> Numbers:
    """A cube of 4 x 4 x 4 unit elements falls by 0.02 on a floor and stays there: energy of the fall that is left after
    300 time units."""
    found, weight = {}, 64 * 1e-4
    for name, law in (("inelastic", {"restitution": 0.0}), ("elastic", {})):
        scene = scene_of(poisson=0.3)
        box = {"origin": [0, 0, 0.02], "size": [4, 4, 4], "cells": [4, 4, 4]}
        scene.add_body("cube", material="elastic", box=box)
        scene.add("gravity", acceleration=[0, 0, -1e-4])
        floor = {"point": [0, 0, 0], "normal": [0, 0, 1]}
        scene.add("obstacle", surface="cube.z_min", plane=floor, **law)
        run = scene.set_time(end=300.0, fraction=0.9).run(progress=False, output=False)
        total = run.energy["total"]
        found[f"{name}_kept"] = 1 + (total[-1] - total[0]) / (0.02 * weight)
    return found


@measurement
def one_blow() -> Numbers:
    """Means over 4000 landings of a lone mass at 0.3 and 0.9 of its stable step, over its kinetic energy: loss on entry
    and gain on exit."""
    landings = (np.arange(4000) + 0.5) / 4000
    found = {}
    for name, fraction in (("3", 0.3), ("9", 0.9)):
        after, entry, leave = np.array([blow(fraction, landing) for landing in landings]).T
        assert np.allclose(after - 0.5, leave - entry, atol=1e-12)
        found |= {f"entry_{name}": 2 * entry.mean(), f"exit_{name}": 2 * leave.mean()}
    return found


# -- Open border -----------------------------------------------------------------------------------


def growth_of_thrown(part: str, enforcement: str, fraction: float) -> float:
    """Growth of the energy, over the kinetic energy at the start, when a block that hangs down beside a plate by h/5 is
    thrown onto it at a fifth of the speed of sound."""
    plate = {"origin": [0, 0, -2], "size": [8, 2, 2], "cells": [8, 2, 2]}
    block = {"origin": [-4, 0, -0.2], "size": [4, 2, 2], "cells": [4, 2, 2]}
    surfaces = ["plate.outer", "block.outer"] if part == "outer" else ["plate.z_max", "block.z_min"]
    run = (
        scene_of()
        .add_body("plate", material="elastic", box=plate)
        .add_body("block", material="elastic", box=block, velocity=[0.2, 0, 0])
        .add_support("plate.z_min", fix="xyz")
        .add_contact(*surfaces, beta=4.0, enforcement=enforcement)
        .set_time(end=15.0, fraction=fraction)
        .set_output(every=1)
        .run(progress=False, output=False)
    )
    return (run.energy["total"].max() - run.energy["total"][0]) / run.energy["kinetic"][0]


@measurement
def border() -> Numbers:
    """Growth with closed surfaces for the penalty, at 0.9 and 0.1 of the stable step. The default law adds nothing
    there, and no law does at open surfaces."""
    for part, enforcement in (
        ("outer", "energy_controlled"),
        ("top", "energy_controlled"),
        ("top", "penalty"),
    ):
        assert growth_of_thrown(part, enforcement, 0.9) < 1e-12
    return {
        "closed": growth_of_thrown("outer", "penalty", 0.9),
        "closed_short": growth_of_thrown("outer", "penalty", 0.1),
    }


# -- Unlike meshes ---------------------------------------------------------------------------------


def pressed(n: int, m: int, beta: float) -> tuple[float, float, float]:
    """
    Two elastic blocks with ν = 0, their faces cut into n x n and m x m elements, pressed together evenly and relaxed.
    The largest and smallest pressure of a point over the true one, and the largest error of the stress of an element.
    """
    scene = scene_of(young=1000.0)
    for name, z, cells in (("lower", -0.5, n), ("upper", 0.0, m)):
        scene.add_body(
            name,
            material="elastic",
            box={
                "origin": [0, 0, z],
                "size": [1, 1, 0.5],
                "cells": [cells, cells, max(cells // 2, 1)],
            },
        )
        scene.add_support(f"{name}.x_min", fix="x").add_support(f"{name}.y_min", fix="y")
    scene.add_support("lower.z_min", fix="z").add_contact("lower.z_max", "upper.z_min", beta=beta)
    scene.add("load", surface="upper.z_max", pressure=1.0).add("damping", relaxation=True)
    run = (
        scene.set_time(end=20.0, fraction=0.9, until_static=1e-6)
        .set_output(every=10**6)
        .run(progress=False)
    )
    pressure = run.contact[0]["raw_pressure"]
    stress = np.concatenate([run.state[name].stress[:, 2] for name in ("lower", "upper")])
    return pressure.max(), pressure.min(), np.abs(stress + 1).max()


@measurement
def unlike_meshes() -> Numbers:
    """Blocks of 8 and 11, and of 2 and 14 elements along an edge, at β = 4 and 100: errors of the pressure of points
    and of the stress of elements."""
    found = {}
    for name, n, m in (("8_11", 8, 11), ("2_14", 2, 14)):
        for beta in (4, 100):
            high, low, stress = pressed(n, m, beta)
            found |= {
                f"{name}_{beta}_point": max(high - 1, 1 - low),
                f"{name}_{beta}_stress": stress,
            }
    return found


# -- Pressure from forces --------------------------------------------------------------------------


def blocks(n: int, m: int, element: str) -> ct.Run:
    """Two elastic blocks with ν = 0, their faces cut into n x n and m x m elements, pressed together by the pressure 1
    and relaxed, with the default contact."""
    scene = scene_of(young=1000.0)
    for name, z, cells in (("lower", -0.5, n), ("upper", 0.0, m)):
        box = {
            "origin": [0, 0, z],
            "size": [1, 1, 0.5],
            "cells": [cells, cells, max(cells // 2, 1)],
        }
        scene.add_body(name, material="elastic", element=element, box=box)
        scene.add_support(f"{name}.x_min", fix="x").add_support(f"{name}.y_min", fix="y")
    scene.add_support("lower.z_min", fix="z").add_contact("lower.z_max", "upper.z_min")
    scene.add("load", surface="upper.z_max", pressure=1.0).add("damping", relaxation=True)
    scene.set_time(end=20.0, fraction=0.9, until_static=1e-5).set_output(every=10**6)
    return scene.run(progress=False)


def projected(nodes: np.ndarray, n: int) -> np.ndarray:
    """Pressures (n + 1, n + 1) on a face of n x n linear elements from the forces of its nodes, by the consistent
    matrix of the surface."""
    force, matrix = np.zeros((n + 1, n + 1)), np.zeros((n + 1, n + 1))
    i, j = np.rint(n * nodes["position"][:, :2]).astype(int).T
    force[i, j] = nodes["area"] * np.abs(nodes["traction"][:, 2])
    for e in range(n):
        matrix[e : e + 2, e : e + 2] += np.array([[2, 1], [1, 2]]) / (6 * n)
    return np.linalg.solve(matrix, np.linalg.solve(matrix, force).T).T


def by_points(run: ct.Run, side: int, n: int) -> np.ndarray:
    """Pressures (n + 1, n + 1) on a face of n x n linear elements from the forces of its nodes, over the area that the
    points of both surfaces have there."""
    (nodes,), (points,) = run.pressure["contact"], run.contact
    nodes, force = nodes[nodes["side"] == side], np.zeros((n + 1, n + 1))
    i, j = np.rint(n * nodes["position"][:, :2]).astype(int).T
    force[i, j] = nodes["area"] * np.abs(nodes["traction"][:, 2])
    place = np.where((points["side"] == side)[:, None], points["position"], points["closest"])
    weight = 0.5 * points["weight"] * (points["raw_pressure"] > 0)
    return force / ((hat(place[:, 0], n) * weight) @ hat(place[:, 1], n).T)


@measurement
def recovered_blocks() -> Numbers:
    """Blocks of 8 and 11, and of 2 and 14 elements along an edge: largest errors of the traction of a point, of the
    recovered pressure and of the stress of an element; of the sharper pressure."""
    found = {}
    for n, m in ((8, 11), (2, 14)):
        for element in ("hex8", "hex20"):
            run, name = blocks(n, m, element), f"{n}_{m}_{element}"
            nodes = run.pressure["contact"][0]
            stress = np.concatenate([run.state[body].stress[:, 2] for body in run.bodies])
            found |= {
                f"{name}_point": np.abs(run.contact[0]["raw_pressure"] - 1).max(),
                f"{name}_node": np.abs(nodes["pressure"] - 1).max(),
                f"{name}_stress": np.abs(stress + 1).max(),
            }
            sharp = [
                sharper(run, s, run.state[body].mesh.faces(face)[0])["pressure"]
                for s, body, face in ((0, "lower", "z_max"), (1, "upper", "z_min"))
            ]
            found[f"{name}_sharper"] = max(np.abs(side - 1).max() for side in sharp)
            if element == "hex8":
                sides = [
                    projected(nodes[nodes["side"] == s], cells) for s, cells in ((0, n), (1, m))
                ]
                found[f"{name}_consistent"] = max(np.abs(side - 1).max() for side in sides)
                found[f"{name}_by_points"] = max(
                    np.abs(by_points(run, s, cells) - 1).max() for s, cells in ((0, n), (1, m))
                )
    return found


@measurement
def recovered_rim() -> Numbers:
    """tutorials/scenes/hertz.toml with the default penalty on 10³ elements: pressure at the corner of the only face in
    contact, with the area of this face alone, and Hertz's; and in the middle with hex20."""
    found = {}
    for element in ("hex8", "hex20"):
        data = ct.Scene.load(ROOT / "tutorials" / "scenes" / "hertz.toml").data
        data["body"][0] |= {"element": element}
        data["body"][0]["box"]["cells"] = [10, 10, 10]
        del data["obstacle"][0]["beta"]
        nodes = ct.Scene(data).run(progress=False, output=False).pressure["obstacle"][0]
        middle, corner = (
            np.argmin(((nodes["position"][:, :2] - x) ** 2).sum(axis=1)) for x in (0.0, 0.4)
        )
        if element == "hex20":
            found["hex20"] = nodes["pressure"][middle]
            continue
        assert np.count_nonzero(nodes["pressure"]) == 4
        found |= {
            "corner": nodes["pressure"][corner],
            "by_faces": nodes["pressure"][corner] * nodes["area"][corner] / (0.4**2 / 4),
            "corner_hertz": 2000 / 0.91 / np.pi * np.sqrt((0.1 - 2 * 0.4**2 / 4) / 4),
        }
    return found


@measurement
def recovered_hertz() -> Numbers:
    """tutorials/scenes/hertz.toml on a block of half the size with the same elements, relaxed: rms of the recovered
    pressure about Hertz's profile, fitted within 0.85 a, over its peak; and about that of the computed force with the
    default penalty, also if mid-sides had the means of bilinear corners."""
    found = {}
    for element, default in itertools.product(("hex8", "hex20"), (False, True)):
        data = ct.Scene.load(ROOT / "tutorials" / "scenes" / "hertz.toml").data
        if default:
            del data["obstacle"][0]["beta"]
        data["body"][0] |= {
            "element": element,
            "box": {"origin": [0, 0, -2], "size": [2, 2, 2], "cells": [10, 10, 10]},
        }
        data["time"] |= {"end": 4e-3, "until_static": 1e-5}
        data |= {"damping": {"relaxation": True}, "output": {"every": 10**6}}
        run = ct.Scene(data).run(progress=False)
        nodes = run.pressure["obstacle"][0]
        r = np.hypot(*nodes["position"][:, :2].T)
        if default:
            block = run.state["block"]
            r = np.hypot(*block.nodes[nodes["node"], :2].T)
            force = 4.0 * abs(nodes["area"] @ nodes["traction"][:, 2])
            radius = (0.75 * force * 4.0 / (1000.0 / 0.91)) ** (1 / 3)
            peak, within = 1.5 * force / (np.pi * radius**2), r < 0.85 * radius
            exact = peak * np.sqrt(1.0 - (r[within] / radius) ** 2)
            found[f"{element}_default"] = rms(nodes["pressure"][within] - exact) / peak
            if element == "hex20":
                corners = at_corners(block.mesh.faces("z_max")[0], nodes, 0.2**2)
                found["hex20_corners"] = rms(corners[within] - exact) / peak
            continue
        within = r < 0.85 * np.sqrt(4.0 * 0.1)
        # Hertz's profile: p² is a straight line over r².
        slope, peak = np.polyfit(r[within] ** 2, nodes["pressure"][within] ** 2, 1)
        error = nodes["pressure"][within] - np.sqrt(peak + slope * r[within] ** 2)
        found[element] = rms(error) / np.sqrt(peak)
    return found


def rms(values: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def at_corners(faces: np.ndarray, nodes: np.ndarray, size: float) -> np.ndarray:
    """Pressures of the nodes of Q8 faces (n, 8), squares of area `size`, if corners took half of the forces of
    mid-sides, and mid-sides had the means of their corners; from the recovered forces, of which a mid-side has kept a
    quarter."""
    row = {node: i for i, node in enumerate(nodes["node"])}
    place = np.array([[row[node] for node in face] for face in faces])
    traction, area = nodes["area"][:, None] * nodes["traction"], np.zeros(len(nodes))
    ends = {f[4 + k]: [f[k], f[(k + 1) % 4]] for f in place for k in range(4)}
    for middle, corners in ends.items():
        traction[corners] += 0.5 * traction[middle]
    np.add.at(area, place[:, :4], 0.25 * size)
    corner = area > 0.0
    traction[corner] /= area[corner, None]
    for middle, corners in ends.items():
        traction[middle] = traction[corners].mean(axis=0)
    return np.linalg.norm(traction, axis=1)


def hat(x: np.ndarray, n: int) -> np.ndarray:
    """Shape functions (n + 1, points) of n equal linear elements on 0 ... 1."""
    return np.maximum(1 - np.abs(n * x - np.arange(n + 1)[:, None]), 0)


@measurement
def recovered_balls() -> Numbers:
    """Two equal balls with the default contact, at rest and at the largest force of an impact, with these numbers of
    elements over the radius (``bench/balls.py``): rms of the recovered pressure about Hertz's profile for the force,
    its mean and its error in the middle, over the peak; rms of the points; rms of the sharper pressure, and
    the largest tension that it has."""
    found = {}
    for element, n, m, impact in (
        ("hex8", 3, 3, False),
        ("hex20", 3, 3, False),
        ("hex8", 3, 3, True),
        ("hex20", 2, 2, True),
        ("hex20", 3, 3, True),
        ("hex20", 4, 4, True),
        ("hex20", 3, 4, True),
        ("hex20", 4, 5, True),
    ):
        run = balls.scene(element, n, m, impact).run(progress=False)
        name = f"{element}_{n}_{m}" + ("_impact" if impact else "")
        off = balls.errors(run, run.pressure["contact"][0], 0)
        found |= {f"{name}_{key}": off[key] for key in ("rms", "mean", "middle", "points")}
        sharp = sharper(run, 0, balls.round_faces(run.state["lower"]))
        found[f"{name}_sharper"] = balls.errors(run, sharp, 0)["rms"]
        tension = sharp["traction"][:, 2].max() / balls.PEAK
        found["tension"] = max(found.get("tension", 0.0), tension)
        if n != m:
            found[f"{name}_fine"] = balls.errors(run, run.pressure["contact"][0], 1)["rms"]
    return found


def sharper(run: ct.Run, side: int, faces: np.ndarray) -> np.ndarray:
    """Rows of one surface with the recovered tractions plus half of what a second mean under their weights would take
    from them; its faces (n, 4 or 8) are nearly parallelograms."""
    (nodes,) = run.pressure["contact"]
    nodes = nodes[nodes["side"] == side].copy()
    x, weights = run.state[run.bodies[side]].nodes, weights_of(faces.shape[1])
    area = [x[faces[:, k]] - x[faces[:, 0]] for k in (1, 3)]
    area = np.linalg.norm(np.cross(*area), axis=1)
    traction, force, whole = np.zeros((len(x), 3)), np.zeros((len(x), 3)), np.zeros(len(x))
    traction[nodes["node"]] = nodes["traction"]
    np.add.at(force, faces, area[:, None, None] * (weights @ traction[faces]))
    np.add.at(whole, faces, area[:, None] * weights.sum(axis=1))
    on = whole > 0.0
    traction[on] += 0.5 * (traction[on] - force[on] / whole[on, None])
    nodes["traction"], nodes["area"] = traction[nodes["node"]], whole[nodes["node"]]
    nodes["pressure"] = np.linalg.norm(nodes["traction"], axis=1)
    return nodes


def weights_of(count: int) -> np.ndarray:
    """Integrals of the products of the weights :eq:`recovered-weights` over a square of area 1 with 4 or 8 nodes."""
    place, weight = np.polynomial.legendre.leggauss(4)
    x, y = np.meshgrid(0.5 + 0.5 * place, 0.5 + 0.5 * place)
    apart = [(abs(x - i), abs(y - j)) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
    cut = 0.5 if count == 8 else 0.0
    chi = [(1 - u) * (1 - v) * (1 - cut * (u + v)) for u, v in apart]
    if count == 8:
        across, along = x * (1 - x), y * (1 - y)
        chi += [across * (1 - y), x * along, across * y, (1 - x) * along]
    return np.einsum("aij,bij,i,j->ab", chi, chi, 0.5 * weight, 0.5 * weight)


def brick(size: np.ndarray, young: float) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness (24, 24) of a box with ν = 0 by 2 x 2 x 2 Gauss points, and σz in its centre for unit displacements
    (24,)."""
    corners = np.array(np.meshgrid(*[[-1, 1]] * 3, indexing="ij")).reshape(3, 8)
    stiffness, modulus = np.zeros((24, 24)), young * np.array([1, 1, 1, 0.5, 0.5, 0.5])
    for point in [*(corners.T / np.sqrt(3)), np.zeros(3)]:
        near = 1 + corners * point[:, None]
        slope = corners / 4 * near[[1, 2, 0]] * near[[2, 0, 1]] / size[:, None]
        B = np.zeros((6, 8, 3))
        for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
            B[i, :, i], B[3 + i, :, j], B[3 + i, :, k] = slope[i], slope[k], slope[j]
        B = B.reshape(6, 24)
        if point.any():
            stiffness += B.T * modulus @ B * np.prod(size) / 8
    return stiffness, young * B[2]


def common(n: int, m: int) -> np.ndarray:
    """Integrals (n + 1, m + 1) of products of the shape functions of n and of m equal elements on 0 ... 1, over the
    common pieces of both."""
    cuts = np.unique(np.r_[np.arange(n + 1) / n, np.arange(m + 1) / m])
    middle, half = (cuts[1:] + cuts[:-1]) / 2, np.diff(cuts) / 2
    points = np.r_[middle - half / np.sqrt(3), middle + half / np.sqrt(3)]
    return (hat(points, n) * np.r_[half, half]) @ hat(points, m).T


@measurement
def mortar() -> Numbers:
    """The hex8 blocks of ``recovered_blocks``, two elements high, at rest and joined by multipliers on the finer face,
    with integrals over the common pieces of both meshes: largest errors of a multiplier and of the stress of an
    element."""
    found = {"node": 0.0, "stress": 0.0}
    for coarse, fine in ((8, 11), (2, 14)):
        nodes = [np.arange(3 * (n + 1) ** 2).reshape(n + 1, n + 1, 3) for n in (coarse, fine)]
        nodes[1] += nodes[0].size
        below, above, size = nodes[0][..., 2], nodes[1][..., 0], 3 * (nodes[1].max() + 1)
        A, b = np.zeros((size + above.size,) * 2), np.zeros(size + above.size)
        pieces = []
        for n, node in zip((coarse, fine), nodes):
            K, row = brick(np.array([1 / n, 1 / n, 0.25]), 1000.0)
            near = [slice(None, -1), slice(1, None)]
            corners = np.stack([node[i, j, k] for i in near for j in near for k in near], -1)
            for one in corners.reshape(-1, 8):
                freedoms = (3 * one[:, None] + np.arange(3)).ravel()
                A[np.ix_(freedoms, freedoms)] += K
                pieces.append((freedoms, row))
        for node, sign, n in ((above, 1, fine), (below, -1, coarse)):
            joined = sign * np.kron(common(fine, n), common(fine, n))
            A[size:, 3 * node.ravel() + 2] = joined
            A[3 * node.ravel() + 2, size:] = joined.T
        b[3 * nodes[1][..., 2].ravel() + 2] = -np.kron(*[common(fine, fine).sum(axis=1)] * 2)
        held = [3 * node[0].ravel() for node in nodes] + [
            3 * node[:, 0].ravel() + 1 for node in nodes
        ]
        free = np.delete(
            np.arange(len(b)), np.concatenate([*held, 3 * nodes[0][..., 0].ravel() + 2])
        )
        x = np.zeros(len(b))
        x[free] = np.linalg.solve(A[np.ix_(free, free)], b[free])
        stress = [row @ x[freedoms] for freedoms, row in pieces]
        for name, values in (("node", np.abs(x[size:])), ("stress", -np.array(stress))):
            found[name] = max(found[name], np.abs(values - 1).max())
    return found


def stiffest_over_softest(n: int, m: int, slip: float = 0.0) -> tuple[int, int, float]:
    """
    Two plane faces of n x n and m x m hex8 that touch, one slid along both edges by ``slip`` times the coarser element:
    contact points, rank of W, :eq:`constraint-problem`, for layers of cubes, and its largest over its smallest
    eigenvalue that is not 0.
    """
    rows = []
    for own, other, sign in ((n, m, 1), (m, n, -1)):
        x = ((np.arange(own) + 0.5)[:, None] + np.array([-0.5, 0.5]) / np.sqrt(3)).ravel() / own
        met = np.clip(x + sign * slip / min(n, m), 0, 1)
        both = [np.kron(hat(x, own), hat(x, own)).T, -np.kron(hat(met, other), hat(met, other)).T]
        rows.append(np.hstack(both[::sign]))
    mass = [
        np.kron(line, line) / c for c in (n, m) for line in [np.r_[0.5, np.ones(c - 1), 0.5] / c]
    ]
    G = np.vstack(rows)
    found = np.linalg.svd(G / np.sqrt(np.concatenate(mass)), compute_uv=False) ** 2
    found = found[found > 1e-13 * found[0]]
    return len(G), len(found), found[0] / found[-1]


def overlap(n: int, m: int, beta: float) -> float:
    """Two blocks of n and m elements along an edge that meet with a hundredth of the wave speed each, at 0.9 of the
    step: deepest overlap over the finer element. Each step must converge."""
    scene = scene_of(poisson=0.3)
    speed = 0.01 * np.sqrt(0.7 / (1.3 * 0.4))
    for name, z, cells, v in (("lower", -0.5, n, speed), ("upper", 0.0, m, -speed)):
        box = {
            "origin": [0, 0, z],
            "size": [1, 1, 0.5],
            "cells": [cells, cells, max(cells // 2, 1)],
        }
        scene.add_body(name, material="elastic", box=box, velocity=[0, 0, v])
    scene.add_contact("lower.z_max", "upper.z_min", beta=beta)
    deepest = []

    def look(run: ct.Run) -> None:
        deepest.append(max(0.0, -np.nanmin(run.contact[0]["gap"])))

    with warnings.catch_warnings():
        warnings.filterwarnings("error", "unconverged:")
        scene.set_time(end=1.0, fraction=0.9).set_output(every=1, fields=[]).run(
            progress=False, output=False, watch=look
        )
    return max(deepest) * max(n, m)


@measurement
def multipliers() -> Numbers:
    """Pairs of meshes: contact points, rank and eigenvalue ratio of W, the ratio after a slip of a thousandth of an
    element, and the overlap of an impact at three penalties."""
    found = {}
    for n, m in ((8, 8), (8, 16), (4, 5), (8, 11), (16, 23)):
        points, rank, ratio = stiffest_over_softest(n, m)
        found |= {f"{n}_{m}_points": points, f"{n}_{m}_rank": rank, f"{n}_{m}_ratio": ratio}
        found[f"{n}_{m}_slip"] = stiffest_over_softest(n, m, 1e-3)[2]
        if n < 16:
            found |= {f"{n}_{m}_{beta}": overlap(n, m, beta) for beta in (40, 1000, 10000)}
    return found


@measurement
def nodal_forces() -> Numbers:
    """A line of n elements pressed evenly on one of m, two Gauss points an element: largest error of a nodal force on
    each side, over the true one."""
    found = {}
    for name, n, m in (("2_3", 2, 3), ("4_5", 4, 5), ("10_73", 10, 73)):
        worst = []
        for own, other in ((n, m), (m, n)):
            exact = np.r_[0.5, np.ones(own - 1), 0.5] / own
            points = (
                (np.arange(other) + 0.5)[:, None] + np.array([-0.5, 0.5]) / np.sqrt(3)
            ).ravel() / other
            # Half of the force comes from the own points, without error; half is sampled at the points of the other
            # side.
            worst.append(np.max(np.abs(hat(points, own).sum(axis=1) / (2 * other) / exact - 1)) / 2)
        found |= (
            {f"{name}_coarse": worst[0], f"{name}_fine": worst[1]}
            if n * 2 < m
            else {name: max(worst)}
        )
    return found


FRONTS: dict[str, tuple[tuple[int, int, int], dict[str, Any]]] = {
    "paper": ((1, 0, 0), {"courant": 0.125}),
    "fast": ((1, 0, 0), {"courant": 0.8}),
    "chung_lee": ((1, 0, 0), {"courant": 0.5, "integrator": "chung_lee"}),
    "noh_bathe": ((1, 0, 0), {"courant": 1.25, "integrator": "noh_bathe"}),
    "tchamwa_wielgosz": ((1, 0, 0), {"courant": 0.5, "integrator": "tchamwa_wielgosz"}),
    "consistent": ((1, 0, 0), {"mass": "consistent"}),
    "askew": ((1, 1, 0), {"courant": 0.125}),
    "askew_fast": ((1, 1, 0), {"courant": 0.8}),
    "hex20": ((1, 0, 0), {"courant": 0.2, "element": "hex20"}),
    "hex20_askew": ((1, 1, 0), {"courant": 0.2, "element": "hex20"}),
    "hex20_noh_bathe": ((1, 0, 0), {"courant": 0.4, "element": "hex20", "integrator": "noh_bathe"}),
}


@measurement
def dispersion() -> Numbers:
    """The front of Fig. 4: how many elements it is late, and its overshoot, from a run, the sum of waves and Airy's
    function. FRONTS after 40 elements on a fine line, and C of the phase error of hex20."""
    run = waves.column()
    found = {"run_late": waves.TRAVEL - run.half_height, "run_overshoot": run.overshoot}
    fine = np.linspace(40.0, 62.0, 2201)
    long = ct.Front(fine, waves.long_front(fine, 0.125))
    found |= {"airy_late": waves.TRAVEL - long.half_height, "airy_overshoot": long.overshoot}
    for name, (normal, options) in FRONTS.items():
        front = ct.dispersion_front(40.0, normal, np.linspace(20.0, 46.0, 2601), **options)
        found |= {f"{name}_late": 40.0 - front.half_height, f"{name}_overshoot": front.overshoot}
    for nu in (0.0, 0.3, 0.45):
        k = 0.02
        phase = ct.dispersion([k, 0, 0], "hex20", poisson=nu).phase[2]
        found[f"hex20_{nu:.2f}".replace(".", "")] = (1.0 - phase) / k**2
    axis, diagonal = (
        1 - ct.dispersion(0.1 * np.array(n) / np.linalg.norm(n), "hex8", poisson=0.3).phase[2]
        for n in ((1, 0, 0), (1, 1, 0))
    )
    return found | {"diagonal": diagonal / axis}


FILTERED = {
    "full": ("reference", campaign.BEST, (0, 2)),
    "stiff": ("reference", campaign.BEST | campaign.STIFF, (0, 1, 2, 3)),
    "contact": ("contact", campaign.BEST | campaign.STIFF, (0, 2)),
    "paper": ("reference", campaign.PAPER, (0, 2)),
}


@measurement
def filtered_plate() -> Numbers:
    """q of eq:filter-transfer of the plate of the chapter, (c₁ Δt/h)² at the stable step; errors and front of the
    plates with d/40, for elements and passes, at c₁t/d = 0.56 and as means."""
    found = {"q": (shown.plate(10).explain().data["time"]["stable"] * 10) ** 2}
    for name, (scene, keys, passes) in FILTERED.items():
        for count in passes:
            own = campaign.case(scene, 40, keys | ({"output.filter": count} if count else {}))
            mean = price.times_of(own)[1]
            found[f"{name}{count}_overshoot"] = mean["overshoot"]
            if name == "paper":
                continue
            done = price.run(price.scene_of(own, price.T))
            end = price.compared(price.shown(own, done), price.T, price.plate(own))
            found[f"{name}{count}_width"] = mean["width"]
            for line in ("fig4", "fig5"):
                found[f"{name}{count}_{line}"] = mean[f"l1_{line}"]
                found[f"{name}{count}_{line}_end"] = end[f"l1_{line}"]
    return found


# -- Impact of two plates --------------------------------------------------------------------------


@measurement
def exact() -> Numbers:
    """Speeds and angle of the waves for ν = 0.3, where the fronts cross the line of Fig. 5, and one point by Cagniard's
    path: x = 0.4, z = 0.8, t = 0.56."""
    c2, c_r = ct.exact.speeds(0.3)
    x, t = 0.4, 0.56
    point = free_face.path_point(x, 0.2, t, 1.0)
    own = free_face.face(x, 0.2, t).sum(axis=0)[1]
    start, touch = ct.exact.fronts(t)["head"][0]
    late = free_face.face(x, 0.1, 1.0)[:, 1]
    return {
        "head_angle": np.degrees(np.arcsin(c2)),
        "c_r": c_r,
        "c_r_over_c2": c_r / c2,
        "fig5_p": 1 - np.sqrt(t * t - x * x),
        "fig5_head": start[1] + (touch[1] - start[1]) * (x - start[0]) / (touch[0] - start[0]),
        "p_re": point.real,
        "p_im": point.imag,
        "s_y": own,
        "sigma_z": ct.exact.plates(x, 0.8, t).stress.sigma_z,
        "late_p": late[0],
        "late_s": late[1],
    }


@measurement
def accuracy() -> Numbers:
    """From the table of the campaign: errors and cost of the paper's setting, of the same mesh at 0.98 and of the best
    buy; what a contact error is; powers of 1/h."""
    rows = drawings.load()
    paper = rows[campaign.case("reference", 100, campaign.PAPER).name]
    best = rows[campaign.case("reference", 100, campaign.BEST).name]
    buy = drawings.best_buy(rows)[1]
    found = {f"paper_{name}": paper[name] for name in ("l1_fig4", "l1_fig5", "l1_fig5_at_056")}
    for name, row in (("step", best), ("buy", buy)):
        found |= {f"{name}_fig4": row["l1_fig4"], f"{name}_fig5": row["l1_fig5"]}
        found[f"{name}_cheaper"] = 1 / row["times_paper"]
        found[f"{name}_fewer"] = paper["updates"] / row["updates"]
    found |= {"buy_cells": buy["cells"], "buy_overshoot": buy["overshoot"]}
    rho = re.search(r"integrator_parameter=([\d.]+)", buy["setting"])
    found["buy_rho"] = float(rho[1]) if rho else 0.9  # the default
    sharp = rows[campaign.case("reference", 100, campaign.SHARP).name]
    front = ("width", "overshoot", "variation_fig5", "variation_along", "variation_fig5_at_056")
    found |= {f"sharp_{name}": sharp[name] for name in front} | {"sharp_updates": sharp["cost"]}
    found |= {f"step_{name}": best[name] for name in ("overshoot", "variation_along")}
    own = rows[campaign.case("reference", 100, campaign.METHODS["default at 0.98, filtered"]).name]
    found |= {f"filtered_{key[3:]}": own[key] for key in ("l1_fig4", "l1_fig5")}
    found |= {f"filtered_{key}": own[key] for key in ("overshoot", "width")}
    found["filtered_updates"] = own["cost"]
    table = defaults.table.read(defaults.table.BOOK / "accuracy_defaults.csv")
    for name in defaults.SCENES:
        own = [row for row in table if row["scene"] == name]
        found |= {
            f"default_{name}": defaults.distances(own)[""],
            f"beaten_{name}": defaults.beaten(own),
        }
        if name == "bounces":
            found["bounces_loss"] = own[0]["error"]
    for name, keys in (("paper", campaign.PAPER), ("best", campaign.BEST)):
        cases = drawings.meshes(rows, "reference", keys)
        for column in ("updates", "l1_fig4"):
            x, y = drawings.values(rows, cases, "cells", column)
            found[f"{name}_{column}_power"] = abs(np.polyfit(np.log(x), np.log(y), 1)[0])
        found[f"{name}_contact"] = rows[campaign.case("contact", 100, keys).name]["contact_l1"]
    return found


# -- Mesh files ------------------------------------------------------------------------------------


def steps_of(nodes: np.ndarray, elements: np.ndarray) -> np.ndarray:
    """The stable step of a mesh alone, bounded by single elements and by the assembled matrix."""
    used, number = np.unique(elements, return_inverse=True)
    scene = scene_of(poisson=0.3).add_body(
        "b",
        material="elastic",
        nodes=nodes[used],
        elements=number.reshape(elements.shape).astype(np.int32),
    )
    bounds = ("elements", "assembled")
    return np.array([stable_step(scene.set_time(end=1.0, stable_step=each)) for each in bounds])


@measurement
def mesh_cost() -> Numbers:
    """The cam's wedges and a box of tetrahedra, each cell as one brick with collapsed sides, and split into three or
    four: elements, steps over that of the single elements of the first, and elements times steps of the second over
    those of the first."""
    out = Numbers()
    for name in ("cam", "tets"):
        with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(MESHES) as archive:
            raw = gmsh.read(Reading(archive.extract(f"{name}.msh", folder)))
        blocks = [each for each in raw.blocks if each.kind in SHAPES]
        whole = np.concatenate([each.nodes[:, SHAPES[each.kind]] for each in blocks])
        split = Split(raw.nodes, blocks, wedges=True)
        kept, made = steps_of(raw.nodes, whole), steps_of(split.nodes, split.elements)
        work = len(split.elements) / len(whole) * kept / made
        out |= {f"{name}_kept": len(whole), f"{name}_split": len(split.elements)}
        for i, bound in enumerate(("elements", "assembled")):
            out[f"{name}_{bound}_kept"] = kept[i] / kept[0]
            out[f"{name}_{bound}_split"] = made[i] / kept[0]
            if name == "cam":
                out[f"{name}_{bound}_work"] = work[i]
    for name in ("cam", "tets"):
        del out[f"{name}_elements_kept"]  # 1
    return out


def rounded(numbers: Numbers) -> Numbers:
    """Five digits are more than a page shows, and few enough to be the same on every machine; what is below 1e-9 is
    round-off."""
    return {name: float(f"{round(float(value), 9):.5g}") for name, value in numbers.items()}


def main() -> None:
    found = {}
    for name, function in MEASUREMENTS.items():
        print(f"  {name}", flush=True)
        found[name] = rounded(function())
    FILE.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
