"""``[damping]``: a force against the velocity, in proportion to mass (chapter "Damping")."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .._core import ffi, lib
from ..schema import Table
from ..units import Units
from . import Known, body_names, body_numbers

MANY = False
WITHOUT = "no [damping]: motion goes on"


@dataclass(frozen=True)
class Damping:
    """``rate`` [1/time] at which velocities of the ``bodies`` (None: of all) decay."""

    rate: float
    bodies: tuple[str, ...] | None


def read(table: Table, known: Known) -> Damping:
    return Damping(table.number("rate", least=0.0), body_names(table, known))


def create(given: Damping, maker: Any) -> Any:
    numbers, count = body_numbers(given.bodies, maker)
    return maker.make(lib.ct_damping_create_effect, ffi.new("ct_damping *", {"rate": given.rate, "bodies": numbers, "body_count": count}))


def describe(given: Damping, units: Units) -> str:
    whom = "all bodies" if given.bodies is None else ", ".join(given.bodies)
    return f"velocities decay by {given.rate:g} 1/{units.time}, {whom}"
