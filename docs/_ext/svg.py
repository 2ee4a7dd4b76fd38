"""Pictures of matplotlib as elements of a page. Needs no Sphinx, as ``tools/build_page.py`` draws some, too."""

from __future__ import annotations

import io
import re
import runpy
import sys
from functools import cache
from pathlib import Path
from typing import Any

FIGURES = Path(__file__).resolve().parents[1] / "figures"
STYLE = FIGURES / "book.mplstyle"
# For ``from shared.drawing import BLUE``, and for the programs of chapters and benches that pictures are drawn of.
for folder in ("week", "theory", "benchmarks", "../bench", "figures"):
    sys.path.append(str((FIGURES.parent / folder).resolve()))


@cache
def program(path: Path) -> dict[str, Any]:
    """The names of a program, which a build runs once for all of its pictures."""
    return runpy.run_path(str(path))


def call(path: Path, name: str) -> Any:
    """What the function of a program returns, drawn in the style of the book."""
    from matplotlib import style

    with style.context(STYLE):
        return program(path)[name]()


def svg(figure: Any, name: str, alt: str, tight: bool = True) -> str:
    """The figure as an SVG element that can stand in a page: the same bytes in every build, black in the colour of the
    page's text, #fefefe in that of the page."""
    import matplotlib
    from matplotlib import style

    with (
        style.context(STYLE),
        matplotlib.rc_context({"svg.hashsalt": name, "svg.fonttype": "none"}),
    ):
        text = io.StringIO()
        box = "tight" if tight else None
        figure.savefig(text, format="svg", metadata={"Date": None}, bbox_inches=box)
    drawing = text.getvalue()
    drawing = drawing[drawing.index("<svg") :]
    drawing = drawing.replace("#000000", "currentColor")
    drawing = drawing.replace(' target="_blank"', "")
    drawing = drawing.replace("#fefefe", "var(--color-background-primary, #ffffff)")
    drawing = re.sub(
        r"<svg ", f'<svg fill="currentColor" role="img" aria-label="{alt}" ', drawing, count=1
    )
    # As wide as it was drawn, or as the page if that is narrower; the height follows.
    width = r'width="([\d.]+)pt" height="[\d.]+pt"'
    return re.sub(width, r'style="width:100%;max-width:\1pt"', drawing, count=1)
