"""The book builds with warnings as errors, tutorials not run (they are tests of their own), and needs nothing from outside."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("sphinx")
ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def book(tmp_path_factory):
    folder = tmp_path_factory.mktemp("book")
    done = subprocess.run([sys.executable, "-m", "sphinx", "-W", "--keep-going", "-n", "-q", "-b", "html", "docs", str(folder)], cwd=ROOT,
                          capture_output=True, text=True, env={**os.environ, "LIBCONTACT_GALLERY": "0", "MPLBACKEND": "Agg"})
    assert done.returncode == 0, done.stderr
    return folder


def test_every_public_function_has_an_entry(book):
    headers = (ROOT / "libcontact" / "include" / "contact").glob("*.h")
    names = {name for header in headers for name in re.findall(r"^CT_API [^;]*?\b(ct_\w+)\(", header.read_text(), re.M)}
    pages = "".join(path.read_text() for path in (book / "api").glob("*.html"))
    assert names and {name for name in names if f'id="c.{name}"' not in pages} == set()


def test_nothing_is_fetched_from_outside(book):
    for page in book.rglob("*.html"):
        assert not re.search(r'<(?:script|link|img)[^>]+(?:src|href)="(?:https?:)?//', page.read_text()), page
