"""Six sabotages of a small book with its sources and tests: each fails the build or a test. And what the table of
equations shows."""

import re
import shutil
import subprocess
import sys
from html import unescape
from pathlib import Path

import books
import pytest
from tracing import PythonSource, Source, statement

pytest.importorskip("sphinx", reason="Sphinx is not installed")

HERE = Path(__file__).resolve().parent

BOOK = {
    "docs/conf.py": "extensions = ['weave', 'tracepage']\nhtml_theme = 'basic'\n",
    "docs/index.rst": "Book\n====\n\n.. toctree::\n\n   spring\n   mass\n   words\n   trace\n",
    "docs/trace.rst": "Trace\n=====\n\n.. trace::\n",
    "docs/spring.rst": r"""
Spring
======

.. math::
   :label: spring-strain
   :class: definition

   e = u / l

.. math::
   :label: spring-force

   f = k e

.. weave:: libcontact/src/spring.c force

.. math::
   :label: spring-energy

   \Pi = \tfrac12 k u^2

.. weave:: libcontact/src/spring.c "Half of the work of the last force"
""",
    "docs/mass.rst": r"""
Mass
====

.. math::
   :label: mass-start
   :class: step

   x_1 = x_0

.. math::
   :label: mass-fall

   x = x_0 - \tfrac12 g t^2

.. literalinclude:: mass.py
   :pyobject: fall
""",
    "docs/words.rst": "Words\n=====\n\n.. math::\n   :label: words\n   :class: definition\n\n   v = \\dot x\n",
    "docs/mass.py": "g = 9.81\n\n\ndef fall(x, t):\n    # (eq:mass-fall)\n    return x - 0.5 * g * t**2\n",
    "libcontact/src/spring.c": """\
double force(double k, double strain)
{
  double f = 0.0;
  f = k * strain; // (eq:spring-force)
  return f;
}

double energy(double k, double u)
{
  // -- Half of the work of the last force (eq:spring-energy)
  const double half = 0.5;
  return half * (k * u * u);
}
""",
    "tests/c/test_spring.c": "/* The force (eq:spring-force). */\nstatic void test_force(void)\n{\n}\n",
    "tests/docs/test_spring.py": '''\
import ctypes
import runpy

from executes import executes

mass = runpy.run_path("docs/mass.py")


@executes("spring-energy")
def test_energy():
    energy = ctypes.CDLL("./spring.so").energy
    energy.restype, energy.argtypes = ctypes.c_double, [ctypes.c_double] * 2
    assert energy(3.0, 2.0) == 6.0


def test_fall():
    """A second (eq:mass-fall)."""
    assert mass["fall"](0.0, 1.0) == -0.5 * 9.81
''',
}


@pytest.fixture
def build(tmp_path):
    """A function that writes the book with changes (file, old text, new text; no new text: no file), and builds it:
    status, messages, table."""

    def build(*changes):
        files = dict(BOOK)
        for name, old, new in changes:
            assert old in files[name]
            files[name] = None if new is None else files[name].replace(old, new)
        books.write(tmp_path, {k: text for k, text in files.items() if text is not None})
        options = ("-W", "--keep-going", "-n", "-q")
        done = books.build(tmp_path, *options, source="docs", out="html")
        page = tmp_path / "html/trace.html"
        html = page.read_text(encoding="utf-8") if page.exists() else ""
        return done.returncode, done.stderr, html

    return build


def test_whole_book_builds_with_a_row_for_each_computed_equation(build):
    status, messages, html = build()
    assert status == 0, messages
    rows = [
        [" ".join(unescape(re.sub(r"<[^>]*>", "", cell)).split()) for cell in cells]
        for cells in (
            re.findall(r"<td>(.*?)</td>", row, re.S)
            for row in re.findall("<tr.*?</tr>", html, re.S)
        )
        if cells
    ]
    assert ["Spring", "2", "1", "0", "2", "1"] in rows
    assert ["Words", "0", "1", "0", "0", "0"] in rows  # a chapter without computed equations
    assert ["all", "3", "2", "1", "3", "1"] in rows
    code, test = "libcontact/src/spring.c", "tests/docs/test_spring.py"
    found = {row[0]: row[1:] for row in rows if len(row) == 4}
    assert {name.split()[-1]: row for name, row in found.items()} == {
        "spring-force": [f"{code}:4 f = k * strain;", "tests/c/test_spring.c:1 test_force()", ""],
        "spring-energy": [
            f"{code}:12 return half * (k * u * u);",
            f"{test}:10 test_energy()",
            "yes",
        ],
        "mass-fall": ["docs/mass.py:6 return x - 0.5 * g * t**2", f"{test}:17 test_fall()", ""],
    }


