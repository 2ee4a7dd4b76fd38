"""Copies and pickles of scenes, runs and their exceptions."""

import copy
import functools
import os
import pickle

import numpy as np
import pytest
from scenes import MILLIMETRES, STEEL, box_of, scene_with

import libcontact as ct


def pickled(thing):
    return pickle.loads(pickle.dumps(thing))


WAYS = [copy.copy, copy.deepcopy, pickled]


def hold(view, k):
    return -k * view.displacement


def stored(view, k):
    return 0.5 * k * np.sum(view.displacement**2)


def scene(own=True):
    """Two bars, one of them a mesh of arrays, that meet on a spring written in Python."""
    made = scene_with(**STEEL, units=MILLIMETRES, title="two bars")
    made.add_body(
        "left",
        material="steel",
        element="hex8",
        box=box_of([-2, 0, 0], [2, 1, 1], [4, 2, 2]),
        velocity=[1000, 0, 0],
    )
    nodes = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    made.add_body("right", material="steel", nodes=nodes, elements=[[0, 1, 3, 2, 4, 5, 7, 6]])
    made.add_contact("left.x_max", "right.x_min")
    made.add("gravity", acceleration=[0, 0, -9810])
    if own:
        made.add_effect(
            "spring",
            "right",
            "x_max",
            functools.partial(hold, k=100.0),
            energy=functools.partial(stored, k=100.0),
            omega_squared=100 / 1e-9,
        )
    return made.set_time(end=5e-7, fraction=0.5)


def same(a, b):
    tables = all(
        np.array_equal(getattr(a, name), getattr(b, name))
        for name in ("energy", "momentum", "steps")
    )
    return (
        tables
        and a.bodies == b.bodies
        and a.units == b.units
        and all(
            np.array_equal(getattr(a.state[name], field), getattr(b.state[name], field))
            for name in a.bodies
            for field in ("displacement", "velocity", "stress", "nodes", "elements")
        )
    )


@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.__name__)
@pytest.mark.parametrize("built", [False, True])
def test_a_copy_of_a_scene_gives_the_same_bits(way, built):
    first = scene()
    if built:
        first.explain()
    second = way(first)
    assert (
        second.data["title"] == "two bars"
        and second.toml() == first.toml()
        and repr(second) == repr(first)
    )
    assert same(second.run(), first.run())


@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.__name__)
def test_a_copy_of_a_scene_goes_its_own_way(way):
    first = scene(own=False)
    before = first.toml()
    second = way(first)
    second.set_time(end=1e-7, fraction=0.25).add_effect(
        "spring", "left", "x_min", functools.partial(hold, k=1.0)
    )
    assert first.toml() == before and second.toml() != before
    assert (
        "spring" not in first.run().energy.dtype.names
        and "spring" in second.run().energy.dtype.names
    )


def test_a_scene_that_is_not_whole_yet_can_be_copied():
    first = scene_with(**STEEL, units=MILLIMETRES)
    for way in WAYS:
        second = way(first).add_body(
            "bar", material="steel", element="hex8", box=box_of([0, 0, 0], [1, 1, 1], [1, 1, 1])
        )
        assert len(second.set_time(end=1e-7, fraction=0.5).run().time) > 1
    assert "body" not in first.data


def test_a_function_that_cannot_be_pickled_is_named():
    first = scene(own=False).add_effect("hand", "right", "x_max", lambda view: -view.displacement)
    with pytest.raises(pickle.PicklingError, match='effect "hand": its force can\'t be pickled'):
        pickle.dumps(first)
    assert same(copy.deepcopy(first).run(), first.run())


