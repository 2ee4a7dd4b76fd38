"""
Random bodies whose contact is between parts of their skins: ``open_scenes.py FAMILY FIRST COUNT``, FAMILY ``scenes``
or ``stiff``.

Over the border of an open surface a point suddenly lies inside. The oracle is the energy of the bodies, kinetic and
strain, not the total that contains what the contact stores: it must not exceed that of the start by more than 0.2 %.
``stiff``: closed skins, with penalty factors of 1 ... 1e6, of bodies that turn.
"""

from __future__ import annotations

import json
import sys
import warnings

import numpy as np
from libcontact.run import RunError

import libcontact as ct

ALLOWED = 0.002
AXES = "xyz"


def _body(chance: np.random.Generator, name: str, origin, size, velocity, most: int) -> dict:
    kind = str(chance.choice(["hex8", "hex8", "hex20"]))
    cells = chance.integers(1, (most if kind == "hex8" else 2) + 1, 3).tolist()
    body = {
        "name": name,
        "material": name,
        "element": kind,
        "box": {"origin": list(map(float, origin)), "size": list(map(float, size)), "cells": cells},
        "velocity": list(map(float, velocity)),
    }
    if chance.random() < 0.5:
        rate = float(chance.uniform(0.02, 0.3))
        body["spin"] = {"rate": rate, "axis": chance.normal(size=3).tolist()}
    return body


def _scene(chance: np.random.Generator, bodies: list[dict], contact: dict) -> dict:
    materials = [
        {
            "name": name,
            "young": float(10 ** chance.uniform(-0.5, 0.5)),
            "poisson": float(chance.uniform(0.0, 0.4)),
            "density": float(10 ** chance.uniform(-0.5, 0.5)),
            "law": "st_venant_kirchhoff",
        }
        for name in "ab"
    ]
    time = {"end": 1e9, "fraction": float(chance.uniform(0.3, 0.95))}
    units = {"length": "m", "mass": "kg", "time": "s"}
    return {
        "units": units,
        "material": materials,
        "body": bodies,
        "contact": [contact],
        "time": time,
        "output": {"every": 1},
    }


def open_scene(seed: int) -> tuple[dict, float]:
    """Two boxes that slide over, past or onto each other, with one side of each in contact."""
    chance = np.random.default_rng(seed)
    axis = int(chance.integers(3))
    sizes = chance.uniform(0.4, 1.6, (2, 3))
    origin = np.zeros(3)
    # The second box is above the first one, more or less beside it.
    origin[axis] = sizes[0, axis] * (1.0 + chance.choice([0.0, 0.02, 0.1, -0.05, -0.3]))
    for c in {0, 1, 2} - {axis}:
        origin[c] = chance.uniform(-1.2, 1.2) * sizes[:, c].mean()
    speed = 10 ** chance.uniform(-2.5, -0.8)
    velocity = chance.normal(size=3)
    velocity[axis] = -abs(velocity[axis])
    velocity -= 0.7 * origin * (np.arange(3) != axis)
    velocity *= speed / np.linalg.norm(velocity)
    bodies = [
        _body(chance, "a", np.zeros(3), sizes[0], np.zeros(3), 3),
        _body(chance, "b", origin, sizes[1], velocity, 3),
    ]
    contact = {"surfaces": [f"a.{AXES[axis]}_max", f"b.{AXES[axis]}_min"]}
    if chance.random() < 0.3:
        contact["points"] = "lobatto"
    scene = _scene(chance, bodies, contact)
    way = float(sizes.mean() * chance.uniform(0.5, 2.0))
    return scene, way / speed


def stiff_scene(seed: int) -> tuple[dict, float]:
    """Two closed boxes of unlike meshes that meet obliquely, with a penalty factor of 1 ... 1e6."""
    chance = np.random.default_rng(seed)
    sizes = chance.uniform(0.6, 1.4, (2, 3))
    origin = np.array([sizes[0, 0] + 0.02, *chance.uniform(-0.5, 0.5, 2)])
    velocity = np.array([-1.0, *chance.uniform(-1, 1, 2)]) * 10 ** chance.uniform(-2.0, -0.6)
    bodies = [
        _body(chance, "a", np.zeros(3), sizes[0], np.zeros(3), 4),
        _body(chance, "b", origin, sizes[1], velocity, 4),
    ]
    beta = float(10 ** chance.uniform(0.0, 6.0))
    contact = {"surfaces": ["a.outer", "b.outer"], "beta": beta}
    if chance.random() < 0.3:
        contact["points"] = "lobatto"
    return _scene(chance, bodies, contact), 2.5 / float(np.linalg.norm(velocity))


def run_scene(made: tuple[dict, float]) -> dict:
    """Run a scene; what its bodies gained, and what was told."""
    most = 6000  # steps
    data, end = made
    data["time"]["end"] = end
    told: list[str] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            scene = ct.Scene(data)
            steps = scene._built(None).step_count
            if steps > most:
                data["time"]["end"] = end * most / steps
                scene = ct.Scene(data)
            run = scene.run(progress=False, output=False)
            ended = "ok"
        except ct.SceneError as error:
            return {"ended": "refused", "text": str(error)[:200], "told": []}
        except RunError as error:
            run, ended = error.run, type(error).__name__
            told.append(str(error)[:160])
    told += [getattr(each.message, "kind", type(each.message).__name__) for each in caught]
    rows = run.energy
    own = rows["kinetic"] + rows["strain"] - rows["external"]
    first = rows["total"][0]
    return {
        "ended": ended,
        "growth": float(own.max() / first - 1.0),
        "step": float(np.diff(own).max() / first) if len(own) > 1 else 0.0,
        "booked": float(rows["total"].max() / first - 1.0),
        "end": float(own[-1] / first),
        "contact": float(rows["contact"].max() / first),
        "told": sorted(set(told)),
    }


def one(family: str, seed: int) -> dict:
    return run_scene({"scenes": open_scene, "stiff": stiff_scene}[family](seed))


def main() -> None:
    family, first, count = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    found = []
    for seed in range(first, first + count):
        got = one(family, seed) | {"seed": seed}
        found.append(got)
        print(json.dumps(got), flush=True)
    ran = [each for each in found if "growth" in each]
    grown = [each for each in ran if each["growth"] > ALLOWED]
    print(
        f"{count} {family}: {sum(e['ended'] == 'refused' for e in found)} refused, {sum(e['ended'] not in ('ok', 'refused') for e in found)} ended early, "
        f"{len(grown)} grow by more than {ALLOWED}, {sum(not e['told'] for e in grown)} of them silently, "
        f"largest {max((e['growth'] for e in ran), default=0):.3g}, in one step {max((e.get('step', 0) for e in ran), default=0):.3g}, "
        f"booked {max((e.get('booked', 0) for e in ran), default=0):.3g}, "
        f"with contact {sum(e.get('contact', 0) > 1e-3 for e in ran)}"
    )


if __name__ == "__main__":
    main()
