"""Answers of the exercises of the chapter on Newton's method and the others."""

import math

import numpy as np

import libcontact as ct
from libcontact import Status


def steps(factor, start, end):
    """Steps of a method that multiplies the error by a factor."""
    return math.ceil(round(math.log(end / start) / math.log(factor), 9))


def test_methods_newton(says):
    error, count = 0.1, 0
    while error > 1.01e-16:
        error, count = error**2, count + 1
    says(str(count), str(steps(0.5, 0.1, 1e-10)), str(steps(0.01, 0.1, 1e-10)))


def test_methods_steepest(says):
    """The worst case: a start on the line (c, 1) of the parabola (x² + c y²)/2, with exact line search."""
    c, x = 25.0, np.array([25.0, 1.0])
    for _ in range(3):
        g = x * [1, c]
        new = x - g @ g / (g @ (g * [1, c])) * g
        assert abs(np.linalg.norm(new) / np.linalg.norm(x) - 24 / 26) < 1e-12
        x = new
    far = steps(9999 / 10001, 1, 1e-10)
    says(f"{24 / 26:.3f}", str(steps(24 / 26, 1, 1e-10)), f"{far // 1000} {far % 1000}")


def test_methods_remainder(says):
    remaining = 0.9e-3 * sum(0.9**k for k in range(1, 400))
    says(f"{remaining * 1e3:.1f}·10⁻³", f"{1e-3 / 9 * 1e4:.1f}·10⁻⁴")


def test_methods_saddle(says):
    xi = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0]], float)
    face = np.column_stack([2 * xi[:, 0], xi[:, 1], 2 * xi[:, 0] ** 2])
    ridge = ("newton", "least_squares", "sphere", "torus", "steepest_descent", "broyden", "bfgs")
    for method in ridge:
        found = ct.project("Q8", face, [[0, 0.1, 1.5]], method=method)
        assert abs(found.distance[0] - 1.5) < 1e-9 and abs(found.xi[0, 0]) < 1e-9
        assert found.status[0] == Status.NO_CONVERGENCE
    for method in ("simplex", "robust", "certified"):
        found = ct.project("Q8", face, [[0, 0.1, 1.5]], method=method)
        assert abs(abs(found.xi[0, 0]) - 0.5) < 1e-6
    says(f"{found.distance[0]:.4f}", given=("1.5",))
    moved = [[1e-6, 0.1, 1.5]]
    newton, downhill = (
        ct.project("Q8", face, moved, method=m).xi[0, 0] for m in ("newton", "steepest_descent")
    )
    assert abs(newton) < 1e-4 and abs(downhill - 0.5) < 1e-3


def test_methods_hessian(says, run):
    names, told = run()
    assert "point at 0.5: x = " in told and "after 30 steps" in told
    assert abs(names["newton"](np.array([0.0, 1.1]))[0]) > 0.3  # not at the bottom any more
    names, told = run(mend=True)
    assert abs(names["newton"](np.array([0.0, 0.5]))[0]) < 1e-10
    says(str(names["newton"](np.array([0.0, 0.5]))[1]))
