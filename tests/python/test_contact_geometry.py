"""Hard cases of contact in scenes: overlap at the start, tunnelling, points on edges and corners."""

import math
import re
import warnings

import numpy as np
import pytest
from libcontact.model import ENFORCEMENTS
from scenes import METRES, box_of, continued, same_state, scene_with

import libcontact as ct
from libcontact import loop

E, RHO = 100.0, 1.0
C = (E / RHO) ** 0.5


def blocks(
    overlap=0.0,
    speed=0.0,
    thick=1.0,
    face=("x_max", "x_min"),
    cells=(4, 2, 2),
    end=1.0,
    fraction=0.5,
    **contact,
):
    """Two blocks end to end along x that overlap by a length; the right one has a speed."""
    scene = scene_with("soft", young=E, poisson=0.0, density=RHO, title="blocks")
    scene.add_body("left", material="soft", box=box_of([-thick, 0, 0], [thick, 1, 1], list(cells)))
    scene.add_body(
        "right",
        material="soft",
        box=box_of([-overlap, 0, 0], [thick, 1, 1], list(cells)),
        velocity=[-speed, 0, 0],
    )
    scene.add_contact(f"left.{face[0]}", f"right.{face[1]}", beta=1.0, **contact)
    return scene.set_time(end=end, fraction=fraction).set_output(every=1)


def test_overlap_is_refused():
    with pytest.raises(
        ct.Error,
        match=r"32 points of its surfaces are inside at the start, the deepest by 0\.05 at .*face",
    ):
        blocks(0.05, initial_penetration="refuse").run()
    blocks(-0.05, initial_penetration="refuse").run()


@pytest.mark.parametrize("enforcement", ENFORCEMENTS)
def test_overlap_is_kept(enforcement):
    """Without other forces nothing moves; pressed together, the blocks have the gaps of two that only touch."""
    run = blocks(0.05, enforcement=enforcement, initial_penetration="keep").run()
    assert np.all(run.energy["total"] == 0.0)
    assert not run.state["right"].displacement.any()
    law = {"enforcement": enforcement}
    if enforcement != "penalty":
        law["restitution"] = (
            0.0  # when a point closed is found from its gap, which round-off changes
        )
    kept = blocks(0.05, 0.1, end=0.15, initial_penetration="keep", **law).run()
    touching = blocks(0.0, 0.1, end=0.15, **law).run()
    assert kept.energy["contact"][-1] > 0.0
    assert kept.state["right"].displacement == pytest.approx(
        touching.state["right"].displacement, abs=1e-12
    )


def test_a_kept_overlap_is_over_once_it_has_opened():
    """The blocks separate and come together again: they meet where their faces touch, not at the initial overlap."""
    run = blocks(0.05, -0.5, end=0.3, enforcement="penalty", initial_penetration="keep").run()
    assert run.penetration[0]["points"]["inside"] == 0
    assert np.all(run.energy["contact"] == 0.0)


@pytest.mark.parametrize("enforcement", ["penalty", "energy_controlled"])
def test_overlap_is_removed_gently(enforcement):
    """The start gap fades; the energy balance has its work and closes; slow removal leaves almost no energy in the
    bodies."""
    fast, slow = (
        blocks(
            0.01,
            end=T,
            fraction=0.2,
            enforcement=enforcement,
            initial_penetration="remove",
            removal_time=T,
        ).run()
        for T in (0.4, 3.2)
    )
    kick = (
        blocks(0.01, end=0.4, fraction=0.2, enforcement=enforcement, initial_penetration="force")
        .run()
        .energy["contact"][0]
    )
    for run in (fast, slow):
        # The total is the stored energy minus external work: it must not rise above its start, 0, and with the plain
        # penalty it is constant.
        scale = run.energy["external"].max()
        assert run.energy["external"][-1] > 0.0
        assert run.energy["total"].max() < 1e-3 * scale
        assert enforcement != "penalty" or run.energy["total"].min() > -1e-3 * scale
    assert slow.energy["external"][-1] < 0.1 * kick
    assert slow.penetration[0]["points"]["deepest"] < 0.1 * 0.01


