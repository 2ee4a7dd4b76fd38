"""Probes: histories compared with the change of momentum, and bit by bit with records and watched runs; kept through
files, restarts, Ctrl-C and faults."""

import os
import signal

import numpy as np
import pytest
from libcontact.model import INTEGRATORS
from libcontact.schema import SceneError
from scenes import box_of, scene_with

import libcontact as ct

MATERIAL = {"young": 900.0, "poisson": 0.0, "density": 1.0}


def bar_on_a_wall(cells=(40, 1, 1), end=1.0, **time):
    """Doyen, Ern and Piperno's bar, which touches the wall: c = 30, ρ c v A = 300, contact until 2 L / c."""
    scene = scene_with("soft", **MATERIAL)
    box = box_of([0, 0, 0], [10, 1, 1], cells)
    scene.add_body("bar", material="soft", box=box, velocity=[-10, 0, 0])
    wall = {"point": [0, 0, 0], "normal": [1, 0, 0]}
    scene.add("obstacle", surface="bar.x_min", plane=wall)
    return scene.set_time(end=end, **(time or {"fraction": 0.5}))


def two_blocks(**contact):
    """A block falls askew on another one with a different mesh that is fixed below."""
    scene = scene_with("soft", **{**MATERIAL, "poisson": 0.3})
    low = box_of([0, 0, 0], [1, 1, 1], [3, 2, 2])
    high = box_of([0.1, 0.2, 1.001], [0.7, 0.6, 0.5], [2, 3, 2])
    scene.add_body("low", material="soft", box=low)
    scene.add_body("high", material="soft", box=high, velocity=[0.3, 0.1, -1])
    scene.add_contact("low.z_max", "high.z_min", **contact)
    scene.add_support("low.z_min", fix="z").add_support("low.x_min", fix="xy")
    return scene.set_time(end=0.2, fraction=0.5).set_output(every=10)


def everywhere(scene):
    """Probes of all quantities of a point that stress waves reach late, and of the near face."""
    every = ["displacement", "velocity", "acceleration", "stress", "pressure"]
    scene.add_probe("tip", body="bar", point=[10, 1, 1], quantities=every)
    scene.add_probe("middle", body="bar", point=[4.9, 0, 1], quantities=every)
    return scene.add_probe("end", surface="bar.x_min", every=3)


def impulse(history):
    """The trapezoidal sum, which is exact for the discrete motion: half of the first and of the last force belongs to
    the time."""
    f, dt = history["force"], np.diff(history["time"])[:, None]
    return (0.5 * dt * (f[1:] + f[:-1])).sum(axis=0)


def test_the_force_of_a_wall_is_the_rate_of_momentum_and_that_of_a_plane_wave():
    """eq:probe-resultant: the sum of the wall's forces."""
    scene = bar_on_a_wall(cells=(100, 1, 1), fraction=0.9).set_output(every=10)
    scene.add_probe("wall", resultant="obstacle", quantities=["force", "moment"])
    run = scene.run()
    wall, p = run.probes["wall"], run.momentum["p"]
    assert len(wall) == run.steps[-1] + 1
    scale = np.abs(p).max()
    for i, step in enumerate(run.steps):
        assert np.abs(impulse(wall[: step + 1]) - (p[i] - p[0])).max() <= 1e-12 * scale
    # ρ c v A until the wave returns; the oscillation of the first element is excluded.
    lasting = (wall["time"] > 0.05) & (wall["time"] < 0.6)
    force = wall["force"][:, 0]
    assert np.sqrt(np.mean((force[lasting] / 300.0 - 1.0) ** 2)) <= 2e-3
    assert force[lasting].max() <= 1.01 * 300.0 and force[wall["time"] > 0.72].max() == 0.0
    # The pressure is uniform, so the force acts at the middle of the face, y = z = 1/2.
    moment = np.stack([0.0 * force, 0.5 * force, -0.5 * force], axis=1)
    assert np.abs(wall["moment"] - moment).max() <= 1e-12 * 300.0


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_point_has_the_bits_of_a_watch_at_every_step(integrator):
    scene = everywhere(bar_on_a_wall(end=0.5, fraction=0.5, integrator=integrator))
    seen = []

    def watch(run):
        bar = run.state["bar"]
        node = np.flatnonzero((bar.nodes == [5, 0, 1]).all(axis=1))[0]
        element = np.flatnonzero((bar.centres == [4.875, 0.5, 0.5]).all(axis=1))[0]
        face = bar.velocity[bar.nodes[:, 0] == 0.0].mean(axis=0)
        u, v, stress = bar.displacement[node], bar.velocity[node], bar.stress[element]
        seen.append((run.time[0], u.copy(), v.copy(), stress.copy(), face))
        assert run.probes["middle"]["time"].tolist() == [run.time[0]]

    watched = scene.set_output(every=1).run(watch=watch)
    rare = scene.set_output(every=10**6).run()
    assert len(watched.steps) == len(rare.probes["middle"]) > 50
    for name, history in rare.probes.items():
        assert history.tobytes() == watched.probes[name].tobytes(), name
    middle = rare.probes["middle"]
    for row, (time, u, v, stress, _) in zip(middle, seen):
        assert row["time"] == time
        assert row["displacement"].tobytes() == u.tobytes()
        assert row["velocity"].tobytes() == v.tobytes()
        assert (row["stress"] == stress).all()
        assert row["pressure"] == -(stress[0] + stress[1] + stress[2]) / 3.0
    assert np.abs(middle["stress"][:, 0]).max() > 100.0
    # The face has equal masses, so its centre of mass is the mean.
    mean = np.array([each[-1] for each in seen[::3]])
    assert np.abs(rare.probes["end"]["velocity"] - mean).max() <= 1e-13 * 10.0


