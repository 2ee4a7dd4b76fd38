"""``[[load]]``: traction and pressure on a surface, with a history in time (chapter "Load")."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ..model import ORIGIN, History, Vector
from ..schema import VECTOR, Flag, Nested, Number, key
from ..units import Units
from . import OnSurface


class Load(OnSurface):
    """
    Traction and pressure on a surface, times a history.

    Attributes
    ----------
    surface
        A face such as ``"bar.x_max"`` (:doc:`/theory/load`).
    traction
        Force per undeformed area; a load needs a traction or a pressure.
    pressure
        Pressure, which acts against the outward normal.
    following
        ``true``: the pressure acts on the deformed surface, along its normal.
    history
        A factor in time, piecewise linear.
    """

    without = "no [[load]]: surfaces are free of tractions"

    traction: Vector = key(VECTOR, unit="stress", default=ORIGIN)
    pressure: float = key(Number(), unit="stress", default=0.0)
    following: bool = key(Flag(), default=False)
    history: Any = key(Nested(History), default=None, says="1 at all times")

    def refusals(self) -> Iterator[tuple[str, str]]:
        if self.pressure == 0.0 and not any(self.traction):
            yield "", "gives neither a traction nor a pressure"
        if self.following and self.pressure == 0.0:
            yield "following", "is true, but only a pressure follows the surface, and there is none"

    def members(self, maker: Any) -> dict[str, Any]:
        return {**super().members(maker), "amplitude": maker.history(self.history)}

    def describe(self, units: Units) -> str:
        parts = [f"traction {list(self.traction)}"] if any(self.traction) else []
        if self.pressure:
            how = " that follows the surface" if self.following else ""
            parts.append(f"pressure {self.pressure:g}{how}")
        history = f", with a history of {len(self.history.time)} points" if self.history else ""
        where = ".".join(self.surface)
        return f"{' and '.join(parts)} {units.label('stress')} on {where}{history}"
