"""Declaration and reading of a scene's tables. A table is a frozen dataclass (:class:`Table`) whose
fields are its keys (:func:`key`); a :class:`Kind` describes the values of a key. The reader with
its messages, the JSON Schema for editors, the pages of the book and the calls of ``Scene`` are
derived from these declarations.
"""

from __future__ import annotations

import dataclasses
import difflib
import inspect
import itertools
import math
import operator
import os
import re
import stat
import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from ._core import ffi
from .errors import Error, bare
from .older import dataclass_transform

T = TypeVar("T", bound="Table")
LONGEST_NAME = 63
MOST = 2**31 - 1


class Source(str):
    """The name of a file whose text is known."""

    def line(self, key: str) -> int | None:
        """The line of a key, counted from 1."""
        raise NotImplementedError


class SceneError(Error, ValueError):
    """A scene that can't be computed.

    Attributes
    ----------
    file
        The scene's file, if it has one.
    key
        The key, such as ``body[1].material``, counted from 0.
    reason
        What is wrong.
    line
        The line of the key in the file, counted from 1; None if the scene was changed since it was read.
    """

    def __init__(
        self, reason: str, key: str = "", file: str | None = None, line: int | None = None
    ):
        self.line = file.line(key) if line is None and isinstance(file, Source) else line
        self.file, self.key, self.reason = None if file is None else str(file), key, bare(reason)
        where = f"{file or 'scene'}" + (f":{self.line}" if self.line else "")
        super().__init__(": ".join(part for part in (where, key, self.reason) if part))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.reason, self.key, self.file, self.line)


@dataclass(frozen=True)
class Place:
    """Position of a value in a scene: ``place / "beta"`` is a key of a table, ``place[0]`` an entry
    of a list. ``dotted`` are the names of the scene's bodies that have dots; ``home`` tells to which
    tables a key belongs."""

    key: str = ""
    file: str | None = None
    dotted: tuple[str, ...] = ()
    home: Callable[[str], str] = lambda name: ""

    def __truediv__(self, name: str) -> Place:
        return dataclasses.replace(self, key=f"{self.key}.{name}".strip("."))

    def __getitem__(self, i: int) -> Place:
        return dataclasses.replace(self, key=f"{self.key}[{i}]")

    def error(self, reason: str) -> SceneError:
        """The error for this position, with a reason."""
        return SceneError(reason, self.key, self.file)

    def need(self, holds: bool, value: Any, what: str) -> None:
        """Raise an error unless the condition holds; ``what`` describes a valid value."""
        if not holds:
            raise self.error(f"is {describe(value)}; it must be {what}")


# Words of the messages.


def suggestion(word: str, known: Iterable[str], lead: str = "known: ") -> str:
    """``; did you mean "steel"?`` if a known name is similar, also in capitals, otherwise the list of all known
    names."""
    known = list(known)
    names = {name.casefold(): name for name in known}
    near = difflib.get_close_matches(str(word).casefold(), names, n=9, cutoff=0.6)
    if near:  # "time" for "tmie", which has more in common with "tie"
        near.sort(key=lambda name: sorted(name) != sorted(str(word).casefold()))
        return f'; did you mean "{names[near[0]]}"?'
    return f"; {lead}{listed(known)}" if known else "; there is none"


def nearest(word: str, known: Iterable[str], most: int = 20) -> list[str]:
    """The known names, of many those that are most like the word."""
    known = list(known)
    if len(known) <= most:
        return known
    names = {name.casefold() for name in known}
    near = difflib.get_close_matches(word.casefold(), names, n=most, cutoff=0.0)
    return [name for name in known if name.casefold() in near]


def listed(words: Iterable[str], last: str = "or") -> str:
    """``"x", "y" or "z"``."""
    *most, end = (f'"{word}"' for word in words)
    return f"{', '.join(most)} {last} {end}" if most else end


