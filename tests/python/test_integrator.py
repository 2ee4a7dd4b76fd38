"""Integrators in scenes: keys and their refusals, ``explain``, energies of the bar on a wall, restarts, optimisations,
and the stable step from both sides."""

import warnings
from pathlib import Path

import numpy as np
import pytest
import steps
from libcontact._core import ffi, lib
from libcontact.model import INTEGRATORS
from libcontact.parts import read
from scenes import box_of, continued, same_state, scene_with

import libcontact as ct

ROOT = Path(__file__).parents[2]
LIMITS = {
    "central_difference": 2.0,
    "chung_lee": 2 / np.sqrt(4 * 28 / 27 - 3),
    "noh_bathe": 2 / np.sqrt(0.46 * 0.62),
    "tchamwa_wielgosz": 2 / np.sqrt(4 / 1.9 - 1),
}


def plates(integrator: str, **keys) -> ct.Scene:
    """Two thick plates that meet, in plane strain, with regions that sleep for a time; the right one is also loaded at
    its far end."""
    made = scene_with("soft", young=1e4, poisson=0.3, density=1.0, title="plates")
    for name, x, speed in (("left", -1.0, 1.0), ("right", 0.0, -1.0)):
        made.add_body(
            name,
            material="soft",
            velocity=[speed, 0, 0],
            box=box_of([x, 0, 0], [1, 0.1, 0.8], [10, 1, 8]),
        )
        for face in ("y_min", "y_max"):
            made.add_support(f"{name}.{face}", fix=["y"])
        made.add_support(f"{name}.z_min", fix=["z"])
    made.add_contact("left.x_max", "right.x_min", beta=4.0)
    return made.set_time(
        **{"end": 0.02, "fraction": 0.9, "integrator": integrator, **keys}
    ).set_output(every=4)


def run(made: ct.Scene, **keys) -> ct.Run:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return made.run(**keys)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_word_of_the_enum_row_of_the_table_and_chapter(integrator):
    facts = lib.ct_integrator_facts(INTEGRATORS[integrator])
    assert facts != ffi.NULL, f"{integrator} has no row in libcontact/src/step/integrator.c"
    assert ffi.string(facts.name).decode() == integrator
    assert integrator in LIMITS
    chapter = (ROOT / "docs/theory/integrator.rst").read_text(encoding="utf-8")
    assert f"integrator.c {integrator}_stages" in chapter or (facts.most == facts.least)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_explain_tells_limit_and_evaluations(integrator):
    made = plates(integrator)
    said = made.explain()
    time = said.data["time"]
    assert time["integrator"] == integrator and integrator in said
    assert time["integrator_limit"] == pytest.approx(LIMITS[integrator], rel=1e-12)
    assert time["evaluations_per_step"] == (2 if integrator == "noh_bathe" else 1)
    central = plates("central_difference").explain().data["time"]
    assert time["stable"] / central["stable"] == pytest.approx(LIMITS[integrator] / 2.0, rel=1e-12)


@pytest.mark.parametrize("integrator, stages", [("central_difference", 1), ("noh_bathe", 2)])
def test_a_step_of_noh_and_bathe_calls_each_force_twice(integrator, stages):
    """So the trial steps of a plan include both calls. A host's effect counts them."""
    made, times = plates(integrator), []
    count = made.explain().data["time"]["steps"]
    made.add_effect(
        "probe",
        "left",
        "z_max",
        lambda view: times.append(view.time) or np.zeros_like(view.displacement),
    )
    run(made, output=False)
    later = [time for time in times if time > 0.0]
    assert stages * count - stages <= len(set(later)) <= stages * count + 1


@pytest.mark.parametrize(
    "keys, key",
    [
        ({"integrator": "leapfrogs"}, "time.integrator"),
        ({"integrator": "noh_bathe", "integrator_parameter": 0.7}, "time.integrator_parameter"),
        ({"integrator": "chung_lee", "integrator_parameter": 0.5}, "time.integrator_parameter"),
        (
            {"integrator": "tchamwa_wielgosz", "integrator_parameter": 1.5},
            "time.integrator_parameter",
        ),
        (
            {"integrator": "central_difference", "integrator_parameter": 0.5},
            "time.integrator_parameter",
        ),
        ({"stable_step": "guess"}, "time.stable_step"),
        ({"force_tolerance": 1e-13}, "time.force_tolerance"),
        ({"force_tolerance": 0.2}, "time.force_tolerance"),
    ],
)
def test_refusals_name_the_key(keys, key):
    with pytest.raises(ct.SceneError, match=key.replace(".", r"\.")):
        plates(**{"integrator": "central_difference", **keys})