def test_removal_needs_a_time():
    with pytest.raises(ct.SceneError, match="removal_time"):
        blocks(0.05, initial_penetration="remove").explain()
    with pytest.raises(ct.SceneError, match="removal_time"):
        blocks(0.05, removal_time=1.0).explain()


def test_a_step_through_a_body_is_refused(monkeypatch):
    # eq:tunnelling
    """A thin plate approaches another one by more than the thickness in a step, and the step may not be divided."""
    monkeypatch.setattr(loop, "MOST_PARTS", 1)
    scene = blocks(
        -0.5, 40 * C, thick=0.02, face=("outer", "outer"), cells=(1, 2, 2), end=0.02, fraction=0.9
    )
    with pytest.raises(
        ct.RunError,
        match=r"in the step to t = .* its surfaces \(face \d+ of the first, \d+ of the second\) may have come nearer",
    ):
        scene.run()


def test_the_text_of_a_fault_between_two_records_is_whole(monkeypatch):
    """The same plate, accelerated until it would pass through: time and step precede the message, and advice
    follows."""
    monkeypatch.setattr(loop, "MOST_PARTS", 1)
    scene = blocks(
        -0.5, thick=0.02, face=("outer", "outer"), cells=(1, 2, 2), end=0.2, fraction=0.9
    ).set_output(every=10**6)
    scene.add("gravity", acceleration=[-300, 0, 0], bodies=["right"])
    with pytest.raises(ct.RunError) as refused:
        scene.run()
    whole = (
        r"at t = \S+ \(step \d+\): contact: in the step .* have come nearer by \S+ and passed through each other; not more than \S+ is safe\. Take a smaller step\. "
        r"The last good state, t = 0 \(step 0\), is run\.state of this error; .*"
    )
    assert re.fullmatch(whole, str(refused.value)), str(refused.value)


def test_a_fast_body_that_is_far_away_is_not_refused():
    scene = blocks(
        -50.0,
        -40 * C,
        thick=0.02,
        face=("outer", "outer"),
        cells=(1, 2, 2),
        end=0.002,
        fraction=0.9,
    )
    scene.run()


def test_penetration_is_reported_at_corners_and_edges():
    """A corner of the right block enters the left one's face by less than 0.21 h: Gauss points do not detect it,
    Lobatto's do."""
    for rule in ("gauss", "lobatto"):
        scene = scene_with("soft", young=E, poisson=0.0, density=RHO, title="corner")
        scene.add_body("floor", material="soft", box=box_of([-1, -1, -1], [2, 2, 1], [4, 4, 2]))
        lattice = np.array([[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)])
        a, b = np.pi / 4, np.arctan(2**-0.5) - np.pi / 2
        turn = np.array(
            [[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]]
        ) @ np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
        nodes = lattice @ turn.T
        low = np.argmin(nodes[:, 2])
        nodes -= nodes[low] + np.array([0.25, 0.25, 0.05])
        scene.add_body("cube", material="soft", nodes=nodes, elements=[[0, 1, 3, 2, 4, 5, 7, 6]])
        scene.add_contact("floor.outer", "cube.outer", beta=1.0, points=rule).set_time(
            end=1e-3, fraction=0.1
        )
        found = scene.run().penetration[0]
        assert found["corners"]["deepest"] == pytest.approx(0.05, rel=0.02)
        assert found["corners"]["surface"] == "cube.outer"
        assert (found["points"]["inside"] > 0) == (rule == "lobatto")


