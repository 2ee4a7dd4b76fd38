"""
How a scene's tables are declared and read. A table is a frozen dataclass (:class:`Table`) whose fields are its keys (:func:`key`); what a key may hold
is a :class:`Kind`. From these declarations come the reader with its messages, the JSON Schema for editors, the pages of the book and the calls of ``Scene``.
"""

from __future__ import annotations

import dataclasses
import difflib
import inspect
import math
import operator
import os
import re
import stat
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, TypeVar, dataclass_transform

import numpy as np
from numpy.typing import NDArray

from ._core import ffi
from .errors import Error

T = TypeVar("T", bound="Table")
LONGEST_NAME = 63
MOST = 2**31 - 1


class SceneError(Error, ValueError):
    """A scene that can't be computed.

    Attributes
    ----------
    file
        The scene's file, if it has one.
    key
        The key at fault, such as ``body[1].material``, counted from 0.
    reason
        What is wrong.
    """

    def __init__(self, reason: str, key: str = "", file: str | None = None):
        self.file, self.key, self.reason = file, key, reason
        super().__init__(": ".join(part for part in (file or "scene", key, reason) if part))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.reason, self.key, self.file)


@dataclass(frozen=True)
class Place:
    """Where in a scene a value stands: ``place / "beta"`` is a key of a table, ``place[0]`` an entry of a list."""

    key: str = ""
    file: str | None = None

    def __truediv__(self, name: str) -> Place:
        return Place(f"{self.key}.{name}".strip("."), self.file)

    def __getitem__(self, i: int) -> Place:
        return Place(f"{self.key}[{i}]", self.file)

    def error(self, reason: str) -> SceneError:
        """The error that says what is wrong here."""
        return SceneError(reason, self.key, self.file)


# Words of the messages.


def suggestion(word: str, known: Iterable[str], lead: str = "known: ") -> str:
    """``; did you mean "steel"?`` when a known name is near, else the list of all known names."""
    known = list(known)
    near = difflib.get_close_matches(str(word), known, n=1, cutoff=0.6)
    if near:
        return f'; did you mean "{near[0]}"?'
    return f"; {lead}{listed(known)}" if known else "; there is none"


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
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype} of shape {value.shape}"
    if isinstance(value, (list, tuple)):
        return f"a list of {len(value)}"
    try:
        text = repr(value)
    except ValueError:
        return "a whole number of very many digits"
    return text if len(text) <= 60 else f"a {type(value).__name__}"


def is_number(value: Any) -> bool:
    """Whether a value is a real number; booleans and complex numbers are not."""
    real = (int, float, np.integer, np.floating)
    return isinstance(value, real) and not isinstance(value, (bool, np.bool_))


def plain(text: str) -> str:
    """A sentence of the book without its markup."""
    text = re.sub(r",? ?\(?(chapter )?:(doc|eq|ref):`[^`]*`\)?", "", text)
    return re.sub(r":\w+:`([^`]*)`", r"\1", text).replace("``", "").replace("\\", "")


# What a key may hold.


class Kind:
    """What the value of a key may be."""

    def read(self, value: Any, at: Place) -> Any:
        """The checked value; what is wrong is a SceneError."""
        raise NotImplementedError

    json: dict[str, Any]
    """The same as JSON Schema."""

    def schema(self) -> dict[str, Any]:
        """The JSON Schema, also of a table."""
        return self.json

    def c(self, value: Any) -> Any:
        """A checked value as a member of a C struct."""
        return value

    def references(self, value: Any, at: Place) -> Iterator[tuple[Place, str, str]]:
        """The tables that a checked value names: where it does, their key in the scene, and their name."""
        return iter(())


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
        if not is_number(value):
            raise at.error(f"is {describe(value)}; it must be a number")
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            raise at.error(f"is {describe(value)}; it must be a finite number")
        for (holds, word, _), limit in self.limits.items():
            if not holds(number, limit):
                raise at.error(f"is {number:g}; it must be {word} {limit:g}{self.why}")
        return number


class Whole(Kind):
    """A whole number from ``least`` to ``most``."""

    def __init__(self, least: int = 1, most: int = MOST):
        self.least, self.most = least, most
        self.json = {"type": "integer", "minimum": least, "maximum": most}

    def read(self, value: Any, at: Place) -> int:
        if not isinstance(value, (int, np.integer)) or isinstance(value, bool):
            raise at.error(f"is {describe(value)}; it must be a whole number")
        if not self.least <= value <= self.most:
            raise at.error(f"is {describe(value)}; it must be from {self.least} to {self.most}")
        return int(value)


