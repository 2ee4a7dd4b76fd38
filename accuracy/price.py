"""One row of the campaign: a run of the plates, its errors against the closed form, and its cost."""

from __future__ import annotations

import time as clock
import warnings
from typing import Any

import numpy as np
from campaign import PAPER, Case, case

import libcontact as ct

D, NU, T = 2.5, 0.3, 0.56  # half the thickness [mm], Poisson's ratio, the paper's time c1 t / d
TIMES = np.linspace(0.50, 0.60, 9)
YOUNG, DENSITY, SPEED = 2.1e5, 7.8e-9, 1000.0  # MPa, t/mm³, mm/s
LAMBDA = YOUNG * NU / ((1 + NU) * (1 - 2 * NU))
C1 = float(np.sqrt((LAMBDA + YOUNG / (1 + NU)) / DENSITY))
PLATEAU = (1 - NU) / NU
PAPER_UPDATES = {"reference": 448 * 100**2, "contact": 2 * 448 * 100**2}
PAPER_CELLS = 100  # of the run that seconds are compared with
EXAMPLES = {"reference": "plates_reference", "contact": "plates"}

ERRORS = ("l1_fig4", "l2_fig4", "l1_fig5", "l2_fig5", "l1_fig5_level", "l2_fig5_level")
FRONT = ("overshoot", "width", "late", "wall")
MEANS = (*ERRORS, *FRONT)
COLUMNS = (
    *("scene", "cells", "setting", "status", "courant", "steps", "evaluations", "updates", "cost"),
    *("seconds", "times_paper", *MEANS, *(f"{name}_at_056" for name in ERRORS)),
    *("contact_l1", "depth", "growth"),
)


def scene_of(own: Case, end: float, times: Any = None) -> ct.Scene:
    """The plates with the keys of a case, until c1 t / d = ``end``."""
    data = ct.Scene.load(ct.example(EXAMPLES[own.scene])).data
    data["time"] = {"end_c1t_over": {"length": D, "value": end}}
    data["output"] = {"fields": ["displacement", "stress"]}
    data["output"] |= (
        {"every": 10**9} if times is None else {"times": [float(t * D / C1) for t in times]}
    )
    for body in data["body"]:
        body["box"]["cells"] = [own.cells, 1, own.cells]
        body["box"]["size"][1] = D / own.cells
    if own.scene == "contact":
        data["contact"] = [{"surfaces": data["contact"][0]["surfaces"]}]
    for name, value in own.keys.items():
        table, key = name.split(".")
        found = data.setdefault(table, {})
        for place in found if isinstance(found, list) else [found]:
            place[key] = value
    return ct.Scene(data)


def run(scene: ct.Scene, **options: Any) -> ct.Run:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return scene.run(progress=False, output=False, **options)


