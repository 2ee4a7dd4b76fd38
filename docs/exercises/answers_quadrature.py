"""Answers of the exercises of the chapter on quadrature."""

import numpy as np
import sympy as sp
from answers_segment import q8

X, Y = sp.symbols("x y")


def test_quadrature_fourth(says):
    third = sp.Rational(1, 3)
    gauss, simpson = 2 * sp.sqrt(third) ** 4, third * 2
    exact = sp.integrate(X**4, (X, -1, 1))
    part = sp.symbols("part")
    assert sp.solve(part * gauss + (1 - part) * simpson - exact, part) == [sp.Rational(3, 5)]
    assert (gauss - exact, simpson - exact) == (-sp.Rational(8, 45), sp.Rational(12, 45))
    says(str(gauss), str(simpson), str(exact))


def test_quadrature_q8(says):
    parts = [sp.integrate(sp.expand(N), (X, -1, 1), (Y, -1, 1)) / 4 for N in q8(X, Y)]
    assert parts == [-sp.Rational(1, 12)] * 4 + [sp.Rational(1, 3)] * 4
    says(str(parts[0]), str(parts[4]))


def test_quadrature_unseen(says):
    a = 1 / sp.sqrt(3)
    points = [(s * a, t * a) for s in (-1, 1) for t in (-1, 1)]
    seen = sp.Matrix([[sp.simplify(N) for N in q8(*point)] for point in points])
    assert 8 - seen.rank() == 4
    nodes = [(-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (0, 1), (-1, 0), (1, 0)]
    for pattern in (3 * X**2 - 1, 3 * Y**2 - 1, Y * (3 * X**2 - 1), X * (3 * Y**2 - 1)):
        gaps = [pattern.subs({X: x, Y: y}) for x, y in nodes]
        assert sp.expand(sum(g * N for g, N in zip(gaps, q8(X, Y))) - pattern) == 0
        assert all(sp.simplify(value) == 0 for value in seen * sp.Matrix(gaps))
    says("4")


def test_quadrature_exponential(says):
    exact, errors = np.e - 1 / np.e, []
    for n in range(1, 6):
        x, w = np.polynomial.legendre.leggauss(n)
        errors.append(abs(w @ np.exp(x) - exact))
    powers = dict(zip("-3 -5 -7 -10".split(), ("10⁻³", "10⁻⁵", "10⁻⁷", "10⁻¹⁰")))
    shown = [
        f"{float(f'{e:.1e}') * 10.0 ** -int(p):.1f}·{t}"
        for e, (p, t) in zip(errors[1:], powers.items())
    ]
    says(f"{errors[0]:.2f}", *shown, f"{abs(w @ np.abs(x) - 1):.4f}")
    says(*(f"{digits:.1f}" for digits in -np.diff(np.log10(errors))[[0, -1]]))


def test_quadrature_swapped(says, run):
    names, told = run()
    assert "x^0: 2.0000" in told and "x^1: -0.2582" in told and "x^2: 0.8667" in told
    names, told = run(mend=True)
    for power in range(6):
        exact = float(sp.integrate(X**power, (X, -1, 1)))
        assert abs(names["integral"](lambda x: x**power) - exact) < 1e-15
    says(f"{names['integral'](lambda x: x**6):.2f}", "0.2857")
