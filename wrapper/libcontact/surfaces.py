"""Names of the surfaces of a body in a scene, such as ``"left.x_max"``."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from .schema import Table, describe, suggestion

# Penalty factor of contacts and obstacles that give none.
DEFAULT_BETA = 4.0
FACES = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max", "outer")


def split_face(table: Table, key: str, value: Any, bodies: Iterable[str]) -> tuple[str, str]:
    """``"left.x_max"`` as (body, face), both of which must exist."""
    if not isinstance(value, str):
        raise table.error(key, f'is {describe(value)}; it must be a text such as "left.x_max"')
    body, dot, face = value.rpartition(".")
    if not dot:
        raise table.error(key, f'"{value}" is no face; write body and face with a dot, such as "left.x_max"')
    if body not in bodies:
        raise table.error(key, f'"{value}": no body is named "{body}"' + suggestion(body, bodies))
    if face not in FACES:
        raise table.error(key, f'"{value}": body "{body}" has no face "{face}"' + suggestion(face, FACES))
    return body, face
