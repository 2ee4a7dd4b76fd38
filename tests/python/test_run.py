"""Runs: tables, states, lines, files, restart, Ctrl-C, failures; compared with closed forms and conservation laws."""

import gc
import math
import os
import signal
import threading
from pathlib import Path

import numpy as np
import pytest
from builds import leave_out_hdf5
from libcontact._core import lib
from libcontact.mesh import Mesh
from libcontact.model import Material
from libcontact.run import Run, RunError
from libcontact.schema import SceneError
from libcontact.state import BodyState, State
from scenes import ENERGY, MILLIMETRES, box_of, same_state, scene_with

import libcontact as ct
from libcontact import loop

needs_hdf5 = pytest.mark.skipif(not ct.has("hdf5"), reason="built without HDF5")

YOUNG, POISSON, DENSITY = 2.1e5, 0.3, 7.8e-9
LAMBDA = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
MU = YOUNG / (2 * (1 + POISSON))
C1 = math.sqrt((LAMBDA + 2 * MU) / DENSITY)


def plates(cells=(8, 1, 6), **changes):
    """Two plates of steel that meet at x = 0 with 1 m/s each."""
    plate = lambda x: box_of([x, 0, 0], [2.0, 0.25, 1.5], list(cells))
    scene = {
        "units": MILLIMETRES,
        "material": [{"name": "steel", "young": YOUNG, "poisson": POISSON, "density": DENSITY}],
        "body": [
            {"name": "left", "box": plate(-2.0), "material": "steel", "velocity": [1000, 0, 0]},
            {"name": "right", "box": plate(0.0), "material": "steel", "velocity": [-1000, 0, 0]},
        ],
        "contact": [{"surfaces": ["left.x_max", "right.x_min"], "beta": 4}],
        "support": [
            {"set": f"{body}.{face}", "fix": [face[0]]}
            for body in ("left", "right")
            for face in ("y_min", "y_max", "z_min")
        ],
        "time": {"end_c1t_over": {"length": 2.0, "value": 0.9}, "courant": 0.125},
        "output": {"every": 7},
    }
    scene.update(changes)
    return ct.Scene(scene)


def bar(velocity=(-1000, 0, 0), supports=True, every=10):
    """A plate in uniaxial strain that hits the plane x = 0."""
    box = box_of([0, 0, 0], [2.0, 0.05, 0.05], [40, 1, 1])
    held = [{"set": "bar.x_min", "fix": ["x"]}]
    held += [
        {"set": f"bar.{face}", "fix": [face[0]]} for face in ("y_min", "y_max", "z_min", "z_max")
    ]
    return ct.Scene(
        {
            "units": MILLIMETRES,
            "material": [{"name": "steel", "young": YOUNG, "poisson": POISSON, "density": DENSITY}],
            "body": [{"name": "bar", "box": box, "material": "steel", "velocity": list(velocity)}],
            "support": held if supports else [],
            "time": {"end_c1t_over": {"length": 2.0, "value": 0.75}, "courant": 0.5},
            "output": {"every": every},
        }
    )


# Closed forms.


def test_a_free_body_flies_without_stress():
    run = bar(velocity=(300.0, -200.0, 100.0), supports=False).run()
    state, mass = run.state["bar"], DENSITY * 2.0 * 0.05 * 0.05
    assert np.allclose(
        state.displacement, np.array([300.0, -200.0, 100.0]) * run.state.time, rtol=1e-12
    )
    assert np.abs(state.stress).max() < 1e-9 * DENSITY * C1 * 300.0
    assert run.energy["kinetic"] == pytest.approx(
        0.5 * mass * (300**2 + 200**2 + 100**2), rel=1e-12
    )
    assert run.momentum["p"][-1] == pytest.approx(
        mass * np.array([300.0, -200.0, 100.0]), rel=1e-12
    )
    # L = p times the lever of the centre of mass, which moves along p.
    lever = np.array([1.0, 0.025, 0.025])
    assert run.momentum["L"] == pytest.approx(
        np.tile(np.cross(lever, mass * np.array([300.0, -200.0, 100.0])), (len(run.time), 1)),
        rel=1e-9,
    )


