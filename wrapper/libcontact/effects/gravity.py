"""``[gravity]``: a uniform acceleration of bodies (chapter "Gravity")."""

from __future__ import annotations

from ..model import Vector
from ..schema import VECTOR, key
from ..units import Units
from . import OnBodies


class Gravity(OnBodies):
    """
    A uniform acceleration.

    Attributes
    ----------
    acceleration
        The acceleration (:doc:`/theory/gravity`).
    """

    without = "no [gravity]: bodies have no weight"

    acceleration: Vector = key(VECTOR, unit="length / time²")

    def describe(self, units: Units) -> str:
        return f"{list(self.acceleration)} {units.length}/{units.time}^2 on {self.whom}"
