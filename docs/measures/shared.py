"""The list of measurements, and what several of them use."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

import libcontact as ct

DOCS = Path(__file__).resolve().parents[1]
ROOT = DOCS.parent
Numbers = dict[str, float]
MEASUREMENTS: dict[str, Callable[[], Numbers]] = {}


def measurement(function: Callable[[], Numbers]) -> Callable[[], Numbers]:
    """List a function as one whose numbers pages quote."""
    MEASUREMENTS[function.__name__] = function
    return function


def scene_of(young: float = 1.0, poisson: float = 0.0, density: float = 1.0) -> ct.Scene:
    """A scene in m, kg and s with one material, "elastic", and no body yet."""
    return ct.Scene(
        title="measured", units={"length": "m", "mass": "kg", "time": "s"}
    ).add_material("elastic", young=young, poisson=poisson, density=density)


def stable_step(scene: ct.Scene) -> float:
    """The stable step that the library reports."""
    return scene.explain().data["time"]["stable"]


def hat(x: np.ndarray, n: int) -> np.ndarray:
    """Shape functions (n + 1, points) of n equal linear elements on 0 ... 1."""
    return np.maximum(1 - np.abs(n * x - np.arange(n + 1)[:, None]), 0)
