"""Names of the surfaces of a body in a scene, such as ``"left.x_max"``, of contacts and of obstacles."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from ._core import lib
from .schema import Table, describe, suggestion

# Penalty factor of contacts and obstacles that give none.
DEFAULT_BETA = 4.0
# How contacts and obstacles make forces of gaps (chapter "Enforcement"), and what stands if a scene does not say.
ENFORCEMENTS = {
    "energy_controlled": lib.CT_ENFORCE_ENERGY_CONTROLLED,
    "penalty": lib.CT_ENFORCE_PENALTY,
    "bipenalty": lib.CT_ENFORCE_BIPENALTY,
    "lagrange": lib.CT_ENFORCE_LAGRANGE,
}
DEFAULT_ENFORCEMENT, DEFAULT_DISSIPATION = "energy_controlled", 0.1
# Where a contact has its points, and what it does with those that are inside at the start (chapter "Contact").
RULES = {"gauss": lib.CT_POINTS_GAUSS, "lobatto": lib.CT_POINTS_LOBATTO}
INITIAL = {
    "push": lib.CT_INITIAL_PUSH,
    "refuse": lib.CT_INITIAL_REFUSE,
    "keep": lib.CT_INITIAL_KEEP,
    "remove": lib.CT_INITIAL_REMOVE,
}
FACES = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max", "outer")


def read_enforcement(table: Table) -> tuple[str, float]:
    """The keys ``enforcement`` and ``dissipation`` of a contact or an obstacle."""
    enforcement = table.choice("enforcement", ENFORCEMENTS, DEFAULT_ENFORCEMENT)
    if table.has("dissipation") and enforcement != "energy_controlled":
        raise table.error(
            "dissipation", f'belongs to the enforcement "energy_controlled", not to "{enforcement}"'
        )
    dissipation = table.number("dissipation", DEFAULT_DISSIPATION, least=0.0)
    if dissipation > 1.0:
        raise table.error("dissipation", f"is {dissipation:g}; it is a share from 0 to 1")
    return enforcement, dissipation


def split_face(table: Table, key: str, value: Any, bodies: Iterable[str]) -> tuple[str, str]:
    """``"left.x_max"`` as (body, face), both of which must exist."""
    if not isinstance(value, str):
        raise table.error(key, f'is {describe(value)}; it must be a text such as "left.x_max"')
    body, dot, face = value.rpartition(".")
    if not dot:
        raise table.error(
            key, f'"{value}" is no face; write body and face with a dot, such as "left.x_max"'
        )
    if body not in bodies:
        raise table.error(key, f'"{value}": no body is named "{body}"' + suggestion(body, bodies))
    if face not in FACES:
        raise table.error(
            key, f'"{value}": body "{body}" has no face "{face}"' + suggestion(face, FACES)
        )
    return body, face


def pair_name(surfaces: Sequence[str | tuple[str, str]]) -> str:
    """Two surfaces in a sentence, each ``"body.face"`` or a body and a face."""
    first, second = (
        surface if isinstance(surface, str) else ".".join(surface) for surface in surfaces
    )
    return f"{first} with " + ("itself" if first == second else second)


def obstacle_name(obstacle: Any) -> str:
    """An obstacle by the surface that it stands before."""
    return ".".join(obstacle.given.surface)