class Flag(Kind):
    """True or false; with ``only`` nothing but true, for the reason in ``only``."""

    def __init__(self, only: str = ""):
        self.only, self.json = only, {"const": True} if only else {"type": "boolean"}

    def read(self, value: Any, at: Place) -> bool:
        if not isinstance(value, bool) or (self.only and not value):
            raise at.error(f"is {describe(value)}; it must be true{self.only or ' or false'}")
        return value


class Text(Kind):
    """A Unicode text."""

    json: dict[str, Any] = {"type": "string"}

    def read(self, value: Any, at: Place) -> str:
        if not isinstance(value, str):
            raise at.error(f"is {describe(value)}; it must be a text")
        try:
            value.encode()
        except UnicodeEncodeError:
            raise at.error(f"{value!a} is no Unicode text") from None
        return str(value)


class FileName(Text):
    """The name of a file."""

    json = {"type": "string", "minLength": 1}

    def read(self, value: Any, at: Place) -> str:
        name = super().read(value, at)
        if not name or "\0" in name:
            raise at.error("is no file name")
        return name


class Name(Text):
    """A text that can name something: printable, and no longer than the C library keeps it."""

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


@dataclass(frozen=True)
class Reference(Text):
    """The name of a table of the scene, such as a ``material``."""

    table: str

    def references(self, value: str, at: Place) -> Iterator[tuple[Place, str, str]]:
        yield at, self.table, value


FACES = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max", "outer")


class Surface(Text):
    """``"left.x_max"``, a body and one of its faces, as the pair of both."""

    json = {"type": "string", "pattern": rf"\.({'|'.join(FACES)})$"}

    def read(self, value: Any, at: Place) -> Any:
        if not isinstance(value, str):
            raise at.error(f'is {describe(value)}; it must be a text such as "left.x_max"')
        body, dot, face = value.rpartition(".")
        if not dot:
            raise at.error(
                f'"{value}" is no face; write body and face with a dot, such as "left.x_max"'
            )
        if face not in FACES:
            raise at.error(
                f'"{value}": body "{body}" has no face "{face}"' + suggestion(face, FACES)
            )
        return body, face

    def references(self, value: tuple[str, str], at: Place) -> Iterator[tuple[Place, str, str]]:
        yield at, "body", value[0]


def word(enum: Mapping[str, int], value: int) -> str:
    """The word of a value of an enum."""
    return next(name for name, number in enum.items() if number == value)


class Choice(Text):
    """One of some words; those of a C enum come with their values."""

    def __init__(self, known: Collection[str]):
        self.known, self.json = known, {"enum": list(known)}

    def read(self, value: Any, at: Place) -> str:
        chosen = super().read(value, at)
        if chosen not in self.known:
            raise at.error(f'"{chosen}" is unknown' + suggestion(chosen, self.known, "it must be "))
        return chosen

    def c(self, value: str) -> Any:
        return self.known[value] if isinstance(self.known, Mapping) else value


def entries(value: Any, at: Place) -> list[Any]:
    """The entries of a list or of a one-dimensional array."""
    if not isinstance(value, (list, tuple)) and not (
        isinstance(value, np.ndarray) and value.ndim == 1
    ):
        raise at.error(f"is {describe(value)}; it must be a list")
    return list(value)


class Each(Kind):
    """A list with an entry of each of some kinds, such as three numbers."""

    def __init__(self, *kinds: Kind):
        self.kinds, each = kinds, [kind.json for kind in kinds]
        self.json = {"type": "array", "prefixItems": each, "minItems": len(each)}
        self.json["maxItems"] = len(each)

    def read(self, value: Any, at: Place) -> tuple[Any, ...]:
        found = entries(value, at)
        if len(found) != len(self.kinds):
            raise at.error(f"has {len(found)} entries; it must have {len(self.kinds)}")
        return tuple(
            kind.read(entry, at[i]) for i, (kind, entry) in enumerate(zip(self.kinds, found))
        )

    def references(self, value: Any, at: Place) -> Iterator[tuple[Place, str, str]]:
        for i, (kind, entry) in enumerate(zip(self.kinds, value)):
            yield from kind.references(entry, at[i])


class Many(Kind):
    """A list of entries of one kind; ``none`` says what an empty one lacks, and ``distinct`` refuses an entry that stands twice (a word counts once else)."""

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

    def references(self, value: Any, at: Place) -> Iterator[tuple[Place, str, str]]:
        for i, entry in enumerate(value):
            yield from self.kind.references(entry, at[i])


