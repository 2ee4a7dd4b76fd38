"""Answers of the exercises of the chapter on faces in contact."""

import itertools

import numpy as np


def test_faces_points(says):
    x, _ = np.polynomial.legendre.leggauss(3)
    square = np.array(list(itertools.product(x, x))) / 2
    corner = np.linalg.norm(square - 0.5, axis=1).min()
    edge = (0.5 - square[:, 0]).min()
    triangle = np.array([[1, 1], [4, 1], [1, 4]]) / 6
    right, sharp = (np.linalg.norm(triangle - c, axis=1).min() for c in ([0, 0], [1, 0]))
    says(f"{edge:.3f}", f"{corner:.3f}", f"{right:.3f}", f"{sharp:.3f}")


def test_faces_cube(says):
    """A turned cube: heights of the points over the lowest corner."""
    up = np.ones(3) / np.sqrt(3)
    near = (1 - 1 / np.sqrt(3)) / 2
    points = [
        np.insert([a, b], axis, 0.0)
        for axis in range(3)
        for a, b in itertools.product((near, 1 - near), repeat=2)
    ]
    says(f"{min(up @ p for p in points):.3f}")


def test_faces_bullet(says):
    c1, h = 6.02, 1.0
    dt = 0.9 * h / c1
    says(*(f"{min(h, 0.75 * layers * h) / dt:.2f}" for layers in (4, 1)))


def test_faces_jump(says):
    E, h, rho = 210e9, 1e-3, 7800
    area = 0.5 * (h / 2) ** 2  # weight 1, J = h²/4
    jump = 0.5 * 4 * E / h * area * (h / 100) ** 2
    says(f"{jump * 1e3:.2f}", f"{rho * h**3 * 1e6:.1f}", f"{np.sqrt(2 * jump / (rho * h**3)):.1f}")


def test_faces_seam(says, run):
    _, told = run()
    assert 0.2 < float(told.split()[-1]) < 0.8
    names, told = run(mend=True)
    assert float(told.split()[-1]) == 0 and names["gaps"].min() > 0.49
    fine = np.concatenate(
        [np.linspace(a, b, 400) for a, b in zip(names["CHAIN"][:-1], names["CHAIN"][1:])]
    )
    for angle, gap in list(zip(names["angles"], names["gaps"]))[::50]:
        point = 1.5 * np.array([np.cos(angle), np.sin(angle)])
        assert abs(np.linalg.norm(fine - point, axis=1).min() - gap) < 1e-5
    says("twice")
