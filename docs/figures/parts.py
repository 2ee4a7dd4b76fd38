"""Maps of the parts of the book: its chapters, and which one needs which, as their own lists "You need" say."""

import sys
import textwrap
from pathlib import Path

from matplotlib.figure import Figure

DOCS = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(DOCS / "_ext"))
from parts import needs, parts  # noqa: E402

COLUMNS = 5
WIDTH, HEIGHT = 1.0, 0.5  # of a box; boxes stand on a grid of 1.25 by 1


def title(page):
    """The title of a chapter up to its colon, in lines that fit a box."""
    text = (DOCS / f"{page}.rst").read_text()
    return textwrap.wrap(next(line for line in text.splitlines() if line[:1].isalnum()), 17)


def levels(chapters):
    """How many chapters of the part must be read one after the other before each of them."""
    level = {}
    for page in chapters:
        known = [level[need] for need in needs(DOCS / f"{page}.rst") if need in level]
        level[page] = max(known, default=-1) + 1
    return level


def places(chapters):
    """Rows from the top: a level has as many rows as it needs."""
    level = levels(chapters)
    place, row = {}, 0

    def above(page):
        found = [place[need][0] for need in needs(DOCS / f"{page}.rst") if need in place]
        return sum(found) / len(found) if found else 0.0

    for depth in range(max(level.values()) + 1):
        pages = [page for page in chapters if level[page] == depth]
        if depth:
            pages.sort(key=above)
        for start in range(0, len(pages), COLUMNS):
            line = pages[start : start + COLUMNS]
            for i, page in enumerate(line):
                place[page] = (1.25 * (i - 0.5 * (len(line) - 1)), -row)
            row += 1
    return place, row


def chart(part):
    """Boxes with the numbers and titles of the chapters of a part; an arrow leads from a chapter to one that needs it."""
    book = parts(DOCS)
    chapters = book[part]
    numbers = {
        page: i + 1 for i, page in enumerate(page for pages in book.values() for page in pages)
    }
    place, rows = places(chapters)
    figure = Figure(figsize=(7.5, 0.85 * rows))
    ax = figure.subplots()
    ax.set(xlim=(-3.05, 3.05), ylim=(0.5 - rows, 0.5))
    ax.axis("off")
    for page, (x, y) in place.items():
        for need in needs(DOCS / f"{page}.rst"):
            if need in place and place[need][1] > y:
                a, b = place[need]
                ends = {"xy": (x, y + HEIGHT / 2 + 0.1), "xytext": (a, b - HEIGHT / 2 - 0.1)}
                line = {"arrowstyle": "->", "color": "#8a8a8a", "lw": 1.0}
                ax.annotate("", **ends, arrowprops=line, zorder=1)
        label = "\n".join([f"{numbers[page]}", *title(page)])
        box = {"boxstyle": "round,pad=0.3", "fc": "#fefefe", "ec": "#3b8bd4"}
        text = ax.text(x, y, label, ha="center", va="center", fontsize=8, bbox=box, zorder=2)
        folder = Path(part).parent
        text.set_url(
            f"{Path(page).name}.html" if Path(page).parent == folder else f"../{page}.html"
        )
    return figure


def week():
    return chart("week/index")


def method():
    return chart("theory/index")


def deeper():
    return chart("theory/deeper")


def fast():
    return chart("theory/fast")
