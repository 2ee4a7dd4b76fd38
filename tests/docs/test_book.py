"""The book builds with warnings as errors, tutorials not run (they are tests of their own), and needs nothing from outside."""

import functools
import os
import re
import shutil
import subprocess
import sys
import threading
import zipfile
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

pytest.importorskip("sphinx")
ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def book(tmp_path_factory):
    folder = tmp_path_factory.mktemp("book")
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
        env={**os.environ, "LIBCONTACT_GALLERY": "0", "MPLBACKEND": "Agg"},
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
    """What the gallery offers to download is what tests/python/test_tutorials.py runs alone in an empty folder."""
    for script in sorted((ROOT / "tutorials").glob("[0-9][0-9]_*.py")):
        found = list((book / "_downloads").rglob(script.name))
        assert len(found) == 1 and found[0].read_bytes() == script.read_bytes()
        with zipfile.ZipFile(next((book / "_downloads").rglob(f"{script.stem}.zip"))) as packed:
            assert packed.read(script.name) == script.read_bytes()


# How numbers of equations lie beside their formulas, as a browser lays the pages out.

WIDTHS = {
    390: 844,
    768: 1024,
    1400: 900,
}  # a telephone, a tablet, a desk: width and height in pixels
PAGES = (
    "brick",
    "contact",
    "enforcement",
    "integrator",
)  # those with the widest formulas; all pages would take half a minute

# Of each numbered equation: does the rectangle of its number cut that of its formula, as far as the formula's box shows it? Is the number
# outside of the window?
LOOK = """
() => {
  const cut = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 0.5 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 0.5;
  let numbered = 0, over = [], lost = [];
  for (const block of document.querySelectorAll("div.math")) {
    const number = block.querySelector(":scope > .eqno"), box = block.querySelector("mjx-container");
    if (!number || !box) continue;
    numbered++;
    const range = document.createRange();
    range.selectNode(number.firstChild);
    const n = range.getBoundingClientRect(), f = box.querySelector("svg").getBoundingClientRect(), b = box.getBoundingClientRect();
    const scrolls = getComputedStyle(box).overflowX !== "visible";
    if (cut(n, scrolls ? {left: Math.max(f.left, b.left), right: Math.min(f.right, b.right), top: f.top, bottom: f.bottom} : f)) over.push(block.id);
    if (n.left < 0 || n.right > document.documentElement.clientWidth) lost.push(block.id);
  }
  return {numbered, over, lost};
}
"""


@pytest.fixture(scope="module")
def looks(book):
    """What LOOK finds on PAGES, by width; skipped where there is no browser."""
    playwright = pytest.importorskip(
        "playwright.sync_api", reason="no playwright (make build/venv/.browser)"
    )
    browser = (
        shutil.which("chromium")
        or shutil.which("chromium-browser")
        or shutil.which("google-chrome")
    )
    if browser is None:
        pytest.skip("no Chromium on this machine")
    handler = functools.partial(
        type("Quiet", (SimpleHTTPRequestHandler,), {"log_message": lambda *_: None}),
        directory=str(book),
    )
    found = {width: {} for width in WIDTHS}
    with (
        ThreadingHTTPServer(("127.0.0.1", 0), handler) as server,
        playwright.sync_playwright() as driver,
    ):
        threading.Thread(target=server.serve_forever, daemon=True).start()
        page = driver.chromium.launch(executable_path=browser, args=["--no-sandbox"]).new_page()
        for name in PAGES:
            page.goto(f"http://127.0.0.1:{server.server_port}/theory/{name}.html")
            page.wait_for_function(
                "() => window.MathJax && MathJax.startup && MathJax.startup.promise"
            )
            page.evaluate("() => MathJax.startup.promise.then(() => true)")
            for width, height in WIDTHS.items():
                page.set_viewport_size({"width": width, "height": height})
                found[width][name] = page.evaluate(LOOK)
        server.shutdown()
    return found


@pytest.mark.parametrize("width", WIDTHS)
def test_no_number_is_printed_over_its_formula(looks, width):
    assert sum(page["numbered"] for page in looks[width].values()) > 40
    assert {name: page["over"] for name, page in looks[width].items() if page["over"]} == {}
    assert {name: page["lost"] for name, page in looks[width].items() if page["lost"]} == {}
