"""``[[tie]]``: two surfaces of unlike meshes that are glued together (chapter "Tie")."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from .._core import lib
from ..model import POSITIVE, modulus
from ..schema import Each, Surface, key
from ..units import Units
from . import Effect


class Tie(Effect):
    """
    Two surfaces that are glued together where they touch in the reference shape.

    Attributes
    ----------
    surfaces
        Two faces or sets of faces, such as ``["a.x_max", "b.x_min"]``; their meshes need not match
        (:doc:`/theory/tie`).
    beta
        Stiffness of the glue per area in units of ρ c₁²/h, with the smaller modulus and the shortest edge of the two
        bodies.
    reach
        Largest distance in the reference shape over which a point is tied; points that are farther from the other
        surface stay free.
    """

    without = "no [[tie]]: bodies that touch are not glued together"

    surfaces: tuple[tuple[str, str], tuple[str, str]] = key(Each(Surface(), Surface()))
    beta: float = key(POSITIVE, default=40.0)
    reach: float | None = key(
        POSITIVE, unit="length", default=None, says="a quarter of the shortest edge"
    )

    @property
    def bodies(self) -> tuple[str, ...]:
        """The bodies that it acts on."""
        return tuple(body for body, _ in self.surfaces)

    def refusals(self) -> Iterator[tuple[str, str]]:
        if self.surfaces[0] == self.surfaces[1]:
            yield "surfaces", "names one surface twice; a tie needs two"

    def members(self, maker: Any) -> dict[str, Any]:
        edge = min(lib.ct_mesh_shortest_edge(maker.body(body).mesh) for body, _ in self.surfaces)
        materials = [each for surface in self.surfaces for each in maker.materials(surface)]
        both = [maker.faces(surface, "surfaces") for surface in self.surfaces]
        members: dict[str, Any] = {name: [each[name] for each in both] for name in both[0]}
        members["epsilon"] = self.beta * min(map(modulus, materials)) / edge
        members["reach"] = edge / 4 if self.reach is None else self.reach
        return members

    def describe(self, units: Units) -> str:
        first, second = (".".join(surface) for surface in self.surfaces)
        return f"{first} is glued to {second}; beta = {self.beta:g}"
