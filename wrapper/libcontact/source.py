"""The text of a scene file: the line of each key, and values that replace those of the file."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from .older import tomllib
from .schema import SceneError, Source, listed

# A string, a comment, a bracket, the end of a line, or what is between them. Lines are sought in texts that tomllib has
# read.
PIECE = re.compile(
    r'"""(?:\\.|[^\\])*?"{3,5}|\'\'\'.*?\'{3,5}|"(?:\\.|[^"\\])*"|\'[^\']*\'|#[^\n]*|[\[\]{}\n]|[^"\'#\[\]{}\n]+',
    re.S,
)
KEY = re.compile(r'((?:"(?:\\.|[^"\\])*"|\'[^\']*\'|[^=\'"])+)=')
# A text on the command line that needs no quotes.
WORD = re.compile(r"[A-Za-z_][\w.-]*")


class Text(Source):
    """The name of a scene file, with its text."""

    text: str
    replaced: tuple[str, ...]

    def __new__(cls, name: str, text: str, replaced: tuple[str, ...] = ()) -> Text:
        self = super().__new__(cls, name)
        self.text, self.replaced = text, replaced
        return self

    def line(self, key: str) -> int | None:
        """The line of a key such as ``body[1].material``, or of the table that lacks it; None for a
        value that does not come from the file."""
        if any(re.match(re.escape(each) + r"(?![\w-])", key) for each in self.replaced):
            return None
        known = dict(places(self.text))
        outer = [key[: found.start()] for found in re.finditer(r"[.\[]", key)]
        # Where all tables of one name are meant, the line of the first one.
        names = [key, f"{key}[0]", *reversed(outer)]
        return next((known[name] for name in names if name in known), None)


def places(text: str) -> Iterator[tuple[str, int]]:
    """Keys and tables of a scene with their lines."""
    count: dict[str, int] = {}
    table = ""
    for line, statement in _statements(text):
        header = statement.startswith("[")
        names = statement if header else KEY.match(statement)[1] + "= 0"  # type: ignore[index]
        key, value = "" if header else table, tomllib.loads(names)
        while isinstance(value, dict) and value:
            ((name, value),) = value.items()
            key = f"{key}.{name}".strip(".")
            if isinstance(value, list):
                count[key], value = count.get(key, 0) + 1, value[0]
            if key in count:
                key = f"{key}[{count[key] - 1}]"
            if not header:
                yield key, line
        if header:
            table = key
            yield key, line


def _statements(text: str) -> Iterator[tuple[int, str]]:
    """Headers and keys with their values, and the lines on which they begin."""
    line, first, depth, held = 1, 1, 0, ""
    for piece in PIECE.findall(text + "\n"):
        depth += (piece in "[{") - (piece in "]}")
        if piece == "\n" and depth == 0:
            if held.strip():
                yield first, held.strip()
            held, first = "", line + 1
        elif not piece.startswith("#"):
            held += piece
        line += piece.count("\n")


def value_of(text: str) -> Any:
    """A value as in TOML; a word may stand without quotes."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        if WORD.fullmatch(text):
            return text
        raise


def set_values(data: dict[str, Any], changes: Mapping[str, Any], file: str) -> tuple[str, ...]:
    """Put values into the tables of a scene by keys such as ``time.end`` and ``contact.0.beta``, and
    return these keys as messages write them."""
    return tuple(_put(data, key, value, file) for key, value in changes.items())


def _put(data: dict[str, Any], key: str, value: Any, file: str) -> str:
    names = re.sub(r"\[(\d+)\]", r".\1", key).split(".")
    inner: Any = data
    for i, name in enumerate(names):
        at = _joined(names[:i])
        last = i == len(names) - 1
        if isinstance(inner, list):
            if not name.isdecimal() or int(name) >= len(inner):
                there = listed((f"{at}.{k}" for k in range(len(inner))), "and") if inner else "none"
                reason = f"{_joined(names[: i + 1])} does not exist; there is {there}"
                raise SceneError(reason, key, file)
            place: Any = int(name)
        elif isinstance(inner, dict) and name:
            place = name
            if not last and name not in inner:
                if names[i + 1].isdecimal():
                    raise SceneError(f"there is no [[{_joined(names[: i + 1])}]]", key, file)
                inner[name] = {}
        else:
            reason = f"{at} is not a table" if name else "is no key; write one such as time.end"
            raise SceneError(reason, key, file)
        if last:
            inner[place] = value
        else:
            inner = inner[place]
    return _joined(names)


def _joined(names: list[str]) -> str:
    """``contact[0].beta``."""
    return re.sub(r"\.(\d+)(?=\.|$)", r"[\1]", ".".join(names))
