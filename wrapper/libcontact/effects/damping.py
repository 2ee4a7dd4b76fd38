"""``[damping]``: a force against the velocity, in proportion to mass, or dynamic relaxation (chapter "Damping")."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .._core import ffi, lib
from ..schema import Table
from ..schema import describe as shown
from ..units import Units
from . import Known, body_names, body_numbers

MANY = False
WITHOUT = "no [damping]: motion goes on"


@dataclass(frozen=True)
class Damping:
    """``rate`` [1/time] at which velocities of the ``bodies`` (None: of all) decay; None: dynamic relaxation, which chooses it."""

    rate: float | None
    bodies: tuple[str, ...] | None


def read(table: Table, known: Known) -> Damping:
    if table.one_of("rate", "relaxation") == "rate":
        return Damping(table.number("rate", least=0.0), body_names(table, known))
    if table.get("relaxation") is not True:
        raise table.error(
            "relaxation",
            f"is {shown(table.get('relaxation'))}; it must be true, or leave it out and give a rate",
        )
    return Damping(None, body_names(table, known))


def create(given: Damping, maker: Any) -> Any:
    numbers, count = body_numbers(given.bodies, maker)
    return maker.make(
        lib.ct_damping_create_effect,
        ffi.new(
            "ct_damping_def *",
            {
                "rate": given.rate or 0.0,
                "relaxation": given.rate is None,
                "bodies": numbers,
                "body_count": count,
            },
        ),
    )


def describe(given: Damping, units: Units) -> str:
    whom = "all bodies" if given.bodies is None else ", ".join(given.bodies)
    if given.rate is None:
        return f"dynamic relaxation, {whom}: the way to rest is not the true motion"
    return f"velocities decay by {given.rate:g} 1/{units.time}, {whom}"
