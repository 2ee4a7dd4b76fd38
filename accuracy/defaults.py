"""The scenes from which the defaults of a scene were chosen: two plates, a bar on a wall, an
elastic ball on a plane (a smooth impact) and a bar that bounces 30 times (a long run). One factor
at a time is changed from the default law at 0.98 of the stable step. Each scene has its own mesh, and is
compared with its exact result. The first setting sets no key at all.
"""

from __future__ import annotations

import csv
import itertools
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

sys.path.append(str(Path(__file__).resolve().parent))
import campaign  # noqa: E402
import drawings  # noqa: E402
import price  # noqa: E402
import table  # noqa: E402
from campaign import Keys  # noqa: E402
from tqdm import tqdm  # noqa: E402

import libcontact as ct  # noqa: E402

FUNCTIONALS = ("duration", "peak", "rebound", "energy", "fig4", "fig5")
COLUMNS = ("scene", "setting", "status", "steps", "updates", "cost", "error", *FUNCTIONALS)
COLUMNS += ("growth", "balance")
FACTORS: dict[str, list[Keys]] = {
    "step": [{"time.fraction": value} for value in (0.25, 0.5, 0.7, 0.95, 1.0)],
    "integrator": [
        {"time.integrator": "chung_lee"},
        {"time.integrator": "noh_bathe"},
        *(campaign.TCHAMWA | {"time.integrator_parameter": value} for value in (0.9, 0.95, 0.98)),
    ],
    "bulk viscosity": [{"viscosity.linear": value} for value in (0.03, 0.06)],
    "β": [{"contact.beta": value} for value in (1.0, 4.0, 10.0, 100.0)],
}


# The ball's elements are finer near its six poles, where it meets the plane.
GRADING = 1.8


# Duration of Hertz's impact, in units of its depth over the speed of approach.
DURATION = 2.9432


class Answer(NamedTuple):
    """Relative errors of the functionals, and the cost of the run."""

    errors: dict[str, float]
    run: ct.Run


def settings() -> list[Keys]:
    changes = [change for found in FACTORS.values() for change in found]
    return [{}, campaign.BEST, *(campaign.over(campaign.BEST, change) for change in changes)]


def measure(name: str, keys: Keys) -> dict[str, Any]:
    """A row: relative errors of the functionals, their mean size, and the cost in updates, weighted with
    the instructions that callgrind counts for the setting."""
    row: dict[str, Any] = {column: float("nan") for column in COLUMNS}
    setting = campaign.Case(name, 0, keys).setting
    row |= {"scene": name, "setting": setting, "status": "done"}
    try:
        errors, run = SCENES[name](keys)
    except ct.Error as error:
        return row | {"status": type(error).__name__}
    updates, total = int(run.writer.state.element_updates[0]), run.energy["total"]
    scale = float(max(run.energy["kinetic"].max(), np.ptp(total)))
    weight = drawings.counts()["viscosity 0.06"] if "viscosity.linear" in keys else 1.0
    cost = updates * weight
    return (
        row
        | errors
        | {
            "steps": int(run.steps[-1]),
            "updates": updates,
            "cost": cost,
            "error": float(np.mean(np.abs([*errors.values()]))),
            "growth": float((total.max() - total[0]) / scale),
            "balance": float(np.abs(run.energy["balance"]).max() / scale),
        }
    )


def write(path: Path) -> None:
    """Compute all rows in about a minute; an existing table is not computed again."""
    if path.exists():
        return
    cases = [(name, keys) for name in SCENES for keys in settings()]
    with path.open("w", newline="", encoding="utf-8") as file:
        out = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        out.writeheader()
        for name, keys in tqdm(cases, unit="row", disable=None):
            row = measure(name, keys)
            out.writerow({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()})


def distances(rows: list[dict[str, Any]]) -> dict[str, float]:
    """
    Distance of each setting of a scene from the scene's Pareto front: the factor by which both cost and
    error must shrink until no other setting is better in both; 1 on the front, infinite if it failed.
    """
    good = [row for row in rows if row["status"] == "done"]
    out = {row["setting"]: float("inf") for row in rows}
    for row in good:
        ratios = (min(row["cost"] / one["cost"], row["error"] / one["error"]) for one in good)
        out[row["setting"]] = max(1.0, *ratios)
    return out


