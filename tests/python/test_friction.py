"""Friction: the partial slip of two bodies after Cattaneo and Mindlin, oblique impacts in gross slip."""

from __future__ import annotations

import math

import defaults
import numpy as np
import pytest
from libcontact.mesh import Mesh
from scenes import MILLIMETRES, box_of, scene_with

import libcontact as ct

GAUSS = np.array([-1.0, 1.0]) / math.sqrt(3.0)

# Cattaneo and Mindlin: two long bodies, one of them with the radius R at the contact, are pressed together and then
# shifted. N elements lie over the contact's half-width, about A.
A, R, SIZE, N = 1.0, 40.0, 10.0, 4
YOUNG, POISSON = 1000.0, 0.3
MODULUS = YOUNG / (2.0 * (1.0 - POISSON**2))


def places(fine: int) -> np.ndarray:
    """Equal elements at first, and then growing ones."""
    x = list(np.arange(fine + 1) * A / N)
    while x[-1] < SIZE:
        x.append(x[-1] + (x[-1] - x[-2]) * 2.0 ** (1.0 / N))
    return np.array(x)


X = places(3 * N // 2)
X, Z = np.concatenate([-X[:0:-1], X]), places(N)


def shifted(friction: float) -> ct.Run:
    made = scene_with("m", young=YOUNG, poisson=POISSON, density=1e-9, units=MILLIMETRES)
    cells = [len(X) - 1, 1, len(Z) - 1]
    mesh = Mesh.box("hex8", [0, 0, 0], cells, cells)
    i = np.rint(mesh.nodes).astype(int)
    for name, z, curved in (("lower", -Z[::-1], 0.0), ("upper", Z, 0.5 / R)):
        nodes = np.column_stack([X[i[:, 0]], A / N * i[:, 1], z[i[:, 2]]])
        nodes[:, 2] += curved * nodes[:, 0] ** 2 * (1.0 - nodes[:, 2] / Z[-1])
        made.add_body(name, material="m", nodes=nodes, elements=mesh.elements)
        for side in "y_min", "y_max":
            made.add_support(f"{name}.{side}", fix="y")
    c1 = math.sqrt(YOUNG * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON) * 1e-9))
    ramp, q = 24.0 * SIZE / c1, np.linspace(0.0, 1.0, 100)
    rise = list(q**3 * (10 - 15 * q + 6 * q * q))
    press = {"time": list(ramp * q), "value": rise}
    shift = {"time": list(1.5 * ramp + ramp * q), "value": rise}
    made.add_support("lower.z_min", fix=["x", "z"])
    made.add_support("upper.z_max", fix="z", travel=[0, 0, -0.04], history=press)
    made.add_support("upper.z_max", fix="x", travel=[0.0217, 0, 0], history=shift)
    rub = {"friction": friction} if friction else {}
    made.add_contact("lower.z_max", "upper.outer", **rub)
    made.add("damping", relaxation=True)
    return made.set_time(end=3.0 * ramp).set_output(every=10**9).run()


def shear(half: float) -> np.ndarray:
    """Mean shear stress in the elements at the surface under the tractions √(1 - (x / half)²)."""
    t = (np.arange(200) + 0.5) / 200 * math.pi
    s, q = half * np.cos(t), half * np.sin(t) ** 2 * math.pi / 200
    out = np.zeros(len(X) - 1)
    for g in GAUSS:
        for h in GAUSS:
            x = 0.5 * (X[1:] + X[:-1]) + 0.5 * g * np.diff(X)
            z, d = 0.5 * A / N * (1 + h), x[:, None] - s
            out += 0.25 * (2 / math.pi) * (q * d**2 * z / (d**2 + z**2) ** 2).sum(axis=1)
    return out


