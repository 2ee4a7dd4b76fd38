"""Answers of the exercises of the chapter on faces."""

import numpy as np
import sympy as sp

X, Y = sp.symbols("x y")
SIGNS = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
WARPED = sp.Matrix([X, Y, (1 + X) * (1 + Y) / 4])  # of the first exercise


def test_segment_warped(says):
    corners = [(*sign, 0) for sign in SIGNS]
    corners[2] = (1, 1, 1)
    point = sum(
        (sp.Matrix(c) * (1 + s[0] * X) * (1 + s[1] * Y) / 4 for c, s in zip(corners, SIGNS)),
        sp.zeros(3, 1),
    )
    assert sp.expand(point - WARPED) == sp.zeros(3, 1)
    normal = point.diff(X).cross(point.diff(Y))
    assert point.subs({X: 0, Y: 0})[2] == sp.Rational(1, 4)
    assert list(normal.subs({X: 0, Y: 0})) == [-sp.Rational(1, 4), -sp.Rational(1, 4), 1]
    says("1/4", f"{float(normal.subs({X: 0, Y: 0}).norm()):.3f}", "1/2")


def q8(x, y):
    corners = [(1 + a * x) * (1 + b * y) * (a * x + b * y - 1) / 4 for a, b in SIGNS]
    return [
        *corners,
        *((1 - x**2) * (1 + b * y) / 2 for b in (-1, 1)),
        *((1 - y**2) * (1 + a * x) / 2 for a in (-1, 1)),
    ]


def test_segment_sums(says):
    """On a fine grid that has the centres."""
    x, y = np.meshgrid(*2 * [np.linspace(-1, 1, 301)])
    square = np.abs(q8(x, y)).sum(axis=0)
    a, b = np.meshgrid(*2 * [np.linspace(0, 1, 301)])
    L = np.array([1 - a - b, a, b])
    inside = (L >= -1e-12).all(axis=0)
    triangle = np.abs([*(L * (2 * L - 1)), *(4 * L * np.roll(L, -1, axis=0))]).sum(axis=0)
    assert abs(square.max() - 3) < 1e-12 and abs(triangle[inside].max() - 5 / 3) < 1e-12
    says("3", "5/3")


def test_segment_area(says):
    J = sp.lambdify((X, Y), WARPED.diff(X).cross(WARPED.diff(Y)).norm(), "numpy")
    middles = (np.arange(1000) + 0.5) / 500 - 1
    area = J(*np.meshgrid(middles, middles)).mean() * 4
    centre = 4 * J(0.0, 0.0)
    points = sum(J(a / np.sqrt(3), b / np.sqrt(3)) for a, b in SIGNS)
    says(f"{area:.4f}", f"{centre:.4f}", f"{1 - centre / area:.2%}".replace("%", " %"))
    assert abs(points / area - 1) < 1e-4
    says(f"{points:.4f}", "0.01 %")


def test_segment_corner(says, run):
    names, told = run()
    assert "at its own node: [3. 3. 3. 3. 1. 1. 1. 1.]" in told
    assert "at another node: 1.0" in told and "sum at the centre: 3.0" in told
    assert 7 * names["shape"](np.zeros(2)).sum() == 21
    names, told = run(mend=True)
    assert np.array_equal(names["table"], np.eye(8))
    x = np.array([0.3, -0.7])
    assert abs(names["shape"](x) - np.array(q8(*x))[[0, 1, 2, 3, 4, 7, 5, 6]]).max() < 1e-15
    says("21", "7", "3")
