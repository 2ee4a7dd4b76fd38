"""Parts of a scene that are right one by one and contradict each other together."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .schema import SceneError

if TYPE_CHECKING:
    from .parts import Parts


def refuse(parts: Parts, file: str | None) -> None:
    """Raise a SceneError with the key of the later of two parts that contradict each other."""
    _same_pair(parts, file)
    _surface_taken_twice(parts, file)
    _absorbing_what_is_held(parts, file)


def _same_pair(parts: Parts, file: str | None) -> None:
    """Two contacts of one pair would press twice."""
    seen: dict[frozenset[str], int] = {}
    for i, contact in enumerate(parts.contacts):
        pair = frozenset(".".join(surface) for surface in contact.surfaces)
        if pair in seen:
            reason = f"is the pair of contact[{seen[pair]}]; its penalty would count twice (the order of the two surfaces makes no difference)"
            raise SceneError(reason, f"contact[{i}].surfaces", file)
        seen[pair] = i


def _surface_taken_twice(parts: Parts, file: str | None) -> None:
    """A surface that absorbs twice has twice the impedance, and reflects a third of each wave."""
    seen: dict[tuple[str, str], str] = {}
    for added in parts.effects:
        if added.name != "absorb":
            continue
        surface = added.given.surface
        if surface in seen:
            reason = f'"{".".join(surface)}" absorbs already ({seen[surface]}); with twice the impedance it would reflect again'
            raise SceneError(reason, f"{added.key}.surface", file)
        seen[surface] = added.key


def _absorbing_what_is_held(parts: Parts, file: str | None) -> None:
    """A surface that can't move at all takes no energy out."""
    for added in parts.effects:
        if added.name != "absorb":
            continue
        held = {
            axis
            for support in parts.supports
            if (support.body, support.face) == added.given.surface
            for axis in support.fix
        }
        if held == {"x", "y", "z"}:
            reason = f'"{".".join(added.given.surface)}" is held along x, y and z by a [[support]]; what does not move absorbs nothing'
            raise SceneError(reason, f"{added.key}.surface", file)
