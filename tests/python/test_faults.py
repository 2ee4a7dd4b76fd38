"""Faults during a run: each is an exception of its own class that names time, body and place; the last good state is
kept, on disk if there is a file, and can be continued."""

import math
import tomllib
import warnings

import kill
import numpy as np
import pytest
from libcontact._core import ffi, lib
from libcontact.mesh import Mesh
from libcontact.run import Run, RunError
from libcontact.state import State
from scenes import box_of, same_state, scene_with

import libcontact as ct
from libcontact import loop

needs_hdf5 = pytest.mark.skipif(not ct.has("hdf5"), reason="built without HDF5")
with_and_without_file = pytest.mark.parametrize(
    "with_file", [False, pytest.param(True, marks=needs_hdf5)]
)


def bars(law="linear", **time):
    """A bar that is fixed at x = 0 and pulled at x = 10, and another one at rest; ν = 0, c = 1."""
    scene = scene_with("rubber", young=2.0, poisson=0.0, density=2.0, law=law, title="bars")
    for name, y in (("other", 5.0), ("bar", 0.0)):
        scene.add_body(name, material="rubber", box=box_of([0, y, 0], [10, 1, 1], [10, 1, 1]))
    scene.add_support("bar.x_min", fix=["x"]).add_support(
        "bar.x_max", fix=["x"], velocity=[0.02, 0, 0]
    )
    return scene.set_time(**{"end": 400.0, "courant": 0.9, "look_every": 4, **time})


class Twisted:
    """The C library, with the motion disturbed before the steps that begin at step 40."""

    def __init__(self, twist):
        self.twist, self.done = twist, False

    def __getattr__(self, name):
        return getattr(lib, name)

    def ct_run(self, problem, state, count, observers, number, error):
        before = 40 - state.step
        if 0 < before < count:
            alone = ffi.new("ct_observer[]", [observers[i] for i in range(number)])
            alone[0].last = 0
            status = lib.ct_run(problem, state, before, alone, number, error)
            return status or self.ct_run(problem, state, count - before, observers, number, error)
        if before <= 0 and not self.done:
            self.done = True
            self.twist(state)
        return lib.ct_run(problem, state, count, observers, number, error)


def not_finite(state):
    state.velocity[200] = math.nan


def inside_out(state):
    for node in range(44, 88):
        state.velocity[3 * node] += 100.0 * (-1) ** node


def faster(state):
    for i in range(3 * 44, 3 * 88):
        state.velocity[i] *= 30.0 if state.problem.inverse_mass[i] > 0.0 else 1.0


def failing(scene, kind, tmp_path, with_file, **how):
    """The error of a run, which names its file if and only if it has one."""
    path = tmp_path / "run.vtkhdf"
    with pytest.raises(kind) as caught:
        scene.run(output=path if with_file else False, **how)
    error = caught.value
    assert isinstance(error, (RunError, ct.Error)) and error.time == pytest.approx(
        error.step * error.run.dt
    )
    assert error.checkpoint == (path if with_file else None)
    assert (str(path) in str(error)) == with_file and "last good state" in str(error)
    good = error.run.state
    assert isinstance(good, State) and good.step <= error.step
    assert all(
        np.isfinite(good[body].displacement).all() and np.isfinite(good[body].velocity).all()
        for body in good
    )
    return error


def goes_on(scene, error, tmp_path, until):
    """The file of a fault opens, contains the last good state, and continues to the same bits as an undisturbed run."""
    loaded = Run.load(error.checkpoint)
    assert loaded.state.step == error.run.state.step == loaded.steps[-1] == error.run.steps[-1]
    rest = scene.run(restart=error.checkpoint, output=tmp_path / "rest.vtkhdf", until=until)
    straight = scene.run(output=False, until=until)
    assert same_state(rest, straight)


@with_and_without_file
@pytest.mark.parametrize(
    ("twist", "law", "kind", "also"),
    [
        (not_finite, "linear", ct.NotFinite, ct.BlowupError),
        (inside_out, "neo_hookean", ct.InvertedElement, ct.GeometryError),
        (faster, "linear", ct.EnergyBlowup, ct.EnergyError),
    ],
)
def test_a_fault_has_a_name_and_the_run_goes_on_from_before_it(
    twist, law, kind, also, with_file, tmp_path, monkeypatch
):
    scene = bars(law)
    with monkeypatch.context() as patch:
        patch.setattr(loop, "lib", Twisted(twist))
        error = failing(scene, kind, tmp_path, with_file, until=100.0)
    assert (
        isinstance(error, also)
        and isinstance(error, RunError)
        and error.body_name == "bar"
        and error.body == 1
    )
    assert 40 < error.step <= 104 and error.run.state.step == 40
    assert (error.element is not None) == (kind is ct.InvertedElement) == (error.node is None)
    if with_file:
        goes_on(scene, error, tmp_path, 100.0)


