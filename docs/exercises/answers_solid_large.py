"""Answers of the exercises of the chapter on large strain."""

import numpy as np
import sympy as sp


def test_large_stretch(says):
    a = np.radians(30)
    turn = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
    for F, shown in ((np.diag([1.2, 1.0]), ("0.22", "0.2")), (turn, ("0", "-0.134"))):
        green, small = (F.T @ F - np.eye(2)) / 2, (F + F.T) / 2 - np.eye(2)
        assert np.allclose([green[0, 0], small[0, 0]], [float(v) for v in shown], atol=5e-4)
        says(*shown)


def test_large_collapse(says):
    a, mu, first = sp.symbols("a mu Lambda", positive=True)
    C = sp.diag(a**2, 1, 1)
    J = sp.sqrt(C.det())
    W = mu * (C.trace() - 3) / 2 - mu * sp.log(J) + first * (J - 1) ** 2 / 2
    stiff = sp.simplify(sp.diff(W, a, 2))
    assert sp.simplify(stiff - mu * (1 + 1 / a**2) - first) == 0
    assert sp.simplify(stiff.subs(a, 1 / sp.sqrt(3)) - first - 4 * mu) == 0
    says(r"\Lambda + 4\mu")
