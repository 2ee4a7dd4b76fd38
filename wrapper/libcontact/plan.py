"""
The plan of a run: what each effect will cost, predicted before the run, and what it did cost.

A rehearsal with larger elements (:mod:`libcontact.rehearsal`) counts what cannot be known before the run: how long surfaces
press, how many rounds the solver takes, which elements are active. A trial of a few steps of the real problem measures how much
more a real step costs than a coarse one. :func:`predict` multiplies the two.
"""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from . import has
from ._core import ffi, lib
from .errors import Error, check, new_error
from .problem import Problem, memory_of, new_state
from .rehearsal import TOUCHING, Array, Rehearsal, effects_of, rehearse, step_seconds
from .touch import first_touch

# A trial takes about this long, in rounds of some steps and a record.
TRIAL_SECONDS, FEWEST_ROUNDS, MOST_ROUNDS, MOST_STEPS = 0.2, 4, 24, 24
# What takes this many times the median of its like was interrupted by another program.
INTERRUPTED = 3.0
# A problem of more elements is not tried; its prices are those of its rehearsal.
MOST_ELEMENTS = 100_000
# The strain that makes all elements active in a trial.
STRETCH = 1e-12
LOOP, OUTPUT = "time loop", "output"
HEADS = (
    *("", "nodes", "a step", "work", "done"),
    *("predicted", "measured", "flops", "bytes", "of the bound"),
)


@dataclass(frozen=True)
class Cost:
    """
    What one part of a run costs: all effects of one name, the ``"time loop"`` around them, or the ``"output"``.

    Attributes
    ----------
    name : str
        Name of the part.
    nodes : int
        Nodes that the part acts on.
    seconds_a_step : float
        Predicted mean time of a step (of the output: of a record) [s].
    active : float
        Predicted fraction of the elements that are computed, or of the steps in which surfaces press.
    done : float or None
        The fraction of the elements that a run has computed; None where not known.
    predicted, measured : float or None
        Time over the whole run [s]; None where not known.
    flops, bytes : float
        Operations and bytes of one step; 0 where not counted.
    omega_squared, rate : float
        Contribution to the bound on the step [1/time²] and [1/time], :eq:`plan-share`.
    """

    name: str
    nodes: int = 0
    seconds_a_step: float = 0.0
    active: float = 1.0
    done: float | None = None
    predicted: float | None = None
    measured: float | None = None
    flops: float = 0.0
    bytes: float = 0.0
    omega_squared: float = 0.0
    rate: float = 0.0


@dataclass(frozen=True)
class Prediction:
    """
    What a run is predicted to cost.

    Attributes
    ----------
    costs : tuple of Cost
        One row for each part of the run.
    steps : int
        Steps that the run will take.
    memory : int
        Memory that the run holds [bytes].
    output : int
        Size of the results file [bytes]; 0 where none is written.
    rehearsed : bool
        Whether a rehearsal foresaw the run. Without one, times are those of a run in which all elements are active and all
        surfaces touch from the beginning.
    """

    costs: tuple[Cost, ...]
    steps: int
    memory: int
    output: int = 0
    rehearsed: bool = True

    @property
    def seconds(self) -> float | None:
        """Time of the whole run [s]; None where the trial failed."""
        return _total([cost.predicted for cost in self.costs])


