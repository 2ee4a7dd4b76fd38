"""
Random bodies at rigid obstacles: ``obstacle_scenes.py FAMILY FIRST COUNT``, FAMILY ``overlap`` or ``small``.

``overlap``: the body begins 1e-6 ... 0.5 of an edge inside a plane, a sphere or a cylinder. ``small``: spheres and
cylinders of 0.05 ... 5 edges hit a body at up to its wave speed. Oracles: the energy of the bodies, kinetic and strain,
never exceeds that of the start plus the work of the obstacle by more than 0.2 %; an obstacle whose path meets the body
gives it an impulse, and its centre is not inside it at the end, deeper than the penalty lets it.
"""

from __future__ import annotations

import json
import math
import sys
import warnings

import numpy as np
from libcontact.run import RunError
from libcontact.schema import SceneError

import libcontact as ct

ALLOWED = 0.002
YOUNG, POISSON, DENSITY = 1.0, 0.3, 1.0
C1 = math.sqrt(YOUNG * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON)) / DENSITY)


def unit(chance: np.random.Generator) -> np.ndarray:
    a = chance.normal(size=3)
    return a / np.linalg.norm(a)


def _body(chance: np.random.Generator, thin: bool) -> dict:
    kind = str(chance.choice(["hex8", "hex8", "hex8", "hex20"]))
    size = chance.uniform(0.5, 1.5, 3)
    cells = chance.integers(1, 5 if kind == "hex8" else 3, 3)
    if thin and chance.random() < 0.4:
        size[2], cells[2] = size[2] * chance.uniform(0.1, 0.4), chance.integers(1, 3)
    box = {"origin": (-0.5 * size).tolist(), "size": size.tolist(), "cells": cells.tolist()}
    return {"name": "b", "material": "m", "element": kind, "box": box}


def _place(
    chance: np.random.Generator, box: dict, shape: str, radius: float, apart: float
) -> tuple[dict, np.ndarray, np.ndarray]:
    """An obstacle whose surface is ``apart`` from a box at a random place; the direction to the body; and
    that place."""
    half = 0.5 * np.array(box["size"])
    where = chance.choice(["face", "edge", "corner"])
    normal = np.zeros(3)
    axes = chance.permutation(3)[: {"face": 1, "edge": 2, "corner": 3}[where]]
    normal[axes] = chance.choice([-1.0, 1.0], len(axes)) * chance.uniform(0.4, 1.0, len(axes))
    normal /= np.linalg.norm(normal)
    at = chance.uniform(-0.9, 0.9, 3) * half
    at[axes] = np.sign(normal[axes]) * half[axes]
    point = at + (radius + apart) * normal
    if shape == "plane":
        return {"point": (at + apart * normal).tolist(), "normal": (-normal).tolist()}, -normal, at
    given = {"centre": point.tolist(), "radius": radius}
    if shape == "cylinder":
        across = np.cross(normal, unit(chance))
        given["axis"] = across.tolist()
    return given, -normal, at


def overlap_scene(seed: int) -> dict:
    """A body that begins inside an obstacle."""
    chance = np.random.default_rng(seed)
    body = _body(chance, thin=False)
    edge = min(s / n for s, n in zip(body["box"]["size"], body["box"]["cells"]))
    shape = str(chance.choice(["plane", "sphere", "cylinder"]))
    depth = edge * 10 ** chance.uniform(-6, math.log10(0.5))
    radius = edge * 10 ** chance.uniform(-0.3, 0.8) if shape != "plane" else 0.0
    given, _, _ = _place(chance, body["box"], shape, radius, -depth)
    obstacle = {"surface": "b.outer", shape: given}
    if chance.random() < 0.5:
        obstacle["velocity"] = (unit(chance) * C1 * 10 ** chance.uniform(-3, -1)).tolist()
    if chance.random() < 0.3:
        body["velocity"] = (unit(chance) * C1 * 10 ** chance.uniform(-3, -1)).tolist()
    how = str(chance.choice(["keep", "keep", "keep", "remove", "refuse"]))
    obstacle["initial_penetration"] = how
    if how == "remove":
        obstacle["removal_time"] = float(chance.uniform(2, 20) * edge / C1)
    return _scene(chance, body, obstacle, float(chance.uniform(5, 40) * edge / C1))


def small_scene(seed: int) -> dict:
    """A sphere or a cylinder of any size that hits a body, at its middle, an edge or a corner."""
    chance = np.random.default_rng(seed)
    body = _body(chance, thin=True)
    edges = [s / n for s, n in zip(body["box"]["size"], body["box"]["cells"])]
    shape = str(chance.choice(["sphere", "cylinder"]))
    radius = max(edges) * 10 ** chance.uniform(math.log10(0.05), math.log10(5.0))
    given, towards, at = _place(chance, body["box"], shape, radius, 0.02 * max(edges))
    speed = C1 * 10 ** chance.uniform(-2, 0)
    aim = towards + 0.5 * chance.uniform(0, 1) * unit(chance)
    velocity = speed * aim / np.linalg.norm(aim)
    obstacle = {"surface": "b.outer", shape: given}
    if chance.random() < 0.5:
        obstacle["velocity"] = velocity.tolist()
    else:
        body["velocity"] = (-velocity).tolist()
    thick = float(min(body["box"]["size"]))
    end = float(chance.uniform(0.3, 1.5) * (thick + 0.02 * max(edges)) / speed)
    scene = _scene(chance, body, obstacle, end)
    if "velocity" in obstacle and chance.random() < 0.4:
        held = int(np.abs(at / np.array(body["box"]["size"])).argmin())
        scene["support"] = [
            {"set": f"b.{'xyz'[held]}_{side}", "fix": ["x", "y", "z"]} for side in ("min", "max")
        ]
        scene["time"]["end"] = min(end, 0.4 * thick / speed)
    return scene


