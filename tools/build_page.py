"""``make page``: the laboratories as a folder of files that a browser opens from a disk.

``build_page.py MODULE FOLDER`` packs the module of the library (``docs/laboratory/module``), writes the scripts and one
page for each laboratory. Browsers that unpack it have vector instructions, too.
"""

from __future__ import annotations

import base64
import csv
import json
import shutil
import sys
import tomllib
from pathlib import Path

import page_tables

ROOT = Path(__file__).resolve().parents[1]
SOURCES = ROOT / "docs" / "laboratory"
sys.path.append(str(ROOT / "docs" / "_ext"))

import svg  # noqa: E402

# Loaded by the page and by its worker, in this order.
COMPUTING = (
    "library.js",
    "motion.js",
    "scene.js",
    "jobs.js",
    "bar.job.js",
    "plates.job.js",
    "closest.job.js",
    "waves.job.js",
    "own.job.js",
)
SHOWN = (
    "packed.js",
    "toml.js",
    "words.js",
    "check.js",
    "rules.js",
    "remote.js",
    "control.js",
    "plot.js",
    "field.js",
    "laboratory.js",
    "bar.js",
    "plates.js",
    "turn.js",
    "closest.js",
    "waves.js",
    "own.js",
)
MOST_PACKED = 320_000  # bytes of the module
EXAMPLES = ("plates", "bar_on_a_wall", "bouncing_bar")
# Titles, and what there is to do.
PAGES = {
    "bar": (
        "A wall and a bar",
        "An elastic bar flies against a rigid wall. Choose the explicit penalty and make it stiffer: energy grows. "
        "The energy-controlled penalty keeps it.",
    ),
    "plates": (
        "Two plates",
        "Two plates collide along their faces. The colours are the stress, the black lines the exact wave fronts. "
        "Change mesh, step and law, and compare the error with its price.",
    ),
    "closest": (
        "Closest point",
        "Which point of a face is closest to a point in space? Drag the point and the nodes, choose a method, and let "
        "it walk.",
    ),
    "waves": (
        "Waves",
        "How fast does each wave travel in a mesh, and what does the mesh make of a front?",
    ),
    "own": ("Your own scene", "Edit a scene, run it, turn the picture, and save the results."),
}
PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<link rel="stylesheet" href="page.css">
<link rel="stylesheet" href="laboratory.css">
</head>
<body>
<h1>{title}</h1>
{content}
</body>
</html>
"""


def html(title: str, content: str) -> str:
    return PAGE.format(title=title, content=content)


def page(name: str) -> str:
    """The page of one laboratory, with its picture for readers without JavaScript and for paper."""
    program = SOURCES / "pictures.py"
    figure, says = svg.call(program, name), svg.program(program)[name].__doc__
    content = (
        f'<div class="laboratory" data-laboratory="{name}">\n'
        f'<figure class="laboratory-fallback">{svg.svg(figure, f"laboratory-{name}", says)}\n'
        f"<figcaption>{says}</figcaption></figure></div>\n"
        "<noscript><p>With JavaScript the library computes in this page.</p></noscript>\n"
        '<p><a href="index.html">All laboratories</a></p>\n'
        '<script defer src="laboratory.js"></script>'
    )
    title, task = PAGES[name]
    return html(title, f"<p>{task}</p>\n{content}")


def joined(*names: str) -> str:
    """Sources of the page, one after another."""
    return "".join((SOURCES / name).read_text(encoding="utf-8") for name in names)


def prices() -> dict[str, dict[str, list[float]]]:
    """Element updates and errors of the book's runs of two plates, by the line of the error."""
    with (ROOT / "docs" / "theory" / "accuracy.csv").open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["scene"] == "contact"]
    rows = [row for row in rows if row["status"] == "done" and "poisson" not in row["setting"]]
    columns = {"x": "l1_fig4_at_056", "z": "l1_fig5_at_056"}
    updates = [float(row["updates"]) for row in rows]
    return {
        line: {"updates": updates, "error": [float(row[column]) for row in rows]}
        for line, column in columns.items()
    }


def examples() -> list[dict[str, str]]:
    """Scenes with which a reader may begin: a ring with friction, and scenes of the tutorials, some of them coarser."""
    scenes = ROOT / "tutorials" / "scenes"
    found = [SOURCES / "ring.toml", *(scenes / f"{name}.toml" for name in EXAMPLES)]
    texts = {path.stem: path.read_text(encoding="utf-8") for path in found}
    texts["plates"] = texts["plates"].replace("100, 1, 100", "30, 1, 30")
    return [
        {"name": name, "title": tomllib.loads(t)["title"], "text": t} for name, t in texts.items()
    ]


def pack(module: bytes) -> str:
    """A script that hands the packed module to the page; Zopfli needs 4 % less than gzip itself."""
    import zopfli.gzip

    content = zopfli.gzip.compress(module)
    print(f"module.js: {len(content)} bytes packed")
    if len(content) > MOST_PACKED:
        sys.exit(f"the packed module has {len(content)} bytes; at most {MOST_PACKED} are allowed")
    return f'laboratoryFile("module", "{base64.b64encode(content).decode()}");\n'


def main(module: str, target: str) -> None:
    folder = Path(target)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "module.js").write_text(pack(Path(module).read_bytes()))
    worker = joined(*COMPUTING, "worker.js")
    script = f"const LABORATORY_WORKER = {json.dumps(worker)};\n"
    script += f"const LABORATORY_PRICES = {json.dumps(prices())};\n"
    script += f"const LABORATORY_EXAMPLES = {json.dumps(examples())};\n"
    script += f"const LABORATORY_TABLES = {json.dumps(page_tables.tables())};\n"
    (folder / "laboratory.js").write_text(
        script + joined(*COMPUTING, *SHOWN, "start.js"), encoding="utf-8"
    )
    for name in ("laboratory.css", "page.css"):
        shutil.copyfile(SOURCES / name, folder / name)
    for name in PAGES:
        (folder / f"{name}.html").write_text(page(name), encoding="utf-8")
    links = "".join(
        f'<li><a href="{name}.html">{title}</a>: {task}</li>\n'
        for name, (title, task) in PAGES.items()
    )
    text = f"<p>In these pages the library computes, without a connection.</p>\n<ul>\n{links}</ul>"
    (folder / "index.html").write_text(html("Laboratories", text), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
