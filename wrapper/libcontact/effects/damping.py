"""``[damping]``: a force against the velocity, proportional to mass, or dynamic relaxation (chapter
"Damping")."""

from __future__ import annotations

from ..model import FORWARD
from ..schema import Flag, key
from ..units import Units
from . import OnBodies


class Damping(OnBodies):
    """Velocities decay at a given rate, or at a rate that dynamic relaxation estimates.

    Attributes
    ----------
    rate
        Rate at which velocities decay (:doc:`/theory/damping`).
    relaxation
        The rate is estimated so that the bodies reach equilibrium quickly (:eq:`relaxation-rate`).
        Only the state of equilibrium has a meaning, not the motion; see ``until_static``. The
        ``restitution`` of contacts and obstacles is 0 by default then, as energy that they give back
        keeps points in motion.
    """

    without = "no [damping]: motion does not decay"
    one = (("rate", "relaxation"),)

    rate: float | None = key(FORWARD, unit="1 / time", default=None, says="one of two")
    relaxation: bool | None = key(
        Flag(", or leave it out and give a rate"), default=None, says="one of two"
    )

    def describe(self, units: Units) -> str:
        if self.rate is None:
            return f"dynamic relaxation, {self.whom}: only the state of rest has a meaning, not the motion"
        return f"velocities decay by {self.rate:g} 1/{units.time}, {self.whom}"
