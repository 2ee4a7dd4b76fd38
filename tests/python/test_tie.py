"""Ties in scenes: the patch test, a restart, threads, what is explained and refused."""

import numpy as np
import pytest
from scenes import box_of, continued, same_state, scene_with

import libcontact as ct


def glued(beta=40.0, order=1):
    scene = scene_with("soft", young=1.0, poisson=0.3, density=1.0)
    scene.add_body("a", material="soft", box=box_of([0, 0, 0], [0.5, 1, 1], [4, 8, 8]))
    scene.add_body("b", material="soft", box=box_of([0.5, 0, 0], [0.5, 1, 1], [4, 11, 11]))
    return scene.add("tie", surfaces=["a.x_max", "b.x_min"][::order], beta=beta)


def pulled(beta):
    """The state of rest of two blocks of 8 x 8 and 11 x 11 cells under tension."""
    scene = glued(beta=beta).add_support("a.x_min", fix="x")
    for body in "ab":
        scene.add_support(f"{body}.y_min", fix="y").add_support(f"{body}.z_min", fix="z")
    scene.add("load", surface="b.x_max", traction=[1e-3, 0, 0]).add("damping", relaxation=True)
    scene.set_time(end=1e4, until_static=1e-9, fraction=0.9, force_tolerance=1e-12)
    return scene.run(output=False).state


@pytest.mark.parametrize("beta, most", [(40.0, 2e-3), (400.0, 7e-4)])
def test_the_patch_test_holds_to_the_stiffness_of_the_glue(beta, most):
    """σ is uniform, and the end moves by σ (L/E + 1/ε) with ε = β ρ c₁²/h (eq:tie-stiffness)."""
    state, nu = pulled(beta), 0.3
    for name in "ab":
        stress = state[name].stress / 1e-3
        assert np.abs(stress - [1, 0, 0, 0, 0, 0]).max() < most
    b = state["b"]
    end = b.displacement[np.isclose(b.nodes[:, 0], 1.0), 0]
    epsilon = beta * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) * 11
    # The load does its work on the mean of the end, to the square of what the stress is off.
    np.testing.assert_allclose(end.mean() / (1e-3 * (1 + 1 / epsilon)), 1.0, atol=2e-5)


def moving(end, threads=1, order=1):
    scene = glued(order=order)
    scene.add("load", surface="a.y_min", traction=[1e-3, -2e-3, 1e-3])
    return scene.set_time(end=end, dt=0.025).set_run(threads=threads)


def test_threads_a_restart_and_exchanged_surfaces_have_the_same_bits(tmp_path):
    whole = moving(0.5).run(output=tmp_path / "whole.vtkhdf")
    others = [moving(0.5, threads=2).run(), moving(0.5, order=-1).run()]
    others += [continued(moving(0.5), tmp_path, 0.25)]
    assert np.abs(whole.state["b"].velocity).max() > 1e-5
    assert whole.energy["tie"][-1] > 0.0
    np.testing.assert_allclose(whole.energy["balance"] / whole.energy["kinetic"][-1], 0, atol=1e-12)
    assert all(same_state(whole, other) for other in others)


def test_a_rigid_body_is_glued_to_one_that_deforms():
    scene = scene_with("soft", young=1.0, poisson=0.3, density=1.0)
    scene.add_body(
        "a", material="soft", box=box_of([0] * 3, [1] * 3, [4] * 3), velocity=[0, 1e-3, 0]
    )
    scene.add_body("b", material="soft", box=box_of([1, 0, 0], [1] * 3, [2, 3, 3]))
    scene.add("tie", surfaces=["a.x_max", "b.x_min"]).add("rigid", body="b")
    scene.set_time(end=10, fraction=0.9, force_tolerance=1e-12)
    run = scene.run(output=False)
    # After the first step, in which the bodies collide; the turn of the rigid body has the order 2.
    total, kinetic = run.energy["total"][1:], run.energy["kinetic"][0]
    assert np.ptp(total) < 1e-7 * kinetic and run.energy["tie"].max() > 1e-3 * kinetic
    p = sum(run.momentum["p"][run.momentum["body"] == body] for body in (0, 1))
    np.testing.assert_allclose(p, np.broadcast_to(p[0], p.shape), atol=1e-17)
    assert np.abs(run.momentum["p"][-1]).max() > 1e-5


def test_a_tie_is_explained():
    text = str(moving(0.5).explain())
    assert "tie: a.x_max is glued to b.x_min; beta = 40; 740 of 740 points are tied" in text
    alone = scene_with("soft", young=9.0, poisson=0.0, density=1.0)
    alone.add_body("bar", material="soft", box=box_of([0, 0, 0], [1, 1, 1], [1, 1, 1]))
    assert "no [[tie]]" in str(alone.set_time(end=1.0, fraction=0.5).explain())


def test_what_a_tie_refuses():
    scene = glued()
    with pytest.raises(ct.SceneError, match=r"tie\[1\]\.surfaces.* twice; a tie needs two"):
        scene.add("tie", surfaces=["a.x_max", "a.x_max"])
    with pytest.raises(ct.SceneError, match=r"tie\[0\]\.surfaces.*contact\[0\]; what is glued"):
        scene.add_contact("b.x_min", "a.x_max")
    apart = glued().add("tie", surfaces=["a.x_min", "b.x_max"]).set_time(end=1.0, fraction=0.5)
    with pytest.raises(ct.SceneError, match=r"tie\[1\].*no point of either surface is within"):
        apart.run()
