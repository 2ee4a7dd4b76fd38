"""Effects that a scene adds from its tables: results compared with closed forms, refusals with file, key and reason,
columns of the energy balance."""

from inspect import signature

import numpy as np
import pytest
from libcontact.parts import EFFECTS
from scenes import box_of, continued, same_state, scene_with

import libcontact as ct


def bar(cells=100, length=10.0, width=0.1, **body):
    scene = scene_with("soft", young=900.0, poisson=0.0, density=1.0)
    return scene.add_body(
        "bar", material="soft", box=box_of([0, 0, 0], [length, width, width], [cells, 1, 1]), **body
    )


def test_a_thrown_body_rises_and_falls_and_the_ledger_has_its_weight():
    """(eq:gravity-force, eq:gravity-potential)"""
    scene = (
        bar(velocity=[0, 0, 5])
        .add("gravity", acceleration=[0, 0, -10])
        .set_time(end=0.2, fraction=0.9)
    )
    run = scene.run()
    t = run.time[-1]
    np.testing.assert_allclose(run.state["bar"].displacement[:, 2], 5 * t - 5 * t**2, rtol=1e-12)
    assert run.energy.dtype.names[-1] == "gravity"
    np.testing.assert_allclose(
        run.energy["kinetic"] + run.energy["strain"] + run.energy["gravity"],
        run.energy["total"],
        rtol=1e-12,
    )
    np.testing.assert_allclose(run.energy["total"], run.energy["total"][0], rtol=1e-12)


def test_gravity_of_some_bodies_leaves_the_others():
    scene = bar()
    scene.add_body("free", material="soft", box=box_of([0, 1, 0], [1, 1, 1], [1, 1, 1]))
    run = (
        scene.add("gravity", acceleration=[0, 0, -10], bodies=["bar"])
        .set_time(end=0.1, fraction=0.9)
        .run()
    )
    assert (
        not run.state["free"].displacement.any() and run.state["bar"].displacement[:, 2].max() < 0
    )


HEIGHT, PERIOD = 1.0, 4.0 / np.sqrt(1e6 / 1000)


def impulse_of_sudden_weight(t):
    """The integral of the triangular wave (eq:laid-block) from 0 to t."""
    whole, rest = np.divmod(np.maximum(t, 0.0), PERIOD)
    fall = np.maximum(rest - PERIOD / 2, 0.0)
    return (
        whole * PERIOD
        + 2 * np.minimum(rest, PERIOD / 2) ** 2 / PERIOD
        + 2 * fall * (1 - fall / PERIOD)
    )


@pytest.mark.parametrize("ramp, apart", [(0.5, 0.04), (2.5, 0.01), (4.0, 0.004), (10.0, 0.004)])
def test_a_block_that_is_laid_on_a_floor_does_not_bounce(ramp, apart):
    """The force on the floor is the mean of the wave of a sudden weight over the time in which the weight grows
    (eq:laid-block, eq:laid-slowly). Ten elements smooth its kinks, which a ramp of half a period shows most."""
    scene = scene_with("soft", young=1e6, poisson=0.0, density=1000.0)
    scene.add_body("block", material="soft", box=box_of([0, 0, 0], [0.3, 0.3, HEIGHT], [2, 2, 10]))
    scene.add("obstacle", surface="block.z_min", plane={"point": [0, 0, 0], "normal": [0, 0, 1]})
    end = ramp * PERIOD
    scene.add("gravity", acceleration=[0, 0, -10], history={"time": [0, end], "value": [0, 1]})
    scene.add_probe("floor", resultant="obstacle").set_time(end=end + 3 * PERIOD, fraction=0.9)
    run = scene.run()
    t, force = run.probes["floor"]["time"], run.probes["floor"]["force"][:, 2] / (1000 * 0.09 * 10)
    exact = (impulse_of_sudden_weight(t) - impulse_of_sudden_weight(t - end)) / end
    np.testing.assert_allclose(force, exact, atol=apart)
    assert abs(force[t > end] - 1).max() < 1 / (4 * ramp) + apart
    assert np.ptp(force[t > end]) < 2 * apart or ramp % 1
    assert run.energy["gravity"][-1] != 0 and "gravity" in run.energy.dtype.names
    np.testing.assert_allclose(run.energy["balance"], 0, atol=1e-9)


