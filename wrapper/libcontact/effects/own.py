"""An effect of the user's own, written in Python: ``Scene.add_effect``."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import ffi, lib
from ..errors import check, held, new_error
from ..model import FORWARD
from ..schema import Place, SceneError

Floats = NDArray[np.float64]


class View:
    """
    What a force is asked with. It is good during the call only; keep the arrays, not the view.

    Attributes
    ----------
    time
        The time of the call.
    reference, displacement, velocity
        Read-only arrays (n, 3) for the effect's nodes: coordinates at the start, displacement at that time, velocity half a step before.
    """

    def __init__(self, view: Any, nodes: NDArray[Any], count: int):
        self.time = float(view.time)
        self._view, self._nodes, self._count = view, nodes, count

    def _rows(self, name: str) -> Floats:
        if self._view is None:
            raise ValueError("the view is gone; read it during the call")
        numbers = ffi.buffer(getattr(self._view, name), 24 * self._count)
        rows: Floats = np.frombuffer(numbers, np.float64).reshape(-1, 3)[self._nodes]
        rows.flags.writeable = False
        return rows

    def close(self) -> None:
        """End of the call."""
        self._view = None

    reference = property(lambda self: self._rows("reference"))
    displacement = property(lambda self: self._rows("displacement"))
    velocity = property(lambda self: self._rows("velocity"))


class Own:
    """An effect whose force is a Python function; see ``Scene.add_effect``."""

    def __init__(
        self,
        name: str,
        body: str,
        nodes: Any,
        force: Callable[[View], Any],
        energy: Callable[[View], float] | None,
        omega_squared: float,
        rate: float,
    ):
        if not isinstance(name, str) or not name.isidentifier() or len(name) > 63:
            raise SceneError(f"{name!r} is no name for a column of the ledger", "effect")
        if not callable(force) or not (energy is None or callable(energy)):
            raise SceneError("force and energy must be functions", name)
        self.name, self.body, self.given, self.force, self.energy = name, body, nodes, force, energy
        self.omega_squared = FORWARD.read(omega_squared, Place(f"{name}.omega_squared"))
        self.rate = FORWARD.read(rate, Place(f"{name}.rate"))
        self.nodes: NDArray[np.int32] = np.empty(0, np.int32)
        self.count = 0

    def check_pickle(self) -> None:
        """Refuse a function that pickle can't find again."""
        for what, function in (("force", self.force), ("energy", self.energy)):
            try:
                pickle.dumps(function)
            except Exception as reason:
                why = "a function at the top of a module can, one within another function and a lambda can't"
                text = f'effect "{self.name}": its {what} can\'t be pickled ({reason}); {why}'
                raise pickle.PicklingError(text) from None

    def ask(self, function: Callable[[View], Any], view: Any) -> Any:
        """What a function of the user answers to the C library's view."""
        seen = View(view, self.nodes, self.count)
        try:
            return function(seen)
        finally:
            seen.close()

    def create(self, maker: Any) -> Any:
        """The C effect, which keeps this object by a handle that the problem keeps."""
        if self.body not in maker.parts.bodies:
            raise maker.error(f'no body is named "{self.body}"')
        first, count = maker.body(self.body).first_node, maker.body(self.body).mesh.node_count
        if isinstance(self.given, str):
            nodes = maker.face_nodes((self.body, self.given))
        else:
            given = np.unique(np.asarray(self.given))
            whole = given.dtype.kind in "iu" and given.size > 0
            if not whole or given[0] < 0 or given[-1] >= count:
                reason = f"nodes must be whole numbers from 0 to {count - 1}, at least one"
                raise maker.error(reason)
            nodes = (first + given).astype(np.int32)
        self.nodes, self.count = maker.keep(np.ascontiguousarray(nodes)), maker.problem.node_count
        filled = maker.keep(ffi.new("ct_effect *"))
        filled.label = maker.keep(ffi.new("char[]", self.name.encode()))
        filled.data = maker.keep(ffi.new_handle(self))
        filled.nodes, filled.node_count = ffi.from_buffer("int32_t[]", self.nodes), len(self.nodes)
        filled.force = lib.own_force
        if self.energy is not None:
            filled.energy = lib.own_energy
        if self.omega_squared:
            filled.omega2_bound = lib.own_omega2_bound
        if self.rate:
            filled.rate_bound = lib.own_rate_bound
        out, error = ffi.new("ct_effect **"), new_error()
        check(lib.ct_effect_create(filled, out, error), error)
        return out[0]


def _answer(effect: Any, error: Any, compute: Callable[[Own], None]) -> Any:
    """Run a function of the user; an exception becomes an error of the C library, and what should end the program goes on through it."""
    own = ffi.from_handle(effect.data)
    try:
        compute(own)
    except BaseException as reason:  # whatever the user's function raises
        if not isinstance(reason, Exception):
            held.reason = reason
        if error != ffi.NULL:
            error.code, error.body, error.element, error.point = lib.CT_INVALID, -1, -1, -1
            said = f"effect {own.name}: {type(reason).__name__}: {reason}"
            text = _cut(said, ffi.sizeof(error.text) - 1)
            ffi.memmove(error.text, text + b"\0", len(text) + 1)
        return lib.CT_INVALID
    return lib.CT_OK


def _cut(text: str, room: int) -> bytes:
    """A text in UTF-8 that fits into ``room`` bytes; three dots stand for what does not."""
    whole = text.replace("\0", " ").encode(errors="replace")
    if len(whole) <= room:
        return whole
    return whole[: room - 3].decode(errors="ignore").encode() + b"..."


def _real(value: Any, what: str) -> Floats:
    """Numbers of the user as float64. What would lose a part on the way there, as complex numbers do, or is no number, is refused."""
    numbers = np.asarray(value)
    if numbers.dtype.kind not in "fiu":
        raise TypeError(f"the {what} is of type {numbers.dtype}; it must be of real numbers")
    return numbers.astype(np.float64, copy=False)


def called_by_c(function: Callable[..., Any]) -> Callable[..., Any]:
    """Make a function one that C can call."""
    made: Callable[..., Any] = ffi.def_extern(error=lib.CT_INVALID)(function)
    return made


@called_by_c
def own_force(effect: Any, view: Any, force: Any, error: Any) -> Any:
    def compute(own: Own) -> None:
        rows = _real(own.ask(own.force, view), "force")
        if rows.shape != (len(own.nodes), 3):
            raise ValueError(f"the force has shape {rows.shape}; it must be ({len(own.nodes)}, 3)")
        if not np.isfinite(rows).all():
            node = own.nodes[np.flatnonzero(~np.isfinite(rows).all(axis=1))[0]]
            raise ValueError(f"the force on node {node} of the problem is not finite")
        ffi.memmove(force, np.ascontiguousarray(rows), rows.nbytes)

    return _answer(effect, error, compute)


@called_by_c
def own_energy(effect: Any, view: Any, energy: Any, error: Any) -> Any:
    def compute(own: Own) -> None:
        assert own.energy is not None
        value = _real(own.ask(own.energy, view), "energy")
        if value.size != 1:
            raise ValueError(f"the energy has shape {value.shape}; it must be one number")
        energy[0] = value.item()

    return _answer(effect, error, compute)


@called_by_c
def own_omega2_bound(effect: Any, view: Any, omega_squared: Any, error: Any) -> Any:
    omega_squared[0] = ffi.from_handle(effect.data).omega_squared
    return lib.CT_OK


@called_by_c
def own_rate_bound(effect: Any, view: Any, rate: Any, error: Any) -> Any:
    rate[0] = ffi.from_handle(effect.data).rate
    return lib.CT_OK
