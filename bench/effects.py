"""
The cost of each effect, predicted before a run and measured in it. The scenes are the plate impact,
three others, one with all effects, and two for which the prediction was not tuned: a bouncing bar and a
ring that is thrown against a wall. Predictions and measurements are minima of repeated trials and runs,
which alternate.
"""

from __future__ import annotations

import tomllib
import warnings
from pathlib import Path

import libcontact as ct

SCENES = Path(__file__).parent.parent / "tutorials" / "scenes"
REPEATS = 3


def everything() -> ct.Scene:
    """A block at rest on a floor, with all effects that can act on it, and another one that falls on it."""
    scene = ct.Scene(title="everything", units={"length": "m", "mass": "kg", "time": "s"})
    scene.add_material("stone", young=1e7, poisson=0.25, density=1000)
    block = {"origin": [0, 0, 0], "size": [1, 1, 1], "cells": [20, 20, 20]}
    lid = {"origin": [0.2, 0.2, 1.0], "size": [0.6, 0.6, 0.3], "cells": [12, 12, 6]}
    scene.add_body("block", material="stone", box=block, velocity=[0.2, 0, 0])
    scene.add_body("lid", material="stone", box=lid, velocity=[0, 0, -1])
    scene.add_contact("block.z_max", "lid.z_min", friction=0.2)
    scene.add(
        "obstacle",
        surface="block.z_min",
        plane={"point": [0, 0, 0], "normal": [0, 0, 1]},
        friction=0.3,
    )
    scene.add("gravity", acceleration=[0, 0, -10]).add("damping", rate=1.0).add(
        "viscosity", linear=0.06, quadratic=1.2
    )
    scene.add("load", surface="lid.z_max", pressure=1e3).add("absorb", surface="block.x_max")
    return scene.set_time(end=0.05, fraction=0.9).set_output(every=100)


def ring_on_a_wall() -> ct.Scene:
    """A soft spinning ring that hits a rough wall, sticks, is flattened and rebounds."""
    scene = ct.Scene(title="ring on a wall", units={"length": "m", "mass": "kg", "time": "s"})
    scene.add_material("rubber", young=1e6, poisson=0.3, density=1000, law="neo_hookean")
    scene.add_body(
        "ring",
        material="rubber",
        ring={"centre": [0, 0, 0], "radius": [0.8, 1.0], "width": 0.2, "cells": [4, 96, 3]},
        velocity=[-4, 0, 0],
        spin={"axis": [0, 0, 1], "rate": 3.0},
    )
    scene.add(
        "obstacle",
        surface="ring.outer",
        plane={"point": [-1.05, 0, 0], "normal": [1, 0, 0]},
        friction=0.3,
    )
    return scene.set_time(end=0.3, fraction=0.8).set_output(every=100)


def scenes() -> dict[str, ct.Scene]:
    made = {}
    for name in ("plates", "block_on_an_incline", "hertz", "bar_on_a_wall", "bouncing_bar"):
        data = tomllib.loads((SCENES / f"{name}.toml").read_text(encoding="utf-8"))
        data.get("output", {}).pop("file", None)
        made[name] = ct.Scene(data)
    return made | {"ring_on_a_wall": ring_on_a_wall(), "everything": everything()}


def measure() -> dict:
    result = {}
    for name, scene in scenes().items():
        predicted, measured, steps = [], [], 0
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            for _ in range(REPEATS):
                run = scene.run(progress=False, output=False)
                costs = scene.costs(run)
                predicted.append({cost.name: cost.predicted for cost in costs})
                measured.append({cost.name: cost.measured for cost in costs})
                steps = int(run.steps[-1])
        parts = {
            part: {
                key: min(row[part] for row in rows)
                for key, rows in (("predicted", predicted), ("measured", measured))
            }
            for part in predicted[0]
        }
        result[name] = {"steps": steps, "parts": parts}
        parts = result[name]["parts"].values()
        result[name]["together"] = {
            key: sum(part[key] for part in parts) for key in ("predicted", "measured")
        }
    return result


def report(result: dict) -> str:
    lines = [
        f"{'scene':<22}{'part':<14}{'predicted':>12}{'measured':>12}{'ratio':>8}{'of the run':>12}"
    ]
    for scene, row in result.items():
        whole = row["together"]["measured"]
        for part, cost in [*row["parts"].items(), ("together", row["together"])]:
            ratio = cost["predicted"] / cost["measured"] if cost["measured"] else float("nan")
            times = f"{1e3 * cost['predicted']:>9.3g} ms{1e3 * cost['measured']:>9.3g} ms"
            lines.append(
                f"{scene:<22}{part:<14}{times}{ratio:>8.2f}{cost['measured'] / whole:>12.1%}"
            )
            scene = ""
    return "\n".join(lines)


if __name__ == "__main__":
    print(report(measure()))