def _scene(chance: np.random.Generator, body: dict, obstacle: dict, end: float) -> dict:
    material = {"name": "m", "young": YOUNG, "poisson": POISSON, "density": DENSITY}
    return {
        "units": {"length": "m", "mass": "kg", "time": "s"},
        "material": [material],
        "body": [body],
        "obstacle": [obstacle],
        "time": {"end": end, "fraction": float(chance.uniform(0.3, 0.95))},
        "output": {"every": 1, "fields": []},
    }


def growth_of(bodies: np.ndarray, contact: np.ndarray, work: np.ndarray) -> float:
    """The largest gain of the bodies over the start and the work, relative to their energy. In a step with a large
    force the product of the velocities before and after is no energy of the bodies alone; that of the contact is
    negative then (:eq:`controlled-energy`), and counts."""
    gain = float((bodies + np.minimum(contact, 0.0) - bodies[0] - work).max())
    scale = float(max(bodies.max(), np.abs(work).max()))
    return gain / scale if scale > 0.0 else 0.0


def depth_of_centre(scene: dict, built: ct.Scene, run: ct.Run) -> float:
    """How deep the centre of a sphere is inside the deformed body, relative to its radius; of a cylinder
    the deepest of many places on its axis."""
    given = scene["obstacle"][0]
    shape = given.get("sphere") or given["cylinder"]
    centre = np.array(shape["centre"])
    centre = centre + run.state.time * np.array(given.get("velocity", [0.0, 0.0, 0.0]))
    places = centre[None, :]
    if "axis" in shape:
        axis = np.array(shape["axis"]) / np.linalg.norm(shape["axis"])
        places = centre + np.linspace(-3, 3, 301)[:, None] * axis
    mesh = built._built(None).bodies["b"].mesh
    faces = mesh.faces("outer")[0]
    x = mesh.nodes + run.state["b"].displacement
    found = ct.nearest("Q4" if faces.shape[1] == 4 else "Q8", x, faces, places)
    return float(-found.signed_distance.min()) / shape["radius"]


def run_scene(scene: dict) -> dict:
    """Run a scene; what its bodies gained, and what was told."""
    told: list[str] = []
    out = {"growth": 0.0, "hit": False}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            built = ct.Scene(scene)
            run = built.run(progress=False, output=False)
            ended = "ok"
        except RunError as error:
            run, ended = error.run, f"{type(error).__name__}: {error}"
        except SceneError as error:
            run, ended = None, f"{type(error).__name__}: {error}"
    told = sorted({getattr(one.message, "kind", type(one.message).__name__) for one in caught})
    if run is not None and len(run.energy):
        energy = run.energy
        bodies = energy["kinetic"] + energy["strain"]
        out["growth"] = growth_of(bodies, energy["obstacle"], energy["external"])
        out["hit"] = bool(energy["obstacle"].any())
        if ended == "ok":
            out["deepest"] = run.penetration[0]["points"]["deepest"]
            if "plane" not in scene["obstacle"][0]:
                out["sunk"] = depth_of_centre(scene, built, run)
            out["impulse"] = float(np.linalg.norm(run.impulse["obstacle"]))
    return {"ended": ended, "told": told, **out}


def one(family: str, seed: int) -> dict:
    """Run one case of a family."""
    scene = overlap_scene(seed) if family == "overlap" else small_scene(seed)
    found = run_scene(scene)
    if family == "overlap":
        how = scene["obstacle"][0]["initial_penetration"]
        still = "velocity" not in scene["obstacle"][0] and "velocity" not in scene["body"][0]
        found["refused"] = how == "refuse" and "inside at the start" in found["ended"]
        found["still"] = how == "keep" and still
    return found


def main() -> None:
    family, first, count = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    worst, grew, ends = 0.0, [], {}
    for seed in range(first, first + count):
        found = one(family, seed)
        worst = max(worst, found["growth"])
        name = found["ended"].split(":")[0]
        ends[name] = ends.get(name, 0) + 1
        bad = found["growth"] > ALLOWED or (found["ended"] != "ok" and not found.get("refused"))
        bad |= family == "small" and found["ended"] == "ok" and not found["hit"]
        bad |= family == "small" and found.get("sunk", 0.0) > 0.0
        if bad:
            grew.append(seed)
            print(seed, json.dumps(found, default=str)[:600], flush=True)
    print(f"{family}: {count} from {first}, worst growth {worst:.2e}, to look at {grew}, {ends}")


if __name__ == "__main__":
    main()
