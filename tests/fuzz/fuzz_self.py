"""
Random scenes in which a body meets itself: ``fuzz_self.py COUNT SEED``.

Each scene has one body with a fold, a gap or a thin wall, and something that closes it fast: a spin, a
speed of its ends, a block that falls on it. A run must come to its end, or end with a fault that the
scene deserves (an inverted element, energy that a law for small strains invents); it must not end or
divide its step because of an approach of surfaces that its motion does not have.
"""

from __future__ import annotations

import math
import random
import sys
import time
import warnings

import numpy as np
from libcontact.mesh import Mesh
from libcontact.run import EnergyBlowup, InvertedElement, NotFinite, StepTooLarge

import libcontact as ct

C = math.sqrt(1.0 * 0.7 / (1.3 * 0.4))  # speed of pressure waves, ν = 0.3


def folded(nodes: np.ndarray, leg: float, thick: float, gap: float) -> np.ndarray:
    """A box of unit length and height, as a strip of two legs along x, one above the other, and half a ring between
    them."""
    s, y, t = nodes.T
    middle = 0.5 * (thick + gap)
    arc = middle * math.pi
    along, off = (2 * leg + arc) * s, thick * (t - 0.5)  # off > 0 is the inner side
    angle = np.clip((along - leg) / middle, 0.0, math.pi)
    straight = np.where(along < leg, along, np.where(along > leg + arc, 2 * leg + arc - along, leg))
    radius = middle - off
    return np.stack([straight + radius * np.sin(angle), y, -radius * np.cos(angle)], -1)


def hairpin(chance: random.Random, kind: str) -> tuple:
    """A folded strip, whose tips move towards each other or past each other."""
    thick, gap, leg = chance.uniform(0.05, 0.2), chance.uniform(0.02, 0.2), chance.uniform(0.4, 1.0)
    mesh = Mesh.box(
        kind,
        (0, 0, 0),
        (1, 0.2, 1),
        (chance.randint(8, 20), chance.randint(1, 2), chance.randint(1, 2)),
    )
    return folded(mesh.nodes, leg, thick, gap), mesh.elements, gap


def ring(chance: random.Random, kind: str) -> tuple:
    """A ring with a gap, a C, or a spiral of more than one turn."""
    thick, turns = chance.uniform(0.05, 0.15), chance.choice([0.9, 0.95, 1.0, 1.6])
    pitch = 0.0 if turns < 1.0 else thick * chance.uniform(1.3, 2.0)
    mesh = Mesh.box(
        kind,
        (0, 0, 0),
        (1, 1, 1),
        (chance.randint(12, 28), chance.randint(1, 2), chance.randint(1, 2)),
    )
    s, y, t = mesh.nodes.T
    angle = 2 * math.pi * turns * s
    radius = 0.5 + thick * (0.5 - t) + pitch * turns * s
    nodes = np.stack([radius * np.sin(angle), 0.2 * y, -radius * np.cos(angle)], -1)
    return nodes, mesh.elements, max(pitch - thick, 0.1 * math.pi * (1.0 - turns) + 0.02)


def zigzag(chance: random.Random, kind: str) -> tuple:
    """An accordion of smooth folds."""
    folds, wave = chance.randint(2, 3), chance.uniform(0.05, 0.3)
    # Thinner than the radius of the folds.
    thick = min(chance.uniform(0.03, 0.08), 0.36 / (wave * (math.pi * folds) ** 2))
    mesh = Mesh.box(kind, (0, 0, 0), (1, 1, 1), (8 * folds, chance.randint(1, 2), 1))
    s, y, t = mesh.nodes.T
    slope = wave * math.pi * folds * np.cos(math.pi * folds * s)
    length = np.sqrt(0.36 + slope**2)
    z, off = wave * np.sin(math.pi * folds * s), thick * (t - 0.5)
    nodes = np.stack([0.6 * s - slope / length * off, 0.2 * y, z + 0.6 / length * off], -1)
    return nodes, mesh.elements, 0.3 / folds


def plate(chance: random.Random, kind: str) -> tuple:
    """A thin plate: its two sides must not take each other for a contact."""
    thick, n = chance.uniform(0.01, 0.2), chance.randint(2, 8)
    mesh = Mesh.box(
        kind, (0, 0, 0), (1, chance.uniform(0.3, 1.0), thick), (n, chance.randint(1, n), 1)
    )
    return mesh.nodes, mesh.elements, thick


