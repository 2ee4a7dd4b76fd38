"""What a run tells of friction: tractions at points and nodes against probes and closed forms, stick and slip."""

import math

import numpy as np
import pytest
from scenes import box_of, scene_with
from test_friction import MODULUS, A, N, R, X, shifted

MU = 0.3


def means(q, x):
    """Means of a function over the hat functions of nodes x; 0 outside them."""
    fine = np.linspace(x[0], x[-1], 40001)
    hats = [np.interp(fine, x, row) for row in np.eye(len(x))]
    return np.array([(hat * q(fine)).sum() / hat.sum() for hat in hats])


def shear(c, a):
    """The traction of Cattaneo and Mindlin over μ p₀ in a contact of the half-width a that sticks in |x| < c."""
    return lambda x: (
        np.sqrt(np.maximum(1 - (x / a) ** 2, 0)) - c / a * np.sqrt(np.maximum(1 - (x / c) ** 2, 0))
    )


def test_partial_slip_from_the_output():
    """Cattaneo and Mindlin's traction q(x), as means over the nodes' hat functions, which is what nodal forces are
    (eq:recovered-friction). The half-width of the stick zone is that with which it fits best."""
    run = shifted(0.5)
    rows = run.pressure["contact"][0]
    rows = rows[(rows["side"] == 0) & (rows["position"][:, 1] < 0.5 * A / N)]
    rows = rows[np.argsort(rows["position"][:, 0])]
    width = (
        np.gradient(np.concatenate([[2 * X[0] - X[1]], X, [2 * X[-1] - X[-2]]]))[1:-1] * A / N / 2
    )
    force = rows["area"][:, None] * rows["friction"]
    P, Q = (
        2 * (rows["area"] * each).sum() * N / A
        for each in (rows["pressure"], rows["friction"][:, 0])
    )
    a = math.sqrt(4 * P * R / (math.pi * MODULUS))
    # What the pressure alone causes is antisymmetric.
    found = 0.5 * np.abs(force[:, 0] + force[::-1, 0]) / width / (0.5 * 2 * P / (math.pi * a))
    tried = np.linspace(0.4, 0.9, 251)
    off = [np.linalg.norm(found - means(shear(c * a, a), X)) for c in tried]
    best = tried[np.argmin(off)]
    assert best == pytest.approx(math.sqrt(1 - abs(Q) / (0.5 * P)), rel=0.02)
    assert min(off) < 0.1


def rubbing(element, speed):
    """A block that is pressed on another one, which rubs on a plane; the upper one is moved along x."""
    scene = scene_with("m", young=1e3, poisson=0.3, density=1.0)
    scene.add_body(
        "low", material="m", element=element, box=box_of([0, 0, 0], [2, 1, 0.5], [4, 2, 1])
    )
    scene.add_body(
        "high",
        material="m",
        element=element,
        box=box_of([0.3, 0.1, 0.5], [1.2, 0.7, 0.5], [3, 2, 1]),
        velocity=[speed, 0, -0.02],
    )
    scene.add_contact("low.z_max", "high.z_min", friction=MU)
    plane = {"point": [0, 0, 0], "normal": [0, 0, 1]}
    scene.add("obstacle", surface="low.z_min", plane=plane, friction=MU)
    scene.add("gravity", acceleration=[0, 0, -5])
    scene.add_probe("upper", resultant="contact", body="high")
    scene.add_probe("lower", resultant="contact", body="low")
    scene.add_probe("floor", resultant="obstacle")
    return scene.set_time(end=0.08, fraction=0.8).run()


@pytest.mark.parametrize("element", ["hex8", "hex20"])
@pytest.mark.parametrize("speed", [0.0, 0.5])
def test_tractions_of_nodes_and_points_are_the_probes_force(element, speed):
    """Area times traction of the nodes of each surface sums to the force of its probe, with friction, and so does
    its part that is normal with the pressure (eq:recovered-friction)."""
    run = rubbing(element, speed)
    contact, floor = run.pressure["contact"][0], run.pressure["obstacle"][0]
    for rows, probe in (
        (contact[contact["side"] == 0], "lower"),
        (contact[contact["side"] == 1], "upper"),
        (floor, "floor"),
    ):
        force = run.probes[probe]["force"][-1]
        total = (rows["area"][:, None] * rows["traction"]).sum(axis=0)
        np.testing.assert_allclose(total, force, atol=1e-12 * np.abs(force).max())
        rub = (rows["area"][:, None] * rows["friction"]).sum(axis=0)
        assert abs(rub[0]) > 1e-3 * np.abs(force).max() or speed == 0.0
    points = run.contact[0]
    on = points[(points["side"] == 1) & (points["raw_pressure"] > 0)]
    own = on["friction"] * 0.5 * on["weight"][:, None]
    assert len(on) and np.abs(own[:, 2]).max() < 1e-2 * max(np.abs(own[:, 0]).max(), 1e-9)


def test_slip_of_a_block_that_slides_and_of_one_that_stays():
    """All points of a block that slides have the traction μ p against the motion; those of one that is at rest on an
    incline below the angle of friction stick, with the traction p tan of the angle."""
    for angle, slides in ((0.2, False), (0.5, True)):
        scene = scene_with("m", young=1e4, poisson=0.0, density=1.0)
        scene.add_body("block", material="m", box=box_of([0, 0, 0], [1, 1, 0.2], [3, 3, 1]))
        plane = {"point": [0, 0, 0], "normal": [0, 0, 1]}
        scene.add("obstacle", surface="block.z_min", plane=plane, friction=MU, restitution=0)
        pull = [10 * math.sin(angle), 0, -10 * math.cos(angle)]
        history = {"time": [0, 0.5], "value": [0, 1]}
        scene.add("gravity", acceleration=pull, history=history).add("damping", stiffness=2e-3)
        run = scene.set_time(end=0.8, fraction=0.8, force_tolerance=1e-8).run()
        rows = run.pressure["obstacle"][0]
        assert set(rows["slip"]) == ({2} if slides else {1})
        weight = (rows["pressure"] * rows["area"]).sum()
        total = (rows["friction"] * rows["area"][:, None]).sum(axis=0)
        want = -MU if slides else -math.tan(angle)
        np.testing.assert_allclose(total / weight, [want, 0, 0], atol=2e-3)
        if slides:
            np.testing.assert_allclose(rows["friction"][:, 0], -MU * rows["pressure"], rtol=1e-4)
