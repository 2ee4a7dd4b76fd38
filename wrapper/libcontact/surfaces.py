"""Names of surfaces in a sentence."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any


def pair_name(surfaces: Sequence[str | tuple[str, str]]) -> str:
    """Two surfaces in a sentence, each ``"body.face"`` or a body and a face."""
    first, second = (
        surface if isinstance(surface, str) else ".".join(surface) for surface in surfaces
    )
    return f"{first} with " + ("itself" if first == second else second)


def split_name(name: str, bodies: Iterable[str]) -> tuple[str, str]:
    """Body and face or set of a name such as ``"left.x_max"``; all of them may have dots."""
    body = max((each for each in bodies if name.startswith(f"{each}.")), key=len)
    return body, name[len(body) + 1 :]


def whole_skin(surfaces: Sequence[Any]) -> str:
    """Advice to name the whole skins of two bodies, unless the contact has them."""
    outer = [f'"{body}.outer"' for body, _ in surfaces]
    given = [f'"{body}.{name}"' for body, name in surfaces]
    return "" if given == outer else f"; name the whole skins, surfaces = [{', '.join(outer)}]"


def obstacle_name(obstacle: Any) -> str:
    """An obstacle, named by the surface in contact with it."""
    return str(".".join(obstacle.given.surface))


def contact_tables(parts: Any) -> Iterator[tuple[str, str, Any]]:
    """The contacts and then the obstacles of a scene: key, surfaces as text, and table of each."""
    for i, contact in enumerate(parts.contact):
        yield f"contact[{i}]", pair_name(contact.surfaces), contact
    for added in parts.effects:
        if added.name == "obstacle":
            yield added.key, obstacle_name(added), added.given
