"""Prediction of the cost of each effect before a run, and its measurement afterwards.

Some numbers are not known before a run: how long surfaces are in contact, how many of their points
are active, how many iterations the solver of the contact forces needs, and which elements the waves
reach. They depend on bodies and waves, and little on the size of the elements. So a *rehearsal*,
the same scene with larger elements, estimates them at a small part of the cost. A *trial* of a few
steps of the real problem measures the ratio of the costs of a real step and a coarse one.
:func:`predict` multiplies the two.
"""

from __future__ import annotations

import copy
import math
import tempfile
import time as clock
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from .._core import ffi, lib
from ..bridge import ask, call, has
from ..checks.touch import first_touch
from ..errors import Error
from ..loop import Loop
from ..mesh import FACTS
from ..model import Body, Time
from ..problem import Held, Problem, memory_of, new_state
from ..progress import table_text
from ..timing import OUTPUT, by_name, computed_fraction, step_seconds

Array = npt.NDArray[np.float64]

# Cost limits of a rehearsal, in updates of one element: this number or this fraction of the run,
# whichever is larger, but at most MOST_EVER. A node that may touch counts as NODE_UPDATES elements.
MOST_UPDATES, MOST_FRACTION, MOST_EVER, NODE_UPDATES = 1e6, 0.15, 1e8, 50
# Ratio of the element sizes of the second rehearsal and the first.
COARSER = 2.0
# Smallest number of cells around a ring.
FEWEST_AROUND = 12
# Effects without force while nothing touches.
TOUCHING = (lib.CT_EFFECT_CONTACT, lib.CT_EFFECT_OBSTACLE, lib.CT_EFFECT_FRICTION)
# Number of equal windows of a run at whose ends the counters are read, and the fewest steps in one.
WINDOWS, FEWEST_STEPS = 240, 4
# A short rehearsal is repeated, because short times are uncertain: number of passes, and their time [s].
PASSES, PASS_SECONDS = 3, 0.15
# Approximate time of a trial [s]; numbers of its rounds, each of some steps and a record; steps of one.
TRIAL_SECONDS, FEWEST_ROUNDS, MOST_ROUNDS, MOST_STEPS = 0.2, 4, 24, 24
# The strain that makes all elements active in a trial.
STRETCH = 1e-12


@dataclass(frozen=True)
class Cost:
    """
    Cost of one part of a run: all effects of one name, the ``"time loop"`` around them, or the
    ``"output"``.

    Attributes
    ----------
    name : str
        Name of the part.
    nodes : int
        Nodes that the part acts on.
    seconds_a_step : float
        Predicted mean time of a step (of the output: of a record) [s].
    active : float
        Predicted fraction of the elements that are computed, or of the steps in which surfaces are
        in contact.
    done : float or None
        Fraction of the elements that a run has computed; None if unknown.
    predicted, measured : float or None
        Time over the whole run [s]; None if unknown.
    flops, bytes : float
        Operations and bytes per step; 0 if not counted.
    omega_squared, rate : float
        Contribution to the bound on the step [1/time²] and [1/time], :eq:`plan-share`.
    """

    name: str
    nodes: int = 0
    flops: float = 0.0
    bytes: float = 0.0
    omega_squared: float = 0.0
    rate: float = 0.0
    seconds_a_step: float = 0.0
    active: float = 1.0
    done: float | None = None
    predicted: float | None = None
    measured: float | None = None


@dataclass(frozen=True)
class Prediction:
    """The predicted cost of a run.

    Attributes
    ----------
    costs : tuple of Cost
        One row for each part of the run.
    steps : int
        Steps that the run will take.
    memory : int
        Memory of the run [bytes].
    output : int
        Size of the results file [bytes]; 0 if none is written.
    rehearsed : bool
        Whether the prediction uses a rehearsal. Without one, times are those of a run in which all
        elements are active and all surfaces touch from the beginning.
    """

    costs: tuple[Cost, ...]
    steps: int
    memory: int
    output: int = 0
    rehearsed: bool = True

    @property
    def seconds(self) -> float | None:
        """Time of the whole run [s]; None if the trial failed."""
        return _total([cost.predicted for cost in self.costs])


