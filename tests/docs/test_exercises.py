"""The exercises of the book: each has a test, and the students' book has no answer."""

import re
import zipfile
from pathlib import Path
from types import SimpleNamespace

import answers
import books
import pagesource
import pytest
from parts import parts

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
FOLDER = DOCS / "exercises"

FILES = sorted(FOLDER.glob("*.rst"))
BOOK = parts(DOCS)
COURSE = [*BOOK["week/index"], *BOOK["theory/index"], "theory/enforcement"]


@pytest.mark.parametrize("chapter", COURSE)
def test_each_chapter_of_the_course_has_four(chapter):
    files = pagesource.included(DOCS, (DOCS / f"{chapter}.rst").read_text())
    assert sum(len(pagesource.exercises(file.read_text())) for file in files) >= 4


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_each_answer_has_its_test(file):
    """And each test its exercise, each kind "error" its program and a diff that mends it."""
    exercises = pagesource.exercises(file.read_text())
    tests = file.with_name(f"answers_{file.stem}.py").read_text()
    assert [one.test for one in exercises] == re.findall(r"^def (test_\w+)\(", tests, re.M)
    for one in exercises:
        program = FOLDER / "programs" / f"{one.label}.py"
        assert one.kind in ("hand", "program", "error") and one.grade in (1, 2, 3)
        assert 5 <= one.minutes <= 240 and len(one.question.split()) > 5
        assert len(one.answer.split()) > 5
        assert (one.kind == "error") == program.exists()
        if program.exists():
            assert ".. code-block:: diff" in one.answer
            assert f"programs/{one.label}.py" in one.question


def test_each_file_belongs_to_one_chapter():
    included = [
        path for page in DOCS.rglob("*.rst") for path in pagesource.included(DOCS, page.read_text())
    ]
    labels = [one.label for file in FILES for one in pagesource.exercises(file.read_text())]
    assert sorted(included) == FILES and len(labels) == len(set(labels))
    programs = {program.stem for program in (FOLDER / "programs").glob("*.py")}
    assert programs <= set(labels)


def test_answers_of_tutorials_are_folded_in_notebooks():
    from exercises import folded, without_answers

    text = "1. How?\n\n   .. answer::\n\n      So,\n      and so.\n\n2. Why?\n\n   .. answer::\n\n      For this.\n"
    shown = folded(text)
    assert shown.count("<details><summary>Answer</summary>\n\n      So,\n      and so.") == 1
    assert shown.count("</details>") == 2 and ".. answer" not in shown and "2. Why?" in shown
    assert without_answers(text).split() == "1. How? 2. Why?".split()
    program = "".join(f"# {line}".rstrip() + "\n" for line in text.splitlines()) + "\nx = 1\n"
    assert without_answers(program) == "# 1. How?\n#\n# 2. Why?\n#\n\nx = 1\n"


PAGE = """
Book
====

See :numref:`one`.

.. include:: /exercises/x.rst
"""
EXERCISES = """
.. exercise:: one
   :kind: hand
   :grade: 1
   :minutes: 10

   Which number?

   .. answer::

      It is fortytwo, as each of :math:`n` readers knows by now.

.. exercise:: two
   :kind: program
   :grade: 3
   :minutes: 20

   And now?
"""
ANSWER = "It is fortytwo, as each of n readers knows by now."


def build(book: Path, page: str, *options: str) -> SimpleNamespace:
    """The book of one page."""
    pytest.importorskip("sphinx_design")
    conf = (
        "extensions = ['exercises']\nhtml_copy_source = False\nnumfig = True\n"
        "numfig_format = {'exercise': 'Exercise %s'}\nexclude_patterns = ['exercises/*']\n"
    )
    books.write(book, {"conf.py": conf, "index.rst": page, "exercises/x.rst": EXERCISES})
    return books.build(book, "-q", *options)


def test_students_get_no_answer(tmp_path):
    """In no file of their book."""
    for options, having in ((), {"index.html", "searchindex.js"}), (("-D", "student=1"), set()):
        done = build(tmp_path / f"book{len(having)}", PAGE, *options)
        assert (done.returncode, done.stderr) == (0, "")
        out = tmp_path / f"book{len(having)}" / "out"
        found = {
            path.relative_to(out).as_posix()
            for path in out.rglob("*")
            if path.is_file() and "fortytwo" in path.read_text(encoding="utf-8", errors="ignore")
        }
        page = (out / "index.html").read_text()
        assert found - {".doctrees/index.doctree", ".doctrees/environment.pickle"} == having
        assert bool(found) == bool(having)
        assert ("<details" in page) == bool(having)
        assert "Exercise 1 </span>by hand · grade 1 of 3 · 10 minutes" in page
        checked = answers.check(out, out.parent)
        assert checked == (["index.html: the answer of one"] if having else [])


def test_an_answer_is_found_in_every_kind_of_file(tmp_path):
    (tmp_path / "exercises").mkdir()
    (tmp_path / "exercises" / "x.rst").write_text(EXERCISES)
    out = tmp_path / "out"
    out.mkdir()
    (out / "a.html").write_text("<p>It is fortytwo, <em>as each</em> of \\(n\\) readers know</p>")
    (out / "b.ipynb").write_text(f'{{"source": ["{ANSWER[:20]}\\n{ANSWER[20:]}"]}}')
    (out / "c.txt").write_text("It is fortytwo, as you know.")  # a part that is too short
    with zipfile.ZipFile(out / "d.zip", "w") as packed:
        packed.writestr("own.py", f"# {ANSWER}")
    index = 'Search.setIndex({"terms": {"fortytwo": 0, "reader": 1, "other": 2}, "titleterms": {}})'
    (out / "searchindex.js").write_text(index)
    found = ["a.html", "b.ipynb", "d.zip/own.py"]
    checked = answers.check(out, tmp_path)
    assert checked == [f"{name}: the answer of one" for name in found]
    (out / "a.html").unlink()  # no page has the words any longer
    words = [line for line in answers.check(out, tmp_path) if line.startswith("searchindex.js")]
    assert [line.split("'")[1] for line in words] == ["fortytwo", "reader"]


def test_every_answer_has_words_of_its_own():
    own = set(answers.telling().values())
    asked = {one.label for file in FILES for one in pagesource.exercises(file.read_text())}
    assert own == asked | {path.stem for path in (DOCS.parent / "tutorials").glob("*.py")}


def test_an_exercise_without_its_grade_fails(tmp_path):
    done = build(tmp_path / "book", "Book\n====\n\n.. exercise:: x\n   :kind: hand\n\n   Why?\n")
    assert "needs :kind:, :grade: and :minutes:" in done.stderr
