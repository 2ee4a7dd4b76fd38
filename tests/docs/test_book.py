"""The book builds with warnings as errors, without running the tutorials (which have their own test), and needs no
network."""

import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

pytest.importorskip("sphinx")
ROOT = Path(__file__).resolve().parents[2]
import browser

# A compiler of C alone, as on a machine without g++.
C_ALONE = """#!/bin/sh
case " $* " in *" c++ "*) exit 1 ;; esac
exec {} "$@"
"""


@pytest.fixture(scope="module")
def book(tmp_path_factory):
    folder, tools = tmp_path_factory.mktemp("book"), tmp_path_factory.mktemp("tools")
    for name in ("gcc", "cc"):
        if found := shutil.which(name):
            (tools / name).write_text(C_ALONE.format(found))
            (tools / name).chmod(0o755)
    path = f"{tools}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "sphinx",
            "-W",
            "--keep-going",
            "-n",
            "-q",
            "-b",
            "html",
            "docs",
            str(folder),
        ],
        cwd=ROOT,
        capture_output=True,
        text=True,
        env={**os.environ, "LIBCONTACT_GALLERY": "0", "MPLBACKEND": "Agg", "PATH": path},
    )
    assert done.returncode == 0, done.stderr
    return folder


def test_every_public_function_has_an_entry(book):
    headers = (ROOT / "libcontact" / "include" / "libcontact").glob("*.h")
    names = {
        name
        for header in headers
        for name in re.findall(r"^CT_API [^;]*?\b(ct_\w+)\(", header.read_text(), re.M)
    }
    pages = "".join(path.read_text() for path in (book / "api").glob("*.html"))
    assert names and {name for name in names if f'id="c.{name}"' not in pages} == set()


def test_nothing_is_fetched_from_outside(book):
    for page in book.rglob("*.html"):
        assert not re.search(
            r'<(?:script|link|img)[^>]+(?:src|href)="(?:https?:)?//', page.read_text()
        ), page


def test_downloads_are_the_tutorials(book):
    """The gallery's downloads are the files that tests/python/test_tutorials.py runs alone in an empty folder."""
    for script in sorted((ROOT / "tutorials").glob("[0-9][0-9]_*.py")):
        found = list((book / "_downloads").rglob(script.name))
        assert len(found) == 1 and found[0].read_bytes() == script.read_bytes()
        with zipfile.ZipFile(next((book / "_downloads").rglob(f"{script.stem}.zip"))) as packed:
            assert packed.read(script.name) == script.read_bytes()


# Every page as a browser lays it out.

WIDTHS = {390: 844, 1400: 900}  # a telephone and a desktop: width and height in pixels
COURSE = ("week/", "theory/")  # pages that must be fully visible on a desktop

# `over`: numbers of equations that cut the visible part of their formula, or lie outside of the window. `lost`: what
# leaves the window and stands in no box that scrolls. `hidden`: formulas and listings of which a part must be scrolled
# to. `errors`: formulas that could not be set.
LOOK = """
() => {
  const width = document.documentElement.clientWidth, name = e => e.closest("[id]")?.id + " " + e.tagName;
  const cut = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 0.5 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 0.5;
  const over = [], lost = [], hidden = [];
  if (document.documentElement.scrollWidth > width + 1) lost.push("page");
  let numbered = 0;
  for (const block of document.querySelectorAll("div.math")) {
    const number = block.querySelector(":scope > .eqno"), box = block.querySelector("mjx-container");
    if (!number || !box) continue;
    numbered++;
    const range = document.createRange();
    range.selectNode(number.firstChild);
    const n = range.getBoundingClientRect(), f = box.querySelector("svg").getBoundingClientRect(), b = box.getBoundingClientRect();
    const scrolls = getComputedStyle(box).overflowX !== "visible";
    const seen = scrolls ? {left: Math.max(f.left, b.left), right: Math.min(f.right, b.right), top: f.top, bottom: f.bottom} : f;
    if (cut(n, seen) || n.left < 0 || n.right > width) over.push(block.id);
  }
  for (const box of document.querySelectorAll("div.math > mjx-container, div.highlight pre"))
    if (box.scrollWidth > box.clientWidth + 1) hidden.push(name(box));
  for (const e of document.querySelectorAll("article *")) {
    const r = e.getBoundingClientRect();
    if (r.width === 0 || r.right <= width + 1) continue;
    let box = e;
    while (box !== document.body && getComputedStyle(box).overflowX === "visible") box = box.parentElement;
    if (box === document.body) lost.push(name(e));
  }
  return {numbered, over, lost, hidden, errors: document.querySelectorAll("mjx-merror").length};
}
"""


@pytest.fixture(scope="module")
def looks(book):
    """Results of LOOK on each page, by width, and requests that left the machine; skipped without a browser."""
    pytest.importorskip("playwright", reason="no playwright (make build/venv/.browser)")
    own = browser.find()
    if own is None:
        pytest.skip("no browser on this machine")
    names = [path.relative_to(book).as_posix() for path in sorted(book.rglob("*.html"))]
    found = {width: {} for width in WIDTHS}
    with browser.reading(book, own) as reader:
        for name in (name for name in names if not name.startswith(("_code/", "slides/"))):
            page = reader.open(name)
            for width, height in WIDTHS.items():
                page.set_viewport_size({"width": width, "height": height})
                found[width][name] = page.evaluate(LOOK)
    return found, reader.outside