SPRING, SOURCE = "docs/spring.rst", "libcontact/src/spring.c"
SABOTAGES = {
    "renamed label": (
        [(SPRING, "label: spring-force", "label: spring-pull")],
        [
            "no page defines the equation spring-force",
            "test_force() names the equation spring-force",
        ],
    ),
    "renamed heading": (
        [(SOURCE, "// -- Half of the work", "// -- A part of the work")],
        ['has no heading "Half of the work', "equation spring-energy has no line in a listing"],
    ),
    "equation without code": (
        [(SPRING, ".. weave:: libcontact/src/spring.c force\n", "")],
        ["spring.rst:11", "equation spring-force has no line in a listing on its page"],
    ),
    "code that forgets its equation": (
        [(SOURCE, " // (eq:spring-force)", "")],
        ["equation spring-force has no line in a listing on its page"],
    ),
    "program that forgets its equation": (
        [("docs/mass.py", "# (eq:mass-fall)", "# It falls")],
        ["equation mass-fall has no line in a listing on its page"],
    ),
    "test file that is not there": (
        [("tests/c/test_spring.c", "", None)],
        ["equation spring-force is named by no test", "[trace.test]"],
    ),
    "test that forgets its equation": (
        [("tests/docs/test_spring.py", '@executes("spring-energy")\n', "")],
        ["equation spring-energy is named by no test"],
    ),
    "class of another name": (
        [("docs/words.rst", ":class: definition", ":class: defintion")],
        ["equation words has the class defintion", "[trace.code]"],
    ),
}


@pytest.mark.parametrize("name", SABOTAGES)
def test_sabotage_fails_the_build(build, name):
    changes, expected = SABOTAGES[name]
    status, messages, _ = build(*changes)
    assert status != 0
    for text in expected:
        assert text in messages, messages


def run_tests(folder):
    """The tests of the small book, with its C compiled: how many passed and failed."""
    compile_it = ["cc", "-shared", "-fPIC", "-o", "spring.so", SOURCE]
    subprocess.run(compile_it, cwd=folder, check=True)
    shutil.copy(HERE / "executes.py", folder / "tests/docs")
    command = "-m pytest -q -p no:cacheprovider tests/docs/test_spring.py".split()
    done = subprocess.run([sys.executable, *command], cwd=folder, capture_output=True, text=True)
    return re.findall(r"\d+ (?:passed|failed|error)", done.stdout), done.stdout


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_flipped_sign_fails_the_test_of_its_row(tmp_path):
    def write(name, old="", new=""):
        books.write(tmp_path, {name: BOOK[name].replace(old, new)})

    books.write(tmp_path, BOOK)
    assert run_tests(tmp_path)[0] == ["2 passed"]
    write(SOURCE, "half * (k * u * u)", "-half * (k * u * u)")
    counted, text = run_tests(tmp_path)
    assert (
        counted == ["1 failed", "1 passed"]
        and "FAILED tests/docs/test_spring.py::test_energy" in text
    )
    write(SOURCE)
    write("docs/mass.py", "x - 0.5", "x + 0.5")
    counted, text = run_tests(tmp_path)
    assert (
        counted == ["1 failed", "1 passed"]
        and "FAILED tests/docs/test_spring.py::test_fall" in text
    )


def test_executed_label_that_no_page_defines_fails(tmp_path):
    old, new = ":label: spring-energy", ":label: spring-work"
    books.write(tmp_path, {name: text.replace(old, new) for name, text in BOOK.items()})
    counted, text = run_tests(tmp_path)
    assert counted[-1] == "1 error" and "no page defines the equations spring-energy" in text


# -- Which line is meant


@pytest.mark.parametrize(
    "code, expected",
    [
        ("  a = b; // (eq:x)", "a = b;"),
        ("  // (eq:x)\n  for (int i = 0; i < 3; i++) {\n    s += a[i];\n  }", "s += a[i];"),
        (
            "  // -- Sum (eq:x)\n  double s = 0.0;\n\n  t = a->b;\n  s = a * (b +\n    c);",
            "s = a * (b + c);",
        ),
        ("  // -- One (eq:x)\n  t = u;\n  // -- Two\n  s = a * b;", "t = u;"),
        ("  // (eq:x)\n  if (a < b) return;\n  c = a + b;", "if (a < b) return;"),
    ],
)
def test_line_of_a_comment(code, expected):
    source = Source("void f(double a)\n{\n" + code + "\n}\n")
    ((_, line, _),) = source.labels()
    first, last = statement(source, line, len(source.lines) - 1)
    text = source.code.splitlines()[first - 1 : last]
    assert " ".join(" ".join(text).split()) == expected


def test_comment_above_a_function_means_its_body():
    source = Source(
        "/* Work (eq:x). */\nstatic double work(int n,\n  double f)\n{\n  int i = n + 1;\n  return f * i;\n}\n"
    )
    assert statement(source, 1, 7) == (6, 6)


def test_labels_of_python_are_in_comments_and_docstrings_only():
    source = PythonSource(
        '"""eq:a"""\ntext = "eq:b"  # eq:c\n\n\nclass T:\n    """:eq:`d`"""\n\n    def f(self):\n        """One.\n\n        eq:e-f, and more.\n        """\n'
    )
    found = [("a", 1, False), ("c", 2, False), ("d", 6, True), ("e-f", 11, False)]
    assert sorted(source.labels()) == found
