"""Layout of the results file, read with h5py; the numbers are those that `test_output --write` sets by hand."""

import os
import pathlib
import re
import subprocess

import numpy as np
import pytest
from scenes import ENERGY, MILLIMETRES, STEEL, box_of, scene_with

import libcontact as ct

h5py = pytest.importorskip("h5py")

ROOT = pathlib.Path(__file__).resolve().parents[2]
STEPS = 4


def writer_program():
    """The C test program of make's build, whose folder LIBCONTACT_BUILD names."""
    program = ROOT / os.environ.get("LIBCONTACT_BUILD", "build") / "tests/test_output"
    if not program.exists():
        pytest.skip("no C test program: make build/tests/test_output")
    return program


def write_results(folder):
    path = folder / "results.vtkhdf"
    subprocess.run([str(writer_program()), "--write", str(path), str(STEPS)], check=True)
    return path


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    with h5py.File(write_results(tmp_path_factory.mktemp("output"))) as file:
        yield file


def test_a_second_run_is_kept_from_the_file_of_the_first(tmp_path):
    """While the first one runs, also if its file is read in between; the first ends with all its records, and the next
    may write."""

    def scene():
        made = scene_with(**STEEL, units=MILLIMETRES, title="bar")
        made.add_body(
            "bar",
            material="steel",
            element="hex8",
            box=box_of([0, 0, 0], [2, 1, 1], [2, 1, 1]),
            velocity=[1, 0, 0],
        )
        return made.set_time(end=1e-6, fraction=0.5).set_output(path, every=1)

    def watch(record):
        refused.append(pytest.raises(ct.SceneError, scene().run))
        if path.exists():
            read.append(len(ct.Run.load(path).steps))

    path, refused, read = tmp_path / "run.vtkhdf", [], []
    run = scene().run(watch=watch)
    assert len(refused) == len(run.steps) and read == list(range(1, len(run.steps) + 1))
    assert all(
        f"{path}: can't write the file: another run is writing it" in str(one.value)
        and "output.file" in str(one.value)
        for one in refused
    )
    assert len(ct.Run.load(path).steps) == len(run.steps)
    scene().run()
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


# Calls that can't fail, or whose failure only shortens a text.
HARMLESS = set(
    "floor memcmp memcpy memset snprintf sprintf strcmp strcspn strerror strlen strstr vsnprintf".split()
)
HARMLESS |= set("va_start va_end offsetof sizeof if for while switch return".split())
HARMLESS |= {"H5_VERSION_GE", "S_ISDIR", "S_ISREG", "defined", "fill"}