def lines(body: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places (n) of the element centres, over d; σx* of the row next to z = 0; σz* at x/d = 0.4, linear between the two columns beside it."""
    x, z = body.centres[:, 0] / D, body.centres[:, 2] / D
    order = np.lexsort((x.round(9), z.round(9)))
    n = round(len(x) ** 0.5)
    place = x[order].reshape(n, n)[0]
    stress = body.stress[order].reshape(n, n, 6) * C1 / (LAMBDA * SPEED)
    after = int(np.searchsorted(place, 0.4))
    part = (0.4 - place[after - 1]) / (place[after] - place[after - 1])
    column = (1 - part) * stress[:, after - 1, 2] + part * stress[:, after, 2]
    return place, stress[0, :, 0], column


def compared(body: Any, t: float) -> dict[str, float]:
    """Errors on the lines of Figs. 4 and 5 at the time t, and what the front looks like."""
    place, sx, sz = lines(body)
    zero = np.zeros_like(place)
    exact_x = ct.exact.plates(place, zero, t, NU).stress.sigma_x
    exact_z = ct.exact.plates(zero + 0.4, place, t, NU).stress.sigma_z
    found = {}
    for name, off in (
        ("fig4", sx - exact_x),
        ("fig5", sz - exact_z),
        ("fig5_level", (sz - sz[0]) - (exact_z - exact_z[0])),
    ):
        found[f"l1_{name}"] = float(np.abs(off).mean())
        found[f"l2_{name}"] = float(np.sqrt((off**2).mean()))
    front = ct.Front(place, -sx / PLATEAU)
    ends = [outermost(front, level) for level in (0.9, 0.1)]
    return found | {
        "overshoot": front.overshoot,
        "width": (ends[1] - ends[0]) * len(place),
        "late": (t - front.half_height) * len(place),
        "wall": float(np.abs(front.stress[:2] - 1).mean()),
    }


def outermost(front: ct.Front, level: float) -> float:
    """The outermost place where the stress passes a level, linear between places."""
    passed = np.flatnonzero((front.stress[:-1] >= level) & (front.stress[1:] < level))
    if not passed.size:
        return float("nan")
    pair = slice(passed[-1], passed[-1] + 2)
    return float(np.interp(-level, -front.stress[pair], front.distance[pair]))


def times_of(own: Case) -> tuple[list[float], dict[str, float]]:
    """c1 t / d of the records, and for each quantity its mean over the records nearest to TIMES; for a contact also the deepest point then, over h."""
    seen: list[tuple[float, dict[str, float]]] = []

    def look(now: ct.Run) -> None:
        t = now.state.time * C1 / D
        if t < TIMES[0] / 2:
            return
        found = compared(now.state["right"], t)
        if own.scene == "contact":
            gap = now.contact[0]["gap"]
            found["depth"] = float(max(0.0, -np.nanmin(gap))) * own.cells / D
        seen.append((t, found))

    run(scene_of(own, TIMES[-1], TIMES), watch=look)
    at = np.array([t for t, _ in seen])
    nearest = [seen[int(np.abs(at - t).argmin())][1] for t in TIMES]
    means = {name: float(np.mean([row[name] for row in nearest])) for name in nearest[0]}
    return list(at), means


def timed(own: Case) -> tuple[ct.Run, float, float]:
    """
    A run to c1 t / d = 0.56, the seconds of its time loop, and their ratio to the paper's setting. Both are run in turn a few times, and the least of each counts: what
    disturbs a run only makes it longer.
    """
    paper, seconds = case(own.scene, PAPER_CELLS, PAPER), np.full(2, np.inf)
    begin = clock.perf_counter()
    for _ in range(7):
        first, result = (run(scene_of(which, T)) for which in (paper, own))
        seconds = np.minimum(seconds, [loop_seconds(first), loop_seconds(result)])
        if clock.perf_counter() - begin > 2.0:
            break
    return result, float(seconds[1]), float(seconds[1] / seconds[0])


def loop_seconds(result: ct.Run) -> float:
    return float(sum(value for name, value in result.costs.items() if name != "output"))


def row(own: Case) -> dict[str, Any]:
    """All columns of a case; one that the library refuses or ends says so in ``status``."""
    found: dict[str, Any] = {name: float("nan") for name in COLUMNS}
    found |= {"scene": own.scene, "cells": own.cells, "setting": own.setting}
    try:
        result, seconds, ratio = timed(own)
        _, means = times_of(own)
    except ct.Error as error:
        return found | {"status": type(error).__name__}
    body = result.state["right"]
    updates, slept = result.writer.state.element_updates
    elements = len(result.bodies) * own.cells**2
    total = result.energy["total"]
    found |= means | {
        "status": "done",
        "courant": C1 * result.dt * own.cells / D,
        "steps": int(result.steps[-1]),
        "evaluations": round((updates + slept) / elements),
        "updates": int(updates),
        "cost": updates / PAPER_UPDATES[own.scene],
        "seconds": seconds,
        "times_paper": ratio,
        "growth": float(total.max() / total[0] - 1),
    }
    at_end = compared(body, T)
    found |= {f"{name}_at_056": at_end[name] for name in ERRORS}
    if own.scene == "contact":
        found["contact_l1"] = against_reference(own, result)
    return found


def against_reference(own: Case, result: ct.Run) -> float:
    """Mean difference on Fig. 4's line from the plate on a wall with the same step."""
    keys = {name: value for name, value in own.keys.items() if not name.startswith("time.")}
    keys |= {name: value for name, value in own.keys.items() if name.startswith("time.integrator")}
    wall = run(scene_of(case("reference", own.cells, keys | {"time.dt": result.dt}), T))
    one, other = (lines(which.state["right"])[1] for which in (result, wall))
    return float(np.abs(one - other).mean())