def describe(value: Any) -> str:
    """A value as an error message shows it: its kind and, if short, itself."""
    if isinstance(value, (bool, np.bool_)):
        return f"the boolean {str(bool(value)).lower()}"
    if isinstance(value, str):
        return f'the text "{value}"' if len(value) <= 60 else f"a text of {len(value)} characters"
    if isinstance(value, (dict, Table)):
        return "a table"
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype} of shape {value.shape}"
    if isinstance(value, (list, tuple)):
        return f"a list of {len(value)}"
    text = "" if isinstance(value, int) and value.bit_length() > 200 else repr(value)
    return text if 0 < len(text) <= 60 else f"a {type(value).__name__}"


def is_number(value: Any) -> bool:
    """Whether a value is a real number; booleans and complex numbers are not."""
    real = (int, float, np.integer, np.floating)
    return isinstance(value, real) and not isinstance(value, (bool, np.bool_))


def plain(text: str) -> str:
    """A sentence of the book without its markup."""
    text = re.sub(r",? ?\(?(chapter )?:(doc|eq|ref):`[^`]*`\)?", "", text)
    return re.sub(r":\w+:`([^`]*)`", r"\1", text).replace("``", "").replace("\\", "")


# Kinds of values.


class Kind:
    """What the value of a key may be."""

    def read(self, value: Any, at: Place) -> Any:
        """The checked value; an invalid one raises a SceneError."""
        raise NotImplementedError

    json: dict[str, Any]
    """The same as JSON Schema."""

    def schema(self) -> dict[str, Any]:
        """The JSON Schema, also of a table."""
        return self.json

    def c(self, value: Any) -> Any:
        """A checked value as a member of a C struct."""
        return value


# Name of a limit: how it is compared, its word in a message and in JSON Schema.
LIMITS: dict[str, tuple[Callable[[float, float], bool], str, str]] = {
    "above": (operator.gt, "above", "exclusiveMinimum"),
    "least": (operator.ge, "at least", "minimum"),
    "below": (operator.lt, "below", "exclusiveMaximum"),
    "most": (operator.le, "at most", "maximum"),
}


class Number(Kind):
    """A finite real number within ``above``, ``least``, ``below``, ``most``; ``why`` explains the limits."""

    def __init__(self, why: str = "", **limits: float):
        self.why, self.limits = why, {LIMITS[name]: limit for name, limit in limits.items()}
        self.json = {"type": "number", **{each[2]: value for each, value in self.limits.items()}}

    def read(self, value: Any, at: Place) -> float:
        at.need(is_number(value), value, "a number")
        too_large = isinstance(value, int) and abs(value) > sys.float_info.max
        number = math.inf if too_large else float(value)
        at.need(math.isfinite(number), value, "a finite number")
        for (holds, word, _), limit in self.limits.items():
            at.need(holds(number, limit), value, f"{word} {limit:g}{self.why}")
        return number


class Whole(Kind):
    """A whole number from ``least`` to ``most``, a multiple of ``step``."""

    def __init__(self, least: int = 1, most: int = MOST, step: int = 1):
        self.least, self.most, self.step = least, most, step
        self.json = {"type": "integer", "minimum": least, "maximum": most}
        self.json |= {"multipleOf": step} if step > 1 else {}

    def read(self, value: Any, at: Place) -> int:
        whole = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
        at.need(whole, value, "a whole number")
        inside = self.least <= value <= self.most
        most = f" and at most {self.most}" if self.most < MOST or value > MOST else ""
        at.need(inside, value, f"at least {self.least}{most}")
        at.need(value % self.step == 0, value, f"a multiple of {self.step}")
        return int(value)


class Flag(Kind):
    """True or false; with ``only`` nothing but true, for the reason in ``only``."""

    def __init__(self, only: str = ""):
        self.only, self.json = only, {"const": True} if only else {"type": "boolean"}

    def read(self, value: Any, at: Place) -> bool:
        right = isinstance(value, bool) and (value or not self.only)
        at.need(right, value, f"true{self.only or ' or false'}")
        return bool(value)


class Text(Kind):
    """A Unicode text."""

    json: dict[str, Any] = {"type": "string"}
    what = "a text"

    def read(self, value: Any, at: Place) -> str:
        at.need(isinstance(value, str), value, self.what)
        try:
            value.encode()
        except UnicodeEncodeError:
            raise at.error(f"{value!a} is no Unicode text") from None
        return str(value)


