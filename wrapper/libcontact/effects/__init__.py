"""
What a scene may add to bodies, contacts and supports: one module an effect, named as its table in the scene file and as the C library names it.

A module has

- ``MANY``: whether the table may stand several times, written ``[[key]]``, else once, written ``[key]``;
- ``WITHOUT``: what a scene without it goes without, for ``explain``;
- ``read(table, known)``: the checked values, a frozen dataclass; what is wrong is a SceneError;
- ``create(given, maker)``: the C effect, ``ct_effect *``, or a list of them;
- ``describe(given, units)``: a line for ``explain``.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType
from typing import Any

from .._core import ffi
from ..schema import Table, describe, suggestion


@dataclass(frozen=True, eq=False)
class Known:
    """What the scene has read before its effects: ``materials`` and ``bodies`` by name, and the ``contacts``."""

    materials: dict[str, Any]
    bodies: dict[str, Any]
    contacts: tuple[Any, ...]


@dataclass(frozen=True, eq=False)
class Added:
    """One effect of a scene: its module, its key in the scene (``load[1]``), its checked values."""

    module: ModuleType
    key: str
    given: Any

    @property
    def name(self) -> str:
        return name_of(self.module)


def name_of(module: ModuleType) -> str:
    """The name of a module's effect: its table, and its column in the ledger."""
    return module.__name__.rpartition(".")[2]


def read(scene: Table, known: Known) -> tuple[Added, ...]:
    """Read the tables of all effects."""
    out = []
    for module in MODULES:
        name = name_of(module)
        if module.MANY:
            tables = scene.tables(name)
        else:
            table = scene.table(name, None)
            tables = [] if table is None else [table]
        for table in tables:
            out.append(Added(module, table.key, module.read(table, known)))
            table.done()
    return tuple(out)


def body_names(table: Table, known: Known) -> tuple[str, ...] | None:
    """The key ``bodies``, names of bodies; None, for all, where it is not given."""
    names = table.items("bodies", None, None)
    if names is None:
        return None
    for i, name in enumerate(names):
        if not isinstance(name, str):
            raise table.error(f"bodies[{i}]", f"is {describe(name)}; it must be the name of a body")
        if name not in known.bodies:
            raise table.error(
                f"bodies[{i}]", f'no body is named "{name}"' + suggestion(name, known.bodies)
            )
        if name in names[:i]:
            raise table.error(f"bodies[{i}]", f'"{name}" is named twice')
    if not names:
        raise table.error("bodies", "is empty; leave it out for all bodies")
    return tuple(names)


def body_numbers(names: tuple[str, ...] | None, maker: Any) -> tuple[Any, int]:
    """Numbers of bodies for C (``int32_t *`` and their count); a null pointer for all."""
    if names is None:
        return ffi.NULL, 0
    order = list(maker.parts.bodies)
    return maker.keep(ffi.new("int32_t[]", [order.index(name) for name in names])), len(names)


# The modules use what stands above. In the order in which their forces are added and their columns stand in the ledger.
from . import absorb, damping, gravity, load, obstacle, viscosity  # noqa: E402

MODULES: tuple[ModuleType, ...] = (obstacle, gravity, load, damping, absorb, viscosity)
