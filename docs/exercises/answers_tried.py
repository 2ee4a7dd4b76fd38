"""Answers of the exercises of the chapter on what was tried."""

import sympy as sp


def test_tried_averaged(says):
    phi, Co, eta = sp.symbols("phi Co eta", positive=True)
    s = sp.sin(phi / 2)
    ratio = sp.series(2 / Co * sp.asin(Co * s * sp.sqrt(1 + 2 * eta * s**2 / 3)) / phi, phi, 0, 4)
    assert sp.simplify(ratio.removeO().coeff(phi, 2) + (1 - Co**2 - 2 * eta) / 24) == 0
    still = 2 * s * sp.sqrt(1 + s**2 / 3) / phi
    fourth = sp.series(still, phi, 0, 6).removeO().coeff(phi, 4)
    assert fourth == -sp.Rational(1, 180)
    says("180")


def test_tried_bipenalty(says):
    k, old, now, new = sp.symbols("k g_- g g_+")
    work = -k / 4 * (new + 2 * now + old) * (new - old) / 2
    fall = k / 2 * (((now + old) / 2) ** 2 - ((new + now) / 2) ** 2)
    assert sp.expand(work - fall) == 0
    says(r"\tfrac12k\,\bar g^2")
