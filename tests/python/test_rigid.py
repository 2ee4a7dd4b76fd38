"""Rigid bodies in scenes: a restart, threads, what is written, explained and refused."""

import numpy as np
import pytest
from libcontact.mesh import Mesh
from libcontact.pictures.rigid import shape_at
from scenes import box_of, continued, same_state, scene_with

import libcontact as ct

SPIN = {"axis": [0, 3, 4], "rate": 2.0}


def thrown(end=0.4, threads=1, **rigid):
    scene = scene_with("soft", young=900.0, poisson=0.0, density=1.0)
    scene.add_body(
        "box",
        material="soft",
        box=box_of([0, 0, 0], [1, 2, 3], [4, 4, 4]),
        velocity=[1, 0, 5],
        spin=SPIN,
    )
    scene.add_body("bar", material="soft", box=box_of([5, 0, 0], [4, 1, 1], [8, 2, 2]))
    scene.add("gravity", acceleration=[0, 0, -10]).add("rigid", body="box", **rigid)
    scene.add_support(
        "bar.x_min", fix="x", travel=[0.1, 0, 0], history={"time": [0, 1], "value": [0, 1]}
    )
    return scene.set_time(end=end, dt=0.004).set_run(threads=threads)


def test_a_thrown_body_turns_and_keeps_its_shape():
    run = thrown().run()
    body, t = run.state["box"], 0.4
    x = body.nodes + body.displacement
    middle, start = x.mean(axis=0), body.nodes.mean(axis=0)
    np.testing.assert_allclose(middle - start, [t, 0, 5 * t - 5 * t * t], atol=1e-12)
    X = body.nodes - start
    np.testing.assert_allclose((x - middle) @ (x - middle).T, X @ X.T, atol=1e-12)
    assert np.abs(body.displacement - body.displacement.mean(axis=0)).max() > 0.5
    assert run.energy.dtype.names[-1] == "rigid" and not body.stress.any()
    # Energy of weight and motion; the work of the rigid effect vanishes with the square of the step.
    energy = run.energy["kinetic"] + run.energy["strain"] + run.energy["gravity"]
    np.testing.assert_allclose(energy - run.energy["external"], run.energy["total"], rtol=1e-12)
    assert np.abs(run.energy["rigid"]).max() < 1e-4 * run.energy["kinetic"].max()
    np.testing.assert_allclose(run.energy["balance"], 0.0, atol=1e-11)


def test_threads_and_a_restart_have_the_same_bits(tmp_path):
    whole = thrown().run(output=tmp_path / "whole.vtkhdf")
    assert same_state(whole, thrown(threads=2).run())
    assert same_state(whole, continued(thrown(), tmp_path, 0.2))
    read = ct.Run.load(tmp_path / "whole.vtkhdf").state["box"]
    assert not read.stress.any() and np.array_equal(
        read.displacement, whole.state["box"].displacement
    )


def test_a_file_without_stress_has_none_for_a_rigid_body(tmp_path):
    scene = thrown().set_output(file=str(tmp_path / "u.vtkhdf"), fields=["displacement"])
    scene.run()
    state = ct.Run.load(tmp_path / "u.vtkhdf").state
    assert not state["box"].stress.any() and state["bar"].stress.any()


def test_a_rigid_body_is_explained():
    text = str(thrown().explain())
    assert "kernel rigid (a rigid body has no strain)" in text
    assert "rigid: box moves by its forces" in text
    alone = scene_with("soft", young=9.0, poisson=0.0, density=1.0)
    alone.add_body("bar", material="soft", box=box_of([0, 0, 0], [1, 1, 1], [1, 1, 1]))
    assert "no [[rigid]]: all bodies deform" in str(alone.set_time(end=1.0, fraction=0.5).explain())


def bar_with_head(cells, law="linear", **keys):
    """A bar of one mesh along x, whose last elements are its rigid head."""
    x, edge = np.linspace(-1, 0.1, 11 * cells + 1), 0.1 / cells
    nodes, elements = lattice(x, np.array([0, edge]), np.array([0, edge]))
    head = np.flatnonzero(nodes[elements].mean(axis=1)[:, 0] > 0)
    scene = scene_with("m", young=1.0, poisson=0.0, density=1.0, law=law)
    mesh = {"nodes": nodes, "elements": elements, "sets": {"head": {"elements": head}}}
    scene.add_body("bar", material="m", **mesh, **keys)
    return scene.add("rigid", set="bar.head"), edge


