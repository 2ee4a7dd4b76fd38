"""Times of a run by effect, as the steps of its state measured them."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._core import ffi, lib
from .bridge import Floats
from .problem import Problem

LOOP, OUTPUT = "time loop", "output"


def measured(problem: Problem, state: Any, output_seconds: float) -> dict[str, float]:
    """The measured time of each part of a run [s] by name, from its last state (``ct_state *``) and the time of
    all records."""
    return by_name(problem, step_seconds(problem, state)) | {OUTPUT: output_seconds}


def by_name(problem: Problem, values: Floats) -> dict[str, float]:
    """Sum the values of the effects and the time loop by name. Supports count as part of the time loop."""
    out: dict[str, float] = {}
    for k, name in enumerate([*problem.effects, LOOP]):
        if name == LOOP or problem.made[k].phase != lib.CT_PHASE_REACTION:
            out[name] = out.get(name, 0.0) + float(values[k])
    return out


def computed_fraction(state: Any) -> float:
    """Return the fraction of the element forces that the steps of a state computed; the others were
    asleep."""
    computed, left_out = state.element_updates
    return float(computed / max(computed + left_out, 1))


def step_seconds(problem: Problem, state: Any) -> Floats:
    """Return the time that a state has spent in each effect and, last, in the time loop (effects + 1,) [s]."""
    size = 8 * (len(problem.effects) + 1)
    return np.frombuffer(ffi.buffer(state.effect_seconds, size), np.float64).copy()
