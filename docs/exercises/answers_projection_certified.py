"""Answers of the exercises of the chapter on certified projections."""

import numpy as np
import sympy as sp

import libcontact as ct


def test_certified_trough(says):
    x, z0 = sp.symbols("x z0")
    f = x**2 + (x**2 / 2 - z0) ** 2
    assert sp.expand(f - z0**2 - x**2 * (1 - z0 + x**2 / 4)) == 0
    xi = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0]], float)
    face = np.column_stack([2 * xi[:, 0], xi[:, 1], 2 * xi[:, 0] ** 2])
    for height, at in ((0.9, 0), (1.1, 1)):
        found = ct.project("Q8", face, [[0, 0.1, height]], method="certified")
        assert found.certified[0] and (abs(found.xi[0, 0]) > 0.1) == at
    says(r"M = 1 - z_0 + \tfrac14x^2")


def test_certified_pieces(says):
    rise = 1.01**2 - 1
    crude, quadratic = rise / 2, np.sqrt(rise)
    says(f"{crude:.2f}", f"{quadratic:.2f}")
    assert 7 < np.log2(2 / crude) < 8 and 3 < np.log2(2 / quadratic) < 4
    says("4 cuts".split()[0], "7")
