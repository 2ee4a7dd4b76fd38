"""Answers of the exercises of the chapter on the closest point."""

import numpy as np
import sympy as sp

import libcontact as ct

SQUARE = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]


def test_projection_box_points(says):
    found = ct.project("Q4", SQUARE, [[0.3, -0.2, 4], [2, 0.5, 1], [2, 3, -2]])
    assert np.abs(found.xi - [[0.3, -0.2], [1, 0.5], [1, 1]]).max() < 1e-12
    assert found.where.tolist() == ["interior", "edge", "vertex"]
    assert np.abs(found.signed_distance - [4, np.sqrt(2), -3]).max() < 1e-12
    says("+4", f"{found.signed_distance[1]:.3f}", f"{found.signed_distance[2]:.0f}", "-2", "-4")


def test_projection_parabola(says):
    x, z0 = sp.symbols("x z0", real=True)
    f = x**2 + (x**2 / 2 - z0) ** 2
    for height, points in ((sp.Rational(1, 2), {0: 1}), (sp.Rational(3, 2), {0: -1, 1: 2, -1: 2})):
        stationary = sp.solve(sp.diff(f, x).subs(z0, height), x)
        real = [p for p in stationary if p.is_real]
        assert {p: sp.diff(f, x, 2).subs({x: p, z0: height}) for p in real} == points
    assert sp.sqrt(f.subs({x: 1, z0: sp.Rational(3, 2)})) == sp.sqrt(2)
    assert sp.diff(f, x, 2).subs({x: 0, z0: 1}) == 0
    says("-1", "1")


def test_projection_stiffening(says):
    """Second differences of the distance from a cylinder."""
    angle = 1e-4 * np.arange(-1, 2)
    for gap, expected in ((0.5, 1), (-0.5, 3)):  # the centre of curvature is at z = 1
        f = np.sin(angle) ** 2 + (1 - np.cos(angle) - gap) ** 2
        assert abs((f[0] - 2 * f[1] + f[2]) / 1e-8 - expected) < 1e-5
    says("1", "3", "2")


def test_projection_clipped(says):
    face = [[-2, -1, 0], [0, -1, 0], [2, 1, 0], [0, 1, 0]]  # corners of the parallelogram
    found = ct.project("Q4", face, [[3, 0, 0]])
    assert np.abs(found.xi - 1).max() < 1e-12 and abs(found.distance[0] - np.sqrt(2)) < 1e-12
    clipped = np.clip(np.linalg.solve([[1, 1], [0, 1]], [3, 0]), -1, 1)
    assert clipped.tolist() == [1, 0]
    d = np.array([clipped @ [1, 1], clipped[1]]) - [3, 0]
    assert np.linalg.norm(d) == 2 and 2 * d @ [1, 1] == -4
    says("2", "-4")


def test_projection_sign(says, run):
    names, told = run()
    assert 0.4 < float(told.split()[-1]) < 0.42
    names, told = run(mend=True)
    assert float(told.split()[-1]) == 0
    beyond = np.maximum(np.abs(names["points"]) - 1, 0)
    outside = ~names["inside"]
    assert np.abs(names["gaps"] - np.linalg.norm(beyond, axis=1))[outside].max() < 1e-12
    says("last side")
