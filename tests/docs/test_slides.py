"""Slides: what they show comes from the chapters, and each chapter of the courses has its lecture."""

import re
from pathlib import Path
from types import SimpleNamespace

import books
import course
import pytest

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"

CHAPTERS = course.chapters(course.table())


@pytest.mark.parametrize("chapter", CHAPTERS)
def test_a_lecture_has_what_it_needs(chapter):
    """A picture, a derivation, a line of code, a question to predict, a command that runs, an exercise; no equation of
    its own."""
    text = (DOCS / "slides" / f"{chapter}.rst").read_text()
    pulled = set(re.findall(r"^\.\. pull:: (\w+) ", text, re.M))
    assert pulled == {"equation", "picture", "listing", "exercise"}
    assert re.search(r"^Predict", text, re.M) and ".. math::" not in text
    commands = re.findall(r"^   \$ build/venv/bin/(?:python|libcontact run) (\S+)$", text, re.M)
    assert commands and all((ROOT / program).exists() for program in commands), commands
    assert 4 <= len(re.findall(r"^-{3,}$", text, re.M)) <= 10


def test_no_slides_without_chapter():
    own = {
        path.relative_to(DOCS / "slides").with_suffix("") for path in DOCS.glob("slides/*/*.rst")
    }
    assert {path.as_posix() for path in own} == set(CHAPTERS)


CHAPTER = """
First
=====

:Goal: find it

Who asks?

.. math::
   :label: sum

   a + b

.. literalinclude:: x.py
   :pyobject: add

Summary
-------

- It is found.

.. include:: /exercises/first.rst
"""
EXERCISE = """
Exercises
---------

.. exercise:: one
   :kind: hand
   :grade: 1
   :minutes: 10

   Why :eq:`sum`?

   .. answer::

      It is fortytwo.
"""
SLIDES = """
:orphan:

First
=====

A slide
-------

.. pull:: equation sum

Predict: who?
-------------

.. pull:: listing add

.. pull:: exercise one
"""
WEEKS = '[six]\ntitle = "Six"\nweeks = [{chapters = ["part/first"], exercises = ["one"]}]\n'


def build(book: Path, slides: str) -> SimpleNamespace:
    """A book of one chapter with slides, built in a process of its own, as directives stay registered."""
    pytest.importorskip("sphinx_design")
    files = {
        "conf.py": "extensions = ['exercises', 'slides']\nnumfig = math_numfig = True\n"
        "exclude_patterns = ['exercises/*']\n"
        "numfig_format = {'exercise': 'Exercise %s', 'code-block': 'Listing %s'}\n"
        f"templates_path = [{str(DOCS / '_templates')!r}]\n",
        "index.rst": "Book\n====\n\n.. toctree::\n   :numbered:\n\n   part/first\n",
        "part/first.rst": CHAPTER,
        "exercises/first.rst": EXERCISE,
        "part/x.py": "def add(a, b):\n    return a + b\n",
        "slides/part/first.rst": slides,
        "course.toml": WEEKS + WEEKS.replace("six", "twelve"),
    }
    books.write(book, files)
    return books.build(book, "-q")


def test_slides_show_what_the_chapter_has(tmp_path):
    done = build(tmp_path, SLIDES)
    assert (done.returncode, done.stderr) == (0, "")
    page = (tmp_path / "out" / "slides" / "part" / "first.html").read_text()
    slides = page.partition("<main>")[2].partition("</main>")[0].strip()
    shown = re.sub(r"<[^>]*>", "", slides)
    for text in (
        "First",
        "Who asks?",
        "Goal: find it",
        r"\[a + b\]",
        "return a + b",
        "It is found.",
    ):
        assert shown.count(text) == 1, text
    assert (
        '<a class="eqno reference external" href="../../part/first.html#equation-sum">(1.1)</a>'
        in page
    )
    assert "Exercise 1.1 · by hand" in shown and "fortytwo" not in page
    assert page.count("<section") == 4 and 'class="predict"' in page
    deck = (tmp_path / "out" / "slides" / "six" / "1.html").read_text()
    assert slides in deck
    assert 'href="../../part/first.html#one">Exercise 1.1</a>, 10 minutes' in deck


def test_what_the_chapter_does_not_have_fails(tmp_path):
    wrong = ("equation no", "listing no", "exercise sum")
    done = build(tmp_path, SLIDES + "".join(f"\n.. pull:: {one}\n" for one in wrong))
    for one in wrong:
        assert f"slides: part/first has 0 times the {one}" in done.stderr
