"""Answers of the exercises of the chapter on search."""

import numpy as np
from answers_segment import q8


def test_search_box(says):
    grid = np.stack(np.meshgrid(*(np.linspace(0, b, 41) for b in (1, 4, 2))), -1).reshape(-1, 3)
    says(f"{np.linalg.norm(grid - [2, 3, -1], axis=1).min():.3f}")


def test_search_control(says):
    """The Bernstein form of the height, fitted to the face on a grid."""
    x, y = np.meshgrid(*2 * [np.linspace(-1, 1, 41)])
    height = sum(q8(x, y)[4:])
    t, s = (x + 1) / 2, (y + 1) / 2

    def bernstein(v):
        return [(1 - v) ** 2, 2 * v * (1 - v), v**2]

    basis = np.array([(a * b).ravel() for a in bernstein(t) for b in bernstein(s)]).T
    points, rest = np.linalg.lstsq(basis, height.ravel(), rcond=None)[:2]
    assert rest < 1e-20 and np.allclose(points, [0, 2, 0, 2, 4, 2, 0, 2, 0])
    says("2", "4", f"{height.max():.0f}", "1")
