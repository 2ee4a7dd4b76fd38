"""Equilibrium by dynamic relaxation, compared with beam theory; other loadings with the same result; supports with a
prescribed displacement."""

from pathlib import Path

import numpy as np
import pytest
from libcontact.parts import read
from scenes import MILLIMETRES, box_of, scene_with

import libcontact as ct

SCENES = Path(__file__).parents[2] / "tutorials" / "scenes"


def test_the_cantilever_of_the_tutorials_bends_as_beam_theory_says():
    run = ct.Scene.load(SCENES / "cantilever.toml").run(output=False)
    beam = run.state["beam"]
    tip = beam.displacement[beam.mesh.nodes[:, 0] == 100, 2].mean()
    bending, shear = (
        1000 * 100**3 / (3 * 2.1e5 * 10**4 / 12),
        1000 * 100 / (5 / 6 * 100 * 2.1e5 / 2.6),
    )
    assert run.time[-1] < 0.04
    assert tip == pytest.approx(
        -(bending + shear), rel=0.015
    )  # the clamped end cannot expand laterally, which makes the beam 1 % stiffer


def pressed(history, **time):
    """A block above another in a smooth box, with a gap of one element; its top goes down by five elements after the
    gap closes."""
    scene = scene_with("soft", young=1000, poisson=0.3, density=1e-9, units=MILLIMETRES)
    scene.add_body("low", material="soft", box=box_of([0, 0, 0], [3, 2, 10], [3, 2, 10]))
    scene.add_body("high", material="soft", box=box_of([0, 0, 11], [3, 2, 10], [3, 2, 10]))
    scene.add_contact("low.z_max", "high.z_min", beta=2)
    for body in ("low", "high"):
        for axis in "xy":
            scene.add_support(f"{body}.{axis}_min", fix=axis).add_support(
                f"{body}.{axis}_max", fix=axis
            )
    scene.add_support("low.z_min", fix="z").add_support(
        "high.z_max", fix="z", travel=[0, 0, -6], history=history
    )
    return (
        scene.add("damping", relaxation=True)
        .set_time(end=2e-2, fraction=0.7, until_static=1e-8, **time)
        .run()
    )


def bar_at_rest(element, boxes, **contact):
    """Bars along x in a row, held at their ends and relaxed until they are at rest."""
    scene = scene_with("steel", young=2.1e5, poisson=0.0, density=7.8e-9, units=MILLIMETRES)
    for name, (x, length) in boxes.items():
        box = box_of([x, 0, 0], [length, 2, 2], [5, 1, 1])
        scene.add_body(name, material="steel", element=element, box=box)
    scene.add_support(f"{name}.x_max", fix="x").add_damping(relaxation=True)
    return scene.set_time(end=1e-3, until_static=1e-8)


@pytest.mark.parametrize("element", ["hex8", "hex20"])
def test_bars_that_overlap_press_each_other(element):
    """Two bars of 10 mm, .01 too long together: the stress is E .01 / 20, but for the penalty's .25 %. Relaxation slows
    the points, which must not take the rest of the overlap for energy that nobody gave (eq:relaxation-force)."""
    scene = bar_at_rest(element, {"one": (0, 10), "two": (9.99, 10)}).add_support(
        "one.x_min", fix="x"
    )
    scene.add_contact("one.x_max", "two.x_min", initial_penetration="remove", removal_time=2e-5)
    run = scene.run(output=False)
    for body in run.state.values():
        assert body.stress[:, 0] == pytest.approx(-105.0, rel=4e-3)


@pytest.mark.parametrize("restitution", [0.0, 1.0])
def test_a_plane_that_moves_gives_a_relaxed_bar_its_work_and_no_more(restitution):
    scene = bar_at_rest("hex8", {"bar": (0, 10)})
    plane = {"point": [0, 0, 0], "normal": [1, 0, 0]}
    ramp = {"time": [0, 2e-5], "value": [0, 1]}
    scene.add_obstacle(
        surface="bar.x_min", plane=plane, travel=[0.01, 0, 0], history=ramp, restitution=restitution
    )
    run = scene.set_output(every=1).run(output=False)
    assert run.state["bar"].stress[:, 0] == pytest.approx(-210.0, rel=6e-3)  # the penalty's .5 %
    rise = np.maximum.accumulate(run.energy["total"])[-1] - run.energy["total"][0]
    assert rise < 1e-9 * run.energy["strain"].max()