@with_and_without_file
def test_a_solid_that_stiffens_ends_a_run_that_may_not_divide_its_step(
    with_file, tmp_path, monkeypatch
):
    """
    The pulled end sends a wave through the bar; St. Venant-Kirchhoff's tangent is E (3 λ² - 1) / 2, so that Courant
    number 0.9 of the start is too much from a stretch of λ² = (2 / 0.9² + 1) / 3 on, which is 1.075 (a little more with
    held ends).
    """
    monkeypatch.setattr(loop, "MOST_PARTS", 1)
    scene = bars("st_venant_kirchhoff")
    error = failing(scene, ct.StepTooLarge, tmp_path, with_file)
    assert isinstance(error, ct.StepError) and error.body_name == "bar" and 0 <= error.element < 10
    good = error.run.state["bar"]
    x = np.unique(np.round(good.positions[:, 0], 9))
    assert len(x) == 11 and 1.07 < np.diff(x).max() < 1.15
    assert 0 <= error.step - good_step(error) <= 4
    assert "choose a smaller step" in str(error)
    if with_file:
        goes_on(scene, error, tmp_path, good_step(error) * error.run.dt)


@needs_hdf5
def test_a_run_whose_step_was_too_large_goes_on_with_a_smaller_one(tmp_path, monkeypatch):
    """With a third of the step the run continues beyond the stretch that ended it; it agrees with a run with this step
    from the start, within the error of the larger step."""
    monkeypatch.setattr(loop, "MOST_PARTS", 1)
    error = failing(bars("st_venant_kirchhoff"), ct.StepTooLarge, tmp_path, True)
    finer, until = bars("st_venant_kirchhoff", courant=0.31), 1.3 * error.time
    rest = finer.run(restart=error.checkpoint, output=tmp_path / "rest.vtkhdf", until=until)
    assert (
        rest.dt == error.run.dt / 3
        and rest.steps[0] == 3 * good_step(error)
        and rest.time[0] == pytest.approx(error.run.state.time, rel=1e-15)
    )
    scale = rest.energy["kinetic"].max()
    assert np.abs(rest.energy["balance"]).max() < 1e-10 * scale
    assert abs(rest.energy["strain"][0] - error.run.energy["strain"][-1]) < 1e-12 * scale
    # The file has the new step, and a second run that only continues has the same bits.
    loaded = Run.load(tmp_path / "rest.vtkhdf")
    assert loaded.dt == rest.dt and tomllib.loads(loaded.scene)["time"]["courant"] == 0.31
    part = finer.run(
        restart=error.checkpoint, output=tmp_path / "part.vtkhdf", until=1.1 * error.time
    )
    again = finer.run(restart=part.path, output=False, until=until)
    assert again.state["bar"].displacement.tobytes() == rest.state["bar"].displacement.tobytes()
    straight = bars("st_venant_kirchhoff", courant=0.3).run(output=False, until=until)
    off = (
        np.abs(rest.state["bar"].displacement - straight.state["bar"].displacement).max()
        / np.abs(straight.state["bar"].displacement).max()
    )
    assert off < 0.03
    # A larger step is refused, and everything else must be the same.
    with pytest.raises(ct.SceneError, match="only a smaller step is possible"):
        bars("st_venant_kirchhoff", courant=0.5).run(restart=tmp_path / "rest.vtkhdf", output=False)
    with pytest.raises(ct.SceneError, match="another scene"):
        bars("neo_hookean", courant=0.3).run(restart=error.checkpoint, output=False)


def good_step(error):
    return error.run.state.step


# A step that is divided in the run.


