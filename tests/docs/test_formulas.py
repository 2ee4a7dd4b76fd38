"""Formulas as printed on the pages, compared with shape functions."""

import numpy as np

RNG = np.random.default_rng(12)


def q8(node, x, y):
    """Shape functions of the chapter "Segment", each written down."""
    corners = [
        (1 + a * x) * (1 + b * y) * (a * x + b * y - 1) / 4
        for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    sides = [
        (1 - x * x) * (1 - y) / 2,
        (1 + x) * (1 - y * y) / 2,
        (1 - x * x) * (1 + y) / 2,
        (1 - x) * (1 - y * y) / 2,
    ]
    return np.array(corners + sides) @ node


def test_coefficients_of_a_q8_face():
    """eq:projection-patch-q8, with q1, q2, q3 the c1, c2, c3 of eq:projection-patch-q4 for the corners."""
    Y, point = RNG.normal(size=(8, 3)), RNG.normal(size=3)
    q1, q2, q3 = (
        ((Y[1] - Y[0]) + (Y[2] - Y[3])) / 4,
        ((Y[3] - Y[0]) + (Y[2] - Y[1])) / 4,
        ((Y[0] - Y[1]) + (Y[2] - Y[3])) / 4,
    )
    d = Y - point
    c0, c1, c2 = d[4:].sum(axis=0) / 2 - d[:4].sum(axis=0) / 4, (Y[5] - Y[7]) / 2, (Y[6] - Y[4]) / 2
    c4 = (Y[0] + Y[1] - 2 * Y[4]) / 4 + (Y[2] + Y[3] - 2 * Y[6]) / 4
    c5 = (Y[0] + Y[3] - 2 * Y[7]) / 4 + (Y[1] + Y[2] - 2 * Y[5]) / 4
    for x, y in RNG.uniform(-1, 1, size=(20, 2)):
        patch = (
            c0
            + c1 * x
            + c2 * y
            + q3 * x * y
            + c4 * x * x
            + c5 * y * y
            + (q2 - c2) * x * x * y
            + (q1 - c1) * x * y * y
        )
        np.testing.assert_allclose(patch, q8(Y, x, y) - point, atol=1e-12)
