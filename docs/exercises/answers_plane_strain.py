"""Answers of the exercises of the chapter on plane strain."""

import numpy as np


def test_plane_count(says):
    free = np.eye(24).reshape(8, 3, 24)
    # Corners 0-3 in the layer y = 0, 4-7 in the other one.
    held = np.concatenate([free[:, 1], free[:4, 0] - free[4:, 0], free[:4, 2] - free[4:, 2]])
    left = 24 - np.linalg.matrix_rank(held)
    says(str(left), str(left - 2), str(left**2), str(24**2))


def test_plane_support(says):
    E, nu, rho = 210e9, 0.3, 7800
    stiff = np.linalg.inv((np.eye(3) * (1 + nu) - nu) / E)
    stress = stiff @ [-1 / np.sqrt(stiff[0, 0] / rho), 0, 0]
    bar = np.sqrt(E * rho)
    says(f"{stress[1] / 1e6:.1f}", f"{bar / 1e6:.1f}", f"{100 * (-stress[0] / bar - 1):.1f}")