class FileName(Text):
    """The name of a file."""

    json = {"type": "string", "minLength": 1}
    what = "the name of a file, in quotes"

    def read(self, value: Any, at: Place) -> str:
        name = super().read(value, at)
        if not name or "\0" in name:
            raise at.error("is no file name")
        return name


class Name(Text):
    """A name: printable, and no longer than the C library stores it."""

    json = {"type": "string", "maxLength": LONGEST_NAME, "pattern": r"^\S(.*\S)?$"}

    def read(self, value: Any, at: Place) -> str:
        name = super().read(value, at)
        if not name or not name.isprintable() or name != name.strip():
            raise at.error(
                f"{name!r} is no name; use printable characters without blanks at the ends"
            )
        if len(name.encode()) > LONGEST_NAME:
            raise at.error(f"is {len(name.encode())} bytes long; at most {LONGEST_NAME} are kept")
        return name


class Reference(Text):
    """The name of a table of the scene, such as a ``material``."""

    def __init__(self, table: str):
        self.table, self.what = table, f"the name of a [[{table}]]"

    def read(self, value: Any, at: Place) -> Named:
        return Named(self.table, super().read(value, at))


class Named(str):
    """The name of another table of the scene, of the kind ``table``."""

    table: str

    def __new__(cls, table: str, name: str) -> Named:
        self = super().__new__(cls, name)
        self.table = table
        return self


class Face(NamedTuple):
    """A body, and one of its faces or sets."""

    body: str
    face: str


SIDES = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max")
FACES = (*SIDES, "outer")


class Surface(Text):
    """``"left.x_max"``, a body and one of its faces, or ``"gear.teeth"``, a body and a set of its mesh. Both names
    may have dots; of two bodies ``"a"`` and ``"a.b"`` the longer name counts."""

    json = {"type": "string", "pattern": r"^.+\..+$"}
    what = 'a text such as "left.x_max"'

    def read(self, value: Any, at: Place) -> Any:
        value = super().read(value, at)
        body, dot, face = value.rpartition(".")
        if face not in FACES:
            body, dot, face = value.partition(".")
            for name in at.dotted:
                if value.startswith(f"{name}.") and len(name) > len(body):
                    body, face = name, value[len(name) + 1 :]
        if not (dot and face):
            reason = "is no face; write body and face with a dot, such as"
            raise at.error(f'"{value}" {reason} "left.x_max"')
        return Face(Named("body", body), face)


class Part(NamedTuple):
    """A table of the scene and its number; None if it is the only one."""

    table: str
    number: int | None


class PartKey(Text):
    """The key of a table of the scene of one of some kinds: ``"contact[1]"``, or ``"contact"`` if there is
    only one."""

    def __init__(self, *tables: str):
        self.tables = tables
        self.json = {"type": "string", "pattern": rf"^({'|'.join(tables)})(\[[0-9]{{1,9}}\])?$"}

    def read(self, value: Any, at: Place) -> Any:
        text = super().read(value, at)
        found = re.fullmatch(r"(\w+)(?:\[([0-9]{1,9})\])?", text)
        if found is None or found[1] not in self.tables:
            near = suggestion(text.partition("[")[0], self.tables, "it must be ")
            raise at.error(f'"{text}" is no part of a scene that has a resultant{near}')
        return Part(found[1], None if found[2] is None else int(found[2]))


def word(enum: Mapping[str, int], value: int) -> str:
    """The word of a value of an enum."""
    return next(name for name, number in enum.items() if number == value)


class Choice(Text):
    """One of some words; those of a C enum have their values. ``gone`` gives the reason for each
    word that was removed, and its replacement."""

    def __init__(self, known: Collection[str], gone: Mapping[str, str] | None = None):
        self.known, self.gone, self.json = known, gone or {}, {"enum": list(known)}

    def read(self, value: Any, at: Place) -> str:
        chosen = super().read(value, at)
        if chosen not in self.known:
            unknown = "is unknown" + suggestion(chosen, self.known, "it must be ")
            raise at.error(f'"{chosen}" {self.gone.get(chosen, unknown)}')
        return chosen

    def c(self, value: str) -> Any:
        return self.known[value] if isinstance(self.known, Mapping) else value


