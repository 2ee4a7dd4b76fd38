"""
The plan of a run: what each effect will cost, predicted from a trial of a few steps on this machine, and what it did cost.

The trial works on a state of its own, which the run never sees. In it every body is shaken by a trillionth of an element and surfaces that will meet are moved
together, so that nothing is left out and each effect shows its full price. The prediction is that price times the steps in which the effect
has work to do: contact from the first possible touch on, elements from when a force can have reached them.
"""

from __future__ import annotations

import contextlib
import math
import tempfile
import time as clock
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ._core import ffi, lib
from .activity import active_share, first_touch
from .errors import Error, check, new_error
from .problem import Problem, new_state

TRIAL_STEPS, TRIAL_SECONDS = 30, 0.25
SHAKE = 1e-12
LOOP, OUTPUT = "time loop", "output"


@dataclass(frozen=True)
class Cost:
    """
    What one part of a run costs: an effect (all of its name together), the ``"time loop"`` around them, or the ``"output"``.

    ``seconds_a_step`` while it has full work [s], ``active`` the share of that work that the run will see, ``predicted`` and ``measured`` [s]
    over the whole run (None where not known), ``flops`` and ``bytes`` a step (0: not counted), ``nodes`` that it acts on, and
    its part ``omega_squared`` [1/time²] and ``rate`` [1/time] of the bound on the step.
    """

    name: str
    nodes: int = 0
    seconds_a_step: float = 0.0
    active: float = 1.0
    predicted: float | None = None
    measured: float | None = None
    flops: float = 0.0
    bytes: float = 0.0
    omega_squared: float = 0.0
    rate: float = 0.0


def predict(problem: Problem, records: int) -> list[Cost]:
    """The costs of a run that records ``records`` times; without predictions where the trial can't be made."""
    state = new_state(problem)
    parts = _parts(problem, state)
    try:
        _prepare(problem, state)
        seconds = _trial(problem, state)
        seconds[OUTPUT] = _record_seconds(problem, state)
    except Error:
        return [Cost(name, **part) for name, part in parts.items()]
    steps = problem.step_count
    touch = first_touch(problem)
    out = []
    for name, part in parts.items():
        active = active_share(problem, touch) if name == "solid" else _touch_share(problem, touch, name) if name in ("contact", "obstacle") else 1.0
        count = records if name == OUTPUT else steps
        out.append(Cost(name, seconds_a_step=seconds[name], active=active, predicted=seconds[name] * active * count, **part))
    return out


def measured(problem: Problem, state: Any, output_seconds: float) -> dict[str, float]:
    """Seconds of a run by effect name, from the clock of its state."""
    out = dict.fromkeys([*problem.effects, LOOP, OUTPUT], 0.0)
    for k, name in enumerate([*problem.effects, LOOP]):
        out[name] += state.effect_seconds[k]
    out[OUTPUT] = output_seconds
    return {name: seconds for name, seconds in out.items() if not _is_reaction(problem, name)}


def _is_reaction(problem: Problem, name: str) -> bool:
    """Whether an effect only holds nodes: its work is done by the time loop."""
    return all(problem.pointer.effects[k].reaction for k, other in enumerate(problem.effects) if other == name) and name in problem.effects


def _parts(problem: Problem, state: Any) -> dict[str, dict[str, Any]]:
    """What is known of each effect without a trial."""
    out: dict[str, dict[str, Any]] = {}
    omega_squared, rate, error = ffi.new("double *"), ffi.new("double *"), new_error()
    for k, name in enumerate(problem.effects):
        if _is_reaction(problem, name):
            continue
        effect = problem.pointer.effects[k]
        check(lib.ct_stable_share(problem.pointer, state, k, omega_squared, rate, error), error)
        part = out.setdefault(name, {"nodes": 0, "flops": 0.0, "bytes": 0.0, "omega_squared": 0.0, "rate": 0.0})
        for key, value in (("nodes", effect.node_count), ("flops", effect.flops), ("bytes", effect.bytes),
                           ("omega_squared", omega_squared[0]), ("rate", rate[0])):
            part[key] += value
    elements = [(len(body.mesh.elements), body) for body in problem.bodies.values()]
    out["solid"]["flops"] = sum(count * body.flops for count, body in elements)
    out["solid"]["bytes"] = sum(count * body.bytes for count, body in elements)
    nodes = problem.pointer.node_count
    # The kick and drift of a degree of freedom: 6 operations; 3 arrays read, 3 read and written.
    out[LOOP] = {"nodes": nodes, "flops": 18.0 * nodes, "bytes": 3.0 * nodes * 8.0 * 8.0}
    out[OUTPUT] = {}
    return out


