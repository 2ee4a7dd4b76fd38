"""Pictures that are drawn when the book is built: ``.. drawn:: figures/contact.py wedge``.

The file, named from the folder of the book, has a function of that name, without arguments, that returns a matplotlib
figure. The text under the directive is the caption, the option ``:alt:`` says what is seen. A book that is built
without the package says so in place of the picture. The program of a chapter has the name of the chapter; what several
of them need lies in ``figures/shared``.

``.. moving::`` is the same for a function that returns pictures of Pillow and the milliseconds of each. On paper, and
for readers who want no motion, the last one stands alone. The page holds them itself.
"""

from __future__ import annotations

import base64
import io
import re
import runpy
import sys
from pathlib import Path
from typing import Any

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
    drawing = re.sub(width, r'style="width:100%;max-width:\1pt"', drawing, count=1)
    return drawing[drawing.index("<svg") :]


def webp(pictures: list[Any], **options: Any) -> str:
    """Pictures as the address of an image that needs no file."""
    data = io.BytesIO()
    pictures[0].save(data, "WEBP", append_images=pictures[1:], quality=80, **options)
    return f"data:image/webp;base64,{base64.b64encode(data.getvalue()).decode()}"


def movie(path: Path, name: str, alt: str) -> str:
    """What the function draws, as an element that shows the pictures one after the other, again and again."""
    pictures, times = runpy.run_path(str(path))[name]()
    width, height = pictures[0].size
    return (
        f'<picture><source media="print, (prefers-reduced-motion: reduce)" srcset="{webp(pictures[-1:])}">'
        f'<img width="{width}" height="{height}" alt="{alt}" src="{webp(pictures, save_all=True, duration=times, loop=0)}">'
        "</picture>"
    )


class Drawn(SphinxDirective):
    draw = staticmethod(svg)
    required_arguments = 2
    has_content = True
    option_spec = {"alt": lambda text: " ".join(directives.unchanged_required(text).split())}

    def run(self) -> list[nodes.Node]:
        path = Path(self.env.srcdir) / self.arguments[0]
        for program in (path, STYLE, *sorted((FIGURES / "shared").glob("*.py"))):
            self.env.note_dependency(str(program))
        caption = self.parse_content_to_nodes()
        try:
            text = self.draw(path, self.arguments[1], self.options["alt"])
            import libcontact._core
        except ImportError as error:
            return self.parse_text_to_nodes(
                f"(This book was built without the Python package, so a picture is missing here: {error}.)\n"
            )
        self.env.note_dependency(libcontact._core.__file__)
        picture = nodes.figure("", nodes.raw("", text, format="html"))
        picture += nodes.caption("", "", *caption[0].children)
        return [picture]


class Moving(Drawn):
    draw = staticmethod(movie)


def setup(app):
    app.add_directive("drawn", Drawn)
    app.add_directive("moving", Moving)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