def test_acceleration_is_the_second_difference_of_displacement():
    run = everywhere(bar_on_a_wall(end=0.5)).run()
    middle = run.probes["middle"]
    u, a, dt = middle["displacement"], middle["acceleration"], run.dt
    second = (u[2:] - 2.0 * u[1:-1] + u[:-2]) / dt**2
    # Round-off of u in a difference of three.
    assert np.abs(second - a[1:-1]).max() <= 8 * np.finfo(float).eps * np.abs(u).max() / dt**2
    assert np.abs(a).max() > 100.0


def test_the_mean_motion_of_all_nodes_is_the_momentum_over_the_mass():
    """eq:probe-mean: the mean by masses."""
    scene = bar_on_a_wall(cells=(10, 1, 1)).set_output(every=1)
    run = scene.add_probe("all", surface="bar.outer", quantities=["velocity"]).run()
    assert np.abs(10.0 * run.probes["all"]["velocity"] - run.momentum["p"]).max() <= 1e-12 * 100.0


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_contact_with_friction_and_supports_explain_all_momentum(friction):
    """eq:probe-impulse: the sum of the resultants, the first and the last by half, is the change of momentum."""
    scene = two_blocks(friction=friction)
    scene.add_probe("up", resultant="contact", body="high").add_probe(
        "down", resultant="contact[0]"
    )
    scene.add_probe("floor", resultant="support[0]").add_probe("side", resultant="support[1]")
    run = scene.run()
    up, down, floor, side = (run.probes[name] for name in ("up", "down", "floor", "side"))
    size = np.abs(up["force"]).max()
    assert size > 1.0 and np.abs(up["force"] + down["force"]).max() <= 1e-13 * size
    high, low = run.body_momentum("high"), run.body_momentum("low")
    scale = np.abs(high["p"]).max()
    assert np.abs(impulse(up) - (high["p"][-1] - high["p"][0])).max() <= 1e-13 * scale
    reaction = impulse(floor) + impulse(side)
    assert np.abs(reaction - low["support_impulse"][-1]).max() <= 1e-13 * scale
    gained = low["p"][-1] - low["p"][0]
    assert np.abs(impulse(down) + reaction - gained).max() <= 1e-13 * scale
    # At t = 0 the forces are solved for twice; with friction they may differ by 1e-5 of the largest (eq:energy-stop).
    off = 1e-5 * size * 0.5 * run.dt if friction else 1e-11 * scale
    assert np.abs(low["p"][0]).max() <= off
    # Each fixes its own directions, also at shared nodes.
    assert not floor["force"][:, :2].any() and not side["force"][:, 2].any()
    assert (np.abs(impulse(side)[:2]) > 1e-4).all()
    # The faces are plane except for the strain.
    tangential = np.hypot(*up["force"][:, :2].T).max() / size
    assert 0.3 * friction < tangential < friction + 0.1


def test_a_support_on_a_path_has_the_force_that_moves_the_body():
    scene = scene_with("soft", **MATERIAL)
    scene.add_body("a", material="soft", box={"size": [2, 1, 1], "cells": [4, 1, 1]})
    ramp = {"time": [0, 1], "value": [0, 1]}
    scene.add_support("a.y_min", fix="y").add_support(
        "a.x_max", fix="x", travel=[0.5, 0, 0], history=ramp
    )
    scene.add_probe("pull", resultant="support[1]").add_probe("rest", resultant="support[0]")
    run = scene.set_time(end=0.5, fraction=0.5).run()
    p = run.momentum["p"]
    assert abs(impulse(run.probes["pull"])[0] - (p[-1] - p[0])[0]) <= 1e-12 * abs(p).max()
    assert p[-1, 0] > 0.1 and not run.probes["pull"]["force"][:, 1:].any()
    assert np.abs(run.probes["rest"]["force"]).max() <= 1e-12


