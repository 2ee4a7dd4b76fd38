"""The filter of recorded fields: from a scene to the file and back, and the plates compared with their closed form."""

import copy
import pickle

import h5py
import numpy as np
import pytest
from scenes import box_of, scene_with

import libcontact as ct

NU = 0.3
FIELDS = ("displacement", "velocity", "stress")


def impact(cells=12, passes=0, contact=False, **output):
    """The plates of the paper in units d = rho = v0 = c1 = 1, without contact the right one on its plane of
    symmetry."""
    young, h = (1 + NU) * (1 - 2 * NU) / (1 - NU), 1 / cells
    scene = scene_with("steel", young=young, poisson=NU, density=1.0)
    for name in ("left", "right") if contact else ("right",):
        side = -1 if name == "left" else 1
        box = box_of([min(side, 0), 0, 0], [1, h, 1], [cells, 1, cells])
        own = {"integration": "reduced", "hourglass": 3.231}
        scene.add_body(name, material="steel", box=box, velocity=[-1e-3 * side, 0, 0], **own)
        for face in ("z_min", "y_min", "y_max"):
            scene.add_support(f"{name}.{face}", fix=face[0])
    if contact:
        scene.add_contact("left.x_max", "right.x_min")
    else:
        scene.add_support("right.x_min", fix="x")
    scene.set_output(**({"filter": passes} if passes else {}), **output)
    return scene.set_time(end=0.56, fraction=0.98)


def run_of(scene, **options):
    return scene.run(**{"output": False, **options})


def error(body):
    """L1 on the line of Fig. 4."""
    x, _, z = body.centres.T
    row = np.flatnonzero(z < 1.5 * z.min())
    stress = body.stress[row, 0] * (1 - NU) / NU / 1e-3
    exact = ct.exact.plates(x[row], np.zeros(row.size), 0.56, NU)[0].sigma_x
    return np.abs(stress - exact).mean()


@pytest.mark.parametrize("contact", [False, True])
def test_the_plates_are_nearer_to_the_closed_form(contact):
    """The rows of the chapter's table at 0.56 with two passes at d/40."""
    body = run_of(impact(40, 2, contact)).state["right"]
    plain, filtered = (0.0842, 0.0529) if contact else (0.0852, 0.0530)
    assert abs(error(body) - plain) < 1e-4 and abs(error(body.filtered) - filtered) < 1e-4


@pytest.mark.parametrize("contact", [False, True])
def test_the_run_keeps_its_bits(contact):
    plain, shown = run_of(impact(contact=contact)), run_of(impact(passes=3, contact=contact))
    for name in plain.state:
        for field in FIELDS:
            one, other = (getattr(run.state[name], field) for run in (plain, shown))
            assert one.tobytes() == other.tobytes()
            assert not np.array_equal(getattr(shown.state[name].filtered, field), other)
    assert plain.energy.tobytes() == shown.energy.tobytes()


def test_what_the_file_holds(tmp_path):
    run = run_of(impact(passes=2, times=[0.0, 0.3]), output=tmp_path / "run.vtkhdf")
    with h5py.File(run.path) as file:
        assert file["libcontact"].attrs["filter"] == 2
        nodes, cells = len(run.state["right"].nodes), len(run.state["right"].elements)
        for group, name, rows in (
            ("PointData", "displacement", nodes),
            ("PointData", "velocity", nodes),
            ("CellData", "stress", cells),
        ):
            shape = file[f"VTKHDF/{group}/{name}"].shape
            assert file[f"VTKHDF/{group}/{name}_filtered"].shape == shape
            first = file[f"VTKHDF/Steps/{group}Offsets/{name}_filtered"][()]
            assert list(first) == [rows * k for k in range(len(first))]
    read = ct.Run.load(run.path)
    for field in FIELDS:
        for one, other in (
            (read.state["right"], run.state["right"]),
            (read.state["right"].filtered, run.state["right"].filtered),
        ):
            assert getattr(one, field).tobytes() == getattr(other, field).tobytes()
    place, values = read.line("stress_xx", [0, 0, 0.01], [1, 0, 0.01], 7, filtered=True)
    assert np.array_equal(
        values, run.line("stress_xx", [0, 0, 0.01], [1, 0, 0.01], 7, filtered=True)[1]
    )
    assert not np.array_equal(values, read.line("stress_xx", [0, 0, 0.01], [1, 0, 0.01], 7)[1])


def test_only_the_fields_that_are_asked_for(tmp_path):
    run = run_of(impact(passes=1, fields=["stress"]), output=tmp_path / "run.vtkhdf")
    with h5py.File(run.path) as file:
        assert "stress_filtered" in file["VTKHDF/CellData"]
        assert not [name for name in file["VTKHDF/PointData"] if name.endswith("_filtered")]


def test_a_file_without_the_filter_says_nothing_of_it(tmp_path):
    run = run_of(impact(), output=tmp_path / "run.vtkhdf")
    with h5py.File(run.path) as file:
        assert "filter" not in file["libcontact"].attrs
        assert not [name for name in file["VTKHDF/PointData"] if name.endswith("_filtered")]
    with pytest.raises(ValueError, match="nothing was filtered"):
        _ = ct.Run.load(run.path).state["right"].filtered


def test_what_is_shown_in_a_watch_and_copied_is_the_same():
    seen = []
    run = run_of(
        impact(passes=2), watch=lambda now: seen.append(now.state["right"].filtered.velocity.copy())
    )
    assert np.array_equal(seen[-1], run.state["right"].filtered.velocity)
    for other in (copy.deepcopy(run), pickle.loads(pickle.dumps(run))):
        assert np.array_equal(seen[-1], other.state["right"].filtered.velocity)


def test_a_restart_filters_on(tmp_path):
    whole = run_of(impact(passes=2))
    run_of(impact(passes=2), output=tmp_path / "half.vtkhdf", until=0.3)
    rest = run_of(impact(passes=2), restart=tmp_path / "half.vtkhdf")
    one, other = (run.state["right"].filtered.stress for run in (whole, rest))
    assert one.tobytes() == other.tobytes()


def test_what_is_refused():
    data = impact(passes=1).data
    data["material"][0]["law"] = "neo_hookean"
    del data["body"][0]["integration"], data["body"][0]["hourglass"]
    with pytest.raises(ct.SceneError, match="output.filter.*not linear"):
        run_of(ct.Scene(data))
    for passes in (-1, 9, 1.5):
        with pytest.raises(ct.SceneError, match="output.filter"):
            run_of(impact(passes=passes))


def test_explain_says_it():
    assert "filtered 2 times" in str(impact(passes=2, file="a.vtkhdf").explain())
