"""Answers of the exercises of the chapter on rays."""

import numpy as np

import libcontact as ct


def test_ray_trough(says):
    xi = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0]], float)
    face = np.column_stack([3 * xi[:, 0], xi[:, 1], 4.5 * xi[:, 0] ** 2])  # z = x²/2
    for z0, start, place in ((0.0, -0.5, 0), (0.0, 1.5, 2), (-1.0, 0.0, np.nan)):
        hit = ct.project_ray("Q8", face, [[start, 0.1, z0 + start]], [[1, 0, 1]])
        assert np.allclose(3 * hit.xi[0, 0], place, atol=1e-9, equal_nan=True)
    assert np.allclose(np.roots([0.5, -1, 0.5]), 1)
    says("0", "2", "1")


def test_ray_bilinear(says):
    face = np.array([[-1, -1, 1], [1, -1, -1], [1, 1, 1], [-1, 1, -1]], float)
    for z, start, place in ((0.25, -1, -0.5), (0.25, 1, 0.5), (-0.25, -1, np.nan)):
        hit = ct.project_ray("Q4", face, [[start, start, z]], [[1, 1, 0]])
        assert np.allclose(hit.xi[0], place, equal_nan=True)
    says("2")
