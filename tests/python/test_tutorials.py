"""Each tutorial runs as downloaded: a script alone in an empty folder. Each asserts its claims. The first one also
writes the files of the contract."""

import ast
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from commands import captured

import libcontact as ct

ROOT = Path(__file__).resolve().parents[2]
SCRIPTS = sorted((ROOT / "tutorials").glob("[0-9][0-9]_*.py"))
# Files of a tutorial for the book.
FILES = {
    "02_closest_point.py": [
        f"closest_point_{name}.png" for name in ("face", "starts", "paths", "work", "floor")
    ]
}


def run(script, folder):
    alone = shutil.copy(script, folder)
    return captured(
        [sys.executable, alone],
        cwd=folder,
        env={
            **os.environ,
            "MPLBACKEND": "Agg",
            "LIBCONTACT_FIGURES": str(folder),
            "LIBCONTACT_TIMES": "no",
        },
    )


def test_what_tutorials_import_comes_with_the_extra():
    """``pip install libcontact[tutorials]`` installs each package that a tutorial imports."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    wanted = project["dependencies"] + project["optional-dependencies"]["tutorials"]
    brought = {
        "libcontact",
        *sys.stdlib_module_names,
        *(name.partition(">")[0].replace("-", "_") for name in wanted),
    }
    for script in SCRIPTS:
        nodes = list(ast.walk(ast.parse(script.read_text())))
        names = {
            alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names
        }
        names |= {node.module for node in nodes if isinstance(node, ast.ImportFrom)}
        assert {name.partition(".")[0] for name in names} <= brought, script.name


def drawing(script):
    """Lines that draw: statements with matplotlib, ``libcontact.pictures.plot`` or objects from these."""
    tree = ast.parse(script.read_text())
    drawn, lines = {"plt", "pyplot", "matplotlib"}, set()

    def visit(node):
        blocks = [getattr(node, name, []) for name in ("body", "orelse", "handlers", "finalbody")]
        inside = [statement for block in blocks for statement in block]
        heads = [child for child in ast.iter_child_nodes(node) if child not in inside]
        names = [x for head in heads for x in ast.walk(head) if isinstance(x, ast.Name)]
        if isinstance(node, ast.ImportFrom) and "plot" in node.module:
            drawn.update(alias.asname or alias.name for alias in node.names)
        if any(x.id in drawn for x in names) and not isinstance(node, ast.Assert):
            # A name that a drawing statement assigns is part of the drawing, unless it is a number.
            if isinstance(node, (ast.Assign, ast.For)) and "share" not in ast.dump(node):
                drawn.update(x.id for x in names if isinstance(x.ctx, ast.Store) and x.id in AXES)
            last = inside[0].lineno if inside else node.end_lineno + 1
            lines.update(range(node.lineno, last))
        for statement in inside:
            visit(statement)

    for statement in tree.body:
        visit(statement)
    return lines


# Names of axes and figures in all tutorials.
AXES = {"fig", "ax", "axes", "left", "right", "above", "below", "upper", "lower", "centre", "image"}


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda s: s.stem)
def test_at_most_a_fifth_draws(script):
    """As a fraction of all lines that are not blank. No line is wider than a page."""
    lines = script.read_text().splitlines()
    assert max(map(len, lines)) <= 100
    assert len(drawing(script)) <= sum(map(bool, lines)) / 5


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda s: s.stem)
def test_each_sends_the_reader_on(script):
    """The last section asks for two or three predictions, each with a folded answer; the program has tried each."""
    section = script.read_text().partition("# Predict, then unfold\n")[2]
    text, code = re.split(r"^(?!#)", section, maxsplit=1, flags=re.M)
    asked = len(re.findall(r"^# \d\. .*\?", text.replace("\n#    ", " "), re.M))
    assert 2 <= asked <= 3 and text.count("#    .. answer::") == asked
    assert code.count("assert ") >= 2


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda s: s.stem)
def test_each_draws_within_twenty_lines_and_tells_its_time(script):
    head, code = script.read_text().split('"""', 2)[1:]
    lines = [line for line in code.splitlines() if line and not line.startswith("#")]
    first = [i for i, line in enumerate(lines, 1) if re.search(r"\bplt\.|\.plot\(", line)]
    assert first and first[0] <= 20
    assert re.search(r"about \d+ s of one core", " ".join(head.split()))