def predict(problem: Problem, records: int) -> Prediction:
    """
    Predict what a run will cost on this machine.

    Parameters
    ----------
    problem : Problem
        The built problem. It is not changed.
    records : int
        How many times the run records.

    Returns
    -------
    Prediction
        Costs without predicted times where no step can be computed.
    """
    seen, steps, active = rehearse(problem), problem.step_count, dict[str, float]()
    try:
        prices = _prices(problem, seen, max(1, steps // max(1, records - 1)))
    except (Error, OSError):
        return Prediction(tuple(_known(problem)), steps, memory_of(problem), rehearsed=False)
    if seen:
        active, steps = _active(seen[0]), seen[0].steps
    costs = []
    for cost in _known(problem, _rounds(problem, seen)):
        price, count = prices.seconds[cost.name], records if cost.name == OUTPUT else steps
        share = active.get(cost.name, 1.0)
        costs.append(replace(cost, seconds_a_step=price, active=share, predicted=price * count))
    size = round(prices.first_bytes + prices.record_bytes * (records - 1))
    return Prediction(tuple(costs), steps, memory_of(problem), size, bool(seen))


def measured(problem: Problem, state: Any, output_seconds: float) -> dict[str, float]:
    """
    Return what each part of a run cost.

    Parameters
    ----------
    problem : Problem
        The problem of the run.
    state : ct_state *
        Its last state.
    output_seconds : float
        Time of all records [s].

    Returns
    -------
    dict of str to float
        Seconds by name, as in ``Cost.measured``.
    """
    return _by_name(problem, step_seconds(problem, state)) | {OUTPUT: output_seconds}


def _by_name(problem: Problem, values: Array) -> dict[str, float]:
    """Values of the effects and the time loop, summed by name. What only holds nodes is work of the time loop."""
    out: dict[str, float] = {}
    for k, name in enumerate([*problem.effects, LOOP]):
        if name == LOOP or problem.pointer.effects[k].phase != lib.CT_PHASE_REACTION:
            out[name] = out.get(name, 0.0) + float(values[k])
    return out


# What is known of each part without a step, and what a rehearsal adds.


def _known(problem: Problem, rounds: float = 0.0) -> list[Cost]:
    """Nodes, operations, bytes and bounds of each part, with ``rounds`` of the solver a point, :eq:`round-flops`; of the output nothing."""
    state, error, bounds = new_state(problem), new_error(), ffi.new("double[2]")
    rows = np.zeros((len(problem.effects) + 1, 5))
    face = max(4 if body.mesh.element == "hex8" else 8 for body in problem.bodies.values())
    for k, effect in enumerate(effects_of(problem)):
        check(lib.ct_stable_share(problem.pointer, state, k, bounds, bounds + 1, error), error)
        rows[k] = effect.node_count, effect.flops, effect.bytes, *bounds
        # A point of a contact moves the nodes of two faces.
        moves = face * (2 if effect.kind == lib.CT_EFFECT_CONTACT else 1)
        round_cost = np.array([60.0 + 15.0 * moves, ffi.sizeof("ct_constraint") + 64.0 * moves])
        rows[k, 1:3] += rounds * effect.constraint_count * round_cost
    for body in problem.bodies.values():
        rows[0, 1:3] += len(body.mesh.elements) * np.array([body.flops, body.bytes])
    # The kick and drift of a degree of freedom: 6 operations; 3 arrays read, 3 read and written.
    rows[-1, :3] = problem.pointer.node_count * np.array([1.0, 18.0, 192.0])
    nodes, flops, moved, omega2, rate = (_by_name(problem, column) for column in rows.T)
    known = (
        Cost(
            name,
            int(count),
            flops=flops[name],
            bytes=moved[name],
            omega_squared=omega2[name],
            rate=rate[name],
        )
        for name, count in nodes.items()
    )
    return [*known, Cost(OUTPUT)]


def _rounds(problem: Problem, seen: list[Rehearsal]) -> float:
    """The solver's rounds in a step, per point."""
    points = [
        sum(effect.constraint_count for effect in effects_of(one))
        for one in (problem, *(rehearsal.coarse for rehearsal in seen))
    ]
    counted = [(float(size), one.rounds) for size, one in zip(points[1:], seen)]
    return _at_size(points[0], counted) / points[0] if counted and points[0] else 0.0


def _active(rehearsal: Rehearsal) -> dict[str, float]:
    """The fraction in which the elements and each touching effect are active."""
    coarse = rehearsal.coarse
    out = {coarse.effects[0]: rehearsal.computed}
    shares = rehearsal.pressed.mean(axis=0)
    for name, effect, share in zip(coarse.effects, effects_of(coarse), shares):
        if effect.kind in TOUCHING:
            out[name] = max(out.get(name, 0.0), float(share))
    return out


# Prices.


@dataclass(frozen=True, eq=False)
class _Prices:
    """Seconds of a step of each part and of a record; bytes of the file after the first record, and of each further one."""

    seconds: dict[str, float]
    first_bytes: float
    record_bytes: float


def _prices(problem: Problem, seen: list[Rehearsal], interval: int) -> _Prices:
    """The prices of a run: those of its rehearsals at the size of the run, :eq:`plan-size`."""
    if not seen:
        return _try(problem, interval, together=True)
    coarse, sizes = seen[0].coarse, _sizes(problem)
    rows = [(_sizes(one.coarse), _by_name(one.coarse, one.seconds)) for one in seen]
    seconds = {
        name: _at_size(sizes[name], [(size[name], value[name]) for size, value in rows])
        for name in rows[0][1]
    }
    large = sum(len(body.mesh.elements) for body in problem.bodies.values()) > MOST_ELEMENTS
    tried = _try(coarse if large else problem, interval)
    ratio = sizes[LOOP] / rows[0][0][LOOP] if large else 1.0
    if not large and coarse is not problem:
        # What does not wait for a touch costs as much more than in the rehearsal as it does in a trial, :eq:`plan-trial`.
        other = _try(coarse, interval).seconds
        for name, effect in zip([*problem.effects, LOOP], [*effects_of(problem), None]):
            if (effect is None or effect.kind not in TOUCHING) and other.get(name, 0.0) > 0.0:
                seconds[name] = rows[0][1][name] * tried.seconds[name] / other[name]
    seconds[OUTPUT] = ratio * tried.seconds[OUTPUT]
    return _Prices(seconds, ratio * tried.first_bytes, ratio * tried.record_bytes)


def _sizes(problem: Problem) -> dict[str, float]:
    """What the cost of each part is proportional to: its operations, or its nodes where these are not counted."""
    return {cost.name: cost.flops or float(cost.nodes) for cost in _known(problem)}


def _at_size(size: float, seen: list[tuple[float, float]]) -> float:
    """A cost that grows in proportion to a size, beside a fixed part, from pairs of size and cost."""
    (larger, most), (smaller, least) = seen[0], seen[-1]
    slope = (most - least) / (larger - smaller) if larger > smaller else most / max(larger, 1.0)
    return most + max(slope, 0.0) * (size - larger)


def _try(problem: Problem, interval: int, together: bool = False) -> _Prices:
    """
    Measure some steps and a record after them, again and again, from the start of the run with all elements active; with the
    surfaces moved ``together`` where that is asked for.
    """
    import tempfile

    from .loop import Loop

    loop, error = Loop(problem, ""), new_error()
    steps: list[Array] = []
    records: list[float] = []
    sizes: list[int] = []
    _place(problem, loop.state, together)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "trial.vtkhdf"
        if problem.parts.output.file is not None and has("hdf5"):
            loop.open(file)
        try:
            loop.start_guard()
            # A record computes the forces of the next step, which takes less time then.
            ticks = step_seconds(problem, loop.state)
            while len(records) < FEWEST_ROUNDS or (
                len(records) < MOST_ROUNDS and np.sum(steps) + sum(records) < TRIAL_SECONDS
            ):
                for _ in range(min(interval, MOST_STEPS)):
                    before = ticks
                    check(lib.ct_step(problem.pointer, loop.state, error), error)
                    ticks = step_seconds(problem, loop.state)
                    steps.append(ticks - before)
                begin = loop.output_seconds
                loop.record()
                records.append(loop.output_seconds - begin)
                sizes.append(file.stat().st_size if file.exists() else 0)
        finally:
            loop.abandon()
    # The first round warms the caches.
    step = _mean(np.array(steps[len(steps) // len(records) :]))
    seconds = _by_name(problem, step) | {OUTPUT: float(_mean(np.array(records[1:])))}
    return _Prices(seconds, sizes[0], (sizes[-1] - sizes[0]) / (len(sizes) - 1))


def _mean(rows: Array) -> Array:
    """The mean of like rows, of which some may have been interrupted."""
    return np.asarray(np.minimum(rows, INTERRUPTED * np.median(rows, axis=0)).mean(axis=0))


def _place(problem: Problem, state: Any, together: bool) -> None:
    """Stretch all bodies a little, which makes every element active, and move them into touch."""
    u, x, free = (
        np.frombuffer(ffi.buffer(pointer, 24 * problem.pointer.node_count)).reshape(-1, 3)
        for pointer in (state.displacement, problem.pointer.reference, problem.pointer.inverse_mass)
    )
    u += STRETCH * x * (free > 0.0)
    moved = set()
    for touch in first_touch(problem) if together else ():
        # A body that may touch several others is moved to one of them.
        if touch.body not in moved and touch.shift.any():
            u[problem.bodies[touch.body].nodes] += touch.shift
            moved.add(touch.body)


# The table.


def table(costs: Sequence[Cost], stable: float) -> str:
    """
    Lay out costs as a table.

    Parameters
    ----------
    costs : sequence of Cost
        The rows.
    stable : float
        The stable step [time], of whose bound each effect has a part, :eq:`plan-share`.

    Returns
    -------
    str
        The lines of the table.
    """
    from rich.console import Console
    from rich.table import Table

    rows = [_cells(cost, stable) for cost in costs]
    sums = (_total([cost.predicted for cost in costs]), _total([cost.measured for cost in costs]))
    rows.append(["together", *4 * [""], *map(_seconds, sums), *3 * [""]])
    told = any(cost.measured is not None for cost in costs)
    kept = [k for k, head in enumerate(HEADS) if told or head not in ("done", "measured")]
    out = Table(box=None, pad_edge=False, padding=(0, 3, 0, 0))
    for k in kept:
        out.add_column(HEADS[k], justify="right" if k else "left")
    for row in rows:
        out.add_row(*(row[k] for k in kept))
    text = io.StringIO()
    Console(file=text, width=200, color_system=None).print(out)
    return "\n".join(line.rstrip() for line in text.getvalue().splitlines())


def _cells(cost: Cost, stable: float) -> list[str]:
    # The part of 4 / dt² = W + 2 D / dt that belongs to the effect.
    bound = (cost.omega_squared + 2.0 * cost.rate / stable) * stable**2 / 4.0
    return [
        cost.name,
        str(cost.nodes or ""),
        _seconds(cost.seconds_a_step or None),
        f"{100 * cost.active:.0f} %",
        "" if cost.done is None else f"{100 * cost.done:.0f} %",
        *map(_seconds, (cost.predicted, cost.measured)),
        *(f"{count:.2g}" if count else "" for count in (cost.flops, cost.bytes)),
        f"{100 * bound:.1f} %" if bound else "",
    ]


def _total(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return math.fsum(known) if known and len(known) == len(values) else None


def _seconds(value: float | None) -> str:
    if value is None or not math.isfinite(value):
        return "-"
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if value >= size:
            return f"{value / size:.3g} {unit}"
    return f"{1e9 * value:.3g} ns"
