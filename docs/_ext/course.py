"""The courses of ``course.toml``: a mark under the heading of each section, tables of courses, the line of PDFs.

::

    .. syllabus:: six
    .. pdfs::

Words, equations and listings of a section are counted in its source (``pagesource.py``); the minutes of exercises are
their own.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any, NamedTuple

import pagesource

DOCS = Path(__file__).resolve().parents[1]

MARKS = ("course", "may be skipped", "for the curious")


class Section(NamedTuple):
    title: str
    words: int
    equations: int
    listings: int


class Week(NamedTuple):
    chapters: list[str]
    left_out: list[str]  # titles of sections
    words: int
    equations: int
    listings: int
    reading: float  # minutes
    exercises: dict[str, int]  # minutes of each

    @property
    def minutes(self) -> float:
        return self.reading + sum(self.exercises.values())


def table(docs: Path = DOCS) -> dict[str, Any]:
    return tomllib.loads((docs / "course.toml").read_text(encoding="utf-8"))


def mark(course: dict[str, Any], chapter: str, title: str) -> str:
    if title in course["skipped"].get(chapter, ()):
        return MARKS[1]
    if title in course["curious"].get(chapter, ()):
        return MARKS[2]
    return course["everywhere"].get(title, MARKS[0])


def chapters(course: dict[str, Any]) -> list[str]:
    """All chapters of the courses, in their order."""
    weeks = [*course["twelve"]["weeks"], *course["six"]["weeks"]]
    return list(dict.fromkeys(name for week in weeks for name in week["chapters"]))


def sections(text: str) -> list[Section]:
    """Of a page without its exercises; what stands before the first heading has no title."""
    text = text.partition(".. include:: /exercises/")[0]
    parts = re.split(r"^(?=\S.*\n-{3,}$)", text, flags=re.M)
    found = []
    for i, part in enumerate(parts):
        blocks = pagesource.blocks(part)
        found.append(
            Section(
                part.partition("\n")[0] if i else "",
                pagesource.words(blocks[-1][2]),
                sum(name == "math" for name, _, _ in blocks),
                sum(name in ("weave", "literalinclude") for name, _, _ in blocks),
            )
        )
    return found


def exercises(docs: Path, chapter: str) -> dict[str, int]:
    """Minutes of the exercises of a chapter."""
    page = (docs / f"{chapter}.rst").read_text(encoding="utf-8")
    files = pagesource.included(docs, page)
    asked = [one for file in files for one in pagesource.exercises(file.read_text())]
    return {one.label: one.minutes for one in asked}


def weeks(name: str, docs: Path = DOCS) -> list[Week]:
    """The weeks of a course: the short one has the sections of the mark "course" only."""
    course = table(docs)
    marks = MARKS[:1] if name == "six" else MARKS[:2]
    cost, found = course["reading"], []
    for week in course[name]["weeks"]:
        read, left = [], []
        minutes = {}
        for chapter in week["chapters"]:
            minutes |= exercises(docs, chapter)
            for one in sections((docs / f"{chapter}.rst").read_text(encoding="utf-8")):
                (read if mark(course, chapter, one.title) in marks else left).append(one)
        words, equations, listings = (sum(s[i] for s in read) for i in (1, 2, 3))
        reading = (
            words / cost["words_per_minute"]
            + equations * cost["equation"]
            + listings * cost["listing"]
        )
        chosen = {label: minutes[label] for label in week["exercises"]}
        titles = [s.title for s in left if s.title not in course["everywhere"]]
        found.append(Week(week["chapters"], titles, words, equations, listings, reading, chosen))
    return found


def syllabus(name: str) -> str:
    """The table of a course, a row per week."""
    head = "week, chapters, exercises, words, equations, listings, reading [min], exercises [min]"
    rows: list[list[Any]] = [head.split(", ")]
    for number, week in enumerate(weeks(name), 1):
        own = ", ".join(f":doc:`/{chapter}`" for chapter in week.chapters)
        asked = ", ".join(f":numref:`%s <{label}>`" for label in week.exercises)
        deck = f"{number} (`slides <../slides/{name}/{number}.html>`__)"
        cells = [deck, own, asked, week.words, week.equations, week.listings]
        rows.append([*cells, f"{week.reading:.0f}", sum(week.exercises.values())])
    lines = [f".. list-table:: {table()[name]['title']}", "   :header-rows: 1", ""]
    for row in rows:
        lines += [f"   {'  -' if i else '* -'} {cell}" for i, cell in enumerate(row)]
    return "\n".join(lines)


def reveal(folder: Path) -> None:
    """Show the links of the first page to the PDFs that lie beside it; the others stay hidden."""
    page = folder / "index.html"
    text = page.read_text(encoding="utf-8")
    for name in table()["pdfs"]:
        if (folder / name).exists():
            text = text.replace(f' hidden="{name}"', "").replace(' hidden="pdfs"', "")
    page.write_text(text, encoding="utf-8")


def setup(app):
    from docutils import nodes
    from sphinx.util.docutils import SphinxDirective

    class Syllabus(SphinxDirective):
        """``.. syllabus:: six``: a row per week."""

        required_arguments = 1

        def run(self) -> list[nodes.Node]:
            self.env.note_dependency(str(DOCS / "course.toml"))
            return self.parse_text_to_nodes(syllabus(self.arguments[0]))

    class Pdfs(SphinxDirective):
        """``.. pdfs::``: links to files that the build of the pages can't know yet."""

        def run(self) -> list[nodes.Node]:
            self.env.note_dependency(str(DOCS / "course.toml"))
            links = "".join(
                f'<span hidden="{name}"> · <a href="{name}">{title}</a></span>'
                for name, title in table()["pdfs"].items()
            )
            return [nodes.raw("", f'<p hidden="pdfs">As PDF{links}</p>', format="html")]

    def add_marks(app, doctree):
        course = table()
        if app.env.docname in chapters(course):
            app.env.note_dependency(str(DOCS / "course.toml"))
            for section in doctree[0].findall(nodes.section):
                if section.parent is doctree[0] and section[0].astext() != "Exercises":
                    text = mark(course, app.env.docname, section[0].astext())
                    section.insert(1, nodes.paragraph("", text, classes=["course-mark"]))

    def finish(app, problem):
        if app.builder.format == "html" and not problem:
            reveal(Path(app.outdir))

    app.add_directive("syllabus", Syllabus)
    app.add_directive("pdfs", Pdfs)
    app.connect("build-finished", finish)
    app.connect("doctree-read", add_marks)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
