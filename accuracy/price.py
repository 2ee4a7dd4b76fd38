"""One row of the campaign: a run of the plates, its errors against the closed form, and its cost."""

from __future__ import annotations

import functools
import time as clock
import warnings
from typing import Any, NamedTuple

import numpy as np
from campaign import PAPER, Case, case

import libcontact as ct

D, T = 2.5, 0.56  # half the thickness [mm], the paper's time c1 t / d
TIMES = np.linspace(0.50, 0.60, 9)
YOUNG, DENSITY, SPEED = 2.1e5, 7.8e-9, 1000.0  # MPa, t/mm³, mm/s
LINES = (0.4, 0.8)  # x/d of Fig. 5's line, |z|/d of a line crossed by the circular fronts
FIELD = 100  # largest number of places along an edge at which a field is compared
PAPER_UPDATES = {"reference": 448 * 100**2, "contact": 2 * 448 * 100**2}
PAPER_CELLS = 100  # of the run that seconds are compared with
BUDGET = 0.6  # seconds after which a row is not timed once more
EXAMPLES = {"reference": "plates_reference", "contact": "plates"}

ERRORS = ("l1_fig4", "l2_fig4", "l1_fig5", "l2_fig5", "l1_fig5_level", "l2_fig5_level")
FRONT = ("overshoot", "width", "late", "wall", "variation_fig5", "variation_along")
FIELDS = ("l1_sigma_x", "l1_sigma_z", "l1_v_x")
MEANS = (*ERRORS, *FRONT)
COLUMNS = (
    *("scene", "cells", "setting", "status", "courant", "steps", "evaluations", "updates", "cost"),
    *("seconds", "times_paper", *MEANS, *(f"{name}_at_056" for name in (*ERRORS, *FRONT))),
    *FIELDS,
    *("contact_l1", "depth", "growth"),
)


class Plate(NamedTuple):
    """Values that depend on Poisson's ratio: the speed c1 [mm/s], the unit Λ v₀ / c₁ of stresses [MPa], and
    the plateau of σx*."""

    nu: float
    speed: float
    unit: float
    plateau: float


def plate(own: Case) -> Plate:
    nu = own.keys.get("material.poisson", 0.3)
    lame = YOUNG * nu / ((1 + nu) * (1 - 2 * nu))
    speed = float(np.sqrt((lame + YOUNG / (1 + nu)) / DENSITY))
    return Plate(nu, speed, lame * SPEED / speed, (1 - nu) / nu)


def scene_of(own: Case, end: float, times: Any = None) -> ct.Scene:
    """The plates with the keys of a case, until c1 t / d = ``end``."""
    data = ct.Scene.load(ct.example(EXAMPLES[own.scene])).data
    data["time"] = {"end_c1t_over": {"length": D, "value": end}}
    data["output"] = {"fields": ["displacement", "stress"]}
    data["output"] |= (
        {"every": 10**9}
        if times is None
        else {"times": [float(t * D / plate(own).speed) for t in times]}
    )
    for body in data["body"]:
        body["box"]["cells"] = [own.cells, 1, own.cells]
        body["box"]["size"][1] = D / own.cells
    if own.scene == "contact":
        data["contact"] = [{"surfaces": data["contact"][0]["surfaces"]}]
    for name, value in own.keys.items():
        table, _, key = name.partition(".")
        found = data.setdefault(table, {})
        for place in found if isinstance(found, list) else [found]:
            place[key] = value
    return ct.Scene(data)


def run(scene: ct.Scene, **options: Any) -> ct.Run:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return scene.run(progress=False, output=False, **options)


def shown(own: Case, result: ct.Run) -> Any:
    """The body whose stresses are compared, filtered if the case has the filter."""
    body = result.state["right"]
    return body.filtered if own.keys.get("output.filter") else body


class Table(NamedTuple):
    """Element centres of a plate as a table: places (n) over d, and σx*, σz*, v_x/v₀ as (n, n), one row per
    z."""

    place: np.ndarray
    sigma_x: np.ndarray
    sigma_z: np.ndarray
    v_x: np.ndarray


