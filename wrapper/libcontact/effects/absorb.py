"""``[[absorb]]``: a surface through which waves leave (chapter "Absorbing boundary")."""

from __future__ import annotations

from typing import Any

from ..schema import Surface, key
from ..units import Units
from . import Effect


class Absorb(Effect):
    """
    A surface that absorbs.

    Attributes
    ----------
    surface
        A face through which waves leave (:doc:`/theory/absorb`).
    """

    many = True
    without = "no [[absorb]]: waves are reflected at every free surface"

    surface: tuple[str, str] = key(Surface())

    def create(self, maker: Any) -> Any:
        return maker.make("absorb", self, **maker.faces(self.surface))

    def describe(self, units: Units) -> str:
        return f"waves leave through {'.'.join(self.surface)}"