def slot(chance: random.Random, kind: str) -> tuple:
    """A block with a slot: elements of a box are left out."""
    n, m = chance.randint(4, 8), chance.randint(3, 5)
    mesh = Mesh.box(kind, (0, 0, 0), (1, 0.3, 0.5), (n, 1, m))
    x, _, z = mesh.centres().T
    row = chance.randint(1, m - 2)
    out = (np.floor(z / 0.5 * m) == row) & (x < chance.uniform(0.4, 0.8))
    used, elements = np.unique(mesh.elements[~out], return_inverse=True)
    return mesh.nodes[used], elements.reshape(-1, mesh.elements.shape[1]).astype(np.int32), 0.5 / m


FAMILIES = {"hairpin": hairpin, "ring": ring, "zigzag": zigzag, "plate": plate, "slot": slot}


def scene(seed: int) -> tuple[ct.Scene, str]:
    """A random scene and a line about it."""
    chance = random.Random(seed)
    family = chance.choice(list(FAMILIES))
    kind = "hex20" if chance.random() < 0.15 else "hex8"
    nodes, elements, gap = FAMILIES[family](chance, kind)
    motion = chance.choice(["spin", "spin", "squeeze", "squeeze", "block", "free"])
    laws = ["linear", "neo_hookean", "neo_hookean", "st_venant_kirchhoff"]
    law = chance.choice(laws[motion == "spin" :])
    speed = C * 10 ** chance.uniform(-2.0, -0.5)
    size = float(np.ptp(nodes, axis=0).max())
    end = min(max(2.0 * gap / speed, 0.5 * size / C), 4.0 * size / C)
    out = ct.Scene(units={"length": "m", "mass": "kg", "time": "s"})
    out.add_material("m", young=1.0, poisson=0.3, density=1.0, law=law)
    given: dict = {"nodes": nodes, "elements": elements, "material": "m"}
    if motion == "spin":
        axis = [chance.gauss(0, 1) for _ in range(3)]
        given["spin"] = {"axis": axis, "rate": speed / (0.5 * size)}
        given["velocity"] = [chance.gauss(0, speed) for _ in range(3)]
    elif motion == "free":
        given["velocity"] = [chance.gauss(0, speed) for _ in range(3)]
    out.add_body("u", **given)
    out.add_contact(
        "u.outer",
        "u.outer",
        **({"beta": 10 ** chance.uniform(-0.5, 1.5)} if chance.random() < 0.3 else {}),
    )
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    if motion in ("block", "squeeze"):
        # One block from above, or two that come from both sides.
        for name, z, v in (("top", high[2] + 0.01, -speed), ("base", low[2] - 0.11, speed))[
            : 1 + (motion == "squeeze")
        ]:
            box = {
                "origin": [low[0] - 0.03, low[1] - 0.05, z],
                "size": [size * chance.uniform(0.3, 1.0), 0.4, 0.1],
                "cells": [3, 2, 1],
            }
            out.add_body(name, material="m", box=box, velocity=[0, 0, v])
            out.add_contact(f"{name}.outer", "u.outer")
    out.set_time(end=end, fraction=chance.choice([0.3, 0.6, 0.9]))
    return out, f"{family} {kind} {law} {motion} v = {speed / C:.2g} c"


def run(seed: int) -> tuple[str, str, int]:
    """How a scene ends, what it is, and how often it divided its step."""
    made, about = scene(seed)
    try:
        done = made.run(progress=False, output=False)
    except StepTooLarge as fault:
        return "StepTooLarge", f"{about}: {fault}", 0
    except (InvertedElement, NotFinite, EnergyBlowup) as fault:
        return type(fault).__name__, f"{about}: {fault}", len(getattr(fault.run, "divisions", ()))
    text = "".join(f" {time:.3g}/{parts}" for time, parts in getattr(done, "divisions", ()))
    return "end", about + text, len(getattr(done, "divisions", ()))


def main(count: int, seed: int) -> None:
    warnings.simplefilter("ignore")
    if hasattr(ct, "StepDivided"):
        warnings.simplefilter("always", ct.StepDivided)
    told: dict[str, int] = {}
    for k in range(seed, seed + count):
        begin = time.perf_counter()
        kind, text, divided = run(k)
        took = time.perf_counter() - begin
        for name in (kind, *["divided"] * bool(divided)):
            told[name] = told.get(name, 0) + 1
        if kind != "end" or divided or took > 20:
            print(k, kind, text, f"{took:.1f} s", flush=True)
    print(told)


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