def everything():
    scene = two_blocks(friction=0.3)
    scene.add_probe(
        "foot", body="low", point=[0.5, 0.5, 0.9], quantities=["displacement", "stress"]
    )
    scene.add_probe("top", surface="high.z_max", every=4)
    return scene.add_probe("up", resultant="contact", body="high", quantities=["force", "moment"])


def equal(one, other):
    assert one.keys() == other.keys()
    for name in one:
        assert one[name].dtype.names == other[name].dtype.names
        assert one[name].tobytes() == other[name].tobytes(), name


def test_the_numbering_of_nodes_changes_no_bit_of_a_resultant():
    """Sums do not depend on the order: a mesh in layers along another axis has the same motion."""
    found = []
    for layers in "xyz":
        data = everything().data
        for body in data["body"]:
            body["box"]["layers"] = layers
        found.append(ct.Scene(data).run().probes)
    for other in found[1:]:
        for name in ("top", "up"):
            assert found[0][name].tobytes() == other[name].tobytes()


def test_threads_and_savings_change_no_bit():
    scene = everything()
    plain = scene.run().probes
    assert len(plain["up"]) > 30
    equal(plain, scene.run(threads=2).probes)
    data = everywhere(bar_on_a_wall()).data
    awake = ct.Scene({**data, "run": {"savings": []}}).run().probes
    asleep = ct.Scene(data).run().probes
    for name in awake:
        for key in awake[name].dtype.names:
            assert (awake[name][key] == asleep[name][key]).all(), (name, key)


pytestmark_file = pytest.mark.skipif(not ct.has("hdf5"), reason="no HDF5")


@pytestmark_file
def test_the_file_has_them_and_a_restart_goes_on_with_them(tmp_path):
    scene, whole, part, rest = everything(), *(tmp_path / f"{n}.vtkhdf" for n in ("a", "b", "c"))
    straight = scene.run(output=whole)
    equal(straight.probes, ct.Run.load(whole).probes)
    assert ct.Run.load(whole).probes["foot"]["stress"].shape[1:] == (6,)
    scene.run(output=part, until=0.11)
    half = ct.Run.load(part).probes
    assert 0 < len(half["up"]) < len(straight.probes["up"])
    equal(straight.probes, scene.run(output=rest, restart=part).probes)
    equal(straight.probes, ct.Run.load(rest).probes)
    # From memory, with other probes: their histories begin with the restart.
    memory = scene.run()
    equal(memory.probes, ct.Run.load(memory.save(tmp_path / "d.vtkhdf")).probes)
    other = two_blocks(friction=0.3).add_probe("up", resultant="contact", body="high")
    late = other.run(restart=part, output=False).probes["up"]
    first = half["up"]["time"][-1]
    assert late["time"][0] == first
    assert (late["force"] == straight.probes["up"]["force"][-len(late) :]).all()


@pytestmark_file
def test_a_smaller_step_goes_on_with_the_history(tmp_path):
    scene, path = everything(), tmp_path / "coarse.vtkhdf"
    scene.run(output=path, until=0.11)
    data = scene.data
    data["time"]["fraction"] = 0.25
    fine = ct.Scene(data).run(restart=path, output=False)
    time, half = fine.probes["up"]["time"], ct.Run.load(path).probes["up"]
    assert (time[: len(half)] == half["time"]).all()
    steps = np.diff(time)
    assert (steps > 0).all() and np.allclose(steps[: len(half) - 1], 2 * fine.dt)
    assert np.allclose(steps[len(half) - 1 :], fine.dt)


@pytestmark_file
def test_a_killed_run_loads_up_to_its_last_record(tmp_path):
    import h5py

    path = tmp_path / "killed.vtkhdf"
    run = everything().run(output=path)
    with h5py.File(path, "r+") as file:
        # As if the rows of the last record had been written, but not its number.
        file["VTKHDF/Steps"].attrs["NSteps"] -= 1
    loaded = ct.Run.load(path)
    last = loaded.time[-1]
    assert last < run.time[-1] and loaded.probes["up"]["time"][-1] == last
    assert (loaded.probes["up"] == run.probes["up"][: len(loaded.probes["up"])]).all()


def test_ctrl_c_keeps_them():
    data = everything().data
    data["time"]["end"] = 10.0
    scene = ct.Scene(data)
    # A shell starts background jobs that ignore Ctrl-C, and the tests inherit this.
    inherited = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        run = scene.run(
            watch=lambda run: run.steps[0] == 20 and os.kill(os.getpid(), signal.SIGINT)
        )
    finally:
        signal.signal(signal.SIGINT, inherited)
    time = run.probes["up"]["time"]
    assert run.interrupted and 20 <= run.steps[-1] < 1000
    assert len(time) == run.steps[-1] + 1 and time[-1] == run.time[-1]