def test_every_call_of_libc_and_hdf5_can_fail_in_the_test_of_faults():
    """tests/c/faults.h names each call that the sources make, and no other."""
    called, own = set(), set()
    for path in (ROOT / "libcontact/src/hdf5").glob("*.c"):
        if path.name in ("missing.c", "load.c"):
            continue
        text = re.sub(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"])*"', "", path.read_text(), flags=re.S)
        own |= set(re.findall(r"^[a-z][\w \*]*?\b(\w+)\([^;]*?\)\s*\{", text, re.M))
        called |= set(re.findall(r"(?<!->)\b([A-Za-z]\w+)\(", text))
    called = {name for name in called - own - HARMLESS if not re.match(r"ct_|CT_|NOW", name)}
    faults = (ROOT / "tests/c/faults.h").read_text()
    assert called == set(re.findall(r"^#define (\w+)\(", faults, re.M)) - {"FAULT"}


def displacement(points, step):
    x, y, z = points.T
    return 1e-3 * (step + 1) * np.column_stack([x + 2 * y, y - z, 3 * z])


def velocity(step):
    return (step + 1) * np.array([0.5, 1, 1.5])


def test_header(results):
    group = results["VTKHDF"]
    assert group.attrs["Type"] == b"UnstructuredGrid"
    assert list(group.attrs["Version"]) == [2, 2]
    assert group["Steps"].attrs["NSteps"] == STEPS
    kind = group.attrs.get_id("Type").get_type()
    assert not kind.is_variable_str() and kind.get_cset() == h5py.h5t.CSET_ASCII


def test_grid(results):
    group = results["VTKHDF"]
    points, cells = 4 * 3 * 2 + 32, 6 + 2
    assert group["NumberOfPoints"][:].tolist() == [points] == [len(group["Points"])]
    assert group["NumberOfCells"][:].tolist() == [cells] == [len(group["Types"])]
    assert (
        group["NumberOfConnectivityIds"][:].tolist()
        == [6 * 8 + 2 * 20]
        == [len(group["Connectivity"])]
    )
    assert group["Types"][:].tolist() == [12] * 6 + [25] * 2
    assert np.diff(group["Offsets"][:]).tolist() == [8] * 6 + [20] * 2
    assert group["Types"].dtype == np.uint8 and group["Connectivity"].dtype == np.int64
    connectivity = group["Connectivity"][:]
    assert (
        connectivity[:48].max() == 23
        and connectivity[48:].min() == 24
        and connectivity.max() == points - 1
    )
    # The first brick of the first body: VTK's order of corners, along x, then back
    corners = group["Points"][:][connectivity[:8]]
    assert np.allclose(corners[0], [-1.5, 0, 0]) and np.allclose(
        corners[6] - corners[0], [0.5, 0.5, 1]
    )
    assert np.allclose(corners[1] - corners[0], [0.5, 0, 0]) and np.allclose(
        corners[3] - corners[0], [0, 0.5, 0]
    )
    assert group["CellData/body"][:].tolist() == [0] * 6 + [1] * 2


def test_fields_of_each_step(results):
    group = results["VTKHDF"]
    points = group["Points"][:]
    n = len(points)
    # Hooke's law by hand with Lambda = mu = 1 (E = 2.5, nu = 1/4), strain 1e-3 (k + 1) (1, 1, 3, 1, -1/2, 0)
    stress = np.array([7, 7, 11, 2, -1, 0]) * 1e-3
    for step in range(STEPS):
        rows = slice(*(group["Steps/PointDataOffsets/displacement"][step] + np.array([0, n])))
        assert np.allclose(
            group["PointData/displacement"][rows], displacement(points, step), rtol=0, atol=1e-15
        )
        rows = slice(*(group["Steps/CellDataOffsets/stress"][step] + np.array([0, 8])))
        assert np.allclose(group["CellData/stress"][rows], (step + 1) * stress, rtol=0, atol=1e-14)
    assert len(group["PointData/displacement"]) == len(group["PointData/velocity"]) == STEPS * n
    assert len(group["CellData/stress"]) == STEPS * 8
    assert not group["Steps/CellDataOffsets/body"][:].any()


def test_step_tables(results):
    steps = results["VTKHDF/Steps"]
    assert np.allclose(steps["Values"], 0.2 * np.arange(STEPS))
    for name in ("PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"):
        assert not steps[name][:].any() and len(steps[name]) == STEPS
    assert steps["CellOffsets"].shape == steps["ConnectivityIdOffsets"].shape == (STEPS, 1)
    assert steps["NumberOfParts"][:].tolist() == [1] * STEPS
    for name in results["VTKHDF/FieldData"]:
        assert steps["FieldDataOffsets"][name][:].tolist() == list(range(STEPS))


def test_ledger(results):
    energy, momentum = results["libcontact/energy"][:], results["libcontact/momentum"][:]
    assert energy.dtype.names == ENERGY
    impulses = ("contact_impulse", "obstacle_impulse", "support_impulse")
    assert momentum.dtype.names == ("time", "body", "p", "L", *impulses)
    factor = np.arange(1, STEPS + 1)
    mass = 2 * np.array([1.5, 2])
    assert np.allclose(energy["time"], 0.2 * np.arange(STEPS))
    assert np.allclose(energy["kinetic"], 0.5 * mass.sum() * 3.5 * factor**2, rtol=1e-13)
    # sigma : epsilon = 7 + 7 + 33 + 2 (2 * 1 + 1/2), over a volume of 3.5
    assert np.allclose(energy["strain"], 0.5 * 3.5 * 52e-6 * factor**2, rtol=1e-12)
    assert momentum["body"].tolist() == [0, 1] * STEPS
    for step in range(STEPS):
        for body in range(2):
            assert np.allclose(
                momentum["p"][2 * step + body], mass[body] * velocity(step), rtol=1e-13
            )
    for name in ("kinetic", "strain", "contact", "reserve", "external", "total", "balance"):
        assert (results["VTKHDF/FieldData"][name][:] == energy[name]).all()
    assert np.allclose(
        results["VTKHDF/FieldData/momentum"], momentum["p"].reshape(STEPS, 2, 3).sum(axis=1)
    )
    assert np.allclose(
        results["VTKHDF/FieldData/angular_momentum"], momentum["L"].reshape(STEPS, 2, 3).sum(axis=1)
    )
    assert results["libcontact/step"][:].tolist() == [0, 10, 20, 30]


def test_what_the_run_was(results):
    group = results["libcontact"]
    assert (
        group.attrs["layout"] == 1
        and group.attrs["dt"] == 0.02
        and group.attrs["version"].count(b".") == 2
    )
    assert group["scene"][()].decode() == 'title = "Zwei Platten: α"\n'
    body, effects = group["body"][:], group["effects"][:]
    assert body["name"].tolist() == [b"left", b"right"] and body["kind"].tolist() == [0, 1]
    assert body["first_node"].tolist() == [0, 24] and body["node_count"].tolist() == [24, 32]
    assert body["first_cell"].tolist() == [0, 6] and body["cell_count"].tolist() == [6, 2]
    assert (
        (body["young"] == 2.5).all()
        and (body["poisson"] == 0.25).all()
        and (body["density"] == 2).all()
    )
    assert effects["name"].tolist() == [b"solid"] and effects["node_count"].tolist() == [56]
    assert group["effect"].shape == (STEPS,) and np.allclose(
        group["effect"]["energy"], group["energy"]["strain"]
    )


def test_restart_records(results):
    slots = results["libcontact/restart"]
    points = results["VTKHDF/Points"][:]
    seals = {name: slots[name]["seal"][()] for name in "ab"}
    assert [int(seals[name]["sequence"]) for name in "ab"] == [3, 4]
    for name in "ab":
        slot, seal = slots[name], seals[name]
        step = int(seal["sequence"]) - 1
        assert (
            seal["row"] == step
            and seal["step"] == 10 * step
            and np.isclose(seal["time"], 0.2 * step)
        )
        assert np.allclose(slot["displacement"], displacement(points, step), rtol=0, atol=1e-15)
        assert np.allclose(slot["velocity"], velocity(step))
        head = [
            np.array([seal[key]]) for key in ("sequence", "step", "row", "time", "kinetic_start")
        ]
        arrays = [
            slot[key][:].ravel()
            for key in ("displacement", "velocity", "work", "impulse", "memory")
        ]
        words = np.concatenate([part.view(np.uint64) for part in head + arrays])
        # Both sums modulo 2^64, which uint64 makes by itself (eq:restart-seal).
        assert words.sum() == seal["sum"]
        assert (words * np.arange(1, len(words) + 1, dtype=np.uint64)).sum() == seal["weighted"]


def test_fields_of_many_pieces_are_those_of_the_state(tmp_path):
    """Velocities and stresses are computed in pieces of 16384 rows; one piece has cells of both bodies."""
    made = scene_with(**STEEL, units=MILLIMETRES, title="pieces")
    made.add_material("wood", young=1.1e4, poisson=0.2, density=6e-10)
    for name, x, material in (("left", -1, "steel"), ("right", 1, "wood")):
        box = box_of([x, 0, 0], [1, 1, 1], [26, 26, 26])
        made.add_body(name, material=material, box=box, velocity=[1000 * x, 0, 0])
        made.add_support(f"{name}.x_min", fix=["x"])
    made.set_time(end=2e-8, fraction=0.5)
    made.set_output(fields=["displacement", "velocity", "stress"], every=10**6)
    run = made.run(output=tmp_path / "run.vtkhdf")
    read = ct.Run.load(tmp_path / "run.vtkhdf")
    for name in ("left", "right"):
        for field in ("displacement", "velocity", "stress"):
            ours, theirs = getattr(run.state[name], field), getattr(read.state[name], field)
            assert np.abs(ours).max() > 0.0
            np.testing.assert_array_equal(ours, theirs)
