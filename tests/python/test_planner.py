"""The planner: its extrapolation on known sequences, its errors computed independently, its predictions for the plates
and a bar on a wall, and its refusals."""

import csv
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from libcontact.command import main
from libcontact.planning import answer, planner
from libcontact.schema import SceneError

import libcontact as ct
from libcontact import exact

ROOT = Path(__file__).resolve().parents[2]


def plates(nu=0.3, end=0.56, axes=(0, 1, 2), names=("left", "right"), both_free=False):
    """The plates with the impact, the plane strain and the free faces along these axes, on few elements."""
    data = ct.Scene.load(ct.example("plates")).data
    data["material"][0]["poisson"] = nu
    data["time"]["end_c1t_over"]["value"] = end
    data["output"] = {"every": 10**9}
    turn = dict(zip("xyz", ("xyz"[k] for k in axes)))
    rename = dict(zip(("left", "right"), names))

    def surface(text):
        body, face = text.split(".")
        return f"{rename[body]}.{turn[face[0]]}{face[1:]}"

    for body in data["body"]:
        body["name"] = rename[body["name"]]
        box = body["box"]
        box["cells"] = [20, 1, 20]
        if both_free:
            box["origin"][2], box["size"][2], box["cells"][2] = -2.5, 5.0, 40
        for key, table in (("velocity", body), *((k, box) for k in ("origin", "size", "cells"))):
            table[key] = [table[key][axes.index(k)] for k in range(3)]
    kept = [each for each in data["support"] if not (both_free and "z" in each["fix"])]
    data["support"] = [
        {"set": surface(each["set"]), "fix": [turn[axis] for axis in each["fix"]]} for each in kept
    ]
    data["contact"][0]["surfaces"] = [surface(text) for text in data["contact"][0]["surfaces"]]
    return data


def l1_by_hand(run, nu):
    """L1 on Fig. 4's line over the plateau, element by element; for c1 t < 2.5 the exact curve is a single step."""
    c1 = np.sqrt(2.1e5 * (1 - nu) / ((1 + nu) * (1 - 2 * nu) * 7.8e-9))
    plateau = -7.8e-9 * c1 * 1000.0  # sigma_x behind the front: rho c1 v0
    body = run.state["right"]
    lowest = min(body.nodes[nodes][:, 2].mean() for nodes in body.elements)
    found = []
    for nodes, stress in zip(body.elements, body.stress):
        x, _, z = body.nodes[nodes].mean(axis=0)
        if z < 1.01 * lowest:
            found.append(abs(stress[0] / plateau - (x < c1 * run.state.time)))
    return np.mean(found)


def run_of(scene):
    return scene.run(output=False)


# Extrapolation.


@pytest.mark.parametrize("order", (0.5, 0.75, 1.0, 1.5, 2.0))
@pytest.mark.parametrize("limit, change", ((3.0, 1.0), (-2e-7, 5e-7), (1.0, -0.01)))
def test_a_power_law_is_found(order, limit, change):
    """eq:planner-power and eq:planner-fit, of sequences without an error."""
    h = 0.7 * 2.0 ** (-0.5 * np.arange(5))
    found = planner.extrapolate(h, limit + change * h**order)
    assert found.value == pytest.approx(limit, abs=1e-9 * abs(change))
    assert found.order == pytest.approx(order, abs=1e-9)
    assert found.orders == (found.order, found.order)
    # The remaining uncertainty is a fraction of the extrapolated difference.
    assert found.uncertainty == pytest.approx(0.25 * abs(change) * h[-1] ** order, rel=1e-6)


