"""Answers of the exercises of the chapter on the default projection."""

import numpy as np

import libcontact as ct
from libcontact import Status

G, H = np.array([-4.0, -1.0]), np.array([[2.0, 1.0], [1.0, 2.0]])


def grid_minimum(g, matrix, limit):
    s = np.linspace(-limit, limit, 201)
    steps = np.stack(np.meshgrid(s, s), -1).reshape(-1, 2)
    values = steps @ g + ((steps @ matrix) * steps).sum(axis=1) / 2
    return steps[values.argmin()], values.min()


def test_robust_model_point(says):
    step, q = grid_minimum(G, H, 1)
    assert np.abs(step - [1, 0]).max() < 1e-12
    assert np.abs(-np.linalg.solve(H, G) - [7 / 3, -2 / 3]).max() < 1e-12
    says(f"{q:.0f}", "-2")


def test_robust_escape(says):
    step, q = grid_minimum(np.zeros(2), np.diag([2.0, -1.0]), 0.5)
    assert np.abs(np.abs(step) - [0, 0.5]).max() < 1e-12 and abs(q + 1 / 8) < 1e-12
    says("-1/8")


def test_robust_bent(says):
    """Whether the library takes one descent, by its count of evaluations, on both sides of the limit."""
    xi = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0]], float)
    limits = []
    for gap in (0.0, 1.0):
        limit = np.sqrt(0.2 / (1 + 2 * gap**2))
        counts = [
            ct.project("Q8", np.column_stack([xi, s * xi[:, 0] ** 2]), [[0, 0, gap]]).evaluations[0]
            for s in (0.99 * limit, 1.01 * limit)
        ]
        assert counts[0] < 7 < counts[1]
        limits.append(limit)
    says(*(f"{s:.3f}" for s in limits), *(f"{1 / (2 * s):.2f}" for s in limits))


def test_robust_far(says):
    square = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
    limit = 1e-10 / (2 * 2.22e-16)
    found = [ct.project("Q4", square, [[0.3, 0.2, d]]) for d in (2e5, 2.5e5)]
    assert [Status(f.status[0]) for f in found] == [Status.OK, Status.NOT_CERTIFIED]
    assert abs(found[1].distance[0] / 2.5e5 - 1) < 1e-15
    says(f"{limit / 1e5:.2f}·10⁵", "2·10⁵", "2.5·10⁵")


def test_robust_clip(says, run):
    names, told = run()
    assert 0.5 < float(told.split()[4]) < 0.6
    clipped = names["value"](G, H, names["lowest"](G, H))
    says(f"{clipped:.2f}", "-3")
    names, told = run(mend=True)
    assert names["missed"] == 0 and abs(names["value"](G, H, names["lowest"](G, H)) + 3) < 1e-12
