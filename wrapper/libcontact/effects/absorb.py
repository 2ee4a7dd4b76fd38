"""``[[absorb]]``: a surface through which waves leave (chapter "Absorbing boundary")."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .._core import ffi, lib
from ..schema import Table
from ..surfaces import split_face
from ..units import Units
from . import Known

MANY = True
WITHOUT = "no [[absorb]]: waves are reflected at every free surface"


@dataclass(frozen=True)
class Absorb:
    """The ``surface`` (body, face) that absorbs."""

    surface: tuple[str, str]


def read(table: Table, known: Known) -> Absorb:
    return Absorb(split_face(table, "surface", table.get("surface"), known.bodies))


def create(given: Absorb, maker: Any) -> Any:
    kind, faces = maker.faces(given.surface)
    return maker.make(
        lib.ct_absorb_create_effect,
        ffi.new(
            "ct_absorb_def *",
            {
                "kind": kind,
                "face_count": len(faces),
                "faces": ffi.from_buffer("int32_t[]", maker.keep(faces)),
            },
        ),
    )


def describe(given: Absorb, units: Units) -> str:
    return f"waves leave through {'.'.join(given.surface)}"