def test_the_uncertainty_of_a_line(monkeypatch):
    """eq:planner-power and eq:planner-fit with one order: the error of the axis intercept in the regression of a line,
    with n - 3 for the order that is sought as well."""
    monkeypatch.setattr(planner, "ORDERS", np.array([1.0]))
    x, noise = np.array([1.0, 0.8, 0.6, 0.5, 0.4]), np.array([0.02, -0.03, 0.01, 0.02, -0.01])
    f = 2.0 + 0.7 * x + noise
    slope = np.cov(x, f)[0, 1] / np.var(x, ddof=1)
    value = f.mean() - slope * x.mean()
    variance = np.sum((f - value - slope * x) ** 2) / (5 - 3)
    error = np.sqrt(variance * (1 / 5 + x.mean() ** 2 / np.sum((x - x.mean()) ** 2)))
    found = planner.extrapolate(x, f)
    assert found.value == pytest.approx(value, rel=1e-12)
    assert found.uncertainty == pytest.approx(2 * error + 0.25 * abs(value - f[-1]), rel=1e-12)


def test_the_uncertainty_holds_the_truth():
    """Orders between the fitted ones, a second term, and noise of a hundredth of the change: in nine of ten sequences
    the true limit is within the uncertainty."""
    random, h, inside = np.random.default_rng(5), 2.0 ** (-0.5 * np.arange(6)), []
    for _ in range(300):
        p = random.uniform(0.6, 2.0)
        values = 1.0 + h**p + random.uniform(-0.3, 0.3) * h ** (p + 1.0)
        found = planner.extrapolate(h, values + 0.01 * random.standard_normal(6))
        inside.append(abs(found.value - 1.0) <= found.uncertainty)
        assert found.orders[0] <= found.order <= found.orders[1]
    assert np.mean(inside) > 0.9


def test_a_common_limit_trusts_the_surer_and_no_one_alone():
    """eq:planner-mean by hand."""
    sure, vague = (
        planner.Limit(1.0, 0.01, 1.0, (1.0, 1.0)),
        planner.Limit(2.0, 1.0, 1.0, (1.0, 1.0)),
    )
    value, uncertainty = planner.together([sure, vague])
    assert abs(value - 1.0) < 0.001 and 0.01 < uncertainty < 0.02
    # Settings that agree share the meshes and their errors: many of them are not more certain than one.
    assert planner.together([sure] * 9)[1] == pytest.approx(0.01)
    apart = planner.Limit(1.2, 0.01, 1.0, (1.0, 1.0))
    assert planner.together([sure, apart])[1] == pytest.approx(np.hypot(0.1, 0.01))


def tried_on(scales, errors):
    tried = planner.Tried({}, 3.0)
    for scale in scales:
        tried.add(scale, 0.0, scale**3)
    tried.errors = np.array(errors)
    return tried


def test_the_mesh_for_an_error():
    scales = (0.25, 0.5, 1.0, 2.0)
    tried = tried_on(scales, [0.5 / s for s in scales])
    assert tried.scale_for(0.8) == pytest.approx(0.625)
    assert tried.scale_for(9.0) == 0.25
    assert tried.scale_for(0.05) == pytest.approx(10.0)
    assert tried.error_at(10.0) == pytest.approx(0.05)
    assert tried.seconds_at(4.0) == pytest.approx(64.0)
    assert tried.scale_in(27.0) == pytest.approx(3.0, rel=0.02)
    # A coarse mesh that is accurate by chance does not count: all finer ones must be as accurate.
    assert tried_on((*scales, 4.0), (0.4, 0.1, 0.4, 0.2, 0.1)).scale_for(0.2) == pytest.approx(2.0)


def test_a_finer_mesh_is_found_where_edges_round_apart():
    """With 197 x 197 x 39 elements one more along the longest edge, rounded as a whole, is the same mesh: 4 cells round
    down where 20 round up."""
    made = object.__new__(planner.Planner)
    made.own_mesh, made.asked = False, {}
    made.lattices = [SimpleNamespace(cells=(20, 20, 4))]
    made._scaled = lambda s: [
        SimpleNamespace(cells=[round(s * n) for n in each.cells]) for each in made.lattices
    ]
    tried = tried_on((0.5, 0.7, 1.0, 1.2), 4 * [0.05 * (9.87 / 1.2) ** planner.SLOWEST])
    goal = SimpleNamespace(error=0.05, seconds=None, scale=lambda _: 9.8166)
    assert made.mesh(tried, goal) == pytest.approx((9.9 * 9.9 * 10.0) ** (1 / 3))