def entries(value: Any, at: Place, what: str = "a list") -> list[Any]:
    """The entries of a list or of a one-dimensional array; ``what`` describes it in a message."""
    array = isinstance(value, np.ndarray) and value.ndim == 1
    at.need(array or isinstance(value, (list, tuple)), value, what)
    return list(value)


class Each(Kind):
    """A list with an entry of each of some kinds, such as three numbers."""

    def __init__(self, *kinds: Kind):
        self.kinds, each = kinds, [kind.json for kind in kinds]
        self.json = {"type": "array", "prefixItems": each, "minItems": len(each)}
        self.json["maxItems"] = len(each)

    def read(self, value: Any, at: Place) -> tuple[Any, ...]:
        found = entries(value, at, f"a list of {len(self.kinds)}")
        if len(found) != len(self.kinds):
            raise at.error(f"has {len(found)} entries; it must have {len(self.kinds)}")
        return tuple(kind.read(found[i], at[i]) for i, kind in enumerate(self.kinds))


class Many(Kind):
    """A list of entries of one kind. ``none`` is the message for an empty list. With ``distinct``
    an entry that is given twice is an error; otherwise a repeated word counts once."""

    def __init__(self, kind: Kind, none: str = "", distinct: bool = False):
        self.kind, self.none, self.distinct = kind, none, distinct
        self.json = {"type": "array", "items": kind.json, "minItems": 1 if none else 0}
        self.json["uniqueItems"] = distinct

    def read(self, value: Any, at: Place) -> tuple[Any, ...]:
        found = entries(value, at)
        if self.none and not found:
            raise at.error(f"is empty; {self.none}")
        for i, entry in enumerate(found):
            found[i] = self.kind.read(entry, at[i])
            if self.distinct and found[i] in found[:i]:
                raise at[i].error(f'"{found[i]}" is named twice')
        return tuple(dict.fromkeys(found) if isinstance(self.kind, Choice) else found)


class Rows(Kind):
    """A table of numbers: rows of 3 coordinates, or (``whole``) of the node numbers of elements."""

    def __init__(self, *widths: int, whole: bool = False):
        self.widths, self.whole = widths, whole
        row = {"type": "array", "items": (Whole(0) if whole else Number()).json}
        rows = [{"items": {**row, "minItems": n, "maxItems": n}} for n in widths]
        self.json = {"type": "array", "minItems": 1, "anyOf": rows}

    def read(self, value: Any, at: Place) -> NDArray[Any]:
        """
        The rows as a contiguous array of float64, or of int32 if ``whole``.

        Real numbers that this type represents without loss are accepted: float32, integers, any
        strides and byte order. Booleans, complex numbers, texts and wider floats are not.
        """
        at.need(isinstance(value, (np.ndarray, list, tuple)), value, "an array")
        if np.ma.is_masked(value):
            raise at.error("has masked values; fill or leave them out")
        try:
            array = np.asarray(value)
        except (ValueError, TypeError, OverflowError) as error:
            raise at.error(f"is no rectangular array ({error})") from None
        kinds, need = ("iu", "whole") if self.whole else ("fiu", "real")
        lists = [row for row in value if isinstance(row, (list, tuple))]
        if any(isinstance(entry, bool) for row in lists for entry in row):
            raise at.error("holds a boolean; numbers are needed")
        if array.size == 0:
            raise at.error("is empty")
        if array.dtype.kind not in kinds or array.dtype.itemsize > 8:
            raise at.error(f"holds {array.dtype}; {need} numbers of at most 64 bits are needed")
        if array.ndim != 2 or array.shape[1] not in self.widths:
            widths = " or ".join(map(str, self.widths))
            raise at.error(f"has shape {array.shape}; it must be (n, {widths})")
        out = np.ascontiguousarray(array, np.int32 if self.whole else np.float64)
        if array.dtype.kind == "f":
            good, why = np.isfinite(out), "; all coordinates must be finite"
        else:
            least, most = (0, MOST) if self.whole else (-(2**53), 2**53)
            good = (array >= least) & (array <= most)
            why = f", outside {'0 ... 2^31 - 1' if self.whole else 'the integers to 2^53 that float64 holds'}"
        bad = np.flatnonzero(~good.all(axis=1))
        if bad.size:
            raise at.error(f"row {bad[0]} is {array[bad[0]].tolist()}{why}")
        return out


