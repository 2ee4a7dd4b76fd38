"""Errors of the C library as exceptions: the class says what kind, the text is C's, and body, element and point say where."""

from __future__ import annotations

import threading
from typing import Any

from ._core import ffi, lib


class Error(Exception):
    """An error of the library. ``code`` is C's status; ``body``, ``element``, ``point`` are numbers from 0, or None."""

    def __init__(self, text: str, code: int | None = None, body: int | None = None, element: int | None = None, point: int | None = None):
        super().__init__(text)
        self.code, self.body, self.element, self.point = code, body, element, point


class ArgumentError(Error, ValueError):
    """An argument is impossible: out of range, unknown, not finite."""


class GeometryError(Error, ValueError):
    """An element or a face is inverted or collapsed."""


class StepError(Error, ValueError):
    """The time step is above the stable one."""


class NotBuiltIn(Error, NotImplementedError):
    """Known, but not in this build or not for this case."""


class FileError(Error, OSError):
    """A file can't be opened, written or read."""


class BlowupError(Error, ArithmeticError):
    """The state stopped being finite in mid-run."""


class EnergyError(Error, ArithmeticError):
    """Energy has appeared from nothing in mid-run."""


class EnergyGrowth(UserWarning):
    """More than 1 % of energy has appeared from nothing in mid-run, by ``time``; ``share`` is how much, ``who`` the effect or body that it came from. The run goes on."""

    def __init__(self, text: str, share: float, time: float, who: str):
        super().__init__(text)
        self.share, self.time, self.who = share, time, who


class OverlapWarning(UserWarning):
    """Surfaces in contact overlap at the start of a run, and the scene says nothing of it."""


CLASSES = {
    lib.CT_INVALID: ArgumentError,
    lib.CT_ERROR_ARGUMENT: ArgumentError,
    lib.CT_ERROR_GEOMETRY: GeometryError,
    lib.CT_ERROR_STEP: StepError,
    lib.CT_ERROR_UNSUPPORTED: NotBuiltIn,
    lib.CT_ERROR_FILE: FileError,
    lib.CT_ERROR_BLOWUP: BlowupError,
    lib.CT_ERROR_ENERGY: EnergyError,
}


class _Held(threading.local):
    """What a Python function that C has called raised, on its way through C: it goes on when C has returned."""

    reason: BaseException | None = None


held = _Held()


def raise_held() -> None:
    """Where C has returned because a Python function raised SystemExit, KeyboardInterrupt or what else is no ``Exception``: raise it on."""
    reason, held.reason = held.reason, None
    if reason is not None:
        raise reason


def text_of(status: int, error: Any = None) -> str:
    """What an error of C says, unless a Python function wants to end the program."""
    raise_held()
    text = ffi.string(error.text).decode(errors="replace") if error is not None else ""
    return text or ffi.string(lib.ct_status_name(status)).decode()


def new_error() -> Any:
    """A ``ct_error *`` for one call."""
    error = ffi.new("ct_error *")
    error.body = error.element = error.point = -1
    return error


def check(status: int, error: Any = None) -> None:
    """Raise what a status other than CT_OK says, with the detail in ``error`` (a ``ct_error *``) where there is one."""
    if status == lib.CT_OK:
        return
    text = text_of(status, error)
    if status == lib.CT_ERROR_MEMORY:
        raise MemoryError(text)
    place = [] if error is None else [None if i < 0 else int(i) for i in (error.body, error.element, error.point)]
    raise CLASSES.get(status, Error)(text, int(status), *place)
