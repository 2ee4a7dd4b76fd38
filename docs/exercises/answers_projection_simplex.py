"""Answers of the exercises of the chapter on the rolling simplex."""

import numpy as np
import sympy as sp

import libcontact as ct


def test_simplex_by_hand(says):
    root = sp.sqrt(3)
    x = [sp.Matrix([-sp.S.Half, -root / 6]), sp.Matrix([sp.S.Half, -root / 6])]
    x.append(sp.Matrix([0, root / 3]))

    def f(v):
        return sp.nsimplify((v[0] - 1) ** 2 + v[1] ** 2)

    says(*(f"{float(f(v)):.3f}" for v in x))
    for high, image in ((0, [1, root / 3]), (2, [sp.Rational(3, 2), -root / 6])):
        assert max(range(3), key=lambda i: f(x[i])) == high
        x[high] = sum((v for i, v in enumerate(x) if i != high), sp.zeros(2, 1)) - x[high]
        assert sp.simplify(x[high] - sp.Matrix(image)) == sp.zeros(2, 1)
    assert {sp.simplify(f(v)) for v in x} == {sp.Rational(1, 3)}


def test_simplex_cost(says):
    halvings = int(np.ceil(np.log2(1e6)))
    says(str(halvings), str(3 + 6 * halvings), f"{np.log10(2):.1f}")


def test_simplex_precision(says):
    ratio = 1e-10 / (2 * np.sqrt(2.2e-16))
    says(f"{ratio:.4f}", f"{2 * np.sqrt(1.2e-7) * 1e4:.1f}·10⁻⁴")
    # The error of the search itself, on both sides of the ratio.
    square = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
    errors = [
        np.abs(ct.project("Q4", square, [[0.3, 0.2, gap]], method="simplex").xi - [0.3, 0.2]).max()
        for gap in (0.02 * ratio, 200 * ratio)
    ]
    assert errors[0] < 1e-10 < errors[1]


def test_simplex_aspect(says):
    counts = []
    for length in (1, 5, 20, 100):
        face = [[-length, -1, 0], [length, -1, 0], [length, 1, 0.3], [-length, 1, 0]]
        point = [[0.35 * length, 0.2, 0.5]]
        found, true = (ct.project("Q4", face, point, method=m) for m in ("simplex", "robust"))
        counts.append(str(found.evaluations[0]))
        far = found.distance[0] - true.distance[0]
        assert (far > 0.01) == (length == 100)
    says(*counts, f"{found.xi[0, 1]:.3f}", f"{true.xi[0, 1]:.3f}", f"{far:.3f}")


def test_simplex_flat(says, run):
    names, _ = run()
    places = np.random.default_rng(1).uniform(-1, 1, (5, 2))

    def errors():
        found = [
            names["search"](lambda x: ((x - place) ** 2).sum() + 1e-8, np.zeros(2))
            for place in places
        ]
        return np.abs(np.array([x for x, _ in found]) - places).max(axis=0), found[0][1]

    wrong, _ = errors()
    assert wrong[0] < 1e-7 and 1 < wrong[1] < 1.2
    names, _ = run(mend=True)
    right, count = errors()
    assert right.max() < 1e-10
    says(str(count))