def predict(problem: Problem, records: int) -> Prediction:
    """Predict the cost of a run with so many records on this machine. The built problem is not changed. Without
    a step that can be computed there are no predicted times."""
    seen, steps = rehearse(problem), problem.step_count
    interval = max(1, steps // max(1, records - 1))
    try:
        tried = _try(problem, interval, together=not seen)
        seconds = (
            _predicted_seconds(problem, seen, tried.seconds, interval) if seen else tried.seconds
        )
    except (Error, OSError):
        return Prediction(tuple(_known(problem)), steps, memory_of(problem), rehearsed=False)
    steps, active = (seen[0].steps, _active(seen[0])) if seen else (steps, {})
    costs = []
    for cost in _known(problem, _rounds(problem, seen)):
        price, count = seconds[cost.name], records if cost.name == OUTPUT else steps
        share = active.get(cost.name, 1.0)
        costs.append(replace(cost, seconds_a_step=price, active=share, predicted=price * count))
    size = round(tried.first_bytes + tried.record_bytes * (records - 1))
    return Prediction(tuple(costs), steps, memory_of(problem, tried.grown), size, bool(seen))


# Costs that are known without a step, and those from a rehearsal.


def _known(problem: Problem, rounds: float = 0.0) -> list[Cost]:
    """Nodes, operations, bytes and bounds of each part, with ``rounds`` of the solver per point,
    :eq:`round-flops`; zeros for the output."""
    state, bounds = new_state(problem), ffi.new("double[2]")
    rows = np.zeros((len(problem.effects) + 1, 5))
    kinds = {FACTS[body.mesh.element].face_kind for body in problem.bodies.values()}
    face = max(map(lib.ct_face_node_count, kinds))
    for k, effect in enumerate(problem.made):
        call(lib.ct_stable_contribution, problem.pointer, state, k, bounds, bounds + 1)
        rows[k] = effect.node_count, effect.cost.flops, effect.cost.bytes, *bounds
        # A contact point acts on the nodes of two faces.
        moves = face * (2 if effect.kind == lib.CT_EFFECT_CONTACT else 1)
        round_cost = np.array([40.0 + 18.0 * moves, 80.0 + 100.0 * moves])
        rows[k, 1:3] += rounds * effect.constraint_count * round_cost
    for body in problem.bodies.values():
        rows[0, 1:3] += len(body.mesh.elements) * np.array([body.flops, body.bytes])
    # The kick and drift of a degree of freedom: 6 operations; 3 arrays read, 3 read and written.
    rows[-1, :3] = problem.pointer.node_count * np.array([1.0, 18.0, 192.0])
    nodes, *columns = (by_name(problem, column) for column in rows.T)
    known = [Cost(name, int(nodes[name]), *(c[name] for c in columns)) for name in nodes]
    return [*known, Cost(OUTPUT)]


def _rounds(problem: Problem, seen: list[Rehearsal]) -> float:
    """Rounds of the solver per step and point."""

    def count(one: Problem) -> float:
        return float(sum(effect.constraint_count for effect in one.made))

    counted = [(count(one.coarse), one.rounds) for one in seen]
    points = count(problem)
    return _at_size(points, counted) / points if counted and points else 0.0


def _active(rehearsal: Rehearsal) -> dict[str, float]:
    """Fraction of the elements that are computed, and of the windows in which each effect that needs a
    touch acts."""
    coarse, out = rehearsal.coarse, {"solid": rehearsal.computed}
    for k, effect in enumerate(coarse.made):
        if effect.kind in TOUCHING:
            share = float(rehearsal.acted[:, k].mean())
            out[coarse.effects[k]] = max(out.get(coarse.effects[k], 0.0), share)
    return out


def _predicted_seconds(
    problem: Problem, seen: list[Rehearsal], tried: dict[str, float], interval: int
) -> dict[str, float]:
    """
    Predict the time of a step in each part [s].

    Effects that need a touch follow :eq:`plan-size`; all others are scaled by trials, :eq:`plan-trial`.
    """
    coarse = seen[0].coarse
    other = tried if coarse is problem else _try(coarse, interval).seconds
    sizes = [_sizes(one) for one in (problem, *(rehearsal.coarse for rehearsal in seen))]
    prices = [by_name(rehearsal.coarse, rehearsal.seconds) for rehearsal in seen]
    touching, seconds = _active(seen[0]).keys() - {"solid"}, dict(tried)
    for name, price in prices[0].items():
        known = [(size[name], each[name]) for size, each in zip(sizes[1:], prices)]
        more = tried[name] / max(other[name], 1e-12)
        seconds[name] = _at_size(sizes[0][name], known) if name in touching else price * more
    return seconds


def _sizes(problem: Problem) -> dict[str, float]:
    """Size of each part, to which its cost is proportional: its operations, or its nodes if these are not
    counted."""
    return {cost.name: cost.flops or float(cost.nodes) for cost in _known(problem)}


def _at_size(size: float, seen: list[tuple[float, float]]) -> float:
    """Cost at a size: a fixed part plus one proportional to the size, from pairs of size and cost."""
    (larger, most), (smaller, least) = seen[0], seen[-1]
    # (eq:plan-size)
    slope = (most - least) / (larger - smaller) if larger > smaller else most / max(larger, 1.0)
    return most + max(slope, 0.0) * (size - larger)


@dataclass(frozen=True, eq=False)
class _Trial:
    """Time of a step in each part, and of a record [s]; bytes of the file after the first record, and of
    each further record; bytes of memory that the run adds to its problem and state."""

    seconds: dict[str, float]
    first_bytes: float
    record_bytes: float
    grown: int


def _try(problem: Problem, interval: int, together: bool = False) -> _Trial:
    """
    Measure rounds of some steps and a record, from the start of the run with all elements active.

    With ``together`` the surfaces are moved into touch.
    """

    loop = Loop(problem, "")
    rounds: list[Array] = []
    sizes: list[int] = []
    _place(problem, loop.state, together)

    def seconds_of(count: int, records: bool = True) -> Array:
        before, begin = step_seconds(problem, loop.state), loop.output_seconds
        call(lib.ct_run, problem.pointer, loop.state, count, ffi.NULL, 0)
        if records:  # it computes the forces of the next step, which then takes less time
            loop.record(checked=False)
        steps = (step_seconds(problem, loop.state) - before) / count
        return np.append(steps, loop.output_seconds - begin)

    with Held() as held, tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "trial.vtkhdf"
        if problem.parts.output.file is not None and has("hdf5"):
            loop.open(file)
        try:
            loop.start_monitor()
            # The first step fills the caches, and its time gives the number of steps in a round.
            there_is_time = (
                TRIAL_SECONDS / FEWEST_ROUNDS / max(seconds_of(1, records=False).sum(), 1e-9)
            )
            count = max(1, min(interval, MOST_STEPS, int(there_is_time)))
            while len(rounds) < FEWEST_ROUNDS or (
                len(rounds) < MOST_ROUNDS and count * np.sum(rounds) < TRIAL_SECONDS
            ):
                rounds.append(seconds_of(count))
                sizes.append(file.stat().st_size if file.exists() else 0)
        finally:
            loop.abandon()
    # The median excludes rounds that another program interrupted.
    middle = np.median(rounds[1:], axis=0)
    seconds = by_name(problem, middle[:-1]) | {OUTPUT: float(middle[-1])}
    growth = (sizes[-1] - sizes[0]) / (len(sizes) - 1)
    return _Trial(seconds, sizes[0], growth, held.bytes)


def _place(problem: Problem, state: Any, together: bool) -> None:
    """Stretch all bodies slightly, which makes every element active; ``together`` also moves them into
    touch."""
    u, free = problem.rows(state.displacement), problem.rows(problem.pointer.inverse_mass) > 0.0
    u += STRETCH * problem.rows(problem.pointer.reference) * free
    moved = set()
    for touch in first_touch(problem) if together else ():
        # A body that may touch several others is moved to one of them.
        if touch.body not in moved and touch.shift.any():
            u[problem.bodies[touch.body].nodes] += touch.shift
            moved.add(touch.body)


# The rehearsal.


@dataclass(frozen=True, eq=False)
class Rehearsal:
    """
    Counters of the run of a coarse problem.

    Attributes
    ----------
    coarse : Problem
        The scene with larger elements; the problem itself if that is cheap enough.
    steps : int
        Steps that the real run will take; fewer than requested if it ends at rest.
    acted : ndarray, shape (windows, effects)
        Whether an effect acted in a window of the run, that is, its impulses changed.
    seconds : ndarray, shape (effects + 1,)
        Mean time of one coarse step in each effect and, last, in the time loop.
    computed : float
        Fraction of the element forces that were computed, :eq:`sleep-share`.
    rounds : float
        Solver rounds times constraints, per coarse step.
    """

    coarse: Problem
    steps: int
    acted: npt.NDArray[np.bool_]
    seconds: Array
    computed: float
    rounds: float


def rehearse(problem: Problem) -> list[Rehearsal]:
    """Compute the scene with larger elements, twice: with the smallest elements that are cheap enough, and with
    larger ones; only the problem itself if that is cheap enough. Empty if no mesh is cheap enough, as for large
    bodies with meshes of their own, or if the coarse run fails."""
    most = max(MOST_UPDATES, MOST_FRACTION * _updates(problem, 1.0))
    sizes = (1.1**k for k in range(100))
    times = next((q for q in sizes if _updates(problem, q) <= min(most, MOST_EVER)), math.inf)
    # A coarse body lacks nodes that a user's effect lists by number.
    numbered = not all(isinstance(own.given, str) for own in problem.own)
    if times > 1.0 and (numbered or math.isinf(times)):
        return []
    try:
        if times == 1.0:
            return [_observe(problem, problem.step_count)]
        return [_observe(_coarse(problem, q), problem.step_count) for q in (times, COARSER * times)]
    except Error:
        return []


def _coarse(problem: Problem, times: float) -> Problem:
    """The scene with elements that are ``times`` times larger, at the same fraction of its stable step."""
    parts = problem.parts
    bodies = tuple(_larger(problem, body, times) for body in parts.body)
    steps = {**dict.fromkeys(Time.rivals[0]), "fraction": min(problem.dt / problem.stable.dt, 1.0)}
    time = replace(parts.time, end=problem.end, end_c1t_over=None, **steps)
    own = [copy.copy(own) for own in problem.own]
    return Problem(replace(parts, body=bodies, time=time), problem.file, problem.threads, own)


def _larger(problem: Problem, body: Body, times: float) -> Body:
    """A body with elements that are ``times`` times larger, numbered along the same axis. A body with a
    mesh of its own is returned unchanged."""
    if body.shape is None:
        return body
    larger = body.lattice.scaled(1.0 / times, FEWEST_AROUND)
    if body.box:
        larger = replace(larger, layers=problem.layers(body))
    return replace(body, **{body.shape: larger})


def _updates(problem: Problem, times: float) -> float:
    """Approximate cost of a run with elements that are ``times`` times larger, in updates of one element."""
    elements, whole, shorter = 0.0, 0.0, 1.0
    for name, body in problem.parts.bodies.items():
        count = fewer = len(problem.bodies[name].mesh.elements)
        if body.shape is not None:
            larger = body.lattice.scaled(1.0 / times, FEWEST_AROUND)
            fewer = larger.counts()[0]
            shorter = min(shorter, np.divide(larger.cells, body.lattice.cells).mean())
        elements, whole = elements + fewer, whole + count
    touching = sum(one.node_count for one in problem.made if one.kind in TOUCHING)
    # The stable step is proportional to the size of the elements. The number of nodes on surfaces goes
    # with the power 2/3 of the number of elements.
    faces = touching * (elements / whole) ** (2 / 3)
    return float((elements + NODE_UPDATES * faces) * problem.step_count * shorter)


def _observe(coarse: Problem, steps: int) -> Rehearsal:
    """Run the coarse problem, which represents a run of ``steps``. Of repeated short runs the fastest
    counts, because other programs disturbed it least."""
    begin = clock.process_time()
    passes = [_pass(coarse, steps)]
    while len(passes) < PASSES and clock.process_time() - begin < PASS_SECONDS:
        passes.append(_pass(coarse, steps))
    return min(passes, key=lambda one: float(one.seconds.sum()))


def _pass(coarse: Problem, steps: int) -> Rehearsal:
    """
    Run the coarse problem to its end, or to rest if the scene ends there, and record which effects
    acted in each window.
    """
    state = new_state(coarse)
    windows = min(WINDOWS, max(1, coarse.step_count // FEWEST_STEPS))
    # The first effect, the elements, records no impulse.
    ends = np.cumsum([0, 0, *(effect.node_count for effect in coarse.made[1:])])
    acted: list[list[bool]] = []
    impulse = _impulse(state)
    while not (len(acted) == windows or (acted and _at_rest(coarse, state))):
        target = round((len(acted) + 1) / windows * coarse.step_count)
        call(lib.ct_run, coarse.pointer, state, target - state.step, ffi.NULL, 0)
        before, impulse = impulse, _impulse(state)
        changed = (impulse != before).any(axis=1)
        acted.append([changed[first:end].any() for first, end in zip(ends, ends[1:])])
    return Rehearsal(
        coarse,
        math.ceil(len(acted) / windows * steps),
        np.array(acted),
        step_seconds(coarse, state) / state.step,
        computed_fraction(state),
        state.constraint_rounds / state.step,
    )


def _impulse(state: Any) -> Array:
    """The impulses of all effects at their nodes (rows, 3): the sum of both parts, :eq:`impulse-parts`."""
    if not state.impulse_count:
        return np.empty((0, 3))
    parts = np.frombuffer(ffi.buffer(state.impulse, 8 * state.impulse_count), np.float64)
    return np.asarray(parts.reshape(2, -1, 3).sum(axis=0))


def _at_rest(problem: Problem, state: Any) -> bool:
    """Whether a run with ``until_static`` would end in this state."""
    wanted = problem.parts.time.until_static
    if wanted is None or state.time < problem.settled:
        return False
    residual: float = ask("double *", lib.ct_energy_residual, problem.pointer, state)
    return bool(residual <= wanted)


# The table.


def table(costs: Sequence[Cost], stable: float) -> str:
    """Costs as lines of a table, with the stable step, to whose bound each effect contributes,
    :eq:`plan-share`."""
    from rich.table import Column, Table

    rows = [_row(cost, stable) for cost in costs]
    sums = {
        key: _total([getattr(cost, key) for cost in costs]) for key in ("predicted", "measured")
    }
    rows.append({"": "together", **{key: shown_seconds(value) for key, value in sums.items()}})
    told = any(cost.measured is not None for cost in costs)
    heads = [head for head in rows[0] if told or head not in ("done", "measured")]
    columns = [Column(head, justify="right" if head else "left") for head in heads]
    out = Table(*columns, box=None, pad_edge=False, padding=(0, 3, 0, 0))
    for row in rows:
        out.add_row(*(row.get(head, "") for head in heads))
    return table_text(out)


def _row(cost: Cost, stable: float) -> dict[str, str]:
    """A row of the table, by the headings of its columns."""
    # The contribution of the effect to 4 / dt² = W + 2 D / dt.
    bound = (cost.omega_squared + 2.0 * cost.rate / stable) * stable**2 / 4.0
    return {
        "": cost.name,
        "nodes": str(cost.nodes or ""),
        "a step": shown_seconds(cost.seconds_a_step or None),
        "work": f"{100 * cost.active:.0f} %",
        "done": "" if cost.done is None else f"{100 * cost.done:.0f} %",
        "predicted": shown_seconds(cost.predicted),
        "measured": shown_seconds(cost.measured),
        "flops": f"{cost.flops:.2g}" if cost.flops else "",
        "bytes": f"{cost.bytes:.2g}" if cost.bytes else "",
        "of the bound": f"{100 * bound:.1f} %" if bound else "",
    }


def _total(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return math.fsum(known) if known and len(known) == len(values) else None


def shown_seconds(value: float | None) -> str:
    if value is None or not math.isfinite(value):
        return "-"
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if value >= size:
            return f"{value / size:.3g} {unit}"
    return f"{1e9 * value:.3g} ns"