@pytest.mark.parametrize("rigid", [False, True])
def test_a_plane_that_moves_presses_a_bar_through_a_block(rigid):
    """The plane's .01 mm are the bar's if the block between them is rigid, else those of both."""
    scene = bar_at_rest("hex8", {"block": (0, 4), "bar": (4, 10)})
    if rigid:
        scene.add_rigid(body="block", fixed=["y", "z", "rx", "ry", "rz"])
    scene.add_contact("block.x_max", "bar.x_min")
    ramp = {"time": [0, 2e-5], "value": [0, 1]}
    plane = {"point": [0, 0, 0], "normal": [1, 0, 0]}
    scene.add_obstacle(surface="block.x_min", plane=plane, travel=[0.01, 0, 0], history=ramp)
    run = scene.set_output(every=1).run(output=False)
    stress = -2.1e5 * 0.01 / (10.0 if rigid else 14.0)
    assert run.state["bar"].stress[:, 0] == pytest.approx(stress, rel=1.2e-2)  # two penalties
    rise = np.maximum.accumulate(run.energy["total"])[-1] - run.energy["total"][0]
    assert rise < 1e-9 * run.energy["strain"].max()


def test_contacts_come_to_rest():
    """Contacts and obstacles of a relaxed scene have restitution 0 unless they give one; two blocks of 2 and 3
    elements, pressed together, then rest within 400 steps."""
    scene = scene_with("elastic", young=1000.0, poisson=0.0, density=1.0, title="blocks")
    for name, z, n in (("lower", -0.5, 2), ("upper", 0.0, 3)):
        box = box_of([0, 0, z], [1, 1, 0.5], [n, n, 1])
        scene.add_body(name, material="elastic", element="hex20", box=box)
        scene.add_support(f"{name}.x_min", fix="x").add_support(f"{name}.y_min", fix="y")
    scene.add_support("lower.z_min", fix="z").add_contact("lower.z_max", "upper.z_min")
    scene.add("load", surface="upper.z_max", pressure=1.0)
    scene.set_time(end=2.0, fraction=0.9, until_static=1e-5).set_output(every=10**6)
    assert read(scene.data).contact[0].restitution == 1.0
    scene.add("damping", relaxation=True)
    assert read(scene.data).contact[0].restitution == 0.0
    given = scene.data
    given["contact"][0]["restitution"] = 1.0
    assert read(given).contact[0].restitution == 1.0
    del given["contact"][0]["restitution"]
    given["contact"][0]["enforcement"] = "penalty"  # which has no such key
    read(given)
    run = scene.run()
    assert run.steps[-1] < 400 and run.pressure["contact"][0]["pressure"].min() > 0.98


def test_one_jump_into_contact_ends_where_fifty_small_ones_end():
    """Elastic bodies have no memory: 5 elements into contact at once, or in 50 jumps with time to come to rest between
    them."""
    steps = np.linspace(0, 1, 51)[1:]
    small = {
        "time": np.repeat(np.arange(50) * 1e-4, 2),
        "value": np.concatenate([[0], np.repeat(steps, 2)])[:100],
    }
    one, many = pressed({"time": [0], "value": [1]}), pressed(small)
    for body in ("low", "high"):
        np.testing.assert_allclose(
            one.state[body].displacement, many.state[body].displacement, atol=1e-6
        )
    # 5 mm compress 20 mm that cannot expand laterally, and slightly the penalty beta E / h
    stiff = 1000 * 0.7 / (1.3 * 0.4)
    for run in (one, many):
        np.testing.assert_allclose(
            run.contact[0]["raw_pressure"], 5 / (20 / stiff + 1 / 2000), rtol=1e-6
        )
    assert one.time[-1] < 1e-3 < 49e-4 < many.time[-1]


