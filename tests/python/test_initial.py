"""Bodies that begin displaced, turned or under stress (``[body.initial]``), against closed forms."""

import numpy as np
import pytest
from scenes import box_of, scene_with

import libcontact as ct

STRETCH, LENGTH, CELLS = 1e-2, 10.0, 40


def bar(law="linear", **initial):
    scene = scene_with("soft", young=900.0, poisson=0.0, density=1.0, law=law)
    h = LENGTH / CELLS
    box = box_of([0, 0, 0], [LENGTH, h, h], [CELLS, 1, 1])
    return scene.add_body("bar", material="soft", box=box, initial=initial)


def test_a_stretched_bar_is_released():
    """Release waves of the speed 30 run in from both ends: the stress is that of the stretch before them, and 0 behind
    them until they meet (eq:released-bar)."""
    scene = bar(gradient=[[STRETCH, 0, 0], [0, 0, 0], [0, 0, 0]])
    run = scene.set_time(end=LENGTH / 4 / 30, courant=1).run()
    x, stress = run.line("stress_xx", [0.2, 0.1, 0.1], [9.8, 0.1, 0.1], n=39)
    behind = (x < LENGTH / 4 - 0.4) | (x > 3 * LENGTH / 4 + 0.4)
    before = (x > LENGTH / 4 + 0.4) & (x < 3 * LENGTH / 4 - 0.4)
    assert behind.sum() > 10 and before.sum() > 10
    np.testing.assert_allclose(stress[before], 900 * STRETCH, rtol=1e-12)
    np.testing.assert_allclose(stress[behind], 0, atol=1e-11)


def test_a_held_bar_under_initial_stress_stays_and_shows_it(tmp_path):
    """Held at both ends, a bar under uniform stress is in equilibrium; its supports carry the stress times the area.
    The stress is the same in a state, at a probe, in a results file, and when it is computed from that file
    (eq:initial-stress)."""
    sigma = [9.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    scene = (
        bar(stress=sigma).add_support("bar.x_min", fix="xyz").add_support("bar.x_max", fix="xyz")
    )
    scene.add_probe("middle", body="bar", point=[5, 0.1, 0.1], quantities=["stress"])
    scene.add_probe("hold", resultant="support[0]")
    for fields in (["displacement", "stress"], ["displacement"]):
        scene.set_output(fields=fields)
        run = scene.set_time(end=0.5, fraction=0.9).run()
        run.save(tmp_path / "held.vtkhdf")
        for state in (run.state, ct.Run.load(tmp_path / "held.vtkhdf").state):
            np.testing.assert_allclose(state["bar"].stress, [sigma] * CELLS, rtol=1e-12, atol=1e-12)
    assert np.abs(run.state["bar"].displacement).max() < 1e-13
    np.testing.assert_allclose(run.probes["middle"]["stress"][:, 0], 9.0, rtol=1e-12)
    area = (LENGTH / CELLS) ** 2
    np.testing.assert_allclose(run.probes["hold"]["force"][-1], [-9 * area, 0, 0], atol=1e-12)
    assert "initial_stress" in run.energy.dtype.names


@pytest.mark.parametrize("law", ["st_venant_kirchhoff", "neo_hookean"])
def test_a_turned_body_is_free_of_stress(law):
    """A bar that is turned by 90 degrees about z stands along y, about its middle
    (eq:initial-displacement)."""
    scene = bar(law, angle=np.pi / 2, displacement=[-5, 0, 0])
    x = scene.set_time(end=1e-3, fraction=0.5).run().state["bar"]
    assert np.abs(x.stress).max() < 1e-9 * 900
    low, high = x.positions.min(axis=0), x.positions.max(axis=0)
    h = LENGTH / CELLS
    np.testing.assert_allclose(
        [low, high], [[-h / 2, -5 + h / 2, 0], [h / 2, 5 + h / 2, h]], atol=1e-12
    )


def test_displacement_follows_the_formula():
    """x = centre + R (1 + gradient)(X - centre) + displacement, with R as the exponential of a matrix
    (eq:initial-displacement)."""
    G, axis, angle = [[0.1, 0.2, 0], [0, -0.1, 0.05], [0, 0, 0.02]], np.array([1.0, 2, -2]) / 3, 2.0
    W = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]]) * angle
    R, term = np.eye(3), np.eye(3)
    for k in range(1, 60):
        term = term @ W / k
        R = R + term
    centre, shift = [1, 2, 3], [0.3, 0.2, 0.1]
    scene = bar(
        "neo_hookean", gradient=G, axis=list(axis), angle=angle, centre=centre, displacement=shift
    )
    body = scene.set_time(end=1e-9, fraction=0.5).run().state["bar"]
    want = centre + (body.nodes - centre) @ (R @ (np.eye(3) + G)).T + shift
    np.testing.assert_allclose(body.positions, want, atol=1e-6)


def test_displacements_of_each_node():
    u = np.zeros((4 * (CELLS + 1), 3))
    u[:, 0] = 0.01
    run = bar(displacements=u).set_time(end=0.1, fraction=0.5).run()
    np.testing.assert_array_equal(run.state["bar"].displacement, u)


@pytest.mark.parametrize(
    "law, initial, words",
    [
        ("linear", {"angle": 0.1}, ["body[0].initial.angle", "false strain"]),
        ("neo_hookean", {"stress": [1, 0, 0, 0, 0, 0]}, ["initial.stress", "gradient"]),
        ("linear", {}, ["body[0].initial", "gives no displacement"]),
        (
            "linear",
            {"displacements": [[0, 0, 0]]},
            ["initial.displacements", "1 rows", "164 nodes"],
        ),
        (
            "linear",
            {"displacements": [[0, 0, 0]], "displacement": [1, 0, 0]},
            ["initial.displacements", "beside"],
        ),
        ("neo_hookean", {"angle": 1, "axis": [0, 0, 0]}, ["initial.axis", "direction"]),
        ("neo_hookean", {"gradient": [[-2, 0, 0], [0, 0, 0], [0, 0, 0]]}, ["body[0]", "invert"]),
    ],
)
def test_refusals(law, initial, words):
    with pytest.raises(ct.SceneError) as caught:
        bar(law, **initial).set_time(end=0.1, fraction=0.5).run()
    assert all(word in str(caught.value) for word in words), caught.value
