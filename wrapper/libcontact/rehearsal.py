"""
A rehearsal of a run: the same scene with larger elements, computed to its end, to count what the run will do.

How long surfaces press, how many of their points, how many rounds the solver of the contact forces takes and which elements
the waves reach cannot be known before a run. These numbers depend on bodies and waves, hardly on the size of the elements. So a
scene with larger elements tells them at a small part of the cost.
"""

from __future__ import annotations

import copy
import math
import time as clock
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from ._core import ffi, lib
from .bridge import ask, call
from .errors import Error
from .model import Body, Time
from .problem import Problem, new_state

Array = npt.NDArray[np.float64]

# Cost limits of a rehearsal, in updates of one element: this number or this fraction of the run, but never more than the
# last. A node that may touch counts as some elements.
MOST_UPDATES, MOST_FRACTION, MOST_EVER, NODE_UPDATES = 1e6, 0.15, 1e8, 50
# The second rehearsal has elements that are this many times larger again.
COARSER = 2.0
# The fewest cells around a ring.
FEWEST_AROUND = 12
# Effects that have no force where nothing touches.
TOUCHING = (lib.CT_EFFECT_CONTACT, lib.CT_EFFECT_OBSTACLE, lib.CT_EFFECT_FRICTION)
# Equal parts of the run's time after which the counters are read, each of some steps.
WINDOWS, FEWEST_STEPS = 240, 4
# A short rehearsal is repeated, for its times.
PASSES, PASS_SECONDS = 3, 0.15


@dataclass(frozen=True, eq=False)
class Rehearsal:
    """
    What the run of a coarse problem counted.

    Attributes
    ----------
    coarse : Problem
        The scene with larger elements; the problem itself where that is cheap enough.
    steps : int
        Steps that the run will take, fewer than it may where it ends at rest.
    pressed : ndarray, shape (windows, effects)
        Whether an effect acted in a part of the run: its impulses changed.
    seconds : ndarray, shape (effects + 1,)
        Mean time of one coarse step in each effect and, last, in the time loop.
    computed : float
        Fraction of the element forces that were computed, :eq:`sleep-share`.
    rounds : float
        Solver rounds times constraints, per coarse step.
    """

    coarse: Problem
    steps: int
    pressed: npt.NDArray[np.bool_]
    seconds: Array
    computed: float
    rounds: float


def computed_share(state: Any) -> float:
    """Return the fraction of the element forces that the steps of a state computed; the others were asleep."""
    computed, left_out = state.element_updates
    return float(computed / max(computed + left_out, 1))


def rehearse(problem: Problem) -> list[Rehearsal]:
    """
    Compute the scene with larger elements, twice.

    Parameters
    ----------
    problem : Problem
        The problem of the run.

    Returns
    -------
    list of Rehearsal
        One with the smallest elements that are cheap enough, and one with larger ones; only the problem itself where that is
        cheap enough. Empty where none is, as for large bodies with meshes of their own, or where the coarse run fails.
    """
    most = max(MOST_UPDATES, MOST_FRACTION * _updates(problem, 1.0))
    sizes = (1.1**k for k in range(100))
    times = next((q for q in sizes if _updates(problem, q) <= min(most, MOST_EVER)), math.inf)
    # Nodes that an effect of the user lists by number do not exist in a coarse body.
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
    """The scene with elements that are some times larger, at the same fraction of its stable step."""
    parts = problem.parts
    bodies = tuple(_larger(problem, body, times) for body in parts.body)
    steps = {**dict.fromkeys(Time.one[1]), "fraction": min(problem.dt / problem.stable.dt, 1.0)}
    time = replace(parts.time, end=problem.end, end_c1t_over=None, **steps)
    own = [copy.copy(own) for own in problem.own]
    return Problem(replace(parts, body=bodies, time=time), problem.file, problem.threads, own)


def _cells(body: Body, times: float) -> tuple[int, int, int] | None:
    """The cells of a body with elements that are some times larger; None where it has a mesh of its own."""
    lattice = body.box or body.ring
    if lattice is None:
        return None
    fewest = (1, 1, 1) if body.box else (1, FEWEST_AROUND, 1)
    x, y, z = (min(n, max(m, round(n / times))) for n, m in zip(lattice.cells, fewest))
    return x, y, z