def test_partial_slip_of_two_bodies():
    """The stick zone has the half-width c = a √(1 - Q / μP), and friction leaves the number of steps. Measured is the
    width with which the closed form's shear stress is closest to that of the elements at the surface. Points that creep
    while they stick would lose Q while the load is constant."""
    run = shifted(0.5)
    body = run.state["lower"]
    top = np.flatnonzero(body.centres[:, 2] > -A / N)
    stress = body.stress[top[np.argsort(body.centres[top, 0])]]
    width = np.diff(X)
    P, Q = -(stress[:, 2] * width).sum(), abs((stress[:, 5] * width).sum())
    a = math.sqrt(4.0 * P * R / (math.pi * MODULUS))
    # The pressure's own shear is antisymmetric.
    found = abs(0.5 * (stress[:, 5] + stress[::-1, 5]))
    peak, near = 0.5 * 2.0 * P / (math.pi * a), abs(X[1:] + X[:-1]) < 2.6 * a
    off = [
        np.linalg.norm((found - peak * (shear(a) - c * shear(c * a)))[near])
        for c in np.linspace(0.3, 0.98, 341)
    ]
    c = np.linspace(0.3, 0.98, 341)[np.argmin(off)]
    assert 0.5 < Q / (0.5 * P) < 0.7
    assert c == pytest.approx(math.sqrt(1.0 - Q / (0.5 * P)), rel=1e-2)
    assert run.steps[-1] <= 1.06 * shifted(0.0).steps[-1]


def test_a_ball_that_strikes_obliquely_in_gross_slip():
    """Above the angle below which points stick in the impact of a ball (Maw, Barber, Fawcett), the tangential
    impulse is μ times the normal one, μ m (1 + e) v_n."""
    friction, speed, nu = 0.3, 0.003, 0.3
    kappa, chi = 2 * (1 - nu) / (2 - nu), 3.5 * (1 - nu) / (2 - nu)
    along = 1.5 * (4 * chi - 1) * friction / kappa * speed
    nodes, elements = defaults.ball()
    made = scene_with("m", young=1.0, poisson=nu, density=1.0, law="st_venant_kirchhoff")
    made.add_body("ball", material="m", nodes=nodes, elements=elements, velocity=[along, 0, -speed])
    made.add(
        "obstacle",
        surface="ball.outer",
        friction=friction,
        plane={"point": [0, 0, -1.001], "normal": [0, 0, 1]},
    )
    run = made.set_time(end=26.0).set_output(every=10**9).run()
    p = run.body_momentum("ball")["p"]
    along, up = p[-1, 0] - p[0, 0], p[-1, 2] - p[0, 2]
    assert p[-1, 2] > -0.95 * p[0, 2]
    assert -along == pytest.approx(friction * up, rel=1e-3)


@pytest.mark.parametrize("on", ["plane", "block"])
@pytest.mark.parametrize("step", [0.9, 0.25, 0.03])
def test_a_rigid_block_that_strikes_in_gross_slip(step, on):
    """It loses μ m (1 + e) v_n whatever the step is, in which it moves by less than the elastic slip at the limit
    (eq:slip-opens)."""
    made = scene_with("m", young=1e6, poisson=0.3, density=1000.0)
    box = box_of([0, 0, 1e-3], [1, 1, 1], [4, 4, 4])
    made.add_body("block", material="m", box=box, velocity=[2, 0, -1])
    made.add("rigid", body="block", fixed=["rx", "ry", "rz"])
    if on == "plane":
        floor = {"point": [0, 0, 0], "normal": [0, 0, 1]}
        made.add("obstacle", surface="block.z_min", friction=0.3, plane=floor)
    else:
        box = box_of([-0.5, -0.5, -1], [2, 2, 1], [10, 10, 5])
        made.add_body("floor", material="m", box=box)
        made.add("rigid", body="floor", fixed=["x", "y", "z", "rx", "ry", "rz"])
        made.add_contact("block.z_min", "floor.z_max", friction=0.3)
    run = made.set_time(end=0.05, dt=step * 0.25 / math.sqrt(1000.0)).set_output(every=10**9).run()
    p = run.body_momentum("block")["p"][-1] / 1000.0
    np.testing.assert_allclose(p, [2 - 0.3 * 2, 0, 1], atol=1e-12)
