"""Large strain in scenes: laws, rings, spins, compared with the thin ring's closed form; refusals with key and
reason."""

import math
from pathlib import Path

import numpy as np
import pytest
from libcontact.mesh import view
from scenes import box_of, continued, same_state, scene_with

import libcontact as ct

SCENE = Path(__file__).parents[2] / "tutorials/scenes/spinning_ring.toml"


def uniaxial_energy(stretch, young, poisson):
    """Stored energy of a neo-Hookean bar with free sides: the lateral stretch b solves a quadratic in b^2."""
    mu, lam = young / (2 * (1 + poisson)), young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    p = mu - lam * stretch
    b2 = 2 * mu / (p + math.sqrt(p * p + 4 * lam * stretch**2 * mu))
    volume = stretch * b2
    return (
        0.5 * mu * (stretch**2 + 2 * b2 - 3) - mu * math.log(volume) + 0.5 * lam * (volume - 1) ** 2
    )


def turning_point(young, poisson, rho_v2):
    """Largest stretch s of a thin ring released with the rim speed v: W(s) = rho v^2 / 2 (1 - 1 / s^2), by
    bisection."""
    low, high = 1 + 1e-6, 3.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        gained = 0.5 * rho_v2 * (1 - middle**-2) - uniaxial_energy(middle, young, poisson)
        low, high = (middle, high) if gained > 0 else (low, middle)
    return low


def small(**changes):
    scene = ct.Scene.load(SCENE).data
    body = scene["body"][0]
    body["ring"]["cells"] = [1, 12, 1]
    body.update(changes)
    scene["body"][0] = {key: value for key, value in body.items() if value is not None}
    scene["output"] = {"every": 20}
    return scene


def test_the_spinning_ring_turns_back_where_the_closed_form_says(tmp_path):
    scene = ct.Scene.load(SCENE)
    assert len(SCENE.read_text().splitlines()) <= 40
    run = scene.run(output=tmp_path / "ring.vtkhdf" if ct.has("hdf5") else False)
    kinetic, total = run.energy["kinetic"], run.energy["total"]
    # At the largest radius all motion is rotation, K = L^2 / (2 m r^2): the kinetic energies give the stretch.
    peak = np.argmin(kinetic)
    L, v = run.momentum["L"][0, 2], 100.0
    stretch = math.sqrt(kinetic[0] / kinetic[peak])
    assert stretch == pytest.approx(turning_point(1e8, 0.4, 1000 * v**2), rel=5e-3)
    assert stretch > 1.15
    assert np.abs(run.momentum["L"][:, 2] / L - 1).max() < 1e-12
    assert np.ptp(total) < 1e-3 * total[0]
    assert np.abs(run.energy["balance"]).max() < 1e-12 * total[0]


def test_stress_of_a_ring_is_tension_around_it():
    scene = small()
    scene["time"]["end"] = 5e-4
    run = ct.Scene(scene).run()
    state = run.state["ring"]
    angle = np.arctan2(*state.mesh.centres(state.mesh.nodes + state.displacement)[:, 1::-1].T)
    n = np.stack([-np.sin(angle), np.cos(angle)], axis=1)
    xx, yy, xy = state.stress[:, 0], state.stress[:, 1], state.stress[:, 3]
    hoop = n[:, 0] ** 2 * xx + n[:, 1] ** 2 * yy + 2 * n[:, 0] * n[:, 1] * xy
    assert hoop.min() > 0 and np.ptp(hoop) < 1e-9 * hoop.max()


def test_a_run_restarts_with_the_same_bits_and_refuses_another_law(tmp_path):
    if not ct.has("hdf5"):
        pytest.skip("no HDF5")
    scene = small()
    assert same_state(ct.Scene(scene).run(), continued(ct.Scene(scene), tmp_path, 3e-3))
    assert ct.Run.load(tmp_path / "half.vtkhdf").state["ring"].material.law == "neo_hookean"
    scene["material"][0]["law"] = "st_venant_kirchhoff"
    with pytest.raises(ct.Error, match="material"):
        ct.Scene(scene).run(restart=tmp_path / "half.vtkhdf")


