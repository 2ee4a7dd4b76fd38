"""Blocks that turn, slide, settle or pass a pulse on, and two discs."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import rigid

from .runs import Numbers, done, load, updates

# -- Rotation --------------------------------------------------------------------------------------


def first_flip(t: Any, rate: Any) -> float:
    """When the rate about the middle axis passes zero for the first time."""
    i = int(np.flatnonzero(rate[:-1] * rate[1:] < 0)[0])
    return float(t[i] - rate[i] * (t[i + 1] - t[i]) / (rate[i + 1] - rate[i]))


def flip_of_euler(cells: Any = None) -> float:
    """By Euler's equations, with the inertia of the lumped masses (eq:lumped-inertia) or, without cells, of the solid
    box."""
    t = np.linspace(0, 40, 8001)
    factor = 1.0 if cells is None else 1 + 2 / np.array(cells) ** 2
    return first_flip(t, rigid.euler(rigid.inertia(factor), t))


def flip_of_box(k: int) -> tuple[float, float, float]:
    """First flip of a box of 3k × 2k × k bricks, computed and by Euler's equations with its lumped inertia; cost."""
    data = load("tumbling_box")
    cells = data["body"][0]["box"]["cells"] = [3 * k, 2 * k, k]
    run = done(data)
    t, rates = rigid.rates(run)
    return first_flip(t, rates[:, 1]), flip_of_euler(cells), updates(run)


def tumbling_box() -> Numbers:
    """The box on three meshes."""
    found = {"solid": flip_of_euler()}
    for k in (1, 2, 4):
        found[f"flip_{k}"], found[f"euler_{k}"], found["updates"] = flip_of_box(k)
    return found


# -- Friction --------------------------------------------------------------------------------------


def newmark(friction: float, push: float, gravity: float, time: float) -> float:
    """Displacement of Newmark's block under a rectangular pulse."""
    speed = push * time
    return speed**2 / (2 * friction * gravity) * (1 - friction * gravity / push)


def slide(young: float) -> tuple[float, float]:
    """Displacement of the block with this modulus, of which the ratio of damping is the scene's; cost."""
    data = load("sliding_block")
    data["material"][0]["young"] = young
    data["damping"]["stiffness"] = 1e-3 * math.sqrt(1e4 / young)
    run = done(data)
    return float(run.probes["block"]["displacement"][-1, 0]), updates(run)


def sliding_block() -> Numbers:
    """The closed form and three stiffnesses."""
    found = {"exact": newmark(0.3, 6.0, 10.0, 0.5)}
    for power in (4, 5, 6):
        found[f"e{power}"], found["updates"] = slide(10.0**power)
    return found


# -- Other programs, unlike meshes -----------------------------------------------------------------


def settlement() -> Numbers:
    """MOOSE's case: largest strain energy and its time, largest force after the first impact, both at the end."""
    run = done(load("settlement"))
    strain, rows = run.energy["strain"], run.probes["force"]
    first = int(np.argmax(strain))
    return {
        "peak": strain[first],
        "peak_time": run.energy["time"][first],
        "force": rows["force"][rows["time"] > 0.003, 2].max(),
        "late_energy": strain[-1],
        "late_force": rows["force"][-1, 2],
        "updates": updates(run),
    }


def pulse_left(left: int, right: int) -> tuple[float, float]:
    """Largest velocity that a pulse leaves in the column that it came through, over the largest in the other one;
    cost."""
    data = load("unlike_pulse")
    for body, n in zip(data["body"], (left, right)):
        body["box"]["cells"] = [6 * n, n, n]
    run = done(data)
    left_over, through = (np.abs(run.state[name].velocity[:, 0]).max() for name in run.bodies)
    return float(left_over / through), updates(run)


def pulse_in_one(n: int) -> float:
    """The same in one column without a contact: what the mesh leaves behind."""
    data = load("unlike_pulse")
    del data["contact"]
    data["body"] = data["body"][:1]
    data["body"][0]["box"] = {"origin": [-6, 0, 0], "size": [12, 1, 1], "cells": [12 * n, n, n]}
    column = done(data).state["left"]
    moves, x = np.abs(column.velocity[:, 0]), column.nodes[:, 0]
    return float(moves[x < 0].max() / moves[x > 0].max())


PAIRS = ((4, 4), (4, 6), (8, 8), (8, 11))


def unlike_pulse() -> Numbers:
    """One column, like and unlike meshes."""
    found = {f"one_{n}": pulse_in_one(n) for n in (4, 8)}
    for n, m in PAIRS:
        found[f"left_{n}_{m}"], found["updates"] = pulse_left(n, m)
    return found


# -- Discs -----------------------------------------------------------------------------------------


def discs() -> Numbers:
    """NimbleSM's thin_plate_contact: mean velocities of both discs after the impact, on three meshes."""
    found = {}
    for n in (2, 3, 4):
        data = load("discs")
        for body in data["body"]:
            body["cylinder"]["cells"] = [2 * n, 16 * n, n]
        run = done(data)
        small = run.body_momentum("small")["p"][0, 2] / -100
        for name, mass in (("small", small), ("large", small / 0.9**2)):
            found[f"{name}_{n}"] = run.body_momentum(name)["p"][-1, 2] / mass
        found[f"kinetic_{n}"] = run.energy["kinetic"][-1] / run.energy["kinetic"][0]
        found[f"updates_{n}"] = updates(run)
    return found