def table_of(body: Any, own: Plate) -> Table:
    x, z = body.centres[:, 0] / D, body.centres[:, 2] / D
    order = np.lexsort((x.round(9), z.round(9)))
    n = round(len(x) ** 0.5)
    stress = body.stress[order].reshape(n, n, 6) / own.unit
    speed = body.velocity[body.elements[order], 0].mean(axis=1).reshape(n, n) / SPEED
    return Table(x[order][:n], stress[..., 0], stress[..., 2], speed)


def between(place: np.ndarray, values: np.ndarray, at: float) -> np.ndarray:
    """Rows of values (n, m) at a place, linear between its two neighbours."""
    after = int(np.searchsorted(place, at))
    part = (at - place[after - 1]) / (place[after] - place[after - 1])
    return (1 - part) * values[after - 1] + part * values[after]


def variation(values: np.ndarray, exact: np.ndarray) -> float:
    """Total variation over that of the exact values at the same places."""
    return float(np.abs(np.diff(values)).sum() / np.abs(np.diff(exact)).sum())


def compared(body: Any, t: float, own: Plate) -> dict[str, float]:
    """Errors on the lines of Figs. 4 and 5 at the time t, overshoot and width of the front, and total
    variation behind the circular fronts."""
    table = table_of(body, own)
    place, sx = table.place, table.sigma_x[0]
    sz = between(place, table.sigma_z.T, LINES[0])
    along = between(place, table.sigma_x, LINES[1])
    zero = np.zeros_like(place)
    exact_x = ct.exact.plates(place, zero, t, own.nu).stress.sigma_x
    exact_z = ct.exact.plates(zero + LINES[0], place, t, own.nu).stress.sigma_z
    exact_along = ct.exact.plates(place, zero + LINES[1], t, own.nu).stress.sigma_x
    found = {}
    for name, off in (
        ("fig4", sx - exact_x),
        ("fig5", sz - exact_z),
        ("fig5_level", (sz - sz[0]) - (exact_z - exact_z[0])),
    ):
        found[f"l1_{name}"] = float(np.abs(off).mean())
        found[f"l2_{name}"] = float(np.sqrt((off**2).mean()))
    front = ct.Front(place, -sx / own.plateau)
    ends = [outermost(front, level) for level in (0.9, 0.1)]
    # The circular front of dilatation about (0, ±d) has the radius t.
    behind = [np.hypot(LINES[0], 1 - place) < t, np.hypot(place, 1 - LINES[1]) < t]
    return found | {
        "overshoot": front.overshoot,
        "width": (ends[1] - ends[0]) * len(place),
        "late": (t - front.half_height) * len(place),
        "wall": float(np.abs(front.stress[:2] - 1).mean()),
        "variation_fig5": variation(sz[behind[0]], exact_z[behind[0]]),
        "variation_along": variation(along[behind[1]], exact_along[behind[1]]),
    }