class Rows(Kind):
    """A table of numbers: rows of 3 coordinates, or (``whole``) of the node numbers of elements."""

    def __init__(self, *widths: int, whole: bool = False):
        self.widths, self.whole = widths, whole
        entry = Whole(0).json if whole else Number().json
        row = {"type": "array", "items": entry}
        rows = [{"items": {**row, "minItems": n, "maxItems": n}} for n in widths]
        self.json = {"type": "array", "minItems": 1, "anyOf": rows}

    def read(self, value: Any, at: Place) -> NDArray[Any]:
        try:
            if self.whole:
                return index_array(value, self.widths, MOST + 1)
            return float_array(value, self.widths[0])
        except ValueError as error:
            raise at.error(str(error)) from None


class Nested(Kind):
    """A table within a table."""

    def __init__(self, model: type[Table]):
        self.model = model

    def schema(self) -> dict[str, Any]:
        return self.model.schema()

    def read(self, value: Any, at: Place) -> Table:
        return self.model.read(value, at)


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
        What it may hold.
    unit
        Its dimension, such as "stress"; "" for a plain number.
    default
        Its value where the key is left out; without one it is required, and None means that there is no value.
    says
        What the book says in place of the default.
    kw_only
        False for a key that a call of ``Scene`` takes by its place.
    free
        Whether it may change when a run is continued.
    """
    about = {"kind": kind, "unit": unit, "says": says, "free": free}
    return dataclasses.field(default=default, kw_only=kw_only, metadata=about)


@dataclass_transform(kw_only_default=True, frozen_default=True, field_specifiers=(key,))
class Table:
    """A table of a scene. A subclass declares its keys as fields, ``young: float = key(Number(above=0.0), unit="stress")``, and says in its docstring what they mean."""

    one: ClassVar[tuple[tuple[str, ...], ...]] = ()
    """Groups of keys exactly one of which must be there."""
    rivals: ClassVar[tuple[tuple[str, ...], ...]] = ()
    """Groups of keys at most one of which may be there."""
    needs: ClassVar[Mapping[str, str]] = {}
    """Keys that can't stand without another one."""
    given: frozenset[str] = frozenset()
    """The keys that the scene has; the others have their defaults."""

    def __init_subclass__(cls, eq: bool = True) -> None:
        cls.__annotations__.pop("given", None)
        dataclass(frozen=True, kw_only=True, eq=eq)(cls)

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
    def read(cls: type[T], value: Any, at: Place) -> T:
        """The table of a scene, each key checked alone; :meth:`refusals` and references are for later, when the whole scene is there."""
        if not isinstance(value, dict):
            raise at.error(f"is {describe(value)}; it must be a table")
        known = cls.keys()
        for name in [name for name, field in known.items() if required(field)]:
            if name not in value:
                near = difflib.get_close_matches(name, map(str, value), n=1, cutoff=0.75)
                hint = f'; is "{near[0]}" meant to be it?' if near and near[0] not in known else ""
                raise (at / name).error("is missing" + hint)
        for name in value:
            if name not in known:
                raise (at / str(name)).error("unknown key" + suggestion(name, known))
        found = cls._alternatives(value, at)
        for name, field in known.items():
            if name in value:
                if value[name] is None:
                    raise (at / name).error("is None; leave the key out instead")
                found[name] = field.metadata["kind"].read(value[name], at / name)
        table = cls(**found)
        object.__setattr__(table, "given", frozenset(value))
        return table

    @classmethod
    def _alternatives(cls, value: Mapping[str, Any], at: Place) -> dict[str, Any]:
        """Check which keys stand together; None for each key in the place of which another one stands."""
        out: dict[str, Any] = {}
        for group in cls.one + cls.rivals:
            there = [name for name in group if name in value]
            if len(there) > 1:
                raise (at / there[1]).error(
                    f'cannot stand beside "{there[0]}"; give exactly one of {listed(group)}'
                )
            if not there and group in cls.one:
                raise at.error(f"gives none of {listed(group, 'and')}; exactly one is needed")
            if there:
                out |= dict.fromkeys(group)
        for name, other in cls.needs.items():
            if name in value and other not in value:
                raise (at / name).error(
                    f'stands alone; it belongs to "{other}", give "{other}" too'
                )
        return out

    def refusals(self) -> Iterator[tuple[str, str]]:
        """Keys, each right alone, that contradict each other: the key, such as ``radius[1]``, and the reason."""
        return iter(())

    def walk(self, at: Place) -> Iterator[tuple[Place, Table]]:
        """The table and all tables within it."""
        yield at, self
        for name in self.keys():
            inner = getattr(self, name)
            if isinstance(inner, Table):
                yield from inner.walk(at / name)

    def c(self, struct: str, **members: Any) -> dict[str, Any]:
        """The members of a C struct that have the name of a key which has a value, and further ``members``."""
        known = self.keys()
        out = {
            name: known[name].metadata["kind"].c(getattr(self, name))
            for name, _ in ffi.typeof(struct).fields
            if name in known and getattr(self, name) is not None
        }
        return {**out, **members}

    @classmethod
    def schema(cls) -> dict[str, Any]:
        """The JSON Schema of the table."""
        properties, docs = {}, cls.docs()
        for name, field in cls.keys().items():
            about: dict[str, Any] = {"description": plain(docs[name])} if name in docs else {}
            if not required(field) and field.default is not None:
                about["default"] = field.default
            properties[name] = {**field.metadata["kind"].schema(), **about}
        out = {
            "type": "object",
            "properties": properties,
            "required": [name for name, field in cls.keys().items() if required(field)],
            "additionalProperties": False,
            "dependentRequired": {name: [other] for name, other in cls.needs.items()},
        }
        groups: list[dict[str, Any]]
        groups = [{"oneOf": [{"required": [name]} for name in group]} for group in cls.one]
        groups += [{"not": {"required": [*group]}} for group in cls.rivals]
        return out | ({"allOf": groups} if groups else {})