def beaten(rows: list[dict[str, Any]], slack: float = 1.3) -> float:
    """Error of the setting without keys over the least error of all settings that cost at most ``slack``
    times as much: 1 if none is better."""
    good = [row for row in rows if row["status"] == "done"]
    own = next(row for row in good if row["setting"] == "")
    least = min(row["error"] for row in good if row["cost"] <= slack * own["cost"])
    return float(own["error"] / least)


def far(folder: Path = table.BOOK) -> list[dict[str, str]]:
    """One line per setting with its distance from the front of each scene, sorted by the largest one."""
    rows = table.read(folder / "accuracy_defaults.csv")
    found = {name: distances([row for row in rows if row["scene"] == name]) for name in SCENES}
    lines = []
    for keys in settings():
        setting = campaign.Case("", 0, keys).setting
        values = [found[name][setting] for name in SCENES]
        line = {"setting": drawings.label(keys) or "nothing chosen"} | {
            name: f"{value:.2f}" if np.isfinite(value) else "fails"
            for name, value in zip(SCENES, values)
        }
        lines.append((max(values), line | {"worst": f"{max(values):.2f}"}))
    return [line for _, line in sorted(lines, key=lambda one: one[0])]


def laid_over(data: dict[str, Any], keys: Keys) -> ct.Scene:
    """A scene with the keys of a setting; keys of contact apply to its obstacles."""
    for name, value in keys.items():
        place, _, key = name.partition(".")
        for found in data["obstacle"] if place == "contact" else [data.setdefault(place, {})]:
            found[key] = value
    return ct.Scene(data)


def bar(example: str, axis: int, cells: int, end: float) -> dict[str, Any]:
    """A bar of the tutorials with cubes for elements; contact and step are the scene's defaults."""
    data = ct.Scene.load(ct.example(example)).data
    box = data["body"][0]["box"]
    box["cells"] = [cells if i == axis else 1 for i in range(3)]
    box["size"] = [10.0 if i == axis else 10.0 / cells for i in range(3)]
    del data["obstacle"][0]["beta"]
    data["time"], data["output"] = {"end": end}, {"every": 10**9}
    data["probe"] = [{"name": "wall", "resultant": "obstacle"}]
    return data


def impact(run: ct.Run, axis: int) -> tuple[float, float]:
    """Duration of the contact and its largest force."""
    rows = run.probes["wall"]
    pushed = np.flatnonzero(rows["force"][:, axis] > 0)
    times = rows["time"][pushed]
    return float(times[-1] - times[0] + run.dt), float(rows["force"][:, axis].max())


def bar_on_a_wall(keys: Keys) -> Answer:
    """Contact lasts 2 L / c = 2/3 with the pressure 300, and the bar leaves with the speed 10."""
    run = price.run(laid_over(bar("bar_on_a_wall", 0, 50, 1.5), keys))
    duration, peak = impact(run, 0)
    momentum = run.momentum["p"][:, 0]
    found = {
        "duration": duration / (2 / 3) - 1,
        "peak": peak / (300 * 0.2**2) - 1,
        "rebound": -momentum[-1] / momentum[0] - 1,
    }
    return Answer(found, run)


def bouncing_bar(keys: Keys) -> Answer:
    """After 30 bounces, at 15·16 L / c = 80, the bar has its initial position and energy; 5 is the height
    of the fall."""
    run = price.run(laid_over(bar("bouncing_bar", 2, 100, 80.0), keys))
    total, weight = run.energy["total"], 10.0 * 10 * 0.1**2
    return Answer({"energy": (total[-1] - total[0]) / (5 * weight)}, run)


# Corners of a brick.
CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)


