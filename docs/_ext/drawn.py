"""Pictures that are drawn when the book is built: ``.. drawn:: figures/contact.py wedge``.

The file, named from the folder of the book, has a function of that name, without arguments, that returns a matplotlib
figure. The text under the directive is the caption, the option ``:alt:`` says what is seen. A book that is built
without the package says so in place of the picture. The program of a chapter has the name of the chapter; what several
of them need lies in ``figures/shared``.
"""

from __future__ import annotations

import io
import re
import runpy
import sys
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.util.docutils import SphinxDirective

FIGURES = Path(__file__).resolve().parents[1] / "figures"
STYLE = FIGURES / "book.mplstyle"
sys.path.append(str(FIGURES))  # for ``from shared.drawing import BLUE``


def svg(path: Path, name: str, alt: str) -> str:
    """What the function draws, as an SVG element that can stand in a page: the same bytes in every build, black in the
    colour of the page's text, #fefefe in that of the page."""
    import matplotlib
    from matplotlib import style

    with (
        style.context(STYLE),
        matplotlib.rc_context({"svg.hashsalt": name, "svg.fonttype": "none"}),
    ):
        figure = runpy.run_path(str(path))[name]()
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None}, bbox_inches="tight")
    drawing = text.getvalue()
    drawing = drawing.replace("#000000", "currentColor")
    drawing = drawing.replace(' target="_blank"', "")
    drawing = drawing.replace("#fefefe", "var(--color-background-primary, #ffffff)")
    drawing = re.sub(
        r"<svg ", f'<svg fill="currentColor" role="img" aria-label="{alt}" ', drawing, count=1
    )
    # As wide as it was drawn, or as the page if that is narrower; the height follows.
    width = r'width="([\d.]+)pt" height="[\d.]+pt"'
    return re.sub(width, r'style="width:100%;max-width:\1pt"', drawing, count=1)


class Drawn(SphinxDirective):
    required_arguments = 2
    has_content = True
    option_spec = {"alt": lambda text: " ".join(directives.unchanged_required(text).split())}

    def run(self) -> list[nodes.Node]:
        path = Path(self.env.srcdir) / self.arguments[0]
        for program in (path, STYLE, *sorted((FIGURES / "shared").glob("*.py"))):
            self.env.note_dependency(str(program))
        caption = self.parse_content_to_nodes()
        try:
            text = svg(path, self.arguments[1], self.options["alt"])
            import libcontact._core
        except ImportError as error:
            return self.parse_text_to_nodes(
                f"(This book was built without the Python package, so a picture is missing here: {error}.)\n"
            )
        self.env.note_dependency(libcontact._core.__file__)
        text = text[text.index("<svg") :]
        picture = nodes.figure("", nodes.raw("", text, format="html"))
        picture += nodes.caption("", "", *caption[0].children)
        return [picture]


def setup(app):
    app.add_directive("drawn", Drawn)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