@pytest.mark.skipif("LIBCONTACT_DOWNLOADS" not in os.environ, reason="minutes; needs the book")
@pytest.mark.parametrize("script", SCRIPTS, ids=lambda s: s.stem)
def test_a_download_runs_with_the_wheel_and_its_extra(script, fresh, tmp_path):
    """From the link of the built book, in an empty folder of a fresh environment: LIBCONTACT_DOWNLOADS is
    ``build/docs/html/_downloads``."""
    downloads = Path(os.environ["LIBCONTACT_DOWNLOADS"]).resolve()
    (found,) = {path.read_text() for path in downloads.glob(f"*/{script.name}")}
    assert found == script.read_text()
    (tmp_path / script.name).write_text(found)
    names = ("PYTHONPATH", "LIBCONTACT_FIGURES", "LIBCONTACT_TIMES")
    environment = {name: value for name, value in os.environ.items() if name not in names}
    done = captured(
        [str(fresh), "-I", script.name], cwd=tmp_path, env=environment | {"MPLBACKEND": "Agg"}
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert list(tmp_path.glob("*.png"))


@pytest.fixture(scope="module")
def fresh(tmp_path_factory):
    """The Python of a fresh environment with ``pip install WHEEL[plot]``."""
    folder = tmp_path_factory.mktemp("fresh")
    (wheel,) = (ROOT / "build" / "wheel").glob("libcontact-*.whl")  # of make wheel
    subprocess.run([sys.executable, "-m", "venv", str(folder / "venv")], check=True)
    python = folder / "venv" / "bin" / "python"
    install = [str(python), "-m", "pip", "install", "-q", f"libcontact[plot] @ {wheel.as_uri()}"]
    subprocess.run(install, check=True)
    return python


def test_examples_are_the_scenes_of_the_repository():
    for path in (ROOT / "tutorials" / "scenes").glob("*.toml"):
        assert ct.example(path.stem).read_bytes() == path.read_bytes()
        ct.Scene.load(ct.example(path.stem))
    with pytest.raises(ValueError, match='no example "plate".*plates'):
        ct.example("plate")


@pytest.mark.parametrize(
    "script", [s for s in SCRIPTS if not s.name.startswith("01")], ids=lambda s: s.stem
)
def test_tutorial_runs(script, tmp_path):
    done = run(script, tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    for name in FILES.get(script.name, ()):
        assert (tmp_path / name).stat().st_size > 10_000


@pytest.fixture(scope="module")
def figures(tmp_path_factory):
    folder = tmp_path_factory.mktemp("figures")
    done = run(SCRIPTS[0], folder)
    assert done.returncode == 0, done.stdout + done.stderr
    (folder / "printed.txt").write_text(done.stdout)
    return folder


def read(path):
    names = path.read_text().splitlines()[0].split(",")
    return names, np.loadtxt(path, delimiter=",", skiprows=1)


def test_plate_impact_writes_its_files(figures):
    tables = {f"{name}{which}.csv" for name in ("fig4", "fig5") for which in ("", "_best")}
    wanted = {"fig3.png", "fig4.png", "fig5.png", *tables} | (
        {"plates.vtkhdf"} if ct.has("hdf5") else set()
    )
    assert wanted <= {path.name for path in figures.iterdir()}


def test_plate_impact_prints_nothing_of_the_machine_for_the_book(figures):
    """With LIBCONTACT_TIMES=no, as the book is built: no seconds and no folder."""
    printed = (figures / "printed.txt").read_text()
    assert "bit for bit: True" in printed
    assert not re.search(
        r"seconds|time: |\d s\b;|\d (?:ms|us)\b|site-packages|" + re.escape(str(ROOT)), printed
    )


def test_fig4_table(figures):
    names, rows = read(figures / "fig4.csv")
    assert names == ["x_over_d", "contact", "reference", "exact"]
    assert rows.shape == (200, 4)
    x, contact, reference, exact = rows.T
    assert np.all(np.diff(x) > 0)
    np.testing.assert_allclose(x, (np.arange(-100, 100) + 0.5) / 100, atol=1e-12)
    # The uniaxial wave: -(1 - nu)/nu behind the front at 0.56, nothing before it.
    np.testing.assert_allclose(exact, np.where(np.abs(x) < 0.56, -7 / 3, 0), atol=1e-12)
    assert np.array_equal(contact, contact[::-1]) and np.array_equal(reference, reference[::-1])
    assert np.mean(np.abs(contact - reference)) < 0.01 * 7 / 3


def test_fig5_table(figures):
    names, rows = read(figures / "fig5.csv")
    assert names == ["z_over_d", "contact", "reference", "exact", "series"]
    assert rows.shape == (100, 5)
    z, _, _, exact, series = rows.T
    np.testing.assert_allclose(z, (np.arange(100) + 0.5) / 100, atol=1e-12)
    assert np.all(exact[z < 0.6] == -1)
    assert np.mean(np.abs(series - exact)) < 0.004 if ct.has("gsl") else np.all(np.isnan(series))


def test_best_buy_tables(figures):
    """With half as many elements along an edge, at its own places; far below the paper's oscillation, and as accurate
    as its curves."""
    names, rows = read(figures / "fig4_best.csv")
    assert names == ["x_over_d", "best", "exact"] and rows.shape == (100, 3)
    x, best, exact = rows.T
    np.testing.assert_allclose(x, (np.arange(-50, 50) + 0.5) / 50, atol=1e-12)
    np.testing.assert_allclose(exact, np.where(np.abs(x) < 0.56, -7 / 3, 0), atol=1e-12)
    assert np.array_equal(best, best[::-1]) and best.min() > -1.02 * 7 / 3
    assert np.mean(np.abs(best - exact)) <= 0.0874
    names, rows = read(figures / "fig5_best.csv")
    assert names == ["z_over_d", "best", "exact"] and rows.shape == (50, 3)
    z, best, exact = rows.T
    series = ct.exact.plates(0.4 + 0 * z, z, 0.56).stress.sigma_z
    np.testing.assert_allclose(exact, series, atol=1e-12)
    assert np.mean(np.abs(best - exact)) <= 0.0159


@pytest.mark.skipif(not ct.has("hdf5"), reason="built without HDF5")
def test_results_file_continues_the_run(figures):
    """The newest record of the tutorial's file is the state at the end."""
    run = ct.Run.load(figures / "plates.vtkhdf")
    assert run.steps[-1] == 448
    assert abs(run.energy["total"][-1] / run.energy["total"][0] - 1) < 1e-3
