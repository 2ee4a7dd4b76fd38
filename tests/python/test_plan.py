"""The plan of a scene: its predictions, and the corresponding counts and measurements of a run."""

import gc
import math

import numpy as np
import pytest
from libcontact._core import ffi, lib
from libcontact.bridge import ask
from libcontact.checks import touch
from libcontact.errors import check, new_error
from libcontact.planning import plan as planned
from libcontact.problem import Held, new_state
from libcontact.timing import LOOP, OUTPUT
from scenes import box_of, scene_with

import libcontact as ct

needs_hdf5 = pytest.mark.skipif(not hasattr(lib, "ct_output_create"), reason="built without HDF5")


def two_bars(gap=1.0, v=(3.0, -2.0), cells=40, savings=None, end=2.0):
    scene = scene_with("soft", young=900.0, poisson=0.0, density=1.0)
    for name, x, speed in (("left", -10.0, v[0]), ("right", gap, v[1])):
        box = box_of([x, 0, 0], [10, 0.5, 0.5], [cells, 1, 1])
        scene.add_body(name, material="soft", box=box, velocity=[speed, 0, 0])
    scene.add_contact("left.x_max", "right.x_min").set_time(end=end, fraction=0.9)
    if savings is not None:
        data = scene.data
        data["run"] = {"savings": savings}
        scene = ct.Scene(data)
    return scene


def touch_of(scene):
    return touch.first_touch(scene._built(None))[0]


def test_bodies_that_approach_touch_when_their_gap_is_closed():
    touch = touch_of(two_bars())
    assert touch.time == pytest.approx(0.2) and touch.body == "right"
    np.testing.assert_allclose(touch.shift, [-1, 0, 0], atol=1e-12)
    assert touch_of(two_bars(v=(1, 2))).time == math.inf
    assert touch_of(two_bars(gap=0.0)).time == 0.0


def test_a_falling_body_touches_after_the_root_of_two_gaps_over_g():
    scene = two_bars(v=(0, 0)).add("gravity", acceleration=[10, 0, 0], bodies=["left"])
    assert touch_of(scene).time == pytest.approx(math.sqrt(2 / 10))
    scene = two_bars(v=(1, 0)).add("gravity", acceleration=[-10, 0, 0], bodies=["left"])
    assert touch_of(scene).time == math.inf


def test_before_the_touch_nothing_is_active():
    scene = two_bars(gap=10.0, end=1.0)  # meets at t = 2
    plan = {cost.name: cost for cost in scene.costs()}
    assert plan["solid"].active == 0.0 and plan["contact"].active == 0.0
    whole = {cost.name: cost for cost in two_bars(gap=10.0, end=1.0, savings=[]).costs()}
    assert whole["solid"].active == 1.0


def test_a_cost_of_a_fixed_part_and_one_for_each_piece_is_known_from_two_sizes():
    """eq:plan-size, a line through two sizes."""
    assert planned._at_size(1000.0, [(100.0, 3.0 + 0.5 * 100), (25.0, 3.0 + 0.5 * 25)]) == 503.0
    # one size: proportional; a larger size that costs less: no smaller cost for an even larger one
    assert planned._at_size(1000.0, [(100.0, 2.0)]) == 20.0
    assert planned._at_size(1000.0, [(100.0, 2.0), (50.0, 3.0)]) == 2.0


def pressed_block(**entries):
    """A block that falls on a floor, in contact with its whole lower face."""
    scene = scene_with("soft", young=1e5, poisson=0.0, density=1000.0)
    box = box_of([0, 0, 0], [1, 1, 2], [16, 16, 32])
    scene.add_body("block", material="soft", box=box, velocity=[0, 0, -0.1])
    plane = {"point": [0, 0, 0], "normal": [0, 0, 1]}
    scene.add("obstacle", surface="block.z_min", plane=plane, **entries)
    return scene.set_time(end=0.25, fraction=0.9)


def counted(problem):
    """Rounds per step and the fraction of computed elements of a whole run, from the counters of its state."""
    state = new_state(problem)
    check(lib.ct_run(problem.pointer, state, problem.step_count, ffi.NULL, 0, new_error()))
    return state.constraint_rounds / state.step, planned.computed_fraction(state)