def test_a_rigid_head_pulls_a_rod_as_a_mass_on_a_dashpot():
    """Its velocity is v exp(-Z t / M) until the wave returns; M contains half of the element beside it."""
    worst = []
    for cells in (10, 20):
        scene, edge = bar_with_head(cells)
        M, v = 0.1 + edge / 2, 1e-3
        scene.add_probe("at", body="bar", point=[0.1, 0, 0], quantities=["velocity"])
        scene.add("load", surface="bar.x_max", traction=[v, 0, 0])
        run = scene.set_time(end=1.8, fraction=0.8).run()
        t, u = run.probes["at"]["time"], run.probes["at"]["velocity"][:, 0] / v
        worst += [np.abs(u - (1 - np.exp(-t / M))).max()]
        x = run.state["bar"].displacement[run.state["bar"].nodes[:, 0] > -1e-9]
        np.testing.assert_allclose(x, x[0] + 0 * x, atol=1e-15)
        assert "rigid: bar.head moves by its forces" in str(scene.explain())
    assert worst[0] < 0.02 and worst[1] < 0.6 * worst[0]


def test_a_rigid_head_keeps_momentum_and_angular_momentum():
    """A bar that tumbles; its head keeps its shape, and the rest deforms."""
    spin = {"axis": [0, 1, 2], "rate": 0.3}
    scene, _ = bar_with_head(2, "neo_hookean", velocity=[0.1, 0, 0], spin=spin)
    run = scene.set_time(end=8.0, fraction=0.5).set_output(every=10).run()
    for name in ("p", "L"):
        found = run.momentum[name]
        np.testing.assert_allclose(found, found[0] + 0 * found, atol=1e-13 * np.abs(found).max())
    X = run.state["bar"].nodes
    x, head = X + run.state["bar"].displacement, X[:, 0] > -1e-9
    r, R = x[head] - x[head].mean(axis=0), X[head] - X[head].mean(axis=0)
    np.testing.assert_allclose(r @ r.T, R @ R.T, atol=1e-12)
    ends = [x[X[:, 0] == end].mean(axis=0) for end in (X[:, 0].min(), 0.1)]
    assert abs(np.linalg.norm(ends[1] - ends[0]) - 1.1) > 1e-4


@pytest.mark.parametrize("carried", [False, True], ids=["meshed", "plane with mass"])
def test_a_rod_that_hits_a_rigid_mass_is_slowed_as_by_a_dashpot(carried):
    """The mass M gets the velocity v (1 - exp(-Z t / M)) from a rod of the impedance Z = A sqrt(E rho), until the
    wave comes back from the other end. The error falls with the length of the elements."""
    worst = []
    for cells in (100, 200):
        edge, M = 1 / cells, 0.5
        scene = scene_with("rod", young=1.0, poisson=0.0, density=1.0)
        scene.add_material("heavy", young=1.0, poisson=0.0, density=5.0)
        rod = box_of([-1, 0, 0], [1, edge, edge], [cells, 1, 1])
        scene.add_body("rod", material="rod", box=rod, velocity=[1e-3, 0, 0])
        place = [0.1, edge / 2, edge / 2] if carried else [0, 0, 0]
        if carried:
            small = {"mass": M * edge**2, "moments": 3 * [M * (edge / 10) ** 2], "centre": place}
            scene.add_body("mass", material="rod", inertia=small)
            wall = {"point": [0, 0, 0], "normal": [-1, 0, 0]}
            scene.add("obstacle", surface="rod.x_max", plane=wall, carrier="mass")
        else:
            mass = box_of([0, 0, 0], [M / 5, edge, edge], [2, 1, 1])
            scene.add_body("mass", material="heavy", box=mass)
            scene.add_contact("rod.x_max", "mass.x_min")
        scene.add("rigid", body="mass")
        for face in ("y_min", "z_min", "y_max", "z_max"):
            scene.add_support(f"rod.{face}", fix=face[0])
        scene.add_probe("at", body="mass", point=place, quantities=["velocity"])
        run = scene.set_time(end=1.4, fraction=0.8).run()
        t, v = run.probes["at"]["time"], run.probes["at"]["velocity"][:, 0] / 1e-3
        worst += [np.abs(v - (1 - np.exp(-t / M))).max()]
        momentum = run.momentum["p"].reshape(len(run.energy), 2, 3).sum(axis=1)[:, 0]
        np.testing.assert_allclose(momentum, momentum[0], rtol=1e-12)
        # The contact of the plane lasts for 100 travel times, of which the dashpot's loss is returned in 40.
        lost = 1.0 - run.energy["total"] / run.energy["total"][0]
        assert lost.min() > -1e-14 and lost.max() < (1e-4 if carried else 1e-6)
    assert worst[0] < 2e-3 and worst[1] < 0.6 * worst[0]