# The error of the plates.


def test_plates_are_recognised_by_geometry():
    for data in (plates(), plates(axes=(2, 0, 1), names=("a", "b")), plates(both_free=True)):
        found = answer.plates(ct.Scene(data)._built(None))
        assert found is not None and found.d == 2.5 and found.speed == 1000.0
    wall = ct.Scene.load(ct.example("plates_reference"))
    assert answer.plates(wall._built(None)).bodies == ("right",)


def unlike(data):
    data["material"].append({**data["material"][0], "name": "soft", "young": 1e5})
    data["body"][0]["material"] = "soft"


OTHERS = {
    "gravity": lambda data: data.update(gravity={"acceleration": [0, 0, 1e6]}),
    "no plane strain": lambda data: data["support"].pop(),
    "two materials": unlike,
    "a gap": lambda data: data["body"][0]["box"]["origin"].__setitem__(0, -2.6),
    "askew": lambda data: data["body"][0]["velocity"].__setitem__(2, 5.0),
    "friction": lambda data: data["contact"][0].update(friction=0.3),
    "unlike heights": lambda data: data["body"][0]["box"]["size"].__setitem__(2, 2.0),
    "going on for too long": lambda data: data["time"]["end_c1t_over"].update(value=2.5),
}


@pytest.mark.parametrize("change", OTHERS.values(), ids=OTHERS)
def test_other_scenes_are_not_taken_for_plates(change):
    data = plates()
    change(data)
    assert answer.plates(ct.Scene(data)._built(None)) is None


@pytest.mark.parametrize("nu", (0.3, 0.4))
def test_the_error_by_hand(nu):
    scene = ct.Scene(plates(nu))
    run, problem = run_of(scene), scene._built(None)
    found, hand = answer.plates(problem), l1_by_hand(run, nu)
    assert replace(found, bodies=("right",)).error(problem, run) == pytest.approx(hand, rel=1e-9)
    # Along other axes, under other names, and with both halves, it is the same error.
    whole = found.error(problem, run)
    for other in (plates(nu, axes=(2, 0, 1), names=("a", "b")), plates(nu, both_free=True)):
        turned = ct.Scene(other)
        again = answer.plates(turned._built(None)).error(turned._built(None), run_of(turned))
        assert again == pytest.approx(whole, rel=1e-6)


# Plans.


@pytest.mark.parametrize("nu, end", ((0.3, 0.56), (0.4, 0.8)))
def test_a_plan_of_plates_keeps_its_word(nu, end, tmp_path):
    scene = ct.Scene(plates(nu, end))
    before = scene.toml()
    plan = scene.plan(error=0.06, trials=60.0)
    assert scene.toml() == before
    plan.scene.save(tmp_path / "new.toml")
    run = run_of(ct.Scene.load(tmp_path / "new.toml"))
    # The predicted error includes half of the fit's uncertainty, and trials end after seconds.
    assert 0.7 * plan.choice.error <= l1_by_hand(run, nu) <= 1.2 * plan.choice.error
    assert l1_by_hand(run, nu) <= 1.2 * 0.06
    assert plan.choice.error <= 0.06 and plan.value is None
    if plan.cheaper:
        assert plan.cheaper.error > 0.06 and plan.cheaper.seconds < plan.choice.seconds
    assert plan.dearer.error < plan.choice.error and plan.dearer.seconds > plan.choice.seconds
    for word in ("choice", "dearer", plan.choice.mesh, plan.choice.setting, "cheapest of"):
        assert word in str(plan)


