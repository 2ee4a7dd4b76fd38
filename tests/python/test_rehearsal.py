"""The rehearsal of a run with larger elements: its counts compared with closed forms and with the run itself."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from libcontact.planning import plan
from scenes import box_of, scene_with

import libcontact as ct

SCENES = Path(__file__).parents[2] / "tutorials" / "scenes"


def scene_of(name, cells):
    data = tomllib.loads((SCENES / f"{name}.toml").read_text(encoding="utf-8"))
    data.pop("output")
    data["body"][0]["box"]["cells"] = cells
    return ct.Scene(data)


def rehearsed(scene):
    """The first rehearsal of a scene, the problem and its rehearsals."""
    problem = scene._built(None)
    seen = plan.rehearse(problem)
    return (seen[0] if seen else None), problem, seen


def block(cells=(8, 8, 8), **entries):
    scene = scene_with("soft", young=1e6, poisson=0.3, density=1000.0, law=entries.pop("law", None))
    box = box_of([1, 2, 3], [1, 2, 3], list(cells))
    scene.add_body("block", material="soft", box=box, **entries)
    return scene.set_time(end=1.0, fraction=0.5)


@pytest.fixture
def cheap(monkeypatch):
    """Rehearsals with a very low cost limit, so that they use larger elements also for small scenes."""
    monkeypatch.setattr(plan, "MOST_UPDATES", 1e3)


def test_a_bar_presses_on_a_wall_for_two_passages_of_its_wave(cheap):
    # contact from 0.5 to 0.5 + 2 L / c of 1.5
    seen, problem, both = rehearsed(scene_of("bar_on_a_wall", [1000, 1, 1]))
    cells = [one.coarse.parts.bodies["bar"].box.cells[0] for one in both]
    assert cells[1] == pytest.approx(cells[0] / plan.COARSER, abs=1) and cells[0] < 1000
    assert seen.steps == problem.step_count
    pressed = seen.acted[:, problem.effects.index("obstacle")]
    assert pressed.mean() == pytest.approx(20 / 30 / 1.5, abs=0.03)
    assert pressed.argmax() / len(pressed) == pytest.approx(0.5 / 1.5, abs=0.01)


def test_the_share_of_computed_elements_is_that_of_a_front_that_goes_one_element_a_step(cheap):
    # eq. sleep-share: from a load at one end, over N steps, the share N / 2 n of n elements
    scene = block(cells=(200, 2, 2)).add("load", surface="block.x_min", pressure=1.0)
    data = scene.data
    data["body"][0]["box"]["size"] = [200, 2, 2]
    c1 = ct.Scene(data).explain().data["bodies"][0]["c1"]
    data["time"]["end"] = 50.0 / c1
    seen, problem, both = rehearsed(ct.Scene(data))
    assert all(len(one.coarse.bodies["block"].mesh.elements) < 800 for one in both)
    # of at most 8 + 1 elements along the front, in batches
    n = seen.coarse.parts.bodies["block"].box.cells[0]
    assert seen.computed == pytest.approx(problem.step_count / (2 * 200), abs=9 / n)


def test_a_bouncing_bar_is_seen_to_come_back(cheap):
    seen, problem, _ = rehearsed(scene_of("bouncing_bar", [1, 1, 500]))
    pressed = seen.acted[:, problem.effects.index("obstacle")]
    time = 5.3333 * (np.arange(len(pressed)) + 0.5) / len(pressed)
    np.testing.assert_allclose(pressed[(time > 1.1) & (time < 1.6)], True)
    np.testing.assert_allclose(pressed[(time > 3.75) & (time < 4.25)], True)
    # after it has left, ringing may touch once more
    assert pressed[(time < 0.95) | ((time > 1.8) & (time < 3.6)) | (time > 4.5)].mean() < 0.03
    # The elements record no impulse; gravity always acts.
    assert not seen.acted[:, 0].any() and seen.acted[:, problem.effects.index("gravity")].all()


def test_what_is_cheap_is_rehearsed_as_it_is():
    seen, problem, both = rehearsed(block(cells=(3, 3, 3)))
    assert seen.coarse is problem and len(both) == 1


def test_a_long_run_is_rehearsed_in_a_bounded_time(monkeypatch):
    observed = []
    monkeypatch.setattr(plan, "_observe", lambda coarse, steps: observed.append(coarse))
    problem = block(cells=(20, 20, 20)).set_time(end=2e3, fraction=0.5)._built(None)
    work = lambda coarse: coarse.step_count * len(coarse.bodies["block"].mesh.elements)
    assert plan.MOST_FRACTION * plan._updates(problem, 1.0) > 2e8
    plan.rehearse(problem)
    assert len(observed) == 2 and work(observed[1]) < work(observed[0]) < 1.1e8
    for coarse in observed:
        assert coarse.dt / coarse.stable.dt == pytest.approx(0.5, rel=1e-3)


ROUND = {
    "ring": {"radius": [0.8, 1.0], "width": 0.4, "cells": [6, 96, 6]},
    "cylinder": {"radius": 1.0, "width": 0.4, "cells": [6, 96, 6]},
    "ball": {"radius": 1.0, "cells": [6, 32]},
    "shell": {"radius": [0.8, 1.0], "cells": [6, 32]},
}


@pytest.mark.parametrize("shape", ["box", *ROUND])
def test_larger_elements_keep_the_body(cheap, shape):
    scene = block(cells=(20, 20, 20))
    if shape != "box":
        scene = scene_with("soft", young=1e6, poisson=0.3, density=1000.0)
        scene.add_body("block", material="soft", **{shape: {"centre": [1, 2, 3], **ROUND[shape]}})
        scene.set_time(end=1.0, fraction=0.5)
    problem = scene._built(None)
    before, after = (one.bodies["block"].mesh for one in (problem, plan._coarse(problem, 2.0)))
    assert len(after.elements) == len(before.elements) / 8
    np.testing.assert_allclose(after.bounds, before.bounds, atol=1e-12)
    if shape == "box":
        assert plan._coarse(problem, 2.0).parts.bodies["block"].box.layers == "z"
    least = plan._coarse(problem, 1e9).parts.bodies["block"]
    assert least.lattice.cells == (
        (1, 1, 1) if shape == "box" else (1, 12, 1)[: len(least.lattice.cells)]
    )


def test_what_has_no_lattice_is_not_rehearsed(cheap):
    large = block(cells=(20, 20, 20))._built(None)
    mesh = large.bodies["block"].mesh
    data = block(cells=(20, 20, 20)).data
    data["body"][0].pop("box")
    data["body"][0] |= {"nodes": mesh.nodes, "elements": mesh.elements}
    assert rehearsed(ct.Scene(data))[0] is None


def test_a_run_to_rest_is_planned_with_the_steps_that_it_needs():
    scene = block(cells=(3, 3, 3)).add("damping", relaxation=True)
    scene.add("load", surface="block.z_max", pressure=10.0).add_support("block.z_min", fix="xyz")
    data = scene.data
    data["time"] = {"end": 20.0, "fraction": 0.5, "until_static": 1e-3}
    scene = ct.Scene(data)
    steps = int(scene.run().steps[-1])
    seen, problem, _ = rehearsed(scene)
    assert steps < 0.8 * problem.step_count
    assert seen.steps == pytest.approx(steps, rel=0.1)


def test_an_effect_of_the_user_is_rehearsed_with_nodes_of_its_own(cheap):
    seen = []

    def spring(view):
        seen.append(len(view.displacement))
        return -1e3 * view.displacement

    scene = block(cells=(40, 4, 4)).add_effect("spring", "block", "x_min", spring)
    there, _, _ = rehearsed(scene)
    assert there.coarse.parts.bodies["block"].box.cells[1] < 4
    seen.clear()
    assert scene.run(until=1e-2).steps[-1] > 0
    assert set(seen) == {25}  # the run's own nodes, not those of the rehearsal


def test_a_scene_that_stays_dear_with_the_largest_elements_is_not_rehearsed(cheap):
    many = scene_with("soft", young=1e6, poisson=0.3, density=1000.0)
    for i in range(10):
        many.add_body(f"block{i}", material="soft", box=box_of([2 * i, 0, 0], [1, 1, 1], [1, 1, 1]))
    assert rehearsed(many.set_time(end=3.0, fraction=0.5))[0] is None
