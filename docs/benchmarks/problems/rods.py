"""Rods that strike each other, a wall and the ground."""

from __future__ import annotations

import math

import numpy as np

from .runs import Numbers, contact_of, done, finer, load, updates

# -- Rods ------------------------------------------------------------------------------------------


def rods(name: str, cells: int) -> Numbers:
    """Two rods, the left one of ``cells`` elements: pressure, duration of the contact and coefficient of
    restitution."""
    data = finer(name, cells / 100)
    run = done(data)
    begin, end, force = contact_of(run, "contact", 0)
    area, mass, after = data["body"][0]["box"]["size"][1] ** 2, [], []
    for body, material in zip(data["body"], data["material"]):
        mass.append(material["density"] * math.prod(body["box"]["size"]))
        after.append(run.body_momentum(body["name"])["p"][-1, 0] / mass[-1])
    before = [body["velocity"][0] for body in data["body"]]
    restitution = (after[1] - after[0]) / (before[0] - before[1])
    return {
        "pressure": force / area,
        "duration": end - begin,
        "restitution": restitution,
        "updates": updates(run),
    }


def rods_of(name: str, exact: Numbers) -> Numbers:
    """Relative errors on three meshes."""
    found = {}
    for cells in (25, 50, 100):
        computed = rods(name, cells)
        found |= {f"{key}_{cells}": computed[key] / exact[key] - 1 for key in exact}
    return found | {"updates": computed["updates"]}


RODS: dict[str, Numbers] = {
    "rods_equal": {"pressure": 0.1, "duration": 20.0, "restitution": 1.0},
    "rods_unequal": {"pressure": 0.1 * 2 / 3, "duration": 20.0, "restitution": 1.0},
    "rods_saint_venant": {"pressure": 0.05, "duration": 20.0, "restitution": 0.5},
}


# -- Rod and beam at a wall ------------------------------------------------------------------------


ROD_MODULUS, ROD_DENSITY, ROD_SPEED, ROD_LENGTH, ROD_GAP = 3e7, 0.73e-3, 202.2, 10.0, 0.01


def rod_exact() -> Numbers:
    """Begin and end of the contact [µs], force [lbf] and speed of the rebound [in/s]."""
    c = math.sqrt(ROD_MODULUS / ROD_DENSITY)
    begin = ROD_GAP / ROD_SPEED
    force = ROD_DENSITY * c * ROD_SPEED
    end = begin + 2 * ROD_LENGTH / c
    return {"begin": 1e6 * begin, "end": 1e6 * end, "force": force, "rebound": ROD_SPEED}


def rod(cells: int) -> Numbers:
    """The rod of VM265 with ``cells`` elements, as ``rod_exact``."""
    data = finer("rod_at_wall", cells / 100)
    run = done(data)
    area = data["body"][0]["box"]["size"][1] ** 2
    begin, end, force = contact_of(run, "wall", 0)
    momentum = run.momentum["p"][-1, 0] / (ROD_DENSITY * ROD_LENGTH * area)
    return {"begin": 1e6 * begin, "end": 1e6 * end, "force": force / area, "rebound": momentum}


def beam(across: int) -> Numbers:
    """The quarter of SDNV100's beam with ``across`` elements over half its width: median force, duration and rebound
    over those of a rod."""
    data = load("beam_at_wall")
    data["body"][0]["box"]["cells"] = [across, across, 20 * across]
    run = done(data)
    begin, end, force = contact_of(run, "wall", 2)
    p = run.momentum["p"][:, 2]
    return {
        "force": force / (1e-4 * 8000 * 5000 * 100) - 1,
        "duration": (end - begin) / (2 * 0.2 / 5000) - 1,
        "rebound": -p[-1] / p[0] - 1,
        "updates": updates(run),
    }


def rod_at_wall() -> Numbers:
    """The closed form, the rod on two meshes, and the errors of the beam on two meshes."""
    found = {f"{key}_exact": value for key, value in rod_exact().items()}
    for cells in (20, 100):
        found |= {f"{key}_{cells}": value for key, value in rod(cells).items()}
    for across in (2, 4):
        last = beam(across)
        found |= {f"beam_{key}_{across}": last[key] for key in ("force", "duration", "rebound")}
    return found | {"updates": last["updates"]}


# -- Bouncing bar ----------------------------------------------------------------------------------


def bounces(cells: int) -> Numbers:
    """The bar under gravity with the default contact: begin of the second and of the tenth impact, and the change of
    energy over the energy of the fall."""
    data = load("bouncing_bar")
    wide = 10 / cells
    data["body"][0]["box"] |= {"size": [wide, wide, 10], "cells": [1, 1, cells]}
    data["probe"] = [{"name": "floor", "resultant": "obstacle"}]
    data["time"] = {"end": 25.5, "fraction": 0.9}
    run = done(data)
    rows = run.probes["floor"]
    on = rows["force"][:, 2] > 30 * wide**2  # a tenth of the pressure ρ c v of an impact
    off_before = np.flatnonzero(np.diff(on.astype(int)) == 1)
    begins = rows["time"][off_before + 1]
    # A gap of some steps in a contact begins no impact.
    begins = begins[np.diff(begins, prepend=-1.0) > 1.0]
    total = run.energy["total"]
    return {
        "second": begins[1],
        "tenth": begins[9],
        "energy": (total[-1] - total[0]) / (10 * 10 * wide**2 * 5),
        "updates": updates(run),
    }


def bouncing_bar() -> Numbers:
    """Two meshes."""
    found = {}
    for cells in (50, 100):
        last = bounces(cells)
        found |= {f"{key}_{cells}": last[key] for key in ("second", "tenth", "energy")}
    return found | {"updates": last["updates"]}
