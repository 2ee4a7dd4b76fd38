"""
The rehearsal of a run with larger elements: what it foresees against closed forms, and how it is laid on the meshes of the run.
"""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest

import libcontact as ct
from libcontact import activity, rehearsal

SCENES = Path(__file__).parents[2] / "tutorials" / "scenes"
UNITS = {"length": "m", "mass": "kg", "time": "s"}


def scene_of(name, cells):
    data = tomllib.loads((SCENES / f"{name}.toml").read_text(encoding="utf-8"))
    data.pop("output")
    data["body"][0]["box"]["cells"] = cells
    return ct.Scene(data)


def rehearsed(scene):
    return rehearsal.rehearse(scene._built(None))


def block(element="hex8", cells=(8, 8, 8), **entries):
    scene = ct.Scene(units=UNITS)
    scene.add_material("soft", young=1e6, poisson=0.3, density=1000.0, law=entries.pop("law", None))
    box = {"origin": [1, 2, 3], "size": [1, 2, 3], "cells": list(cells)}
    scene.add_body("block", material="soft", element=element, box=box, **entries)
    return scene.set_time(end=1.0, fraction=0.5)


@pytest.fixture
def cheap(monkeypatch):
    """Rehearsals that may cost next to nothing, so that small scenes have larger elements in them."""
    monkeypatch.setattr(rehearsal, "MOST_UPDATES", 1e3)


def test_a_bar_presses_on_a_wall_for_two_passages_of_its_wave(cheap):
    # contact from 0.5 to 0.5 + 2 L / c of 1.5, and a rehearsal is looked at 240 times
    seen = rehearsed(scene_of("bar_on_a_wall", [1000, 1, 1]))
    cells = seen.coarse.parts.bodies["bar"].box.cells
    assert cells[0] < 1000 and seen.steps == seen.problem.step_count
    k = seen.problem.effects.index("obstacle")
    assert seen.active(k) == pytest.approx(20 / 30 / 1.5, abs=0.03)
    looks = np.flatnonzero(seen.pressing[:, k] > 0)
    assert looks[0] / len(seen.pressing) == pytest.approx(0.5 / 1.5, abs=0.01)
    assert seen.begins()[k] == pytest.approx(0.5 / 1.5 * seen.steps, rel=0.03)


def test_elements_at_a_boundary_that_no_wave_has_reached_are_at_rest_in_the_plan(cheap):
    # the far end absorbs, but in 0.25 of the passage of a wave nothing comes there; a load begins at the other end
    scene = (
        block(cells=(60, 2, 2))
        .add("load", surface="block.x_min", pressure=1.0)
        .add("absorb", surface="block.x_max")
    )
    data = scene.data
    data["body"][0]["box"]["size"] = [60, 2, 2]
    c1 = ct.Scene(data).explain().data["bodies"][0]["c1"]
    data["time"]["end"] = 15.0 / c1
    problem = ct.Scene(data)._built(None)
    seen = rehearsal.rehearse(problem)
    begins = seen.begins()
    assert (
        begins[problem.effects.index("load")] == 0
        and begins[problem.effects.index("absorb")] > 0.5 * seen.steps
    )
    share, without = (
        activity.active_share(problem, [], seen.steps, there) for there in (begins, None)
    )
    assert share < 0.75 * without


def test_a_bouncing_bar_is_seen_to_come_back(cheap):
    seen = rehearsed(scene_of("bouncing_bar", [1, 1, 500]))
    k = seen.problem.effects.index("obstacle")
    time = 5.3333 * (np.arange(len(seen.pressing)) + 0.5) / len(seen.pressing)
    pressed = seen.pressing[:, k] > 0
    np.testing.assert_allclose(pressed[(time > 1.1) & (time < 1.6)], True)
    np.testing.assert_allclose(pressed[(time > 3.75) & (time < 4.25)], True)
    # after it has left, ringing may touch once more
    assert pressed[(time < 0.95) | ((time > 1.8) & (time < 3.6)) | (time > 4.5)].mean() < 0.03
    states = list(seen.moments(6))
    assert math.fsum(state.share for state in states) == pytest.approx(1.0)
    down = math.fsum(
        state.share
        for state in states
        if pressed[round(state.step / seen.steps * len(pressed)) - 1]
    )
    assert down == pytest.approx(4 / 3 / 5.3333, abs=0.06)


def test_what_is_cheap_is_rehearsed_as_it_is():
    small = rehearsed(block(cells=(3, 3, 3)))
    assert small.coarse.parts.bodies["block"].box.cells == (3, 3, 3)


def test_a_long_run_is_rehearsed_in_a_bounded_time(monkeypatch):
    problem = block(cells=(20, 20, 20)).set_time(end=1e6, fraction=0.5)._built(None)
    assert rehearsal.MOST_SHARE * rehearsal._updates(problem, problem.parts.bodies) > 1e8
    coarse = rehearsal._coarse(problem)
    assert coarse is None or coarse.step_count * len(coarse.bodies["block"].mesh.elements) < 1e8
    monkeypatch.setattr(rehearsal, "MOST_EVER", 1e11)
    assert rehearsal._coarse(problem) is not None


def test_what_has_no_lattice_is_not_rehearsed(cheap):
    large = block(cells=(20, 20, 20))._built(None)
    box = rehearsal._coarse(large).parts.bodies["block"].box
    assert all(2 <= n < 20 for n in box.cells) and box.size == (1, 2, 3)
    mesh = large.bodies["block"].mesh
    data = block(cells=(20, 20, 20)).data
    data["body"][0].pop("box")
    data["body"][0] |= {"nodes": mesh.nodes, "elements": mesh.elements}
    assert rehearsed(ct.Scene(data)) is None


