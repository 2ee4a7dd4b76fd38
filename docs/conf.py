"""How the book is built: ``make docs``, or by hand

    build/venv/bin/python -m sphinx -W --keep-going -n -b html docs build/docs/html

``LIBCONTACT_GALLERY=0`` shows the tutorials without running them, which takes seconds and needs no compiled wrapper;
where there is none, the page of the Python package is left out. Nothing in the book comes from outside: it reads the
same without a network, opened from the disk.
"""

import gc
import importlib.util
import os
import shutil
import sys
import warnings
from pathlib import Path

from hawkmoth.util.compiler import get_include_args

# A book is millions of objects that stay. By default Python searches all of them for garbage again and again.
gc.set_threshold(100_000, 20, 20)
DOCS = Path(__file__).resolve().parent
ROOT = DOCS.parent
# What tutorials write goes beside the book, not into the sources.
os.environ.setdefault("LIBCONTACT_FIGURES", str(ROOT / "build" / "docs" / "figures"))
os.environ.setdefault(
    "LIBCONTACT_TIMES", "no"
)  # how long this machine took is of no use to readers
os.environ["LIBCONTACT_DOCS"] = ""  # messages in the book have no address of a book on this machine
# Nor has a warning on the page of a tutorial the path of its program.
warnings.formatwarning = lambda message, category, *_: f"{category.__name__}: {message}\n"
RUN_TUTORIALS = os.environ.get("LIBCONTACT_GALLERY", "1") != "0"

sys.path.insert(0, str(DOCS / "_ext"))

project = "libcontact"
author = "the libcontact authors"
copyright = f"{author}; MIT licence"  # noqa: A001 (the name is Sphinx's)

