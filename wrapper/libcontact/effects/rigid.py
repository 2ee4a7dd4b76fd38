"""``[[rigid]]``: a body that keeps its shape and moves by the forces on it (chapter "Rigid bodies")."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from .._core import ffi
from ..model import Vector
from ..schema import VECTOR, Choice, Many, Reference, Surface, key
from ..units import Units
from . import Effect

FREEDOMS = ("x", "y", "z", "rx", "ry", "rz")


class Rigid(Effect):
    """
    A rigid body or a rigid part of a body: it keeps its shape, and moves by all forces on it with the mass and the
    inertia of its nodes.

    Attributes
    ----------
    body
        Name of the body (:doc:`/theory/rigid`). Of its material only the density counts, and in contact
        between two rigid bodies the stiffness.
    set
        Instead of a whole body, a set of it such as ``"gear.hub"``: its nodes move as a rigid body, and the rest of
        the body deforms. A body has at most one.
    fixed
        Freedoms that stay at rest: ``"x"``, ``"y"``, ``"z"`` of the centre of mass, and ``"rx"``, ``"ry"``,
        ``"rz"``, the angular velocities about the axes of the scene.
    pivot
        A point about which the body turns, and which does not move, instead of the centre of mass.
    """

    without = "no [[rigid]]: all bodies deform"

    one = (("body", "set"),)

    body: str | None = key(Reference("body"), default=None, says="one of two")
    set: Any = key(Surface(), default=None, says="one of two")
    fixed: tuple[str, ...] = key(
        Many(Choice(FREEDOMS), "leave it out for none", distinct=True), default=(), says="none"
    )
    pivot: Vector | None = key(VECTOR, unit="length", default=None, says="none")

    @property
    def bodies(self) -> tuple[str]:
        """The bodies that it acts on."""
        return (self.of,)

    @property
    def of(self) -> str:
        """The body, also that of a set."""
        return str(self.body or self.set.body)

    def refusals(self) -> Iterator[tuple[str, str]]:
        moves = [name for name in self.fixed if name in FREEDOMS[:3]]
        if self.pivot is not None and moves:
            yield "fixed", f'has "{moves[0]}", but a body with a pivot does not move along x, y, z'

    def create(self, maker: Any) -> Any:
        """Create the one effect of all rigid bodies, at the first of them."""
        given = maker.parts.rigid
        if self is not given[0]:
            return []
        order = list(maker.parts.bodies)
        bodies = maker.keep(ffi.new("ct_rigid[]", len(given)))
        for entry, one in zip(bodies, given):
            entry.body = order.index(one.of)
            if one.set is not None:
                nodes = maker.face_nodes(one.set, f"rigid[{given.index(one)}].set")
                entry.nodes, entry.node_count = (
                    maker.keep(ffi.from_buffer("int32_t[]", nodes)),
                    len(nodes),
                )
            entry.fixed = [name in one.fixed for name in FREEDOMS]
            entry.pivoted = one.pivot is not None
            entry.pivot = [0.0, 0.0, 0.0] if one.pivot is None else one.pivot
        return maker.make("rigid", None, bodies=bodies, body_count=len(given))

    def describe(self, units: Units) -> str:
        held = f", {', '.join(self.fixed)} fixed" if self.fixed else ""
        about = f", about {list(self.pivot)} {units.length}" if self.pivot is not None else ""
        name = self.body or ".".join(self.set)
        return f"{name} moves by its forces{about}{held}"