def test_a_plate_on_a_wall_gets_the_impulse_of_a_plane_wave():
    # Behind the front the stress is -rho c1 v0; the wall's impulse is rho c1 v0 A t until the front is back.
    run = bar().run()
    area, v0 = 0.05 * 0.05, 1000.0
    moved = run.momentum["support_impulse"][-1, 0]
    assert moved == pytest.approx(DENSITY * C1 * v0 * area * run.time[-1], rel=0.02)
    p = run.momentum["p"][:, 0]
    assert p[-1] - p[0] == pytest.approx(moved, rel=1e-10)
    s, stress = run.line("stress_xx", (0.0, 0.025, 0.025), (2.0, 0.025, 0.025), n=400)
    behind = s < 0.6 * C1 * run.time[-1]
    assert stress[behind].mean() == pytest.approx(-DENSITY * C1 * v0, rel=0.02)
    assert np.abs(stress[s > 1.25 * C1 * run.time[-1]]).max() < 0.01 * DENSITY * C1 * v0


def test_energy_of_a_run_without_contact_stays():
    run = bar().run()
    assert np.ptp(run.energy["total"]) < 1e-12 * run.energy["kinetic"][0]
    assert np.abs(run.energy["balance"]).max() < 1e-12 * run.energy["kinetic"][0]
    assert run.energy["strain"][-1] > 0.1 * run.energy["kinetic"][0]


def test_a_pulled_end_goes_where_it_is_pulled():
    scene = bar(velocity=(0, 0, 0)).data
    scene["support"][0] = {"set": "bar.x_max", "fix": ["x"], "velocity": [250.0, 0, 0]}
    run = ct.Scene(scene).run()
    end = run.state["bar"].nodes[:, 0] == 2.0
    assert run.state["bar"].displacement[end, 0] == pytest.approx(250.0 * run.state.time, rel=1e-12)
    # The stored and kinetic energy is the work of the pull.
    last = run.energy[-1]
    assert last["external"] == pytest.approx(
        last["kinetic"] - run.energy["kinetic"][0] + last["strain"], rel=1e-9
    )


def test_plates_that_meet_are_mirror_images_and_keep_momentum():
    run = plates().run()
    left, right = run.state["left"], run.state["right"]
    flip = lambda values: values.reshape(6, 1, 8, -1)[:, :, ::-1].reshape(48, -1)
    signs = np.array([1, 1, 1, -1, 1, -1])
    assert np.array_equal(flip(left.stress) * signs, right.stress)
    assert right.stress[:, 0].min() < -0.5 * DENSITY * C1 * 1000
    p = run.momentum["p"].reshape(-1, 2, 3).sum(axis=1)
    assert np.abs(p[:, 0]).max() < 1e-13 * DENSITY * 2.0 * 0.25 * 1.5 * 1000
    for body in ("left", "right"):
        rows = run.body_momentum(body)
        change = rows["p"] - rows["p"][0]
        assert (
            np.abs(change - rows["contact_impulse"] - rows["support_impulse"]).max()
            < 1e-12 * np.abs(change).max()
        )


def test_memory_of_a_run_is_given_back():
    """A state that outlives its problem would leak its workspace: 2 MB per run here."""
    if not os.path.exists("/proc/self/statm"):
        pytest.skip("needs /proc")

    def resident():
        gc.collect()
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    scene = plates(cells=(50, 1, 50), time={"end": 1e-8, "courant": 0.125}).data
    ct.Scene(scene).run()
    before = resident()
    for _ in range(20):
        ct.Scene(scene).run()
    assert resident() - before < 10e6


# Tables and schedule.


def test_a_row_is_recorded_at_the_start_every_so_often_and_at_the_end():
    run = plates().run()
    count = run.steps[-1]
    assert run.steps.tolist() == sorted({*range(0, count + 1, 7), count})
    assert run.time[0] == 0.0 and run.time[-1] == pytest.approx(0.9 * 2.0 / C1, rel=1e-12)
    assert run.energy.dtype.names == ENERGY
    assert run.momentum.dtype.names[:4] == ("time", "body", "p", "L") and len(
        run.momentum
    ) == 2 * len(run.energy)
    total = (
        run.energy["kinetic"]
        + run.energy["strain"]
        + run.energy["contact"]
        - run.energy["external"]
    )
    assert np.allclose(total, run.energy["total"], rtol=1e-14)