def test_a_run_divides_its_step_where_the_solid_stiffens():
    """At the stretch of the test above the step is halved, with one warning; the end agrees with a run with half of the
    step from the start."""
    scene = bars("st_venant_kirchhoff", end=60.0)
    with pytest.warns(ct.StepDivided) as told:
        run = scene.run(output=False)
    (time, parts), *more = run.divisions
    first = scene._built(None).dt
    assert parts == 2 and not more and run.dt == first / 2 and len(told) == 1
    assert told[0].message.parts == 2 and told[0].message.time == time
    assert f"the time step {first:.6g} is divided by 2" in str(told[0].message)
    assert run.time[-1] == pytest.approx(60.0) and (np.diff(run.time) > 0.0).all()
    np.testing.assert_allclose(np.diff(run.time)[:-1], run.time[1], rtol=1e-9)
    # Before the change the forces of the records are those of the larger step, afterwards the balance goes on.
    assert np.abs(run.energy["balance"]).max() < 1e-10 * run.energy["kinetic"].max()
    straight = bars("st_venant_kirchhoff", end=60.0, courant=0.45).run(output=False)
    off = run.state["bar"].displacement - straight.state["bar"].displacement
    assert np.abs(off).max() < 0.03 * np.abs(straight.state["bar"].displacement).max()


def guarded(most, start, refused):
    """A block in free flight whose own effect refuses steps above ``most`` from ``start`` on, before they are taken."""

    def force(view):
        if view.time >= start and view.dt > most:
            refused.append((view.time, view.dt))
            raise ct.StepError("this step is too long", int(lib.CT_ERROR_STEP))
        return np.zeros_like(view.displacement)

    scene = scene_with("m", young=1.0, poisson=0.0, density=1.0, title="guard")
    box = box_of([0, 0, 0], [1, 1, 1], [2, 1, 1])
    scene.add_body("b", material="m", box=box, velocity=[0.1, 0, 0])
    return scene.set_time(end=10.0, dt=0.25).add_effect("guard", "b", "x_max", force)


@pytest.mark.parametrize("start", [0.0, 0.25, 4.9])
def test_an_effect_may_refuse_a_step_at_any_time(start):
    """Also the first step of all; the run goes on with a step that the effect accepts, and output times stay."""
    refused = []
    scene = guarded(0.04, start, refused).set_output(every=5)
    with pytest.warns(ct.StepDivided, match="this step is too long|the first step is too large"):
        run = scene.run(output=False)
    assert run.dt == 0.25 / 8 and [parts for _, parts in run.divisions] == [2, 4, 8]
    assert all(max(0.0, start - 0.5) <= time <= start for time, _ in run.divisions)
    np.testing.assert_allclose(run.time, np.arange(9) * 1.25, rtol=1e-15)
    np.testing.assert_allclose(run.state["b"].displacement[:, 0], 1.0, rtol=1e-12)
    assert refused


def test_energy_that_a_divided_step_shows_counts_as_growth():
    """A block held at one end vibrates near the limit of its step; the smaller step shows all of that energy,
    :eq:`divided-energy`, and the total is constant before and after it."""
    scene = guarded(0.3, 2.0, []).add_support("b.x_min", fix="x").set_time(end=10.0, dt=0.49)
    with pytest.warns(ct.EnergyGrowth) as told, pytest.warns(ct.StepDivided):
        run = scene.run(output=False)
    total = run.energy["total"]
    (growth,) = [one.message for one in told if isinstance(one.message, ct.EnergyGrowth)]
    assert growth.ratio == pytest.approx(total[-1] / total[0] - 1, rel=1e-9) and growth.ratio > 0.02
    assert growth.who == 'body "b"'


def test_a_step_that_is_refused_at_any_length_ends_the_run():
    with (
        pytest.warns(ct.StepDivided),
        pytest.raises(ct.StepTooLarge, match="already divided by 1024") as caught,
    ):
        guarded(0.0, 4.9, []).run(output=False)
    assert 4.0 < caught.value.run.state.time < 5.0


@needs_hdf5
@pytest.mark.parametrize("integrator", ["central_difference", "noh_bathe", "chung_lee"])
@pytest.mark.parametrize("every", [1, 7, 10**6])
def test_a_divided_run_that_is_continued_has_the_same_bits(integrator, every, tmp_path):
    """Two plates so fast that one would pass through the other in a step: stopped before, at and after the division, at
    any record."""
    scene = bullet(integrator, every)
    whole = scene.run(output=tmp_path / "whole.vtkhdf")
    assert whole.divisions and whole.dt < scene._built(None).dt / 8
    loaded = Run.load(tmp_path / "whole.vtkhdf")
    assert loaded.dt == whole.dt and loaded.state.time == whole.time[-1]
    np.testing.assert_array_equal(loaded.time, whole.time)
    for i, until in enumerate((0.1, 0.37, 0.7)):
        part, rest = tmp_path / f"{i}.vtkhdf", tmp_path / f"{i}rest.vtkhdf"
        first = scene.run(until=until, output=part)
        assert Run.load(part).dt == first.dt
        then = scene.run(until=0.8, restart=part, output=rest)
        last = scene.run(restart=rest, output=False)
        assert same_state(whole, last)
        assert set(then.time[1:]) <= set(whole.time) | {then.time[-1]}
        for name in ("displacement", "velocity"):
            np.testing.assert_array_equal(whole.probes["p"][name], last.probes["p"][name])