def test_a_fault_leaves_the_history_up_to_it():
    scene = bar_on_a_wall(end=1.0)
    count = []

    def force(view):
        count.append(view.time)
        return np.full_like(view.displacement, np.nan if view.time > 0.3 else 0.0)

    scene.add_effect("fault", "bar", "x_max", force).add_probe("wall", resultant="obstacle")
    with pytest.raises(ct.RunError) as caught:
        scene.run()
    history = caught.value.run.probes["wall"]
    assert 0.25 < history["time"][-1] <= 0.35 and history["force"][-1, 0] > 200.0


REFUSED = [
    (
        {"body": "baz", "point": [0, 0, 0]},
        "probe[0].body",
        'no body is named "baz"; did you mean "bar"?',
    ),
    (
        {"body": "bar", "point": [11, 0, 0]},
        "probe[0].point",
        '[11.0, 0.0, 0.0] lies outside body "bar"; its nearest node is at (10, 0, 0)',
    ),
    ({"point": [0, 0, 0]}, "probe[0].point", 'give "body" too'),
    ({}, "probe[0]", 'gives none of "point", "surface" and "resultant"'),
    (
        {"surface": "bar.x_min", "resultant": "obstacle"},
        "probe[0].resultant",
        "cannot stand beside",
    ),
    ({"surface": "bar.x_mni"}, "probe[0].surface", 'did you mean "x_min"?'),
    ({"surface": "bar.x_min", "body": "bar"}, "probe[0].body", 'cannot stand beside "surface"'),
    ({"resultant": "obstacel"}, "probe[0].resultant", 'did you mean "obstacle"?'),
    (
        {"resultant": "gravity"},
        "probe[0].resultant",
        'it must be "contact", "obstacle" or "support"',
    ),
    (
        {"resultant": "obstacle[1]"},
        "probe[0].resultant",
        "the scene has 1 [[obstacle]], counted from 0",
    ),
    ({"resultant": "support"}, "probe[0].resultant", "the scene has no [[support]]"),
    (
        {"resultant": "obstacle", "quantities": ["stress"]},
        "probe[0].quantities[0]",
        "is not recorded of a resultant, which has force, moment",
    ),
    (
        {"surface": "bar.x_min", "quantities": ["displacment"]},
        "probe[0].quantities[0]",
        'did you mean "displacement"?',
    ),
    ({"surface": "bar.x_min", "quantities": []}, "probe[0].quantities", "name at least one"),
    ({"surface": "bar.x_min", "every": 0}, "probe[0].every", "at least 1"),
    ({"name": "a/b", "surface": "bar.x_min"}, "probe[0].name", "slash"),
]


@pytest.mark.parametrize(
    ("entries", "key", "reason"), REFUSED, ids=[row[1] + str(i) for i, row in enumerate(REFUSED)]
)
def test_what_is_wrong_is_told_with_key_reason_and_suggestion(entries, key, reason):
    data = bar_on_a_wall().data
    data["probe"] = [{"name": "p", **entries}]
    with pytest.raises(SceneError) as caught:
        ct.Scene(data, file="bar.toml").explain()
    assert caught.value.key == key and str(caught.value).startswith(f"bar.toml: {key}: ")
    assert reason in caught.value.reason


def test_a_resultant_must_be_one():
    data = two_blocks().data
    for probe, key, reason in [
        (
            {"resultant": "support"},
            "probe[0].resultant",
            '"support" is one of 2; write "support[0]" ... "support[1]"',
        ),
        (
            {"resultant": "support[0]", "body": "high"},
            "probe[0].body",
            '"support" does not act on "high"',
        ),
    ]:
        with pytest.raises(SceneError) as caught:
            ct.Scene({**data, "probe": [{"name": "p", **probe}]})
        assert caught.value.key == key and reason in caught.value.reason
    with pytest.raises(SceneError, match='"p" is used twice'):
        two_blocks().add_probe("p", surface="low.x_min").add_probe("p", surface="low.x_max")
    folded = {**data, "contact": [{"surfaces": ["low.outer", "low.outer"]}]}
    with pytest.raises(SceneError, match="with itself, whose forces have the sum 0"):
        ct.Scene({**folded, "probe": [{"name": "p", "resultant": "contact"}]})


def test_without_probes_there_are_none_and_explain_names_those_that_are():
    assert bar_on_a_wall().run().probes == {}
    assert "probe" not in bar_on_a_wall().explain()
    scene = bar_on_a_wall().add_probe("wall", resultant="obstacle", every=5)
    assert "probe wall: force of obstacle[0] on bar, every 5 steps" in scene.explain()
    row = scene.explain().data["probes"][0]
    assert row["row_bytes"] == 8 * 4 and row["quantities"] == ["force"]
