"""The benches of Hertz's contact on coarse meshes, and their closed form compared with independent numbers."""

import math

import balls
import hertz
import numpy as np
import pytest


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


# Half a per cent above what the chapter on the pressure has.
@pytest.mark.parametrize(
    "element, n, m, impact, most",
    [
        ("hex8", 3, 3, False, (0.027, 0.027)),
        ("hex8", 3, 3, True, (0.027, 0.027)),
        ("hex8", 3, 4, True, (0.028, 0.018)),
        ("hex20", 2, 2, True, (0.068, 0.068)),
        ("hex20", 3, 3, True, (0.035, 0.035)),
    ],
)
def test_recovered_pressure_of_two_balls(element, n, m, impact, most):
    """Hertz's ellipse for the computed force, on both balls, at rest and in the middle of an impact, in which the
    error is no larger with three elements: it is that of the mesh. Points are off by 15 % of the peak and more;
    :eq:`recovered-traction`."""
    run = balls.scene(element, n, m, impact).run()
    for side in (0, 1):
        off = balls.errors(run, run.pressure["contact"][0], side)
        assert off["rms"] < most[side] and off["spread"] < 0.028
        assert off["force"] == pytest.approx(balls.FORCE, rel=0.06 if impact else 1e-3)
        assert off["points"] > 0.15
