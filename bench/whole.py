"""
The time of a whole run in its parts (process start, set-up, solid, contact and obstacle, time loop,
records, file) for two plates, a block and a general mesh; growth of time and memory with the number of
elements; and speed-up by a second thread.

``python whole.py SCENE CELLS STEPS THREADS`` runs one scene in a process of its own and prints one JSON
object. With 0 threads it is the run of a user: one thread, sleeping elements, and a second run for the
cost of the file. Otherwise all elements are active, so that the work of a step depends on the size alone.
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
SCENES = {
    "plates": "two plates, 2 x 100 x 100",
    "block": "block, 100 x 100 x 100",
    "general": "distorted block, 60 x 60 x 60",
}
CELLS = {"plates": 100, "block": 100, "general": 60}
STEPS, THREAD_STEPS = 100, 40
RUNS = 3
# Elements along an edge (10^4 to 10^7 in all), steps, and runs; the fastest run counts.
GROWTH = {22: (200, 5), 46: (100, 5), 100: (20, 3), 215: (20, 1)}
PARTS = ("start", "set-up", "solid", "contact and obstacle", "time loop", "records", "file", "rest")


def all_active(scene: Any) -> Any:
    """The scene with all elements active from its start."""
    from libcontact.model import SAVINGS

    return type(scene)(
        scene.data | {"run": {"savings": [name for name in SAVINGS if name != "quiet"]}}
    )


def scene_of(name: str, cells: int, steps: int) -> Any:
    """A scene by its name, with a record every tenth of the run."""
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
    # About ``steps`` steps: c1 is 6020 km/s, and the stable step about h / c1.
    return scene.set_time(end=0.9 * steps / cells / 6.02e6, fraction=0.9)


def brick(cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and elements of a unit cube, distorted inside by up to a quarter of an element."""
    from libcontact.mesh import Mesh

    mesh = Mesh.box("hex8", [0, 0, 0], [cells] * 3, [cells] * 3)
    inside = np.sin(np.pi * mesh.nodes / cells).prod(axis=1, keepdims=True)
    moved = mesh.nodes + 0.25 * inside * np.sin(2.0 * mesh.nodes[:, [1, 2, 0]])
    return moved / cells, mesh.elements


def one(name: str, cells: int, steps: int, threads: int) -> dict[str, Any]:
    """The parts of one run [s], its memory in addition to the imports [bytes], and its counts."""
    import libcontact as ct

    assert ct.Scene  # names are imported on first use
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    start = time.perf_counter() - STARTED
    began = time.perf_counter()
    scene = scene_of(name, cells, steps)
    run = (all_active(scene) if threads else scene).run(
        progress=False, output=False, threads=threads or 1
    )
    whole = time.perf_counter() - began
    peak = 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
    costs, elements, file = run.costs, 2 * cells**2 if name == "plates" else cells**3, 0.0
    if not threads:
        with tempfile.TemporaryDirectory() as folder:
            again = scene.run(progress=False, output=Path(folder) / "run.vtkhdf")
            file = max(again.costs["output"] - costs["output"], 0.0)
    contact = sum(v for k, v in costs.items() if k in ("contact", "obstacle"))
    parts = {
        "start": start,
        "set-up": whole - run.seconds,
        "solid": costs["solid"],
        "contact and obstacle": contact,
        "time loop": costs["time loop"],
        "records": costs["output"],
        "file": file,
    }
    parts["rest"] = max(run.seconds - sum(costs.values()), 0.0)
    taken = int(run.steps[-1])
    return {"elements": elements, "steps": taken, "rows": len(run.steps), "memory": peak} | parts


def alone(name: str, cells: int, steps: int, threads: int) -> dict[str, Any]:
    """One run in a process of its own."""
    command = [sys.executable, __file__, name, str(cells), str(steps), str(threads)]
    return dict(json.loads(subprocess.run(command, check=True, capture_output=True).stdout))


def step_of(row: dict[str, Any]) -> float:
    """Seconds of a time step."""
    return sum(row[part] for part in ("solid", "contact and obstacle", "time loop")) / row["steps"]


def fastest(runs: int, name: str, cells: int, steps: int, threads: int) -> dict[str, Any]:
    """The fastest time of each part in several runs, and the least memory."""
    rows = [alone(name, cells, steps, threads) for _ in range(runs)]
    return {key: min(row[key] for row in rows) for key in rows[0]}


def total(row: dict[str, Any]) -> float:
    """Seconds of a whole run."""
    return float(sum(row[part] for part in PARTS))


def label(name: str, row: dict[str, Any]) -> str:
    return f"{SCENES[name]}, {row['steps']} steps, {row['rows']} records, {total(row):.2f} s"


def exponent(rows: list[dict[str, Any]], values: list[float]) -> float:
    """The slope of values over elements, both as logarithms."""
    return float(np.polyfit(np.log([row["elements"] for row in rows]), np.log(values), 1)[0])


def measure() -> dict[str, Any]:
    scenes = {name: fastest(RUNS, name, cells, STEPS, 0) for name, cells in CELLS.items()}
    growth = [fastest(runs, "block", cells, steps, 1) for cells, (steps, runs) in GROWTH.items()]
    threads = {
        name: [step_of(fastest(RUNS, name, cells, THREAD_STEPS, n)) for n in (1, 2)]
        for name, cells in CELLS.items()
    }
    return {
        "scenes": scenes,
        "growth": growth,
        "exponents": {
            "set-up": exponent(growth, [row["set-up"] for row in growth]),
            "step": exponent(growth, [step_of(row) for row in growth]),
            "memory": exponent(growth, [row["memory"] for row in growth]),
        },
        "threads": threads,
    }


def report(result: dict[str, Any]) -> str:
    lines = ["a whole run, in per cent:"]
    for name, row in result["scenes"].items():
        parts = ", ".join(f"{part} {100 * row[part] / total(row):.0f}" for part in PARTS)
        lines.append(f"  {label(name, row)}: {parts}")
    lines.append(
        "growth of a block: elements, set-up in steps, ns per step and element, bytes per element"
    )
    for row in result["growth"]:
        n, step = row["elements"], step_of(row)
        lines.append(
            f"  {n:9d} {row['set-up'] / step:6.1f} {1e9 * step / n:6.1f} {row['memory'] / n:6.0f}"
        )
    powers = ", ".join(f"{name} {value:.2f}" for name, value in result["exponents"].items())
    lines.append(f"  exponents: {powers}")
    lines.append("one thread, two threads, ms per step with all elements active, and the ratio:")
    for name, (first, second) in result["threads"].items():
        lines.append(
            f"  {SCENES[name]}: {1e3 * first:.2f}, {1e3 * second:.2f}, {first / second:.2f} times"
        )
    return "\n".join(lines)


if __name__ == "__main__":
    print(json.dumps(one(sys.argv[1], *map(int, sys.argv[2:5]))))
