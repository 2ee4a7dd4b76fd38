"""Maps of the parts of the book: its chapters, and which one needs which, as their own lists "You need" say."""

import functools
import itertools
import re
import textwrap
from pathlib import Path

import numpy as np
import parts
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREY

DOCS = Path(__file__).resolve().parents[1]

COLUMNS = 5


def title(page):
    """The title of a chapter, in lines that fit a box."""
    text = (DOCS / f"{page}.rst").read_text()
    return textwrap.wrap(re.search(r"^(.+)\n([=])\2+$", text, re.M)[1], 17)


def arrows(chapters):
    """For each chapter those of the part that it needs, without those that another one of them needs."""
    direct = {
        page: [n for n in parts.needs(DOCS / f"{page}.rst") if n in chapters] for page in chapters
    }

    def all_before(page):
        return set(direct[page]).union(*(all_before(need) for need in direct[page]))

    return {
        page: [n for n in found if not any(n in all_before(other) for other in found)]
        for page, found in direct.items()
    }


def groups(before):
    """Chapters that arrows connect, and a last group of those that none does."""
    group = {page: {page} for page in before}
    for page, found in before.items():
        for need in found:
            group[page] |= group[need]
            for member in group[page]:
                group[member] = group[page]
    joined = [g for i, g in enumerate(group.values()) if g not in list(group.values())[:i]]
    return [g for g in joined if len(g) > 1], [page for page in before if len(group[page]) == 1]


def places(before):
    """A box for each chapter: column and row. Chapters follow those that they need to the right or, in a long part,
    downwards."""
    level = {}
    for page in before:
        level[page] = max((level[need] + 1 for need in before[page]), default=0)
    for page in reversed(before):  # as late as those that need it allow: arrows become short
        after = [level[other] - 1 for other in before if page in before[other]]
        level[page] = min(after, default=level[page])
    connected, alone = groups(before)
    place, lines, row = {}, [], 0

    downwards = max(level.values()) >= COLUMNS
    left = rows = 0
    for group in connected:
        depths = range(max(level[page] for page in group) + 1)
        if downwards or left + len(depths) > COLUMNS:
            left, row, rows = 0, row + rows, 0
        for depth in depths:
            line = [page for page in before if page in group and level[page] == depth]
            lines.append(line)
            for i, page in enumerate(line):
                middle = 0.5 * (COLUMNS - len(line))
                place[page] = (middle + i, row + depth) if downwards else (left + depth, row + i)
            rows = max(rows, depth + 1 if downwards else len(line))
        left += len(depths)
    row += rows
    for i, page in enumerate(alone):
        place[page] = (i % COLUMNS, row + i // COLUMNS)
    return untangled(place, lines, before, downwards), downwards


@functools.cache
def half_size(page):
    """Half the width and height of a box, in columns and rows."""
    lines = title(page)
    width = 4.9 * max(map(len, lines)) + 8.0  # points; a column has 108, a row 68
    return width / 216, (10.2 * (len(lines) + 1) + 7.0) / 137


def boxes_hit(start, end, pages, place, bend=0.0):
    """Whether an arrow from each start to each end runs through each box; ``bend`` is its height over its length."""
    along = np.linspace(0.0, 1.0, 25)[:, None, None]
    way = end - start
    aside = np.stack([-way[:, 1], way[:, 0]], axis=1)
    points = start + along * way + 4 * along * (1 - along) * bend * aside
    centre, half = (np.array([one(page) for page in pages]) for one in (place.get, half_size))
    return (np.abs(points[:, :, None] - centre) < half + 0.03).all(axis=-1).any(axis=0)


def tangle(place, before):
    """Length of all arrows, and a fine for each box that an arrow runs through."""
    pages = list(place)
    centre = np.array([place[page] for page in pages])
    ends = [(pages.index(need), pages.index(page)) for page in before for need in before[page]]
    if not ends:
        return 0.0
    a, b = np.array(ends).T
    hit = boxes_hit(centre[a], centre[b], pages, place)
    hit[np.arange(len(a)), a] = hit[np.arange(len(b)), b] = False
    return np.hypot(*(centre[b] - centre[a]).T).sum() + 20.0 * hit.sum()


def bend_of(start, end, pages, place):
    """The smallest bend with which an arrow runs through no box of other pages."""
    bends = sorted(np.linspace(-0.4, 0.4, 81), key=abs)
    hits = [boxes_hit(start[None], end[None], pages, place, bend).sum() for bend in bends]
    return bends[int(np.argmin(hits))]


def untangled(place, lines, before, downwards):
    """The same boxes, each line of them moved to the places with the least tangle, given the others, down and up four
    times. A row may use all half columns."""
    for line in 4 * (lines + lines[::-1]):
        own = [place[page] for page in line]
        if downwards:
            halves = itertools.combinations(np.arange(0.0, COLUMNS - 0.5, 0.5), len(line))
            choices = [
                [(x, own[0][1]) for x in xs] for xs in halves if min(np.diff(xs), default=1) >= 1
            ]
        else:
            choices = [own]
        orders = itertools.chain(*map(itertools.permutations, choices))
        tried = [place | dict(zip(line, order)) for order in orders]
        if len(line) <= COLUMNS:
            place = min(tried, key=lambda one: tangle(one, before))
    return place


def chart(part):
    """Boxes with the numbers and titles of the chapters of a page; an arrow leads from a chapter to one that needs
    it."""
    book = parts.groups(DOCS)
    chapters = book[part]
    numbers = {
        page: i + 1 for i, page in enumerate(page for pages in book.values() for page in pages)
    }
    before = arrows(chapters)
    place, downwards = places(before)
    rows = 1 + max(row for _, row in place.values())
    figure = Figure(figsize=(7.5, 0.95 * rows))
    ax = figure.subplots()
    ax.set(xlim=(-0.5, COLUMNS - 0.5), ylim=(rows - 0.5, -0.5))
    ax.axis("off")
    for page, (x, y) in place.items():
        for need in before[page]:
            (a, b), axis = place[need], int(downwards)
            start, end = np.array([a, b], float), np.array([x, y], float)
            start[axis] += half_size(need)[axis]
            end[axis] -= half_size(page)[axis] + 0.02
            others = [one for one in place if one not in (page, need)]
            # The control point of the arc is twice as far away as the arc.
            arc = f"arc3,rad={2 * bend_of(start, end, others, place)}"
            line = {"arrowstyle": "->", "color": GREY, "lw": 1.0, "connectionstyle": arc}
            line |= {"shrinkA": 0, "shrinkB": 0}
            ax.annotate("", xy=end, xytext=start, arrowprops=line, zorder=1)
        label = "\n".join([f"{numbers[page]}", *title(page)])
        box = {"boxstyle": "round,pad=0.3", "fc": "#fefefe", "ec": BLUE}
        text = ax.text(x, y, label, ha="center", va="center", fontsize=8.4, bbox=box, zorder=2)
        folder = Path(part).parent
        text.set_url(
            f"{Path(page).name}.html" if Path(page).parent == folder else f"../{page}.html"
        )
    return figure


def week():
    return chart("week/index")


def method():
    return chart("theory/index")


def laws():
    return chart("theory/deeper_laws")


def effects():
    return chart("theory/deeper_effects")


def waves():
    return chart("theory/deeper_waves")


def certainty():
    return chart("theory/deeper_certainty")


def fast():
    return chart("theory/fast")