@pytest.mark.parametrize("end", (0.88, 1.1))
def test_the_error_contains_the_front(end):
    """Also when the front is farther than d. The plan's error is that of the whole line, as far as the closed form
    holds."""
    data, length = plates(end=end), 2.0
    for body in data["body"]:
        body["box"]["origin"][0] *= length
        body["box"]["size"][0] *= length
        body["box"]["cells"][0] = 40
    plan = ct.Scene(data).plan(error=0.06, trials=60.0)
    body = run_of(plan.scene).state["right"]
    x, z = body.centres[:, 0] / 2.5, body.centres[:, 2]
    row = (z < 1.01 * z.min()) & (x < 2 * length - end - 1e-9)
    sigma = exact.plates(x[row], z[row] / 2.5, end, 0.3, length).stress.sigma_x
    c1 = np.sqrt(2.1e5 * 0.7 / (1.3 * 0.4 * 7.8e-9))
    off = np.abs(body.stress[row, 0] / (7.8e-9 * c1 * 1000) - sigma * 3 / 7)
    error = off.sum() * np.diff(np.unique(x.round(9)))[0]
    assert error <= 1.2 * 0.06 and plan.choice.error == pytest.approx(error, rel=0.05)


def test_a_front_that_has_left_the_plate_has_no_closed_form():
    assert answer.plates(ct.Scene(plates(end=0.99))._built(None)) is not None
    assert answer.plates(ct.Scene(plates(end=1.05))._built(None)) is None


def test_a_trial_that_met_the_error_at_less_cost_is_an_offer():
    """One setting needs a fine mesh, because the error of a mesh between is larger; its coarse trial meets the request
    in a tenth of the time."""
    tried = [tried_on((1.0, 1.4, 2.0, 2.8), (0.009, 0.02, 0.012, 0.008))]
    tried[0].seconds = [0.1, 0.3, 0.6, 1.0]
    made = object.__new__(planner.Planner)
    made.tried, made.price, made.offer = tried, lambda t, s: t.seconds_at(s), lambda t, s, p: (s, p)
    ((offer, each, scale),) = made._lucky(0.01, 1.0)
    assert scale == 1.0 and each is tried[0] and offer == (1.0, pytest.approx(0.1))
    assert made._lucky(0.01, 0.1) == [] and made._lucky(0.001, 1.0) == []


def bar(**change):
    data = ct.Scene.load(ct.example("bar_on_a_wall")).data
    data["output"] = {"every": 10**9}
    data["probe"] = [{"name": "wall", "resultant": "obstacle"}]
    data["body"][0]["box"] |= {"size": [10, 0.5, 0.5], "cells": [20, 1, 1]}
    return ct.Scene(data | change)


def test_a_plan_of_a_bar_keeps_its_word():
    """The bar rebounds: its momentum at the end is m v = 2.5 * 10."""
    plan = bar().plan(error=0.05, functional="bar.p_x.end", trials=60.0)
    assert abs(run_of(plan.scene).momentum["p"][-1, 0] / 25.0 - 1.0) <= 1.2 * 0.05
    assert abs(plan.value - 25.0) <= 2.0 * plan.uncertainty < 25.0
    assert "bar.p_x.end = 2" in str(plan) and "sure" in plan.sure


def test_a_time_is_kept(monkeypatch):
    """With a cost of 1 us per element and step, the choice takes at most the requested time."""

    def price(problem, records):
        elements = sum(len(body.mesh.elements) for body in problem.bodies.values())
        return SimpleNamespace(seconds=1e-6 * problem.step_count * elements, costs=[])

    monkeypatch.setattr(planner, "predict", price)
    plans = [bar().plan(seconds=s, functional="bar.p_x.end", trials=1.0) for s in (0.004, 0.4)]
    assert all(plan.choice.seconds <= s for plan, s in zip(plans, (0.004, 0.4)))
    assert "within 400 ms" in plans[1].choice.why