class Indices(Rows):
    """A list of numbers of nodes or elements."""

    def __init__(self) -> None:
        super().__init__(1, whole=True)
        self.json = {"type": "array", "items": Whole(0).json, "minItems": 1}

    def read(self, value: Any, at: Place) -> NDArray[Any]:
        """The numbers as a contiguous array of int32."""
        listed = entries(value, at) if not isinstance(value, np.ndarray) else None
        rows = value.reshape(-1, 1) if listed is None else [[entry] for entry in listed]
        return super().read(rows, at).ravel()


class Nested(Kind):
    """A table within a table."""

    def __init__(self, model: type[Table]):
        self.model = model

    def schema(self) -> dict[str, Any]:
        return self.model.schema()

    def read(self, value: Any, at: Place) -> Any:
        return self.model.read(value, at)


class ByName(Kind):
    """Values of one kind by name: a table whose keys the user chooses."""

    def __init__(self, kind: Kind):
        self.kind = kind
        if isinstance(kind, Nested):
            self.model = kind.model

    def schema(self) -> dict[str, Any]:
        out = {"type": "object", "propertyNames": Name.json, "minProperties": 1}
        return {**out, "additionalProperties": self.kind.schema()}

    def read(self, value: Any, at: Place) -> dict[str, Any]:
        at.need(isinstance(value, dict), value, "a table")
        if not value:
            raise at.error("is empty; give at least one name")
        return {
            Name().read(name, at): self.kind.read(entry, at / str(name))
            for name, entry in value.items()
        }


class OneOrByName(ByName):
    """One value, or values by name."""

    def schema(self) -> dict[str, Any]:
        return {"anyOf": [self.kind.schema(), super().schema()]}

    def read(self, value: Any, at: Place) -> Any:
        return super().read(value, at) if isinstance(value, dict) else self.kind.read(value, at)


class Several(Nested):
    """Tables of one kind, written ``[[key]]``."""

    def schema(self) -> dict[str, Any]:
        return {"type": "array", "items": self.model.schema()}

    def read(self, value: Any, at: Place) -> tuple[Table, ...]:
        listed = isinstance(value, (list, tuple))
        at.need(listed, value, f"an array of tables, written [[{at.key}]]")
        return tuple(self.model.read(item, at[i]) for i, item in enumerate(value))


VECTOR = Each(Number(), Number(), Number())


# Tables.


def key(
    kind: Kind,
    *,
    unit: str = "",
    says: str = "",
    default: Any = dataclasses.MISSING,
    kw_only: bool = True,
    free: bool = False,
) -> Any:
    """
    A key of a table.

    Parameters
    ----------
    kind
        Kind of its values.
    unit
        Its dimension, such as "stress"; "" for a plain number.
    default
        Its value if the key is left out. A key without a default is required; None means no value.
    says
        Text for the book instead of the default.
    kw_only
        False for a positional argument of a call of ``Scene``.
    free
        Whether it may change when a run is continued.
    """
    about = {"kind": kind, "unit": unit, "says": says, "free": free}
    return dataclasses.field(default=default, kw_only=kw_only, metadata=about)