@pytest.mark.parametrize("what", ("over", "lost", "errors"))
@pytest.mark.parametrize("width", WIDTHS)
def test_pages_at_a_width(looks, width, what):
    pages = looks[0][width]
    assert sum(page["numbered"] for page in pages.values()) > 300
    assert {name: page[what] for name, page in pages.items() if page[what]} == {}


def test_nothing_of_the_course_is_hidden_on_a_desk(looks):
    pages = looks[0][1400]
    hidden = {name: page["hidden"] for name, page in pages.items() if page["hidden"]}
    assert {name: boxes for name, boxes in hidden.items() if name.startswith(COURSE)} == {}


# What a student would search for, and a chapter that must be among the first four results.
SEARCHES = {
    "stable step": "theory/stable",
    "hourglass": "theory/solid_reduced",
    "shock": "week/bar",
    "KKT conditions": "theory/continuum",
    "node-to-segment": "theory/contact",
    "tunnelling": "theory/contact_faces",
    "friction": "theory/friction",
    "penalty": "week/wall",
    "closest point": "theory/projection",
    "ct_project": "api/projection",
}
RESULTS = """
() => [...document.querySelectorAll("#search-results li > a")].slice(0, 4).map(a => a.getAttribute("href"))
"""
SHOWN = """
() => {
  const box = e => e.getBoundingClientRect();
  const hidden = [...document.querySelectorAll("article :is(p, img, svg, a)")].filter(e => {
    if (e.closest("[hidden], .toctree-wrapper, .headerlink") || !e.textContent.trim() && e.tagName !== "IMG") return false;
    const style = getComputedStyle(e);
    return style.display === "none" || style.visibility !== "visible" || box(e).width === 0;
  });
  const picture = document.querySelector("article img");
  return {top: box(picture).top + scrollY, loaded: picture.naturalWidth, hidden: hidden.map(e => e.outerHTML)};
}
"""


@pytest.fixture(scope="module")
def first(book):
    """The first page at both widths on a light and a dark ground, and the results of searches."""
    pytest.importorskip("playwright", reason="no playwright (make build/venv/.browser)")
    own = browser.find()
    if own is None:
        pytest.skip("no browser on this machine")
    found, results = {}, {}
    with browser.reading(book, own) as reader:
        for scheme in ("light", "dark"):
            reader.page.emulate_media(color_scheme=scheme)
            for width, height in WIDTHS.items():
                reader.page.set_viewport_size({"width": width, "height": height})
                found[scheme, width] = reader.open("index.html").evaluate(SHOWN)
        for query in SEARCHES:
            page = reader.open(f"search.html?q={query}")
            page.wait_for_selector("#search-results .search-summary:not(:empty)")
            results[query] = page.evaluate(RESULTS)
    return found, results


def test_the_first_page_begins_with_its_picture(first):
    for seen in first[0].values():
        assert 0 < seen["top"] < 500 and seen["loaded"] > 0 and seen["hidden"] == []


def test_a_search_finds_chapters_first(first):
    missed = {
        query: found
        for query, found in first[1].items()
        if not any(link.startswith(f"{SEARCHES[query]}.html") for link in found)
    }
    assert missed == {}


def test_no_request_leaves(looks):
    assert looks[1] == []


# Decks as a projector and a telephone show them. `tall`: slides that do not fit into the window. `lost` and `hidden` as
# above.
DECK = """
() => {
  const width = document.documentElement.clientWidth, tall = [], lost = [], hidden = [];
  const title = e => e.closest("section").querySelector("h1, h2").textContent + ": " + e.tagName;
  for (const slide of document.querySelectorAll("main > section"))
    if (slide.getBoundingClientRect().height > innerHeight + 1) tall.push(title(slide));
  for (const box of document.querySelectorAll(".math > mjx-container, div.highlight pre"))
    if (box.scrollWidth > box.clientWidth + 1) hidden.push(title(box));
  for (const e of document.querySelectorAll("main *")) {
    let box = e;
    if (e.getBoundingClientRect().right <= width + 1) continue;
    while (box !== document.body && getComputedStyle(box).overflowX === "visible") box = box.parentElement;
    if (box === document.body) lost.push(title(e));
  }
  return {slides: document.querySelectorAll("main > section").length, tall, lost, hidden,
          errors: document.querySelectorAll("mjx-merror, .pull").length};
}
"""


def test_decks(book):
    pytest.importorskip("playwright", reason="no playwright (make build/venv/.browser)")
    own = browser.find()
    if own is None:
        pytest.skip("no browser on this machine")
    with browser.reading(book, own) as reader:
        for week in range(1, 13):
            page = reader.open(f"slides/twelve/{week}.html")
            page.set_viewport_size({"width": 1400, "height": 800})
            wide = page.evaluate(DECK)
            page.set_viewport_size({"width": 390, "height": 844})
            narrow = page.evaluate(DECK)
            assert wide["slides"] >= 8 and wide["errors"] == 0
            assert (wide["tall"], wide["lost"], wide["hidden"], narrow["lost"]) == ([], [], [], [])
        assert reader.outside == []