def mean_of(t, values):
    return sum((b - a) * (f + g) / 2 for a, b, f, g in zip(t, t[1:], values, values[1:])) / t[-1]


def test_functionals_by_hand():
    scene = bar(output={"every": 7})
    run, problem = run_of(scene), scene._built(None)
    t, force = run.probes["wall"]["time"], run.probes["wall"]["force"][:, 0]
    for name, value in {
        "wall.force_x.max": max(force),
        "wall.force_x.mean": mean_of(t, force),
        "bar.p_x.mean": mean_of(run.time, run.momentum["p"][:, 0]),
        "energy.kinetic.min": min(run.energy["kinetic"]),
        "energy.obstacle.end": run.energy["obstacle"][-1],
        "bar.p_x.end": run.momentum["p"][-1, 0],
    }.items():
        assert answer.functional(problem, name).value(run) == pytest.approx(value, rel=1e-12)


def with_nodes():
    nodes = np.array([[x, y, z] for x in range(9) for z in (0, 1) for y in (0, 1)], float)
    elements = np.array([0, 4, 5, 1, 2, 6, 7, 3]) + 4 * np.arange(8)[:, None]
    body = {"name": "bar", "material": "bar", "velocity": [-10, 0, 0]}
    return bar(body=[body | {"nodes": nodes, "elements": elements}])


def test_a_mesh_of_its_own_stays():
    scene = with_nodes()
    plan = scene.plan(error=0.05, functional="wall.force_x.mean", trials=1.0)
    assert (plan.scene.data["body"][0]["nodes"] == scene.data["body"][0]["nodes"]).all()
    assert "its own error is not included" in plan.sure and plan.choice.mesh == "mesh of its own"
    assert f"{plan.scene.data['time']['fraction']:.3g} of the stable step" in plan.choice.setting


def test_on_a_mesh_of_its_own_all_settings_have_one_limit():
    """A softer contact, another mass or a contact that holds no energy has another limit for small steps, so these
    keys stay those of the scene."""
    data = with_nodes().data
    data["obstacle"][0] |= {"beta": 3.0, "dissipation": 0.1}
    own = planner.Planner(ct.Scene(data), "bar.p_x.end", 1.0)
    assert len(own.tried) > 1
    for tried in own.tried:
        changed = own.changed(tried.keys, 2.0).data
        assert {name.partition(".")[0] for name in tried.keys} == {"time"}
        assert changed["obstacle"][0] == data["obstacle"][0] | {"restitution": 1.0}
        assert changed["time"]["fraction"] == tried.keys["time.fraction"] / 2.0


# Refusals and interruptions.


@pytest.mark.parametrize(
    "goal, key, words",
    (
        ({"error": 0.05}, "functional", "is missing"),
        (
            {"error": 0.05, "functional": "wall.force_q.max"},
            "functional",
            'did you mean "wall.force_',
        ),
        ({"error": 0.05, "functional": "wall.force_x"}, "functional", ".mean"),
        ({"error": 0.05, "functional": "floor.force_x.max"}, "functional", "floor.force_x"),
        ({"error": 0.05, "seconds": 1.0}, "error", "exactly one"),
        ({}, "error", "exactly one"),
        ({"error": 1.5}, "error", "below 1"),
        ({"error": "5"}, "error", "below 1"),
        ({"seconds": 0.0}, "seconds", "above 0"),
        ({"seconds": 1e-9, "functional": "bar.p_x.end"}, "seconds", "are not enough"),
        ({"error": 1e-12, "functional": "bar.p_x.end"}, "error", "times finer"),
        ({"error": 0.1, "functional": "bar.p_z.end"}, "functional", "no meaning"),
    ),
)
def test_what_is_refused_says_where(goal, key, words):
    scene = ct.Scene(bar().data, file="some.toml")
    with pytest.raises(SceneError) as caught:
        scene.plan(**goal, trials=0.5)
    assert str(caught.value).startswith(f"some.toml: {key}: ") and words in str(caught.value)


