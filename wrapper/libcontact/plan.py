"""
The plan of a run: what each effect will cost, predicted from a rehearsal and a trial on this machine, and what it did cost.

What a step costs depends on where the run is: surfaces are far, near, pressing. So the prices are measured with the true scene
in states that a rehearsal with larger elements goes through, each with the share of the run that it stands for. The trial works
on a state of its own, which the run never sees; in it every body is shaken by a trillionth of an element, so that none is left
out. Elements have a second price, that of being left out, and the share of those that a force can have reached.
"""

from __future__ import annotations

import contextlib
import math
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from . import has
from ._core import ffi, lib
from .activity import Touch, active_share, first_touch
from .errors import Error, check, new_error
from .problem import Problem, new_state
from .rehearsal import Rehearsal, element_count, rehearse, with_larger_elements

# All moments together may take about this time. At each some steps are taken, and those of the second half measured; in a scene
# of costly steps fewer.
TRIAL_SECONDS, MOST_MOMENTS, MOST_STEPS, FEWEST_STEPS, LEAST_STEPS = 0.5, 10, 48, 20, 4
IDLE_STEPS = 32
# A problem of more elements has its trial with larger ones.
MOST_ELEMENTS = 100_000
# What takes so many times the median of its like was interrupted by something else and does not count.
INTERRUPTED = 4.0
SHAKE = 1e-12
# Effects that have no force where nothing touches.
TOUCHING = ("contact", "obstacle", "friction")
LOOP, OUTPUT = "time loop", "output"
# The rounds of the iteration for contact forces, a step, each times the constraints in it, stand among the seconds under this
# name.
ROUNDS = "rounds"


@dataclass(frozen=True)
class Cost:
    """
    What one part of a run costs: an effect (all of its name together), the ``"time loop"`` around them, or the ``"output"``.

    ``seconds_a_step`` [s], the mean over the run (of the output: of a record), ``active`` the share of its elements that are
    computed or of the steps in which its surfaces press, ``done`` that share of the elements as a run has counted it,
    ``predicted`` and ``measured`` [s] over the whole run (None where not known), ``flops`` and ``bytes`` a step (0: not counted), ``nodes`` that it acts on, and its part ``omega_squared`` [1/time²]
    and ``rate`` [1/time] of the bound on the step.
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


def predict(problem: Problem, records: int) -> list[Cost]:
    """The costs of a run that records ``records`` times; without predictions where the trial can't be made."""
    parts = _parts(problem)
    try:
        small = _smaller(problem)
        prices = _prices(small, records)
    except (Error, OSError):
        return [Cost(name, **part) for name, part in parts.items()]
    # What a part costs goes with the nodes that it acts on.
    sizes, smaller = _sizes(problem), _sizes(small)
    ratio = {name: sizes[name] / smaller[name] if smaller[name] else 1.0 for name in sizes}
    seconds, rounds = (
        {name: price * ratio[name] for name, price in prices.seconds.items()},
        prices.rounds * ratio[ROUNDS],
    )
    _add_rounds(problem, parts, rounds)
    counts = {OUTPUT: records}
    steps = round(prices.steps * problem.step_count / small.step_count)
    return [
        Cost(
            name,
            seconds_a_step=seconds[name],
            active=prices.active.get(name, 1.0),
            predicted=seconds[name] * counts.get(name, steps),
            **part,
        )
        for name, part in parts.items()
    ]


@dataclass(frozen=True, eq=False)
class _Prices:
    """What a trial found: ``seconds`` a step of each part (of the output: a record), the share in which each is ``active``, the ``steps`` of the run, and the ``rounds`` a step."""

    seconds: dict[str, float]
    active: dict[str, float]
    steps: int
    rounds: float


