"""Answers of the exercises of the chapter on dispersion."""

import numpy as np
import pytest
from dispersion import row
from scipy.optimize import brentq
from scipy.special import itairy

import libcontact as ct


def test_dispersion_elements(says):
    for courant in (0, 0.5, 0.9):
        exact = brentq(lambda n: row(2 * np.pi / n, courant)[0] * n / (2 * np.pi) - 0.99, 3, 50)
        says(f"{exact:.1f}", f"{2 * np.pi * np.sqrt((1 - courant**2) / 24 / 0.01):.1f}")
    late = brentq(lambda n: row(2 * np.pi / n, 0.5)[0] * n / (2 * np.pi) - 0.998, 3, 50)
    says(f"{late:.1f}")


def test_dispersion_width(says):
    fronts = [ct.dispersion_front(t, courant=0.125) for t in (400.0, 800.0)]
    width = [
        np.interp([-0.9, -0.1], -f.stress[f.distance > t - 10], f.distance[f.distance > t - 10])
        for f, t in zip(fronts, (400, 800))
    ]
    ratio = np.diff(width[1])[0] / np.diff(width[0])[0]
    assert ratio == pytest.approx(2 ** (1 / 3), rel=0.01)
    says(f"{2 ** (1 / 3):.2f}", f"{2**1.5:.2f}", "4")


def test_dispersion_design(says):
    """The width of Airy's front, from scipy's integral."""

    def front(eta):
        return 1 / 3 - itairy(eta)[0] if eta > 0 else 1 / 3 + itairy(-eta)[2]

    wide = brentq(lambda e: front(e) - 0.1, 0, 5) - brentq(lambda e: front(e) - 0.9, -2, 0)
    assert wide == pytest.approx(2.168, abs=1e-3)
    for courant in (0.5, 0.95):
        h = np.sqrt((1 / wide) ** 3 / (3 * (1 - courant**2) / 24 * 100))
        says(f"{h:.3f}", f"{100 / h:.0f}", f"{100 / h / courant:.0f}")


def test_dispersion_directions(says):
    k = 2 * np.pi / 40 * np.array([[1, 0, 0], [0.5**0.5, 0.5**0.5, 0], [3**-0.5] * 3])
    late = 1 - ct.dispersion(k).phase[:, 2]
    says(*(f"{part:.2f}" for part in late[1:] / late[0]))


def test_dispersion_ahead(says):
    k = np.linspace(0.01, 3.1, 100_001)
    group = np.gradient(row(k, consistent=True)[0], k)
    says(f"{group.max():.3f}", f"{k[group.argmax()]:.2f}")
    assert np.gradient(row(k)[0], k).argmax() < 5


def test_dispersion_consistent(says, run):
    names, told = run()
    assert "6 elements: 0.955 0.872" in told
    names, told = run(mend=True)
    for n in (3, 6, 12):
        exact = row(2 * np.pi / n, consistent=True)[0] * n / (2 * np.pi)
        assert names["speed"](n, True) == pytest.approx(exact) and exact > 1
    says(given=(f"{names['speed'](6, True):.3f}",))