def test_times_are_recorded_at_the_nearest_steps():
    whole = plates().run()
    dt = whole.time[-1] / whole.steps[-1]
    run = plates(output={"times": [20.4 * dt, 10.6 * dt, 20.1 * dt]}).run()
    assert run.steps.tolist() == [0, 11, 20, whole.steps[-1]]
    with pytest.raises(SceneError, match="output.times"):
        plates(output={"times": [2 * whole.time[-1]]}).run()


def test_until_ends_at_the_first_step_that_is_not_before_it():
    whole = plates().run()
    dt = whole.time[-1] / whole.steps[-1]
    for until, step in (
        (10.2 * dt, 11),
        (10 * dt, 10),
        (1e-3 * dt, 1),
        (whole.time[-1], whole.steps[-1]),
    ):
        assert plates().run(until=until).steps[-1] == step
    for until in (0, -1.0, math.nan, math.inf, True, "now", 2 * whole.time[-1]):
        with pytest.raises(SceneError, match="until"):
            plates().run(until=until)


def test_threads_change_nothing():
    one, two = plates().run(threads=1), plates().run(threads=2)
    assert (
        same_state(one, two)
        and one.energy.tobytes() == two.energy.tobytes()
        and one.momentum.tobytes() == two.momentum.tobytes()
    )
    for threads in (0, True, 1.0, "2"):
        with pytest.raises(SceneError, match="threads"):
            plates().run(threads=threads)


# States and lines.


def test_states_are_read_only_views_that_stay():
    state = plates().run(until=1e-8).state
    with pytest.raises(ValueError):
        state["left"].displacement[0, 0] = 1.0
    displacement = state["left"].displacement
    assert displacement.dtype == np.float64 and displacement.base is not None
    before = displacement.copy()
    del state
    plates().run(until=1e-8)
    assert np.array_equal(displacement, before)
    with pytest.raises(KeyError, match='did you mean "left"'):
        plates().run(until=1e-8).state["lfet"]


def linear_state(element):
    """A state of constant strain, with the stress of Hooke's law worked out by hand."""
    mesh = Mesh.box(element, (0, 0, 0), (2, 1, 1), (4, 2, 2))
    gradient = np.array([[1e-3, 2e-3, 0], [0, -5e-4, 1e-3], [3e-3, 0, 2e-4]])
    strain = (gradient + gradient.T) / 2
    stress = LAMBDA * np.trace(strain) * np.eye(3) + 2 * MU * strain
    state = BodyState(
        "block",
        mesh,
        Material(name="steel", young=YOUNG, poisson=POISSON, density=DENSITY),
        displacement=mesh.nodes @ gradient.T,
        velocity=mesh.nodes @ gradient.T * 7,
    )
    return state, gradient, stress


