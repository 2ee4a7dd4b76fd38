"""Whether the pictures of a chapter stand in the program of its name (docs/figures)."""

import ast
import re
from pathlib import Path

import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"
FIGURES = DOCS / "figures"
PAGES = sorted(page for page in DOCS.rglob("*.rst") if "_build" not in page.parts)
DRAWN = {
    page: re.findall(r"^ *\.\. (?:drawn|moving):: (\S+) (\w+)", page.read_text(), re.M)
    for page in PAGES
}
OF_A_PART = {"week", "parts"}  # one program for the pages of Part I, one for the maps of all parts


@pytest.mark.parametrize(
    "page", [page for page in PAGES if DRAWN[page]], ids=lambda page: page.stem
)
def test_a_chapter_is_drawn_by_the_program_of_its_name(page):
    for place, name in DRAWN[page]:
        program = DOCS / place
        if program.parent == FIGURES and program.stem not in OF_A_PART:
            folder = page.stem == "index" and page.parent != DOCS
            chapter = page.parent.name if folder else page.stem
            assert program.stem == chapter, f"{page.name} draws {name} of {place}"
        tree = ast.parse(program.read_text())
        (function,) = (f for f in tree.body if getattr(f, "name", "") == name)
        assert len(function.args.args) == len(function.args.defaults), f"{name} needs arguments"


def test_every_program_is_drawn_and_short():
    used = {(DOCS / place).resolve() for drawn in DRAWN.values() for place, _ in drawn}
    for program in FIGURES.rglob("*.py"):
        assert len(program.read_text().splitlines()) <= 300, program.name
        if program.parent == FIGURES:
            assert program in used, f"no page draws {program.name}"
