"""Surfaces that overlap at the start, and what a contact does about it, as sentences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from .parts import Contact
from .problem import BuiltContact, Problem, penetrations

FATE = {
    "keep": 'gaps count from there, so no energy is added (initial_penetration = "keep")',
    "push": 'the penalty pushes them apart, which adds energy to the bodies (initial_penetration = "push")',
    "remove": "they are parted in a time of {time:g}",
    "refuse": 'the run is refused (initial_penetration = "refuse")',
}


def who(surfaces: Sequence[str]) -> str:
    """Two surfaces in a sentence."""
    return f"{surfaces[0]} with " + ("itself" if surfaces[0] == surfaces[1] else surfaces[1])


def sentence(built: BuiltContact, given: Contact, found: dict[str, Any]) -> str:
    """What a contact does about points that are ``found`` inside at the start (``Run.penetration``); empty where surfaces only touch."""
    deepest = found["deepest"]
    if deepest <= found["touching"]:
        return ""
    where = ", ".join(f"{x:.4g}" for x in found["position"])
    out = (f"contact {who(built.surfaces)}: the surfaces overlap by {deepest:.3g} at the start, at {found['inside'] - found['buried']} points, "
           f"most at ({where}) on {found['surface']}; ")
    if deepest <= given.adjust:
        return out + f"they are taken as touching there (adjust = {given.adjust:g})"
    out += FATE[given.initial_penetration].format(time=given.removal_time)
    if given.initial_penetration in ("keep", "push"):
        out += f". If they are meant to touch, give adjust = {1.1 * deepest:.2g} or more, which closes gaps, too; if not, move the bodies or see initial_penetration"
    return out


def overlaps(problem: Problem, state: Any) -> Iterator[str]:
    """A sentence for each contact with an overlap in the first ``state`` (``ct_state *``) that the scene says nothing of: neither ``adjust`` nor ``"remove"``."""
    if not problem.contacts:
        return
    for built, given, found in zip(problem.contacts, problem.parts.contacts, penetrations(problem, state)):
        if found["points"]["deepest"] > given.adjust and given.initial_penetration != "remove" and (told := sentence(built, given, found["points"])):
            yield told
