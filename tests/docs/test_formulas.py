"""Formulas as printed on the pages, compared with the library and with shape functions."""

import numpy as np
import pytest

import libcontact as ct

RNG = np.random.default_rng(12)
SQUARE = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)


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


def first_step(nodes, point, start):
    """Gradient and Hessian of f by differences, exact for these polynomials up to round-off, and the first step of the
    method from ``start``."""

    def f(xi):
        N = [(1 + a * xi[0]) * (1 + b * xi[1]) / 4 for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        return np.sum((N @ nodes - point) ** 2)

    e, h = np.eye(2), 1e-3
    g = np.array([(f(start + h * a) - f(start - h * a)) / (2 * h) for a in e])
    H = np.array(
        [
            [
                (
                    f(start + h * (a + b))
                    - f(start + h * (a - b))
                    - f(start - h * (a - b))
                    + f(start - h * (a + b))
                )
                / (4 * h * h)
                for b in e
            ]
            for a in e
        ]
    )
    path, _ = ct.project_path("Q4", nodes, point, method="steepest_descent", start=start)
    return f, g, H, next(xi for xi in path if not np.array_equal(xi, start)) - start


@pytest.mark.parametrize("height, opens_upwards", [(0.3, True), (6.0, False)])
def test_first_step_of_steepest_descent(height, opens_upwards):
    """eq:steepest-length: to the lowest point of the parabola if it has one, else by a half-width of the face; downhill
    in both cases."""
    nodes = SQUARE + [[0, 0, 0.5], [0, 0, -0.5], [0, 0, 0.5], [0, 0, -0.5]]
    start = np.array([0.3, 0.25])
    f, g, H, step = first_step(nodes, np.array([0.0, 0.0, height]), start)
    bend = g @ H @ g
    assert (bend > 0) == opens_upwards
    length = min(np.linalg.norm(g) ** 3 / bend, 1.0) if bend > 0 else 1.0
    np.testing.assert_allclose(step, -length * g / np.linalg.norm(g), rtol=1e-6, atol=1e-7)
    assert f(start + step) < f(start)
