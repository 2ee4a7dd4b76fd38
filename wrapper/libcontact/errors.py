"""Exceptions and warnings. Errors of the C library: the class gives the kind, the text comes from
C, and body, element and point give the place. Warnings of the package: the class gives the kind;
the text names the key of the scene, what was found, and what to do.
"""

from __future__ import annotations

import re
import sys
import threading
import warnings
from collections.abc import Callable
from functools import wraps
from types import FrameType
from typing import Any, ParamSpec, TypeVar

from ._core import ffi, lib

__all__ = ["ArgumentError", "BlowupError", "EnergyError", "Error", "FileError", "GeometryError"]
__all__ += ["NotBuiltIn", "StepError"]
__all__ += ["BorderWarning", "ChatterWarning", "EnergyGrowth", "InsideOutWarning"]
__all__ += ["LongRunWarning", "NeverMeetWarning", "NotAtRest", "NotSettled", "OutputWarning"]
__all__ += ["OverlapWarning", "PenetrationWarning", "RotationWarning", "SamePlaceWarning"]
__all__ += ["SceneWarning", "ShortStepWarning", "StepDivided", "ThinWarning"]
__all__ += ["TwiceWarning", "UnitsWarning"]

# The library counts its memory from its first object on.
lib.count_memory()


ADDRESS = " [docs: reference/symptoms.html#{}]"


def bare(text: str) -> str:
    """The text of an error without the address of its entry in the book."""
    return re.sub(r" \[docs: reference/symptoms\.html#\w+\]", "", text)


class _Documented(Exception):
    """An error or warning with an entry on the page "Symptoms" of the book: its text ends with the address of the
    entry."""

    def __str__(self) -> str:
        text = super().__str__()
        return text + ADDRESS.format(type(self).__name__.lower()) if text else text


class Error(_Documented):
    """
    An error of the library.

    Attributes
    ----------
    code : int or None
        The ``ct_status`` of the C library.
    body, element, point : int or None
        Where it happened, counted from 0; None if the error has no such place.
    """

    body: int | None = None
    element: int | None = None
    point: int | None = None

    def __init__(self, text: str, code: int | None = None, **place: int | None):
        super().__init__(bare(text))
        self.code = code
        vars(self).update(place)


class ArgumentError(Error, ValueError):
    """An invalid argument: out of range, unknown, not finite."""


class GeometryError(Error, ValueError):
    """An element or a face is inverted or collapsed."""


class StepError(Error, ValueError):
    """The time step exceeds the largest stable one."""


class NotBuiltIn(Error, NotImplementedError):
    """Not supported in this build or for this case."""


class FileError(Error, OSError):
    """A file can't be opened, written or read."""


class BlowupError(Error, ArithmeticError):
    """The state became NaN or infinite during the run."""


class EnergyError(Error, ArithmeticError):
    """Spurious energy growth was detected during the run."""


class SceneWarning(_Documented, UserWarning):
    """Something in a scene or a run that is probably not intended. The text names the key, says
    what was found, and ends with what to do.

    Attributes
    ----------
    key : str
        The key of the scene that it belongs to, such as ``contact[0]``; ``""`` for the whole scene.
    """

    def __init__(self, text: str, key: str = ""):
        super().__init__(f"{key}: {text}" if key else text)
        self.key = key


class UnitsWarning(SceneWarning):
    """A wave speed that no material has: Young's modulus, density and units are inconsistent."""


class InsideOutWarning(SceneWarning):
    """The two surfaces of a contact, or an obstacle and its surface, face away from each other."""


class SamePlaceWarning(SceneWarning):
    """Two bodies occupy the same space."""


class TwiceWarning(SceneWarning):
    """Two contacts have the same faces, so that the contact force acts twice."""


class OverlapWarning(SceneWarning):
    """Surfaces of a contact, or a surface and an obstacle, overlap at the start."""


class BorderWarning(SceneWarning):
    """Points were found inside the other surface that did not come in through it."""


class NeverMeetWarning(SceneWarning):
    """The surfaces of a contact cannot come together before the run ends."""


class ThinWarning(SceneWarning):
    """An impact on a body that is about one element thick loses a large part of its energy."""


class ChatterWarning(SceneWarning):
    """A penalty is so stiff for the time step that points open and close with every step, which
    adds energy to the bodies."""


class ShortStepWarning(SceneWarning):
    """The friction of a contact or an obstacle shortens the stable step four times or more."""