@pytest.mark.parametrize("element", ["hex8", "hex20"])
def test_a_linear_field_is_sampled_exactly(element):
    state, gradient, stress = linear_state(element)
    energy = np.zeros(1, loop.ENERGY)
    run = Run(
        bodies=["block"],
        units=None,
        steps=[0],
        energy=energy,
        momentum=np.zeros(0, loop.MOMENTUM),
        state=State(0.0, 0, {"block": state}),
    )
    start, end = np.array([0.1, 0.2, 0.3]), np.array([1.7, 0.9, 0.5])
    s, u = run.line("displacement_y", start, end, n=11)
    points = start + np.linspace(0, 1, 11)[:, None] * (end - start)
    assert np.allclose(s, np.linalg.norm(points - start, axis=1), rtol=1e-14)
    assert np.allclose(u, (points @ gradient.T)[:, 1], rtol=1e-12)
    assert np.allclose(
        run.line("velocity_z", start, end, n=11)[1], 7 * (points @ gradient.T)[:, 2], rtol=1e-12
    )
    assert np.allclose(
        run.line("velocity_z", end, start, n=11)[1][::-1],
        run.line("velocity_z", start, end, n=11)[1],
        rtol=1e-14,
    )
    for name, value in zip(
        ("xx", "yy", "zz", "xy", "yz", "zx"), stress[[0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]
    ):
        assert np.allclose(run.line(f"stress_{name}", start, end, n=5)[1], value, rtol=1e-9)


def test_lines_outside_are_nan_and_bad_lines_are_refused():
    run = plates().run(until=1e-8)
    s, values = run.line("stress_xx", (-3, 0.1, 0.1), (3, 0.1, 0.1), n=7)
    assert np.isnan(values[[0, 6]]).all() and np.isfinite(values[1:6]).all() and s[-1] == 6.0
    assert np.isnan(
        run.line("stress_xx", (-1, 0.1, 0.1), (-0.5, 0.1, 0.1), n=3, body="right")[1]
    ).all()
    for arguments in (
        ("stress_xq", (0, 0, 0), (1, 0, 0)),
        ("stress_xx", (0, 0), (1, 0, 0)),
        ("stress_xx", (0, 0, math.nan), (1, 0, 0)),
        ("stress_xx", (0, 0, 0), (1, 0, 0), 0),
        ("stress_xx", (0, 0, 0), (1, 0, 0), 2.0),
    ):
        with pytest.raises(ValueError):
            run.line(*arguments)


# Files, restart, interruption.


@needs_hdf5
def test_a_run_that_was_saved_is_the_run_that_is_loaded(tmp_path):
    run = plates().run(output=tmp_path / "a.vtkhdf")
    loaded = Run.load(tmp_path / "a.vtkhdf")
    assert (
        same_state(run, loaded)
        and loaded.bodies == ["left", "right"]
        and loaded.units.label("stress") == "MPa"
    )
    for table in ("energy", "momentum", "steps"):
        assert getattr(run, table).tobytes() == getattr(loaded, table).tobytes()
    run.save(tmp_path / "b.vtkhdf")
    assert (tmp_path / "b.vtkhdf").read_bytes() == (tmp_path / "a.vtkhdf").read_bytes()
    early = Run.load(tmp_path / "a.vtkhdf", record=0)
    assert early.state.time == 0.0 and not early.state["left"].displacement.any()
    with pytest.raises(ValueError, match="no record|none with the number"):
        Run.load(tmp_path / "a.vtkhdf", record=1000)


@needs_hdf5
def test_a_run_in_memory_is_saved_with_its_tables(tmp_path):
    run = plates().run()
    run.save(tmp_path / "later.vtkhdf")
    loaded = Run.load(tmp_path / "later.vtkhdf")
    assert same_state(run, loaded) and run.energy.tobytes() == loaded.energy.tobytes()
    assert run.momentum.tobytes() == loaded.momentum.tobytes() and len(loaded.time) == len(run.time)
    part = plates().run(until=0.4 * run.time[-1])
    part.save(tmp_path / "part.vtkhdf")
    assert same_state(run, plates().run(restart=tmp_path / "part.vtkhdf"))
    with pytest.raises(OSError, match="none"):
        run.save(tmp_path / "none" / "later.vtkhdf")


@needs_hdf5
@pytest.mark.parametrize("end, part", [(0.9, 0.4), (2.4, 0.4), (2.4, 0.879)])
def test_a_restarted_run_ends_with_the_same_bits(tmp_path, end, part):
    """In contact, and while points give back what they hold; the rest with other threads."""
    made = lambda: plates(time={"end_c1t_over": {"length": 2.0, "value": end}, "courant": 0.125})
    whole = made().run()
    path = tmp_path / "first.vtkhdf"
    first = made().run(until=part * whole.time[-1], output=path)
    held = first.energy["reserve"]
    assert held[-1] > 0.0 and (held[-1] < 0.9 * held.max()) == (part > 0.8)
    rest = made().run(restart=path, output=tmp_path / "rest.vtkhdf", threads=2)
    assert same_state(whole, rest)
    shared, own = np.isin(whole.steps, rest.steps), np.isin(rest.steps, whole.steps)
    assert shared.sum() > 2 and whole.energy[shared].tobytes() == rest.energy[own].tobytes()
    assert rest.time[0] == pytest.approx(
        part * whole.time[-1], abs=whole.time[-1] / whole.steps[-1]
    )


@needs_hdf5
@pytest.mark.parametrize(
    "layout, why", [(None, "of version 0.1"), (1, "older than the key restitution")]
)
def test_a_file_of_an_older_library_is_read_and_its_run_not_continued(tmp_path, layout, why):
    h5py = pytest.importorskip("h5py")
    old = tmp_path / "old.vtkhdf"
    plates().run(until=1e-8, output=old)
    with h5py.File(old, "r+") as file:
        del file["libcontact"].attrs["restart_layout"]
        if layout is not None:
            file["libcontact"].attrs["restart_layout"] = layout
    assert ct.Run.load(old).time[-1] > 0
    with pytest.raises(SceneError, match=f"{why}: its results can be read, but its run can't be"):
        plates().run(restart=old)


@needs_hdf5
def test_a_restart_from_another_scene_or_over_its_own_file_is_refused(tmp_path):
    first = tmp_path / "first.vtkhdf"
    plates().run(until=1e-8, output=first)
    other = plates().data
    other["contact"][0]["beta"] = 3
    with pytest.raises(SceneError, match="contact"):
        ct.Scene(other).run(restart=first)
    with pytest.raises(SceneError, match="restart"):
        plates().run(restart=first, output=first)
    with pytest.raises(SceneError, match="no such file"):
        plates().run(restart=tmp_path / "none.vtkhdf")
    (tmp_path / "text.vtkhdf").write_text("no HDF5")
    with pytest.raises(SceneError, match="text.vtkhdf"):
        plates().run(restart=tmp_path / "text.vtkhdf")


@pytest.mark.parametrize("with_file", [False, pytest.param(True, marks=needs_hdf5)])
def test_ctrl_c_ends_the_run_and_keeps_what_there_is(with_file, tmp_path):
    path = tmp_path / "cut.vtkhdf" if with_file else False
    scene = plates(time={"end": 1.0, "courant": 0.125}, output={"every": 50})
    timer = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
    # A shell starts background jobs with Ctrl-C switched off, and the tests inherit that: switch it on for this one.
    inherited = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        run = scene.run(output=path, watch=lambda record: record.steps[-1] or timer.start())
        timer.join()
        assert run.interrupted and signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, inherited)
    assert 0 < run.steps[-1] and run.time[-1] < 1.0
    if with_file:
        assert same_state(run, Run.load(path))


