"""Scenes of the benchmarks, their runs and what these cost."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np

import libcontact as ct

FOLDER = Path(__file__).resolve().parents[1]
Numbers = dict[str, float]


def load(name: str) -> dict[str, Any]:
    """The tables of a scene of this folder or of the tutorials."""
    own = FOLDER / f"{name}.toml"
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
