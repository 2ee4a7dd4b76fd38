"""What each chapter of the book holds: ``python tools/count_book.py [REVISION] [PAGE]...``; without a revision, the
working tree.

Words are those of the prose: directives, listings, displayed formulas and their options don't count, a formula within a
line is one word. A figure is a ``drawn``, ``figure`` or ``image`` directive. A labelled equation is a definition or a
step if its class says so. Any other is computed if a listing of its own page names it (``eq:label``), and open if none
does. "Own line" counts the listings that name an equation of their page. A forward reference is a link to a chapter or
to an equation that comes later in the order of the contents, and does not stand in a box "Later"; pages of contents
have none.

Exercises are counted by their kind, with the minutes of all; "tested" are those whose answer has a test.
"""

from __future__ import annotations

import argparse
import io
import re
import subprocess
import sys
import tarfile
import tempfile
import textwrap
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "docs" / "_ext"))

from csource import Source, WeaveError  # noqa: E402

FOLDERS = ("week", "theory", "stability")  # whose pages are chapters
COLUMNS = (
    "words",
    "figures",
    "computed",
    "definition",
    "step",
    "open",
    "listings",
    "own line",
    "forward",
    "hand",
    "program",
    "error",
    "tested",
    "minutes",
)
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


def count_exercises(docs: Path, text: str) -> dict[str, int]:
    counts = dict.fromkeys(("hand", "program", "error", "tested", "minutes"), 0)
    for file in included(docs, text):
        answers = file.with_name(f"answers_{file.stem}.py")
        tests = answers.read_text() if answers.exists() else ""
        for one in exercises(file.read_text()):
            counts[one.kind] += 1
            counts["minutes"] += one.minutes
            counts["tested"] += f"def {one.test}(" in tests
    return counts


def words(prose: str) -> int:
    """Words of prose; a role is one, marks of headings and tables are none."""
    prose = re.sub(r":[\w:]+:`[^`]*`", "X", prose)
    return sum(1 for word in prose.split() if re.search(r"\w", word))


def order(docs: Path, page: str = "index") -> list[str]:
    """All pages in the order of the contents."""
    file = docs / f"{page}.rst"
    if not file.exists():
        return []
    pages = [page]
    for name, _, body in blocks(file.read_text()):
        if name != "toctree":
            continue
        for line in body.splitlines():
            entry = re.sub(r"^.*<(.*)>$", r"\1", line.strip())
            if entry and not entry.startswith(":"):
                below = (
                    entry.lstrip("/") if entry[0] == "/" else (Path(page).parent / entry).as_posix()
                )
                pages += order(docs, below)
    return pages


def listing(root: Path, page: Path, name: str, argument: str, body: str) -> str:
    """The text that a listing shows; empty if it can't be found."""
    try:
        if name == "weave":
            path, what = argument.split(maxsplit=1)
            source = Source((root / path).read_text())
            heading = re.fullmatch(r'"(.*)"', what)
            span = source.fragment(heading[1]) if heading else source.function(what)
            first = source.doc_start(span) if ":doc:" in body else span.first
            return "\n".join(source.lines[first - 1 : span.last])
        text = (page.parent / argument).read_text()
        part = re.search(r":pyobject: *(\S+)", body)
        if part:
            found = re.search(
                rf"^( *)(?:def|class) {part[1].split('.')[-1]}\b.*?(?=^\1\S|\Z)", text, re.M | re.S
            )
            return found[0] if found else ""
        return text
    except (OSError, WeaveError, ValueError):
        return ""


def labels(text: str) -> list[tuple[str, str]]:
    """Label and class of each labelled equation of a page."""
    found = []
    for name, _, body in blocks(text):
        label = re.search(r"^ *:label: *(\S+)", body, re.M) if name == "math" else None
        if label:
            kind = re.search(r"^ *:class: *(\S+)", body, re.M)
            found.append((label[1], kind[1] if kind else ""))
    return found


def measure(root: Path) -> dict[str, dict[str, int]]:
    docs = root / "docs"
    pages = list(dict.fromkeys(order(docs)))
    place = {page: i for i, page in enumerate(pages)}
    text = {page: (docs / f"{page}.rst").read_text() for page in pages}
    home = {label: page for page in pages for label, _ in labels(text[page])}
    counts = {}
    for page in (p for p in pages if p.split("/")[0] in FOLDERS):
        parts = blocks(text[page])
        prose = parts[-1][2]
        kinds = labels(text[page])
        shown = [
            listing(root, docs / f"{page}.rst", *part)
            for part in parts
            if part[0] in ("weave", "literalinclude")
        ]
        named = [set(re.findall(r"\beq:`?([\w-]+)", code)) for code in shown]
        own = {label for label, _ in kinds}
        computed = sum(not kind and any(label in n for n in named) for label, kind in kinds)
        ahead = 0
        for role, target in re.findall(r":(doc|eq):`(?:[^`<]*<)?([^`>]+)>?`", prose):
            if role == "eq":
                there = home.get(target, page)
            elif target[0] == "/":
                there = target.lstrip("/")
            else:
                there = (Path(page).parent / target).as_posix()
            chapter = there.split("/")[0] in FOLDERS
            ahead += chapter and not page.endswith("/index") and place.get(there, -1) > place[page]
        counts[page] = {
            "words": words(prose),
            "figures": sum(part[0] in ("drawn", "figure", "image") for part in parts),
            "computed": computed,
            "definition": sum(kind == "definition" for _, kind in kinds),
            "step": sum(kind == "step" for _, kind in kinds),
            "open": sum(not kind for _, kind in kinds) - computed,
            "listings": len(shown),
            "own line": sum(bool(n & own) for n in named),
            "forward": ahead,
            **count_exercises(docs, text[page]),
        }
    return counts


def measured(revision: str | None) -> dict[str, dict[str, int]]:
    """The counts of a revision, None: of the working tree."""
    if revision is None:
        return measure(ROOT)
    with tempfile.TemporaryDirectory() as folder:
        packed = subprocess.run(
            ["git", "archive", revision, "docs", "libcontact"],
            cwd=ROOT,
            capture_output=True,
            check=True,
        )
        tarfile.open(fileobj=io.BytesIO(packed.stdout)).extractall(folder, filter="data")
        return measure(Path(folder))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("revision", nargs="?", help="default: the working tree")
    parser.add_argument("page", nargs="*", help="only pages whose name contains one of these")
    given = parser.parse_args()
    counts = measured(None if given.revision in (None, "-") else given.revision)
    chosen = {
        page: row
        for page, row in counts.items()
        if not given.page or any(name in page for name in given.page)
    }
    print(f"{'':32}" + "".join(f"{name:>11}" for name in COLUMNS))
    for page, row in chosen.items():
        print(f"{page:32}" + "".join(f"{row[name]:11}" for name in COLUMNS))
    total = {name: sum(row[name] for row in chosen.values()) for name in COLUMNS}
    print(f"{'together':32}" + "".join(f"{total[name]:11}" for name in COLUMNS))


if __name__ == "__main__":
    main()