class LongRunWarning(SceneWarning):
    """A run takes ten million steps or more, or about an hour or more."""


class PenetrationWarning(SceneWarning):
    """Surfaces overlap by more than half an element during the run: the penalty is too soft for the
    load."""


class RotationWarning(SceneWarning):
    """A body with the small-strain law has rotated so far that the rotation causes false strain."""


class OutputWarning(SceneWarning):
    """A run continues without something that was requested, for example a file in a build without
    HDF5."""


class EnergyGrowth(SceneWarning):
    """More than 1 % of spurious energy was detected during the run. The run continues.

    Attributes
    ----------
    ratio : float
        Ratio of spurious energy to the energy that the bodies should have.
    time : float
        When it was detected [time].
    who : str
        The effect or body that caused most of it.
    """

    # The defaults serve copies, which are made from the text alone.
    def __init__(
        self, text: str, key: str = "", ratio: float = 0.0, time: float = 0.0, who: str = ""
    ):
        super().__init__(text, key)
        self.ratio, self.time, self.who = ratio, time, who


class StepDivided(SceneWarning):
    """A run divides its time step, because the solid has become too stiff for it or surfaces could pass
    through each other within it. It is issued once; ``Run.divisions`` has all divisions.

    Attributes
    ----------
    time : float
        When the step was first divided [time].
    parts : int
        The number of parts.
    """

    # The defaults serve copies, which are made from the text alone.
    def __init__(self, text: str, key: str = "", time: float = 0.0, parts: int = 1):
        super().__init__(text, key)
        self.time, self.parts = time, parts


class NotAtRest(SceneWarning):
    """A run with ``until_static`` has reached its end before the bodies are at rest."""


class NotSettled(SceneWarning):
    """In some steps the iteration for the contact forces did not converge."""


def came_in_late(count: int, depth: float) -> str:
    """What a warning says of points that were found inside."""
    text = f"{count} points were found up to {depth:.3g} inside the other surface although they did not come in through it, as over the border of an open surface; "
    return (
        text
        + "their gaps count from there, so no energy is added and the bodies stay in each other"
    )


def issue(warning: SceneWarning) -> None:
    """Issue a warning through Python's ``warnings``, at the line outside the package that made the call."""
    level = 1
    frame: FrameType | None = sys._getframe()
    while (
        frame is not None and frame.f_globals.get("__name__", "").partition(".")[0] == __package__
    ):
        level, frame = level + 1, frame.f_back
    warnings.warn(warning, stacklevel=level)


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
    """An exception of a Python function that C has called; it is raised again after C has
    returned."""

    reason: BaseException | None = None


held = _Held()


def raise_held() -> None:
    """If C has returned because a Python function raised SystemExit, KeyboardInterrupt or another
    exception that is not an ``Exception``, raise it again."""
    reason, held.reason = held.reason, None
    if reason is not None:
        raise reason


def text_of(status: int, error: Any = None) -> str:
    """The text of an error of C; raises again what a Python function has raised to end the
    program."""
    raise_held()
    text = ffi.string(error.text).decode(errors="replace") if error is not None else ""
    return text or ffi.string(lib.ct_status_name(status)).decode()


P = ParamSpec("P")
R = TypeVar("R")


def renamed(**now: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """For a call of which keyword arguments have been renamed: an old one is refused, and the error
    names the present one."""

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        @wraps(function)
        def checked(*args: P.args, **given: P.kwargs) -> R:
            for old in now.keys() & given.keys():
                raise TypeError(f'{function.__name__}: "{old}" is gone; write "{now[old]}"')
            return function(*args, **given)

        return checked

    return decorate


def new_error() -> Any:
    """A ``ct_error *`` for one call."""
    error = ffi.new("ct_error *")
    error.body = error.element = error.point = -1
    return error


def place(error: Any) -> dict[str, int | None]:
    """Body, element and point of a ``ct_error *``, as the keywords of an :class:`Error`."""
    numbers = ((name, getattr(error, name)) for name in ("body", "element", "point"))
    return {name: int(number) if number >= 0 else None for name, number in numbers}


def check(status: int, error: Any = None) -> None:
    """Raise the exception of a status other than CT_OK, with the details in ``error`` (a ``ct_error
    *``) if there are any."""
    if status == lib.CT_OK:
        return
    text = text_of(status, error)
    if status == lib.CT_ERROR_MEMORY:
        raise MemoryError(text)
    raise CLASSES.get(status, Error)(text, int(status), **({} if error is None else place(error)))
