"""``[viscosity]``: a pressure that resists compression and spreads a front over a few elements (chapter
"Bulk viscosity")."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ..model import FORWARD
from ..schema import key
from ..units import Units
from . import OnBodies


class Viscosity(OnBodies):
    """A pressure with a part proportional to the strain rate and a part proportional to its square, for bodies with the
    law ``"linear"``.

    Attributes
    ----------
    linear
        Coefficient of the strain rate (:doc:`/theory/viscosity`).
    quadratic
        Coefficient of the square of the strain rate; if it is not 0, the stable step is that of
        ``linear`` + 0.06.
    """

    without = "no [viscosity]: the mesh causes oscillations behind wave fronts"

    linear: float = key(FORWARD, default=0.06)
    quadratic: float = key(FORWARD, default=1.2)

    def refusals(self) -> Iterator[tuple[str, str]]:
        if self.linear == 0.0 and self.quadratic == 0.0:
            yield "linear", "and quadratic are both 0; leave [viscosity] out instead"

    def members(self, maker: Any) -> dict[str, Any]:
        """The bodies that deform."""
        parts = maker.parts
        if self.bodies is not None or not parts.rigid:
            return super().members(maker)
        return dict(maker.bodies([name for name in parts.bodies if name not in parts.rigid_names]))

    def describe(self, units: Units) -> str:
        return f"pressure against compression, linear {self.linear:g} and quadratic {self.quadratic:g}, {self.whom}"
