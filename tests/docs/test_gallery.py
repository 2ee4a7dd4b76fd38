"""The gallery, with the book's settings, on two scripts: their order, and no traces of the machine or of Python on
their pages."""

import os
import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("sphinx_gallery")
ROOT = Path(__file__).resolve().parents[2]

LONG = '''"""
First
=====

It has more lines of code than the second.
"""

import time

import matplotlib.pyplot as plt

time.sleep(0.01)
a = 1
b = 2
print("the sum is", a + b)
fig, ax = plt.subplots()
ax.plot([1, 2])
'''
SHORT = '''"""
Second
======

It is short.
"""

object()
'''


@pytest.fixture(scope="module")
def gallery(tmp_path_factory):
    root = tmp_path_factory.mktemp("gallery")
    settings = runpy.run_path(str(ROOT / "docs" / "conf.py"))["sphinx_gallery_conf"] | {
        "plot_gallery": True
    }
    (root / "scripts").mkdir()
    (root / "docs").mkdir()
    (root / "scripts" / "GALLERY_HEADER.rst").write_text("Scripts\n=======\n")
    (root / "scripts" / "01_long.py").write_text(LONG)
    (root / "scripts" / "02_short.py").write_text(SHORT)
    settings = repr(settings | {"examples_dirs": "../scripts", "gallery_dirs": "scripts"}).replace(
        ": inf", ": float('inf')"
    )
    (root / "docs" / "conf.py").write_text(
        f"import sys\nsys.path.insert(0, {str(ROOT / 'docs' / '_ext')!r})\n"
        f"extensions = ['sphinx_gallery.gen_gallery']\nsphinx_gallery_conf = {settings}\n"
    )
    (root / "docs" / "index.rst").write_text("Book\n====\n\n.. toctree::\n\n   scripts/index\n")
    done = subprocess.run(
        [sys.executable, "-m", "sphinx", "-q", "-b", "html", "docs", "out"],
        cwd=root,
        capture_output=True,
        text=True,
        env={**os.environ, "MPLBACKEND": "Agg"},
    )
    assert done.returncode == 0, done.stderr
    return root / "out" / "scripts"


def test_scripts_stand_in_the_order_of_their_names(gallery):
    shown = re.findall(r"(01_long|02_short)\.html", (gallery / "index.html").read_text())
    assert list(dict.fromkeys(shown)) == ["01_long", "02_short"]


def test_output_is_what_the_script_printed(gallery):
    page = (gallery / "01_long.html").read_text()
    assert "the sum is 3" in page
    assert "matplotlib.lines" not in page and "running time" not in page
    page = (gallery / "02_short.html").read_text()
    assert "object at 0x" not in page and "running time" not in page


def test_a_picture_links_its_data(gallery):
    (data,) = (gallery.parent / "_downloads").rglob("*.csv")
    assert data.read_text() == "panel,curve,x,y,value\n1,line 1,0,1,\n1,line 1,1,2,\n"
    assert f"{data.parent.name}/{data.name}" in (gallery / "01_long.html").read_text()