def test_a_load_with_a_history_pulls_a_wave_of_its_shape():
    """The stress at x is the traction at the end, delayed by the distance over c = 30."""
    scene = bar(cells=200).add(
        "load",
        surface="bar.x_max",
        traction=[2, 0, 0],
        history={"time": [0, 0.1, 0.2], "value": [0, 1, 0]},
    )
    run = scene.set_time(end=0.2, fraction=0.9).run()
    x, stress = run.line("stress_xx", [4.1, 0.05, 0.05], [9.9, 0.05, 0.05], n=50)
    exact = 2 * np.interp(run.time[-1] - (5.9 - x) / 30, [0, 0.1, 0.2], [0, 1, 0])
    assert np.max(np.abs(stress - exact)) < 0.05
    assert (
        run.energy["external"][-1] == pytest.approx(run.energy["load"][-1])
        and run.energy["load"][-1] > 0
    )


def test_an_absorbing_end_takes_the_wave():
    pulse = {"time": [0, 0.05, 0.1], "value": [0, 1, 0]}
    scene = bar().add("load", surface="bar.x_min", traction=[2, 0, 0], history=pulse)
    free = scene.set_time(end=0.5, fraction=0.4).run()
    run = ct.Scene(scene.data).add("absorb", surface="bar.x_max").run()
    left = [r.energy["strain"][-1] + r.energy["kinetic"][-1] for r in (run, free)]
    assert left[0] < 0.01 * left[1]
    np.testing.assert_allclose(np.abs(run.energy["balance"]).max() / left[1], 0, atol=1e-12)


def test_damping_ends_in_the_static_solution():
    """A bar that hangs from one end under its own weight comes to rest with the other end lower by rho g L^2 / (2
    E)."""
    scene = (
        bar(cells=20).add_support("bar.x_min", fix="xyz").add("gravity", acceleration=[10, 0, 0])
    )
    scene.add("damping", rate=2 * np.pi / 2 * 30 / 10).set_time(end=12, fraction=0.9)
    run = scene.run()
    assert run.state["bar"].displacement[:, 0].max() == pytest.approx(
        1 * 10 * 100 / (2 * 900), rel=1e-3
    )
    assert run.energy["kinetic"][-1] < 1e-12 * run.energy["strain"][-1]
    assert run.energy["damping"][-1] < 0


def test_a_restart_has_the_same_bits_with_forces_that_go_with_velocity(tmp_path):
    pytest.importorskip("h5py")
    scene = (
        bar()
        .add("damping", rate=3)
        .add("gravity", acceleration=[1, 2, 3])
        .add("absorb", surface="bar.x_max")
    )
    scene.add("load", surface="bar.x_min", pressure=1.0, following=True).set_time(
        end=0.1, fraction=0.9
    )
    scene.set_output(tmp_path / "whole.vtkhdf", every=20)
    whole = scene.run()
    rest = continued(scene, tmp_path, 0.05)
    assert same_state(whole, rest) and rest.energy[-1].tobytes() == whole.energy[-1].tobytes()
    loaded = ct.Run.load(tmp_path / "whole.vtkhdf")
    assert (
        loaded.energy.dtype == whole.energy.dtype
        and loaded.energy.tobytes() == whole.energy.tobytes()
    )


def test_explain_tells_what_is_on_and_what_is_not():
    text = bar().add("gravity", acceleration=[0, 0, -10]).set_time(end=1, fraction=0.9).explain()
    assert "gravity: [0.0, 0.0, -10.0] m/s^2 on all bodies" in text and "no [damping]" in text
    assert "gravity" in text.data["effects"] and "gravity" not in text.data["left_out"]


@pytest.mark.parametrize(
    "effect, entries, words",
    [
        ("gravity", {}, ["gravity.acceleration", "missing"]),
        ("gravity", {"acceleration": [0, 0]}, ["gravity.acceleration", "3"]),
        (
            "gravity",
            {"acceleration": [0, 0, 1], "bodies": ["baar"]},
            ["gravity.bodies[0]", 'did you mean "bar"'],
        ),
        ("gravity", {"acceleration": [0, 0, 1], "bodies": []}, ["gravity.bodies", "empty"]),
        ("gravity", {"acceleration": [0, 0, 1], "acc": 1}, ["gravity.acc", "unknown key"]),
        ("damping", {"rate": -1}, ["damping.rate", "at least 0"]),
        ("load", {"surface": "bar.x_max"}, ["load[0]", "neither a traction nor a pressure"]),
        ("load", {"surface": "bar.top", "pressure": 1}, ["load[0].surface", "no face"]),
        (
            "load",
            {"surface": "bar.x_max", "traction": [1, 0, 0], "following": True},
            ["load[0].following", "only a pressure follows"],
        ),
        (
            "load",
            {"surface": "bar.x_max", "pressure": 1, "history": {"time": [0, 1], "value": [1]}},
            ["load[0].history.value", "both need as many"],
        ),
        (
            "load",
            {"surface": "bar.x_max", "pressure": 1, "history": {"time": [1, 0], "value": [1, 1]}},
            ["load[0].history.time[1]", "before"],
        ),
        ("absorb", {"surface": 3}, ["absorb[0].surface", "must be a text"]),
        ("gravty", {}, ['did you mean "gravity"']),
    ],
)
def test_what_cannot_be_is_refused_with_key_and_reason(effect, entries, words):
    with pytest.raises(ct.SceneError) as refused:
        bar().add(effect, **entries)
    for word in words:
        assert word in str(refused.value)