@pytest.mark.parametrize(
    "integrator, parameter, held",
    [
        ("central_difference", None, 1.0),
        ("chung_lee", 1.0, 1.0),
        ("tchamwa_wielgosz", 1.0, 1.0),
        ("chung_lee", None, 0.0),
        ("tchamwa_wielgosz", None, 0.0),
        ("noh_bathe", None, 0.0),
        ("noh_bathe", 0.5, 0.0),
    ],
)
def test_contacts_hold_energy_only_with_the_leapfrog(integrator, parameter, held):
    """Only there it is proved that bodies gain nothing by it (eq:impact-reserve); a scene may give another value."""
    data = plates(integrator).data
    data["time"] |= {} if parameter is None else {"integrator_parameter": parameter}
    assert read(data).contact[0].restitution == held
    data["contact"][0]["restitution"] = 0.5
    assert read(data).contact[0].restitution == 0.5
    # The explicit penalty has no such key.
    del data["contact"][0]["restitution"]
    data["contact"][0]["enforcement"] = "penalty"
    read(data)


def test_a_step_above_the_limit_of_the_integrator_is_refused():
    limit = plates("central_difference").explain().data["time"]["stable"]
    with pytest.raises(ct.Error, match="above the stable step"):
        run(plates("tchamwa_wielgosz", fraction=None, dt=0.99 * limit), output=False)
    run(plates("noh_bathe", fraction=None, dt=1.8 * limit), output=False)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_the_ledger_closes_and_restarts_give_the_same_bits(integrator, tmp_path):
    made = plates(integrator)
    whole = run(made.set_output(file=str(tmp_path / "whole.vtkhdf"), every=4))
    scale = whole.energy["kinetic"][0]
    assert np.abs(whole.energy["balance"]).max() < 1e-12 * scale
    assert whole.energy["contact"].max() > 1e-3 * scale
    assert whole.energy["total"].max() < 1.001 * whole.energy["total"][0]
    rest = continued(made, tmp_path, 0.5 * whole.time[-1])
    assert same_state(whole, rest) and whole.energy[-1] == rest.energy[-1]


def test_loose_contact_forces_add_no_energy_and_restart_with_the_same_bits(tmp_path):
    """``force_tolerance`` (:eq:`energy-stop`): the motion changes, by less than 0.1 % in energy up to 3e-3. At 1e-2
    points open in another step (:eq:`release-together`), which leaves 0.24 % more or less in the vibration."""
    tight, made = plates("central_difference"), plates("central_difference", force_tolerance=1e-2)
    assert made._built(None).pointer.force_tolerance == 1e-2
    tight, whole = run(tight, output=False), run(made, output=False)
    assert not np.array_equal(tight.state["left"].velocity, whole.state["left"].velocity)
    total, kinetic = whole.energy["total"], whole.energy["kinetic"]
    assert np.diff(total).max() < 1e-12 * total[0]
    assert np.abs(kinetic - tight.energy["kinetic"]).max() < 3e-3 * kinetic[0]
    closer = run(plates("central_difference", force_tolerance=3e-3), output=False).energy["kinetic"]
    assert np.abs(closer - tight.energy["kinetic"]).max() < 1e-3 * kinetic[0]
    made.set_output(every=4)
    assert same_state(whole, continued(made, tmp_path, 0.5 * whole.time[-1]))
    other = plates("central_difference").set_output(file=str(tmp_path / "other.vtkhdf"), every=4)
    with pytest.raises(ct.Error, match="restart"):
        other.run(restart=tmp_path / "half.vtkhdf")


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("beta", [1.0, 1e2, 1e4])
def test_the_default_enforcement_makes_no_energy_with_any_integrator(integrator, beta):
    """Bar on a wall, 100 elements, 0.9 of the limit: the total is never above its start by 1 %, the force is right to
    0.1 %, the impulse to 1.5 %."""
    made = scene_with("soft", young=900.0, poisson=0.0, density=1.0, title="bar")
    made.add_body(
        "bar",
        material="soft",
        box=box_of([0, 0, 5], [0.1, 0.1, 10], [1, 1, 100]),
        velocity=[0, 0, -10],
    )
    made.add(
        "obstacle", surface="bar.z_min", plane={"point": [0, 0, 0], "normal": [0, 0, 1]}, beta=beta
    )
    made.set_time(end=1.4, fraction=0.9, integrator=integrator).set_output(every=1, fields=[])
    done = run(made, output=False)
    total, p = done.energy["total"], done.momentum["p"][:, 2]
    assert total.max() < 1.01 * total[0] and 0.95 * total[0] < total[-1] <= total[0]
    held = (done.time > 0.6) & (done.time < 1.1)
    assert abs(np.polyfit(done.time[held], p[held], 1)[0] / (300.0 * 0.01) - 1.0) < 1e-3
    assert abs((p[-1] - p[0]) / (300.0 * 0.01 * 2 / 3) - 1.0) < 1.5e-2


def test_the_stable_step_is_safe_and_sharp():
    """The short form of stability/steps.py: 10 000 steps at 0.999 of the reported step stay bounded, 1.02 of the true
    one does not."""
    rows = [
        *steps.rows(("cubes", "distorted by 0.2 h"), ("hex8",), 10_000),
        *steps.rows(("graded",), ("hex20",), 2_000),
    ]
    assert (
        len(rows) == 3 * len(INTEGRATORS)
        and [steps.line(row) for row in rows if not row.good] == []
    )
    assert all(row.sharpness > 0.9 for row in rows)
