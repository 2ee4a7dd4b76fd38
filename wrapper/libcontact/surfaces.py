"""Names of surfaces in a sentence."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any


def pair_name(surfaces: Sequence[str | tuple[str, str]]) -> str:
    """Two surfaces in a sentence, each ``"body.face"`` or a body and a face."""
    first, second = (
        surface if isinstance(surface, str) else ".".join(surface) for surface in surfaces
    )
    return f"{first} with " + ("itself" if first == second else second)


def obstacle_name(obstacle: Any) -> str:
    """An obstacle by the surface that it stands before."""
    return str(".".join(obstacle.given.surface))