def test_a_rigid_ball_rolls_down_an_incline():
    """Without sliding it has 1 / (1 + I / (M R²)) of the acceleration, with the inertia of its lumped masses."""
    scene = scene_with("soft", young=2e4, poisson=0.0, density=1.0)
    ball = {"centre": [0, 0, 1], "radius": 1.0, "cells": [2, 40]}
    scene.add_body("ball", material="soft", ball=ball).add("rigid", body="ball")
    g, angle, end = 9.81, 0.3, 0.8
    scene.add("gravity", acceleration=[g * np.sin(angle), 0, -g * np.cos(angle)])
    plane = {"point": [0, 0, 0], "normal": [0, 0, 1]}
    scene.add("obstacle", surface="ball.outer", plane=plane, friction=0.5)
    run = scene.set_time(end=end, dt=1e-3).run()
    shift = run.state["ball"].displacement.mean(axis=0)
    rolls = 0.5 * 5 / 7 * g * np.sin(angle) * end**2
    # Facets: the ball rolls on corners and bounces a little.
    np.testing.assert_allclose(shift[0], rolls, rtol=0.02)
    total = run.energy["total"]
    assert np.diff(total).max() < 1e-5 * run.energy["kinetic"].max()


def lattice(x, y, z):
    """Nodes and elements of bricks between coordinates along the axes."""
    cells = [len(along) - 1 for along in (x, y, z)]
    mesh = Mesh.box("hex8", [0, 0, 0], cells, cells)
    i, j, k = np.rint(mesh.nodes).astype(int).T
    return np.column_stack([np.array(x)[i], np.array(y)[j], np.array(z)[k]]), mesh.elements