@pytest.mark.parametrize("enforcement", ["penalty", "energy_controlled"])
def test_a_block_comes_on_from_the_side_at_a_depth(enforcement):
    """At an open border points come in at a depth; their gaps count from there (eq:admitted), so they create no energy,
    and the run warns. Closed surfaces have no border."""
    depth, side, beta, speed = 0.02, 0.4, 1.0, 0.5
    kinetic = 0.5 * RHO * side**3 * speed**2
    for faces in (("z_max", "z_min"), ("outer", "outer")):
        scene = scene_with("soft", young=E, poisson=0.0, density=RHO, title="from the side")
        scene.add_body(
            "plate", material="soft", box=box_of([-1, -0.25, -0.2], [1, 0.5, 0.2], [10, 5, 2])
        )
        scene.add_body(
            "block",
            material="soft",
            box=box_of([0.02, -0.2, -depth], [side] * 3, [4, 4, 4]),
            velocity=[-speed, 0, 0],
        )
        scene.add_support("plate.z_min", fix=["x", "y", "z"]).add_contact(
            f"plate.{faces[0]}", f"block.{faces[1]}", beta=beta, enforcement=enforcement
        )
        scene.set_time(end=0.6, fraction=0.5).set_output(every=1, fields=[])
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            run = scene.run()
        total = run.energy["total"]
        assert total.max() - total[0] < 2e-3 * kinetic
        told = [each.message for each in caught if getattr(each.message, "kind", "") == "border"]
        found = run.penetration[0]["points"]
        if faces[0] == "outer":
            assert not told and found["late"] == 0
        else:
            assert found["late"] > 0 and found["late_depth"] == pytest.approx(depth, rel=0.2)
            assert len(told) == 1 and 'surfaces = ["plate.outer", "block.outer"]' in str(told[0])


def test_the_warning_of_a_corner_that_leads_names_the_points_that_help():
    """The lowest node of a coarse ball meets a plate before the Gauss points of its faces, and is a Lobatto point."""
    told = {}
    for points in ("gauss", "lobatto"):
        scene = scene_with("soft", young=E, poisson=0.0, density=RHO, title="a coarse ball")
        scene.add_body("plate", material="soft", box=box_of([-1, -1, -0.2], [2, 2, 0.2], [8, 8, 1]))
        scene.add_body(
            "ball",
            material="soft",
            ball={"centre": [0.03, 0.02, 0.41], "radius": 0.4, "cells": [1, 8]},
            velocity=[0, 0, -0.5],
        )
        scene.add_contact("plate.z_max", "ball.outer", points=points)
        scene.set_time(end=0.6, fraction=0.5).set_output(every=1, fields=[])
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            scene.run()
        told[points] = [str(each.message) for each in caught if "corner" in str(each.message)]
    assert not told["lobatto"]
    assert len(told["gauss"]) == 1 and 'points = "lobatto"' in told["gauss"][0]


def test_restart_continues_with_the_same_bits(tmp_path):
    """History and start gaps are in the restart: a kept overlap, a removal in progress, thin plates pressed past half
    their thickness."""
    pytest.importorskip("h5py")
    for key in (
        {"initial_penetration": "keep"},
        {"initial_penetration": "remove", "removal_time": 0.3},
        {},
    ):
        key |= {"face": ("outer", "outer"), "enforcement": "penalty"}
        scene = blocks(0.02, 0.5, thick=0.1, end=0.2, **key)
        assert same_state(scene.run(), continued(scene, tmp_path, 0.1))


def test_quadratic_bodies_that_turn_inside_out_gain_no_energy():
    """
    A soft body of the linear law hits a stiff one at its own wave speed. The law does not resist det F < 0, so
    the surface layer of 20-node elements folds through itself, and points come to lie deep under turned
    faces: the energy grew 48 times.
    """
    c = math.sqrt(0.7 / (1.3 * 0.4))
    scene = ct.Scene(units=METRES)
    for name, young, origin, v in (
        ("soft", 1.0, [-1.01, 0, 0], 0.5 * c),
        ("stiff", 100.0, [0, 0.13, 0.07], -0.5 * c),
    ):
        scene.add_material(name, young=young, poisson=0.3, density=1.0)
        box = box_of(origin, [1, 1, 1], [3, 3, 3])
        scene.add_body(name, material=name, element="hex20", box=box, velocity=[v, 0, 0])
    scene.add_contact("soft.outer", "stiff.outer").set_time(end=1.2 / c, fraction=0.3)
    run = scene.run(output=False)
    bodies = run.energy["kinetic"] + run.energy["strain"]
    assert bodies.max() < 1.002 * bodies[0]
