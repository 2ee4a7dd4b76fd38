"""Checked reading of the tables of a scene: every refusal names the file, the key and the reason."""

from __future__ import annotations

import difflib
import math
import os
import stat
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from .errors import Error

REQUIRED = object()


class SceneError(Error, ValueError):
    """A scene that can't be computed. ``file``, ``key`` (``body[1].material``, counted from 0) and ``reason`` say what is wrong."""

    def __init__(self, reason: str, key: str = "", file: str | None = None):
        self.file, self.key, self.reason = file, key, reason
        super().__init__(": ".join(part for part in (file or "scene", key, reason) if part))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.reason, self.key, self.file)


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


def suggestion(word: str, known: Iterable[str]) -> str:
    """``; did you mean "steel"?`` when a known name is near, else the list of all known names."""
    known = list(known)
    near = difflib.get_close_matches(str(word), known, n=1, cutoff=0.6)
    if near:
        return f'; did you mean "{near[0]}"?'
    return "; known: " + ", ".join(f'"{name}"' for name in known) if known else "; there is none"


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
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(
        value, (bool, np.bool_)
    )


class Table:
    """One table of a scene that is being read. Each getter checks and takes a key; ``done`` refuses those that are left."""

    def __init__(self, data: Any, key: str = "", file: str | None = None):
        self.key, self.file = key, file
        if not isinstance(data, dict):
            raise SceneError(f"is {describe(data)}; it must be a table", key, file)
        self.data = data
        self.asked: dict[str, None] = {}

    def path(self, key: str) -> str:
        return f"{self.key}.{key}" if self.key else key

    def error(self, key: str, reason: str) -> SceneError:
        return SceneError(reason, self.path(key) if key else self.key, self.file)

    def has(self, key: str) -> bool:
        self.asked[key] = None
        return key in self.data

    def get(self, key: str, default: Any = REQUIRED) -> Any:
        if self.has(key):
            if self.data[key] is None:
                raise self.error(key, "is None; leave the key out instead")
            return self.data[key]
        if default is REQUIRED:
            raise self.missing(key)
        return default

    def missing(self, key: str) -> SceneError:
        """The error for a key that is not there, with a guess at how it was misspelt."""
        near = difflib.get_close_matches(key, [str(k) for k in self.data], n=1, cutoff=0.75)
        return self.error(key, "is missing" + (f'; is "{near[0]}" meant to be it?' if near else ""))

    def done(self) -> None:
        """Refuse keys that nobody asked for."""
        for key in self.data:
            if key not in self.asked:
                raise self.error(str(key), "unknown key" + suggestion(key, self.asked))

    def table(self, key: str, default: Any = REQUIRED) -> Table | None:
        value = self.get(key, default)
        return (
            None if value is None and default is None else Table(value, self.path(key), self.file)
        )

    def tables(self, key: str) -> list[Table]:
        """An array of tables, ``[[key]]``; none is an empty list."""
        value = self.get(key, [])
        if not isinstance(value, (list, tuple)):
            raise self.error(
                key, f"is {describe(value)}; it must be an array of tables, written [[{key}]]"
            )
        return [Table(item, f"{self.path(key)}[{i}]", self.file) for i, item in enumerate(value)]

    def text(self, key: str, default: Any = REQUIRED) -> Any:
        value = self.get(key, default)
        if value is default and default is not REQUIRED:
            return value
        if not isinstance(value, str):
            raise self.error(key, f"is {describe(value)}; it must be a text")
        try:
            value.encode()
        except UnicodeEncodeError:
            raise self.error(key, f"{value!a} is no Unicode text") from None
        return str(value)

    def name(self, key: str) -> str:
        """A text that can name something: printable, 1 to 63 bytes (the C library keeps 64)."""
        value = self.text(key)
        if not value or not value.isprintable() or value != value.strip():
            raise self.error(
                key, f"{value!r} is no name; use printable characters without blanks at the ends"
            )
        if len(value.encode()) > 63:
            raise self.error(key, f"is {len(value.encode())} bytes long; at most 63 are kept")
        return value

    def choice(self, key: str, known: Iterable[str], default: Any = REQUIRED) -> Any:
        value = self.text(key, default)
        known = list(known)
        if value is not default and value not in known:
            raise self.error(key, f'"{value}" is unknown' + suggestion(value, known))
        return value

    def number(
        self,
        key: str,
        default: Any = REQUIRED,
        *,
        above: float | None = None,
        least: float | None = None,
    ) -> Any:
        value = self.get(key, default)
        if value is default and default is not REQUIRED:
            return value
        return self.checked_number(value, key, above, least)

    def checked_number(
        self, value: Any, key: str, above: float | None = None, least: float | None = None
    ) -> float:
        if not is_number(value):
            raise self.error(key, f"is {describe(value)}; it must be a number")
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            raise self.error(key, f"is {describe(value)}; it must be a finite number")
        if above is not None and not number > above:
            raise self.error(key, f"is {number:g}; it must be above {above:g}")
        if least is not None and not number >= least:
            raise self.error(key, f"is {number:g}; it must be at least {least:g}")
        return number

    def integer(
        self, key: str, default: Any = REQUIRED, *, least: int = 1, most: int = 2**31 - 1
    ) -> Any:
        value = self.get(key, default)
        if value is default and default is not REQUIRED:
            return value
        return self.checked_integer(value, key, least, most)

    def checked_integer(self, value: Any, key: str, least: int, most: int) -> int:
        if not isinstance(value, (int, np.integer)) or isinstance(value, (bool, np.bool_)):
            raise self.error(key, f"is {describe(value)}; it must be a whole number")
        if not least <= value <= most:
            raise self.error(key, f"is {describe(value)}; it must be from {least} to {most}")
        return int(value)

    def items(self, key: str, count: int | None = None, default: Any = REQUIRED) -> Any:
        """A list, of ``count`` entries if a count is given."""
        value = self.get(key, default)
        if value is default and default is not REQUIRED:
            return value
        if isinstance(value, np.ndarray) and value.ndim == 1:
            value = list(value)
        if not isinstance(value, (list, tuple)):
            raise self.error(key, f"is {describe(value)}; it must be a list")
        if count is not None and len(value) != count:
            raise self.error(key, f"has {len(value)} entries; it must have {count}")
        return list(value)

    def vector(self, key: str, default: Any = REQUIRED, *, above: float | None = None) -> Any:
        """Three numbers, x, y, z."""
        value = self.items(key, 3, default)
        if value is default and default is not REQUIRED:
            return value
        return tuple(
            self.checked_number(item, f"{key}[{i}]", above) for i, item in enumerate(value)
        )

    def one_of(self, *keys: str, required: bool = True) -> str | None:
        """The one key of several alternatives that is there."""
        there = [key for key in keys if self.has(key)]
        listed = ", ".join(f'"{key}"' for key in keys)
        if len(there) > 1:
            raise self.error(
                there[1], f'cannot stand beside "{there[0]}"; give exactly one of {listed}'
            )
        if not there and required:
            raise self.error("", f"gives none of {listed}; exactly one is needed")
        return there[0] if there else None


def float_array(value: Any, width: int) -> np.ndarray:
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


def index_array(value: Any, widths: tuple[int, ...], limit: int) -> np.ndarray:
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


def _rectangular(value: Any) -> np.ndarray:
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
    return array
