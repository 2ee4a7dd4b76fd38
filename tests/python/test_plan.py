"""The plan of a scene: what is predicted, what is measured, and what the front of a wave can have reached."""

import math

import numpy as np
import pytest
from libcontact.plan import LOOP, OUTPUT

import libcontact as ct
from libcontact import activity
from libcontact import plan as planned

UNITS = {"length": "m", "mass": "kg", "time": "s"}


def two_bars(gap=1.0, v=(3.0, -2.0), cells=40, savings=None, end=2.0):
    scene = ct.Scene(units=UNITS)
    scene.add_material("soft", young=900.0, poisson=0.0, density=1.0)
    for name, x, speed in (("left", -10.0, v[0]), ("right", gap, v[1])):
        box = {"origin": [x, 0, 0], "size": [10, 0.5, 0.5], "cells": [cells, 1, 1]}
        scene.add_body(name, material="soft", box=box, velocity=[speed, 0, 0])
    scene.add_contact("left.x_max", "right.x_min").set_time(end=end, fraction=0.9)
    if savings is not None:
        data = scene.data
        data["run"] = {"savings": savings}
        scene = ct.Scene(data)
    return scene


def touch_of(scene):
    return activity.first_touch(scene._built(None))[0]


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


def test_the_front_goes_one_element_a_step():
    elements = np.array([[i, i + 1] for i in range(10)])
    starts = np.full(11, np.inf)
    starts[0] = 3.0
    np.testing.assert_array_equal(activity._first_steps(elements, starts), 3.0 + np.arange(10))
    assert np.all(activity._first_steps(elements, np.full(11, np.inf)) == np.inf)


def test_before_the_touch_nothing_is_active():
    scene = two_bars(gap=10.0, end=1.0)  # meets at t = 2
    plan = {cost.name: cost for cost in scene.costs()}
    assert plan["solid"].active == 0.0 and plan["contact"].active == 0.0
    whole = {cost.name: cost for cost in two_bars(gap=10.0, end=1.0, savings=[]).costs()}
    assert whole["solid"].active == 1.0


def test_each_effect_has_its_costs_and_its_share_of_the_bound():
    scene = two_bars(gap=0.0).add("damping", rate=0.5)
    run = scene.run(progress=False)
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
    assert two_bars(gap=10.0, end=1.0, savings=[]).run(progress=False).computed == 1.0
    # All elements are computed once, in the first of the two evaluations that the start takes, and never again while they fly.
    alone = two_bars(gap=10.0, end=1.0)
    steps = alone.explain().data["time"]["steps"]
    assert alone.run(progress=False).computed == 1.0 / (steps + 2)
    # A front that goes one element a step from the contact into bars of 200 elements, in batches of 8: eq. quiet-share.
    met = two_bars(gap=0.0, cells=200, end=0.3)
    run = met.run(progress=False)
    solid = met.costs(run)[0]
    assert run.computed == solid.done and abs(solid.active - solid.done) < 8 / 200
    assert abs(solid.done - met.explain().data["time"]["steps"] / (2 * 200)) < 8 / 200
    assert f"{100 * solid.done:.0f} %" in met.cost_table(run)
    assert met.costs(run)[1].done is None and met.costs()[0].done is None


def test_the_trial_of_a_plan_changes_nothing():
    scene, fresh = two_bars(), two_bars()
    scene.explain()
    a, b = scene.run(progress=False), fresh.run(progress=False)
    assert a.state["left"].displacement.tobytes() == b.state["left"].displacement.tobytes()


def test_operations_of_contact_are_those_of_its_points_and_of_the_rounds_for_their_forces():
    def contact(**entries):
        scene = two_bars(gap=0.0, v=(3.0, -2.0), cells=8)
        data = scene.data
        data["contact"][0] |= entries
        return next(cost for cost in ct.Scene(data).costs() if cost.name == "contact")

    # one face on each side, 4 points each
    explicit, controlled = contact(enforcement="penalty"), contact()
    assert explicit.flops == 800 * 8
    rounds = (controlled.flops - 1200 * 8) / (60 + 15 * 8)
    # of 8 points, in the steps in which they press; the iteration ends after 500
    assert 0.0 < controlled.active < 1.0 and 0.1 * 8 < rounds / controlled.active < 8 * 500
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
    """Dashpots on a cube of 4 elements' edge have 2 c1 / (h/2) at their nodes and bound the step; a stiff penalty does, too."""
    scene = ct.Scene(title="limit", units={"length": "m", "mass": "kg", "time": "s"}).add_material(
        "m", young=1e4, poisson=0.3, density=1.0
    )
    for k, name in enumerate("ab"):
        scene.add_body(
            name,
            material="m",
            box={"origin": [1.1 * k, 0, 0], "size": [1, 1, 1], "cells": [4, 4, 4]},
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


def test_a_large_scene_has_its_trial_with_larger_elements(monkeypatch):
    """All that is no measured time stays; the trial has few elements, whatever the scene has."""

    def scene():
        return two_bars().set_output(every=7)

    def facts(text):
        plan = [
            {
                key: value
                for key, value in vars(cost).items()
                if key not in ("seconds_a_step", "predicted", "active")
            }
            for cost in text.data["plan"]
        ]
        return plan, {key: value for key, value in text.data.items() if key != "plan"}

    whole = scene().explain()
    made = []
    prices = planned._prices
    monkeypatch.setattr(
        planned,
        "_prices",
        lambda problem, records: (
            made.append(sum(len(body.mesh.elements) for body in problem.bodies.values()))
            or prices(problem, records)
        ),
    )
    monkeypatch.setattr(planned, "MOST_ELEMENTS", 20)
    small = scene().explain()
    assert made[0] <= 20 < sum(body["elements"] for body in whole.data["bodies"])
    (plan_whole, rest_whole), (plan_small, rest_small) = facts(whole), facts(small)
    assert repr(rest_whole) == repr(rest_small)
    for one, other in zip(plan_whole, plan_small, strict=True):
        assert {**one, "flops": 0, "bytes": 0} == {
            **other,
            "flops": 0,
            "bytes": 0,
        }  # these two also count the rounds of the iteration
    assert all(cost.predicted > 0.0 for cost in small.data["plan"])
