"""``[gravity]``: a uniform acceleration of bodies, with a history in time (chapter "Gravity")."""

from __future__ import annotations

from typing import Any

from ..model import History, Vector
from ..schema import VECTOR, Nested, key
from ..units import Units
from . import OnBodies


class Gravity(OnBodies):
    """
    A uniform acceleration, times a history.

    Attributes
    ----------
    acceleration
        The acceleration (:doc:`/theory/gravity`).
    history
        A factor in time, piecewise linear. A body that is laid on a floor does not bounce if its weight
        grows slowly. Its column in ``run.energy`` is then the work of the weight.
    """

    without = "no [gravity]: bodies have no weight"

    acceleration: Vector = key(VECTOR, unit="length / time²")
    history: Any = key(Nested(History), default=None, says="1 at all times")

    def members(self, maker: Any) -> dict[str, Any]:
        return {**super().members(maker), "amplitude": maker.history(self.history)}

    def describe(self, units: Units) -> str:
        history = f", with a history of {len(self.history.time)} points" if self.history else ""
        return f"{list(self.acceleration)} {units.length}/{units.time}^2 on {self.whom}{history}"
