"""Numbers that pages type: each is listed, and a new one fails the build."""

import tomllib
from pathlib import Path

import books
import pytest
from typed import check, typed

DOCS = Path(__file__).resolve().parents[2] / "docs"

TABLE = tomllib.loads((DOCS / "typed.toml").read_text())
PAGES = {
    path.relative_to(DOCS).with_suffix("").as_posix(): path.read_text()
    for path in DOCS.rglob("*.rst")
    if not {"tutorials", "exercises", "_code"} & set(path.parts)
}


def test_pages_type_what_the_list_has():
    wrong = [f"{name}: {one}" for name, text in PAGES.items() for one in check(name, text, TABLE)]
    assert wrong == [] and set(TABLE) <= set(PAGES)


PAGE = """
Page
====

A bar of 100 elements loses 3.5 % of its energy, :measured:`a.b:.1%` at half the step, and takes
1.8 times as long, and ends at .75 m, listing 1.2.3. See ``Delta = 5 %`` and v2.5.

.. math::

   x = 3 \\%

=====  =====
mesh   error
=====  =====
10     0.25
=====  =====

.. list-table::

   * - 20
     - 1.25 %

.. drawn:: figures/a.py b
   :alt: a curve

   The curve ends at 7 %.

How we know that it is right
----------------------------

Within 1 %.

Next
----

It grew by 2 %.
"""
FOUND = ["3.5 %", "1.8 times", ".75", "0.25", "1.25 %", "7 %", "2 %"]


def test_numbers_of_sentences_and_tables_are_found():
    assert typed(PAGE) == FOUND
    assert check("a", PAGE, {"a": FOUND}) == []
    assert check("a", PAGE, {"a": [*FOUND, "9 %"]}) == [
        'typed.toml lists "9 %", which is not there'
    ]
    assert check("a", PAGE, {}) == [f'"{one}" is typed' for one in FOUND]


def test_a_typed_result_fails_the_build(tmp_path):
    pytest.importorskip("sphinx")
    page = "Page\n====\n\nThe bar loses 5 % of 2 %.\n"
    conf, table = "extensions = ['typed']\n", 'index = ["2 %"]\n'
    books.write(tmp_path, {"conf.py": conf, "index.rst": page, "typed.toml": table})
    done = books.build(tmp_path, "-W", "-q", builder="text")
    assert done.returncode != 0 and 'typed: index: "5 %" is typed' in done.stderr
