"""Whether the pictures of a chapter stand in the program of its name (docs/figures)."""

import ast
import csv
import io
import re
from pathlib import Path

import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"
FIGURES = DOCS / "figures"
PAGES = sorted(page for page in DOCS.rglob("*.rst") if "_build" not in page.parts)
DRAWN = {
    page: re.findall(r"^ *\.\. (?:drawn|moving):: (\S+) (\w+)", page.read_text(), re.M)
    for page in PAGES
}
OF_A_PART = {"week", "parts"}  # one program for the pages of Part I, one for the maps of all parts


@pytest.mark.parametrize(
    "page", [page for page in PAGES if DRAWN[page]], ids=lambda page: page.stem
)
def test_a_chapter_is_drawn_by_the_program_of_its_name(page):
    for place, name in DRAWN[page]:
        program = DOCS / place
        if program.parent == FIGURES and program.stem not in OF_A_PART:
            folder = page.stem == "index" and page.parent != DOCS
            chapter = page.parent.name if folder else page.stem
            assert program.stem == chapter, f"{page.name} draws {name} of {place}"
        tree = ast.parse(program.read_text())
        (function,) = (f for f in tree.body if getattr(f, "name", "") == name)
        assert len(function.args.args) == len(function.args.defaults), f"{name} needs arguments"


def test_every_program_is_drawn_and_short():
    used = {(DOCS / place).resolve() for drawn in DRAWN.values() for place, _ in drawn}
    for program in FIGURES.rglob("*.py"):
        assert len(program.read_text().splitlines()) <= 300, program.name
        if program.parent == FIGURES:
            assert program in used, f"no page draws {program.name}"


def test_the_data_of_a_picture():
    """What is drawn stands in the table once, without sketches and colour bars."""
    pytest.importorskip("matplotlib")
    import figuredata
    import numpy as np
    from matplotlib.figure import Figure

    figure = Figure()
    ax, image, sketch = figure.subplots(1, 3)
    ax.plot([0, 1], [2, 3.25], label="own")
    ax.bar([1], [4], width=2)
    figure.colorbar(image.imshow(np.arange(6.0).reshape(2, 3), extent=(0, 3, 0, 2), origin="lower"))
    sketch.plot([7, 7], [7, 7])
    sketch.set_axis_off()
    rows = list(csv.reader(io.StringIO(figuredata.table(figure))))
    assert rows[:3] == [
        ["panel", "curve", "x", "y", "value"],
        ["1", "own", "0", "2", ""],
        ["1", "own", "1", "3.25", ""],
    ]
    assert {(x, y) for _, name, x, y, _ in rows if name == "area 1"} == {
        ("0", "0"),
        ("2", "0"),
        ("2", "4"),
        ("0", "4"),
    }
    cells = [(float(x), float(y), float(v)) for _, name, x, y, v in rows if name == "image 1"]
    assert cells == [(c + 0.5, r + 0.5, 3 * r + c) for r in range(2) for c in range(3)]
    assert {row[0] for row in rows[1:]} == {"1", "2"}
    turned = figuredata.points(image.imshow(np.arange(6.0).reshape(2, 3)))  # row 0 on top, at y = 0
    assert turned.tolist() == [[c, r, 3 * r + c] for r in range(2) for c in range(3)]


def test_pictures_of_tutorials_have_their_data(tmp_path):
    scrapers = pytest.importorskip("sphinx_gallery.scrapers")
    from figuredata import _get_sg_image_scraper
    from matplotlib import pyplot

    images = tmp_path / "tutorials" / "images"
    images.mkdir(parents=True)
    pyplot.close("all")  # of other tests
    for values in ([1, 2], [3, 4.5]):
        pyplot.figure().subplots().plot(values, label="own")
    where = scrapers.ImagePathIterator(str(images / "picture_{0:03}.png"))
    conf = {
        "src_dir": str(tmp_path),
        "image_srcset": [],
        "compress_images": (),
        "matplotlib_animations": (False, None),
    }
    text = _get_sg_image_scraper()(None, {"image_path_iterator": where}, conf)
    for number, last in ((1, "1,own,1,2,"), (2, "1,own,1,4.5,")):
        name = f"tutorials/images/picture_00{number}.csv"
        assert f"<{'/' + name}>" in text
        assert (tmp_path / name).read_text().splitlines()[-1] == last
    assert pyplot.get_fignums() == []


MOVING = re.findall(
    r"^\.\. drawn:: (\S+) .*\n(?:   .*\n)*?   :animation: (\w+)$",
    "".join(page.read_text() for page in PAGES),
    re.M,
)


@pytest.mark.parametrize("place, name", MOVING)
def test_an_animation_is_small_and_moves(place, name):
    pytest.importorskip("libcontact")
    pytest.importorskip("sphinx")
    pytest.importorskip("matplotlib")
    import drawn

    made = drawn.call(DOCS / place, name)
    text = drawn.animation(made, name, "alt")
    assert len(text) < 150_000 and 4 <= made[1] <= 8
    values = re.findall(r'<animate attributeName="d" [^>]*values="([^"]*)"', text)
    assert len(values) == len(made[2])
    for frames in (value.split(";") for value in values):
        assert len(frames) >= 40 and len(set(frames)) >= 20
        assert len({frame.count("L") for frame in frames}) == 1  # else a browser shows steps


def test_two_pictures_move():
    assert len(MOVING) == 2


@pytest.mark.parametrize("name", ["method", "laws", "fast"])
def test_no_arrow_of_a_map_runs_through_a_box(name):
    """In pixels, as they are drawn: an arrow may touch the boxes at its ends only."""
    from drawn import call
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.text import Annotation

    figure = call(FIGURES / "parts.py", name)
    FigureCanvasAgg(figure).draw()
    (ax,) = figure.axes
    arrows = [text.arrow_patch for text in ax.texts if isinstance(text, Annotation)]
    boxes = [patch.get_window_extent() for text in ax.texts if (patch := text.get_bbox_patch())]
    assert len(boxes) > 2
    for arrow in arrows:
        line = arrow.get_path().interpolated(20).vertices
        points = arrow.get_transform().transform(line)
        for box in boxes:
            assert not ((points > box.min + 2) & (points < box.max - 2)).all(axis=1).any()