def required(field: dataclasses.Field[Any]) -> bool:
    """Whether a key has no default."""
    return field.default is dataclasses.MISSING


# Files and arrays.


def check_file(path: str | Path, most: float = math.inf) -> None:
    """Refuse, with a ValueError that names it, a file that is none (a device or a pipe may never end) or that has more than ``most`` bytes."""
    found = os.stat(path)
    if not stat.S_ISREG(found.st_mode):
        raise ValueError(
            f'"{path}" is '
            + (
                "a folder"
                if stat.S_ISDIR(found.st_mode)
                else "no regular file but a device, a pipe or the like"
            )
        )
    if found.st_size > most:
        raise ValueError(
            f'"{path}" has {found.st_size / 1e6:.6g} MB; at most {most / 1e6:g} MB are read'
        )


def float_array(value: Any, width: int) -> NDArray[Any]:
    """
    A table of coordinates as a contiguous float64 array of shape (n, ``width``).

    Any real numbers that float64 holds without loss are taken (float32, integers, any strides or byte order);
    booleans, complex numbers, texts and wider floats are refused with a ValueError that says why.
    """
    array = _rectangular(value)
    if array.dtype.kind not in "fiu" or (array.dtype.kind == "f" and array.dtype.itemsize > 8):
        raise ValueError(
            f"holds {array.dtype}; real numbers (float64 or what it holds exactly) are needed"
        )
    if array.ndim != 2 or array.shape[1] != width:
        raise ValueError(f"has shape {array.shape}; it must be (n, {width})")
    out = np.ascontiguousarray(array, dtype=np.float64)
    if array.dtype.kind in "iu" and not np.array_equal(out.astype(object), array.astype(object)):
        raise ValueError("holds integers above 2^53, which float64 would round")
    bad = np.flatnonzero(~np.isfinite(out).all(axis=1))
    if bad.size:
        raise ValueError(f"row {bad[0]} is {out[bad[0]].tolist()}; all coordinates must be finite")
    return out


def index_array(value: Any, widths: tuple[int, ...], limit: int) -> NDArray[Any]:
    """A table of node numbers 0 ... ``limit`` - 1 as a contiguous int32 array whose row length is one of ``widths``; else ValueError."""
    array = _rectangular(value)
    if array.dtype.kind not in "iu":
        raise ValueError(f"holds {array.dtype}; whole numbers are needed")
    if array.ndim != 2 or array.shape[1] not in widths:
        raise ValueError(
            f"has shape {array.shape}; it must be (n, {' or '.join(map(str, widths))})"
        )
    bad = np.flatnonzero(((array < 0) | (array >= limit)).any(axis=1))
    if bad.size:
        raise ValueError(
            f"row {bad[0]} names a node outside 0 ... {limit - 1}: {array[bad[0]].tolist()}"
        )
    return np.ascontiguousarray(array, dtype=np.int32)


def _rectangular(value: Any) -> NDArray[Any]:
    if not isinstance(value, (np.ndarray, list, tuple)):
        raise ValueError(f"is {describe(value)}; it must be an array")
    if np.ma.is_masked(value):
        raise ValueError("has masked values; fill or leave them out")
    try:
        array = np.asarray(value)
    except (ValueError, TypeError, OverflowError) as error:
        raise ValueError(f"is no rectangular array ({error})") from None
    if array.size == 0:
        raise ValueError("is empty")
    rows = [row for row in value if isinstance(row, (list, tuple))] if array.ndim == 2 else []
    if any(isinstance(entry, bool) for row in rows for entry in row):
        raise ValueError("holds a boolean; numbers are needed")
    return array
