"""``[[absorb]]``: a surface through which waves leave (chapter "Absorbing boundary")."""

from __future__ import annotations

from ..units import Units
from . import OnSurface


class Absorb(OnSurface):
    """A surface that absorbs waves.

    Attributes
    ----------
    surface
        A face through which waves leave (:doc:`/theory/absorb`).
    """

    without = "no [[absorb]]: waves are reflected at every free surface"

    def describe(self, units: Units) -> str:
        return f"waves leave through {'.'.join(self.surface)}"
