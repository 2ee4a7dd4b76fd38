"""Exercises with folded answers.

::

    .. exercise:: wall-depth
       :kind: hand
       :grade: 1
       :minutes: 10

       How deep does the mass enter?

       .. answer::

          By :eq:`week-by-hand` ...

The kinds are ``hand``, ``program`` (with the library or a program of one's own) and ``error`` (find the error in
``exercises/programs``, a file with the name of the exercise); the grades 1 to 3. A chapter includes its file of
``exercises`` at its end. The test of an answer stands beside that file and has the name of the exercise; see
``exercises/conftest.py``. Tutorials have answers, too, which are folded in their notebooks. With ``-D student=1``
(``make docs STUDENT=1``) answers are not read at all, and the gallery reads a copy of the tutorials without them, so
they are in no file of the book.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.util.docutils import SphinxDirective
from sphinx_design.dropdown import DropdownDirective

KINDS = {"hand": "by hand", "program": "with a program", "error": "find the error"}


class exercise(nodes.General, nodes.Element):
    """Numbered like a figure: ``:numref:`wall-depth``` is a link."""


class Exercise(SphinxDirective):
    required_arguments = 1
    has_content = True
    option_spec = {
        "kind": lambda text: directives.choice(text, tuple(KINDS)),
        "grade": lambda text: directives.choice(text, ("1", "2", "3")),
        "minutes": directives.positive_int,
    }

    def run(self) -> list[nodes.Node]:
        if len(self.options) < len(self.option_spec):
            raise self.error("an exercise needs :kind:, :grade: and :minutes:")
        node = exercise("", *self.parse_content_to_nodes(), names=[self.arguments[0]])
        for listing in node.findall(nodes.literal_block):  # ":end-before:" leaves blank lines
            listing.rawsource = listing.astext().rstrip()
            listing[:] = [nodes.Text(listing.rawsource)]
        self.set_source_info(node)
        self.state.document.note_explicit_target(node)
        grade = int(self.options["grade"])
        node["about"] = " · ".join(
            (
                KINDS[self.options["kind"]],
                f"grade {grade} of 3",
                f"{self.options['minutes']} minutes",
            )
        )
        return [node]


class Answer(DropdownDirective):
    """A dropdown of sphinx-design; nothing in the students' book."""

    optional_arguments = 0

    def run(self) -> list[nodes.Node]:
        if self.config.student:
            return []
        self.arguments = ["Answer"]
        return super().run()


def visit(translator, node: exercise) -> None:
    translator.body.append(translator.starttag(node, "div", CLASS="exercise"))
    translator.body.append('<p class="exercise-title">')
    translator.add_fignumber(node)
    translator.body.append(f"{node['about']}</p>\n")


def depart(translator, node: exercise) -> None:
    translator.body.append("</div>\n")


# An answer in the text of a tutorial, with or without the "#" of its program.
ANSWER = re.compile(r"^(#?)( *)\.\. answer::\n\1\n((?:\1\2 +\S.*\n?|\1[ \t]*\n)+)", re.M)


def folded(text: str) -> str:
    """Text of a tutorial for a notebook, with its answers folded."""
    return ANSWER.sub(r"\2<details><summary>Answer</summary>\n\n\3\n\2</details>\n\n", text)


def without_answers(text: str) -> str:
    return ANSWER.sub("", text)


def fold_in_notebooks(app) -> None:
    """The gallery writes the notebooks of the tutorials from their texts, in which it knows no answers."""
    if "sphinx_gallery.gen_gallery" in app.extensions:
        from sphinx_gallery import notebook

        convert = getattr(notebook.rst2md, "plain", notebook.rst2md)

        def rst2md(text, *options):
            return convert(folded(text), *options)

        rst2md.plain = convert  # type: ignore[attr-defined]
        notebook.rst2md = rst2md


def copy_tutorials(app, config) -> None:
    """For students the gallery takes pages, notebooks and downloads from tutorials without answers."""
    if config.student and "sphinx_gallery.gen_gallery" in app.extensions:
        plain = Path(app.outdir).with_name(f"{Path(app.outdir).name}-tutorials")
        gallery = config.sphinx_gallery_conf
        shutil.rmtree(plain, ignore_errors=True)
        shutil.copytree(Path(app.srcdir, gallery["examples_dirs"]), plain)
        for program in plain.rglob("*.py"):
            text = program.read_text(encoding="utf-8")
            program.write_text(without_answers(text), encoding="utf-8")
        gallery["examples_dirs"] = str(plain)


def setup(app):
    app.setup_extension("sphinx_design")
    app.connect("config-inited", copy_tutorials, priority=1)
    app.connect("builder-inited", fold_in_notebooks, priority=100)
    app.add_config_value("student", False, "env", bool)
    app.add_enumerable_node(
        exercise, "exercise", title_getter=lambda node: node["about"], html=(visit, depart)
    )
    app.add_directive("exercise", Exercise)
    app.add_directive("answer", Answer)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