def _prepare(problem: Problem, state: Any) -> None:
    """Shake all nodes a little, and move surfaces that are apart together."""
    count = problem.pointer.node_count
    u = np.frombuffer(ffi.buffer(state.displacement, 24 * count), np.float64).reshape(-1, 3)
    edge = min(body.mesh.shortest_edge for body in problem.bodies.values())
    moved = set()
    for move in first_touch(problem):
        # A body that several things wait for can be brought to one of them only.
        if move.body not in moved and move.shift.any():
            u[problem.bodies[move.body].nodes] += move.shift
            moved.add(move.body)
    shake = SHAKE * edge * np.random.default_rng(1).uniform(-1.0, 1.0, u.shape)
    for body in problem.bodies.values():
        # A layer in plane strain would leave its plane, and its kernel leaves nothing out.
        if body.kernel != "plane":
            u[body.nodes] += shake[body.nodes]


def _trial(problem: Problem, state: Any) -> dict[str, float]:
    """Seconds a step of each effect and of the time loop: the median over the steps of the trial."""
    names = [*problem.effects, LOOP]
    error, begin, rows = new_error(), clock.perf_counter(), []
    before = np.zeros(len(names))
    for _ in range(TRIAL_STEPS):
        check(lib.ct_step(problem.pointer, state, error), error)
        now = np.array([state.effect_seconds[k] for k in range(len(names))])
        rows.append(now - before)
        before = now
        if clock.perf_counter() - begin > TRIAL_SECONDS and len(rows) > 2:
            break
    # The first steps wake the caches and the search.
    typical = np.median(rows[min(2, len(rows) - 1):], axis=0)
    out = dict.fromkeys(names, 0.0)
    for name, seconds in zip(names, typical):
        out[name] += float(seconds)
    return out


def _record_seconds(problem: Problem, state: Any) -> float:
    """Seconds of one record, written to a file that is thrown away."""
    from .loop import Loop

    loop = Loop(problem, "")
    loop.state = state
    loop.start_guard()
    with tempfile.TemporaryDirectory() as folder, contextlib.suppress(OSError):
        if problem.parts.output.file is not None and hasattr(lib, "ct_output_create"):
            loop.open(Path(folder) / "trial.vtkhdf")
        times = []
        for _ in range(3):
            begin = clock.perf_counter()
            loop.record()
            times.append(clock.perf_counter() - begin)
            check(lib.ct_step(problem.pointer, state, new_error()))
        loop.abandon()
        return min(times[1:])
    return math.nan


def _touch_share(problem: Problem, touch: list[Any], name: str) -> float:
    """Share of the run after the first possible touch, the mean over the contacts or over the obstacles."""
    shares = [max(0.0, 1.0 - move.time / problem.end) for move in touch if move.name == name]
    return sum(shares) / len(shares) if shares else 1.0


def table(costs: list[Cost], stable: float) -> list[str]:
    """The costs as lines of text; ``stable``: the stable step, of which each effect's bound takes a part."""
    told = any(cost.measured is not None for cost in costs)
    head = f"  {'':<14}{'nodes':>9}{'a step':>11}{'work':>7}{'predicted':>12}" + (f"{'measured':>12}" if told else "")
    lines = [head + f"{'flops':>10}{'bytes':>10}{'of the bound':>14}"]
    whole = 4.0 / stable**2
    for cost in costs:
        # How much of 4 / dt² = W + 2 D / dt belongs to the effect.
        share = (cost.omega_squared + 2.0 * cost.rate / stable) / whole
        line = f"  {cost.name:<14}{cost.nodes or '':>9}{_seconds(cost.seconds_a_step or None):>11}{100 * cost.active:>5.0f} %{_seconds(cost.predicted):>12}"
        line += f"{_seconds(cost.measured):>12}" if told else ""
        line += f"{_count(cost.flops):>10}{_count(cost.bytes):>10}" + (f"{100 * share:>12.1f} %" if share else "")
        lines.append(line.rstrip())
    sums = [math.fsum(values) if None not in values and values else None
            for values in ([cost.predicted for cost in costs], [cost.measured for cost in costs])]
    lines.append(f"  {'together':<14}{'':>27}{_seconds(sums[0]):>12}" + (f"{_seconds(sums[1]):>12}" if told else ""))
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
