"""Fronts on a mesh, as they are and filtered."""

from __future__ import annotations

import warnings
from typing import Any

import campaign
import dispersion as chapter
import filter as shown
import numpy as np
import price

import libcontact as ct

from .effects import hold_sides
from .shared import Numbers, measurement, scene_of

FRONTS: dict[str, tuple[tuple[int, int, int], dict[str, Any]]] = {
    "paper": ((1, 0, 0), {"courant": 0.125}),
    "fast": ((1, 0, 0), {"courant": 0.8}),
    "chung_lee": ((1, 0, 0), {"courant": 0.5, "integrator": "chung_lee"}),
    "noh_bathe": ((1, 0, 0), {"courant": 1.25, "integrator": "noh_bathe"}),
    "tchamwa_wielgosz": ((1, 0, 0), {"courant": 0.5, "integrator": "tchamwa_wielgosz"}),
    "consistent": ((1, 0, 0), {"mass": "consistent"}),
    "askew": ((1, 1, 0), {"courant": 0.125}),
    "askew_fast": ((1, 1, 0), {"courant": 0.8}),
    "hex20": ((1, 0, 0), {"courant": 0.2, "element": "hex20"}),
    "hex20_askew": ((1, 1, 0), {"courant": 0.2, "element": "hex20"}),
    "hex20_noh_bathe": ((1, 0, 0), {"courant": 0.4, "element": "hex20", "integrator": "noh_bathe"}),
}


@measurement
def dispersion() -> Numbers:
    """The front of Fig. 4: how many elements it is late, and its overshoot, from a run, the sum of waves and Airy's
    function. FRONTS after 40 elements on a fine line, and C of the phase error of hex20."""
    run = chapter.column()
    found = {"run_late": chapter.TRAVEL - run.half_height, "run_overshoot": run.overshoot}
    fine = np.linspace(40.0, 62.0, 2201)
    long = ct.Front(fine, chapter.long_front(fine, 0.125))
    found |= {"airy_late": chapter.TRAVEL - long.half_height, "airy_overshoot": long.overshoot}
    for name, (normal, options) in FRONTS.items():
        front = ct.dispersion_front(40.0, normal, np.linspace(20.0, 46.0, 2601), **options)
        found |= {f"{name}_late": 40.0 - front.half_height, f"{name}_overshoot": front.overshoot}
    for nu in (0.0, 0.3, 0.45):
        k = 0.02
        phase = ct.dispersion([k, 0, 0], "hex20", poisson=nu).phase[2]
        found[f"hex20_{nu:.2f}".replace(".", "")] = (1.0 - phase) / k**2
    axis, diagonal = (
        1 - ct.dispersion(0.1 * np.array(n) / np.linalg.norm(n), "hex8", poisson=0.3).phase[2]
        for n in ((1, 0, 0), (1, 1, 0))
    )
    return found | {"diagonal": diagonal / axis}


@measurement
def damped_front() -> Numbers:
    """Overshoot of the front of Fig. 4 at the paper's step with another integrator."""
    run = chapter.column(integrator="tchamwa_wielgosz")
    return {"tchamwa_wielgosz": run.overshoot}


@measurement
def wide_bar() -> Numbers:
    """What a bar of 20 elements that strikes a wall keeps of its speed, by their width over their length; and one of 10
    and of 40 elements four times as wide as long."""
    found = {
        f"kept_{ratio:g}".replace(".", ""): struck("hex20", ratio, 20)
        for ratio in (1.0, 1.5, 2.0, 4.0, 8.0)
    }
    found["kept_hex8"] = struck("hex8", 1.0, 20)
    return found | {f"cells_{n}": struck("hex20", 4.0, n) for n in (10, 40)}


def struck(element: str, ratio: float, cells: int) -> float:
    """Speed kept by a bar of length, modulus and density 1 with held sides, at 0.9 of its step."""
    v, width = 0.01, ratio / cells
    box = {"origin": [0.1 * v, 0, 0], "size": [1, width, width], "cells": [cells, 1, 1]}
    scene = scene_of().add_body(
        "bar", material="elastic", element=element, box=box, velocity=[-v, 0, 0]
    )
    hold_sides(scene, "bar", "yz")
    wall = {"point": [0, 0, 0], "normal": [1, 0, 0]}
    scene.add("obstacle", surface="bar.x_min", plane=wall).set_time(end=2.7, fraction=0.9)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "wide:")
        run = scene.run(progress=False, output=False)
    return run.momentum["p"][-1, 0] / (v * width**2)


FILTERED = {
    "full": ("reference", campaign.BEST, (0, 2)),
    "stiff": ("reference", campaign.BEST | campaign.STIFF, (0, 1, 2, 3)),
    "contact": ("contact", campaign.BEST | campaign.STIFF, (0, 2)),
    "paper": ("reference", campaign.PAPER, (0, 2)),
}


@measurement
def filtered_plate() -> Numbers:
    """q of eq:filter-transfer of the plate of the chapter, (c₁ Δt/h)² at the stable step; errors and front of the
    plates with d/40, for elements and passes, at c₁t/d = 0.56 and as means."""
    found = {"q": (shown.plate(10).explain().data["time"]["stable"] * 10) ** 2}
    for name, (scene, keys, passes) in FILTERED.items():
        for count in passes:
            own = campaign.case(scene, 40, keys | ({"output.filter": count} if count else {}))
            mean = price.times_of(own)[1]
            found[f"{name}{count}_overshoot"] = mean["overshoot"]
            if name == "paper":
                continue
            done = price.run(price.scene_of(own, price.T))
            end = price.compared(price.shown(own, done), price.T, price.plate(own))
            found[f"{name}{count}_width"] = mean["width"]
            for line in ("fig4", "fig5"):
                found[f"{name}{count}_{line}"] = mean[f"l1_{line}"]
                found[f"{name}{count}_{line}_end"] = end[f"l1_{line}"]
    return found
