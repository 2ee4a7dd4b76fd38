"""The counts of the book, on two small pages."""

import count_book

FIRST = """
Five words, and no more :eq:`two`
=================================

.. math::
   :label: one
   :class: definition

   a = b

.. math::
   :label: known

   c = d

.. math::
   :label: unknown

   e = f

.. drawn:: figures/x.py y
   :alt: not counted

   a caption

See :doc:`second`, :doc:`first`.

.. admonition:: Later

   Not ahead: :doc:`second`

.. include:: /exercises/first.rst

.. weave:: libcontact/src/a.c square
.. weave:: libcontact/src/a.c "Not there"
"""

EXERCISES = """
Exercises
---------

.. exercise:: first-one
   :kind: hand
   :grade: 1
   :minutes: 10

   Words of an exercise.

   .. answer::

      Two.

.. exercise:: first-two
   :kind: error
   :grade: 2
   :minutes: 15

   Which?

   .. answer::

      None.
"""


def test_counts_of_a_page(tmp_path):
    asked = tmp_path / "docs" / "exercises"
    asked.mkdir(parents=True)
    (asked / "first.rst").write_text(EXERCISES)
    (asked / "answers_first.py").write_text("def test_first_two():\n    pass\n")
    theory, source = tmp_path / "docs" / "theory", tmp_path / "libcontact" / "src"
    theory.mkdir(parents=True), source.mkdir(parents=True)
    toc = ".. toctree::\n   :hidden:\n\n"
    (tmp_path / "docs" / "index.rst").write_text(toc + "   theory/first\n   Two <theory/second>\n")
    (theory / "first.rst").write_text(FIRST)
    (theory / "second.rst").write_text(".. math::\n   :label: two\n\n   g = h\n\n:doc:`first`\n")
    (source / "a.c").write_text("int square(int x)\n{\n  return x * x; /* (eq:known) */\n}\n")
    counts = count_book.measure(tmp_path)
    assert list(counts) == ["theory/first", "theory/second"]
    assert counts["theory/first"] == {
        "words": 6 + 2 + 3,
        "figures": 1,
        "computed": 1,
        "definition": 1,
        "step": 0,
        "open": 1,
        "listings": 2,
        "own line": 1,
        "forward": 2,
        "hand": 1,
        "program": 0,
        "error": 1,
        "tested": 1,
        "minutes": 25,
    }
    assert counts["theory/second"]["open"] == 1 and counts["theory/second"]["forward"] == 0