def _smaller(problem: Problem) -> Problem:
    """The problem that the trial is made with: a very large one with larger elements, if it can have them, as prices then go with the size."""
    if element_count(problem, problem.parts.bodies) <= MOST_ELEMENTS:
        return problem
    fraction = min(problem.dt / problem.stable.dt, 1.0)
    return (
        with_larger_elements(
            problem, lambda bodies: element_count(problem, bodies), MOST_ELEMENTS, fraction
        )
        or problem
    )


def _sizes(problem: Problem) -> dict[str, int]:
    """Nodes that each part acts on, and the constraints of all that press."""
    effects = [problem.pointer.effects[k] for k in range(len(problem.effects))]
    out = dict.fromkeys(problem.effects, 0)
    for name, effect in zip(problem.effects, effects):
        out[name] += effect.node_count
    return out | {
        LOOP: problem.pointer.node_count,
        OUTPUT: problem.pointer.node_count,
        ROUNDS: sum(effect.constraint_count for effect in effects),
    }


def _prices(problem: Problem, records: int) -> _Prices:
    """Prices of a problem, from a trial."""
    state = new_state(problem)
    touch = first_touch(problem)
    rehearsal = rehearse(problem)
    steps = problem.step_count if rehearsal is None else rehearsal.steps
    begins = None if rehearsal is None else rehearsal.begins()
    active = active_share(problem, touch, steps, begins)
    idle = _idle(problem, state) if active < 1.0 else {}
    with _recorder(problem, state) as loop:
        interval = max(1, steps // max(1, records - 1))
        if rehearsal is None:
            seconds = _touching(problem, loop, touch, interval)
        else:
            seconds = _rehearsed(problem, loop, rehearsal, interval)
    begun = active_share(problem, touch, IDLE_STEPS, begins)
    for name, price in idle.items():
        # What a step costs with no element at work, from the first steps, where some are.
        asleep = (price - begun * seconds[name]) / (1.0 - begun) if begun < 1.0 else seconds[name]
        seconds[name] = active * seconds[name] + (1.0 - active) * min(
            max(asleep, 0.0), seconds[name]
        )
    shares = {"solid": active}
    for name in set(TOUCHING).intersection(problem.effects):
        if rehearsal is None:
            shares[name] = _touch_share(problem, touch, name)
            seconds[name] *= shares[name]
        else:
            shares[name] = max(
                rehearsal.active(k) for k, other in enumerate(problem.effects) if other == name
            )
    return _Prices(seconds, shares, steps, seconds.pop(ROUNDS))


def measured(problem: Problem, state: Any, output_seconds: float) -> dict[str, float]:
    """Seconds of a run by effect name, from the clock of its state."""
    out = dict.fromkeys([*problem.effects, LOOP, ROUNDS], 0.0)
    for k, name in enumerate([*problem.effects, LOOP]):
        out[name] += state.effect_seconds[k]
    out[OUTPUT] = output_seconds
    return {name: seconds for name, seconds in out.items() if not _is_reaction(problem, name)}


def computed_share(state: Any) -> float:
    """The share of the elements' forces that a state's steps have computed; the others were quiet."""
    computed, left_out = state.element_updates
    return computed / max(computed + left_out, 1)


def _is_reaction(problem: Problem, name: str) -> bool:
    """Whether an effect only holds nodes: its work is done by the time loop."""
    return name in problem.effects and all(
        problem.pointer.effects[k].phase == lib.CT_PHASE_REACTION
        for k, other in enumerate(problem.effects)
        if other == name
    )


def _parts(problem: Problem) -> dict[str, dict[str, Any]]:
    """What is known of each effect without a trial."""
    state = new_state(problem)
    out: dict[str, dict[str, Any]] = {}
    omega_squared, rate, error = ffi.new("double *"), ffi.new("double *"), new_error()
    for k, name in enumerate(problem.effects):
        if _is_reaction(problem, name):
            continue
        effect = problem.pointer.effects[k]
        check(lib.ct_stable_share(problem.pointer, state, k, omega_squared, rate, error), error)
        part = out.setdefault(
            name, {"nodes": 0, "flops": 0.0, "bytes": 0.0, "omega_squared": 0.0, "rate": 0.0}
        )
        for key, value in (
            ("nodes", effect.node_count),
            ("flops", effect.flops),
            ("bytes", effect.bytes),
            ("omega_squared", omega_squared[0]),
            ("rate", rate[0]),
        ):
            part[key] += value
    elements = [(len(body.mesh.elements), body) for body in problem.bodies.values()]
    out["solid"]["flops"] = sum(count * body.flops for count, body in elements)
    out["solid"]["bytes"] = sum(count * body.bytes for count, body in elements)
    nodes = problem.pointer.node_count
    # The kick and drift of a degree of freedom: 6 operations; 3 arrays read, 3 read and written.
    out[LOOP] = {"nodes": nodes, "flops": 18.0 * nodes, "bytes": 3.0 * nodes * 8.0 * 8.0}
    out[OUTPUT] = {}
    return out


def _add_rounds(problem: Problem, parts: dict[str, dict[str, Any]], rounds: float) -> None:
    """
    Operations and bytes of the iteration for contact forces, shared out among contacts and obstacles by their points, as the
    time loop does with the time.
    """
    effects = [problem.pointer.effects[k] for k in range(len(problem.effects))]
    points = sum(effect.constraint_count for effect in effects)
    for name, effect in zip(problem.effects, effects):
        if effect.constraint_count:
            share = rounds * effect.constraint_count / points
            # A point of a contact moves the nodes of two faces.
            faces = _face_nodes(problem) * (2 if effect.kind == lib.CT_EFFECT_CONTACT else 1)
            parts[name]["flops"] += share * (60.0 + 15.0 * faces)
            parts[name]["bytes"] += share * (ffi.sizeof("ct_constraint") + 8.0 * 8.0 * faces)


def _face_nodes(problem: Problem) -> int:
    """Nodes of a face, the most of all bodies."""
    return max(4 if body.mesh.element == "hex8" else 8 for body in problem.bodies.values())


def _idle(problem: Problem, state: Any) -> dict[str, float]:
    """
    Seconds a step of the elements and of the time loop in the first steps of the run, with all that can be left out left out.
    """
    solid, loop, error, best = 0, len(problem.effects), new_error(), [math.inf, math.inf]
    for _ in range(2):
        before = [state.effect_seconds[k] for k in (solid, loop)]
        check(lib.ct_step_many(problem.pointer, state, IDLE_STEPS // 2, error), error)
        seconds = [
            2.0 * (state.effect_seconds[k] - start) / IDLE_STEPS
            for k, start in zip((solid, loop), before)
        ]
        best = [min(pair) for pair in zip(best, seconds)]
    return {"solid": best[0], LOOP: best[1]}


def _rehearsed(
    problem: Problem, loop: Any, rehearsal: Rehearsal, interval: int
) -> dict[str, float]:
    """Seconds a step of each effect and of the time loop, and of a record, the means over states that stand for the run."""
    state = loop.state
    memory = (
        np.frombuffer(ffi.buffer(state.memory, 8 * state.memory_count), np.float64)
        if state.memory_count
        else np.empty(0)
    )
    room = _room(problem, loop)
    steps = int(min(MOST_STEPS, max(room / MOST_MOMENTS, FEWEST_STEPS), max(room, LEAST_STEPS)))
    out, records = dict.fromkeys([*problem.effects, LOOP, ROUNDS], 0.0), []
    for moment in rehearsal.moments(int(min(MOST_MOMENTS, max(1.0, room / steps)))):
        _place(problem, state, moment.displacement, moment.velocity)
        # Nothing is remembered of the state before.
        memory[:] = 0.0
        state.step, state.time = moment.step, moment.step * problem.dt
        trial = _trial(problem, loop, interval, steps // 2, steps - steps // 2)
        records.append((trial.pop(OUTPUT), moment.share))
        for name, seconds in trial.items():
            out[name] += moment.share * seconds
    seconds, shares = np.array(records).T
    whole = seconds <= INTERRUPTED * np.median(seconds)
    return out | {OUTPUT: float(np.average(seconds[whole], weights=shares[whole]))}


def _touching(problem: Problem, loop: Any, touch: list[Touch], interval: int) -> dict[str, float]:
    """
    Seconds a step of each effect and of the time loop, and of a record, while all surfaces touch, which are moved together for
    it.
    """
    u, moved = np.zeros((problem.pointer.node_count, 3)), set()
    for move in touch:
        # A body that several things wait for can be brought to one of them only.
        if move.body not in moved and move.shift.any():
            u[problem.bodies[move.body].nodes] += move.shift
            moved.add(move.body)
    _place(problem, loop.state, u, None)
    steps = int(min(MOST_STEPS, max(_room(problem, loop), LEAST_STEPS)))
    return _trial(problem, loop, interval, steps // 2, steps - steps // 2)


def _room(problem: Problem, loop: Any) -> float:
    """How many steps the trial may take."""
    seconds = _trial(problem, loop, 1, 1, 2)
    return TRIAL_SECONDS / sum(seconds[name] for name in (*set(problem.effects), LOOP))


def _place(
    problem: Problem, state: Any, displacement: np.ndarray, velocity: np.ndarray | None
) -> None:
    """Put the nodes there and shake them a little, so that no element is left out."""
    count = problem.pointer.node_count
    u = np.frombuffer(ffi.buffer(state.displacement, 24 * count), np.float64).reshape(-1, 3)
    edge = min(body.mesh.shortest_edge for body in problem.bodies.values())
    shake = SHAKE * edge * np.random.default_rng(1).uniform(-1.0, 1.0, u.shape)
    for body in problem.bodies.values():
        u[body.nodes] = displacement[body.nodes]
        u[body.nodes] += (
            shake[body.nodes]
            if body.kernel != "plane"
            else _in_plane(problem, body, shake[body.nodes])
        )
    if velocity is not None:
        np.frombuffer(ffi.buffer(state.velocity, 24 * count), np.float64).reshape(-1, 3)[:] = (
            velocity
        )


def _in_plane(problem: Problem, body: Any, shake: np.ndarray) -> np.ndarray:
    """Numbers (nodes, 3) that move both layers of a body in plane strain alike, and not along its thickness."""
    held = (
        np.frombuffer(
            ffi.buffer(problem.pointer.inverse_mass, 24 * problem.pointer.node_count), np.float64
        ).reshape(-1, 3)[body.nodes]
        == 0.0
    )
    across = next(
        k for k in range(3) if held[:, k].all() and len(np.unique(body.mesh.nodes[:, k])) == 2
    )
    below = body.mesh.nodes[:, across] == body.mesh.nodes[:, across].min()
    low, high = np.flatnonzero(below), np.flatnonzero(~below)
    place = np.delete(body.mesh.nodes, across, axis=1)
    out = np.zeros_like(shake)
    for nodes in (low, high):
        out[nodes[np.lexsort(place[nodes].T)]] = shake[low]
    out[:, across] = 0.0
    return out


def _trial(problem: Problem, loop: Any, interval: int, warm: int, count: int) -> dict[str, float]:
    """
    Seconds a step of each effect and of the time loop: the mean over ``count`` steps after ``warm`` ones, which wake the caches
    and the search; and of a record after them, ``interval`` steps after another one. Steps that were interrupted do not count.
    """
    names, state = [*problem.effects, LOOP], loop.state
    error, rows = new_error(), []
    # The state was put here: what a guard knows of its energy begins anew.
    loop.start_guard()
    for _ in range(warm):
        check(lib.ct_step(problem.pointer, state, error), error)
    before, rounds = (
        np.array([state.effect_seconds[k] for k in range(len(names))]),
        state.constraint_rounds,
    )
    for left in range(count, 0, -1):
        # The record that is measured comes as long after another one as in the run.
        if left == min(count, interval):
            loop.record()
        check(lib.ct_step(problem.pointer, state, error), error)
        now = np.array([state.effect_seconds[k] for k in range(len(names))])
        rows.append(now - before)
        before = now
    out = dict.fromkeys(names, 0.0)
    for name, seconds in zip(names, np.array(rows).T):
        out[name] += float(seconds[seconds <= INTERRUPTED * np.median(seconds)].mean())
    out[ROUNDS] = (state.constraint_rounds - rounds) / count
    out[OUTPUT] = _record(loop)
    if interval <= count:
        # Where records come often, as in the run, each is made with what the one before has left in the caches.
        for _ in range(interval):
            check(lib.ct_step(problem.pointer, state, error), error)
        out[OUTPUT] = _record(loop)
    return out


def _record(loop: Any) -> float:
    """Seconds of a record."""
    begin = loop.output_seconds
    loop.record()
    return loop.output_seconds - begin


@contextlib.contextmanager
def _recorder(problem: Problem, state: Any) -> Iterator[Any]:
    """A loop that records the state, into a file that is thrown away."""
    from .loop import Loop

    loop = Loop(problem, "")
    loop.state = state
    with tempfile.TemporaryDirectory() as folder:
        if problem.parts.output.file is not None and has("hdf5"):
            loop.open(Path(folder) / "trial.vtkhdf")
        try:
            yield loop
        finally:
            loop.abandon()


def _touch_share(problem: Problem, touch: list[Any], name: str) -> float:
    """Share of the run after the first possible touch, the mean over the contacts or over the obstacles."""
    shares = [max(0.0, 1.0 - move.time / problem.end) for move in touch if move.name == name]
    return sum(shares) / len(shares) if shares else 1.0


def table(costs: list[Cost], stable: float) -> list[str]:
    """The costs as lines of text; ``stable``: the stable step, of which each effect's bound takes a part."""
    told = any(cost.measured is not None for cost in costs)
    head = f"  {'':<14}{'nodes':>9}{'a step':>11}{'work':>7}" + (f"{'done':>7}" if told else "")
    head += f"{'predicted':>12}" + (f"{'measured':>12}" if told else "")
    lines = [head + f"{'flops':>10}{'bytes':>10}{'of the bound':>14}"]
    whole = 4.0 / stable**2
    for cost in costs:
        # How much of 4 / dt² = W + 2 D / dt belongs to the effect.
        share = (cost.omega_squared + 2.0 * cost.rate / stable) / whole
        line = f"  {cost.name:<14}{cost.nodes or '':>9}{_seconds(cost.seconds_a_step or None):>11}{100 * cost.active:>5.0f} %"
        if told:
            line += f"{100 * cost.done:>5.0f} %" if cost.done is not None else f"{'':>7}"
        line += f"{_seconds(cost.predicted):>12}"
        line += f"{_seconds(cost.measured):>12}" if told else ""
        line += f"{_count(cost.flops):>10}{_count(cost.bytes):>10}" + (
            f"{100 * share:>12.1f} %" if share else ""
        )
        lines.append(line.rstrip())
    sums = [
        math.fsum(values) if None not in values and values else None
        for values in ([cost.predicted for cost in costs], [cost.measured for cost in costs])
    ]
    lines.append(
        f"  {'together':<14}{'':>{34 if told else 27}}{_seconds(sums[0]):>12}"
        + (f"{_seconds(sums[1]):>12}" if told else "")
    )
    return lines


def _seconds(value: float | None) -> str:
    if value is None or not math.isfinite(value):
        return "-"
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if value >= size:
            return f"{value / size:.3g} {unit}"
    return f"{value / 1e-9:.3g} ns"


def _count(value: float) -> str:
    return f"{value:.2g}" if value else ""
