"""Laboratories, in which a reader runs the library: ``.. laboratory:: bar``, with the caption as its content.

The scripts and the modules come from ``make page`` and are copied into the book. The picture that the function of this
name in ``laboratory/pictures.py`` draws stands in the place of a laboratory without JavaScript, on paper, and in a book
that was built without ``make page``; the option ``:alt:`` describes it.
"""

from __future__ import annotations

import shutil
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.util.docutils import SphinxDirective
from svg import call, svg

ROOT = Path(__file__).resolve().parents[2]
PICTURES = ROOT / "docs" / "laboratory" / "pictures.py"
TARGET = "_static/laboratory"
WITHOUT = "This book was built without the cross compiler, so the laboratory is a picture."


class Laboratory(SphinxDirective):
    required_arguments = 1
    has_content = True
    option_spec = {"alt": lambda text: " ".join(directives.unchanged_required(text).split())}

    def run(self) -> list[nodes.Node]:
        name, up = self.arguments[0], "../" * self.env.docname.count("/")
        self.env.note_dependency(str(PICTURES))
        self.env.metadata[self.env.docname]["laboratory"] = "yes"
        caption = self.parse_content_to_nodes()
        try:
            drawing = svg(call(PICTURES, name), f"laboratory-{name}", self.options["alt"])
        except ImportError as error:
            drawing = f"<p>(This book was built without the Python package: {error}.)</p>"
        here = built(self.config.laboratory_folder)
        address = f"{up}{TARGET}/{name}.html"
        more = f'<a href="{address}">This laboratory on a page of its own.</a>' if here else WITHOUT
        text = (
            f'<div class="laboratory" data-laboratory="{name}">'
            f'<div class="laboratory-fallback">{drawing}</div></div>'
        )
        figure = nodes.figure("", nodes.raw("", text, format="html"))
        figure += nodes.caption("", "", *caption[0].children)
        return [figure, nodes.raw("", f'<p class="laboratory-more">{more}</p>', format="html")]


def built(folder: str) -> bool:
    return (Path(folder) / "laboratory.js").exists()


def link(role, rawtext, text, lineno, inliner, options=None, content=None):
    """``:laboratory:`words <bar:law=penalty&beta=10>```: a laboratory with its state set."""
    words, _, place = " ".join(text.rstrip(">").split()).rpartition(" <")
    name = place.partition(":")[0]
    env = inliner.document.settings.env
    if not built(env.config.laboratory_folder):
        return [nodes.inline(rawtext, words)], []
    up = "../" * env.docname.count("/")
    address = f"{up}{TARGET}/{name}.html#{place}"
    return [nodes.reference(rawtext, words, refuri=address)], []


def copy(app) -> None:
    """Take what ``make page`` has built."""
    if app.builder.format != "html" or not built(app.config.laboratory_folder):
        return
    shutil.copytree(app.config.laboratory_folder, Path(app.outdir) / TARGET, dirs_exist_ok=True)


def add_scripts(app, page, template, context, tree) -> None:
    """Only pages with a laboratory load its scripts."""
    if "laboratory" in app.env.metadata.get(page, {}) and built(app.config.laboratory_folder):
        app.add_js_file("laboratory/laboratory.js", loading_method="defer")
        app.add_css_file("laboratory/laboratory.css")


def setup(app):
    app.add_config_value("laboratory_folder", str(ROOT / "build" / "page" / "html"), "env")
    app.add_directive("laboratory", Laboratory)
    app.add_role("laboratory", link)
    app.connect("builder-inited", copy)
    app.connect("html-page-context", add_scripts)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
