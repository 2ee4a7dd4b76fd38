"""``[damping]``: forces against the velocity, proportional to mass and to stiffness, or dynamic relaxation
(chapter "Damping")."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ..model import FORWARD, POSITIVE
from ..schema import Flag, key
from ..units import Units
from . import OnBodies


class Damping(OnBodies):
    """Velocities decay at a given rate, rates of strain by a force proportional to the stiffness, or both; or
    motion decays at a rate that dynamic relaxation estimates.

    Attributes
    ----------
    rate
        Rate at which velocities decay (:doc:`/theory/damping`).
    stiffness
        Coefficient of the stiffness (:eq:`stiffness-damping-force`), for bodies with the law ``"linear"``.
        It damps vibrations of short period, leaves rigid motion alone, and shortens the stable step.
    relaxation
        The rate is estimated so that the bodies reach equilibrium quickly (:eq:`relaxation-rate`).
        Only the state of equilibrium has a meaning, not the motion; see ``until_static``. The
        ``restitution`` of contacts and obstacles is 0 by default then, as energy that they give back
        keeps points in motion.
    """

    without = "no [damping]: motion does not decay"
    rivals = (("rate", "relaxation"), ("stiffness", "relaxation"))

    rate: float | None = key(FORWARD, unit="1 / time", default=None, says="none")
    stiffness: float | None = key(POSITIVE, unit="time", default=None, says="none")
    relaxation: bool | None = key(
        Flag(", or leave it out and give a rate"), default=None, says="none"
    )

    def refusals(self) -> Iterator[tuple[str, str]]:
        if self.rate is None and self.stiffness is None and self.relaxation is None:
            yield "", "gives none of rate, stiffness and relaxation; at least one is needed"

    def create(self, maker: Any) -> Any:
        """Create the effect of the rate or of relaxation. That of the stiffness belongs to the bodies
        (``ct_scene_body``), because it needs their kernels."""
        return super().create(maker) if self.rate is not None or self.relaxation else []

    def describe(self, units: Units) -> str:
        if self.relaxation:
            return f"dynamic relaxation, {self.whom}: only the state of rest has a meaning, not the motion"
        parts = [] if self.rate is None else [f"velocities decay by {self.rate:g} 1/{units.time}"]
        if self.stiffness:
            parts.append(f"stiffness times {self.stiffness:g} {units.time} damps rates of strain")
        return f"{' and '.join(parts)}, {self.whom}"
