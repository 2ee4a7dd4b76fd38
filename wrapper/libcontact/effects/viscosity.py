"""``[viscosity]``: a pressure against compression that spreads a front over a few elements (chapter "Bulk viscosity")."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .._core import ffi, lib
from ..schema import Table
from ..units import Units
from . import Known, body_names, body_numbers

MANY = False
WITHOUT = "no [viscosity]: fronts ring behind them as the mesh lets them"


@dataclass(frozen=True)
class Viscosity:
    """Coefficients of the strain rate and of its square, for the ``bodies`` (None: for all)."""

    linear: float
    quadratic: float
    bodies: tuple[str, ...] | None


def read(table: Table, known: Known) -> Viscosity:
    linear, quadratic = (
        table.number("linear", 0.06, least=0.0),
        table.number("quadratic", 1.2, least=0.0),
    )
    if linear == 0.0 and quadratic == 0.0:
        raise table.error("linear", "and quadratic are both 0; leave [viscosity] out instead")
    names = body_names(table, known)
    for name in known.bodies if names is None else names:
        if known.bodies[name].element == "hex20":
            raise table.error("bodies", f'"{name}" is of hex20; bulk viscosity is for hex8')
    return Viscosity(linear, quadratic, names)


def create(given: Viscosity, maker: Any) -> Any:
    numbers, count = body_numbers(given.bodies, maker)
    return maker.make(
        lib.ct_viscosity_create_effect,
        ffi.new(
            "ct_viscosity_def *",
            {
                "linear": given.linear,
                "quadratic": given.quadratic,
                "bodies": numbers,
                "body_count": count,
            },
        ),
    )


def describe(given: Viscosity, units: Units) -> str:
    whom = "all bodies" if given.bodies is None else ", ".join(given.bodies)
    return f"pressure against compression, linear {given.linear:g} and quadratic {given.quadratic:g}, {whom}"