def test_laws_rings_and_spins_are_explained():
    scene = small()
    scene["material"].append({"name": "steel", "young": 2e11, "poisson": 0.3, "density": 7800})
    scene["body"].append(
        {"name": "block", "box": {"size": [1, 1, 1], "cells": [1, 1, 1]}, "material": "steel"}
    )
    facts = ct.Scene(scene).explain().data
    assert [body["law"] for body in facts["bodies"]] == ["neo_hookean", "linear"]
    assert [body["kernel"] for body in facts["bodies"]] == ["general", "box"]
    assert any("neo-Hookean" in line and "ring" in line for line in facts["assumptions"])
    assert any("small strains" in line and "block" in line for line in facts["assumptions"])
    assert any("stable step" in line for line in facts["assumptions"])


@pytest.mark.parametrize(
    "change, key, reason",
    [
        ({"spin": {"axis": [0, 0, 0], "rate": 1}}, "body[0].spin.axis", "direction"),
        ({"spin": {"axis": [0, 0, 1]}}, "body[0].spin.rate", "missing"),
        ({"kernel": "box"}, "body[0].kernel", "small strain"),
        (
            {"ring": {"radius": [0.2, 0.1], "width": 1, "cells": [1, 8, 1]}},
            "body[0].ring.radius[1]",
            "above the inner",
        ),
        (
            {"ring": {"radius": [0, 0.1], "width": 1, "cells": [1, 8, 1]}},
            "body[0].ring.radius[0]",
            "above 0",
        ),
        (
            {"ring": {"radius": [0.1, 0.2], "width": 1, "cells": [1, 2, 1]}},
            "body[0].ring.cells[1]",
            "at least 3",
        ),
        (
            {"ring": {"radius": [0.1, 0.2], "width": 1, "cells": [10000, 10000, 1000]}},
            "body[0].ring.cells",
            "GB",
        ),
        ({"box": {"size": [1, 1, 1], "cells": [1, 1, 1]}}, "body[0].ring", "cannot stand beside"),
    ],
)
def test_what_is_refused(change, key, reason):
    with pytest.raises(ct.SceneError, match=reason) as caught:
        ct.Scene(small(**change)).run(output=False)
    assert caught.value.key == key


def test_a_spin_under_small_strain_is_refused():
    scene = small()
    scene["material"][0]["law"] = "linear"
    with pytest.raises(ct.SceneError, match="a rotation causes false strain") as caught:
        ct.Scene(scene)
    assert caught.value.key == "body[0].spin"
    scene["material"][0]["law"] = "hookean"
    with pytest.raises(ct.SceneError, match="neo_hookean"):
        ct.Scene(scene)


def test_a_spin_is_a_rigid_rotation_and_adds_to_the_velocity():
    scene = small(spin={"axis": [0, 3, 4], "rate": 10, "centre": [1, 2, 3]}, velocity=[5, 6, 7])
    problem = ct.Scene(scene)._built(None)
    nodes = problem.bodies["ring"].mesh.nodes
    start = view(problem.pointer.initial_velocity, nodes.shape, np.float64, problem)
    expected = np.array([5, 6, 7]) + np.cross([0, 6, 8], nodes - np.array([1, 2, 3]))
    assert np.abs(start - expected).max() < 1e-13 * np.abs(expected).max()


def test_a_body_that_is_turned_inside_out_ends_the_run_with_its_name():
    scene = small(
        ring=None, spin=None, box={"size": [1, 1, 1], "cells": [1, 1, 1]}, velocity=[-1e4, 0, 0]
    )
    scene["support"] = [{"set": "ring.x_min", "fix": ["x"]}]
    scene["time"] = {"end": 0.01, "fraction": 0.9}
    with pytest.raises(ct.Error, match='"ring".*inverts the element'):
        ct.Scene(scene).run()