@dataclass_transform(
    eq_default=False, kw_only_default=True, frozen_default=True, field_specifiers=(key,)
)
class Table:
    """A table of a scene. A subclass declares its keys as fields, ``young: float =
    key(Number(above=0.0), unit="stress")``, and describes them in its docstring."""

    one: ClassVar[tuple[tuple[str, ...], ...]] = ()
    """Groups of keys of which exactly one must be given."""
    rivals: ClassVar[tuple[tuple[str, ...], ...]] = ()
    """Groups of keys of which at most one may be given."""
    needs: ClassVar[Mapping[str, str]] = {}
    """Keys that require another key."""
    belongs: ClassVar[Mapping[str, tuple[str, str]]] = {}
    """Keys that have a meaning only where another one has a certain word."""

    def __init_subclass__(cls, eq: bool = False) -> None:
        # Written once here: each dataclass would generate these methods, and Python compile them at start.
        dataclass(kw_only=True, eq=eq, unsafe_hash=eq, repr=False, match_args=False)(cls)

    def __setattr__(self, name: str, value: Any) -> None:
        if name in self.__dict__:
            raise dataclasses.FrozenInstanceError(f"cannot assign to {name!r}")
        super().__setattr__(name, value)

    def __delattr__(self, name: str) -> None:
        raise dataclasses.FrozenInstanceError(f"cannot delete {name!r}")

    def __repr__(self) -> str:
        given = ", ".join(f"{name}={getattr(self, name)!r}" for name in self.keys())
        return f"{type(self).__name__}({given})"

    @classmethod
    def keys(cls) -> dict[str, dataclasses.Field[Any]]:
        """The keys by name, in their order."""
        return {field.name: field for field in dataclasses.fields(cls)}  # type: ignore[arg-type]

    @classmethod
    def docs(cls) -> dict[str, str]:
        """What the keys mean, from the section "Attributes" of the docstrings."""
        texts = (inspect.cleandoc(each.__doc__ or "") for each in cls.__mro__ if each is not Table)
        found = (re.findall(r"^(\w+)\n((?:    .+\n?)+)", text, re.M) for text in texts)
        return {name: " ".join(text.split()) for each in reversed([*found]) for name, text in each}

    @classmethod
    def needed(cls) -> list[str]:
        """The keys that must be given."""
        return [name for name, field in cls.keys().items() if required(field)]

    @classmethod
    def described(cls) -> str:
        """The table in the words of a message, with the keys that must be given."""
        return "a table" + (f" with {listed(cls.needed(), 'and')}" if cls.needed() else "")

    @classmethod
    def read(cls: type[T], value: Any, at: Place) -> T:
        """Read a table and check each key alone; :meth:`refusals` and references are checked when the whole
        scene is known."""
        known = cls.keys()
        at.need(isinstance(value, dict), value, cls.described())
        for name in value:
            if name not in known:
                other = at.home(name) + suggestion(name, known)
                raise (at / str(name)).error("unknown key" + other)
        for name in cls.needed():
            if name not in value:
                kind = known[name].metadata["kind"]
                must = f"; it must be {kind.model.described()}" if type(kind) is Nested else ""
                raise (at / name).error("is missing" + must)
        found = cls._alternatives(value, at)
        for name, field in known.items():
            if name in value:
                if value[name] is None:
                    raise (at / name).error("is None; leave the key out instead")
                kind = field.metadata["kind"]
                if isinstance(kind, Several) and isinstance(value[name], dict):
                    cls._check_single(name, value, at)
                try:
                    found[name] = kind.read(value[name], at / name)
                except SceneError as error:  # a list that is none or too short: of what?
                    if isinstance(kind, Each) and error.key == (at / name).key:
                        meant = plain(cls.docs().get(name, "")).rstrip(".")
                        raise (at / name).error(
                            f"{error.reason}: {meant[:1].lower()}{meant[1:]}"
                        ) from None
                    raise
        return cls(**found)

    @classmethod
    def _check_single(cls, name: str, value: Mapping[str, Any], at: Place) -> None:
        """Raise an error for a single table in place of several if its keys are those of a missing table."""
        kinds = {each: field.metadata["kind"] for each, field in cls.keys().items()}
        fits = [each for each in kinds if each not in value and type(kinds[each]) is Nested]
        for each in [name, *fits]:
            if set(value[name]) <= set(kinds[each].model.keys()):
                if each != name:
                    raise (at / name).error(f'is a table with the keys of "{each}"; is that meant?')
                return

    @classmethod
    def _alternatives(cls, value: Mapping[str, Any], at: Place) -> dict[str, Any]:
        """Check combinations of keys; None for each key that is replaced by another one."""
        out: dict[str, Any] = {}
        for group in cls.one + cls.rivals:
            there = [name for name in group if name in value]
            if len(there) > 1:
                reason = f'cannot stand beside "{there[0]}"; give exactly one of {listed(group)}'
                raise (at / there[1]).error(reason)
            if not there and group in cls.one:
                raise at.error(f"gives none of {listed(group, 'and')}; exactly one is needed")
            if there:
                out |= dict.fromkeys(group)
        for name, other in cls.needs.items():
            if name in value and other not in value:
                reason = f'stands alone; it belongs to "{other}", give "{other}" too'
                raise (at / name).error(reason)
        return out

    def refusals(self) -> Iterator[tuple[str, str]]:
        """Keys that are valid alone but contradict each other: the key, such as ``radius[1]``, and
        the reason."""
        for name, (other, wanted) in self.belongs.items():
            value, there = getattr(self, name), getattr(self, other)
            if value != self.keys()[name].default and there != wanted:
                belongs = f'it belongs to {other} = "{wanted}", not to "{there}"'
                yield name, f"is {describe(value)}; {belongs}"

    def c(self, struct: str, **members: Any) -> dict[str, Any]:
        """The members of a C struct: keys with a value other than a table whose names the struct has, and
        further ``members``."""
        out, known, there = dict[str, Any](), self.keys(), dict(ffi.typeof(struct).fields)
        for name in there.keys() & known.keys():
            value = getattr(self, name)
            if value is not None and not isinstance(value, Table):
                out[name] = known[name].metadata["kind"].c(value)
        return {**out, **members}

    @classmethod
    def schema(cls) -> dict[str, Any]:
        """The JSON Schema of the table."""
        properties, docs = {}, cls.docs()
        for name, field in cls.keys().items():
            about: dict[str, Any] = {"description": plain(docs[name])} if name in docs else {}
            kind = field.metadata["kind"]
            if not required(field) and field.default is not None and not isinstance(kind, Nested):
                about["default"] = field.default
            properties[name] = {**kind.schema(), **about}
        out = {
            "type": "object",
            "properties": properties,
            "required": cls.needed(),
            "additionalProperties": False,
            "dependentRequired": {name: [other] for name, other in cls.needs.items()},
        }
        groups: list[dict[str, Any]]
        groups = [{"oneOf": [{"required": [name]} for name in group]} for group in cls.one]
        pairs = (pair for group in cls.rivals for pair in itertools.combinations(group, 2))
        groups += [{"not": {"required": [*pair]}} for pair in pairs]
        return out | ({"allOf": groups} if groups else {})


