"""``[viscosity]``: a pressure against compression that spreads a front over a few elements (chapter "Bulk viscosity")."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import FORWARD
from ..schema import key
from ..units import Units
from . import OnBodies


class Viscosity(OnBodies):
    """
    A pressure in proportion to the strain rate and to its square.

    Attributes
    ----------
    linear
        Coefficient of the strain rate (:doc:`/theory/viscosity`).
    quadratic
        Coefficient of the square of the strain rate; with any other than 0 the stable step is that of ``linear`` + 0.06.
    """

    without = "no [viscosity]: fronts ring behind them as the mesh lets them"

    linear: float = key(FORWARD, default=0.06)
    quadratic: float = key(FORWARD, default=1.2)

    def refusals(self) -> Iterator[tuple[str, str]]:
        if self.linear == 0.0 and self.quadratic == 0.0:
            yield "linear", "and quadratic are both 0; leave [viscosity] out instead"

    def describe(self, units: Units) -> str:
        return f"pressure against compression, linear {self.linear:g} and quadratic {self.quadratic:g}, {self.whom}"
