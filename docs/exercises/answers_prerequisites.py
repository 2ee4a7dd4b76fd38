"""Answers of the exercises of the page on what one should know."""

import numpy as np
import sympy as sp


def test_before_spring(says):
    says(f"{float(sp.sqrt(sp.Rational(2, 50)) * sp.Rational(3, 2)):.1f} m")


def test_before_bar(says):
    x, t, E, rho = sp.symbols("x t E rho", positive=True)
    c = sp.sqrt(E / rho)
    u = sp.Function("f")(x - c * t)
    assert sp.simplify((rho * u.diff(t, 2) - E * u.diff(x, 2)).doit()) == 0
    speed = float(c.subs({E: 200e9, rho: 8000}))
    says(f"{speed:.0f} m/s", f"{2e3 / speed:.1f} ms")


def stiffness(lengths):
    K = sp.zeros(len(lengths) + 1)
    for i, h in enumerate(lengths):
        K[i : i + 2, i : i + 2] += sp.Matrix([[1, -1], [-1, 1]]) / h
    return K


def test_before_element(says):
    K = stiffness([1, 2])
    assert K[1, :] == sp.Matrix([[-1, sp.Rational(3, 2), -sp.Rational(1, 2)]])
    moved = K[1:, 1:].solve(sp.Matrix([0, 1]))
    says(f"by {moved[0]} and", f"one by {moved[1]},")


def test_before_modes(says):
    found = sorted((2 * stiffness([1])).eigenvals())
    says(f"are {found[0]} and {found[1]}")


def test_before_python(says):
    K = np.array(stiffness(10 * [1]), float)
    root = np.sqrt([2, *(9 * [1]), 2])
    says(f"at all: {np.sqrt(np.linalg.eigvalsh(root[:, None] * K * root)[-1]):.0f}")