@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.__name__)
def test_a_copy_of_a_run_has_its_tables_and_its_state(way):
    run = scene().run()
    other = way(run)
    assert same(other, run) and repr(other) == repr(run)
    assert len(other.contact) == 1
    assert np.array_equal(other.contact[0]["raw_pressure"], run.contact[0]["raw_pressure"])
    np.testing.assert_equal(
        other.penetration, run.penetration
    )  # no point is inside: positions of NaN
    assert (
        other.impulse.keys() == run.impulse.keys()
        and other.dt == run.dt
        and other.costs == run.costs
    )
    line = [
        np.array(each.line("stress_xx", [-2, 0.5, 0.5], [1, 0.5, 0.5], 21)) for each in (run, other)
    ]
    np.testing.assert_array_equal(*line)
    with pytest.raises(ValueError, match="read-only"):
        other.state["left"].displacement[0, 0] = 1.0


@pytest.mark.skipif(not ct.has("hdf5"), reason="built without HDF5")
def test_a_copy_can_be_saved_a_pickle_without_a_file_can_not(tmp_path):
    pytest.importorskip("h5py")
    run = scene().run()
    for way in (copy.copy, copy.deepcopy):
        assert same(ct.Run.load(way(run).save(tmp_path / f"{way.__name__}.vtkhdf")), run)
    with pytest.raises(ValueError, match="no file and no state"):
        pickled(run).save(tmp_path / "pickle.vtkhdf")
    written = scene().run(output=tmp_path / "run.vtkhdf")
    assert pickled(written).path == written.path and same(
        pickled(ct.Run.load(written.path)), ct.Run.load(written.path)
    )


def test_errors_come_through_a_pickle():
    with pytest.raises(ct.SceneError) as refused:
        scene().add_material("steel", young=-1, poisson=0.3, density=1)
    again = pickled(refused.value)
    assert str(again) == str(refused.value) and (again.key, again.reason, again.file) == (
        refused.value.key,
        refused.value.reason,
        refused.value.file,
    )

    made = scene(own=False).add_effect(
        "late", "right", "x_max", functools.partial(fail, after=3e-7)
    )
    with pytest.raises(ct.RunError) as failed:
        made.run()
    again = pickled(failed.value)
    assert (
        str(again) == str(failed.value)
        and again.step == failed.value.step
        and same(again.run, failed.value.run)
    )


@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.__name__)
def test_warnings_can_be_copied(way):
    warning = ct.EnergyGrowth("there is more", "contact[0]", 0.25, 1e-6, "contact a with b")
    again = way(warning)
    assert type(again) is ct.EnergyGrowth and str(again) == str(warning)
    assert vars(again) == {
        "kind": "energy_growth",
        "text": "there is more",
        "key": "contact[0]",
        "ratio": 0.25,
        "time": 1e-6,
        "who": "contact a with b",
    }


def fail(view, after):
    if view.time > after:
        raise ValueError("enough")
    return 0.0 * view.displacement


def test_the_package_says_that_it_is_typed():
    assert os.path.exists(os.path.join(os.path.dirname(ct.__file__), "py.typed"))


@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.__name__)
def test_fields_that_nobody_has_asked_for_are_those_of_the_last_step(way):
    """Computed later, by the run or by its copy, after other runs: v_n = (u_{n+1} - u_{n-1}) / 2 Δt."""
    one, dt = scene(own=False), scene(own=False)._built(None).dt
    run, before, after = (one.run(output=False, until=(n - 0.5) * dt) for n in (10, 9, 11))
    made = way(run)
    del run, one
    for name, state in made.state.items():
        change = after.state[name].displacement - before.state[name].displacement
        assert not state.velocity.flags.writeable
        assert np.abs(state.velocity - change / (2.0 * dt)).max() < 1e-9 * np.abs(change).max() / dt


def test_what_a_watch_has_kept_is_of_its_record():
    kept = []
    run = scene(own=False).run(output=False, watch=lambda one: kept.append(one.state["left"]))
    first, last = kept[0].velocity[:, 0], run.state["left"].velocity[:, 0]
    assert np.allclose(first, 1000.0) and np.abs(last - first).max() > 100.0
