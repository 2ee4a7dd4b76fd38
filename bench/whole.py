"""
What a user waits for: a whole run in its parts (process start, set-up, solid, contact, time loop, records, file) for two plates, a block and a general mesh, the same plate in other codes beside it, and how time and memory grow with the number of elements.

``python whole.py SCENE CELLS STEPS`` runs one scene in a process of its own and prints one JSON object.
"""

from __future__ import annotations

import time

STARTED = time.perf_counter()

import json  # noqa: E402
import resource  # noqa: E402
import subprocess  # noqa: E402
import sys  # noqa: E402
import tempfile  # noqa: E402
from pathlib import Path  # noqa: E402
from typing import Any  # noqa: E402

import numpy as np  # noqa: E402

HERE = Path(__file__).parent
RUNS = 3
SCENES = {
    "plates": "two plates, 2 x 100 x 100",
    "block": "block, 100 x 100 x 100",
    "general": "distorted block, 60 x 60 x 60",
}
CELLS = {"plates": 100, "block": 100, "general": 60}
STEPS = 100
GROWTH = (22, 46, 100, 215)  # elements along an edge: 10^4 to 10^7
PARTS = ("start", "set-up", "solid", "contact", "time loop", "records", "file", "rest")


def scene_of(name: str, cells: int, steps: int) -> Any:
    """A scene by its name, with a ledger row every tenth of the run."""
    import libcontact as ct

    if name == "plates":
        data = ct.Scene.load(HERE.parent / "tutorials" / "scenes" / "plates.toml").data
        data["contact"] = [{"surfaces": ["left.x_max", "right.x_min"]}]
        data["time"] = {"end_c1t_over": {"length": 2.5, "value": 0.56}, "fraction": 0.98}
        return ct.Scene(data | {"output": {"fields": []}})
    scene = ct.Scene(title=name, units={"length": "mm", "mass": "t", "time": "s"})
    scene.add_material("steel", young=2.1e5, poisson=0.3, density=7.8e-9)
    shape: dict[str, Any] = {"box": {"origin": [0, 0, 0], "size": [1, 1, 1], "cells": [cells] * 3}}
    if name == "general":
        nodes, elements = brick(cells)
        shape = {"nodes": nodes, "elements": elements}
    scene.add_body("body", material="steel", velocity=[-1000.0, 0, 0], **shape)
    scene.add("obstacle", surface="body.x_min", plane={"point": [0, 0, 0], "normal": [1, 0, 0]})
    scene.set_output(fields=[], every=max(steps // 10, 1))
    # About so many steps: c1 is 6020 km/s, and the stable step about h / c1.
    return scene.set_time(end=0.9 * steps / cells / 6.02e6, fraction=0.9)


def brick(cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and elements of a unit cube, bent inside by up to a quarter of an element."""
    x = np.stack(np.meshgrid(*[np.arange(cells + 1.0)] * 3, indexing="ij"), -1).reshape(-1, 3)
    inside = np.sin(np.pi * x / cells).prod(axis=1, keepdims=True)
    number = np.arange(len(x)).reshape([cells + 1] * 3)
    near = [slice(None, -1), slice(1, None)]
    corner = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    corner += [(i, j, 1) for i, j, _ in corner]
    elements = np.stack([number[near[i], near[j], near[k]].ravel() for i, j, k in corner], -1)
    return (x + 0.25 * inside * np.sin(2.0 * x[:, [1, 2, 0]])) / cells, elements


def one(name: str, cells: int, steps: int) -> dict[str, Any]:
    """The parts of one run [s], the memory that it took above the imports [bytes], and its counts."""
    import libcontact as ct

    assert ct.Scene  # names are imported when they are asked for
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    start = time.perf_counter() - STARTED
    began = time.perf_counter()
    run = (scene := scene_of(name, cells, steps)).run(progress=False, output=False)
    whole = time.perf_counter() - began
    peak = 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
    with tempfile.TemporaryDirectory() as folder:
        again = scene.run(progress=False, output=Path(folder) / "run.vtkhdf")
    costs, elements = run.costs, 2 * cells**2 if name == "plates" else cells**3
    contact = sum(v for k, v in costs.items() if k in ("contact", "obstacle"))
    parts = {
        "start": start,
        "set-up": whole - run.seconds,
        "solid": costs["solid"],
        "contact": contact,
        "time loop": costs["time loop"],
        "records": costs["output"],
        "file": max(again.costs["output"] - costs["output"], 0.0),
    }
    parts["rest"] = max(run.seconds - sum(costs.values()), 0.0)
    taken = int(run.steps[-1])
    return {"elements": elements, "steps": taken, "rows": len(run.steps), "memory": peak} | parts


def alone(name: str, cells: int, steps: int) -> dict[str, Any]:
    """One run in a process of its own."""
    command = [sys.executable, __file__, name, str(cells), str(steps)]
    return dict(json.loads(subprocess.run(command, check=True, capture_output=True).stdout))


def step_of(row: dict[str, Any]) -> float:
    """Seconds of a time step."""
    return sum(row[part] for part in ("solid", "contact", "time loop")) / row["steps"]


def total(row: dict[str, Any]) -> float:
    """Seconds of a whole run."""
    return float(sum(row[part] for part in PARTS))


def label(name: str, row: dict[str, Any]) -> str:
    return f"{SCENES[name]}, {row['steps']} steps, {row['rows']} records, {total(row):.2f} s"


def exponent(rows: list[dict[str, Any]], values: list[float]) -> float:
    """The slope of values over elements, both as logarithms."""
    return float(np.polyfit(np.log([row["elements"] for row in rows]), np.log(values), 1)[0])


def measure() -> dict[str, Any]:
    from plates import peer

    scenes = {}
    for name, cells in CELLS.items():
        runs = [alone(name, cells, STEPS) for _ in range(RUNS)]
        scenes[name] = min(runs, key=total)
    growth = [alone("block", cells, 20) for cells in GROWTH]
    return {
        "scenes": scenes,
        "growth": growth,
        "exponents": {
            "set-up": exponent(growth, [row["set-up"] for row in growth]),
            "step": exponent(growth, [step_of(row) for row in growth]),
            "memory": exponent(growth, [row["memory"] for row in growth]),
        },
        "peers": {code: peer(code, STEPS) for code in ("scipy", "akantu")},
    }


def report(result: dict[str, Any]) -> str:
    lines = ["a whole run, in per cent:"]
    for name, row in result["scenes"].items():
        parts = ", ".join(f"{part} {100 * row[part] / total(row):.0f}" for part in PARTS)
        lines.append(f"  {label(name, row)}: {parts}")
    lines.append(
        "growth of a block: elements, set-up in steps, ns a step and element, bytes an element"
    )
    for row in result["growth"]:
        n, step = row["elements"], step_of(row)
        lines.append(
            f"  {n:9d} {row['set-up'] / step:6.1f} {1e9 * step / n:6.1f} {row['memory'] / n:6.0f}"
        )
    powers = ", ".join(f"{name} {value:.2f}" for name, value in result["exponents"].items())
    lines.append(f"  exponents: {powers}")
    for code, row in result["peers"].items():
        lines.append(
            f"  {code}, one plate: set-up {row['setup']:.2f} s, {1e9 * row['us_per_update'] / 1e3:.0f} ns a step and element"
            if row
            else f"  {code}: not installed here"
        )
    return "\n".join(lines)


def draw(result: dict[str, Any], path: Path) -> None:
    import matplotlib.pyplot as plt

    fig, (left, right) = plt.subplots(
        1, 2, figsize=(12, 4.2), layout="constrained", width_ratios=[3, 2]
    )
    names, rows = list(result["scenes"]), list(result["scenes"].values())
    base = np.zeros(len(rows))
    for part in PARTS:
        values = np.array([100 * row[part] / total(row) for row in rows])
        ticks = [label(name, row).replace(", ", "\n") for name, row in zip(names, rows)]
        left.barh(ticks, values, left=base, label=part)
        base += values
    left.set(xlabel="% of the whole run", title="Where the time goes", xlim=(0, 100))
    left.invert_yaxis()
    left.legend(ncols=4, loc="upper center", bbox_to_anchor=(0.5, -0.18), frameon=False)
    growth = result["growth"]
    n = np.array([row["elements"] for row in growth])
    for what, values in (
        ("set-up [s]", [row["set-up"] for row in growth]),
        ("step [s]", [step_of(row) for row in growth]),
        ("memory [GB]", [row["memory"] / 1e9 for row in growth]),
    ):
        power = result["exponents"][what.split(" [")[0]]
        right.loglog(n, values, "o-", label=f"{what}, grows like $N^{{{power:.2f}}}$")
    right.set(xlabel="elements of a block", title="How it grows")
    right.legend()
    right.grid(alpha=0.3)
    fig.savefig(path, dpi=150)
    plt.close(fig)


if __name__ == "__main__":
    print(json.dumps(one(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))))