def test_larger_elements_foretell_the_rounds_and_the_active_elements_of_a_run(monkeypatch):
    monkeypatch.setattr(planned, "MOST_UPDATES", 1e3)
    scene = pressed_block()
    problem = scene._built(None)
    rounds, share = counted(problem)
    first, second = planned.rehearse(problem)
    elements = [len(one.coarse.bodies["block"].mesh.elements) for one in (first, second)]
    assert 16 * 16 * 32 > 3 * elements[0] > 12 * elements[1]
    costs = {cost.name: cost for cost in scene.costs()}
    # 40 + 18 n operations per round and constraint, n = 4 nodes; the rest is the listing of the points.
    points = 16 * 16 * 4
    told = (costs["obstacle"].flops - problem.pointer.effects[1].cost.flops) / (40 + 18 * 4)
    assert rounds > 0.2 * points and told == pytest.approx(rounds, rel=0.16)
    assert costs["solid"].active == pytest.approx(share, abs=0.05) and share < 0.95
    assert costs["obstacle"].active > 0.9


@needs_hdf5
def test_memory_and_the_size_of_the_file_are_foretold(tmp_path):
    scene = two_bars(end=0.5).set_output(file=str(tmp_path / "run.vtkhdf"), every=10)
    data = scene.explain().data["cost"]
    scene.run()
    assert data["output_bytes"] == pytest.approx((tmp_path / "run.vtkhdf").stat().st_size, rel=0.02)
    assert data["memory_bytes"] > 0 and data["rehearsed"]
    assert two_bars(end=0.5).explain().data["cost"]["output_bytes"] == 0
    parts = [cost.predicted for cost in scene.costs()]
    assert data["seconds"] > 0.0 and all(part > 0.0 for part in parts)


def test_the_bytes_of_a_block_are_counted_and_nothing_else():
    with Held() as outer:
        with Held() as inner:
            problem = two_bars()._built(None)
        assert gc.isenabled() is False
        lib.ct_state_free(ask("ct_state **", lib.ct_state_create, problem.pointer))
    assert gc.isenabled() and outer.bytes == inner.bytes == problem.held
    assert problem.held > 24 * 9 * problem.pointer.node_count
    del problem


def test_what_cannot_have_larger_elements_is_planned_as_if_all_touched_from_the_start(monkeypatch):
    monkeypatch.setattr(planned, "MOST_UPDATES", 1e3)
    scene = two_bars(gap=1.0, end=2.0)
    problem, data = scene._built(None), scene.data
    for body in data["body"]:
        mesh = problem.bodies[body["name"]].mesh
        body.pop("box")
        body |= {"nodes": mesh.nodes, "elements": mesh.elements}
    text = ct.Scene(data).explain()
    assert not text.data["cost"]["rehearsed"] and "no rehearsal" in text
    assert [cost.active for cost in text.data["plan"]] == [1.0] * 4
    assert all(cost.predicted > 0.0 for cost in text.data["plan"])
    # The bars are moved together, and each of their elements is stretched.
    state = new_state(problem)
    planned._place(problem, state, True)
    u = np.frombuffer(planned.ffi.buffer(state.displacement, 24 * problem.pointer.node_count))
    u = u.reshape(-1, 3)
    for name, shift in (("left", 0.0), ("right", -1.0)):
        body = problem.bodies[name]
        np.testing.assert_allclose(u[body.nodes], [[shift, 0, 0]] * len(body.mesh.nodes), atol=1e-9)
        corners = u[body.nodes][body.mesh.elements]
        assert (corners.max(axis=1) > corners.min(axis=1)).all()


def test_each_effect_has_its_costs_and_its_share_of_the_bound():
    """eq:plan-share, whose parts add up to the bound."""
    scene = two_bars(gap=0.0).add("damping", rate=0.5)
    run = scene.run()
    costs = scene.costs(run)
    assert [cost.name for cost in costs] == ["solid", "contact", "damping", LOOP, OUTPUT]
    assert all(cost.predicted > 0 and cost.measured > 0 for cost in costs)
    stable = scene.explain().data["time"]["stable"]
    # 4 / dt^2 = W + 2 D / dt, the root that eq. damped-step-bound gives
    total = (
        sum(cost.omega_squared for cost in costs) + 2 * sum(cost.rate for cost in costs) / stable
    )
    assert total * stable**2 == pytest.approx(4.0, rel=1e-12)
    text = scene.cost_table(run)
    assert "predicted" in text and "measured" in text and "damping" in text
    assert "measured" not in scene.cost_table()