def bullet(integrator="central_difference", every=1):
    """A thin plate hits another one at 20 times the speed of sound, at t = 0.3."""
    scene = scene_with("m", young=1.0, poisson=0.3, density=1.0, title="bullet")
    for name, x in (("left", -0.05), ("right", 6.0)):
        scene.add_body(
            name,
            material="m",
            box=box_of([x, 0, 0], [0.05, 1, 1], [1, 2, 2]),
            velocity=[0.0 if name == "left" else -20.0, 0, 0],
        )
    scene.add_contact("left.outer", "right.outer")
    scene.add_probe(
        "p", body="right", point=[6.0, 0.5, 0.5], quantities=["displacement", "velocity"], every=2
    )
    return scene.set_time(end=1.0, fraction=0.9, integrator=integrator).set_output(every=every)


def test_the_watch_changes_no_bit():
    """Of blocks with large strain that collide with friction."""
    runs = []
    for every in (3, 10**6):
        data = kill.scene().data
        data["time"]["look_every"], data["output"]["every"] = every, 10**6
        runs.append(ct.Scene(data).run(output=False))
    assert same_state(*runs) and runs[0].energy.tobytes() == runs[1].energy.tobytes()
    assert np.abs(runs[0].momentum["contact_impulse"]).max() > 0.0


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("energy_limit", 0.0),
        ("energy_limit", -1.0),
        ("look_every", 0),
        ("look_every", 2.5),
        ("energy_limit", "much"),
    ],
)
def test_bad_keys_of_the_watch_are_refused(key, value):
    with pytest.raises(ct.SceneError, match=key):
        bars(**{key: value})


# Growth below the limit of a fault.


def flying(force, stores=True):
    """A block in free flight, and a force of the user on all its nodes."""
    scene = scene_with("soft", young=2.0, poisson=0.3, density=1.5, title="flying")
    scene.add_body(
        "block", material="soft", box=box_of([0, 0, 0], [1, 1, 1], [1, 1, 1]), velocity=[1, 0, 0]
    )
    scene.add_effect(
        "pump", "block", list(range(8)), force, energy=(lambda view: 0.0) if stores else None
    )
    return scene.set_time(end=20.0, fraction=0.2, look_every=2)


def pump(view):
    """A force c m v, by which the kinetic energy grows as exp(2 c t), and which from t = 5 on removes more than it
    gave."""
    return (0.01 if view.time < 5.0 else -0.05) * 1.5 / 8.0 * view.velocity