@pytest.mark.parametrize(
    "law, time, asked",
    [
        ("neo_hookean", {}, {"fraction": 0.7}),
        ("st_venant_kirchhoff", {}, {"fraction": 0.7}),
        ("linear", {}, {"fraction": 0.9}),
        ("neo_hookean", {"fraction": 0.9}, {"fraction": 0.9}),
        ("neo_hookean", {"courant": 0.5}, {"courant": 0.5}),
    ],
)
def test_the_usual_step_is_below_four_steps_a_period(law, time, asked):
    """Of large strain only, and where the scene names none (:eq:`step-resonance`)."""
    data = small(spin=None)
    data["material"][0]["law"], data["time"] = law, {"end": 1e-3, **time}
    facts = ct.Scene(data).explain().data["time"]
    assert facts["asked"] == asked
    assert facts["fraction"] <= facts["asked"].get("fraction", 1.0) * (1 + 1e-12)


def test_a_material_that_no_body_has_leaves_the_usual_step():
    data = small(spin=None)
    data["material"].append({**data["material"][0], "name": "unused", "law": "neo_hookean"})
    data["material"][0]["law"], data["time"] = "linear", {"end": 1e-3}
    assert ct.Scene(data).explain().data["time"]["asked"] == {"fraction": 0.9}


# One neo-Hookean element whose far face moves along x: one degree of freedom of mass M, a force and a stiffness.
MU, LAMBDA, M = 2.0 / 2.6, 2.0 * 0.3 / (1.3 * 0.4), 0.75
OMEGA = math.sqrt((2 * MU + LAMBDA) / M)


def one_element(angle, strain, steps):
    """It starts with the velocity of this strain, and takes steps of ``angle`` over its frequency."""
    scene = scene_with(
        "m", young=2.0, poisson=0.3, density=2 * M, law="neo_hookean", title="one element"
    )
    box = box_of([0, 0, 0], [1, 1, 1], [1, 1, 1])
    scene.add_body("b", material="m", box=box, velocity=[strain * OMEGA, 0, 0])
    scene.add_support("b.x_min", fix="x").add_support("b.outer", fix="yz")
    dt = angle / OMEGA
    scene.set_time(end=(steps - 0.5) * dt, dt=dt)
    return scene.set_output(every=1, fields=["displacement"]).run(output=False)


def band(angle):
    """Largest change of its energy, and largest difference of that to the closed form, over 24 / OMEGA."""
    run = one_element(angle, 0.2, round(24 / angle))
    s = 1 + np.array([state["b"].displacement[:, 0].sum() / 4 for state in run.states])
    force, stiffness = MU * (s - 1 / s) + LAMBDA * (s - 1), MU * (1 + s**-2) + LAMBDA
    v2 = 2 / M * run.energy["kinetic"] + (run.dt * force / (2 * M)) ** 2
    function = v2 * stiffness + force**2 / M
    change = run.energy["total"] - run.energy["total"][0]
    exact = -(run.dt**2) / 12 * (function - function[0])
    return np.abs(change).max(), np.abs(change - exact).max()


def test_the_energy_of_the_leapfrog_at_large_strain():
    """:eq:`energy-band`: the band is of second order in the step, and what it leaves of fourth."""
    (one, off), (half, less) = band(0.2), band(0.1)
    assert one / half == pytest.approx(4, rel=0.05) and off / less == pytest.approx(16, rel=0.1)


def test_four_steps_a_period_resonate():
    """:eq:`step-resonance`: at a strain of 5 % the energy doubles, and a little below it stays within its band."""
    energy = one_element(1.3, 0.05, 1000).energy["total"]
    assert np.abs(energy / energy[0] - 1).max() < 0.02
    with pytest.warns(ct.EnergyGrowth, match="fraction|dt = "), pytest.raises(ct.EnergyBlowup):
        one_element(math.sqrt(2), 0.05, 1000)