def lattice(*counts: int) -> NDArray[np.float64]:
    """Corners (elements, 8, 3) of the bricks that divide the unit cube."""
    cells = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), -1).reshape(-1, 1, 3)
    return np.asarray((cells + CORNERS) / np.array(counts))


def octant(
    parts: int, layers: int, core: float = 0.45, grading: float = GRADING
) -> NDArray[np.float64]:
    """The corners (elements, 8, 3) of the octant of the unit ball with non-negative coordinates: a cube,
    and layers from three of its faces to the sphere. Edges grow with the power ``grading`` from the axes."""
    inside = [core * lattice(parts, parts, parts) ** grading]
    for axis in range(3):
        places = np.roll(lattice(layers, parts, parts), axis, axis=2)
        depth = 1 - (1 - places[..., axis : axis + 1]) ** grading
        places = places**grading
        places[..., axis] = 1.0
        angle = np.tan(0.25 * np.pi * places)
        sphere = angle / np.linalg.norm(angle, axis=2, keepdims=True)
        inside.append((1 - depth) * core * places + depth * sphere)
    return np.concatenate(inside)


def joined(corners: NDArray[np.float64]) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and elements of bricks that are given by their corners (elements, 8, 3)."""
    points = corners.reshape(-1, 3)
    _, first, numbers = np.unique(points.round(9), axis=0, return_index=True, return_inverse=True)
    return points[first], numbers.reshape(-1, 8).astype(np.int32)


def ball(parts: int = 6, layers: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and elements of the unit ball: an octant and its mirror images."""
    part, whole = octant(parts, layers), []
    for signs in itertools.product((1, -1), repeat=3):
        # The nodes of a mirrored brick are reordered, bottom and top exchanged.
        order = np.arange(8) if np.prod(signs) > 0 else np.roll(np.arange(8), 4)
        whole.append((part * signs)[:, order])
    return joined(np.concatenate(whole))


def ball_on_a_plane(keys: Keys) -> Answer:
    """Hertz's impact of a ball: the approach follows from the energy, the duration from the
    approach. The impact is quasi-static, so the ball rebounds with its initial speed."""
    nodes, elements = ball()
    stiff, mass, depth = 1 / (1 - 0.3**2), 4 * np.pi / 3, 0.04
    speed = float(np.sqrt(16 * stiff * depth**2.5 / (15 * mass)))
    duration = DURATION * depth / speed
    data: dict[str, Any] = {
        "title": "Elastic ball on a plane",
        "units": {"length": "m", "mass": "kg", "time": "s"},
        "material": [{"name": "soft", "young": 1.0, "poisson": 0.3, "density": 1.0}],
        "body": [{"name": "ball", "nodes": nodes, "elements": elements, "material": "soft"}],
        "obstacle": [
            {"surface": "ball.outer", "plane": {"point": [0, 0, -1], "normal": [0, 0, 1]}}
        ],
        "time": {"end": 1.2 * duration},
        "output": {"every": 10**9},
        "probe": [{"name": "wall", "resultant": "obstacle"}],
    }
    data["body"][0]["velocity"] = [0, 0, -speed]
    run = price.run(laid_over(data, keys))
    lasts, peak = impact(run, 2)
    momentum = run.momentum["p"][:, 2]
    found = {
        "duration": lasts / duration - 1,
        "peak": peak / (4 / 3 * stiff * depth**1.5) - 1,
        "rebound": -momentum[-1] / momentum[0] - 1,
    }
    return Answer(found, run)


def two_plates(keys: Keys) -> Answer:
    """Mean errors on the paper's two lines, that of Fig. 4 over its plateau."""
    own = campaign.Case("contact", 50, keys)
    means = price.times_of(own)[1]
    run = price.run(price.scene_of(own, price.T))
    found = {"fig4": means["l1_fig4"] / price.plate(own).plateau, "fig5": means["l1_fig5"]}
    return Answer(found, run)


SCENES: dict[str, Callable[[Keys], Answer]] = {
    "plates": two_plates,
    "bar": bar_on_a_wall,
    "ball": ball_on_a_plane,
    "bounces": bouncing_bar,
}