def _larger(problem: Problem, body: Body, times: float) -> Body:
    """A body with elements that are some times larger, numbered along the same axis; one with a mesh of its own as it is."""
    cells = _cells(body, times)
    if cells and body.box:
        return replace(body, box=replace(body.box, cells=cells, layers=problem.layers(body)))
    return replace(body, ring=replace(body.ring, cells=cells)) if cells and body.ring else body


def effects_of(problem: Problem) -> list[Any]:
    """Return the effects of a problem (``const ct_effect *``)."""
    return [problem.pointer.effects[k] for k in range(len(problem.effects))]


def _updates(problem: Problem, times: float) -> float:
    """The cost of a run with elements that are some times larger, in updates of one element, about."""
    elements, whole, shorter = 0.0, 0.0, 1.0
    for name, body in problem.parts.bodies.items():
        count, cells = len(problem.bodies[name].mesh.elements), _cells(body, times)
        ratios = np.divide(cells, _cells(body, 1.0) or 1.0) if cells else np.ones(3)
        elements, whole = elements + count * ratios.prod(), whole + count
        shorter = min(shorter, ratios.mean())
    touching = sum(one.node_count for one in effects_of(problem) if one.kind in TOUCHING)
    # The stable step grows with the elements, surfaces go with the power 2/3 of their number.
    faces = touching * (elements / whole) ** (2 / 3)
    return float((elements + NODE_UPDATES * faces) * problem.step_count * shorter)


def _observe(coarse: Problem, steps: int) -> Rehearsal:
    """Run the coarse problem, which stands for a run of ``steps``; a short one again, for its times: the fastest was disturbed least by other programs."""
    begin = clock.process_time()
    passes = [_pass(coarse, steps)]
    while len(passes) < PASSES and clock.process_time() - begin < PASS_SECONDS:
        passes.append(_pass(coarse, steps))
    return min(passes, key=lambda one: float(one.seconds.sum()))


def _pass(coarse: Problem, steps: int) -> Rehearsal:
    """Run the coarse problem to its end, or until it is at rest where that ends it, and see after each window which effects pressed."""
    state = new_state(coarse)
    windows = min(WINDOWS, max(1, coarse.step_count // FEWEST_STEPS))
    # The first effect, the elements, has no impulse.
    ends = np.cumsum([0, 0, *(effect.node_count for effect in effects_of(coarse)[1:])])
    pressed: list[list[bool]] = []
    impulse = _impulse(state)
    while not (len(pressed) == windows or (pressed and _at_rest(coarse, state))):
        target = round((len(pressed) + 1) / windows * coarse.step_count)
        call(lib.ct_step_many, coarse.pointer, state, target - state.step)
        before, impulse = impulse, _impulse(state)
        changed = (impulse != before).any(axis=1)
        pressed.append([changed[first:end].any() for first, end in zip(ends, ends[1:])])
    return Rehearsal(
        coarse,
        math.ceil(len(pressed) / windows * steps),
        np.array(pressed),
        step_seconds(coarse, state) / state.step,
        computed_share(state),
        state.constraint_rounds / state.step,
    )


def _impulse(state: Any) -> Array:
    """The impulses of all effects at their nodes (rows, 3): the sum of both parts, :eq:`impulse-parts`."""
    if not state.impulse_count:
        return np.empty((0, 3))
    parts = np.frombuffer(ffi.buffer(state.impulse, 8 * state.impulse_count), np.float64)
    return np.asarray(parts.reshape(2, -1, 3).sum(axis=0))


def step_seconds(problem: Problem, state: Any) -> Array:
    """Return the time that a state's steps took in each effect and, last, in the time loop (effects + 1,) [s]."""
    size = 8 * (len(problem.effects) + 1)
    return np.frombuffer(ffi.buffer(state.effect_seconds, size), np.float64).copy()


def _at_rest(problem: Problem, state: Any) -> bool:
    """Whether a run that ends at rest would end here."""
    wanted = problem.parts.time.until_static
    if wanted is None or state.time < problem.settled:
        return False
    residual: float = ask("double *", lib.ct_energy_residual, problem.pointer, state)
    return residual <= wanted
