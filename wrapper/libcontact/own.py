"""Effects of the caller's own, written in Python: a force on some nodes, treated like those of the library (``Scene.add_effect``)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ._core import ffi, lib
from .schema import suggestion
from .surfaces import FACES


@dataclass(frozen=True, eq=False)
class View:
    """
    What an effect is shown: the ``time`` t_n, and of all bodies, one after another, the ``reference`` coordinates, the ``displacement`` u_n and the ``velocity`` v_{n-1/2}, shape
    (nodes of the problem, 3). ``nodes`` are the effect's own rows, ascending. The arrays are those of the run, read-only and without a copy; they are good
    during the call only.
    """

    time: float
    reference: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    nodes: np.ndarray


@dataclass(eq=False)
class OwnEffect:
    """An effect as the caller gave it. ``nodes`` is a body, a face "body.face", or a pair (body, numbers of nodes); ``failure`` what its call raised."""

    name: str
    nodes: Any
    force: Callable[[View], Any]
    energy: Callable[[View], float] | None
    frequency: float
    rows: np.ndarray = field(default_factory=lambda: np.empty(0, np.int32))
    node_count: int = 0
    failure: BaseException | None = None

    def view(self, given: Any) -> View:
        arrays = []
        for pointer in (given.reference, given.displacement, given.velocity):
            array = np.frombuffer(ffi.buffer(pointer, 24 * self.node_count)).reshape(-1, 3)
            array.flags.writeable = False
            arrays.append(array)
        return View(given.time, *arrays, self.rows)


def create(own: OwnEffect, maker: Any) -> Any:
    """The ``ct_effect`` that calls the caller's functions."""
    own.rows, own.node_count = maker.keep(_rows(own.nodes, maker)), maker.problem.node_count
    filled = maker.keep(ffi.new("ct_effect *", {
        "name": maker.keep(ffi.new("char[]", own.name.encode())), "data": maker.keep(ffi.new_handle(own)),
        "nodes": ffi.from_buffer("int32_t[]", own.rows), "node_count": len(own.rows), "force": lib.own_force,
        "energy": lib.own_energy if own.energy else ffi.NULL, "frequency": lib.own_frequency}))
    return maker.make(lambda options, problem, out, error: lib.ct_effect_create(options, out, error), filled)


def _rows(nodes: Any, maker: Any) -> np.ndarray:
    """Numbers of the effect's nodes in the problem, ascending (int32)."""
    body, numbers = nodes if isinstance(nodes, tuple) else (nodes, None)
    name, _, face = body.partition(".") if numbers is None and isinstance(body, str) else (body, "", "")
    if name not in maker.parts.bodies:
        raise maker.error(f"no body is named {name!r}", "nodes")
    if face and face not in FACES:
        raise maker.error(f'body "{name}" has no face "{face}"' + suggestion(face, FACES), "nodes")
    if face:
        return maker.face_nodes((name, face))
    rows = maker.body_nodes(name)
    if numbers is None:
        return rows
    numbers = np.asarray(numbers)
    if numbers.ndim != 1 or not numbers.size or numbers.dtype.kind not in "iu" or numbers.min() < 0 or numbers.max() >= len(rows):
        raise maker.error(f'must be whole numbers from 0 to {len(rows) - 1}, nodes of "{name}"', "nodes")
    return rows[np.unique(numbers)]


def _failed(own: OwnEffect, error: Any, what: str, exception: BaseException) -> int:
    """Leave in C's error what the caller's function raised, and keep the exception."""
    own.failure = exception
    text = f"effect {own.name}: {what}: {type(exception).__name__}: {exception}".encode()
    if error != ffi.NULL:
        size = ffi.sizeof(error.text) - 1
        error.code, error.body, error.element, error.point = lib.CT_ERROR_ARGUMENT, -1, -1, -1
        error.text = text[:size].decode(errors="ignore").encode() + b"\0"
    return lib.CT_ERROR_ARGUMENT


@ffi.def_extern(error=lib.CT_ERROR_ARGUMENT)
def own_force(effect: Any, view: Any, force: Any, error: Any) -> int:
    own = ffi.from_handle(effect.data)
    try:
        answer = np.asarray(own.force(own.view(view)), dtype=np.float64)
        if answer.shape != (len(own.rows), 3):
            raise ValueError(f"the force has the shape {answer.shape}, and the effect acts on {len(own.rows)} nodes: ({len(own.rows)}, 3)")
        if not np.isfinite(answer).all():
            raise ValueError("the force is not finite")
        np.frombuffer(ffi.buffer(force, 24 * len(own.rows))).reshape(-1, 3)[:] = answer
    except BaseException as exception:
        return _failed(own, error, "force", exception)
    return lib.CT_OK


@ffi.def_extern(error=lib.CT_ERROR_ARGUMENT)
def own_energy(effect: Any, view: Any, energy: Any, error: Any) -> int:
    own = ffi.from_handle(effect.data)
    try:
        energy[0] = float(own.energy(own.view(view)))
    except BaseException as exception:
        return _failed(own, error, "energy", exception)
    return lib.CT_OK


@ffi.def_extern(error=lib.CT_ERROR_ARGUMENT)
def own_frequency(effect: Any, view: Any, omega_squared: Any, error: Any) -> int:
    omega_squared[0] = ffi.from_handle(effect.data).frequency ** 2
    return lib.CT_OK
