"""``[[load]]``: traction and pressure on a surface, with a history in time (chapter "Load")."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .._core import ffi, lib
from ..schema import Table
from ..schema import describe as shown
from ..surfaces import split_face
from ..units import Units
from . import Known

MANY = True
WITHOUT = "no [[load]]: surfaces are free of tractions"


@dataclass(frozen=True)
class Load:
    """``traction`` and ``pressure`` [stress] on the ``surface`` (body, face), times the line through ``history`` (times, values)."""

    surface: tuple[str, str]
    traction: tuple[float, float, float]
    pressure: float
    following: bool
    history: tuple[tuple[float, ...], tuple[float, ...]]


def read(table: Table, known: Known) -> Load:
    surface = split_face(table, "surface", table.get("surface"), known.bodies)
    traction, pressure = table.vector("traction", (0.0, 0.0, 0.0)), table.number("pressure", 0.0)
    if pressure == 0.0 and not any(traction):
        raise table.error("", "gives neither a traction nor a pressure")
    following = table.get("following", False)
    if not isinstance(following, bool):
        raise table.error("following", f"is {shown(following)}; it must be true or false")
    if following and pressure == 0.0:
        raise table.error(
            "following", "is true, but only a pressure follows the surface, and there is none"
        )
    return Load(surface, traction, pressure, following, read_history(table))


def read_history(table: Table) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The key ``history = { time = [...], value = [...] }``; without it the factor is 1 at all times."""
    own = table.table("history", None)
    if own is None:
        return (), ()
    time, value = own.items("time"), own.items("value")
    if not time or len(time) != len(value):
        raise own.error(
            "value",
            f"has {len(value)} entries, and time has {len(time)}; both need as many, and at least one",
        )
    time = [own.checked_number(t, f"time[{i}]") for i, t in enumerate(time)]
    value = [own.checked_number(v, f"value[{i}]") for i, v in enumerate(value)]
    for i, (before, after) in enumerate(zip(time, time[1:])):
        if after < before:
            raise own.error(f"time[{i + 1}]", f"is {after:g}, before {before:g}")
    own.done()
    return tuple(time), tuple(value)


def c_history(history: tuple[tuple[float, ...], tuple[float, ...]], maker: Any) -> dict[str, Any]:
    """The members of a ``ct_history``, kept alive by the maker."""
    time, value = (maker.keep(ffi.new("double[]", list(numbers) or [0.0])) for numbers in history)
    return {"count": len(history[0]), "time": time, "value": value}


def create(given: Load, maker: Any) -> Any:
    kind, faces = maker.faces(given.surface)
    return maker.make(
        lib.ct_load_create_effect,
        ffi.new(
            "ct_load_def *",
            {
                "kind": kind,
                "face_count": len(faces),
                "faces": ffi.from_buffer("int32_t[]", maker.keep(faces)),
                "traction": list(given.traction),
                "pressure": given.pressure,
                "following": given.following,
                "history": c_history(given.history, maker),
            },
        ),
    )


def describe(given: Load, units: Units) -> str:
    parts = []
    if any(given.traction):
        parts.append(f"traction {list(given.traction)}")
    if given.pressure:
        parts.append(
            f"pressure {given.pressure:g}"
            + (" that follows the surface" if given.following else "")
        )
    history = f", with a history of {len(given.history[0])} points" if given.history[0] else ""
    return f"{' and '.join(parts)} {units.label('stress')} on {'.'.join(given.surface)}{history}"
