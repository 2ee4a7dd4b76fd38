"""The notebook of docs/start in a kernel: tables, a progress bar and pictures are shown."""

import base64
import json
from pathlib import Path

import pytest
from scenes import METRES

import libcontact as ct

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")
pytest.importorskip("matplotlib_inline")

FILE = Path(__file__).resolve().parents[2] / "docs" / "start" / "plates.ipynb"
PLAN = """\
from libcontact.planning.planner import Offer, Plan
offer = Offer(scene, "100 x 1 x 100 <cells>", "courant 0.5", 0.02, 1.5, "the mesh meets the error")
plan = Plan(offer, None, None, "of the stress", "sure")
print(plan)
plan"""
MID_CELL = """\
for field in ("mises", "pressure"):
    run.plot(field, instants=1)
done = 1"""


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    """The outputs of the cells by their names, after those of the file a plan and pictures in a loop."""
    book = nbformat.read(FILE, as_version=4)
    for name, source in {"plan": PLAN, "loop": MID_CELL}.items():
        book.cells.append(nbformat.v4.new_code_cell(source, id=name))
    # A smaller mesh is enough.
    cell = next(cell for cell in book.cells if cell.id == "scene")
    cell.source = cell.source.replace(
        'scene = ct.Scene.load(ct.example("plates"))',
        'data = ct.Scene.load(ct.example("plates")).data\n'
        'for body in data["body"]:\n    body["box"]["cells"] = [20, 1, 20]\n'
        "scene = ct.Scene(data)",
    )
    where = {"metadata": {"path": str(tmp_path_factory.mktemp("notebook"))}}
    client = nbclient.NotebookClient(book, timeout=300, kernel_name="python3", resources=where)
    with pytest.MonkeyPatch.context() as patch:
        # The kernel chooses its own backend.
        patch.delenv("MPLBACKEND", raising=False)
        client.execute()
    return {cell.id: cell.outputs for cell in book.cells if cell.cell_type == "code"}


def bundles(outputs, kind):
    """What the outputs of a cell contain of a MIME type."""
    found = [output.data for output in outputs if "data" in output]
    return [data[kind] for data in found if kind in data]


def printed(outputs):
    return "".join(output.text for output in outputs if output.output_type == "stream")


def test_the_table_of_costs_is_printed(outputs):
    """rich would display the table instead of writing it."""
    text = printed(outputs["cost"])
    assert "predicted" in text and "solid" in text and "contact" in text
    assert not bundles(outputs["cost"], "text/html")


def test_explain_contains_its_table(outputs):
    (text,) = bundles(outputs["explain"], "text/html")
    assert "What is not computed" in text and "of the bound" in text and "<details" in text
    (scene,) = bundles(outputs["scene"], "text/html")
    assert "<table>" in scene and "left" in scene and "20 × 1 × 20 cells" in scene


def test_a_run_shows_a_progress_bar_and_its_energies(outputs):
    """The bar of ipywidgets, or where there is none a line of text."""
    views = bundles(outputs["run"], "application/vnd.jupyter.widget-view+json")
    assert views or "steps" in printed(outputs["run"])
    (text,) = bundles(outputs["run"], "text/html")[-1:]
    assert "kinetic [mJ]" in text and "records of left, right" in text


def test_a_plot_is_shown_once(outputs):
    """Each call gives one image, the last expression of a cell as well as one in a loop."""
    for cell, count in {"plot": 1, "mises": 1, "curve": 1, "loop": 2}.items():
        images = bundles(outputs[cell], "image/png")
        assert len(images) == count, cell
        assert all(base64.b64decode(image).startswith(b"\x89PNG") for image in images)
        assert all(len(image) > 20_000 for image in images) or cell == "curve"


def test_a_plan_is_a_table(outputs):
    (text,) = bundles(outputs["plan"], "text/html")
    assert "<table>" in text and "&lt;cells&gt;" in text and "2" in text
    assert "courant 0.5" in printed(outputs["plan"])


def test_the_file_has_no_outputs():
    cells = [cell for cell in json.loads(FILE.read_text())["cells"] if cell["cell_type"] == "code"]
    assert cells and not any(cell["outputs"] or cell["execution_count"] for cell in cells)


def test_what_a_notebook_shows_is_escaped():
    """Titles and names may contain any characters."""
    scene = ct.Scene(units=METRES, title="<b>a & b</b>")
    assert "&lt;b&gt;a &amp; b&lt;/b&gt;" in scene._repr_html_()