def grown(scene, **how):
    """The warnings of growth in a run that completes."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        scene.run(output=False, **how)
    return [warning for warning in told if issubclass(warning.category, ct.EnergyGrowth)]


def test_growth_is_told_at_once_and_at_the_end_though_it_is_gone():
    told = grown(flying(pump))
    assert len(told) == 2 and told[0].filename == told[1].filename == __file__
    warning, last = told[0].message, told[1].message
    assert last.ratio == pytest.approx(math.expm1(0.1), rel=0.05) and "at most" in str(last)
    when = math.log(1.002) / 0.02
    assert (
        0.002 < warning.ratio < 0.01
        and when < warning.time < when + 1.0
        and warning.who == 'effect "pump"'
    )
    assert f"t = {warning.time:.6g}" in str(warning) and "smaller step" in str(warning)
    assert not grown(flying(pump, stores=False))


@pytest.mark.parametrize("where", ["obstacle", "contact"])
def test_growth_names_the_contact_that_makes_it(where):
    """An explicit penalty, too stiff for its step, feeds energy into a bar that hits a wall or an equal bar."""
    bar = lambda x: box_of([x, 0, 0], [10, 0.2, 0.2], [50, 1, 1])
    scene = scene_with("m", young=900.0, poisson=0.0, density=1.0, title="bars").add_body(
        "bar", material="m", box=bar(0.05), velocity=[-10, 0, 0]
    )
    stiff = {"beta": 10, "enforcement": "penalty"}
    if where == "obstacle":
        scene.add(
            "obstacle",
            surface="bar.x_min",
            plane={"point": [0, 0, 0], "normal": [1, 0, 0]},
            **stiff,
        )
    else:
        scene.add_body("twin", material="m", box=bar(-10.05), velocity=[10, 0, 0]).add_contact(
            "bar.x_min", "twin.x_max", **stiff
        )
    told = grown(scene.set_time(end=0.5, fraction=0.7, look_every=4))
    who = {"obstacle": "obstacle at bar.x_min", "contact": "contact bar.x_min with twin.x_max"}
    assert [each.message.who for each in told] == 2 * [who[where]]
    assert "energy_controlled" in str(told[0].message)


def test_growth_of_a_solid_names_the_body(monkeypatch):
    growth = ffi.new(
        "ct_growth *",
        {"ratio": 0.02, "largest": 0.04, "time": 3.0, "step": 7, "effect": 0, "body": 1},
    )

    class Told(Twisted):
        def ct_monitor_growth(self, watch):
            return growth[0]

    monkeypatch.setattr(loop, "lib", Told(lambda state: None))
    told = grown(bars(), until=20.0)
    assert (
        len(told) == 1
        and told[0].message.who == 'body "bar"'
        and "courant = 0.45 leaves a quarter" in str(told[0].message)
        and "2 % more energy" in str(told[0].message)
        and "t = 3 (step 7)" in str(told[0].message)
    )


def test_what_comes_in_from_outside_is_no_growth():
    """A moving ball, a moving support, a load that is switched on, weight, friction and dampers."""
    scene = scene_with("m", young=100.0, poisson=0.3, density=1.0, title="outside")
    scene.add_body("floor", material="m", box=box_of([-1, -1, -1], [3, 3, 1], [4, 4, 2]))
    scene.add_body("block", material="m", box=box_of([0, 0, 0], [1, 1, 1], [3, 3, 3]))
    scene.add_contact("floor.z_max", "block.z_min", friction=0.3).add_support(
        "floor.z_min", fix="xyz", velocity=[0.1, 0, 0]
    )
    scene.add(
        "obstacle",
        surface="block.z_max",
        sphere={"centre": [0.5, 0.5, 3.0], "radius": 2.0},
        travel=[0, 0, -0.05],
        history={"time": [0, 0.5, 0.6, 1], "value": [0, 1, 1, 0]},
    )
    scene.add(
        "load",
        surface="block.x_min",
        pressure=1.0,
        history={"time": [0, 0.2, 0.3, 2], "value": [0, 0, 1, 1]},
    )
    scene.add("gravity", acceleration=[0, 0, -5.0])
    assert not grown(scene.set_time(end=1.0, fraction=0.8, look_every=1))


# Bodies at rest.


def turned(seed):
    """A random rotation."""
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    return q * np.linalg.det(q)


@pytest.mark.parametrize("what", ["later load", "plane", "fixed body"])
def test_rest_is_no_fault_whatever_its_orientation(what):
    """Two blocks whose faces touch, or one on an inclined plane or on a fixed block, with almost no weight: round-off
    must not count as energy. Each report is an error."""
    for seed in range(8):
        axes, place = turned(seed), np.random.default_rng(seed).uniform(-3, 3, 3)
        scene = scene_with(
            "m",
            young=2e5 if seed % 2 else 1.0,
            poisson=0.3,
            density=1e-8 if seed % 2 else 1.0,
            title="rest",
        )
        duration = math.sqrt(1e-8 / 2e5) if seed % 2 else 1.0
        for name, z in (("lower", 0.0), ("upper", 1.0)):
            mesh = Mesh.box("hex8", (0, 0, z), (1, 1, 1), (2, 2, 2))
            if name == "upper" or what != "plane":
                scene.add_body(
                    name, material="m", nodes=mesh.nodes @ axes.T + place, elements=mesh.elements
                )
        if what == "plane":
            scene.add(
                "obstacle",
                surface="upper.outer",
                plane={"point": (place + axes[:, 2]).tolist(), "normal": axes[:, 2].tolist()},
            )
        else:
            scene.add_contact("lower.outer", "upper.outer")
        if what == "fixed body":
            scene.add_support("lower.outer", fix="xyz")
        if what == "later load":
            scene.add(
                "load",
                surface="upper.outer",
                pressure=1e-3 * (2e5 if seed % 2 else 1.0),
                history={"time": [0, duration, 2 * duration], "value": [0, 0, 1]},
            )
        else:
            small = 1e-12 / duration**2
            scene.add(
                "gravity",
                acceleration=(small * (0.1 * axes[:, 0] - axes[:, 2])).tolist(),
                bodies=["upper"],
            )
        scene.set_time(end=1.5 * duration, fraction=0.8).set_output(every=1)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.filterwarnings("ignore", "units:")
            scene.run(output=False)


# Distorted meshes.


def distorted(amount, seed):
    """A block of unit cubes with its inner nodes moved at random by up to ``amount`` in each direction."""
    mesh, rng = Mesh.box("hex8", [0, 0, 0], [5, 5, 5], [5, 5, 5]), np.random.default_rng(seed)
    nodes = mesh.nodes.copy()
    inner = ((nodes > 0) & (nodes < 5)).all(1)
    nodes[inner] += rng.uniform(-amount, amount, (inner.sum(), 3))
    return nodes, mesh.elements


def worst_determinants(nodes, cells):
    """Smallest Jacobian determinant at the corners of each element, from the definition of the trilinear map."""
    square = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    signs = np.array([(*side, z) for z in (-1, 1) for side in square])
    out = np.full(len(cells), np.inf)
    for xi in signs:
        factor = 1 + signs * xi
        gradient = np.stack(
            [signs[:, i] * np.prod(np.delete(factor, i, 1), 1) / 8 for i in range(3)], 1
        )
        out = np.minimum(out, np.linalg.det(np.einsum("eac,ai->eci", nodes[cells], gradient)))
    return out


@pytest.mark.parametrize("seed", range(3))
def test_a_mesh_distorted_a_little_runs_and_one_distorted_much_is_refused_by_name(seed):
    def scene(amount):
        nodes, cells = distorted(amount, seed)
        out = scene_with("soft", young=2.0, poisson=0.3, density=1.0, title="distorted")
        return out.add_body(
            "block", material="soft", nodes=nodes, elements=cells, velocity=[0.1, 0.0, 0.0]
        ).set_time(end=1.0, fraction=0.9), worst_determinants(nodes, cells)

    good, det = scene(0.2)
    assert (det > 0).all() and good.run(output=False).state.time == pytest.approx(1.0)
    bad, det = scene(0.45)
    inverted = np.flatnonzero(det <= 0)
    assert len(inverted)
    with pytest.raises(
        ct.SceneError, match=f'"block".*element {inverted[0]} is inverted'
    ) as caught:
        bad.explain()
    if len(inverted) > 1:
        assert f"{len(inverted)} elements are bad" in str(caught.value) and all(
            f"{e}" in str(caught.value) for e in inverted[:8]
        )


# Continuing beyond the end.


@needs_hdf5
def test_a_run_that_has_ended_goes_on_to_a_later_end_with_the_same_bits(tmp_path):
    """The first run ends between two steps that a longer one would take; the longer one keeps its step to the last bit,
    also when it is continued once more."""
    first = bars("neo_hookean", end=20.3, courant=0.77).run(output=tmp_path / "a.vtkhdf")
    longer = bars("neo_hookean", end=33.7, courant=0.77)
    half = longer.run(restart=tmp_path / "a.vtkhdf", output=tmp_path / "b.vtkhdf", until=27.0)
    whole = longer.run(restart=tmp_path / "b.vtkhdf", output=tmp_path / "c.vtkhdf")
    assert first.dt == half.dt == whole.dt != longer.run(output=False, until=0.1).dt
    assert 33.7 <= whole.state.time < 33.7 + first.dt
    # The same step, given as a number that divides the end, in a run without interruption.
    straight = bars("neo_hookean", end=whole.state.step * first.dt, courant=None, dt=first.dt)
    if straight._built(None).dt == first.dt:
        end = straight.run(output=False)
        assert (
            end.state.step == whole.state.step
            and end.state["bar"].displacement.tobytes() == whole.state["bar"].displacement.tobytes()
        )
    saved = tomllib.loads(Run.load(tmp_path / "c.vtkhdf").scene)
    assert saved["time"]["end"] == 33.7


@needs_hdf5
def test_another_integrator_or_material_is_still_another_scene(tmp_path):
    bars(end=5.0).run(output=tmp_path / "a.vtkhdf")
    with pytest.raises(ct.SceneError, match=r"\[time\] differs"):
        bars(end=9.0, integrator="noh_bathe").run(restart=tmp_path / "a.vtkhdf", output=False)
    with pytest.raises(ct.SceneError, match=r"\[material\] differs"):
        bars("neo_hookean", end=9.0).run(restart=tmp_path / "a.vtkhdf", output=False)
