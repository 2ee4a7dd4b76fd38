"""``[damping]``: a force against the velocity, in proportion to mass, or dynamic relaxation (chapter "Damping")."""

from __future__ import annotations

from ..model import FORWARD
from ..schema import Flag, key
from ..units import Units
from . import OnBodies


class Damping(OnBodies):
    """
    Velocities decay at a given rate, or at one that dynamic relaxation chooses.

    Attributes
    ----------
    rate
        Rate at which velocities decay (:doc:`/theory/damping`).
    relaxation
        The rate is chosen so that bodies come to rest soon; only the state of rest counts
        (:eq:`relaxation-rate`), see ``until_static``.
    """

    without = "no [damping]: motion goes on"
    one = (("rate", "relaxation"),)

    rate: float | None = key(FORWARD, unit="1 / time", default=None, says="one of two")
    relaxation: bool | None = key(
        Flag(", or leave it out and give a rate"), default=None, says="one of two"
    )

    def describe(self, units: Units) -> str:
        if self.rate is None:
            return f"dynamic relaxation, {self.whom}: the way to rest is not the true motion"
        return f"velocities decay by {self.rate:g} 1/{units.time}, {self.whom}"