@pytest.mark.parametrize("carried", [False, True], ids=["meshed", "sphere with mass"])
def test_a_rigid_sphere_hits_an_elastic_plate_as_hertz_says(carried):
    """A quarter of a plate whose size is 20 radii of contact, with 4 elements in this radius a = 0.05 R; the impact
    lasts as long as waves need for 8 times the plate."""
    a, last, poisson = 0.05, 15.0, 0.3
    modulus, depth = 1.0 / (1.0 - poisson**2), a * a
    speed = 2.94 * depth / last
    mass = 16 * modulus * depth**2.5 / (15 * speed**2) / 4
    x = [*np.arange(0, 1.3 * a, a / 4)]
    while x[-1] < 20 * a:
        x.append(x[-1] + 1.5 * (x[-1] - x[-2]))
    across = np.arange(-a / 2, 1.6 * a, a / 4)
    nodes, elements = lattice(across, across, np.array([0.0, 0.2]))
    nodes[:, 2] += 1 - np.sqrt(1 - nodes[:, 0] ** 2 - nodes[:, 1] ** 2)
    scene = scene_with("soft", young=1.0, poisson=poisson, density=1.0)
    heavy = mass / (0.2 * (across[-1] - across[0]) ** 2)
    scene.add_material("heavy", young=1.0, poisson=0.0, density=heavy)
    falls = {"material": "heavy", "velocity": [0, 0, -speed]}
    plate = dict(zip(("nodes", "elements"), lattice(x, x, -np.array(x[::-1]))))
    scene.add_body("plate", material="soft", **plate)
    if carried:
        small = {"mass": mass, "moments": 3 * [0.4 * mass], "centre": [0, 0, 1]}
        scene.add_body("ball", inertia=small, **falls)
        sphere = {"centre": [0, 0, 1], "radius": 1}
        scene.add("obstacle", surface="plate.z_max", sphere=sphere, carrier="ball")
    else:
        scene.add_body("ball", nodes=nodes, elements=elements, **falls)
        scene.add_contact("ball.outer", "plate.z_max")
    scene.add("rigid", body="ball", fixed=["x", "y", "rx", "ry", "rz"])
    for face in ("x_min", "y_min", "z_min"):
        scene.add_support(f"plate.{face}", fix=face[0])
    scene.add_probe("on", resultant="obstacle" if carried else "contact")
    run = scene.set_time(end=1.1 * last, fraction=0.9).run()
    force, time = np.abs(run.probes["on"]["force"][:, 2]), run.probes["on"]["time"]
    on = time[force > 0]
    np.testing.assert_allclose(force.max(), 4 / 3 * modulus * depth**1.5 / 4, rtol=0.02)
    np.testing.assert_allclose(on[-1] - on[0], last, rtol=0.02)
    own = run.momentum[run.momentum["body"] == 1]
    blow = own["obstacle_impulse" if carried else "contact_impulse"]
    given = blow[:, 2] + own["support_impulse"][:, 2]
    np.testing.assert_allclose(own["p"][:, 2] - own["p"][0, 2], given, atol=1e-12 * mass * speed)
    assert own["p"][-1, 2] > 0.995 * mass * speed
    energy = run.energy["total"] / run.energy["kinetic"][0]
    assert np.diff(energy).max() < 1e-12 and energy[-1] > 0.9999


def test_a_sphere_with_mass_comes_to_rest_on_a_plate_as_hertz_says():
    """Dynamic relaxation of a sphere under its weight, on a quarter of a plate of 80 contact radii with four elements
    in each: its approach is δ = (3 P / (4 E* √R))^(2/3)."""
    a, modulus = 0.05, 1.0 / (1.0 - 0.3**2)
    weight, mass = 4 / 3 * modulus * a**3 / 4, 0.3
    x = [*np.arange(0, 2 * a, a / 4)]
    while x[-1] < 80 * a:
        x.append(x[-1] + 1.4 * (x[-1] - x[-2]))
    scene = scene_with("soft", young=1.0, poisson=0.3, density=1.0)
    plate = dict(zip(("nodes", "elements"), lattice(x, x, -np.array(x[::-1]))))
    scene.add_body("plate", material="soft", **plate)
    for face in ("x_min", "y_min", "z_min"):
        scene.add_support(f"plate.{face}", fix=face[0])
    small = {"mass": mass, "moments": 3 * [0.4 * mass], "centre": [0, 0, 1]}
    scene.add_body("ball", material="soft", inertia=small)
    scene.add("rigid", body="ball", fixed=["x", "y", "rx", "ry", "rz"])
    sphere = {"centre": [0, 0, 1], "radius": 1}
    scene.add("obstacle", surface="plate.z_max", sphere=sphere, carrier="ball")
    scene.add("gravity", acceleration=[0, 0, -weight / mass], bodies=["ball"])
    scene.add("damping", relaxation=True).add_probe("on", resultant="obstacle")
    run = scene.set_time(end=36.0, fraction=0.9).run()
    force = np.abs(run.probes["on"]["force"][-1, 2])
    np.testing.assert_allclose(force, weight, rtol=0.005)
    depth = -run.state["ball"].displacement[:, 2].mean()
    np.testing.assert_allclose(depth, a * a * (force / weight) ** (2 / 3), rtol=0.02)