def required(field: dataclasses.Field[Any]) -> bool:
    """Whether a key has no default."""
    return field.default is dataclasses.MISSING


def walk(value: Any, at: Place) -> Iterator[tuple[Place, Any]]:
    """All tables, faces and names in a value that was read, with their places."""
    if isinstance(value, (Table, Named, Face)):
        yield at, value
    if isinstance(value, Table):
        for name in value.keys():
            yield from walk(getattr(value, name), at / name)
    elif isinstance(value, dict):
        for name, entry in value.items():
            yield from walk(entry, at / name)
    elif isinstance(value, tuple) and value and isinstance(value[0], (Table, Named, Face)):
        for i, entry in enumerate(value):
            yield from walk(entry, at if isinstance(value, Face) else at[i])


def check_file(path: str | Path, most: float = math.inf) -> None:
    """Raise a ValueError that names the file if it is not a regular file (a device or a pipe may
    never end) or has more than ``most`` bytes."""
    found = os.stat(path)
    if not stat.S_ISREG(found.st_mode):
        folder = stat.S_ISDIR(found.st_mode)
        what = "a folder" if folder else "not a regular file but a device, a pipe or the like"
        raise ValueError(f'"{path}" is {what}')
    if found.st_size > most:
        size = f"{found.st_size / 1e6:.6g} MB; at most {most / 1e6:g} MB are read"
        raise ValueError(f'"{path}" has {size}')
