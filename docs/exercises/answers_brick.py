"""Answers of the exercises of the chapter on bricks."""

import itertools

import numpy as np
import pytest
import sympy as sp

X = sp.symbols("x:3")
CORNERS = list(itertools.product((-1, 1), repeat=3))
EDGES = [node for node in itertools.product((-1, 0, 1), repeat=3) if node.count(0) == 1]


def hex20(point):
    """All functions, corners first."""
    found = []
    for node in CORNERS:
        x = [a * b for a, b in zip(node, point)]
        found.append((1 + x[0]) * (1 + x[1]) * (1 + x[2]) * (sum(x) - 2) / sp.Integer(8))
    for node in EDGES:
        factors = [1 + a * b if a else 1 - b**2 for a, b in zip(node, point)]
        found.append(sp.prod(factors) / sp.Integer(4))
    return found


def test_brick_centre(says):
    values = hex20((0, 0, 0))
    assert len(values) == 20 and sum(values) == 1 and set(values[8:]) == {sp.Rational(1, 4)}
    assert set(values[:8]) == {-sp.Rational(1, 4)} and sum(map(abs, values)) == 5
    says("-1/4", "1/4", "5")


def test_brick_nodes(says):
    """Nodes of ten bricks on a half grid, by counting their places."""
    n, places = 10, set()
    for brick in itertools.product(range(n), repeat=3):
        for node in CORNERS + EDGES:
            places.add(tuple(2 * b + 1 + a for a, b in zip(node, brick)))
    says(str(len(places)), str((2 * n + 1) ** 3))


def test_brick_monomials(says):
    x, y, z = X
    functions = hex20(X)
    represented = []
    for monomial in (x * y * z, x**2 * y, x**2 * y * z, x**2 * y**2):
        values = [monomial.subs(dict(zip(X, node))) for node in CORNERS + EDGES]
        left = sp.expand(monomial - sum(v * f for v, f in zip(values, functions)))
        represented.append(left == 0)
    assert represented == [True, True, True, False]
    assert sp.expand(left - (x**2 * y**2 - x**2 - y**2 + 1)) == 0
    says("All but the last", "20")


def test_brick_clockwise(says, run):
    names, told = run()
    assert "area 6.0" in told and float(told.split()[-1]) == pytest.approx(1 / 3)
    assert np.abs(names["vectors"].sum(axis=0)).max() == 2
    names, told = run(mend=True)
    assert "area 6.0" in told and "volume 1.0" in told and not names["vectors"].sum(axis=0).any()
    says("clockwise")