@pytest.mark.parametrize(
    "output, reason",
    [("none/a.vtkhdf", "No such file"), (".", "directory"), (3, "path"), ("ro/a.vtkhdf", "denied")],
)
@needs_hdf5
def test_an_output_that_cannot_be_written_is_refused_before_the_run(
    output, reason, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ro").mkdir(mode=0o500)
    if reason == "denied" and os.access(tmp_path / "ro", os.W_OK):
        pytest.skip("this user may write everywhere")
    with pytest.raises(SceneError, match=f"(?i){reason}") as caught:
        plates().run(output=output)
    assert caught.value.key == "output.file"


@needs_hdf5
def test_a_device_is_no_results_file(tmp_path):
    with pytest.raises(SceneError, match="output.file"):
        plates().run(output="/dev/full")


def test_without_hdf5_the_run_says_so_and_stays_in_memory(tmp_path, monkeypatch):
    leave_out_hdf5(monkeypatch)
    with pytest.warns(ct.SceneWarning, match="output: .* no HDF5"):
        run = plates().run(until=1e-8, output=tmp_path / "a.vtkhdf")
    assert run.path is None and run.steps[-1] > 0 and not list(tmp_path.iterdir())


def test_files_that_are_no_runs_are_refused(tmp_path):
    h5py = pytest.importorskip("h5py")
    h5py.File(tmp_path / "empty.vtkhdf", "w").close()
    (tmp_path / "text.vtkhdf").write_text("no HDF5")
    for name in ("empty.vtkhdf", "text.vtkhdf", "none.vtkhdf"):
        with pytest.raises(ValueError, match=name):
            Run.load(tmp_path / name)


# Failures.


class Poisoned:
    """The C library, with a NaN in the motion from the third chunk of steps on."""

    def __init__(self):
        self.calls = 0

    def __getattr__(self, name):
        return getattr(lib, name)

    def ct_run(self, problem, state, *rest):
        self.calls += 1
        if self.calls == 3:
            state.velocity[4] = math.nan
        return lib.ct_run(problem, state, *rest)


@pytest.mark.parametrize("with_file", [False, pytest.param(True, marks=needs_hdf5)])
def test_a_run_that_blows_up_names_the_body_and_keeps_the_last_good_state(
    with_file, tmp_path, monkeypatch
):
    monkeypatch.setattr(loop, "lib", Poisoned())
    with pytest.raises(RunError, match="bar") as caught:
        bar(every=1).run(output=tmp_path / "up.vtkhdf" if with_file else False)
    run = caught.value.run
    assert run.steps.tolist() == [0, 1, 2] and run.state.step == 2
    assert np.isfinite(run.state["bar"].displacement).all() and run.state["bar"].displacement.any()
    assert np.isfinite(run.energy["total"]).all()


def test_an_energy_that_does_not_fit_a_number_is_refused_before_the_run():
    with pytest.raises(ct.SceneError, match="finite"):
        bar(velocity=(-1e200, 0, 0)).run()


def test_the_progress_bar_goes_to_stderr_when_it_is_wanted(capsys):
    plates().run(progress="always")
    out, err = capsys.readouterr()
    assert "steps" in err and not out
    plates().run(progress=True)
    plates().run()
    assert capsys.readouterr() == ("", "")


def test_contact_points_are_seen():
    """Two blocks pressed together: gaps are negative where the pressure is, and pressure times weight is the force of
    both passes."""
    scene = scene_with("soft", young=1.0, poisson=0.0, density=1.0, title="blocks")
    for name, origin, velocity in (("left", -2.0, 0.1), ("right", 0.0, -0.1)):
        scene.add_body(
            name,
            material="soft",
            box=box_of([origin, 0, 0], [2, 1, 1], [8, 2, 2]),
            velocity=[velocity, 0, 0],
        )
    scene.add_contact("left.x_max", "right.x_min", beta=1, enforcement="penalty")
    pressures = []
    for end in np.linspace(0.5, 3.5, 13):
        scene.set_time(end=float(end), fraction=0.5)
        (points,) = scene.run().contact
        assert len(points) == 2 * 4 * 4 and set(points["side"]) == {0, 1}
        assert np.all(points["gap"] < 0)
        epsilon = scene.explain().data["contacts"][0]["epsilon"]
        np.testing.assert_allclose(points["raw_pressure"], -epsilon * points["gap"], rtol=1e-14)
        np.testing.assert_allclose(
            np.linalg.norm(points["closest"] - points["position"], axis=1),
            -points["gap"],
            rtol=1e-9,
        )
        pressures.append(np.average(points["raw_pressure"], weights=points["weight"]))
    # Two equal bars have the pressure rho c v = 0.1 until the waves return at t = 4; the penalty oscillates about it.
    assert abs(np.mean(pressures) - 0.1) < 0.01


def test_a_run_with_proven_projections_meets_the_same_faces():
    """Every step of an impact of two plates with ``certified``: the same contact set and the same bits as with
    ``robust``."""
    runs = {}
    for method in ("robust", "certified"):
        data = ct.Scene.load(
            Path(__file__).parents[2] / "tutorials" / "scenes" / "plates.toml"
        ).data
        for body in data["body"]:
            body["box"]["cells"] = [20, 1, 20]
        data["contact"][0]["method"] = method
        runs[method] = ct.Scene(data).run(output=False)
    robust, certified = (runs[m].contact[0] for m in ("robust", "certified"))
    assert np.array_equal(robust["other"], certified["other"]) and np.any(robust["gap"] < 0)
    np.testing.assert_allclose(robust["gap"], certified["gap"], rtol=1e-9, equal_nan=True)