@pytest.mark.parametrize("element", ["hex8", "hex20"])
def test_fields_that_are_linear_are_laid_on_a_box_without_error(cheap, element):
    problem = block(element, cells=(12, 9, 15))._built(None)
    coarse = rehearsal._coarse(problem)
    assert coarse.parts.bodies["block"].box.cells < (12, 9, 15)
    gradient, offset = np.random.default_rng(1).uniform(-1, 1, (2, 3, 3))
    X, x = coarse.bodies["block"].mesh.nodes, problem.bodies["block"].mesh.nodes
    u, v = np.empty((2, *x.shape))
    rehearsal._Map(problem, coarse, "block")(X @ gradient, X @ offset + 1.0, u, v)
    np.testing.assert_allclose(u, x @ gradient, atol=1e-13 * np.abs(u).max())
    np.testing.assert_allclose(v, x @ offset + 1.0, atol=1e-13 * np.abs(v).max())


@pytest.mark.parametrize("element", ["hex8", "hex20"])
def test_a_turned_ring_is_laid_as_it_turns(cheap, element):
    scene = ct.Scene(units=UNITS)
    scene.add_material("rubber", young=1e6, poisson=0.3, density=1000.0, law="neo_hookean")
    ring = {"centre": [1, 2, 3], "radius": [0.8, 1.0], "width": 0.4, "cells": [2, 48, 2]}
    scene.add_body("ring", material="rubber", element=element, ring=ring)
    problem = scene.set_time(end=5.0, fraction=0.5)._built(None)
    coarse = rehearsal._coarse(problem)
    assert coarse.parts.bodies["ring"].ring.cells[1] < 48
    axis = np.array([1.0, 2.0, 2.0]) / 3.0
    K = np.cross(np.eye(3), axis)  # rows e × axis: x @ K.T = axis × x
    R = np.eye(3) + math.sin(2.0) * K.T @ np.eye(3) + (1 - math.cos(2.0)) * K.T @ K.T
    X, x = coarse.bodies["ring"].mesh.nodes, problem.bodies["ring"].mesh.nodes
    assert abs(np.linalg.det(R) - 1.0) < 1e-14 and np.abs(R @ R.T - np.eye(3)).max() < 1e-14
    move = lambda nodes: (
        nodes @ R.T + [3.0, 0.0, -1.0],
        np.cross([0.1, -0.2, 0.3], nodes @ R.T) + [1.0, 2.0, 3.0],
    )
    (now, speed), (there, speed_there) = move(X), move(x)
    u, v = np.empty((2, *x.shape))
    rehearsal._Map(problem, coarse, "ring")(now - X, speed, u, v)
    np.testing.assert_allclose(u, there - x, atol=1e-12)
    np.testing.assert_allclose(v, speed_there, atol=1e-12)


def test_a_run_to_rest_is_planned_with_the_steps_that_it_needs():
    scene = block(cells=(3, 3, 3)).add("damping", relaxation=True)
    scene.add("load", surface="block.z_max", pressure=10.0).add_support("block.z_min", fix="xyz")
    data = scene.data
    data["time"] = {"end": 20.0, "fraction": 0.5, "until_static": 1e-3}
    scene = ct.Scene(data)
    steps = int(scene.run(progress=False).steps[-1])
    seen = rehearsed(scene)
    assert steps < 0.8 * seen.problem.step_count
    assert seen.steps == pytest.approx(steps, rel=0.1)


def test_like_states_are_one_group():
    rng = np.random.default_rng(2)
    centres = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    rows = np.concatenate(
        [
            centre + 0.01 * rng.standard_normal((count, 2))
            for centre, count in zip(centres, (10, 30, 60))
        ]
    )
    groups = rehearsal._group(rows, 3)
    assert sorted(count for _, count in groups) == [10, 30, 60]
    for look, count in groups:
        assert {10: 0, 30: 1, 60: 2}[count] == int(
            np.argmin(((rows[look] - centres) ** 2).sum(axis=1))
        )
    assert len(rehearsal._group(np.zeros((5, 2)), 3)) == 1


def test_an_effect_of_the_user_is_rehearsed_with_nodes_of_its_own(cheap):
    seen = []

    def spring(view):
        seen.append(len(view.displacement))
        return -1e3 * view.displacement

    scene = block(cells=(40, 4, 4)).add_effect("spring", "block", "x_min", spring)
    there = rehearsed(scene)
    assert there.coarse.parts.bodies["block"].box.cells[1] < 4
    seen.clear()
    assert scene.run(progress=False, until=1e-2).steps[-1] > 0
    assert set(seen) == {25}  # the run's own nodes, not those of the rehearsal


def test_a_scene_that_stays_dear_with_the_largest_elements_is_not_rehearsed(cheap):
    many = ct.Scene(units=UNITS)
    many.add_material("soft", young=1e6, poisson=0.3, density=1000.0)
    for i in range(10):
        many.add_body(
            f"block{i}",
            material="soft",
            box={"origin": [2 * i, 0, 0], "size": [1, 1, 1], "cells": [3, 3, 3]},
        )
    assert rehearsed(many.set_time(end=1.0, fraction=0.5)) is None