def test_a_support_on_a_path_is_there_in_time_and_in_the_ledger():
    scene = scene_with("soft", young=1000, poisson=0, density=1e-9, units=MILLIMETRES)
    scene.add_body("bar", material="soft", box=box_of([0, 0, 0], [10, 1, 1], [200, 1, 1]))
    scene.add_support(
        "bar.x_min", fix="x", travel=[0.1, 0, 0], history={"time": [0, 4e-6], "value": [0, 1]}
    )
    run = scene.set_time(end=5e-6, fraction=0.9).run()
    bar = run.state["bar"]
    np.testing.assert_allclose(bar.displacement[bar.mesh.nodes[:, 0] == 0, 0], 0.1, rtol=1e-13)
    rho_c, V = 1e-9 * 1e6, 0.1 / 4e-6
    assert run.energy["external"][-1] == pytest.approx(rho_c * V**2 * 4e-6, rel=0.03)
    assert np.abs(run.energy["balance"]).max() < 1e-12 * run.energy["external"][-1]
    assert "on a path" in scene.explain()


def test_a_run_that_does_not_come_to_rest_says_so():
    scene = scene_with("soft", young=1000, poisson=0, density=1e-9, units=MILLIMETRES)
    scene.add_body(
        "bar", material="soft", box=box_of([0, 0, 0], [10, 1, 1], [10, 1, 1])
    ).add_support("bar.x_min", fix="xyz")
    scene.add("gravity", acceleration=[1, 0, 0]).set_time(end=1e-4, fraction=0.9, until_static=1e-6)
    with pytest.warns(UserWarning, match="before it comes to rest"):
        scene.run()


@pytest.mark.parametrize(
    "change, words",
    [
        (lambda s: s.add("damping", rate=3, relaxation=True), ["damping", "beside"]),
        (lambda s: s.add("damping", relaxation=False), ["damping.relaxation", "true"]),
        (lambda s: s.add("damping"), ["damping", "rate", "relaxation"]),
        (
            lambda s: s.add_support("bar.x_min", fix="x", travel=[1, 0, 0]),
            ["support[0].travel", "history"],
        ),
        (
            lambda s: s.add_support(
                "bar.x_min", fix="x", travel=[0, 1, 0], history={"time": [0], "value": [1]}
            ),
            ["travel[1]", "not in fix"],
        ),
        (
            lambda s: s.add_support(
                "bar.x_min",
                fix="x",
                velocity=[1, 0, 0],
                travel=[1, 0, 0],
                history={"time": [0], "value": [1]},
            ),
            ["support[0].velocity", "beside"],
        ),
        (
            lambda s: s.set_time(end=1, fraction=0.5, until_static=0),
            ["time.until_static", "at least"],
        ),
    ],
)
def test_what_contradicts_itself_is_refused(change, words):
    scene = scene_with("soft", young=1000, poisson=0, density=1e-9, units=MILLIMETRES)
    scene.add_body("bar", material="soft", box=box_of([0, 0, 0], [10, 1, 1], [10, 1, 1]))
    with pytest.raises(ct.SceneError) as refused:
        change(scene)
    for word in words:
        assert word in str(refused.value)


def test_a_bar_bounces_twice_and_is_back():
    """
    Doyen, Ern and Piperno 2011: contact for 2 L / c from t = 1 and from 3.6667. Meanwhile gravity shakes the bar about
    its static shape, half a swing: it leaves the floor lower by twice rho g L^2 / (3 E) in the mean, and the second
    bounce takes that back.
    """
    run = ct.Scene.load(SCENES / "bouncing_bar.toml").run(output=False)
    weight = 0.1 * 0.1 * 10 * 10
    height = run.energy["gravity"] / weight
    touching = run.time[run.energy["obstacle"] > 0]
    first, second = touching[touching < 2.6], touching[touching > 2.6]
    np.testing.assert_allclose(
        [first[0], first[-1], second[0], second[-1]], [1, 1.6667, 3.6667, 4.3333], atol=0.06
    )
    assert np.interp(2.6667, run.time, height) - height[0] == pytest.approx(
        -2 * 10 * 10**2 / (3 * 900), abs=0.1
    )
    assert height[-1] - height[0] == pytest.approx(0, abs=0.15)
    # Energy never grows; each impact takes the energy of the nodes that meet the floor, half an element of a hundred,
    # and at most a fifth more.
    gain = (run.energy["total"] - run.energy["total"][0]) / (5 * weight)
    assert gain.max() < 1e-12 and gain.min() > -2 * 1.2 / (2 * 100)
    assert np.abs(run.energy["balance"]).max() < 1e-12 * 5 * weight