def test_python_functions_are_not_planned():
    scene = bar().add_effect("spring", "bar", "x_max", lambda view: -view.displacement)
    with pytest.raises(SceneError, match="spring: is a Python function"):
        scene.plan(error=0.1, functional="bar.p_x.end")


@pytest.mark.parametrize("enough", (False, True))
def test_ctrl_c_loses_no_trial(enough, monkeypatch):
    """The signal arrives during a trial: the plan is made from earlier trials, or there is none."""
    true_try, count = planner.Planner._try, []
    after = planner.FEWEST * len(planner.settings(True)) + 1 if enough else 5

    def stopped(self, *given):
        count.append(1)
        if len(count) > after:
            raise KeyboardInterrupt
        return true_try(self, *given)

    monkeypatch.setattr(planner.Planner, "_try", stopped)
    if not enough:
        with pytest.raises(KeyboardInterrupt):
            bar().plan(error=0.01, functional="bar.p_x.end")
        return
    plan = bar().plan(error=0.03, functional="bar.p_x.end", trials=1e9)
    assert plan.interrupted and "interrupted" in str(plan)


def test_what_ran_has_the_price_of_its_runs(monkeypatch):
    """For any prediction; of several runs the shortest counts."""
    tried = planner.Tried({}, 2.0)
    for seconds in (0.3, 0.2, 0.4):
        tried.add(1.0, 5.0, seconds)
    assert tried.scales == [1.0] and tried.values == [5.0] and tried.seconds == [0.2]
    true = planner.predict

    def slow(*given):
        found = true(*given)
        costs = [replace(c, predicted=0.0 if c.name == "output" else 1e6) for c in found.costs]
        return replace(found, costs=tuple(costs))

    monkeypatch.setattr(planner, "predict", slow)
    plan = bar().plan(error=0.05, functional="bar.p_x.end", trials=60.0)
    assert plan.choice.seconds < 1e3


def test_the_command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    ct.Scene(plates()).save("plates.toml")
    words = ["plan", "plates.toml", "--error", "7%", "--trials", "0.5"]
    assert main([*words, "--write", "new.toml"]) == 0
    out, err = capsys.readouterr()
    assert "choice" in out and "at most 7 %" in out and "new.toml" in err
    assert main(["explain", "new.toml"]) == 0
    assert main([*words, "--write", "new.toml"]) == 2
    assert "exists already" in capsys.readouterr().err
    assert main(["plan", "plates.toml"]) == 2
    assert main(["plan", "plates.toml", "--error", "much"]) == 2
    assert main(["plan", "plates.toml", "--error", "5%", "--functional", "x.y.end"]) == 2
    assert "plates.toml: functional: " in capsys.readouterr().err


# The list.


def test_the_list_is_that_of_the_book(tmp_path, monkeypatch):
    """prices.csv has rows of the campaign: cost, error over the plateau 7/3, growth. With all rows of one material and
    without the filter the planner would choose the same."""
    with (ROOT / "docs" / "theory" / "accuracy.csv").open(encoding="utf-8") as file:
        table = [row for row in csv.DictReader(file) if row["status"] == "done"]
    table = {
        (row["scene"], row["cells"], row["setting"]): row
        for row in table
        if not ("poisson" in row["setting"] or "filter" in row["setting"])
    }
    with planner.PRICES.open(encoding="utf-8") as file:
        for own in csv.DictReader(file):
            row = table[own["scene"], own["cells"], own["setting"]]
            cost, error = float(row["times_paper"]), float(row["l1_fig4"]) * 3 / 7
            assert float(own["cost"]) == pytest.approx(cost, nan_ok=True)
            assert float(own["error"]) == pytest.approx(error, rel=1e-6, nan_ok=True)
    chosen = planner.settings(False), planner.settings(True)
    monkeypatch.setattr(planner, "PRICES", tmp_path / "all.csv")
    lines = [
        f"{','.join(key)},{row['times_paper']},{row['l1_fig4']},{row['growth']}\n"
        for key, row in table.items()
    ]
    planner.PRICES.write_text("scene,cells,setting,cost,error,growth\n" + "".join(lines))
    assert (planner.settings(False), planner.settings(True)) == chosen and len(chosen[1]) > 9