def test_a_run_counts_which_share_of_its_elements_it_has_computed():
    assert two_bars(gap=10.0, end=1.0, savings=[]).run().computed == 1.0
    # Bars in free flight have no strain: no element is ever computed.
    assert two_bars(gap=10.0, end=1.0).run().computed == 0.0
    # A front that advances one element per step from the contact into bars of 200 elements, in batches of 8: eq.
    # sleep-share.
    met = two_bars(gap=0.0, cells=200, end=0.3)
    run = met.run()
    solid = met.costs(run)[0]
    assert run.computed == solid.done and abs(solid.active - solid.done) < 8 / 200
    assert abs(solid.done - met.explain().data["time"]["steps"] / (2 * 200)) < 8 / 200
    assert f"{100 * solid.done:.0f} %" in met.cost_table(run)
    assert met.costs(run)[1].done is None and met.costs()[0].done is None


@pytest.mark.parametrize("interval", [1, 2, 10])
def test_a_trial_has_the_forces_of_each_of_its_steps(interval, monkeypatch):
    """Also those that a record computes for the next step: with elements in place of seconds, each step has all."""
    problem = two_bars()._built(None)

    def elements(problem, state):
        return np.array([state.element_updates[0], *[0.0] * len(problem.effects)])

    monkeypatch.setattr(planned, "step_seconds", elements)
    monkeypatch.setattr(planned, "TRIAL_SECONDS", 1e9)  # rounds of the whole interval
    assert planned._try(problem, interval).seconds["solid"] == 2 * 40


def test_the_trial_of_a_plan_changes_nothing():
    scene, fresh = two_bars(), two_bars()
    scene.explain()
    a, b = scene.run(), fresh.run()
    assert a.state["left"].displacement.tobytes() == b.state["left"].displacement.tobytes()


def test_operations_of_contact_are_those_of_its_points_and_of_the_rounds_for_their_forces():
    """eq:round-flops for each round of a point."""

    def contact(**entries):
        scene = two_bars(gap=0.0, v=(3.0, -2.0), cells=8)
        data = scene.data
        data["contact"][0] |= entries
        return next(cost for cost in ct.Scene(data).costs() if cost.name == "contact")

    # one face on each side, 4 points each
    explicit, controlled = contact(enforcement="penalty"), contact()
    assert explicit.flops == 800 * 8
    rounds = (controlled.flops - 1200 * 8) / (40 + 18 * 8)
    # of 8 points, in the steps in which they have forces; the iteration ends after 2000
    assert 0.0 < controlled.active < 1.0 and 0.1 * 8 < rounds / controlled.active < 8 * 2000
    assert controlled.bytes > explicit.bytes > 8 * 8
    apart = next(
        cost for cost in two_bars(gap=10.0, end=1.0, cells=8).costs() if cost.name == "contact"
    )
    assert apart.flops == 1200 * 8


@pytest.mark.parametrize(
    "effect, limit",
    [
        ("none", "elements"),
        ("absorb", "absorb and elements together"),
        ("contact", "contact and elements together"),
    ],
)
def test_what_limits_the_step(effect, limit):
    """Dashpots on a cube with 4 elements along an edge have 2 c1 / (h/2) at their nodes and bound the step; so does a
    stiff penalty."""
    scene = scene_with("m", young=1e4, poisson=0.3, density=1.0, title="limit")
    for k, name in enumerate("ab"):
        scene.add_body(
            name,
            material="m",
            box=box_of([1.1 * k, 0, 0], [1, 1, 1], [4, 4, 4]),
            velocity=[1 - k, 0, 0],
        )
    if effect == "absorb":
        for face in ("x_min", "y_min", "y_max", "z_min", "z_max"):
            scene.add("absorb", surface=f"a.{face}")
    if effect == "contact":
        scene.add_contact("a.x_max", "b.x_min", enforcement="penalty", beta=4)
    text = scene.set_time(end=0.2, fraction=0.9).explain()
    shares = {
        cost.name: cost.omega_squared + 2 * cost.rate / text.data["time"]["stable"]
        for cost in text.data["plan"]
    }
    assert sum(shares.values()) == pytest.approx(4 / text.data["time"]["stable"] ** 2, rel=1e-9)
    assert text.data["time"]["limited_by"] == limit and f"limited by {limit}\n" in text