def test_every_effect_has_a_call_of_its_own():
    for effect in EFFECTS:
        assert set(signature(getattr(ct.Scene, f"add_{effect}")).parameters) > {
            *EFFECTS[effect].keys()
        }
    by_name = (
        bar().add("gravity", acceleration=[0, 0, 1]).add("load", surface="bar.x_max", pressure=1)
    )
    called = bar().add_gravity(acceleration=[0, 0, 1]).add_load(surface="bar.x_max", pressure=1)
    assert called.data == by_name.data
    with pytest.raises(ct.SceneError, match="given twice"):
        called.add_gravity(acceleration=[0, 0, 1])


def test_an_effect_that_a_scene_has_once_is_refused_twice():
    with pytest.raises(ct.SceneError, match="given twice"):
        bar().add("gravity", acceleration=[0, 0, 1]).add("gravity", acceleration=[0, 0, 1])


def test_a_step_above_the_damped_limit_is_refused():
    scene = bar().add("damping", rate=1e4).set_time(end=0.1, courant=0.9)
    with pytest.raises(ct.SceneError, match="above the stable step"):
        scene.explain()


# Effects of the user.


def spring(scene, k=2.0, **more):
    """A spring from each node of the end to its initial position."""
    return scene.add_effect(
        "spring",
        "bar",
        "x_max",
        lambda view: -k * view.displacement,
        energy=lambda view: 0.5 * k * np.sum(view.displacement**2),
        omega_squared=k / (0.1**3 / 8),
        **more,
    )


def test_a_spring_written_in_python_turns_a_body_back():
    """A bar (10 x 0.1 x 0.1, mass 0.1) on four springs of k = 2e-3: omega^2 = 8e-3 / 0.1, except for the bar's own
    stiffness E A / L = 0.9."""
    scene = (
        spring(bar(velocity=[0.01, 0, 0]), k=2e-3)
        .set_time(end=np.pi / np.sqrt(8e-3 / 0.1), fraction=0.9)
        .set_output(every=1)
    )
    run = scene.run()
    assert run.state["bar"].velocity[:, 0].mean() == pytest.approx(-0.01, rel=1e-3)
    assert run.energy.dtype.names[-1] == "spring" and run.energy["spring"].max() == pytest.approx(
        run.energy["kinetic"][0], rel=1e-2
    )
    np.testing.assert_allclose(run.energy["total"], run.energy["total"][0], rtol=1e-12)
    assert abs(run.energy["balance"]).max() < 1e-12 * run.energy["kinetic"][0]


def test_the_stable_step_knows_the_spring():
    free = bar().set_time(end=1, fraction=0.9).explain().data["time"]["stable"]
    k, m = 2.0, 0.1**3 / 8
    with_spring = spring(bar(), k).set_time(end=1, fraction=0.9).explain().data["time"]["stable"]
    assert 4 / with_spring**2 == pytest.approx(4 / free**2 + k / m, rel=1e-12)


def test_what_the_function_raises_ends_the_run_and_names_the_effect():
    def force(view):
        if view.time > 0.05:
            raise KeyError("no such table")
        return np.zeros_like(view.displacement)

    scene = bar().add_effect("mine", "bar", [0, 3], force).set_time(end=1, fraction=0.9)
    with pytest.raises(ct.RunError, match="effect mine: KeyError: 'no such table'") as failed:
        scene.run()
    assert 0 < failed.value.run.time[-1] <= 0.051


@pytest.mark.parametrize(
    "answer, words",
    [
        (np.zeros((3, 3)), "shape"),
        (np.full((2, 3), np.nan), "not finite"),
        ("text", "real numbers"),
        (np.full((2, 3), 1 + 2j), "complex128"),
        (np.zeros((2, 3), np.complex64), "complex64"),
        ([["1.0"] * 3] * 2, "real numbers"),
        (np.zeros((2, 3), object), "object"),
        (np.zeros((2, 3), bool), "bool"),
        (None, "object"),
    ],
)
def test_an_impossible_force_is_refused(answer, words):
    scene = (
        bar().add_effect("mine", "bar", [0, 3], lambda view: answer).set_time(end=1, fraction=0.9)
    )
    with pytest.raises(ct.Error, match=f"effect mine: .*{words}"):
        scene.run()


