"""The programs of the pictures of the chapters on contact, compared with closed forms."""

import runpy
from pathlib import Path

import numpy as np
import pytest

FIGURES = Path(__file__).resolve().parents[2] / "docs" / "figures"
continuum = runpy.run_path(str(FIGURES / "continuum.py"))


@pytest.mark.parametrize("epsilon", [1.0, 30.0, 1e4])
def test_a_penalty_leaves_the_gap_of_two_springs(epsilon):
    # eq:continuum-penalty: the bar has the stiffness 1 and is pushed by 1
    assert continuum["pressed"]("penalty", epsilon) == pytest.approx(-1 / (1 + epsilon), rel=1e-9)


@pytest.mark.parametrize("epsilon", [20.0, 300.0])
def test_nitsche_leaves_no_gap_and_has_a_limit(epsilon):
    # eq:continuum-nitsche: ten elements, so E / h is 10
    assert abs(continuum["pressed"]("nitsche", epsilon)) < 1e-14
    assert np.isnan(continuum["pressed"]("nitsche", 9.9))
    assert not np.isnan(continuum["pressed"]("nitsche", 10.1))
    K, u, h = np.diag([900.0, 30.0]), np.array([0.3, -0.7]), 0.5
    added = 0.5 * u @ (continuum["wall_terms"]("nitsche", epsilon, K, u, h)[0] - K) @ u
    pressure = (u[0] - u[1]) / h
    law = pressure - epsilon * u[0]
    assert added == pytest.approx((law**2 - pressure**2) / (2 * epsilon))


def test_a_multiplier_is_the_pressure():
    # eq:continuum-multiplier: the reaction of the wall, -K u of its row
    K, f = np.array([[2.0, -1.0], [-1.0, 2.0]]), np.array([0.0, -2.0])
    matrix, load = continuum["wall_terms"]("multiplier", 1.0, K, f, 0.5)
    gap, middle, pressure = np.linalg.solve(matrix, load)
    assert gap == pytest.approx(0.0, abs=1e-15) and middle == pytest.approx(-1.0)
    assert pressure == pytest.approx(1.0)
