"""Answers of the exercises of the chapter on contact."""

import numpy as np
import pytest
import sympy as sp

import libcontact as ct


def test_contact_half(says):
    """The library's two passes, against the sum without the half: two unit squares that overlap by 0.01."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    contact = ct.Contact(
        ct.Surface("Q4", square, [[0, 3, 2, 1]]),
        ct.Surface("Q4", square - [0, 0, 0.01], [[0, 1, 2, 3]]),
        epsilon=100.0,
        enforcement="penalty",
        initial_penetration="keep",
    )
    rest, masses = np.zeros((4, 3)), np.full((4, 3), 1.0)
    lower = square - [0, 0, 0.01]
    contact.step(1e-3, (square - [0, 0, 0.02], lower), (rest, rest), (masses, masses), (rest, rest))
    force = abs(contact.resultant[0, 0, 2])
    assert force == pytest.approx(100 * 0.01, rel=1e-12)  # ε |g| A
    doubled = sum(contact.points["raw_pressure"] * contact.points["weight"])  # without the half
    assert doubled == pytest.approx(2 * force, rel=1e-12)
    says("2", "half")


def test_contact_wedge(says):
    first = np.array([1.0, 0.0])
    second = np.array([np.cos(2 * np.pi / 3), np.sin(2 * np.pi / 3)])
    vector = 0.1 * first + second
    products = [vector @ n for n in (first, second, first + second)]
    says(f"{np.linalg.norm(vector):.3f}", *(f"{p:.2g}" for p in products))


def nodal(places, weights, n):
    """Forces of unit pressure at places of a line with n edges."""
    edge = np.minimum((places * n).astype(int), n - 1)
    part = places * n - edge
    return np.bincount(edge, weights * (1 - part), n + 1) + np.bincount(
        edge + 1, weights * part, n + 1
    )


def points(n):
    x, w = np.polynomial.legendre.leggauss(2)
    return ((np.arange(n)[:, None] + 0.5 + x / 2) / n).ravel(), np.tile(w / 2 / n, n)


def test_contact_unlike(says):
    largest = {}
    for m, n in ((3, 4), (5, 7), (8, 60), (1, 2)):
        for one, other in ((m, n), (n, m)):
            own = nodal(*points(other), other)
            largest[one, other] = np.abs((own + nodal(*points(one), other)) / 2 / own - 1).max()
    assert largest[2, 1] < 1e-15 and largest[60, 8] < 1e-3
    assert all(largest[m, n] > largest[n, m] for m, n in ((3, 4), (5, 7), (8, 60)))
    says(f"{largest[3, 4]:.2%}".replace("%", " %"), f"{largest[5, 7]:.2%}".replace("%", " %"))
    says(f"{largest[8, 60]:.0%}".replace("%", " %"))


def test_contact_slide(says):
    x, g, phi, s = sp.symbols("x g phi s")
    place = sp.Matrix([s * sp.cos(phi), -s * sp.sin(phi)])  # the plane, turned
    squared = ((sp.Matrix([x, g]) - place).T * (sp.Matrix([x, g]) - place))[0]
    closest = x * sp.cos(phi) - g * sp.sin(phi)
    assert sp.simplify(sp.diff(squared, s).subs(s, closest)) == 0
    distance2 = squared.subs(s, closest)
    expected = (g + x * phi - g * phi**2 / 2) ** 2
    for order in range(3):
        assert sp.simplify(sp.diff(distance2 - expected, phi, order).subs(phi, 0)) == 0
    says(r"g + x\varphi - \tfrac12 g\varphi^2")


def test_contact_moment(says, run):
    names, told = run()
    found = [float(line.split()[-1]) for line in told.splitlines()]
    assert found[0] == found[1] == 0 and abs(found[2]) == pytest.approx(0.161, abs=5e-4)
    names, told = run(mend=True)
    rng = np.random.default_rng(2)
    assert max(abs(names["moment"](p)) for p in rng.uniform(-3, 3, (100, 2))) < 1e-13
    says("couple")