@pytest.mark.parametrize(("angle", "friction"), [(20.0, 0.5), (60.0, 0.2)], ids=["rolls", "slides"])
def test_a_sphere_with_mass_runs_down_an_elastic_plate(angle, friction):
    """A solid sphere on an inclined plate: 5/7 g sin α if 2/7 tan α < μ, else g (sin α - μ cos α). Its weight grows
    in the first half of a second, so that it does not bounce."""
    edge, alpha, start, end = 1 / 8, np.radians(angle), 0.5, 2.0
    scene = scene_with("soft", young=1e5, poisson=0.3, density=0.1)
    plate = box_of([-1, -0.5, -0.25], [3, 1, 0.25], [24, 8, 2])
    solid = {"mass": 1.0, "moments": 3 * [0.4], "centre": [0, 0, 1]}
    scene.add_body("plate", material="soft", box=plate)
    scene.add_body("ball", material="soft", inertia=solid).add("rigid", body="ball")
    scene.add_support("plate.z_min", fix="xyz")
    sphere = {"centre": [0, 0, 1], "radius": 1}
    scene.add("obstacle", surface="plate.z_max", sphere=sphere, carrier="ball", friction=friction)
    down = [np.sin(alpha), 0, -np.cos(alpha)]
    grows = {"time": [0, start], "value": [0, 1]}
    scene.add("gravity", acceleration=down, bodies=["ball"], history=grows)
    scene.add("damping", rate=50.0, bodies=["plate"])
    run = scene.set_time(end=end, fraction=0.9).run()
    own = run.momentum[run.momentum["body"] == 1]
    t, v = own["time"], own["p"][:, 0]
    late = t > 1.2 * start
    slides = 2 / 7 * np.tan(alpha) > friction
    wanted = np.sin(alpha) - friction * np.cos(alpha) if slides else 5 / 7 * np.sin(alpha)
    np.testing.assert_allclose(np.polyfit(t[late], v[late], 1)[0], wanted, rtol=0.01)
    assert np.abs(own["p"][:, 1]).max() < 1e-12 * v[-1]
    assert run.state["ball"].displacement.mean(axis=0)[0] > 2 * edge


def test_a_brick_has_the_mass_and_the_moments_that_are_given():
    """Its momentum and angular momentum at t = 0 are m v and I ω (eq:inertia-brick)."""
    given = {"mass": 3.0, "moments": [0.7, 0.9, 1.1], "centre": [1.0, -2.0, 0.5]}
    scene = scene_with("any", young=1.0, poisson=0.0, density=17.0)
    v, w = [0.3, 0.2, 0.1], np.array([0.01, 0.02, 0.02])
    spin = {"axis": w.tolist(), "rate": 0.03}
    scene.add_body("lump", material="any", inertia=given, velocity=v, spin=spin)
    assert "mass and moments of inertia" in scene._repr_html_()
    run = scene.add("rigid", body="lump").set_time(end=0.1, dt=0.1).run()
    first = run.momentum[0]
    np.testing.assert_allclose(first["p"], np.multiply(3.0, v), rtol=1e-14)
    own = first["L"] - np.cross(given["centre"], first["p"])
    np.testing.assert_allclose(own, given["moments"] * w, rtol=1e-12)
    assert "inertia of these masses over that of the body: 1, 1, 1" in str(scene.explain())


def test_a_picture_has_an_obstacle_where_its_carrier_is():
    """A cylinder flies freely and turns by ω t about an axis through the centre of its carrier."""
    scene = scene_with("any", young=1e3, poisson=0.0, density=1.0)
    scene.add_body("bar", material="any", box=box_of([9, 9, 9], [1, 1, 1], [1, 1, 1]))
    given = {"mass": 3.0, "moments": [1.0, 1.0, 1.0], "centre": [1, 0, 0]}
    spin, v = {"axis": [0, 0, 1], "rate": 2.0}, np.array([0.5, 0, 0.25])
    scene.add_body("lump", material="any", inertia=given, velocity=v.tolist(), spin=spin)
    cylinder = {"centre": [1, 0.5, 0], "axis": [2, 0, 0], "radius": 0.1}
    scene.add("rigid", body="lump").add(
        "obstacle", surface="bar.x_min", cylinder=cylinder, carrier="lump"
    )
    run = scene.set_time(end=0.4, dt=1e-3).run()
    name, shape = shape_at(scene.data["obstacle"][0], run.state)
    c, s = np.cos(0.8), np.sin(0.8)
    np.testing.assert_allclose(shape["axis"], [2 * c, 2 * s, 0], atol=1e-5)
    centre = [1, 0, 0] + 0.4 * v + [-0.5 * s, 0.5 * c, 0]
    np.testing.assert_allclose(shape["centre"], centre, atol=1e-5)
    assert name == "cylinder" and run.plot(view="z_max")


