"""Answers of the exercises of the chapter on masses."""

import math

import numpy as np
import sympy as sp
from answers_segment import q8
from libcontact.mesh import Mesh

X, Y = sp.symbols("x y")


def scaled(diagonal):
    return [d / sum(diagonal) for d in diagonal]


def test_mass_bar(says):
    functions = [X * (X - 1) / 2, 1 - X**2, X * (X + 1) / 2]
    rows = [sp.integrate(N, (X, -1, 1)) / 2 for N in functions]
    assert scaled([sp.integrate(N**2, (X, -1, 1)) for N in functions]) == rows
    says(str(rows[0]), str(rows[1]))


def test_mass_q8(says):
    def integral(f):
        return sp.integrate(sp.expand(f), (X, -1, 1), (Y, -1, 1))

    functions = q8(X, Y)
    squares = [integral(N**2) for N in functions]
    assert (squares[0], squares[4]) == (sp.Rational(2, 15), sp.Rational(32, 45))
    hrz = scaled(squares)
    says(str(integral(functions[0]) / 4), str(integral(functions[4]) / 4), str(hrz[0]), str(hrz[4]))


def test_mass_t6(says):
    def integral(f):
        """Over the triangle of area ½, by its monomials."""
        return sum(
            c * sp.Rational(math.factorial(i) * math.factorial(j), math.factorial(i + j + 2))
            for (i, j), c in sp.Poly(sp.expand(f), X, Y).terms()
        )

    L = [1 - X - Y, X, Y]
    functions = [a * (2 * a - 1) for a in L] + [4 * L[i] * L[(i + 1) % 3] for i in range(3)]
    rows = [integral(N) / sp.Rational(1, 2) for N in functions]
    hrz = scaled([integral(N**2) for N in functions])
    assert hrz[:3] == hrz[:1] * 3 and hrz[3:] == hrz[3:4] * 3
    says(str(rows[0]), str(rows[3]), str(hrz[0]), str(hrz[3]))


def test_mass_flight(says):
    ratios = []
    for n in (1, 2, 10):
        box = Mesh.box("hex8", [-0.5] * 3, [1, 1, 1], [n] * 3)
        mass = np.bincount(box.elements.ravel(), minlength=len(box.nodes)) / n**3 / 8
        ratios.append(mass @ box.nodes[:, 0] ** 2 * 12)
    says(*(f"{r:.3g}" for r in ratios[:2]), given=(f"{ratios[2]:.2f}",))


def test_mass_negative(says, run):
    names, told = run()
    assert "sum: 4.0" in told
    growth = names["largest"](np.array([1.0] * 4 + [-1.0] * 4))
    assert 0.5e14 < growth < 2e14
    assert names["largest"](np.array([1.0] * 4 + [-1.0] * 4), 6000, 0.01) > growth / 2
    names, told = run(mend=True)
    assert names["largest"](np.array([1.0] * 4 + [-1.0] * 4), 10_000) < 1.1
    says("-1/3")
