"""``[gravity]``: a uniform acceleration of bodies (chapter "Gravity")."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .._core import ffi, lib
from ..schema import Table
from ..units import Units
from . import Known, body_names, body_numbers

MANY = False
WITHOUT = "no [gravity]: nothing falls"


@dataclass(frozen=True)
class Gravity:
    """``acceleration`` [length/time²] of the ``bodies`` (None: of all)."""

    acceleration: tuple[float, float, float]
    bodies: tuple[str, ...] | None


def read(table: Table, known: Known) -> Gravity:
    return Gravity(table.vector("acceleration"), body_names(table, known))


def create(given: Gravity, maker: Any) -> Any:
    numbers, count = body_numbers(given.bodies, maker)
    return maker.make(
        lib.ct_gravity_create_effect,
        ffi.new(
            "ct_gravity_def *",
            {"acceleration": list(given.acceleration), "bodies": numbers, "body_count": count},
        ),
    )


def describe(given: Gravity, units: Units) -> str:
    whom = "all bodies" if given.bodies is None else ", ".join(given.bodies)
    return f"{list(given.acceleration)} {units.length}/{units.time}^2 on {whom}"
