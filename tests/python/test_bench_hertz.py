"""The bench of Hertz's contact on its coarsest mesh, and its closed form compared with independent numbers."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "bench"))
import hertz  # noqa: E402


def test_the_surface_of_the_closed_form_is_that_of_its_pressure():
    # eq:hertz
    # u(r) = 1 / (pi E*) times the integral of p / distance over the disc: at its middle and at the rim, which the bench
    # uses
    force = 9.0
    a, deep = hertz.exact(force)
    p0 = 1.5 * force / (math.pi * a**2)
    r, weight = np.polynomial.legendre.leggauss(400)
    r, weight = 0.5 * a * (r + 1.0), 0.5 * a * weight
    angle = 2.0 * math.pi * (np.arange(400) + 0.5) / 400
    p = p0 * np.sqrt(1.0 - (r / a) ** 2)
    middle = 2.0 * math.pi * (p * weight).sum()
    away = np.sqrt(r[:, None] ** 2 + hertz.RIM**2 - 2.0 * r[:, None] * hertz.RIM * np.cos(angle))
    rim = (p * r * weight * (2.0 * math.pi / away).mean(axis=1)).sum()
    assert (middle - rim) / (math.pi * hertz.MODULUS) == pytest.approx(deep, rel=1e-5)


def test_two_elements_over_the_radius_are_within_what_the_book_says():
    row = hertz.solve(2)
    a, deep = hertz.exact(row["force"])
    assert row["radius"] == pytest.approx(a, rel=0.06)
    assert row["approach"] == pytest.approx(deep, rel=0.015)
    whole = (
        4.0
        / 3.0
        * hertz.MODULUS
        * math.sqrt(hertz.RADIUS)
        * (hertz.CONTACT**2 / hertz.RADIUS) ** 1.5
    )
    assert (
        1.032 < row["force"] / whole < 1.09
    )  # the far ends of the block are fixed, which alone causes 3.2 %
