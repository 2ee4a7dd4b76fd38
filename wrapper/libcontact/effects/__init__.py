"""Effects that a scene may add to bodies, contacts and supports: one module per effect, with the
name of its table in the scene file and of its C effect. An effect is a
:class:`libcontact.schema.Table` with its keys and the members of :class:`Effect`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from ..schema import Many, Reference, Surface, Table, key
from ..units import Units


class Effect(Table):
    """The keys of an effect, its C effect, and its description."""

    without: ClassVar[str]
    """What is missing in a scene without the effect, for ``explain``."""

    def create(self, maker: Any) -> Any:
        """Create the C effect (``ct_effect *``), or a list of them, with a
        :class:`libcontact.problem.Maker`; by default from the keys that its struct has."""
        return maker.make(type(self).__name__.lower(), self, **self.members(maker))

    def members(self, maker: Any) -> dict[str, Any]:
        """Members of the struct that are not keys with the same name."""
        raise NotImplementedError

    def describe(self, units: Units) -> str:
        """A line for ``explain``."""
        raise NotImplementedError


class OnBodies(Effect):
    """
    An effect that acts on whole bodies.

    Attributes
    ----------
    bodies
        Names of the bodies that it acts on.
    """

    bodies: Sequence[str] | None = key(
        Many(Reference("body"), "leave it out for all bodies", distinct=True),
        default=None,
        says="all",
    )

    def members(self, maker: Any) -> dict[str, Any]:
        """The numbers of the bodies."""
        return dict(maker.bodies(self.bodies))

    @property
    def whom(self) -> str:
        """The bodies in a sentence."""
        return "all bodies" if self.bodies is None else ", ".join(self.bodies)


class OnSurface(Effect):
    """
    An effect that acts on a surface.

    Attributes
    ----------
    surface
        The face or set of faces that it acts on.
    """

    surface: tuple[str, str] = key(Surface())

    def members(self, maker: Any) -> dict[str, Any]:
        """The faces."""
        return dict(maker.faces(self.surface))


@dataclass(frozen=True, eq=False)
class Added:
    """One effect of a scene: its ``key`` in the scene (``load[1]``), and its table ``given``."""

    key: str
    given: Any

    @property
    def name(self) -> str:
        """The name of the effect: that of its table, and of its column in the energy balance."""
        return self.key.partition("[")[0]
