"""Answers of the exercises of the chapter on contact of a body with itself."""

import numpy as np


def test_self_sag(says):
    h, R, p, modulus = 3e-3, 20e-3, 100e6, 282.7e9
    sag, overlap = R - np.sqrt(R * R - h * h / 4), p * h / (40 * modulus)
    equal = 8 * R * p / (40 * modulus)
    facets = 2 * np.pi * R / equal
    says(f"{sag * 1e6:.0f}", f"{overlap * 1e6:.4f}", f"{sag / overlap / 100:.0f}00")
    says(f"{equal * 1e6:.2f}", f"{facets / 1e3:.1f}".replace(".", " ") + "00")


def far(n, own, last=None):
    same = n @ own >= 0.5
    return same if last is None else n @ last < -0.5 or (n @ last < 0.5 and same)


def test_self_normals(says):
    up = np.array([0, 0, 1.0])
    places = [-up, np.array([1.0, 0, 0]), up, np.array([0.8, 0, 0.6])]
    assert [far(n, -up, up) for n in places] == [True, False, False, False]
    assert [far(n, up) for n in places] == [False, False, True, True]
    says("½", given=("0, 0, -1", "0.8, 0, 0.6"))
