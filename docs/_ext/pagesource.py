"""What the source of a page consists of: its directives, its prose, and the exercises that it includes."""

from __future__ import annotations

import re
import textwrap
from pathlib import Path
from typing import NamedTuple

DIRECTIVE = re.compile(r"^( *)\.\. ([\w:-]+)::(.*)$")


def blocks(text: str) -> list[tuple[str, str, str]]:
    """The directives of a page (name, argument, body), and its prose under the name ""; what is in a box stays
    prose."""
    found, prose, lines = [], [], text.splitlines()
    i = 0
    while i < len(lines):
        start = DIRECTIVE.match(lines[i])
        if not start:
            if not re.match(r"^ *\.\. ", lines[i]):
                prose.append(lines[i])
            i += 1
            continue
        indent, body = len(start[1]), []
        i += 1
        while i < len(lines) and (
            not lines[i].strip() or len(lines[i]) - len(lines[i].lstrip()) > indent
        ):
            body.append(lines[i])
            i += 1
        name, inside = start[2], "\n".join(body)
        found.append((name, start[3].strip(), inside))
        if name in ("admonition", "note", "list-table", "tip", "warning", "drawn", "figure"):
            shown = [line for line in body if not re.match(r"^ *:[\w-]+:", line)]
            for part in blocks("\n".join(shown)):
                if part[0]:
                    found.append(part)
                elif not (name == "admonition" and start[3].strip() == "Later"):
                    prose += part[2].splitlines()
    return [*found, ("", "", "\n".join(prose))]


class Exercise(NamedTuple):
    """An exercise, from its source."""

    label: str
    kind: str
    grade: int
    minutes: int
    question: str
    answer: str

    @property
    def test(self) -> str:
        """The name of the test of its answer."""
        return "test_" + self.label.replace("-", "_")


def exercises(text: str) -> list[Exercise]:
    """The exercises of a file of ``docs/exercises``."""
    found = []
    for name, label, body in blocks(text):
        if name == "exercise":
            options = dict(re.findall(r"^ *:(\w+): *(\S+)$", body, re.M))
            question, _, answer = textwrap.dedent(body).partition(".. answer::\n")
            found.append(
                Exercise(
                    label,
                    options.get("kind", ""),
                    int(options.get("grade", 0)),
                    int(options.get("minutes", 0)),
                    question,
                    textwrap.dedent(answer),
                )
            )
    return found


def included(docs: Path, text: str) -> list[Path]:
    """The files of exercises that a page includes."""
    return [
        docs / path for path in re.findall(r"^\.\. include:: /(exercises/\S+\.rst)$", text, re.M)
    ]


def words(prose: str) -> int:
    """Words of prose; a role is one, marks of headings and tables are none."""
    prose = re.sub(r":[\w:]+:`[^`]*`", "X", prose)
    return sum(1 for word in prose.split() if re.search(r"\w", word))
