"""What the tests of the answers share.

A test has the name of its exercise: ``test_wall_depth`` computes the answer of ``wall-depth`` in another way than the
page derives it, and hands its numbers to ``says``, as the page prints them. The programs of the exercises of the kind
"error" are run by ``run``, as they are handed out and as the answer mends them.
"""

import contextlib
import importlib.util
import io
import re
import sys
from pathlib import Path

import pagesource
import pytest

HERE = Path(__file__).parent
DOCS = HERE.parent

# The programs of Part I as week_wall, ...: others have a plates.py, too.
for name in ("wall", "bar", "plates"):
    spec = importlib.util.spec_from_file_location(f"week_{name}", DOCS / "week" / f"{name}.py")
    sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(sys.modules[spec.name])

EXERCISES = {
    one.label: one
    for page in HERE.glob("*.rst")
    for one in pagesource.exercises(page.read_text(encoding="utf-8"))
}
CHAPTERS = {
    label.label: page.read_text(encoding="utf-8").partition(".. include:: /exercises/")[0]
    for page in [
        *DOCS.glob("week/*.rst"),
        *DOCS.glob("theory/*.rst"),
        *DOCS.glob("stability/*.rst"),
        DOCS / "start" / "prerequisites.rst",
    ]
    for file in pagesource.included(DOCS, page.read_text(encoding="utf-8"))
    for label in pagesource.exercises(file.read_text(encoding="utf-8"))
}


def occurs(number: str, text: str) -> bool:
    """Whether a text has the number or word, not as a part of a longer one."""
    text = " ".join(text.replace("\N{MINUS SIGN}", "-").split())
    return re.search(rf"(?<![\w.]){re.escape(number)}(?![\w])(?!\.\d)", text) is not None


def telling(number: str) -> bool:
    """Whether a number has three digits that count, so that it can't stand somewhere by chance."""
    return len(re.sub(r"\D", "", number).lstrip("0")) >= 3 and "/" not in number


@pytest.fixture
def asked(request):
    """The exercise of a test."""
    label = request.node.originalname.removeprefix("test_").replace("_", "-")
    return EXERCISES[label]


@pytest.fixture
def says(asked):
    """Assert that the answer has these numbers, and that the chapter does not have them before it. What the chapter
    gives on purpose is ``given``."""

    def check(*numbers, given=()):
        assert numbers or given
        missing = [number for number in (*numbers, *given) if not occurs(number, asked.answer)]
        assert missing == [], f"the answer of {asked.label} does not say {missing}"
        before = CHAPTERS[asked.label] + asked.question
        early = [number for number in numbers if telling(number) and occurs(number, before)]
        assert early == [], f"{early} of {asked.label} stands before the answer"

    return check


def mended(text: str, answer: str) -> str:
    """The program with the lines that the answer takes away and those that it adds: its ``code-block:: diff``."""
    lines = re.search(r"code-block:: diff\n\n((?: +.*\n|\n)+)", answer)[1]
    signed = [line.strip("\n")[3:] for line in lines.splitlines() if line.strip()]
    wrong, right = (
        "".join(f"{line[1:].rstrip()}\n" for line in signed if line[0] in (" ", sign))
        for sign in "-+"
    )
    assert text.count(wrong) == 1, f"the program has this {text.count(wrong)} times:\n{wrong}"
    return text.replace(wrong, right)


@pytest.fixture
def run(asked):
    """The names and the output of the exercise's program, as it is handed out or mended."""

    def execute(mend=False):
        path = HERE / "programs" / f"{asked.label}.py"
        text = path.read_text(encoding="utf-8")
        if mend:
            text = mended(text, asked.answer)
        names = {"__name__": "__main__", "__file__": str(path)}
        with contextlib.redirect_stdout(io.StringIO()) as told:
            exec(compile(text, str(path), "exec"), names)
        return names, told.getvalue()

    return execute