@functools.lru_cache(maxsize=8)
def exact_fields(cells: int, t: float, nu: float) -> tuple[slice, tuple[np.ndarray, ...]]:
    """Which elements along an edge are compared (each k-th, at most FIELD), and the closed form at their centres."""
    every = -(-cells // FIELD)
    part = slice((every - 1) // 2, None, every)
    place = ((np.arange(cells) + 0.5) / cells)[part]
    stress, velocity = ct.exact.plates(*np.meshgrid(place, place), t, nu)
    return part, (stress.sigma_x, stress.sigma_z, velocity.v_x)


def fields(body: Any, t: float, own: Plate) -> dict[str, float]:
    """L1 errors over the fields of σx*, σz* and v_x/v₀ at element centres."""
    table = table_of(body, own)
    part, exact = exact_fields(len(table.place), t, own.nu)
    return {
        name: float(np.abs(values[part, part] - other).mean())
        for name, values, other in zip(FIELDS, table[1:], exact)
    }


def outermost(front: ct.Front, level: float) -> float:
    """The outermost place where the stress crosses a level, linear between places."""
    passed = np.flatnonzero((front.stress[:-1] >= level) & (front.stress[1:] < level))
    if not passed.size:
        return float("nan")
    pair = slice(passed[-1], passed[-1] + 2)
    return float(np.interp(-level, -front.stress[pair], front.distance[pair]))


def times_of(own: Case) -> tuple[list[float], dict[str, float]]:
    """c1 t / d of the records, and the mean of each quantity over the records nearest to TIMES; for a
    contact also the largest penetration at these records, over h."""
    seen: list[tuple[float, dict[str, float]]] = []

    def look(now: ct.Run) -> None:
        t = now.state.time * plate(own).speed / D
        if t < TIMES[0] / 2:
            return
        found = compared(shown(own, now), t, plate(own))
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
    A run to c1 t / d = 0.56, the seconds of its time loop, and their ratio to the paper's setting. Both
    run alternately a few times, and the least of each counts, because disturbances only make runs longer.
    """
    paper, seconds = case(own.scene, PAPER_CELLS, PAPER), np.full(2, np.inf)
    if not own.timed:
        return run(scene_of(own, T)), float("nan"), float("nan")
    begin = clock.perf_counter()
    for _ in range(7):
        first, result = (run(scene_of(which, T)) for which in (paper, own))
        seconds = np.minimum(seconds, [loop_seconds(first), loop_seconds(result)])
        if clock.perf_counter() - begin > BUDGET:
            break
    return result, float(seconds[1]), float(seconds[1] / seconds[0])


def loop_seconds(result: ct.Run) -> float:
    return float(sum(value for name, value in result.costs.items() if name != "output"))


def work(result: ct.Run, own: Case) -> tuple[int, int]:
    """Element updates that were computed, and force evaluations."""
    updates, slept = result.writer.state.element_updates
    return int(updates), round((updates + slept) / (len(result.bodies) * own.cells**2))


def row(own: Case) -> dict[str, Any]:
    """All columns of a case; ``status`` says if the library has refused it or ended it with an error."""
    found: dict[str, Any] = {name: float("nan") for name in COLUMNS}
    found |= {"scene": own.scene, "cells": own.cells, "setting": own.setting}
    try:
        result, seconds, ratio = timed(own)
        _, means = times_of(own)
    except ct.Error as error:
        return found | {"status": type(error).__name__}
    body = shown(own, result)
    updates, evaluations = work(result, own)
    # Each pass of the filter costs one more force evaluation.
    passes = own.keys.get("output.filter", 0)
    evaluations += passes
    updates += passes * len(result.bodies) * own.cells**2
    total = result.energy["total"]
    found |= means | {
        "status": "done",
        "courant": plate(own).speed * result.dt * own.cells / D,
        "steps": int(result.steps[-1]),
        "evaluations": evaluations,
        "updates": updates,
        "cost": updates / PAPER_UPDATES[own.scene],
        "seconds": seconds,
        "times_paper": ratio,
        "growth": float(total.max() / total[0] - 1),
    }
    at_end = compared(body, T, plate(own))
    found |= {f"{name}_at_056": at_end[name] for name in (*ERRORS, *FRONT)}
    found |= fields(body, T, plate(own))
    if own.scene == "contact":
        found["contact_l1"] = against_reference(own, result)
    return found


def against_reference(own: Case, result: ct.Run) -> float:
    """Mean difference on Fig. 4's line from the plate on a wall with the same step."""
    keys = {name: value for name, value in own.keys.items() if not name.startswith("time.")}
    keys |= {name: value for name, value in own.keys.items() if name.startswith("time.integrator")}
    wall = run(scene_of(case("reference", own.cells, keys | {"time.dt": result.dt}), T))
    one, other = (table_of(shown(own, which), plate(own)).sigma_x[0] for which in (result, wall))
    return float(np.abs(one - other).mean())
