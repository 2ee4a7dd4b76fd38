"""An effect of the user's own, written in Python: ``Scene.add_effect``."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import Any

import numpy as np

from .._core import ffi, lib
from ..bridge import Floats, Ints, ask, ints
from ..errors import StepError, held
from ..model import FORWARD
from ..schema import Place, SceneError


@dataclass(frozen=True, eq=False)
class View:
    """Input of a force.

    Attributes
    ----------
    time
        The time of the call.
    reference, displacement, velocity
        Read-only arrays (n, 3) for the effect's nodes: coordinates at the start, displacement at this
        time, velocity half a step earlier.
    dt
        The time step. A force may raise ``libcontact.StepError`` if it is too long; the run then
        divides it.
    """

    time: float
    reference: Floats
    displacement: Floats
    velocity: Floats
    dt: float = 0.0


@dataclass(eq=False)
class Own:
    """An effect whose force is a Python function; see ``Scene.add_effect``."""

    name: str
    body: str
    given: Any
    force: Callable[[View], Any]
    energy: Callable[[View], float] | None
    omega_squared: float
    rate: float

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.isidentifier() or len(self.name) > 63:
            raise SceneError(
                f"{self.name!r} is not a valid name for a column of the energy balance", "effect"
            )
        if not callable(self.force) or not (self.energy is None or callable(self.energy)):
            raise SceneError("force and energy must be functions", self.name)
        self.omega_squared = FORWARD.read(self.omega_squared, Place(f"{self.name}.omega_squared"))
        self.rate = FORWARD.read(self.rate, Place(f"{self.name}.rate"))
        self.nodes: Ints = np.empty(0, np.int32)
        self.count = 0

    def check_pickle(self) -> None:
        """Raise an error for a function that can't be pickled."""
        for what, function in (("force", self.force), ("energy", self.energy)):
            try:
                pickle.dumps(function)
            except Exception as reason:
                why = "a function at the top of a module can, one within another function and a lambda can't"
                text = f'effect "{self.name}": its {what} can\'t be pickled ({reason}); {why}'
                raise pickle.PicklingError(text) from None

    def view(self, of: Any) -> View:
        """A copy of the C library's ``ct_view *`` at the effect's nodes."""
        arrays = []
        for pointer in (of.reference, of.displacement, of.velocity):
            numbers = np.frombuffer(ffi.buffer(pointer, 24 * self.count), np.float64)
            arrays.append(numbers.reshape(-1, 3)[self.nodes])
            arrays[-1].flags.writeable = False
        reference, displacement, velocity = arrays
        return View(float(of.time), reference, displacement, velocity, float(of.dt))

    def create(self, maker: Any) -> Any:
        """Create the C effect. The problem keeps a handle that keeps this object alive."""
        if self.body not in maker.parts.bodies:
            raise maker.error(f'no body is named "{self.body}"')
        if isinstance(self.given, str):
            self.nodes = maker.face_nodes((self.body, self.given))
        else:
            numbers, given = maker.body_nodes(self.body), np.unique(np.asarray(self.given))
            whole = given.dtype.kind in "iu" and given.size > 0
            if not whole or given[0] < 0 or given[-1] >= len(numbers):
                reason = f"nodes must be whole numbers from 0 to {len(numbers) - 1}, at least one"
                raise maker.error(reason)
            self.nodes = numbers[given]
        self.count = maker.problem.node_count
        filled = maker.keep(ffi.new("ct_effect *"))
        filled.label = maker.keep(ffi.new("char[]", self.name.encode()))
        filled.data = maker.keep(ffi.new_handle(self))
        filled.nodes, filled.node_count = maker.keep(ints(self.nodes)), len(self.nodes)
        filled.calls = calls = maker.keep(ffi.new("ct_effect_calls *"))
        calls.force = lib.own_force
        calls.pieces.common = 1  # the function sees its own nodes only
        if self.energy is not None:
            calls.energy = lib.own_energy
        if self.omega_squared:
            calls.bounds.omega2 = lib.own_omega2_bound
        if self.rate:
            calls.bounds.rate = lib.own_rate_bound
        return ask("ct_effect **", lib.ct_effect_create, filled)


def called_by_c(function: Callable[[Own, Any, Any], None]) -> Callable[..., Any]:
    """Wrap a function so that C can call it. An ``Exception`` becomes an error of the C library;
    SystemExit and KeyboardInterrupt pass through C."""

    @wraps(function)
    def answer(effect: Any, view: Any, out: Any, error: Any) -> Any:
        own = ffi.from_handle(effect.data)
        try:
            function(own, view, out)
        except BaseException as reason:  # whatever the user's function raises
            if not isinstance(reason, Exception):
                held.reason = reason
            status = lib.CT_ERROR_STEP if isinstance(reason, StepError) else lib.CT_INVALID
            if error != ffi.NULL:
                error.code, error.body, error.element, error.point = status, -1, -1, -1
                said = f"effect {own.name}: {type(reason).__name__}: {reason}"
                error.text = _cut(said, ffi.sizeof(error.text) - 1)
            return status
        return lib.CT_OK

    made: Callable[..., Any] = ffi.def_extern(error=lib.CT_INVALID)(answer)
    return made


def _cut(text: str, room: int) -> bytes:
    """A text in UTF-8 of at most ``room`` bytes; a text that was too long ends with three dots."""
    whole = text.replace("\0", " ").encode(errors="replace")
    if len(whole) <= room:
        return whole
    return whole[: room - 3].decode(errors="ignore").encode() + b"..."


def _real(value: Any, what: str) -> Floats:
    """Numbers of the user as float64. Values that are not real numbers are rejected."""
    numbers = np.asarray(value)
    if numbers.dtype.kind not in "fiu":
        raise TypeError(f"the {what} is of type {numbers.dtype}; it must be of real numbers")
    return numbers.astype(np.float64, copy=False)


@called_by_c
def own_force(own: Own, view: Any, force: Any) -> None:
    """Write the forces on the effect's nodes."""
    rows = _real(own.force(own.view(view)), "force")
    if rows.shape != (len(own.nodes), 3):
        raise ValueError(f"the force has shape {rows.shape}; it must be ({len(own.nodes)}, 3)")
    if not np.isfinite(rows).all():
        node = own.nodes[np.flatnonzero(~np.isfinite(rows).all(axis=1))[0]]
        raise ValueError(f"the force on node {node} of the problem is not finite")
    ffi.memmove(force, np.ascontiguousarray(rows), rows.nbytes)


@called_by_c
def own_energy(own: Own, view: Any, energy: Any) -> None:
    """Write the stored energy of the effect."""
    assert own.energy is not None
    value = _real(own.energy(own.view(view)), "energy")
    if value.size != 1:
        raise ValueError(f"the energy has shape {value.shape}; it must be one number")
    energy[0] = value.item()


@called_by_c
def own_omega2_bound(own: Own, view: Any, omega_squared: Any) -> None:
    """Write the largest ω²."""
    omega_squared[0] = own.omega_squared


@called_by_c
def own_rate_bound(own: Own, view: Any, rate: Any) -> None:
    """Write the largest rate."""
    rate[0] = own.rate