extensions = [
    "weave",  # quotes C functions and fragments, checks equation labels
    "tracepage",  # the line and the test of each equation
    "codepages",  # each C file as a page, for the links from listings and from the API
    "navigation",  # the titles of all pages, beside each page
    "floors",  # the rooms of the sources, drawn from their includes
    "methodtable",  # measures the methods of projection side by side
    "scenekeys",  # the tables of a scene's keys come from the package's model
    "exercises",  # with folded answers, which -D student=1 leaves out
    "course",  # marks of sections and tables of weeks come from course.toml
    "slides",  # show what the chapters have; the decks of the weeks come from course.toml
    "parts",  # one count of chapters through all parts
    "symbols",  # the tables of notation come from reference/notation.toml
    "drawn",  # pictures of a chapter come from a program beside it
    "laboratory",  # pages in which a reader runs the library, from make page
    "measured",  # numbers in the text come from measured.json
    "typed",  # a page types no other numbers than typed.toml lists
    "cnames",  # `ct_name` in comments becomes a link; no public function without a page
    "hawkmoth",
    "sphinx.ext.autodoc",
    "numpydoc",
    "sphinx.ext.mathjax",
    "sphinx_design",
    "sphinxcontrib.bibtex",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["tutorials/sg_execution_times.rst", "tutorials/**/*.ipynb", "exercises/*"]
default_role = "cname"
highlight_language = "c"
nitpicky = True
nitpick_ignore = [
    # Types of the C standard library, which has no pages here.
    ("c:identifier", "size_t"),
    ("c:identifier", "int32_t"),
    ("c:identifier", "uint8_t"),
    ("c:identifier", "int64_t"),
    ("c:identifier", "uint64_t"),
    # Opaque in the public headers.
    ("c:identifier", "ct_piece"),
    ("c:identifier", "ct_slip"),
    # What Scene.explain is made from: not for callers.
    ("py:class", "libcontact.problem.Problem"),
    # What the types of the model are made of.
    ("py:class", "libcontact.schema.Place"),
    ("py:class", "libcontact.schema.T"),
    ("py:class", "dataclasses.Field"),
    ("py:class", "Vector"),
]
nitpick_ignore_regex = [
    # Types of Python and numpy in signatures: their pages are on the net, and the book is built without it.
    (
        r"py:.*",
        r"(numpy|np|pathlib|os|collections|typing|types|enum)\..*|Any|Iterable|Callable|Path|ndarray|ArrayLike|NDArray|Floats|Ints|Rows|InitVar",
    ),
    (
        r"py:.*",
        r"(int|float|str|bool|bytes|dict|list|tuple|object|None|optional|IntEnum|ValueError|RuntimeError)",
    ),
]

# -- Numbers of figures, listings and equations -------------------------------------------------------------------
numfig = True
math_numfig = True
numfig_secnum_depth = 1
numfig_format = {
    "code-block": "Listing %s",
    "exercise": "Exercise %s",
    "figure": "Fig. %s",
    "table": "Table %s",
}
math_eqref_format = "({number})"

# -- HTML ---------------------------------------------------------------------------------------------------------
html_theme = "furo"
html_title = "libcontact"
html_static_path = ["_static"]
templates_path = ["_templates"]
html_css_files = ["book.css"]
html_search_scorer = str(DOCS / "_static" / "search.js")
html_show_sphinx = False
html_copy_source = False
pygments_style = "friendly"
pygments_dark_style = "github-dark"
mathjax_path = "tex-svg-full.js"

# -- C, from the comments of the headers ------------------------------------------------------------------------
hawkmoth_root = str(ROOT / "libcontact" / "include")
# The folder of stddef.h. By itself hawkmoth asks for those of C++ too, with a warning where there is no C++ compiler.
hawkmoth_autoconf: list[str] = []
hawkmoth_clang = [
    "-std=c99",
    f"-I{hawkmoth_root}",
    *get_include_args(shutil.which("gcc") or "cc", "c"),
]
hawkmoth_source_uri = "../_code/libcontact/include/{source}.html#line-{line}"

# -- Python --------------------------------------------------------------------------------------------------------
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
numpydoc_show_class_members = False  # autodoc lists them
package = importlib.util.find_spec("libcontact")
if not RUN_TUTORIALS and (
    package is None or package.origin is None
):  # no origin: the folder of the C library, not the package
    exclude_patterns.append("api/python.rst")
    suppress_warnings = ["toc.excluded"]
else:
    # Sphinx looks up annotations in the module, which imports these names for type checkers alone.
    import libcontact.scene
    from libcontact.pictures import animation, drawing, picture
    from libcontact.planning import explain, plan

    libcontact.scene.Cost, libcontact.scene.Explanation = plan.Cost, explain.Explanation
    animation.Run = drawing.Run = picture.Run = libcontact.scene.Run

# -- References and tutorials ---------------------------------------------------------------------------------------
bibtex_bibfiles = ["references.bib"]
bibtex_reference_style = "author_year"
sphinx_gallery_conf = {
    "examples_dirs": "../tutorials",
    "gallery_dirs": "tutorials",
    "filename_pattern": r"/\d\d_",
    "within_subsection_order": "FileNameSortKey",
    "plot_gallery": RUN_TUTORIALS,
    "image_scrapers": ("figuredata",),  # with the data of each picture
    "abort_on_example_error": True,
    # Nothing on a page is of the machine that built it, or of Python: no times, no "<matplotlib.lines.Line2D object at
    # 0x...>".
    "write_computation_times": False,
    "min_reported_time": float("inf"),
    "capture_repr": (),
    "show_memory": False,
    "remove_config_comments": True,
    "download_all_examples": False,
}


def copy_mathjax(app):
    """Take the one file of MathJax that sets everything without fetching more; the package would copy 20 MB."""
    if app.builder.format == "html":
        package = Path(importlib.util.find_spec("sphinx-mathjax-offline").origin).parent
        target = Path(app.outdir) / "_static"
        target.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(package / "static" / "mathjax" / mathjax_path, target / mathjax_path)


def without_factories(app, what, name, thing, options, signature, returns):
    """Dataclasses with defaults that Sphinx can't show are shown by their fields, which follow."""
    return ("", "") if "<factory>" in (signature or "") else None


def setup(app):
    app.connect("autodoc-process-signature", without_factories)
    app.connect("builder-inited", copy_mathjax)