@pytest.mark.parametrize(
    "answer, words",
    [
        (1j, "complex128"),
        (np.complex64(1), "complex64"),
        ("1", "real numbers"),
        ([1.0, 2.0], "shape"),
        (None, "object"),
    ],
)
def test_an_impossible_energy_is_refused(answer, words):
    scene = (
        bar()
        .add_effect(
            "mine", "bar", [0, 3], lambda view: np.zeros((2, 3)), energy=lambda view: answer
        )
        .set_time(end=1, fraction=0.9)
    )
    with pytest.raises(ct.Error, match=f"effect mine: .*{words}"):
        scene.run()


@pytest.mark.parametrize("kind", [np.float32, np.int8, np.uint64, np.longdouble])
def test_a_force_may_be_of_any_real_numbers(kind):
    """The same numbers in different types, each without loss, give the same bits."""

    def pushed(kind):
        force = np.array([[1, 2, 3], [4, 0, 64]], kind)
        return (
            bar()
            .add_effect("mine", "bar", [0, 3], lambda view: force)
            .set_time(end=0.01, fraction=0.9)
            .run()
        )

    np.testing.assert_array_equal(
        pushed(kind).state["bar"].displacement, pushed(np.float64).state["bar"].displacement
    )


@pytest.mark.parametrize(
    "reason",
    [SystemExit(7), KeyboardInterrupt(), GeneratorExit()],
    ids=lambda reason: type(reason).__name__,
)
@pytest.mark.parametrize("when", [-1.0, 0.05])
@pytest.mark.parametrize("function", ["force", "energy"])
def test_what_ends_a_program_ends_it_from_within_a_function(
    reason, when, function, tmp_path, capfd
):
    """At the first call and during a run; the file keeps its records."""

    def leave(view):
        if view.time > when:
            raise reason

    def force(view):
        if function == "force":
            leave(view)
        return np.zeros_like(view.displacement)

    def energy(view):
        if function == "energy":
            leave(view)
        return 0.0

    path = tmp_path / "run.vtkhdf"
    scene = (
        bar(velocity=[1, 0, 0])
        .add_effect("mine", "bar", [0, 3], force, energy=energy)
        .set_time(end=1, fraction=0.9)
        .set_output(every=1)
    )
    with pytest.raises(type(reason)) as left:
        scene.run(output=path if ct.has("hdf5") else False)
    assert left.value is reason
    assert "cffi" not in capfd.readouterr().err
    if ct.has("hdf5") and when > 0:
        pytest.importorskip("h5py")
        assert 0 < ct.Run.load(path).time[-1] <= 0.06
    # No trace of it remains for the next run.
    with pytest.raises(ct.SceneError, match="output.file"):
        bar().set_time(end=0.01, fraction=0.9).run(output=tmp_path / "none" / "run.vtkhdf")


def test_a_long_text_of_an_exception_is_cut_between_characters():
    def force(view):
        raise ValueError("ε" * 5000)

    with pytest.raises(ct.Error, match=r"effect mine: ValueError: ε+\.\.\.") as failed:
        bar().add_effect("mine", "bar", [0, 3], force).set_time(end=1, fraction=0.9).run()
    assert "\ufffd" not in str(failed.value)


def test_the_view_is_that_of_the_nodes_and_cannot_be_written():
    seen = []

    def force(view):
        seen.append((view, view.reference, view.velocity, view.displacement))
        return np.zeros((2, 3))

    run = (
        bar(velocity=[1, 2, 3])
        .add_effect("mine", "bar", [5, 0], force)
        .set_time(end=0.01, fraction=0.9)
        .run()
    )
    view, reference, velocity, displacement = seen[-1]
    np.testing.assert_array_equal(reference, run.state["bar"].nodes[[0, 5]])
    np.testing.assert_allclose(velocity, [[1, 2, 3]] * 2, rtol=1e-12)
    with pytest.raises(ValueError, match="read-only"):
        displacement[0, 0] = 1
    np.testing.assert_array_equal(view.velocity, velocity)  # also after the call


def test_a_function_cannot_be_saved_and_names_are_checked(tmp_path):
    scene = spring(bar()).set_time(end=1, fraction=0.9)
    with pytest.raises(ct.SceneError, match="spring: is a Python function"):
        scene.save(tmp_path / "scene.toml")
    for name in ("kinetic", "solid", "spring", "two words"):
        with pytest.raises(ct.SceneError):
            scene.add_effect(name, "bar", "x_max", lambda view: 0)
    with pytest.raises(ct.SceneError, match="no body"):
        bar().add_effect("mine", "baar", [0], lambda view: 0).set_time(
            end=1, fraction=0.9
        ).explain()
    with pytest.raises(ct.SceneError, match="whole numbers"):
        bar().add_effect("mine", "bar", [10**6], lambda view: 0).set_time(
            end=1, fraction=0.9
        ).explain()