@pytest.mark.parametrize("arm", [0.0, 1.0])
def test_only_the_path_of_a_spinning_sphere_divides_a_step(arm):
    """By .2 rad a step a sphere of radius .25 above a plate turns about its centre; or it moves by .2, being on a lever
    of length 1, and could pass through a body (eq:tunnelling)."""
    scene = scene_with("soft", young=1e3, poisson=0.0, density=1e6)
    plate = box_of([-1.5, -1.5, -1], [3, 3, 0.5], [20, 20, 1])
    scene.add_body("plate", material="soft", box=plate)
    small = {"mass": 1.0, "moments": [1.0, 1.0, 1.0]}
    spin = {"axis": [0, 0, 1], "rate": 20.0}
    scene.add_body("lever", material="soft", inertia=small, spin=spin).add("rigid", body="lever")
    sphere = {"centre": [arm, 0, 0], "radius": 0.25}
    scene.add("obstacle", surface="plate.z_max", sphere=sphere, carrier="lever")
    run = scene.set_time(end=0.2, dt=0.01).run()
    assert (run.dt < 0.01) == (arm > 0)


def test_elastic_slip_turns_with_the_obstacle():
    """A block rides on a turntable, and soft springs of friction hold it on its circle: it lags by no angle, as it
    would by 2 π |e| = .06 if its slip stayed in space."""
    scene = scene_with("any", young=1e3, poisson=0.0, density=1.0)
    block = box_of([0.95, -0.05, 0], [0.1, 0.1, 0.1], [2, 2, 1])
    spin = {"axis": [0, 0, 1], "rate": 1.0, "centre": [0, 0, 0]}
    scene.add_body("block", material="any", box=block, spin=spin).add("rigid", body="block")
    table = {"mass": 1e3, "moments": [1e3, 1e3, 1e3]}
    scene.add_body("table", material="any", inertia=table, spin=spin)
    scene.add("rigid", body="table", fixed=["x", "y", "z", "rx", "ry"])
    plane = {"point": [0, 0, 0], "normal": [0, 0, 1]}
    epsilon, mass = 1e3, 1e-3
    soft = {"friction": 0.9, "epsilon": epsilon, "tangent": mass / (0.01 * epsilon * 0.1**2)}
    scene.add("obstacle", surface="block.z_min", plane=plane, carrier="table", **soft)
    scene.add("gravity", acceleration=[0, 0, -10], bodies=["block"])
    run = scene.set_time(end=2 * np.pi, dt=2e-3).run()
    middle = np.array([1.0, 0.0]) + run.state["block"].displacement.mean(axis=0)[:2]
    assert 1.0 < np.linalg.norm(middle) < 1.03
    assert abs(np.arctan2(middle[1], middle[0])) < 0.01


def test_two_tumbling_boxes_collide_and_keep_their_momenta():
    """Momentum, angular momentum and total energy to round-off. The solver's motion is linear in the forces, so the
    kinetic energy is kept up to the square of the angle of a step, here 0.0015 (eq:rigid-turned)."""
    scene = scene_with("soft", young=1000.0, poisson=0.0, density=1.0)
    one, two = (
        box_of([0, 0, 0], [1, 0.3, 0.3], [6, 2, 2]),
        box_of([0.2, 0.8, -0.1], 3 * [0.4], 3 * [3]),
    )
    scene.add_body("a", material="soft", box=one, spin={"axis": [0, 0, 1], "rate": 1.5})
    spin = {"axis": [1, 0.5, 0], "rate": 1.0}
    scene.add_body("b", material="soft", box=two, velocity=[0, -1, 0], spin=spin)
    scene.add("rigid", body="a").add("rigid", body="b").add_contact("a.outer", "b.outer")
    run = scene.set_time(end=1.2, dt=1e-3).set_output(every=10).run()
    for name in ("p", "L"):
        both = run.momentum[name].reshape(len(run.energy), 2, 3)
        np.testing.assert_allclose(
            both.sum(axis=1), both[0].sum(axis=0) + 0 * both[:, 0], atol=1e-14
        )
        assert np.abs(both[-1, 0] - both[0, 0]).max() > 1e-3
    kinetic = run.energy["kinetic"]
    np.testing.assert_allclose(kinetic[-1], kinetic[0], rtol=5e-6)
    np.testing.assert_allclose(run.energy["total"], kinetic[0], rtol=1e-14)
    assert np.abs(run.energy["rigid"]).max() > 1e-5 * kinetic[0]


