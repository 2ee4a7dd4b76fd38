"""Exceptions and warnings. Errors of the C library: the class gives the kind, the text comes from
C, and body, element and point give the place. Warnings of the package: the kind; the
text names kind and key of the scene, what was found, and what to do.
"""

from __future__ import annotations

import os
import re
import shlex
import sys
import threading
import warnings
from collections.abc import Callable
from functools import wraps
from importlib import metadata
from pathlib import Path
from types import FrameType
from typing import Any, ParamSpec, TypeVar

from ._core import ffi, lib

__all__ = ["ArgumentError", "BlowupError", "EnergyError", "Error", "FileError", "GeometryError"]
__all__ += ["NotBuiltIn", "StepError", "EnergyGrowth", "SceneWarning", "StepDivided"]

# The library counts its memory from its first object on.
lib.count_memory()


def install(extra: str) -> str:
    """The command that installs what an extra needs into this Python, wherever the package itself came from."""
    needed = [line.split(";") for line in metadata.requires("libcontact") or []]
    names = [name.strip() for name, *when in needed if f'extra == "{extra}"' in "".join(when)]
    return " ".join([shlex.quote(sys.executable), "-m pip install", *map(shlex.quote, names)])


def bare(text: str) -> str:
    """The text of an error without the address of its entry in the book."""
    return re.sub(r" \[docs: [^]]*\]", "", text)


def _address(entry: str) -> str:
    """The address of an entry of the page "Symptoms", in brackets: in the book of the environment variable
    LIBCONTACT_DOCS, or in that of this Python environment; empty if there is none."""
    copy = Path(sys.prefix, "share", "doc", "libcontact")
    installed = copy.as_uri() if (copy / "index.html").is_file() else ""
    book = os.environ.get("LIBCONTACT_DOCS", installed).rstrip("/")
    return f" [docs: {book}/reference/symptoms.html#{entry}]" if book else ""


class Error(Exception):
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

    def __str__(self) -> str:
        text = super().__str__()
        return text + _address(type(self).__name__.lower()) if text else text


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


# Kinds of warnings: what was found. The first are known before the first step of a run.
KINDS = {
    "units": "a wave speed or a density that no material has, because Young's modulus, density and units are inconsistent; or an angle "
    "of more than a turn, probably in degrees",
    "output": "a run continues without something that was requested, for example a file in a build without HDF5",
    "inside_out": "the two surfaces of a contact, or an obstacle and its surface, face away from each other",
    "same_place": "two bodies occupy the same space",
    "overlap": "surfaces of a contact, or a surface and an obstacle, overlap at the start",
    "never_meet": "the surfaces of a contact cannot come together before the run ends",
    "no_contact": "two bodies meet that no contact names, so they pass through each other",
    "thin": "an impact with a restitution below 1 on a body that is about one element thick loses a large part of its energy",
    "wide": "hex20 elements are wider than long along an impact, whose wave they do not carry",
    "chatter": "a penalty is so stiff for the time step that points open and close with every step, which adds energy "
    "to the bodies",
    "long_run": "a run takes ten million steps or more, or about an hour or more",
    "short_run": "a run of less than 20 steps ends before a wave has crossed a body",
    "energy_growth": "more than 0.2 % of spurious energy was detected, or 1 % after a loss; an "
    ":class:`EnergyGrowth`",
    "penetration": "surfaces overlap by more than half an element: the penalty is too soft for the load",
    "border": "points were found inside the other surface that did not come in through it",
    "step_divided": "the step of a run was divided; a :class:`StepDivided`",
    "rotation": "a body with the small-strain law has rotated so far that the rotation causes false strain",
    "volume": "an element has collapsed or is inverted",
    "unconverged": "in some steps the iteration for the contact forces did not converge",
    "not_at_rest": "a run with ``until_static`` has reached its end before the bodies are at rest",
}


class SceneWarning(UserWarning):
    """Something in a scene or a run that is probably not intended. The text begins with the kind and the key,
    ``thin: contact[0]: ...``, says what was found, and ends with what to do. So the filters of Python choose
    one kind: ``warnings.filterwarnings("ignore", "thin:")``, also with ``"error"`` or in the option ``-W`` of
    Python and pytest. The kinds are

    {kinds}

    Attributes
    ----------
    kind : str
        The kind.
    key : str
        The key of the scene that it belongs to, such as ``contact[0]``; ``""`` for the whole scene.
    """

    def __init__(self, kind: str, text: str, key: str = ""):
        self.kind, self.text, self.key = kind, bare(text), key

    def __str__(self) -> str:
        text = ": ".join(filter(None, (self.kind, self.key, self.text)))
        return text + _address(self.kind.replace("_", "-"))


if SceneWarning.__doc__:  # none with python -OO
    listed = "\n".join(f"    - ``{kind}``: {found}" for kind, found in KINDS.items())
    SceneWarning.__doc__ = SceneWarning.__doc__.replace("    {kinds}", listed)


def gone(name: str) -> str:
    """What to write instead of the name of a warning's class that has left; empty for other names."""
    words = re.findall("[A-Z][a-z]+", name.removesuffix("Warning"))
    kind = "unconverged" if name == "NotSettled" else "_".join(words).lower()
    if kind not in KINDS:
        return ""
    ignored = f'warnings.filterwarnings("ignore", "{kind}:")'
    return f'"{name}" is gone; it is a SceneWarning of the kind "{kind}", as in {ignored}'


class EnergyGrowth(SceneWarning):
    """More than 0.2 % of spurious energy was detected during the run, or 1 % after a loss. The run continues, and warns
    again at its end if that became more than twice as much.

    Attributes
    ----------
    ratio : float
        Ratio of spurious energy to the energy that the bodies should have.
    time : float
        When it was detected [time].
    who : str
        The effect or body that caused most of it.
    """

    def __init__(self, text: str, key: str, ratio: float, time: float, who: str):
        super().__init__("energy_growth", text, key)
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

    def __init__(self, text: str, key: str, time: float, parts: int):
        super().__init__("step_divided", text, key)
        self.time, self.parts = time, parts


def came_in_late(count: int, depth: float, borders: bool = True) -> str:
    """What a warning says of points that were found inside; whole skins have no ``borders``."""
    why = "as over the border of an open surface"
    if not borders:
        why = "as when an element is inverted, since whole skins have no border"
    text = f"{count} points were found up to {depth:.3g} inside the other surface although they did not come in through it, {why}; "
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