ROWS = """scene,cells,setting,cost,error,growth
reference,12,time.fraction=0.98,1.0,0.10,0
reference,12,time.fraction=0.98; viscosity.linear=0.06,1.9,0.10,0
reference,12,time.fraction=0.98; time.integrator=noh_bathe,2.1,0.10,0
reference,12,time.courant=0.125,0.5,0.01,0
reference,12,body.element=hex20; time.fraction=0.98,1.0,0.05,0
reference,25,time.fraction=0.98; time.integrator=chung_lee,9.0,0.05,0
contact,12,contact.beta=4.0; contact.enforcement=penalty; time.fraction=0.98,1,0.01,0.5
contact,12,contact.beta=40.0; contact.enforcement=energy_controlled; time.fraction=0.98,1,0.03,0
contact,12,contact.beta=1.0; contact.enforcement=penalty; time.fraction=0.98,1,0.04,0
contact,25,contact.beta=40.0; contact.enforcement=energy_controlled; time.fraction=0.98,1,0.02,0
contact,12,contact.beta=2.0; contact.enforcement=penalty; time.fraction=0.98,1,0.09,0
"""


def test_settings_that_are_tried(tmp_path, monkeypatch):
    """From a list by hand: settings with over twice the cost for the same error are left out, and so are other keys,
    laws whose energy grows, and all but two laws."""
    monkeypatch.setattr(planner, "PRICES", tmp_path / "prices.csv")
    (tmp_path / "prices.csv").write_text(ROWS)
    step = {"time.fraction": 0.98}
    methods = [step, step | {"viscosity.linear": 0.06}, step | {"time.integrator": "chung_lee"}]
    assert planner.settings(False) == methods
    soft = {"contact.beta": 1.0, "contact.enforcement": "penalty"}
    laws = ({}, {"contact.beta": 40.0}, soft)
    assert planner.settings(True) == [method | law for method in methods for law in laws]


def test_what_a_setting_changes():
    """Keys of the choice replace those of the scene, all others stay; meshes and the thickness of plane strain are
    scaled, or the steps."""
    data = plates() | {"viscosity": {"linear": 0.2}}
    data["time"] |= {"integrator": "noh_bathe", "integrator_parameter": 0.55}
    data["contact"][0] |= {"points": "lobatto"}
    own = planner.Planner(ct.Scene(data), None, 1.0)
    keys = {"time.fraction": 0.9, "contact.beta": 3.0}
    new = own.changed(keys, 0.5).data
    end = data["time"]["end_c1t_over"]
    assert new["time"] == {"end_c1t_over": end, "fraction": 0.9}
    assert new["contact"] == [
        {**{k: data["contact"][0][k] for k in ("surfaces", "method", "points")}, "beta": 3.0}
    ]
    assert "viscosity" not in new
    damped = own.changed({"time.fraction": 0.9, "viscosity.linear": 0.06}, 1.0)
    assert damped.data["viscosity"] == {"linear": 0.06}
    assert [body["box"]["cells"] for body in new["body"]] == [[10, 1, 10]] * 2
    assert [body["box"]["size"] for body in new["body"]] == [[2.5, 0.25, 2.5]] * 2
    assert (
        own.changed({"time.fraction": 0.9, "time.integrator": "chung_lee"}, 1.0).data["time"][
            "integrator"
        ]
        == "chung_lee"
    )
    steps = planner.Planner(with_nodes(), "bar.p_x.end", 1.0).changed({"time.fraction": 0.9}, 2.0)
    assert steps.data["time"]["fraction"] == 0.45