REFUSED = [
    ({"rigid": [{"body": "bax"}]}, "rigid[0].body", 'did you mean "box"'),
    ({"rigid": [{"body": "box", "fixed": ["w"]}]}, "rigid[0].fixed[0]", "rx"),
    ({"rigid": [{"body": "box"}, {"body": "box"}]}, "rigid[1].body", "rigid already (rigid[0])"),
    (
        {"rigid": [{"body": "box"}, {"set": "box.x_min"}]},
        "rigid[1].set",
        "rigid already (rigid[0])",
    ),
    ({"rigid": [{"body": "box", "pivot": [0, 0, 0], "fixed": ["x"]}]}, "rigid[0].fixed", "pivot"),
    ({"support": [{"set": "box.x_min", "fix": ["x"]}]}, "support[0].set", "rigid[0].fixed"),
    ({"viscosity": {"bodies": ["box"]}}, "viscosity.bodies", "no strain rate"),
]


SPHERE = {"surface": "bar.x_max", "sphere": {"centre": [20, 0, 0], "radius": 1}, "carrier": "box"}


def lump(last):
    """The table of a body that is given by its moments of inertia."""
    inertia = {"mass": 1.0, "moments": [1.0, 1.0, last]}
    return {"name": "lump", "material": "soft", "inertia": inertia}


REFUSED += [
    ({"rigid": [], "obstacle": [SPHERE]}, "obstacle[0].carrier", 'add [[rigid]] with body = "box"'),
    ({"obstacle": [SPHERE | {"carrier": "bar"}]}, "obstacle[0].carrier", "can't touch it, too"),
    ({"obstacle": [SPHERE | {"velocity": [1, 0, 0]}]}, "obstacle[0].velocity", "give it to that body"),
    ({"obstacle": [SPHERE | {"enforcement": "penalty"}]}, "obstacle[0].enforcement", "carrier"),
    ({"body": [*thrown().data["body"], lump(1.0)]}, "body[2].inertia", 'with body = "lump"'),
    ({"body": [*thrown().data["body"], lump(2.0)]}, "body[2].inertia.moments[2]", "others, 2"),
]  # fmt: skip


@pytest.mark.parametrize(("change", "key", "reason"), REFUSED)
def test_what_a_rigid_body_cannot_have_is_refused(change, key, reason):
    data = {**thrown().data, **change}
    with pytest.raises(ct.SceneError) as caught:
        ct.Scene(data)
    assert caught.value.key == key and reason in caught.value.reason


def test_a_spin_of_a_small_strain_body_needs_rigid():
    data = thrown().data
    del data["rigid"]
    with pytest.raises(ct.SceneError, match="false strain") as caught:
        ct.Scene(data)
    assert caught.value.key == "body[0].spin"


def test_a_body_that_moves_along_a_fixed_freedom_is_refused():
    with pytest.raises(ct.SceneError, match="fixed freedoms are at rest"):
        thrown(fixed=["z"]).run()


def test_viscosity_of_all_bodies_leaves_a_rigid_one_out():
    run = thrown().add("viscosity").run()
    t = run.time[-1]
    shift = run.state["box"].displacement.mean(axis=0)
    np.testing.assert_allclose(shift, [t, 0, 5 * t - 5 * t * t], atol=1e-12)
